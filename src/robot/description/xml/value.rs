//! Numbers and words of attributes.

use super::Element;
use crate::robot::description::error::DescriptionError;

impl Element {
    /// The finite numbers of an attribute, if it is there.
    pub fn numbers(&self, name: &str) -> Result<Option<Vec<f64>>, DescriptionError> {
        let Some(text) = self.text(name) else { return Ok(None) };
        let number = |word: &str| word.parse::<f64>().ok().filter(|number| number.is_finite());
        let numbers: Option<Vec<f64>> = text.split_ascii_whitespace().map(number).collect();
        match numbers {
            Some(numbers) => Ok(Some(numbers)),
            None => Err(self.bad(name, "finite numbers with blanks between them")),
        }
    }

    /// So many limits, if the attribute is there; those that are infinite are `far`.
    pub fn limits<const N: usize>(&self, name: &str, far: f64) -> Result<Option<[f64; N]>, DescriptionError> {
        let words = self.text(name).map(|text| text.split_ascii_whitespace().map(str::parse::<f64>));
        let numbers = words.and_then(|words| words.collect::<Result<Vec<f64>, _>>().ok()).unwrap_or_default();
        match <[f64; N]>::try_from(numbers) {
            Ok(ends) if ends.iter().all(|end| !end.is_nan()) => Ok(Some(ends.map(|end| end.clamp(-far, far)))),
            _ => self.exactly::<N>(name),
        }
    }

    /// So many numbers, if the attribute is there.
    pub fn exactly<const N: usize>(&self, name: &str) -> Result<Option<[f64; N]>, DescriptionError> {
        let Some(numbers) = self.numbers(name)? else { return Ok(None) };
        let count = if N == 1 { "one number".to_owned() } else { format!("{N} numbers") };
        <[f64; N]>::try_from(numbers).map(Some).map_err(|_| self.bad(name, count))
    }

    /// One number, if the attribute is there.
    pub fn number(&self, name: &str) -> Result<Option<f64>, DescriptionError> {
        Ok(self.exactly::<1>(name)?.map(|[number]| number))
    }

    /// One number that is not negative, if the attribute is there.
    pub fn not_negative(&self, name: &str) -> Result<Option<f64>, DescriptionError> {
        match self.number(name)? {
            Some(number) if number < 0.0 => Err(self.bad(name, "a number not below 0")),
            number => Ok(number),
        }
    }

    /// An attribute that has to be there.
    pub fn needed(&self, name: &str) -> Result<&str, DescriptionError> {
        self.text(name).ok_or_else(|| self.wrong(format!("the attribute `{name}` is missing")))
    }

    /// What one of some words stands for, if the attribute is there.
    pub fn word<T: Copy>(&self, name: &str, words: &[(&str, T)]) -> Result<Option<T>, DescriptionError> {
        let Some(text) = self.text(name) else { return Ok(None) };
        match words.iter().find(|(word, _)| *word == text.trim()) {
            Some((_, meant)) => Ok(Some(*meant)),
            None => {
                let known: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
                Err(self.bad(name, format!("one of {}", known.join(", "))))
            }
        }
    }
}
