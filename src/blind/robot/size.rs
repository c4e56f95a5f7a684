//! How much a fault changes what the logs read.

use super::fault::Fault;
use super::scene::Scene;
use super::setting::Setting;
use crate::blind::dice::Dice;
use crate::log::RobotStudy;
use crate::number::{extent, math};
use crate::synth::{Alteration, AnySpec, Made, make_altered, make_described};
use std::collections::BTreeMap;

/// Readings without noise by joint, logs one after the other \[rad\].
#[derive(Clone, Debug)]
pub(super) struct Readings {
    pub angle_rad: BTreeMap<String, Vec<f64>>,
    pub setpoint_rad: BTreeMap<String, Vec<f64>>,
}

impl Readings {
    /// Least and greatest reading of a joint \[rad\].
    pub fn range(&self, joint: &str) -> [f64; 2] {
        range(self.angle_rad.get(joint))
    }

    /// Joints that are asked to move, by name.
    pub fn moving(&self) -> Vec<String> {
        let moves = |column: &Vec<f64>| {
            let [low, high] = range(Some(column));
            high - low > 0.02
        };
        self.setpoint_rad.iter().filter(|(_, column)| moves(column)).map(|(name, _)| name.clone()).collect()
    }

    /// RMS difference to other readings over some joints \[rad\].
    pub fn rms_rad(&self, other: &Self, joints: &[String]) -> f64 {
        let (mut sum, mut count) = (0.0, 0_usize);
        for joint in joints {
            let (Some(a), Some(b)) = (self.angle_rad.get(joint), other.angle_rad.get(joint)) else { continue };
            sum += a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
            count += a.len();
        }
        (sum / count.max(1) as f64).sqrt()
    }
}

fn range(column: Option<&Vec<f64>>) -> [f64; 2] {
    extent(column.into_iter().flatten().copied())
}

/// What the logs would read without noise; `None` where the robot runs away.
pub(super) fn readings(spec: &AnySpec, faults: &[(&Fault, f64)]) -> Option<Readings> {
    let spec = Scene::without_noise(spec);
    let mut found = Readings { angle_rad: BTreeMap::new(), setpoint_rad: BTreeMap::new() };
    let made = make_with(&spec, faults, false)?;
    for (_, text) in made.logs {
        let mut lines = text.lines();
        let names: Vec<&str> = lines.next()?.split(',').collect();
        for line in lines {
            for (name, value) in names.iter().zip(line.split(',')) {
                let (into, joint) = match name.rsplit_once('.') {
                    Some((joint, "q")) => (&mut found.angle_rad, joint),
                    Some((joint, "q_ref")) => (&mut found.setpoint_rad, joint),
                    _ => continue,
                };
                into.entry(joint.to_owned()).or_default().push(value.parse().ok()?);
            }
        }
    }
    let is_sound = found.angle_rad.values().flatten().all(|q| q.abs() < WIDEST_RAD);
    is_sound.then_some(found)
}

/// A joint that turns farther ran away \[rad\].
const WIDEST_RAD: f64 = 20.0;

/// Makes a study with faults of some strengths, which says how large the noise is or does not.
pub(super) fn make_with(spec: &AnySpec, faults: &[(&Fault, f64)], states_noise: bool) -> Option<Made> {
    let mut spec = spec.clone();
    for (fault, strength) in faults {
        fault.install(*strength, Scene::truth_of(&mut spec));
    }
    let alterations: Vec<_> = faults.iter().filter_map(|(fault, strength)| fault.alteration(*strength)).collect();
    let robot = |robot: &mut _| alterations.iter().for_each(|alteration| alteration.robot(robot));
    let setpoints = |setpoints: &mut _| alterations.iter().for_each(|alteration| alteration.setpoints(setpoints));
    let study = |study: &mut RobotStudy| study.sensor.noise_rad = study.sensor.noise_rad.filter(|_| states_noise);
    let alteration = Alteration { robot: &robot, setpoints: &setpoints, study: &study };
    match &spec {
        AnySpec::Robot(spec) => make_altered(spec, None, alteration).ok(),
        AnySpec::Described(spec) => make_described(spec, None).ok(),
    }
}

/// Steps while a strength is sought \[s\]: where free play or a stop must be followed, elsewhere in the air, on the floor.
const SEARCH_S: [f64; 3] = [1e-4, 1e-3, 5e-4];
/// Changes that are sought, as multiples of a reading's standard deviation: of one cause, and of each of two causes and of
/// what the catalogue does not have, which have to show as such.
pub(super) const ONE: [f64; 2] = [1.0, 30.0];
pub(super) const PLAIN: [f64; 2] = [4.0, 30.0];
/// Changes up to so much more or less are taken.
const OFF: f64 = 1.3;
const TRIES: usize = 9;

/// The spec with the integrator by which strengths are sought.
pub(super) fn searched(scene: &Scene, is_stiff: bool) -> AnySpec {
    let mut spec = scene.spec.clone();
    let [stiff, clamped, floor] = SEARCH_S;
    let step = match scene.setting {
        _ if is_stiff => stiff,
        Setting::Floor => floor,
        _ => clamped,
    };
    let (truth, _) = Scene::truth_of(&mut spec);
    (truth.method, truth.step) = (Some("stiff".to_owned()), Some(step));
    spec
}

/// A strength at which a fault changes its joints by so many times a reading's standard deviation.
pub(super) fn strength(
    scene: &Scene,
    fault: &Fault,
    moving: &[String],
    [least, most]: [f64; 2],
    dice: &mut Dice,
) -> Option<f64> {
    let spec = searched(scene, fault.is_stiff());
    let plain = readings(&spec, &[])?;
    let joints = fault.seen_in(moving);
    let ratio = |strength: f64| {
        // A robot that runs away shows too much.
        readings(&spec, &[(fault, strength)])
            .map_or(f64::INFINITY, |with| with.rms_rad(&plain, joints) / scene.noise_rad())
    };
    let wanted = dice.log_uniform(least, most);
    let is_taken = |ratio: f64| ratio >= least / OFF && ratio <= most * OFF;
    let [mut low, mut high] = [0.0, 1.0];
    let mut best: Option<(f64, f64)> = None;
    for attempt in 0..TRIES {
        let at = if attempt == 0 { 1.0 } else { 0.5 * (low + high) };
        let ratio = ratio(at);
        let off = math::ln(ratio / wanted).abs();
        if is_taken(ratio) && best.is_none_or(|(_, least)| off < least) {
            best = Some((at, off));
        }
        if attempt == 0 && ratio < wanted || off < 0.1 {
            break;
        }
        if ratio > wanted { high = at } else { low = at }
    }
    best.map(|(at, _)| at)
}
