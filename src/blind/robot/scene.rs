//! What a made study looks like before anything is the matter: robot, scenario, sensors, logs.

use super::arm::{self, Arm};
use super::quadruped::{self, Size};
use super::setting::Setting;
use super::size::Readings;
use crate::blind::dice::{Dice, significant};
use crate::log::{ControlSpec, FloorSpec, LegFrictionSpec, RobotScenario, RobotSensorSpec, RobotStudy, Uncertain};
use crate::number::math;
use crate::synth::{AnySpec, Believed, EffectSpec, LogSpec, Spec, TruthSpec};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Encoders to draw from, that of section B.1 among them: their step \[rad\] and period \[s\].
const STEPS_RAD: [f64; 4] = [0.006, 0.006, 0.003, 0.0015];
const PERIODS_S: [f64; 3] = [0.008, 0.008, 0.016];
/// Those of arms.
const ARM_STEPS_RAD: [f64; 3] = [0.0015, 0.0008, 0.0003];
const ARM_PERIODS_S: [f64; 2] = [0.01, 0.02];
/// Least and greatest standard deviation of the noise before rounding \[rad\].
const NOISE_RAD: [f64; 2] = [0.001, 0.004];
const ARM_NOISE_RAD: [f64; 2] = [0.0002, 0.001];
/// Least and greatest relative standard deviation of masses and floor, and of friction. Beliefs are narrower or wider:
/// an exam may not be what the diagnosis assumes.
const SCATTER: [f64; 2] = [0.05, 0.10];
const FRICTION_SCATTER: [f64; 2] = [0.10, 0.30];
/// How many of the quadrupeds are of another size than the ERS-7.
const OTHERS: f64 = 0.35;
/// Friction of the ERS-7's legs by joint 1, 2, 3, Coulomb \[N m\] and viscous \[N m s/rad\], as study and exam believe it.
const LEG_FRICTION: [[f64; 3]; 2] = [[0.001, 0.007, 0.010], [0.017, 0.019, 0.010]];
/// Load of an ERS-7's joint as it stands \[N m\], and its mass \[kg\].
const ERS7_LOAD_NM: f64 = 0.3;
const ERS7_KG: f64 = 1.69;

/// A study to be made.
pub(super) struct Scene {
    pub spec: AnySpec,
    pub setting: Setting,
    /// Which robot, in words.
    pub robot: String,
    /// How strong and how heavy the robot is, in units of the ERS-7.
    pub torque: f64,
    pub mass: f64,
    /// Believed friction of an arm's joints, Coulomb \[N m\] and viscous \[N m s/rad\].
    friction: BTreeMap<String, [f64; 2]>,
    /// In words, by log.
    pub motions: Vec<String>,
    /// The joint that is let go.
    pub released: Option<String>,
    /// The study says how large the noise is.
    pub states_noise: bool,
}

impl Scene {
    /// Draws robot and logs; the robot's file, if it has one, is written into a folder. `None` where it cannot be.
    pub fn draw(setting: Setting, folder: &Path, dice: &mut Dice) -> Option<Self> {
        match setting.scenario() {
            Some(scenario) => Self::of_quadruped(setting, scenario, folder, dice),
            None => Self::of_arm(folder, dice),
        }
    }

    fn of_quadruped(setting: Setting, scenario: RobotScenario, folder: &Path, dice: &mut Dice) -> Option<Self> {
        let size = if dice.chance(OTHERS) { Some(Size::draw(dice)) } else { None };
        if let Some(size) = size {
            std::fs::write(folder.join(quadruped::FILE), size.robot()).ok()?;
        }
        let (torque, mass) = size.map_or((1.0, 1.0), |size| (size.torque(), size.mass()));
        let [coulomb_nm, viscous_nm_s_rad] =
            LEG_FRICTION.map(|of| Some(of.map(|number| significant(torque * number, 3))));
        let study = RobotStudy {
            file: folder.join("study.toml"),
            model: size.map_or("ers7", |_| quadruped::FILE).to_owned(),
            model_path: size.map(|_| folder.join(quadruped::FILE)),
            described: None,
            scenario,
            drop_height_m: 0.02,
            friction: LegFrictionSpec { coulomb_nm, viscous_nm_s_rad },
            control: ControlSpec { gains: size.map(Size::gains).unwrap_or_default(), ..ControlSpec::default() },
            floor: FloorSpec::default(),
            sensor: RobotSensorSpec {
                resolution_rad: Some(dice.pick(&STEPS_RAD)),
                period_s: Some(dice.pick(&PERIODS_S)),
                noise_rad: Some(significant(dice.log_uniform(NOISE_RAD[0], NOISE_RAD[1]), 2)),
            },
            uncertain: Uncertain::default(),
            columns: crate::log::Columns::default(),
            logs: Vec::new(),
        };
        let [scatter, friction_scatter] = scatters(dice);
        let truth = TruthSpec { scatter, friction_scatter: Some(friction_scatter), ..TruthSpec::default() };
        let (logs, motions, released) = match scenario {
            RobotScenario::Air => walks(&AIR, 2, dice),
            RobotScenario::Floor => walks(&FLOOR, 1, dice),
            RobotScenario::Drop => drops(dice),
        };
        let spec = Spec {
            file: PathBuf::from("study.toml"),
            seed: dice.seed(),
            believed: Believed::Robot(Box::new(study)),
            truth,
            effects: Vec::new(),
            logs,
        };
        let robot = size.map_or_else(|| "ers7".to_owned(), Size::words);
        let (spec, friction, states_noise) = (AnySpec::Robot(Box::new(spec)), BTreeMap::new(), dice.chance(0.7));
        Some(Self { spec, setting, robot, torque, mass, friction, motions, released, states_noise })
    }

    fn of_arm(folder: &Path, dice: &mut Dice) -> Option<Self> {
        let arm = Arm::draw(dice);
        std::fs::write(folder.join(arm::FILE), arm.urdf()).ok()?;
        let [scatter, friction_scatter] = scatters(dice);
        let noise_rad = significant(dice.log_uniform(ARM_NOISE_RAD[0], ARM_NOISE_RAD[1]), 2);
        let mut motions = Vec::new();
        let mut log = |(k, (motion, role)): (usize, (&str, &str))| {
            let duration_s = significant(dice.uniform(10.0, 16.0), 2);
            motions.push(format!("{motion}, {duration_s} s"));
            format!(
                "[[log]]\nfile = \"log-{k:02}.csv\"\ngait = \"{motion}\"\nrole = \"{role}\"\nduration = {duration_s}\n"
            )
        };
        let asked = [("sines", "fit"), ("steps", "fit"), ("sines", "validate")];
        let logs: String = asked.into_iter().enumerate().map(&mut log).collect();
        let text = format!(
            "schema = 1\nseed = {}\n[robot]\nmodel = \"{}\"\nscenario = \"fixed\"\n{}[sensor]\nperiod = {}\nresolution = {}\n\
             [truth]\nscatter = {scatter}\nfriction_scatter = {friction_scatter}\nnoise = {noise_rad}\n{logs}",
            dice.seed() >> 1,
            arm::FILE,
            arm.servos(),
            dice.pick(&ARM_PERIODS_S),
            dice.pick(&ARM_STEPS_RAD),
        );
        Some(Self {
            spec: AnySpec::from_toml(&folder.join("study.toml"), &text).ok()?,
            setting: Setting::Arm,
            robot: arm.words(),
            torque: arm.load_nm() / ERS7_LOAD_NM,
            mass: arm.mass_kg() / ERS7_KG,
            friction: arm.friction().collect(),
            motions,
            released: None,
            states_noise: false,
        })
    }

    /// What is true, and the effects that are there.
    pub fn truth_of(spec: &mut AnySpec) -> (&mut TruthSpec, &mut Vec<EffectSpec>) {
        match spec {
            AnySpec::Robot(spec) => (&mut spec.truth, &mut spec.effects),
            AnySpec::Described(spec) => (&mut spec.truth, &mut spec.effects),
        }
    }

    /// The spec with encoders that read exactly.
    pub fn without_noise(spec: &AnySpec) -> AnySpec {
        let mut spec = spec.clone();
        match &mut spec {
            AnySpec::Robot(spec) => {
                if let Believed::Robot(study) = &mut spec.believed {
                    (study.sensor.resolution_rad, study.sensor.noise_rad) = (None, None);
                }
            }
            AnySpec::Described(spec) => (spec.study.sensor.resolution_rad, spec.truth.noise) = (None, None),
        }
        spec
    }

    /// Standard deviation of a reading \[rad\].
    pub fn noise_rad(&self) -> f64 {
        let (step_rad, noise_rad) = match &self.spec {
            AnySpec::Robot(spec) => {
                let (Believed::Robot(study) | Believed::Joint(study, _)) = &spec.believed;
                (study.sensor.resolution_rad, study.sensor.noise_rad)
            }
            AnySpec::Described(spec) => (spec.study.sensor.resolution_rad, spec.truth.noise),
        };
        math::hypot(noise_rad.unwrap_or(0.0), step_rad.unwrap_or(0.0) / 12f64.sqrt())
    }

    /// Joints that are asked to move and may have a fault: a quadruped's legs, all of an arm.
    pub fn moving(&self, plain: &Readings) -> Vec<String> {
        let mut moving = plain.moving();
        if self.setting != Setting::Arm {
            moving.retain(|name| ["lf", "rf", "lr", "rr"].iter().any(|leg| name.starts_with(leg)));
        }
        moving
    }

    /// Believed Coulomb \[N m\] and viscous friction \[N m s/rad\] of a joint.
    pub fn friction(&self, joint: &str) -> [f64; 2] {
        let number = joint.chars().last().and_then(|last| last.to_digit(10)).filter(|number| (1..=3).contains(number));
        let of_leg = |of: [f64; 3]| self.torque * number.map_or(0.0, |number| of[number as usize - 1]);
        self.friction.get(joint).copied().unwrap_or_else(|| LEG_FRICTION.map(of_leg))
    }
}

/// Relative standard deviations of masses and floor, and of friction.
fn scatters(dice: &mut Dice) -> [f64; 2] {
    [SCATTER, FRICTION_SCATTER].map(|[least, most]| significant(dice.uniform(least, most), 2))
}

/// A gait and how it may be walked: amplitudes to choose from, least and greatest frequency \[1/s\].
type Walk = (&'static str, &'static [Option<&'static str>], [f64; 2]);

const AIR: [Walk; 5] = [
    ("trot", &[Some("air"), Some("air"), Some("floor")], [0.6, 1.8]),
    ("trot", &[Some("air")], [0.8, 1.2]),
    ("trot-2hz", &[Some("air"), Some("floor")], [1.5, 2.5]),
    ("pace", &[None], [0.8, 2.0]),
    ("turn-left", &[None], [0.7, 1.6]),
];
const FLOOR: [Walk; 4] = [
    ("trot", &[Some("floor")], [0.8, 1.25]),
    ("trot", &[Some("floor")], [0.8, 1.25]),
    ("pace", &[None], [1.2, 1.7]),
    ("turn-left", &[None], [0.8, 1.2]),
];

type Logs = (Vec<LogSpec>, Vec<String>, Option<String>);

/// One log of a gait, or as many as `most`.
fn walks(gaits: &[Walk], most: usize, dice: &mut Dice) -> Logs {
    let count = if dice.chance(0.75) { 1 } else { most };
    let on_floor = gaits.iter().all(|(.., [low, _])| *low >= 0.8);
    let one = |k: usize| {
        let (gait, amplitudes, [low, high]) = dice.pick(gaits);
        let frequency = significant(dice.uniform(low, high), 3);
        let amplitude = dice.pick(amplitudes);
        let duration = significant(if on_floor { dice.uniform(8.0, 10.0) } else { dice.uniform(6.0, 9.0) }, 2);
        let log = LogSpec {
            file: format!("log-{k:02}.csv"),
            gait: Some(gait.to_owned()),
            amplitude: amplitude.map(str::to_owned),
            frequency: Some(frequency),
            duration: Some(duration),
            base: on_floor && dice.chance(0.3),
            forward: (on_floor && dice.chance(0.6)).then_some([2.0, duration]),
            ..LogSpec::default()
        };
        let words = format!("{gait} {} at {frequency} Hz, {duration} s", amplitude.unwrap_or("as it is"));
        (log, words)
    };
    let (logs, motions) = (0..count).map(one).unzip();
    (logs, motions, None)
}

/// One to three drops of one joint, from where it moves when it is let go.
fn drops(dice: &mut Dice) -> Logs {
    let leg = dice.pick(&["lf", "rf", "lr", "rr"]);
    let number = dice.pick(&[1, 1, 2, 2, 2, 3]);
    let joint = format!("{leg}{number}");
    let count = dice.whole(1, 3);
    let one = |k: usize| {
        let angle = match number {
            1 => dice.sign() * dice.uniform(0.6, 1.7),
            2 => dice.uniform(0.7, 1.45),
            _ => dice.uniform(1.2, 2.0),
        };
        let angle = significant(angle, 3);
        let mut angles = BTreeMap::from([(joint.clone(), angle)]);
        if number == 1 && dice.chance(0.5) {
            angles.insert(format!("{leg}3"), significant(dice.uniform(0.0, 0.8), 3));
        }
        let log = LogSpec {
            file: format!("log-{k:02}.csv"),
            released: Some(joint.clone()),
            release_time: Some(significant(dice.uniform(0.3, 0.6), 2)),
            duration: Some(significant(dice.uniform(3.0, 4.5), 2)),
            angles,
            ..LogSpec::default()
        };
        (log, format!("{joint} let go at {angle} rad"))
    };
    let (logs, motions) = (0..count).map(one).unzip();
    (logs, motions, Some(joint))
}
