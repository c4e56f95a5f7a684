//! A look at what a change does to a walk, before any fit: a short stand, and long steps.
//!
//! Feet stand where the landing put them until all have stepped once, and only then a walk is compared: how long a robot
//! stood before is forgotten by then. The robot as given is simulated alike, so that errors cancel.

use super::case::{CaseLog, RobotCase};
use super::cause::Change;
use super::forward::{of_those, predict};
use super::layout::{Layout, less};
use super::scatter::Scatter;

/// Long enough to land and to come to rest \[s\].
const STANDS_S: f64 = 0.4;
/// The longest step that follows the reference walk within 5 mm \[s\].
const STEP_S: f64 = 8e-4;

/// The walks of a study from shortly before their beginning on.
pub(super) struct Walks {
    /// With how many samples of the log come before.
    logs: Vec<(CaseLog, usize)>,
    /// What the study's robot reads.
    given: Vec<f64>,
}

impl Walks {
    /// `None` where the study's robot runs away.
    pub fn new(case: &RobotCase, layout: &Layout) -> Option<Self> {
        let logs = case.logs.iter().map(|log| log.from(log.motion_begins_s() - STANDS_S)).collect();
        let mut walks = Self { logs, given: Vec::new() };
        walks.given = walks.readings(case, layout, &vec![true; case.logs.len()], (&[], f64::INFINITY))?;
        Some(walks)
    }

    /// What changes make of the readings of some logs until a time, 0 beyond and in others; `None` where the robot runs away.
    pub fn difference(
        &self,
        case: &RobotCase,
        layout: &Layout,
        asked: &[bool],
        changes: &[Change],
        until_s: f64,
    ) -> Option<Vec<f64>> {
        Some(less(&self.readings(case, layout, asked, (changes, until_s))?, &self.given))
    }

    fn readings(
        &self,
        case: &RobotCase,
        layout: &Layout,
        asked: &[bool],
        (changes, until_s): (&[Change], f64),
    ) -> Option<Vec<f64>> {
        let none = Scatter::none(case.model());
        let walked = |(log, before): &(CaseLog, usize)| {
            Some(predict(case, log, None, (&none, changes), STEP_S, until_s).ok().flatten()?.after(*before))
        };
        Some(layout.predicted(case, &of_those(case, &self.logs, asked, walked)?))
    }
}
