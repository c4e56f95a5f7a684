//! A law as a table in files (specification, section 7).

use super::{BadLaw, Law, LawActs, LawVariable};
use crate::joint::Stage;
use serde::{Deserialize, Serialize};

/// A law with what is known of it, as `law` in `fit.json` and in a diagnosis.
///
/// Only `variables`, `acts` and `table` say what it does; the rest is for the reader.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LawTable {
    /// The stage of the chain that it changes.
    #[serde(default)]
    pub stage: String,
    /// What it is a function of: one variable.
    pub variables: Vec<LawVariable>,
    /// What it adds to; a torque where nothing else is said.
    #[serde(default = "torque")]
    pub acts: LawActs,
    /// Share of the gap that it closes, after everything with a name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub closed: Option<f64>,
    /// What the curve looks like.
    #[serde(default)]
    pub looks_like: String,
    /// The joints that have it.
    #[serde(default)]
    pub joints: Vec<String>,
    /// Its curve.
    pub table: CurveTable,
}

/// A curve by its knots.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CurveTable {
    /// Increasing, in the variable's unit.
    pub x: Vec<f64>,
    /// A value for each.
    pub y: Vec<f64>,
    /// Of `y`.
    #[serde(default)]
    pub unit: String,
}

fn torque() -> LawActs {
    LawActs::Torque
}

/// A reading may fall behind the angle by this share of it, at the most: beyond, it would turn back.
const MOST_LOST: f64 = 0.9;

impl LawTable {
    /// The table of a curve, with its stage and unit.
    pub fn new(variable: LawVariable, acts: LawActs, x: Vec<f64>, y: Vec<f64>) -> Self {
        Self {
            stage: acts.stage(variable).name().to_owned(),
            variables: vec![variable],
            acts,
            closed: None,
            looks_like: String::new(),
            joints: Vec::new(),
            table: CurveTable { x, y, unit: acts.unit().to_owned() },
        }
    }

    /// The stage that it names, where there is such a one.
    pub fn stage(&self) -> Option<Stage> {
        Stage::ALL.into_iter().find(|stage| stage.name() == self.stage)
    }

    /// What it is a function of.
    ///
    /// # Errors
    /// [`BadLaw::Variables`] where that is not one variable.
    pub fn variable(&self) -> Result<LawVariable, BadLaw> {
        match self.variables[..] {
            [variable] => Ok(variable),
            _ => Err(BadLaw::Variables { found: self.variables.len() }),
        }
    }

    /// The law that the table states.
    ///
    /// # Errors
    /// [`BadLaw`], naming what is wrong with it.
    pub fn law(&self) -> Result<Law<f64>, BadLaw> {
        let variable = self.variable()?;
        let CurveTable { x, y, unit } = &self.table;
        if !self.stage.is_empty() && self.stage().is_none() {
            return Err(BadLaw::Stage { found: self.stage.clone() });
        }
        if !unit.is_empty() && unit != self.acts.unit() {
            return Err(BadLaw::Unit { found: unit.clone(), acts: self.acts });
        }
        let law = Law::new(variable, self.acts, x[..].into(), y)?;
        let fall = law.curve.least_slope();
        if (self.acts, variable) == (LawActs::Reading, LawVariable::Angle) && fall < -MOST_LOST {
            return Err(BadLaw::Fold { fall });
        }
        Ok(law)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bad(json: &str) -> String {
        let table: LawTable = serde_json::from_str(json).unwrap();
        table.law().unwrap_err().to_string()
    }

    #[test]
    fn a_table_is_written_and_read_as_the_specification_has_it() {
        let mut table = LawTable::new(LawVariable::SetpointRate, LawActs::Torque, vec![-1.0, 2.0], vec![0.1, 0.4]);
        (table.closed, table.joints) = (Some(0.7), vec!["knee".into()]);
        let json = serde_json::to_value(&table).unwrap();
        assert_eq!(json["variables"], serde_json::json!(["setpoint_rate"]));
        assert_eq!((&json["acts"], &json["stage"]), (&"torque".into(), &"motor".into()));
        assert_eq!(json["table"], serde_json::json!({ "x": [-1.0, 2.0], "y": [0.1, 0.4], "unit": "N m" }));
        assert_eq!(serde_json::from_value::<LawTable>(json).unwrap(), table);
        let least = r#"{"variables": ["angle"], "table": {"x": [0, 1], "y": [0, -0.5]}}"#;
        let law = serde_json::from_str::<LawTable>(least).unwrap().law().unwrap();
        assert_eq!((law.variable(), law.acts(), law.at(0.5)), (LawVariable::Angle, LawActs::Torque, -0.25));
        for (variable, acts) in LawVariable::ALL.iter().flat_map(|v| LawActs::ALL.map(|acts| (*v, acts))) {
            let table = LawTable::new(variable, acts, vec![0.0, 1.0], vec![0.0, 0.0]);
            let is_there = match acts {
                LawActs::Torque => true,
                LawActs::Friction => variable != LawVariable::SetpointRate,
                LawActs::Reading => matches!(variable, LawVariable::Angle | LawVariable::Time),
                LawActs::Gain => {
                    matches!(variable, LawVariable::Angle | LawVariable::Speed | LawVariable::Time)
                }
            };
            assert_eq!(table.law().is_ok(), is_there, "{variable} {acts}");
        }
    }

    #[test]
    fn a_bad_table_is_refused_with_what_was_expected() {
        let unknown = r#"{"variables": ["angel"], "table": {"x": [0, 1], "y": [0, 1]}}"#;
        let said = serde_json::from_str::<LawTable>(unknown).unwrap_err().to_string();
        assert!(said.contains("unknown variable \"angel\"") && said.contains("setpoint_rate"), "{said}");
        let of = |rest: &str| bad(&format!(r#"{{"variables": ["angle"], {rest}}}"#));
        assert!(of(r#""table": {"x": [0, 1], "y": [0]}"#).contains("2 values in x and 1 in y"));
        assert!(of(r#""table": {"x": [0, 0], "y": [0, 1]}"#).contains("x[1] = 0 does not follow"));
        assert!(of(r#""table": {"x": [0, 1], "y": [0, 1], "unit": "Nm"}"#).contains("unit \"Nm\""));
        assert!(of(r#""stage": "shaft", "table": {"x": [0, 1], "y": [0, 1]}"#).contains("\"shaft\""));
        assert!(of(r#""acts": "reading", "table": {"x": [0, 1], "y": [1, 0]}"#).contains("-1"));
        let two = r#"{"variables": ["angle", "speed"], "table": {"x": [0, 1], "y": [0, 1]}}"#;
        assert!(bad(two).contains("2 variables"), "{}", bad(two));
        let pair = r#"{"variables": ["speed"], "acts": "reading", "table": {"x": [0, 1], "y": [0, 1]}}"#;
        assert!(bad(pair).contains("a law of the reading cannot be a function of speed"), "{}", bad(pair));
    }
}
