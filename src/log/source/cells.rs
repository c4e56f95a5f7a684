//! Cells that hold more than a number: lists, stamps in parts, names.

/// Numbers of a list in brackets: `[0.1, 2]`, `(0.1, 2)`, `0.1 2` with numpy's line breaks, `array('d', [0.1, 2])`.
pub(super) fn list_cell(cell: &[u8]) -> Option<Vec<f64>> {
    let body = body(std::str::from_utf8(cell).ok()?);
    let parts = body.split(|c: char| c == ',' || c.is_whitespace()).filter(|part| !part.is_empty());
    parts.map(|part| part.parse::<f64>().ok()).collect()
}

/// Names of a list in brackets, in quotes or not.
pub(super) fn names_cell(cell: &[u8]) -> Option<Vec<String>> {
    let text = std::str::from_utf8(cell).ok()?.trim();
    if !text.starts_with(['[', '(']) {
        return None;
    }
    let names = body(text).split(',').map(|part| part.trim().trim_matches(['\'', '"']).to_owned());
    Some(names.filter(|name| !name.is_empty()).collect())
}

fn body(text: &str) -> &str {
    let text = text.trim();
    let from = text.rfind(['[', '(']).map_or(0, |at| at + 1);
    let to = text[from..].find([']', ')']).map_or(text.len(), |at| from + at);
    &text[from..to]
}

/// A decimal number of seconds in nanoseconds, without losing digits on the way.
pub(super) fn nanoseconds(cell: &[u8], ns_per_unit: i64) -> Option<i64> {
    let text = std::str::from_utf8(cell).ok()?.trim();
    let (whole, fraction) = text.split_once('.').unwrap_or((text, ""));
    let is_plain = |part: &str| part.bytes().all(|byte| byte.is_ascii_digit());
    let digits = whole.strip_prefix('-').unwrap_or(whole);
    if digits.is_empty() || !is_plain(digits) || !is_plain(fraction) {
        let value = text.parse::<f64>().ok().filter(|value| value.is_finite())? * ns_per_unit as f64;
        return (value.abs() < 9e18).then_some(value.round() as i64);
    }
    let whole = whole.parse::<i64>().ok()?.checked_mul(ns_per_unit)?;
    let share = if fraction.is_empty() { 0.0 } else { format!("0.{fraction}").parse::<f64>().ok()? };
    let share = (share * ns_per_unit as f64).round() as i64;
    whole.checked_add(if text.starts_with('-') { -share } else { share })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_in_the_ways_that_tools_write_them_are_read() {
        for cell in ["[0.1, -2]", "(0.1, -2)", "[ 0.1 -2. ]", "array('d', [0.1, -2])"] {
            assert_eq!(list_cell(cell.as_bytes()), Some(vec![0.1, -2.0]), "{cell}");
        }
        assert_eq!(list_cell(b"[0.1, x]"), None);
        assert_eq!(names_cell(b"['elbow', \"a b\"]"), Some(vec!["elbow".to_owned(), "a b".to_owned()]));
        assert_eq!(names_cell(b"elbow"), None);
    }

    #[test]
    fn stamps_keep_their_nanoseconds() {
        assert_eq!(nanoseconds(b"1700000000.123456789", 1_000_000_000), Some(1_700_000_000_123_456_789));
        assert_eq!(nanoseconds(b"1700000000123456789", 1), Some(1_700_000_000_123_456_789));
        assert_eq!(nanoseconds(b"-0.5", 1_000_000_000), Some(-500_000_000));
        assert_eq!(nanoseconds(b"1e3", 1_000_000), Some(1_000_000_000));
        assert_eq!(nanoseconds(b"nan", 1), None);
        assert_eq!(nanoseconds(b"", 1), None);
    }
}
