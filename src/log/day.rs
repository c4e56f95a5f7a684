//! Days of the calendar, as studies, folders and stamps have them.

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::fmt;

/// Seconds of a day \[s\].
const DAY_S: f64 = 86_400.0;
/// Stamps before this are no time of day but the time since a recorder began: 2000-01-01 \[s since 1970\].
const FIRST_S: f64 = 946_684_800.0;
/// Stamps from here on are no seconds: 2100-01-01 \[s since 1970\].
const LAST_S: f64 = 4_102_444_800.0;

/// A day (UTC), counted from 1970-01-01.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Day(i32);

impl Day {
    /// The day of a time \[s since 1970\]; `None`: it is no time of this century.
    pub fn of_epoch_s(at_s: f64) -> Option<Self> {
        (FIRST_S..LAST_S).contains(&at_s).then(|| Self((at_s / DAY_S) as i32))
    }

    /// A day as year, month and day of the month; `None`: there is no such day in this century.
    fn of_civil(year: i32, month: i32, day: i32) -> Option<Self> {
        let is_leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
        let longest = match month {
            2 if is_leap => 29,
            2 => 28,
            4 | 6 | 9 | 11 => 30,
            _ => 31,
        };
        if !(2000..2100).contains(&year) || !(1..=12).contains(&month) || !(1..=longest).contains(&day) {
            return None;
        }
        // Years begin in March, so that the leap day is the last of its year (Hinnant, "chrono-compatible low-level date
        // algorithms", 2013).
        let from_march = if month > 2 { year } else { year - 1 };
        let day_of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
        let leap_days = from_march / 4 - from_march / 100 + from_march / 400;
        Some(Self(365 * from_march + leap_days + day_of_year - 719_468))
    }

    /// A day as `2026-03-01`, and nothing else in the text.
    pub fn parse(text: &str) -> Option<Self> {
        let bytes = text.as_bytes();
        let is_day = bytes.len() == 10 && bytes[4] == b'-' && bytes[7] == b'-';
        if is_day { Self::of_digits(&text.replace('-', "")) } else { None }
    }

    /// The first day that stands in a name, as `2026-03-01`, `2026_03_01` or `20260301` between what are no digits.
    pub fn find(name: &str) -> Option<Self> {
        let bytes = name.as_bytes();
        let is_digit = |at: usize| bytes.get(at).is_some_and(u8::is_ascii_digit);
        let day_at = |at: usize| {
            let compact = bytes.get(at..at + 8).filter(|part| part.iter().all(u8::is_ascii_digit));
            let parted = bytes.get(at..at + 10).filter(|part| part[4] == part[7] && matches!(part[4], b'-' | b'_'));
            let (found, length) = match (compact, parted) {
                (Some(found), _) => (found.to_vec(), 8),
                (None, Some(found)) => ([&found[..4], &found[5..7], &found[8..]].concat(), 10),
                (None, None) => return None,
            };
            let is_alone = (at == 0 || !is_digit(at - 1)) && !is_digit(at + length);
            std::str::from_utf8(&found).ok().filter(|_| is_alone).and_then(Self::of_digits)
        };
        (0..bytes.len()).find_map(day_at)
    }

    fn of_digits(digits: &str) -> Option<Self> {
        if digits.len() != 8 || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
            return None;
        }
        let number = |range: std::ops::Range<usize>| digits[range].parse().ok();
        Self::of_civil(number(0..4)?, number(4..6)?, number(6..8)?)
    }

    /// Days since 1970-01-01.
    pub fn number(self) -> i32 {
        self.0
    }
}

impl Serialize for Day {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Day {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        Self::parse(&text).ok_or_else(|| D::Error::custom(format!("`{text}`, expected a day such as 2026-03-01")))
    }
}

impl fmt::Display for Day {
    /// `2026-03-01`
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let days = self.0 + 719_468;
        let era = days.div_euclid(146_097);
        let of_era = days.rem_euclid(146_097);
        let year_of_era = (of_era - of_era / 1_460 + of_era / 36_524 - of_era / 146_096) / 365;
        let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
        let from_march = (5 * of_year + 2) / 153;
        let day = of_year - (153 * from_march + 2) / 5 + 1;
        let month = if from_march < 10 { from_march + 3 } else { from_march - 9 };
        let year = year_of_era + 400 * era + i32::from(month <= 2);
        write!(f, "{year:04}-{month:02}-{day:02}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_counted_as_the_calendar_does() {
        for (text, number) in [("2000-01-01", 10_957), ("2024-02-29", 19_782), ("2026-11-23", 20_780)] {
            let day = Day::parse(text).unwrap();
            assert_eq!((day.number(), day.to_string().as_str()), (number, text));
            assert_eq!(Day::of_epoch_s(f64::from(number) * DAY_S + 86_399.0), Some(day));
        }
        let all: Vec<Day> = (10_957..47_482).map(Day).collect();
        assert!(all.iter().all(|day| Day::parse(&day.to_string()) == Some(*day)));
    }

    #[test]
    fn what_is_no_day_is_none() {
        for text in ["2026-02-29", "2026-13-01", "1999-12-31", "2026-1-01", "2026-03-01T10", "2026-03-+1", ""] {
            assert_eq!(Day::parse(text), None, "{text}");
        }
        for at_s in [0.0, 12.5, 1.7e12, f64::NAN] {
            assert_eq!(Day::of_epoch_s(at_s), None);
        }
    }

    #[test]
    fn days_are_found_in_names() {
        let day = Day::parse("2026-03-01");
        for name in ["2026-03-01", "run_20260301_12", "log-2026_03_01.csv", "rosbag2_2026-03-01T10-00", "ä2026-03-01"]
        {
            assert_eq!(Day::find(name), day, "{name}");
        }
        for name in ["12026-03-01", "202603011", "2026-0301", "2026-03_01", "1772323200.5", "dog-07", "20261340"] {
            assert_eq!(Day::find(name), None, "{name}");
        }
    }
}
