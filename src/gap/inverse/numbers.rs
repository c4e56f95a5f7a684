//! What is believed of a joint along a measured motion, and what its torque is made of.

use super::signals::{Grid, Signals};
use super::system::Unknown;
use crate::identify::Deviations;

/// Which number of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Which {
    /// Of the links, and with it all that accelerations and rates ask for.
    Inertia,
    /// Of the links: gravity.
    Moment,
    /// Of rotor and gears.
    Armature,
    Coulomb,
    Viscous,
    /// Torque that arrives per torque that is logged.
    Gain,
}

impl Which {
    pub const ALL: [Self; 6] = [Self::Inertia, Self::Moment, Self::Armature, Self::Coulomb, Self::Viscous, Self::Gain];

    /// Name, letter, unit.
    pub fn words(self) -> [&'static str; 3] {
        match self {
            Self::Inertia => ["inertia", "I*", "kg m^2"],
            Self::Moment => ["moment", "M*", "kg m"],
            Self::Armature => ["armature", "I_a", "kg m^2"],
            Self::Coulomb => ["coulomb", "mu_c", "N m"],
            Self::Viscous => ["viscous", "mu_v", "N m s/rad"],
            Self::Gain => ["gain", "c", ""],
        }
    }
}

/// Values of a joint's numbers, in the order of [`Which::ALL`].
pub(super) type Values = [f64; 6];

/// What a joint's study and description say of it.
#[derive(Clone, Debug)]
pub(super) struct Believed {
    pub values: Values,
    /// Standard deviations; 0: exact.
    pub sd: Values,
}

/// Relative standard deviations by number, in the order of [`Which::ALL`].
pub(super) fn believed(values: Values, relative: Values, largest_nm: f64, fastest_rad_s: f64) -> Believed {
    let mut sd = values;
    sd.iter_mut().zip(relative).for_each(|(sd, share)| *sd *= share);
    let least_nm = Deviations::LEAST_FRICTION * largest_nm;
    let friction = |k: usize, least: f64| Deviations::of_friction(relative[k], values[k], least);
    sd[3] = friction(3, least_nm);
    sd[4] = friction(4, least_nm / fastest_rad_s.max(f64::MIN_POSITIVE));
    Believed { values, sd }
}

impl Believed {
    /// A number counted from its belief, as an unknown.
    pub fn unknown(&self, which: Which) -> Unknown {
        // Nothing of a joint is negative, and a drive that gives half or twice its torque is another one.
        let value = self.values[which as usize];
        let bounds = if which == Which::Gain { [-0.5, 1.0] } else { [-value, f64::INFINITY] };
        Unknown { sd: self.sd[which as usize], bounds }
    }

    /// Whether the logs may move a number.
    pub fn is_free(&self, which: Which) -> bool {
        self.sd[which as usize] > 0.0
    }
}

/// A joint's torque along a log for values of its numbers, after the low pass and on the whole grid.
#[derive(Clone, Debug)]
pub(super) struct Asked {
    /// What the motion asks for, friction and all, as the drive's own column would tell it \[N m\].
    pub all_nm: Vec<f64>,
    /// The same before the low pass.
    pub raw_nm: Vec<f64>,
    /// The direction of the motion. Not filtered.
    pub used: Vec<f64>,
    /// Where the joint is at rest, or nothing is known of it: friction may be anything between plus and minus Coulomb's, so
    /// the drive's torque is the right one. (Whoever would count the torques beyond it would let friction grow to hide turning
    /// points.)
    pub is_held: Vec<bool>,
}

/// Shares of inertia and moment that values have of what was believed.
pub(super) fn shares(values: &Values, believed: &Believed) -> [f64; 2] {
    let share = |k: usize| if believed.values[k] > 0.0 { values[k] / believed.values[k] } else { 1.0 };
    [share(Which::Inertia as usize), share(Which::Moment as usize)]
}

impl Asked {
    pub fn new(signals: &Signals, grid: &Grid, values: &Values, believed: &Believed) -> Self {
        let [of_inertia, of_moment] = shares(values, believed);
        let [_, _, armature, coulomb_nm, viscous, gain] = *values;
        let n = signals.angle_rad.len();
        let rigid = |k: usize| {
            of_inertia * signals.inertial_nm[k]
                + of_moment * signals.gravity_nm[k]
                + signals.spring_nm[k]
                + armature * signals.acceleration_rad_s2[k]
        };
        let used: Vec<f64> = signals.rate_rad_s.iter().map(|rate| rate.signum()).collect();
        let rests = |rate: &f64| rate.abs() <= signals.resting_rad_s;
        let is_held = signals.rate_rad_s.iter().zip(&grid.is_hole).map(|(rate, is_hole)| *is_hole || rests(rate));
        let is_held: Vec<bool> = is_held.collect();
        let friction = |k: usize| used[k] * coulomb_nm + viscous * signals.rate_rad_s[k];
        let given = |k: usize| signals.torque_nm.as_ref().map_or(0.0, |torque| torque[k]);
        let all = |k: usize| if is_held[k] { given(k) } else { (rigid(k) + friction(k)) / gain };
        let raw_nm: Vec<f64> = (0..n).map(all).collect();
        Self { all_nm: grid.smooth(&raw_nm), raw_nm, used, is_held }
    }
}
