//! What a user demands of the numbers of a fit: `--fix`, `--free`, `--bound`, `--start`.

use crate::identify::Directives;
use clap::Args;

/// The demands, the same in every command that fits.
#[derive(Args, Debug)]
pub(super) struct DemandArgs {
    /// Hold a parameter at a value, or at its nominal value; repeatable
    #[arg(long, value_name = "NAME[=VALUE]", value_parser = name_and_value)]
    fix: Vec<(String, Option<f64>)>,
    /// Search a parameter that is held otherwise, and without a belief; repeatable
    #[arg(long, value_name = "NAME")]
    free: Vec<String>,
    /// Search a parameter between two values only; repeatable
    #[arg(long, value_name = "NAME=LOW:HIGH", value_parser = name_and_range)]
    bound: Vec<(String, [f64; 2])>,
    /// Begin the search at a value; repeatable
    #[arg(long, value_name = "NAME=VALUE", value_parser = name_with_value)]
    start: Vec<(String, f64)>,
}

impl DemandArgs {
    /// The demands as a fit takes them.
    pub fn directives(&self) -> Directives {
        Directives {
            fix: self.fix.clone(),
            free: self.free.iter().map(|name| name.trim().to_owned()).collect(),
            bound: self.bound.clone(),
            start: self.start.clone(),
        }
    }
}

fn number(text: &str) -> Result<f64, String> {
    text.trim().parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(|| format!("`{text}` is not a number"))
}

fn name_and_value(text: &str) -> Result<(String, Option<f64>), String> {
    match text.split_once('=') {
        Some((name, value)) => Ok((name.trim().to_owned(), Some(number(value)?))),
        None => Ok((text.trim().to_owned(), None)),
    }
}

fn name_with_value(text: &str) -> Result<(String, f64), String> {
    match name_and_value(text)? {
        (name, Some(value)) => Ok((name, value)),
        (name, None) => Err(format!("`{name}` lacks a value; write {name}=VALUE")),
    }
}

fn name_and_range(text: &str) -> Result<(String, [f64; 2]), String> {
    let expected = || format!("`{text}` is not a range; write NAME=LOW:HIGH");
    let (name, range) = text.split_once('=').ok_or_else(expected)?;
    let (low, high) = range.split_once([':', ',']).ok_or_else(expected)?;
    let range = [number(low)?, number(high)?];
    if range[0] < range[1] {
        Ok((name.trim().to_owned(), range))
    } else {
        Err(format!("`{text}`: LOW must be below HIGH"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn demands_are_parsed_or_refused_with_the_form_expected() {
        assert_eq!(name_and_value("moment"), Ok(("moment".into(), None)));
        assert_eq!(name_and_value("moment=0.05"), Ok(("moment".into(), Some(0.05))));
        assert_eq!(name_and_range("viscous=0:0.1"), Ok(("viscous".into(), [0.0, 0.1])));
        assert_eq!(name_and_range("delay.T=0,0.1"), Ok(("delay.T".into(), [0.0, 0.1])));
        assert!(name_with_value("moment").unwrap_err().contains("moment=VALUE"));
        assert!(name_and_range("viscous=0.1:0").unwrap_err().contains("LOW must be below HIGH"));
        assert!(name_and_value("moment=five").unwrap_err().contains("not a number"));
    }
}
