//! What a user demands of parameters: fix, free, bound, start.

use super::Parameter;
use super::parameter::Search;
use serde::Serialize;

/// Demands on the parameters of a model, by name.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Directives {
    /// Hold at a value; `None`: at its nominal value.
    pub fix: Vec<(String, Option<f64>)>,
    /// Search although the model holds it, and whatever is believed of it.
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
    #[error("`{name}` = {} is impossible; it must be {allowed}", format!("{value} {unit}").trim_end())]
    Impossible {
        /// Which parameter.
        name: String,
        /// As the user wrote it.
        value: f64,
        /// Its unit.
        unit: String,
        /// What it may be.
        allowed: String,
    },
    /// Several effects have a parameter of this name.
    #[error("several effects have a parameter `{name}`; write {known}")]
    Ambiguous {
        /// As the user wrote it.
        name: String,
        /// The names that tell them apart.
        known: String,
    },
    /// What outputs print of an effect, where other numbers are searched.
    #[error("`{name}` is worked out of what is searched; write {known}")]
    Printed {
        /// As the user wrote it.
        name: String,
        /// The numbers that are searched.
        known: String,
    },
    /// One of a few values, not a number to be searched.
    #[error("`{name}` is not searched but {allowed}; write --fix {name}=VALUE or leave it out")]
    NotSearched {
        /// Which parameter.
        name: String,
        /// What it may be.
        allowed: String,
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
            self.check_values(p)?;
            self.impose(p);
        }
        Ok(())
    }

    /// Nothing is demanded.
    pub fn is_empty(&self) -> bool {
        self.names().next().is_none()
    }

    /// Every name that something is demanded of.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let fixed = self.fix.iter().map(|(name, _)| name);
        let bounded = self.bound.iter().map(|(name, _)| name);
        let started = self.start.iter().map(|(name, _)| name);
        fixed.chain(&self.free).chain(bounded).chain(started).map(String::as_str)
    }

    /// The same demands of parameters with other names.
    pub fn renamed(&self, name: impl Fn(&str) -> String) -> Self {
        Self {
            fix: self.fix.iter().map(|(n, value)| (name(n), *value)).collect(),
            free: self.free.iter().map(|n| name(n)).collect(),
            bound: self.bound.iter().map(|(n, range)| (name(n), *range)).collect(),
            start: self.start.iter().map(|(n, value)| (name(n), *value)).collect(),
        }
    }

    /// The value that a parameter is held at; `None` where that is not demanded.
    pub fn held(&self, p: &Parameter) -> Option<f64> {
        self.fix.iter().find(|(name, _)| *name == p.name).and_then(|(_, value)| value.or(p.nominal))
    }

    /// Where the search of a parameter is to begin; `None` where that is not demanded.
    pub fn begun(&self, p: &Parameter) -> Option<f64> {
        self.start.iter().find(|(name, _)| *name == p.name).map(|(_, value)| *value)
    }

    /// Applies the demands on one parameter, which have been checked. What is searched by demand is no longer believed.
    pub(crate) fn impose(&self, p: &mut Parameter) {
        if let Some((_, [low, high])) = self.bound.iter().find(|(name, _)| *name == p.name) {
            (p.lower, p.upper) = (*low, *high);
            p.start = p.start.clamp(*low, *high);
        }
        p.start = self.begun(p).unwrap_or(p.start);
        if self.free.contains(&p.name) {
            (p.fixed, p.belief) = (false, None);
        }
        if let Some(value) = self.held(p) {
            (p.fixed, p.start) = (true, value);
        }
    }

    /// The parameter can have the values demanded of it.
    fn check_values(&self, p: &Parameter) -> Result<(), DirectiveError> {
        if let Some((_, [low, high])) = self.bound.iter().find(|(name, _)| *name == p.name) {
            checked(p, *low, true)?;
            checked(p, *high, false)?;
        }
        if let Some(value) = self.begun(p) {
            checked(p, value, false)?;
        }
        if self.fix.iter().any(|(name, _)| *name == p.name) {
            let value = self.held(p).ok_or_else(|| DirectiveError::NoNominal { name: p.name.clone() })?;
            checked(p, value, false)?;
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
        let fixed = names("--fix");
        for (option, searched) in
            [("--free", self.free.iter().map(String::as_str).collect()), ("--start", names("--start"))]
        {
            if let Some(name) = searched.iter().find(|name| fixed.contains(*name)) {
                return Err(contradiction(name, format!("--fix and {option} are both given")));
            }
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
        for name in self.names() {
            if !names.contains(&name) {
                let mut unique = names.clone();
                unique.sort_unstable();
                unique.dedup();
                return Err(DirectiveError::Unknown { name: name.to_owned(), known: unique.join(", ") });
            }
        }
        Ok(())
    }
}

/// A value that the parameter can have; a lower bound may be zero where the value may not.
fn checked(p: &Parameter, value: f64, is_lower_bound: bool) -> Result<f64, DirectiveError> {
    let impossible = |allowed: &str| {
        let (name, unit, allowed) = (p.name.clone(), p.unit.clone(), allowed.to_owned());
        Err(DirectiveError::Impossible { name, value, unit, allowed })
    };
    match p.search {
        _ if !value.is_finite() => impossible("finite"),
        Search::Logarithm if value <= 0.0 && !is_lower_bound => impossible("above zero"),
        Search::Linear { .. } if value < 0.0 && p.lower >= 0.0 && p.unit != "rad" => impossible("zero or above"),
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
    fn what_is_freed_is_no_longer_believed_and_what_is_fixed_stays() {
        let believed = || parameters().into_iter().map(|p| p.believed(0.1)).collect::<Vec<_>>();
        let mut p = believed();
        Directives { free: vec!["moment".into()], ..Directives::default() }.apply(&mut p).unwrap();
        assert!(!p[0].fixed && p[0].belief.is_none() && p[1].belief.is_some());
        let d = Directives { fix: vec![("moment".into(), Some(0.06))], ..Directives::default() };
        assert_eq!((d.held(&p[0]), d.held(&p[1]), d.is_empty()), (Some(0.06), None, false));
        let renamed = d.renamed(|name| format!("link.{name}"));
        assert_eq!(renamed.names().collect::<Vec<_>>(), ["link.moment"]);
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
                Directives { fix: vec![("moment".into(), None)], start: vec![moment(1.0)], ..Directives::default() },
                "--fix and --start",
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
