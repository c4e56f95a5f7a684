//! What a joint is as given, where it is diagnosed as part of a robot whose bodies are other than described.

use crate::gap::diagnosis::{Diagnosis, Gap, LogTraces};
use crate::gap::hypothesis::evidence::Evidence;
use crate::gap::hypothesis::held_out::{HeldOut, closed};
use crate::gap::hypothesis::trial::Trial;
use crate::identify::{Case, Experiment};

/// A joint of the robot as described.
pub(in crate::gap) struct AsGiven {
    rms_rad: f64,
    /// By the log's name \[rad\].
    per_log: Vec<(String, f64)>,
    /// Readings that it predicts, by the log's name, with their stamps \[rad, s\].
    curves: Vec<(String, Vec<f64>, Vec<f64>)>,
}

impl AsGiven {
    /// As the diagnosis of the robot as described has it.
    pub fn of(described: &Diagnosis) -> Self {
        let curve = |traces: &LogTraces| (traces.file.clone(), traces.t_s.clone(), traces.before_rad.clone());
        Self {
            rms_rad: described.gap.before,
            per_log: described.gap.per_log.iter().map(|log| (log.file.clone(), log.before)).collect(),
            curves: described.traces.iter().map(curve).collect(),
        }
    }

    /// As the case of the robot as described simulates it; `None` where nothing moves.
    pub fn simulated(case: &Case) -> Option<Self> {
        let evidence = Evidence::of(case, case.joint.nominal?)?;
        let mut given = Trial::as_given(&evidence, &evidence.baseline());
        given.predict(&evidence, None);
        let held = HeldOut::of(&evidence);
        let residuals = held.residuals(&evidence, &given);
        let logs = evidence.fit.iter().zip(&given.fit).chain(evidence.held.iter().zip(&given.held));
        let curve = |(e, residual): (&Experiment, &Vec<f64>)| {
            let predicted = residual.iter().zip(&e.measured_rad[e.uncompared..]).map(|(r, q)| r + q).collect();
            (e.file.clone(), e.t_s[e.uncompared..].to_vec(), predicted)
        };
        Some(Self {
            rms_rad: held.rms_rad(&residuals),
            per_log: held.rms_by_file(&residuals),
            curves: logs.map(curve).collect(),
        })
    }

    /// Lets a gap begin at it.
    pub fn begin(&self, gap: &mut Gap) {
        gap.before = self.rms_rad;
        gap.closed = closed(gap.before, gap.after, gap.floor);
        // of the redraws of other readings
        gap.closed_interval = None;
        for row in &mut gap.per_log {
            if let Some((_, before)) = self.per_log.iter().find(|(file, _)| *file == row.file) {
                row.before = *before;
            }
        }
    }

    /// Puts what it predicts into curves of the same logs.
    pub fn show(&self, traces: &mut [LogTraces]) {
        for own in traces {
            if let Some((.., before)) = self.curves.iter().find(|(file, t_s, _)| (&own.file, &own.t_s) == (file, t_s)) {
                own.before_rad.clone_from(before);
            }
        }
    }
}
