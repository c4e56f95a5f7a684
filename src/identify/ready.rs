//! A log looked at whole, and shortened to what a search can look at hundreds of times.

use super::holes::{Begins, ends_of_holes};
use crate::log::{DriveMode, Health, Log, SensorSpec, Spikes, health, stretches, thinned};

/// Samples of a free log that are fitted at the most. A swing holds no more news than that.
const MOST_SAMPLES: usize = 20_000;
/// Samples of a driven log that are fitted at the most, in stretches: what drives it between two samples counts.
const MOST_DRIVEN: usize = 48_000;
/// What the logs of a study share alike, the free ones counted too; a driven one keeps no fewer than [`FEWEST_DRIVEN`].
const MOST_TOGETHER: usize = 96_000;
const FEWEST_DRIVEN: usize = 12_000;

/// A log as it is fitted.
pub(super) struct Ready {
    /// What was recorded, or a choice of it.
    pub log: Log,
    /// Of the whole log.
    pub health: Health,
    /// Where its parts begin.
    pub begins: Begins,
}

impl Ready {
    /// A log of a study that has so many.
    pub fn of(mut log: Log, sensor: &SensorSpec, drive: DriveMode, logs: usize) -> Self {
        let spikes = Spikes::mended(&log.t_s, &mut log.q_rad);
        let whole = Health { spikes, ..health(&log, sensor, drive) };
        let after_holes_s = ends_of_holes(&log.t_s);
        if drive == DriveMode::Off {
            let (log, health) = thinned(&log, &whole, MOST_SAMPLES).unwrap_or((log, whole));
            return Self { log, health, begins: Begins { after_holes_s, stretches_s: Vec::new() } };
        }
        let most = (MOST_TOGETHER / logs.max(1)).clamp(FEWEST_DRIVEN, MOST_DRIVEN);
        let (log, begins) = stretches(&log, most).unwrap_or((log, Vec::new()));
        let stretches_s = begins.into_iter().map(|k| log.t_s[k]).collect();
        Self { log, health: whole, begins: Begins { after_holes_s, stretches_s } }
    }
}
