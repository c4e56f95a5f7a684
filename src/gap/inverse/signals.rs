//! What every joint needs along the measured motion of all of them, by inverse dynamics.

use super::low_pass::LowPass;
use crate::identify::{ends_of_holes, smooth_along};
use crate::log::{JointColumns, RobotLog};
use crate::number::math;
use crate::robot::description::Description;
use crate::robot::tree::{Tree, TreeDynamics, TreeState};

/// Cutoff of the low pass that both sides go through \[Hz\]: above it torques of real joints are vibration and jitter of the
/// stamps, and arms that are moved to be identified have their motion below it.
const CUTOFF_HZ: f64 = 5.0;
/// Accelerations of readings are known up to this share of the sampling frequency.
const KNOWN: f64 = 0.05;
/// Filtered samples in a period of the cutoff frequency.
const KEPT: f64 = 5.0;
/// Filtered samples of a log at the most: of six minutes and longer fewer are kept.
const MOST_KEPT: usize = 9000;
/// A step by which an angle is moved to see what gravity makes of it \[rad\].
const NUDGE_RAD: f64 = 1e-5;
/// Stamps that stray by more than this share of the period are no grid.
const UNEVEN: f64 = 0.01;

/// Samples and time to either side of a hole in which a smoothed motion knows of both its ends.
const BESIDE_HOLE: f64 = 3.0;
const BESIDE_HOLE_S: f64 = 0.02;

/// Even samples of one log.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    pub t_s: Vec<f64>,
    pub period_s: f64,
    /// Whether the log's own stamps are uneven, so that readings lie between samples.
    pub is_resampled: bool,
    /// Samples of which nothing is known, in holes of the log and beside them.
    pub is_hole: Vec<bool>,
    cutoff_hz: f64,
    filter: LowPass,
    stride: usize,
}

impl Grid {
    /// `cutoff_hz` is that of all logs.
    pub fn new(log: &RobotLog, cutoff_hz: f64) -> Self {
        let period_s = period_s(log);
        let (start, end) = (log.t_s[0], log.t_s[log.len() - 1]);
        let count = ((end - start) / period_s).round() as usize + 1;
        let t_s: Vec<f64> = (0..count).map(|k| start + period_s * k as f64).collect();
        let uneven = |(k, t): (usize, &f64)| (t - start - period_s * k as f64).abs() > UNEVEN * period_s;
        let stride = ((1.0 / (KEPT * cutoff_hz * period_s)).floor() as usize).max(count / MOST_KEPT).max(1);
        Self {
            is_hole: in_holes(&log.t_s, &t_s, (BESIDE_HOLE * period_s).max(BESIDE_HOLE_S)),
            is_resampled: count != log.len() || log.t_s.iter().enumerate().any(uneven),
            t_s,
            period_s,
            cutoff_hz,
            filter: LowPass::new(cutoff_hz, period_s),
            stride,
        }
    }

    /// What of a signal passes if all of it is as white as its quietest octave above the cutoff.
    fn white(&self, signal: &[f64]) -> f64 {
        let above = |times: f64| LowPass::new(times * self.cutoff_hz, self.period_s).both_ways(signal);
        let [two, four, eight] = [2.0, 4.0, 8.0].map(above);
        let density = |a: &[f64], b: &[f64], octave: f64| {
            let cut = self.filter.settling().min(a.len() / 3);
            let inner = a.iter().zip(b).skip(cut).take(a.len() - 2 * cut);
            inner.clone().map(|(a, b)| (a - b).powi(2)).sum::<f64>() / (inner.count().max(1) as f64 * octave)
        };
        density(&two, &four, 2.0).min(density(&four, &eight, 4.0)).sqrt()
    }

    /// Root of the mean square of what a time that is known to a sample makes of a smooth signal.
    fn of_stamps(&self, smooth: &[f64]) -> f64 {
        let squares: f64 = (0..smooth.len()).map(|k| self.slope(smooth, k).powi(2)).sum();
        self.period_s / 12.0_f64.sqrt() * (squares / smooth.len().max(1) as f64).sqrt()
    }

    /// Acceleration that passes of an encoder that rounds to steps of one radian \[rad/s^2\]: its noise is white.
    fn encoder_unit(&self) -> f64 {
        let density = 2.0 * self.period_s / 12.0;
        (2.0 * std::f64::consts::PI).powi(2) * (density * self.cutoff_hz.powi(5) / 5.0).sqrt()
    }

    /// Samples that count for one, because the low pass ties them together.
    pub fn tied(&self) -> f64 {
        (1.0 / (2.0 * self.cutoff_hz * self.period_s * self.stride as f64)).max(1.0)
    }

    /// A column of the log on the grid.
    fn of(&self, log: &RobotLog, column: &[f64]) -> Vec<f64> {
        if !self.is_resampled {
            return column.to_vec();
        }
        let mut after = 1;
        let value = |t: &f64| {
            while after + 1 < log.len() && log.t_s[after] < *t {
                after += 1;
            }
            let [from, to] = [log.t_s[after - 1], log.t_s[after]];
            let share = ((t - from) / (to - from)).clamp(0.0, 1.0);
            column[after - 1] + share * (column[after] - column[after - 1])
        };
        self.t_s.iter().map(value).collect()
    }

    /// A column of the log on the grid, late by some time.
    pub fn late(&self, log: &RobotLog, column: &[f64], late_s: f64) -> Vec<f64> {
        let own = self.of(log, column);
        let samples = late_s / self.period_s;
        let at = |k: usize| {
            let place = (k as f64 - samples).clamp(0.0, (own.len() - 1) as f64);
            let from = (place.floor() as usize).min(own.len().saturating_sub(2));
            own[from] + (place - from as f64) * (own[(from + 1).min(own.len() - 1)] - own[from])
        };
        (0..own.len()).map(at).collect()
    }

    /// Slope of a column on the grid.
    pub fn slope(&self, column: &[f64], k: usize) -> f64 {
        let (from, to) = (k.saturating_sub(1), (k + 1).min(column.len() - 1));
        (column[to] - column[from]) / (self.period_s * (to - from).max(1) as f64)
    }

    /// A signal after the low pass.
    pub fn smooth(&self, signal: &[f64]) -> Vec<f64> {
        self.filter.both_ways(signal)
    }

    /// Of a smooth signal those samples that are compared: away from the ends, and no more than it has to say.
    pub fn kept(&self, smooth: &[f64]) -> Vec<f64> {
        let cut = self.filter.settling();
        let to = smooth.len().saturating_sub(cut);
        smooth.get(cut..to).unwrap_or_default().iter().copied().step_by(self.stride).collect()
    }

    /// Both.
    pub fn passed(&self, signal: &[f64]) -> Vec<f64> {
        self.kept(&self.smooth(signal))
    }
}

/// Which instants lie in holes of a log, or so near to one \[s\].
fn in_holes(log_s: &[f64], at_s: &[f64], near_s: f64) -> Vec<bool> {
    let mut is_hole = vec![false; at_s.len()];
    for end_s in ends_of_holes(log_s) {
        let begin_s = log_s[log_s.partition_point(|t| *t < end_s).saturating_sub(1)];
        let from = at_s.partition_point(|t| *t < begin_s - near_s);
        let to = at_s.partition_point(|t| *t <= end_s + near_s);
        is_hole[from..to].fill(true);
    }
    is_hole
}

/// The middle of a log's steps \[s\].
fn period_s(log: &RobotLog) -> f64 {
    let mut steps: Vec<f64> = log.t_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = steps.len() / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The cutoff for a study's logs \[Hz\].
pub(super) fn cutoff_hz(logs: &[RobotLog]) -> f64 {
    logs.iter().map(|log| KNOWN / period_s(log)).fold(CUTOFF_HZ, f64::min)
}

/// One joint along one log, on its grid.
#[derive(Clone, Debug)]
pub(super) struct Signals {
    pub angle_rad: Vec<f64>,
    pub rate_rad_s: Vec<f64>,
    pub acceleration_rad_s2: Vec<f64>,
    /// What accelerations and rates of all links ask for, no armature \[N m\].
    pub inertial_nm: Vec<f64>,
    /// What holds it up \[N m\].
    pub gravity_nm: Vec<f64>,
    /// What holds the joint against the spring that it is described with \[N m\].
    pub spring_nm: Vec<f64>,
    /// How both change with the joint's own angle \[N m/rad\].
    pub slope_nm_rad: Vec<f64>,
    /// `M_jj` of the links, mean over the log \[kg m^2\].
    pub own_inertia_kg_m2: f64,
    /// Torque of the drive after the low pass \[N m\]; `None` where the log has none of this joint.
    pub torque_nm: Option<Vec<f64>>,
    /// What nobody knows better \[N m\]: what the reading of the torque and the encoder's step leave below the cutoff at the
    /// most, if it is white, and what stamps that are known to a sample make of the torque.
    pub noise_nm: f64,
    /// Below this rate the joint may be at rest \[rad/s\].
    pub resting_rad_s: f64,
}

/// The motion of a robot along a log, as generalised coordinates.
#[derive(Clone, Debug)]
pub(super) struct Motion {
    pub grid: Grid,
    /// Of each joint of the tree: angle, rate, acceleration at each sample; `None`: it stands as drawn.
    joints: Vec<Option<Vec<[f64; 3]>>>,
}

impl Motion {
    pub fn new(tree: &Tree, log: &RobotLog, cutoff_hz: f64) -> Self {
        let grid = Grid::new(log, cutoff_hz);
        let smooth = |joint: &JointColumns| smooth_along(&grid.t_s, &grid.of(log, &joint.q_rad));
        let joints = tree.joint_names().map(|name| log.joint(name).map(smooth)).collect();
        Self { grid, joints }
    }

    /// Calls `see` with the state and the accelerations at each sample.
    pub fn walk(&self, tree: &Tree, mut see: impl FnMut(&TreeState, &[f64])) {
        let mut state = TreeState::drawn(tree);
        let mut acceleration = vec![0.0; self.joints.len()];
        for k in 0..self.grid.t_s.len() {
            for (j, motion) in self.joints.iter().enumerate() {
                if let Some(motion) = motion {
                    [state.position[j], state.rate[j], acceleration[j]] = motion[k];
                }
            }
            see(&state, &acceleration);
        }
    }

    /// The generalised forces that the motion asks for of a tree, joint by joint.
    pub fn needed(&self, tree: &Tree) -> Vec<Vec<f64>> {
        let mut dynamics = TreeDynamics::new(tree);
        let mut needed = vec![0.0; self.joints.len()];
        let mut all = vec![Vec::with_capacity(self.grid.t_s.len()); self.joints.len()];
        self.walk(tree, |state, acceleration| {
            dynamics.inverse(state, acceleration, &mut needed);
            all.iter_mut().zip(&needed).for_each(|(column, value): (&mut Vec<f64>, _)| column.push(*value));
        });
        all
    }

    /// Every joint of the tree; `bare` is the tree of the description without armatures. `None` for joints that the log does not
    /// show.
    pub fn signals(
        &self,
        (description, bare): (&Description, &Tree),
        log: &RobotLog,
        torque_of: &TorqueOf<'_>,
    ) -> Vec<Option<Signals>> {
        let joints = self.joints.len();
        let needed = self.needed(bare);
        let mut dynamics = TreeDynamics::new(bare);
        let (mut level, mut turned) = (vec![0.0; joints], vec![0.0; joints]);
        let (mut gravity, mut slope) = (vec![Vec::new(); joints], vec![Vec::new(); joints]);
        let mut inertia = vec![0.0; joints];
        let mut matrix = nalgebra::DMatrix::zeros(joints, joints);
        self.walk(bare, |state, _| {
            let mut still = state.clone();
            still.rate.fill(0.0);
            dynamics.bias(&still, &mut level);
            dynamics.rigid_mass_matrix(&still, &mut matrix);
            for j in 0..joints {
                let angle = still.position[j];
                still.position[j] = angle + NUDGE_RAD;
                dynamics.bias(&still, &mut turned);
                still.position[j] = angle;
                gravity[j].push(level[j]);
                slope[j].push((turned[j] - level[j]) / NUDGE_RAD);
                inertia[j] += matrix[(j, j)] / self.grid.t_s.len() as f64;
            }
        });
        let names: Vec<&str> = bare.joint_names().collect();
        let signals = |j: usize| {
            let motion = self.joints[j].as_ref()?;
            let columns = log.joint(names[j])?;
            let of = |k: usize| motion.iter().map(|now| now[k]).collect::<Vec<f64>>();
            let [angle_rad, rate_rad_s, acceleration_rad_s2] = [of(0), of(1), of(2)];
            let torque = torque_of(columns, &angle_rad, &rate_rad_s, &self.grid);
            let mover = &description.joints[bare.joints()[j].0];
            let stiffness_nm_rad = mover.stiffness[0];
            let step_rad = step_rad(columns);
            let of_encoder = inertia[j] * step_rad * self.grid.encoder_unit();
            let torque = torque.map(|torque| (self.grid.white(&torque), self.grid.smooth(&torque)));
            let noise = |(white, torque): &(f64, Vec<f64>)| math::hypot(*white, self.grid.of_stamps(torque));
            Some(Signals {
                noise_nm: math::hypot(torque.as_ref().map_or(0.0, noise), of_encoder),
                resting_rad_s: resting_rad_s(step_rad, &rate_rad_s, self.grid.period_s),
                spring_nm: angle_rad.iter().map(|angle| stiffness_nm_rad * (angle - mover.spring_rest_rad)).collect(),
                angle_rad,
                rate_rad_s,
                acceleration_rad_s2,
                inertial_nm: needed[j].iter().zip(&gravity[j]).map(|(all, gravity)| all - gravity).collect(),
                gravity_nm: gravity[j].clone(),
                slope_nm_rad: slope[j].iter().map(|of_gravity| of_gravity + stiffness_nm_rad).collect(),
                own_inertia_kg_m2: inertia[j],
                torque_nm: torque.map(|(_, torque)| torque),
            })
        };
        (0..joints).map(signals).collect()
    }
}

/// The torque that a joint's drive gave along a log, on its grid; `None` where nobody knows.
pub(super) type TorqueOf<'a> = dyn Fn(&JointColumns, &[f64], &[f64], &Grid) -> Option<Vec<f64>> + 'a;

/// The logged torque.
pub(super) fn logged<'a>(log: &'a RobotLog) -> Box<TorqueOf<'a>> {
    Box::new(|columns, _, _, grid| columns.tau_nm.as_ref().map(|torque| held(&grid.of(log, torque))))
}

/// The smallest step of an encoder \[rad\]; 0 where it never moves.
fn step_rad(columns: &JointColumns) -> f64 {
    let steps = columns.q_rad.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let step_rad = steps.filter(|step| *step > 0.0).fold(f64::INFINITY, f64::min);
    if step_rad.is_finite() { step_rad } else { 0.0 }
}

/// What an encoder's step looks like as a rate, and no less than a thousandth of the fastest.
fn resting_rad_s(step_rad: f64, rate_rad_s: &[f64], period_s: f64) -> f64 {
    const WINDOW_S: f64 = 0.04;
    const WINDOW_SAMPLES: f64 = 6.0;
    let fastest = rate_rad_s.iter().fold(0.0_f64, |most, rate| most.max(rate.abs()));
    (step_rad / WINDOW_S.max(WINDOW_SAMPLES * period_s)).max(1e-3 * fastest)
}

/// A torque that is held from each sample to the next, about the samples.
fn held(torque: &[f64]) -> Vec<f64> {
    (0..torque.len()).map(|k| 0.5 * (torque[k] + torque[k.saturating_sub(1)])).collect()
}

/// A description whose joints have no armature.
pub(super) fn without_armature(description: &Description) -> Description {
    let mut bare = description.clone();
    bare.joints.iter_mut().for_each(|joint| joint.armature_kg_m2 = 0.0);
    bare
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::tree::TreeBase;
    use std::path::Path;

    #[test]
    fn holes_and_what_is_beside_them_are_not_known() {
        let even: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k)).collect();
        let log_s: Vec<f64> = even.iter().filter(|t| !(0.505..1.495).contains(*t)).copied().collect();
        let is_hole = in_holes(&log_s, &even, 0.035);
        assert_eq!(is_hole.iter().filter(|is_hole| **is_hole).count(), 107);
        assert!(is_hole[47] && !is_hole[46] && is_hole[153] && !is_hole[154]);
        assert!(in_holes(&even, &even, 0.035).iter().all(|is_hole| !is_hole));
    }

    #[test]
    fn a_described_spring_is_held_against_with_a_torque_of_its_own() {
        let description = Description::read(Path::new("data/examples/robots/three-link.toml")).unwrap();
        let tree = Tree::new(&description, TreeBase::Fixed).unwrap();
        let wrist = tree.joint_names().position(|name| name == "wrist").unwrap();
        let t_s: Vec<f64> = (0..400).map(|k| 0.01 * f64::from(k)).collect();
        let q_rad = t_s.iter().map(|t| 0.4 * (2.0 * t).sin()).collect();
        let joint = JointColumns { name: "wrist".to_owned(), q_rad, ..JointColumns::default() };
        let log = RobotLog {
            file: "made".into(),
            t_s,
            joints: vec![joint],
            base: None,
            acceleration_m_s2: None,
            ignored_columns: Vec::new(),
            notes: Vec::new(),
        };
        let motion = Motion::new(&tree, &log, 5.0);
        let mut free = description.clone();
        free.joints.iter_mut().for_each(|joint| joint.stiffness = [0.0; 3]);
        let [sprung, free] = [&description, &free]
            .map(|description| motion.signals((description, &tree), &log, &|_, _, _, _| None)[wrist].clone().unwrap());
        for k in [50, 150, 250] {
            assert!((sprung.spring_nm[k] - 0.5 * sprung.angle_rad[k]).abs() < 1e-12 && free.spring_nm[k] == 0.0);
            assert!((sprung.slope_nm_rad[k] - free.slope_nm_rad[k] - 0.5).abs() < 1e-12);
        }
    }
}
