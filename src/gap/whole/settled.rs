//! The whole robot with the numbers at which it follows its logs best, within what is believed of them: masses, friction,
//! gains and what turns with the motors, and the sizes of causes, by steps of Gauss and Newton with all joints simulated at
//! once.
//!
//! Along the measured motion alone the joints' pushes on one another are known no better than the readings' second
//! derivatives and the described masses: a joint that no cause explains there may be explained here.

use super::bench::{Bench, Point, Sides, along, driven};
use super::noise::{LEAST_NOISE_RAD, mean_square};
use super::robot::PlacedCause;
use super::unknown::Quantity;
use crate::deadline::Deadline;
use crate::fit::correlation_length;
use crate::gap::clamped::{BODY_OPEN, ClampedSetup};
use crate::gap::hypothesis::reach::travels;
use crate::gap::verdict::told::AtBest;
use crate::identify::best_window;
use crate::joint::EffectId;
use crate::log::{DriveMode, JointColumns, RobotLog, Role};
use crate::robot::description::{FoundKey, FoundNumber};

/// Points about which the robot is made linear at most, and steps from each.
const POINTS: usize = 5;
const STEPS: usize = 4;
/// A step that gains less than this share is the last of a point, and a point that does is the last.
const WORTH_A_STEP: f64 = 0.1;
const DONE: f64 = 5e-3;
/// A robot that leaves so many times the noise and gains less than the share is not this one.
const HOPELESS: f64 = 5.0;
const GETS_THERE: f64 = 0.5;

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
    /// Joints that other logs show moving than those that setpoints drive: nobody knows what it leaves of them there.
    pub seen_elsewhere: Vec<String>,
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

    /// Whether a joint moves in logs that were not simulated.
    pub fn is_seen_elsewhere(&self, joint: &str) -> bool {
        self.seen_elsewhere.iter().any(|other| other == joint)
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

    /// What it leaves of a joint that setpoints drive in all logs which show it moving \[rad\].
    pub fn left_rad(&self, joint: &str) -> Option<f64> {
        let is_known = !self.is_seen_elsewhere(joint);
        self.left_rad.iter().filter(|_| is_known).find(|(name, _)| name == joint).map(|(_, left)| *left)
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
    settled_alike(setup, numbers, causes, each(causes.len()), deadline)
}

/// Each of so many causes with values of its own.
pub(super) fn each(causes: usize) -> Vec<Vec<usize>> {
    (0..causes).map(|cause| vec![cause]).collect()
}

/// The same where those of the causes that are `alike` have the same values.
pub(super) fn settled_alike(
    setup: &ClampedSetup,
    numbers: &[FoundNumber],
    causes: &[PlacedCause],
    alike: Vec<Vec<usize>>,
    deadline: &Deadline,
) -> Option<Settled> {
    if causes.iter().any(|cause| cause.form.id == EffectId::Backlash) {
        return None;
    }
    let bench = Bench::new(setup, numbers, causes, alike)?;
    let mut here = bench.with(numbers, None)?;
    for _ in 0..POINTS {
        if deadline.leaves_out("the whole robot at its best") {
            break;
        }
        let Some(slopes) = bench.slopes(&here, bench.sides(&here)) else { break };
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

impl Bench<'_> {
    /// To which sides numbers are changed about a point.
    pub(super) fn sides(&self, here: &Point) -> Sides {
        if self.is_hopeless(here) { Sides::One } else { Sides::Both }
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
    pub(super) fn correlation(&self, here: &Point) -> f64 {
        let joints = self.logs.iter().flat_map(|log| &log.joints).zip(&here.left);
        let lengths: Vec<f64> =
            joints.filter(|(joint, _)| moves(joint)).map(|(_, left)| correlation_length(left)).collect();
        lengths.iter().sum::<f64>() / lengths.len().max(1) as f64
    }

    fn settled(&self, here: &Point) -> Option<Settled> {
        let sd = &here.sd;
        let (numbers, causes) = self.robot(&here.sizes, sd);
        let held_out = driven(self.setup, |role| role == Role::Validate);
        let mut rows: [Vec<(&str, Vec<f64>)>; 2] = Default::default();
        for (rows, logs) in rows.iter_mut().zip([&held_out, &self.logs]) {
            let (_, left) = along(self.setup, (&numbers, &causes), logs, None, f64::INFINITY)?;
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
        let of_body = self.unknowns.iter().zip(sd).filter(|(own, _)| matches!(own.quantity, Quantity::Body { .. }));
        let body_sd = of_body.map(|(own, sd)| (*sd < BODY_OPEN).then_some(sd * own.sd)).collect();
        let others = self.setup.study.logs.iter().zip(&self.setup.logs);
        let others = others.filter(|(entry, _)| entry.drive != DriveMode::Position).flat_map(|(_, log)| &log.joints);
        let seen_elsewhere = others.filter(|joint| moves(joint)).map(|joint| joint.name.clone()).collect();
        Some(Settled { numbers, causes, body_sd, left_rad, seen_elsewhere })
    }
}

/// Whether a log shows a joint moving.
fn moves(joint: &JointColumns) -> bool {
    travels(&joint.q_rad)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::whole::as_stated_at_best;
    use crate::gap::whole::robot::WholeRobot;
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

    fn made() -> ClampedSetup {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("arm.urdf"), ARM).unwrap();
        let spec = AnySpec::from_toml(&folder.path().join("study.toml"), SPEC).unwrap();
        let AnySpec::Described(spec) = spec else { panic!("it has a clamped base") };
        for (name, text) in make_described(&spec, None).unwrap().files() {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        ClampedSetup::read(&folder.path().join("study.toml")).unwrap()
    }

    #[test]
    fn after_a_hole_the_robot_begins_where_it_is_read() {
        let setup = made();
        let whole = &setup.logs[0];
        let off_rad = |k: &usize| (whole.joints[0].q_rad[*k] - whole.joints[0].q_rad[99]).abs();
        let far = (200..900).max_by(|a, b| off_rad(a).total_cmp(&off_rad(b))).unwrap();
        assert!(off_rad(&far) > 0.05);
        let samples: Vec<usize> = (0..100).chain(far..far + 100).collect();
        let mut log = whole.clone();
        log.t_s = samples.iter().enumerate().map(|(k, _)| 0.01 * k as f64 + if k < 100 { 0.0 } else { 1.0 }).collect();
        for (joint, of) in log.joints.iter_mut().zip(&whole.joints) {
            let those = |column: &Vec<f64>| samples.iter().map(|k| column[*k]).collect::<Vec<f64>>();
            joint.q_rad = samples.iter().map(|k| of.q_rad[*k]).collect();
            joint.q_ref_rad = of.q_ref_rad.as_ref().map(those);
            joint.tau_nm = of.tau_nm.as_ref().map(those);
            joint.drive = of.drive.as_ref().map(|on| samples.iter().map(|k| on[*k]).collect());
        }
        let bench = Bench::new(&setup, &[], &[], Vec::new()).unwrap();
        let none = vec![0.0; bench.unknowns.len()];
        let (numbers, _) = bench.robot(&none, &vec![1.0; none.len()]);
        let mut robot = WholeRobot::of(&setup, &numbers, &[]).unwrap();
        let read = robot.readings(&setup, &log).unwrap();
        for (read, joint) in read.iter().zip(&log.joints) {
            assert_eq!(read.len(), 200);
            assert!((read[100] - joint.q_rad[100]).abs() < 2e-3, "{}: {}", read[100], joint.q_rad[100]);
        }
        let (_, left) = along(&setup, (&numbers, &[]), &[&log], None, f64::INFINITY).unwrap();
        assert!(left.iter().all(|row| row.len() == 200 && row[100].abs() < 2e-3));
    }

    /// All numbers of this arm could be larger by a share; intervals of half a percent were told once, by the errors of differences.
    #[test]
    fn the_scale_of_all_torques_is_known_by_what_is_believed_alone() {
        let setup = made();
        let best = as_stated_at_best(&setup, &Deadline::default()).unwrap();
        let masses = best.masses();
        let share = |mass: &FoundNumber| mass.interval.map(|[low, high]| 0.5 * (high - low) / mass.value);
        assert!(masses.iter().all(|mass| share(mass).is_some_and(|half| half > 0.04)), "{masses:?}");
        let bench = Bench::new(&setup, &[], &[], Vec::new()).unwrap();
        let here = bench.stated(None).unwrap();
        let slopes = bench.slopes(&here, Sides::Both).unwrap();
        let scaled: Vec<f64> = bench.unknowns.iter().map(|unknown| unknown.was / unknown.sd).collect();
        let moved = slopes.along(&scaled);
        assert!(moved.iter().flatten().all(|moved| moved.abs() < 1e-9));
    }

    /// Made by another integrator, with masses and friction that are off.
    #[test]
    fn a_sound_arm_at_its_best_leaves_noise_in_logs_that_no_step_saw() {
        let setup = made();
        let logs = driven(&setup, |role| role == Role::Validate);
        let bench = Bench::new(&setup, &[], &[], Vec::new()).unwrap();
        let (numbers, _) = bench.robot(&vec![0.0; bench.unknowns.len()], &vec![1.0; bench.unknowns.len()]);
        let (_, stated) = along(&setup, (&numbers, &[]), &logs, None, f64::INFINITY).unwrap();
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
