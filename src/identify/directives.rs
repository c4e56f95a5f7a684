//! What a user demands of parameters: fix, free, bound, start.

use super::Parameter;
use super::parameter::Search;

/// Demands on the parameters of a model, by name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Directives {
    /// Hold at a value; `None`: at its nominal value.
    pub fix: Vec<(String, Option<f64>)>,
    /// Search although the model holds it.
    pub free: Vec<String>,
    /// Search between two values.
    pub bound: Vec<(String, [f64; 2])>,
    /// Begin the search at a value.
    pub start: Vec<(String, f64)>,
}

/// A demand that cannot be met.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DirectiveError {
    /// No model has such a parameter.
    #[error("there is no parameter `{name}`; this fit has {known}")]
    Unknown {
        /// As the user wrote it.
        name: String,
        /// The names that there are.
        known: String,
    },
    /// A value outside what the parameter may be.
    #[error("`{name}` = {value} {unit} is impossible; it must be {allowed}")]
    Impossible {
        /// Which parameter.
        name: String,
        /// As the user wrote it.
        value: f64,
        /// Its unit.
        unit: String,
        /// What it may be.
        allowed: &'static str,
    },
    /// Nothing is known that the parameter could be held at.
    #[error("`{name}` has no nominal value to be held at; write --fix {name}=VALUE")]
    NoNominal {
        /// Which parameter.
        name: String,
    },
    /// Two demands that cannot both be met.
    #[error("`{name}`: {what}; leave one of them out")]
    Contradiction {
        /// Which parameter.
        name: String,
        /// Which demands.
        what: String,
    },
}

impl Directives {
    /// Applies the demands to a model's parameters; demands on others' parameters are passed over.
    ///
    /// # Errors
    /// [`DirectiveError::Impossible`] for a value that the parameter cannot have.
    pub fn apply(&self, parameters: &mut [Parameter]) -> Result<(), DirectiveError> {
        self.check_consistency()?;
        for p in parameters {
            if let Some((_, [low, high])) = self.bound.iter().find(|(name, _)| *name == p.name) {
                checked(p, *low, true)?;
                checked(p, *high, false)?;
                (p.lower, p.upper) = (*low, *high);
                p.start = p.start.clamp(*low, *high);
            }
            if let Some((_, value)) = self.start.iter().find(|(name, _)| *name == p.name) {
                p.start = checked(p, *value, false)?;
            }
            if self.free.contains(&p.name) {
                p.fixed = false;
            }
            if let Some((_, value)) = self.fix.iter().find(|(name, _)| *name == p.name) {
                let value = value.or(p.nominal).ok_or_else(|| DirectiveError::NoNominal { name: p.name.clone() })?;
                p.start = checked(p, value, false)?;
                p.fixed = true;
            }
        }
        Ok(())
    }

    /// No parameter is given two values, held and searched, or started or held outside its bounds.
    fn check_consistency(&self) -> Result<(), DirectiveError> {
        let contradiction = |name: &str, what: String| DirectiveError::Contradiction { name: name.to_owned(), what };
        let names = |option: &'static str| -> Vec<&str> {
            match option {
                "--fix" => self.fix.iter().map(|(name, _)| name.as_str()).collect(),
                "--bound" => self.bound.iter().map(|(name, _)| name.as_str()).collect(),
                _ => self.start.iter().map(|(name, _)| name.as_str()).collect(),
            }
        };
        for option in ["--fix", "--bound", "--start"] {
            let names = names(option);
            if let Some((_, name)) = names.iter().enumerate().find(|(i, name)| names[..*i].contains(name)) {
                return Err(contradiction(name, format!("{option} is given twice")));
            }
        }
        if let Some(name) = self.free.iter().find(|name| names("--fix").contains(&name.as_str())) {
            return Err(contradiction(name, "--fix and --free are both given".into()));
        }
        for (name, [low, high]) in &self.bound {
            let fixed = self.fix.iter().filter_map(|(n, value)| Some((n, (*value)?, "--fix")));
            let mut given = fixed.chain(self.start.iter().map(|(n, value)| (n, *value, "--start")));
            if let Some((_, value, option)) = given.find(|(n, v, _)| *n == name && !(*low..=*high).contains(v)) {
                return Err(contradiction(name, format!("{option} {value} lies outside --bound {low}:{high}")));
            }
        }
        Ok(())
    }

    /// Checks that every name belongs to one of the models.
    ///
    /// # Errors
    /// [`DirectiveError::Unknown`] with the names that there are.
    pub fn check_names(&self, known: &[&[Parameter]]) -> Result<(), DirectiveError> {
        let names: Vec<&str> = known.iter().flat_map(|ps| ps.iter().map(|p| p.name.as_str())).collect();
        let fixed = self.fix.iter().map(|(name, _)| name);
        let bounded = self.bound.iter().map(|(name, _)| name);
        let started = self.start.iter().map(|(name, _)| name);
        for name in fixed.chain(&self.free).chain(bounded).chain(started) {
            if !names.contains(&name.as_str()) {
                let mut unique = names.clone();
                unique.sort_unstable();
                unique.dedup();
                return Err(DirectiveError::Unknown { name: name.clone(), known: unique.join(", ") });
            }
        }
        Ok(())
    }
}

/// A value that the parameter can have; a lower bound may be zero where the value may not.
fn checked(p: &Parameter, value: f64, is_lower_bound: bool) -> Result<f64, DirectiveError> {
    let impossible =
        |allowed| DirectiveError::Impossible { name: p.name.clone(), value, unit: p.unit.clone(), allowed };
    match p.search {
        _ if !value.is_finite() => Err(impossible("finite")),
        Search::Logarithm if value <= 0.0 && !is_lower_bound => Err(impossible("above zero")),
        Search::Linear { .. } if value < 0.0 && p.unit != "rad" => Err(impossible("zero or above")),
        _ => Ok(value),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parameters() -> Vec<Parameter> {
        vec![
            Parameter::positive("moment", "M*", "kg m", Some(0.05), 0.05),
            Parameter::friction("coulomb", "mu_c", "N m", Some(0.01), 0.01, 1.0),
        ]
    }

    #[test]
    fn fixing_without_a_value_takes_the_nominal_one() {
        let mut p = parameters();
        p[0].start = 0.07;
        Directives { fix: vec![("moment".into(), None)], ..Directives::default() }.apply(&mut p).unwrap();
        assert!(p[0].fixed && p[0].start == 0.05);
    }

    #[test]
    fn bounds_move_the_start_inside() {
        let mut p = parameters();
        let d = Directives { bound: vec![("coulomb".into(), [0.02, 0.5])], ..Directives::default() };
        d.apply(&mut p).unwrap();
        assert_eq!((p[1].start, p[1].lower, p[1].upper), (0.02, 0.02, 0.5));
    }

    #[test]
    fn unknown_and_impossible_demands_are_named() {
        let d = Directives { free: vec!["mas".into()], ..Directives::default() };
        let message = d.check_names(&[&parameters()]).unwrap_err().to_string();
        assert_eq!(message, "there is no parameter `mas`; this fit has coulomb, moment");
        let d = Directives { start: vec![("moment".into(), -1.0)], ..Directives::default() };
        assert!(d.apply(&mut parameters()).unwrap_err().to_string().contains("must be above zero"));
    }

    #[test]
    fn demands_that_contradict_each_other_are_refused() {
        let moment = |value: f64| ("moment".to_owned(), value);
        let cases = [
            (Directives { start: vec![moment(1.0), moment(2.0)], ..Directives::default() }, "--start is given twice"),
            (
                Directives { fix: vec![("moment".into(), None)], free: vec!["moment".into()], ..Directives::default() },
                "--fix and --free",
            ),
            (
                Directives {
                    start: vec![moment(3.0)],
                    bound: vec![("moment".into(), [1.0, 2.0])],
                    ..Directives::default()
                },
                "--start 3 lies outside --bound 1:2",
            ),
        ];
        for (d, expected) in cases {
            let message = d.apply(&mut parameters()).unwrap_err().to_string();
            assert!(message.contains(expected) && message.contains("`moment`"), "{message}");
        }
        let mut unknown = parameters();
        unknown[0].nominal = None;
        let d = Directives { fix: vec![("moment".into(), None)], ..Directives::default() };
        assert!(d.apply(&mut unknown).unwrap_err().to_string().contains("--fix moment=VALUE"));
    }
}
