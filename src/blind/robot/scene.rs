//! What a made study looks like before anything is the matter: scenario, sensors, logs.

use crate::blind::dice::{Dice, significant};
use crate::log::{ControlSpec, FloorSpec, LegFrictionSpec, RobotScenario, RobotSensorSpec, RobotStudy, Uncertain};
use crate::synth::{Believed, LogSpec, Spec, TruthSpec};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Encoders to draw from, that of section B.1 among them: their step \[rad\] and period \[s\].
const STEPS_RAD: [f64; 4] = [0.006, 0.006, 0.003, 0.0015];
const PERIODS_S: [f64; 3] = [0.008, 0.008, 0.016];
/// Least and greatest standard deviation of the noise before rounding \[rad\].
const NOISE_RAD: [f64; 2] = [0.001, 0.004];
/// Least and greatest relative standard deviation of masses and floor, and of friction. Beliefs are narrower or wider:
/// an exam may not be what the diagnosis assumes.
const SCATTER: [f64; 2] = [0.05, 0.10];
const FRICTION_SCATTER: [f64; 2] = [0.10, 0.30];

/// A study to be made.
pub(super) struct Scene {
    pub spec: Spec,
    pub scenario: RobotScenario,
    /// In words, by log.
    pub motions: Vec<String>,
    /// The joint that is let go.
    pub released: Option<String>,
    /// The study says how large the noise is.
    pub states_noise: bool,
}

/// Of a hundred studies 60 are in the air, 25 on the floor, 15 drops.
pub(super) fn draw_scenario(dice: &mut Dice) -> RobotScenario {
    match dice.uniform(0.0, 1.0) {
        x if x < 0.60 => RobotScenario::Air,
        x if x < 0.85 => RobotScenario::Floor,
        _ => RobotScenario::Drop,
    }
}

impl Scene {
    /// Draws the logs of a scenario.
    pub fn draw(scenario: RobotScenario, dice: &mut Dice) -> Self {
        let study = RobotStudy {
            file: PathBuf::from("study.toml"),
            model: "ers7".to_owned(),
            model_path: None,
            scenario,
            drop_height_m: 0.02,
            friction: LegFrictionSpec {
                coulomb_nm: Some([0.001, 0.007, 0.010]),
                viscous_nm_s_rad: Some([0.017, 0.019, 0.010]),
            },
            control: ControlSpec::default(),
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
        let [least, most] = SCATTER;
        let [low, high] = FRICTION_SCATTER;
        let truth = TruthSpec {
            scatter: significant(dice.uniform(least, most), 2),
            friction_scatter: Some(significant(dice.uniform(low, high), 2)),
            ..TruthSpec::default()
        };
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
        Self { spec, scenario, motions, released, states_noise: dice.chance(0.7) }
    }

    /// Standard deviation of a reading \[rad\].
    pub fn noise_rad(&self) -> f64 {
        let (Believed::Robot(study) | Believed::Joint(study, _)) = &self.spec.believed;
        let step_rad = study.sensor.resolution_rad.unwrap_or(0.0);
        study.sensor.noise_rad.unwrap_or(0.0).hypot(step_rad / 12f64.sqrt())
    }
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
