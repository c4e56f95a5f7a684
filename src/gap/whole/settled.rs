//! The whole robot with the numbers at which it follows its logs best, within what is believed of them: masses, friction,
//! gains and what turns with the motors, and the sizes of causes, by steps of Gauss and Newton with all joints simulated at
//! once.
//!
//! Along the measured motion alone the joints' pushes on one another are known no better than the readings' second
//! derivatives and the described masses: a joint that no cause explains there may be explained here.

use super::robot::{PlacedCause, Stretch, WholeRobot};
use super::unknown::{Quantity, Unknown, believed, is_body};
use crate::deadline::Deadline;
use crate::fit::correlation_length;
use crate::gap::clamped::{BODY_OPEN, ClampedSetup};
use crate::gap::told::AtBest;
use crate::identify::best_window;
use crate::joint::EffectId;
use crate::log::{DriveMode, JointColumns, RobotLog, Role};
use crate::number::chance::HALF_95;
use crate::robot::description::{FoundKey, FoundNumber};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use rayon::prelude::*;

/// Time of all fitted logs that steps are told by \[s\], and steps of the simulation \[s\].
const SIMULATED_S: f64 = 45.0;
const STEP_S: f64 = 2e-3;
/// Points about which the robot is made linear at most, steps from each, and halvings of one that explains less.
const POINTS: usize = 5;
const STEPS: usize = 4;
const HALVINGS: i32 = 3;
/// A step that gains less than this share is the last of a point, and a point that does is the last.
const WORTH_A_STEP: f64 = 0.1;
const DONE: f64 = 5e-3;
/// A robot that leaves so many times the noise and gains less than the share is not this one.
const HOPELESS: f64 = 5.0;
const GETS_THERE: f64 = 0.5;
/// Change of a number to either side for what it does, in its standard deviations: what scales masses, gains and friction
/// together changes nothing, and is seen to change nothing only where each of them is told well.
const NUDGE: f64 = 0.05;
/// Nobody reads angles better than this \[rad\].
const LEAST_NOISE_RAD: f64 = 1e-4;
/// A joint that goes less far does not move \[rad\].
const MOVES_RAD: f64 = 0.01;

/// The whole robot at its best.
pub(in crate::gap) struct Settled {
    /// Numbers of its description.
    pub numbers: Vec<FoundNumber>,
    /// Its causes; spreads are standard deviations of their values.
    pub causes: Vec<PlacedCause>,
    /// Standard deviations of the mass of a body that was found, where it hangs on a link \[kg\], and of its place \[m\]; `None`
    /// where the logs do not tell.
    pub body_sd: Vec<Option<f64>>,
    /// Root of the mean square that it leaves of each joint that moves, on held-out logs where these show that \[rad\].
    pub left_rad: Vec<(String, f64)>,
}

impl Settled {
    /// Its masses.
    pub fn masses(&self) -> Vec<FoundNumber> {
        self.numbers.iter().filter(|number| number.key == FoundKey::Mass).cloned().collect()
    }

    /// Its masses, and numbers of its joints but for what is told as causes: they go together.
    pub fn numbers_but_causes(&self) -> Vec<FoundNumber> {
        use FoundKey::{Armature, Damping, Frictionloss, Kd, Kp, Mass};
        let is_told = |number: &&FoundNumber| matches!(number.key, Mass | Frictionloss | Damping | Armature | Kp | Kd);
        self.numbers.iter().filter(is_told).cloned().collect()
    }

    /// Causes of a joint.
    pub fn causes_of(&self, joint: &str) -> Vec<AtBest> {
        let own = self.causes.iter().filter(|cause| cause.joint == joint);
        own.map(|cause| AtBest {
            form: cause.form,
            values: cause.values.iter().copied().zip(cause.spreads.iter().copied()).collect(),
        })
        .collect()
    }

    /// What it leaves of a joint \[rad\].
    pub fn left_rad(&self, joint: &str) -> Option<f64> {
        self.left_rad.iter().find(|(name, _)| name == joint).map(|(_, left)| *left)
    }
}

/// The robot at its best with causes, from `numbers` on; `None` where no log is driven by setpoints, nothing is uncertain,
/// a joint has free play, in which it would hunt, or the robot runs away.
pub(in crate::gap) fn settled(
    setup: &ClampedSetup,
    numbers: &[FoundNumber],
    causes: &[PlacedCause],
    deadline: &Deadline,
) -> Option<Settled> {
    if causes.iter().any(|cause| cause.form.id == EffectId::Backlash) {
        return None;
    }
    let bench = Bench::new(setup, numbers, causes)?;
    let mut here = bench.point(bench.unknowns.iter().map(|unknown| unknown.size_in(numbers)).collect())?;
    for _ in 0..POINTS {
        if deadline.leaves_out("the whole robot at its best") {
            break;
        }
        let Some(slopes) = bench.slopes(&here) else { break };
        let before = slopes.price(&here);
        for _ in 0..STEPS {
            let Some((there, gained)) = bench.stepped(&here, &slopes) else { break };
            here = there;
            if gained < WORTH_A_STEP {
                break;
            }
        }
        let gained = 1.0 - slopes.price(&here) / before;
        if gained < DONE || gained < GETS_THERE && bench.is_hopeless(&here) {
            break;
        }
    }
    bench.settled(&here)
}

/// What a robot leaves of its logs.
struct Point {
    /// In standard deviations of the unknowns.
    sizes: Vec<f64>,
    /// Measured less simulated \[rad\], joint by joint of log by log.
    left: Vec<Vec<f64>>,
    /// How well the sizes are known, as told where the last step began; 1 before any.
    sd: Vec<f64>,
}

/// A robot made linear about a point.
struct Slopes {
    /// What one standard deviation of each unknown changes \[rad\]; `None` where the robot runs away.
    columns: Vec<Option<Vec<Vec<f64>>>>,
    /// One over the variance of each row.
    weights: Vec<f64>,
    factors: Cholesky<f64, Dyn>,
    /// How well the unknowns are known.
    sd: Vec<f64>,
}

impl Slopes {
    /// What a point leaves, and what it asks of the beliefs.
    fn price(&self, point: &Point) -> f64 {
        dot(&self.weights, &point.left, &point.left) + point.sizes.iter().map(|size| size * size).sum::<f64>()
    }
}

/// What the unknowns are tried on.
struct Bench<'a> {
    setup: &'a ClampedSetup,
    logs: Vec<&'a RobotLog>,
    unknowns: Vec<Unknown>,
    /// Those that are not uncertain.
    others: Vec<FoundNumber>,
    /// Bodies that were found, where they were.
    bodies: Vec<FoundNumber>,
    causes: &'a [PlacedCause],
}

impl<'a> Bench<'a> {
    fn new(setup: &'a ClampedSetup, numbers: &[FoundNumber], causes: &'a [PlacedCause]) -> Option<Self> {
        let logs = driven(setup, |role| role != Role::Validate);
        let mut unknowns = believed(setup, &logs, numbers);
        let values = causes.iter().enumerate().flat_map(|(cause, placed)| {
            let each = placed.values.iter().zip(&placed.spreads).enumerate();
            each.map(move |(value, (was, sd))| (Quantity::Value { cause, value }, *was, *sd))
        });
        let known = values.filter(|(_, _, sd)| *sd > 0.0);
        unknowns.extend(known.map(|(quantity, was, sd)| Unknown { quantity, was, centre: was, sd }));
        if logs.is_empty() || unknowns.is_empty() {
            return None;
        }
        let is_unknown = |number: &FoundNumber| {
            unknowns.iter().any(|unknown| match &unknown.quantity {
                Quantity::Number { key, name, .. } => *key == number.key && *name == number.name,
                Quantity::Body { .. } | Quantity::Value { .. } => false,
            })
        };
        let known = numbers.iter().filter(|number| !is_unknown(number)).cloned();
        let (bodies, others) = known.partition(is_body);
        Some(Self { setup, logs, unknowns, others, bodies, causes })
    }

    /// The robot where the unknowns have these sizes, known so well.
    fn robot(&self, sizes: &[f64], sd: &[f64]) -> (Vec<FoundNumber>, Vec<PlacedCause>) {
        let (mut numbers, mut causes) = (self.others.clone(), self.causes.to_vec());
        let mut bodies = self.bodies.clone();
        for (unknown, (size, sd)) in self.unknowns.iter().zip(sizes.iter().zip(sd)) {
            let at = |size: f64| unknown.at(size);
            match &unknown.quantity {
                Quantity::Number { key, name, unit } => numbers.push(FoundNumber {
                    name: name.clone(),
                    key: *key,
                    was: Some(unknown.was),
                    value: at(*size).max(0.0),
                    interval: Some([-HALF_95, HALF_95].map(|side| at(size + side * sd).max(0.0))),
                    unit: (*unit).to_owned(),
                    place_m: None,
                }),
                Quantity::Body { key, name, axis } => {
                    let own = bodies.iter_mut().filter(|body| body.key == *key && body.name == *name);
                    own.for_each(|body| match (axis, &mut body.place_m) {
                        (None, _) => {
                            body.value = at(*size);
                            body.interval = Some([-HALF_95, HALF_95].map(|side| at(size + side * sd).max(0.0)));
                        }
                        (Some(axis), Some(place_m)) => place_m[*axis] = at(*size),
                        (Some(_), None) => {}
                    });
                }
                Quantity::Value { cause, value } => {
                    causes[*cause].values[*value] = at(*size);
                    causes[*cause].spreads[*value] = sd * unknown.sd;
                }
            }
        }
        // What hangs on a link comes after the link's own mass.
        numbers.extend(bodies);
        (numbers, causes)
    }

    fn point(&self, sizes: Vec<f64>) -> Option<Point> {
        let sd = vec![1.0; sizes.len()];
        let (numbers, causes) = self.robot(&sizes, &sd);
        let mut robot = WholeRobot::of(self.setup, &numbers, &causes).ok()?;
        let left = self.left(&mut robot, &self.logs, SIMULATED_S / self.logs.len() as f64)?;
        Some(Point { sizes, left, sd })
    }

    /// Measured less simulated of every joint of logs, up to so long after their start \[rad, s\].
    fn left(&self, robot: &mut WholeRobot, logs: &[&RobotLog], until_s: f64) -> Option<Vec<Vec<f64>>> {
        let mut left: Vec<Vec<f64>> = Vec::new();
        for log in logs {
            let period_s = (log.t_s[log.len() - 1] - log.t_s[0]) / (log.len() - 1) as f64;
            let until_s = log.t_s[0] + until_s;
            let recording = robot.motion(self.setup, log, &Stretch { period_s, step_s: STEP_S, until_s }).ok()?;
            let samples = log.t_s.partition_point(|t| *t <= until_s);
            let of_joint = |(joint, read): (&JointColumns, Vec<f64>)| {
                joint.q_rad.iter().zip(read).take(samples).map(|(measured, read)| measured - read).collect()
            };
            left.extend(log.joints.iter().zip(robot.read(&recording, log).ok()?).map(of_joint));
        }
        left.iter().flatten().all(|left: &f64| left.is_finite()).then_some(left)
    }

    /// One over the variance of each row: what it leaves is taken as its noise.
    fn weights(&self, left: &[Vec<f64>]) -> Vec<f64> {
        let rounding_rad = self.setup.study.sensor.resolution_rad.map_or(0.0, |step| step / 12f64.sqrt());
        let least = rounding_rad.max(LEAST_NOISE_RAD).powi(2);
        left.iter().map(|row| mean_square(row).max(least).recip()).collect()
    }

    /// The robot made linear about a point.
    fn slopes(&self, here: &Point) -> Option<Slopes> {
        let n = self.unknowns.len();
        let column = |k: usize| -> Option<Vec<Vec<f64>>> {
            let nudged = |by: f64| {
                let mut sizes = here.sizes.clone();
                sizes[k] += by;
                Some(self.point(sizes)?.left)
            };
            let down = here.sizes[k] - NUDGE;
            let low = if self.unknowns[k].within(down) > down { 0.0 } else { -NUDGE };
            let (less, more) = (nudged(low)?, nudged(NUDGE)?);
            let rows = less.iter().zip(more);
            Some(rows.map(|(a, b)| a.iter().zip(b).map(|(a, b)| (a - b) / (NUDGE - low)).collect()).collect())
        };
        let columns: Vec<Option<Vec<Vec<f64>>>> = (0..n).into_par_iter().map(column).collect();
        let weights = self.weights(&here.left);
        let mut inner = DMatrix::identity(n, n);
        for (a, of_a) in columns.iter().enumerate() {
            for (b, of_b) in columns.iter().enumerate() {
                inner[(a, b)] += of_a.as_ref().zip(of_b.as_ref()).map_or(0.0, |(a, b)| dot(&weights, a, b));
            }
        }
        let factors = inner.cholesky()?;
        let sd = factors.inverse().diagonal().iter().map(|variance: &f64| variance.max(0.0).sqrt()).collect();
        Some(Slopes { columns, weights, factors, sd })
    }

    /// Goes to what is best to first order as far as that explains more, and by which share.
    fn stepped(&self, here: &Point, slopes: &Slopes) -> Option<(Point, f64)> {
        let asked = |(size, column): (&f64, &Option<Vec<Vec<f64>>>)| {
            column.as_ref().map_or(0.0, |column| dot(&slopes.weights, column, &here.left)) - size
        };
        let step = slopes
            .factors
            .solve(&DVector::from_iterator(here.sizes.len(), here.sizes.iter().zip(&slopes.columns).map(asked)));
        (0..=HALVINGS).find_map(|halving| {
            let share = 0.5_f64.powi(halving);
            let sizes = here.sizes.iter().zip(step.iter()).zip(&self.unknowns);
            let sizes = sizes.map(|((size, by), unknown)| unknown.within(size + share * by));
            let there = self.point(sizes.collect())?;
            let gained = 1.0 - slopes.price(&there) / slopes.price(here);
            (gained > 0.0).then(|| (Point { sd: slopes.sd.clone(), ..there }, gained))
        })
    }

    /// Whether what is left of the joints that move is much more than noise, which has no shape.
    fn is_hopeless(&self, here: &Point) -> bool {
        let joints = self.logs.iter().flat_map(|log| log.joints.iter().map(move |joint| (*log, joint)));
        let moving = joints.zip(&here.left).filter(|((_, joint), _)| moves(joint));
        let in_noise = |((log, _), left): ((&RobotLog, &JointColumns), &Vec<f64>)| {
            mean_square(left) / best_window(&log.t_s[..left.len()], left).1.max(LEAST_NOISE_RAD.powi(2))
        };
        let squares: Vec<f64> = moving.map(in_noise).collect();
        squares.iter().sum::<f64>() > HOPELESS * HOPELESS * squares.len() as f64
    }

    /// How many samples of what is left of joints that move stand for one, where it were white: rounding of a joint that hardly
    /// moves hangs together.
    fn correlation(&self, here: &Point) -> f64 {
        let joints = self.logs.iter().flat_map(|log| &log.joints).zip(&here.left);
        let lengths: Vec<f64> =
            joints.filter(|(joint, _)| moves(joint)).map(|(_, left)| correlation_length(left)).collect();
        lengths.iter().sum::<f64>() / lengths.len().max(1) as f64
    }

    fn settled(&self, here: &Point) -> Option<Settled> {
        let times = self.correlation(here).sqrt();
        let sd: Vec<f64> = here.sd.iter().map(|sd| (times * sd).min(1.0)).collect();
        let (numbers, causes) = self.robot(&here.sizes, &sd);
        let mut robot = WholeRobot::of(self.setup, &numbers, &causes).ok()?;
        let held_out = driven(self.setup, |role| role == Role::Validate);
        let mut rows: [Vec<(&str, Vec<f64>)>; 2] = Default::default();
        for (rows, logs) in rows.iter_mut().zip([&held_out, &self.logs]) {
            let left = self.left(&mut robot, logs, f64::INFINITY)?;
            let joints = logs.iter().flat_map(|log| &log.joints).zip(left);
            rows.extend(joints.filter(|(joint, _)| moves(joint)).map(|(joint, left)| (joint.name.as_str(), left)));
        }
        let of_joint = |name: &str| {
            let own = |rows: &[(&str, Vec<f64>)]| -> Vec<f64> {
                rows.iter().filter(|(of, _)| *of == name).flat_map(|(_, left)| left.clone()).collect()
            };
            let left = rows.iter().map(|rows| own(rows)).find(|left| !left.is_empty())?;
            Some((name.to_owned(), mean_square(&left).sqrt()))
        };
        let left_rad = self.setup.description.joints.iter().filter_map(|joint| of_joint(&joint.name)).collect();
        let of_body = self.unknowns.iter().zip(&sd).filter(|(own, _)| matches!(own.quantity, Quantity::Body { .. }));
        let body_sd = of_body.map(|(own, sd)| (*sd < BODY_OPEN).then_some(sd * own.sd)).collect();
        Some(Settled { numbers, causes, body_sd, left_rad })
    }
}

/// Whether a log shows a joint moving.
fn moves(joint: &JointColumns) -> bool {
    let (low, high) = joint.q_rad.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), q| (l.min(*q), h.max(*q)));
    high - low > MOVES_RAD
}

/// Rows times rows, each with its weight.
fn dot(weights: &[f64], a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let rows = weights.iter().zip(a.iter().zip(b));
    rows.map(|(weight, (a, b))| weight * a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>()).sum()
}

fn mean_square(values: &[f64]) -> f64 {
    values.iter().map(|value| value * value).sum::<f64>() / values.len().max(1) as f64
}

/// Logs that setpoints drive.
fn driven(setup: &ClampedSetup, is_asked: impl Fn(Role) -> bool) -> Vec<&RobotLog> {
    let entries = setup.study.logs.iter().zip(&setup.logs);
    let those = entries.filter(|(entry, _)| entry.drive == DriveMode::Position && is_asked(entry.role));
    those.map(|(_, log)| log).filter(|log| log.len() > 1).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::whole::as_stated_at_best;
    use crate::synth::{AnySpec, make_described};

    const ARM: &str = r#"<robot name="arm"><link name="base"/>
<link name="upper"><inertial><origin xyz="0.01 0 0.15"/><mass value="1.2"/>
  <inertia ixx="0.01" iyy="0.01" izz="0.002" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="lower"><inertial><origin xyz="0 0.01 0.1"/><mass value="0.6"/>
  <inertia ixx="0.003" iyy="0.003" izz="0.0005" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
  <dynamics damping="0.3" friction="0.2"/><limit lower="-2" upper="2" effort="40" velocity="8"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0 0 0.3"/><axis xyz="0 1 0"/>
  <dynamics damping="0.1" friction="0.06"/><limit lower="-2" upper="2" effort="20" velocity="8"/></joint>
</robot>"#;
    const SPEC: &str = r#"schema = 1
seed = 11
[robot]
model = "arm.urdf"
scenario = "fixed"
[joints.shoulder]
kp = 60.0
kd = 3.0
armature = 0.02
[joints.elbow]
kp = 20.0
kd = 0.8
armature = 0.005
[sensor]
period = 0.01
resolution = 0.0003
[truth]
scatter = 0.08
friction_scatter = 0.25
noise = 0.0004
method = "bdf"
tolerance = 1e-6
[[log]]
file = "log-00.csv"
gait = "sines"
role = "fit"
duration = 10.0
[[log]]
file = "log-01.csv"
gait = "sines"
role = "validate"
duration = 6.0
"#;

    /// Made by another integrator, with masses and friction that are off.
    #[test]
    fn a_sound_arm_at_its_best_leaves_noise_in_logs_that_no_step_saw() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("arm.urdf"), ARM).unwrap();
        let spec = AnySpec::from_toml(&folder.path().join("study.toml"), SPEC).unwrap();
        let AnySpec::Described(spec) = spec else { panic!("it has a clamped base") };
        for (name, text) in make_described(&spec, None).unwrap().files() {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        let setup = ClampedSetup::read(&folder.path().join("study.toml")).unwrap();
        let logs = driven(&setup, |role| role == Role::Validate);
        let bench = Bench::new(&setup, &[], &[]).unwrap();
        let (numbers, _) = bench.robot(&vec![0.0; bench.unknowns.len()], &vec![1.0; bench.unknowns.len()]);
        let mut stated = WholeRobot::of(&setup, &numbers, &[]).unwrap();
        let stated = bench.left(&mut stated, &logs, f64::INFINITY).unwrap();
        let best = as_stated_at_best(&setup, &Deadline::default()).unwrap();
        for (row, (joint, left_rad)) in stated.iter().zip(&best.left_rad) {
            let noise_rad = 0.0004_f64.hypot(0.0003 / 12f64.sqrt());
            assert!(*left_rad < 1.1 * noise_rad, "{joint}: {left_rad}");
            assert!(mean_square(row).sqrt() > 3.0 * noise_rad, "{joint}: {}", mean_square(row).sqrt());
        }
        let masses = best.masses();
        assert_eq!(masses.len(), 2);
        assert!(masses.iter().all(|mass| mass.interval.is_some_and(|[low, high]| low < high)), "{masses:?}");
    }
}
