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
}

impl Directives {
    /// Applies the demands to a model's parameters; demands on others' parameters are passed over.
    ///
    /// # Errors
    /// [`DirectiveError::Impossible`] for a value that the parameter cannot have.
    pub fn apply(&self, parameters: &mut [Parameter]) -> Result<(), DirectiveError> {
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
                p.start = checked(p, value.or(p.nominal).unwrap_or(p.start), false)?;
                p.fixed = true;
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
}
