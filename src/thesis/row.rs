//! One number of a table: the thesis's beside ours.

use serde::Serialize;

/// What a number is of.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Of {
    /// A joint of the leg.
    Joint(String),
    /// A part of the leg.
    Body(String),
}

impl Of {
    /// Its name.
    pub fn name(&self) -> &str {
        match self {
            Of::Joint(name) | Of::Body(name) => name,
        }
    }
}

/// One number of a table, the thesis's beside ours.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Joint or body.
    #[serde(flatten)]
    pub of: Of,
    /// e.g. `b_over_ml2`, `mass`, `coulomb`.
    pub quantity: String,
    /// Which swings: `bare`, `0.220 kg`, `all`, ...
    pub swings: String,
    /// As printed.
    pub thesis: Option<f64>,
    /// Half of its last printed digit, where what it is compared with is no better than that; else 0.
    pub half_digit: f64,
    /// Estimate; `None` where there is none.
    pub ours: Option<f64>,
    /// 95 % interval, or the one that the rounding of printed digits allows.
    pub interval: Option<[f64; 2]>,
    /// Its unit.
    pub unit: String,
    /// Whether the swings determine it.
    pub identifiable: bool,
    /// Estimates of single tests, as the thesis took them; empty where there are none.
    pub tests: Vec<f64>,
    /// What to know of it; empty as a rule.
    pub remark: String,
}

impl Row {
    /// An estimate that a printed number stands beside.
    pub fn new(of: Of, quantity: &str, swings: &str, unit: &str, thesis: Option<f64>) -> Self {
        Self {
            of,
            quantity: quantity.into(),
            swings: swings.into(),
            thesis,
            half_digit: 0.0,
            ours: None,
            interval: None,
            unit: unit.into(),
            identifiable: false,
            tests: Vec::new(),
            remark: String::new(),
        }
    }

    /// With an estimate that the swings determine.
    pub fn estimated(self, ours: f64, interval: [f64; 2]) -> Self {
        Self { ours: Some(ours), interval: Some(interval), identifiable: true, ..self }
    }

    /// Ours less the thesis's.
    pub fn difference(&self) -> Option<f64> {
        Some(self.ours? - self.thesis?)
    }

    /// Whether the thesis's number lies inside the interval, as far as its digits say.
    pub fn inside(&self) -> Option<bool> {
        let ([low, high], thesis) = (self.interval?, self.thesis?);
        Some(low <= thesis + self.half_digit && thesis - self.half_digit <= high)
    }

    /// Half of the interval over the estimate.
    pub fn relative_half_width(&self) -> Option<f64> {
        let [low, high] = self.interval?;
        Some(0.5 * (high - low) / self.ours?.abs())
    }

    /// Mean of the single tests.
    pub fn average(&self) -> Option<f64> {
        (!self.tests.is_empty()).then(|| self.tests.iter().sum::<f64>() / self.tests.len() as f64)
    }
}
