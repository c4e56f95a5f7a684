//! Whether realism got worse: the error of models as given, log by log and joint by joint, against a bound or an earlier
//! measurement.
//!
//! What is judged is the gap as given, `gap.before` of a diagnosis: what a simulation with the study's numbers would be off
//! by. What was found as its cause is told beside it.

/// What may not be exceeded.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GateBounds {
    /// Of the RMS error \[rad, or N m where torques are predicted\].
    pub max_gap: Option<f64>,
    /// Of its growth over the baseline, relative: 0.1 is ten percent.
    pub max_growth: Option<f64>,
}

/// A bound that is exceeded; what is not a number exceeds every bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exceeded {
    /// That of the error.
    Gap {
        /// The bound.
        most: f64,
    },
    /// That of its growth.
    Growth {
        /// What it has grown by, relative.
        growth: f64,
        /// The bound.
        most: f64,
    },
}

/// One joint in one log.
#[derive(Clone, Debug, PartialEq)]
pub struct GateRow {
    /// The study as the user named it.
    pub study: String,
    /// The joint; of a robot that is judged as a whole its name.
    pub joint: String,
    /// The log.
    pub log: String,
    /// `rad` or `N m`.
    pub unit: String,
    /// RMS error of the model as given.
    pub gap: f64,
    /// The same of the baseline; `None`: it has no such log.
    pub baseline: Option<f64>,
    /// The causes that were found, by their ids, or the verdict where none has a name.
    pub cause: String,
    /// What a colleague would say.
    pub sentence: String,
    /// What is exceeded; empty: nothing.
    pub exceeded: Vec<Exceeded>,
    /// Whether it is held against a baseline that does not have it.
    pub is_new: bool,
}

impl GateRow {
    /// Growth over the baseline, relative.
    pub fn growth(&self) -> Option<f64> {
        self.baseline.filter(|before| *before > 0.0).map(|before| self.gap / before - 1.0)
    }

    /// The same, held against bounds.
    #[must_use]
    pub fn judged(self, bounds: &GateBounds) -> Self {
        let too_large = bounds.max_gap.filter(|most| !(self.gap <= *most)).map(|most| Exceeded::Gap { most });
        let grown = self.growth().zip(bounds.max_growth).filter(|(growth, most)| !(growth <= most));
        let grown = grown.map(|(growth, most)| Exceeded::Growth { growth, most });
        let is_new = bounds.max_growth.is_some() && self.baseline.is_none();
        Self { exceeded: too_large.into_iter().chain(grown).collect(), is_new, ..self }
    }

    /// Whether it passes: nothing is exceeded.
    pub fn passes(&self) -> bool {
        self.exceeded.is_empty()
    }
}

/// A study that was judged.
#[derive(Clone, Debug, PartialEq)]
pub struct GateStudy {
    /// As the user named it.
    pub study: String,
    /// Its rows; empty where nothing moved.
    pub rows: Vec<GateRow>,
    /// Why it has no answer; `None`: it has one.
    pub error: Option<String>,
}

impl GateStudy {
    /// A study without an answer.
    pub fn failed(study: &str, why: String) -> Self {
        Self { study: study.to_owned(), rows: Vec::new(), error: Some(why) }
    }

    /// Whether it passes: it has an answer, and nothing is exceeded.
    pub fn passes(&self) -> bool {
        self.error.is_none() && self.rows.iter().all(GateRow::passes)
    }
}
