//! Which logs a study has: free swings from various angles, some with masses, and driven motions.

use super::dice::{Dice, significant};
use super::joint::Joint;
use super::motion::motion;
use crate::number::{STANDARD_GRAVITY_M_S2, math};

/// A mass hung on the link: a thin-walled hollow cylinder.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extra {
    pub mass_kg: f64,
    pub distance_m: f64,
    pub radius_m: f64,
    pub length_m: f64,
}

/// What a mass adds to the joint.
#[derive(Clone, Copy, Debug)]
pub(super) struct Load {
    pub inertia_kg_m2: f64,
    pub peak_gravity_nm: f64,
}

impl Extra {
    /// `M (R^2/2 + L^2/12) + M D^2`, and `g M D`.
    pub(super) fn load(&self) -> Load {
        let (m, d, r, l) = (self.mass_kg, self.distance_m, self.radius_m, self.length_m);
        Load {
            inertia_kg_m2: m * (r * r / 2.0 + l * l / 12.0) + m * d * d,
            peak_gravity_nm: STANDARD_GRAVITY_M_S2 * m * d,
        }
    }
}

/// One log to be made.
#[derive(Clone, Debug)]
pub(super) struct LogPlan {
    /// When samples are taken \[s\].
    pub times_s: Vec<f64>,
    /// Angle of a free joint at the start; added to where the drive holds a driven one \[rad\].
    pub start_rad: f64,
    /// Speed at the start \[rad/s\]: none, but where the effect of the start is asked for.
    pub start_rad_s: f64,
    /// Where in the band of its friction a driven joint starts \[-1 to 1\].
    pub start_share: f64,
    /// Held until then \[s\].
    pub release_s: f64,
    /// Column `drive` says so.
    pub drive_column: bool,
    /// Held back from the fit.
    pub validate: bool,
    pub load: Option<Extra>,
    /// Setpoints of a driven log: instants \[s\] and values \[rad\].
    pub changes: Option<Vec<(f64, f64)>>,
}

impl LogPlan {
    /// Whether a motor drives it.
    pub(super) fn is_driven(&self) -> bool {
        self.changes.is_some()
    }

    /// Index of the first sample after the release.
    pub(super) fn first_free(&self) -> usize {
        self.times_s.partition_point(|t| *t < self.release_s)
    }
}

/// Which logs a motor drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Driven {
    None,
    /// Two to four.
    Some,
    All,
}

/// Draws the logs of a study.
pub(super) fn plan(joint: &Joint, driven: Driven, dice: &mut Dice) -> Vec<LogPlan> {
    let count = dice.whole(5, 9);
    let driven = match driven {
        Driven::None => 0,
        Driven::Some => dice.whole(2, 4).min(count - 2),
        Driven::All => count,
    };
    let extras = extras(joint, dice);
    let held_first = dice.chance(0.4);
    let drive_column = dice.chance(0.5);
    let mut logs: Vec<LogPlan> = (0..count)
        .map(|i| {
            let is_driven = i < driven;
            let period = joint.sensor.period_s;
            let samples = (dice.uniform(3.0, 8.0) / period).round() as usize;
            let times_s: Vec<f64> =
                (0..samples).map(|k| joint.sensor.comes_s(significant(k as f64 * period, 9), dice)).collect();
            let hung = if is_driven { 0.2 } else { 0.6 };
            let load = if !extras.is_empty() && dice.chance(hung) { Some(dice.pick(&extras)) } else { None };
            let peak_nm = joint.peak_gravity_nm() + load.map_or(0.0, |extra| extra.load().peak_gravity_nm);
            let changes = is_driven.then(|| motion(joint, &times_s, dice));
            // a joint that is let go must not stay where it is
            let sticks_rad = math::asin((1.3 * joint.coulomb_nm / peak_nm).clamp(0.0, 0.8));
            let start_rad = dice.sign() * dice.uniform((0.25 + sticks_rad).max(0.4), 2.0);
            let release_s = if held_first && !is_driven { dice.uniform(0.2, 0.6) } else { 0.0 };
            LogPlan {
                times_s,
                start_rad: if is_driven { 0.0 } else { start_rad },
                start_rad_s: 0.0,
                start_share: dice.uniform(-0.5, 0.5),
                release_s,
                drive_column: drive_column && held_first && !is_driven,
                validate: false,
                load,
                changes,
            }
        })
        .collect();
    hold_back(&mut logs, driven, dice);
    // driven logs stand anywhere among the others
    let order = dice.some_of(logs.len(), logs.len());
    order.into_iter().map(|i| logs[i].clone()).collect()
}

/// Lets every free log go from the same side.
pub(super) fn one_sided(logs: &mut [LogPlan], side: f64) {
    for log in logs.iter_mut().filter(|log| !log.is_driven()) {
        log.start_rad = side * log.start_rad.abs();
    }
}

/// Two logs are held back; of a study with free and driven logs one of each.
fn hold_back(logs: &mut [LogPlan], driven: usize, dice: &mut Dice) {
    let free = logs.len() - driven;
    let mut held: Vec<usize> = Vec::new();
    if driven > 0 && free > 0 {
        held.push(dice.whole(0, driven - 1));
        held.push(driven + dice.whole(0, free - 1));
    } else {
        held.extend(dice.some_of(2, logs.len()));
    }
    for i in held {
        logs[i].validate = true;
    }
}

/// None, one or two masses that add 0.3 to 1.5 of the link's moment.
fn extras(joint: &Joint, dice: &mut Dice) -> Vec<Extra> {
    let count = dice.pick(&[0, 1, 1, 2, 2]);
    (0..count)
        .map(|_| {
            let reach_m = joint.inertia_kg_m2 / joint.moment_kg_m;
            let distance_m = significant(reach_m * dice.uniform(0.5, 0.85), 3);
            let mass_kg = significant(dice.uniform(0.3, 1.5) * joint.moment_kg_m / distance_m, 3);
            Extra {
                mass_kg,
                distance_m,
                radius_m: significant(distance_m * dice.uniform(0.08, 0.2), 2),
                length_m: significant(distance_m * dice.uniform(0.15, 0.35), 2),
            }
        })
        .collect()
}
