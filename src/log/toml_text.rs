//! Names as TOML, whatever characters they have.

/// A string in quotes.
pub(crate) fn toml_string(text: &str) -> String {
    toml::Value::from(text).to_string()
}

/// A key, in quotes only where it needs them; unlike a string it has one line.
pub(crate) fn toml_key(name: &str) -> String {
    let line = toml::Table::from_iter([(name.to_owned(), toml::Value::Integer(0))]).to_string();
    line.trim_end().trim_end_matches('0').trim_end().trim_end_matches('=').trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn plain_names_stay_plain() {
        assert_eq!((toml_string("q1").as_str(), toml_key("rf_1-a").as_str()), ("\"q1\"", "rf_1-a"));
        assert_eq!(toml_key(""), "\"\"");
    }

    proptest! {
        #[test]
        fn any_name_is_read_back(name in "[ -~]{0,8}|[\"\\\\'\n\t.=#\\[\\]a]{0,8}|\\PC{0,8}") {
            let text = format!("{} = {}\n", toml_key(&name), toml_string(&name));
            let table: toml::Table = toml::from_str(&text).map_err(|error| TestCaseError::fail(format!("{text}: {error}")))?;
            prop_assert_eq!(table.get(&name).and_then(toml::Value::as_str), Some(name.as_str()));
        }
    }
}
