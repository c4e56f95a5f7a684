//! Makes a robot study and keeps its answer.

use super::cause::{RobotFilter, RobotOutside, RobotTrueCause};
use super::fault::{Fault, Kind};
use super::scene::Scene;
use super::setting::Setting;
use super::size::{ONE, PLAIN, Readings, make_with, readings, searched, strength};
use super::truth::{RobotTruth, TrueFault};
use crate::blind::dice::Dice;
use crate::gap::Verdict;
use crate::gap::robot::Cause;
use crate::joint::EffectId;

/// What is to be made.
#[derive(Clone, Copy, Debug)]
pub struct RobotOrder {
    /// Seed of the run.
    pub seed: u64,
    /// What the logs are of; drawn where it is not stated.
    pub setting: Option<Setting>,
    /// What may be the matter.
    pub filter: RobotFilter,
}

/// A study and its answer.
#[derive(Clone, Debug)]
pub struct RobotMade {
    /// Names and contents of the study's files, `study.toml` first.
    pub study: Vec<(String, String)>,
    /// What is true of it.
    pub truth: RobotTruth,
}

/// Faults that are drawn for a scene until one shows, and scenes.
const FAULTS: usize = 12;
const SCENES: usize = 12;
/// Steps of the maker \[s\], the finer for free play and stops, and its tolerance.
const STIFF_S: f64 = 1e-4;
const FINE_S: f64 = 2e-5;
const TOLERANCE: f64 = 1e-6;

/// Makes study `trial` of a run; `None` where no cause shows in logs of the setting asked for.
pub fn make_robot(order: &RobotOrder, trial: u64) -> Option<RobotMade> {
    if order.setting.is_some_and(|setting| !order.filter.shows_in(setting)) {
        return None;
    }
    let mut dice = Dice::new(order.seed, trial);
    let folder = tempfile::tempdir().ok()?;
    (0..SCENES).find_map(|_| {
        let setting = order.setting.unwrap_or_else(|| Setting::draw(&mut dice));
        if !order.filter.shows_in(setting) {
            return None;
        }
        let kind = kind_of(order.filter, &mut dice);
        let scene = Scene::draw(setting, folder.path(), &mut dice)?;
        let plain = readings(&searched(&scene, false), &[])?;
        let faults = (0..FAULTS).find_map(|_| faults(kind, &scene, &plain, &mut dice))?;
        finish(order.seed, trial, scene, &plain, &faults, &mut dice)
    })
}

/// Of a hundred studies 25 have nothing, 8 a wrong friction, 45 one cause, 8 two, 14 something outside the catalogue.
fn kind_of(filter: RobotFilter, dice: &mut Dice) -> RobotFilter {
    match (filter, dice.uniform(0.0, 1.0)) {
        (RobotFilter::Any, x) if x < 0.25 => RobotFilter::Nothing,
        (RobotFilter::Any, x) if x < 0.33 => RobotFilter::Calibration,
        (RobotFilter::Any, x) if x < 0.78 => RobotFilter::AnyEffect,
        (RobotFilter::Any, x) if x < 0.86 => RobotFilter::AnyPair,
        (RobotFilter::Any, _) => RobotFilter::AnyOutside,
        (given, _) => given,
    }
}

/// Share of the causes in studies on a floor that are of the trunk or the floor.
const OF_ROBOT: f64 = 0.4;
/// Share of the causes of arms that are a payload.
const PAYLOADS: f64 = 0.15;

fn draw_cause(setting: Setting, calibration_too: bool, dice: &mut Dice) -> Cause {
    let pick = |of_robot: bool, dice: &mut Dice| {
        let list: Vec<Cause> = Cause::all()
            .filter(|cause| RobotTrueCause::One(*cause).shows_in(setting))
            .filter(|cause| cause.is_of_robot() == of_robot && (calibration_too || !cause.is_calibration()))
            .collect();
        dice.pick(&list)
    };
    let of_robot = match setting {
        Setting::Floor => dice.chance(OF_ROBOT),
        Setting::Arm => dice.chance(PAYLOADS),
        Setting::Air | Setting::Drop => false,
    };
    pick(of_robot, dice)
}

/// Draws what is the matter, with strengths that show.
fn faults(kind: RobotFilter, scene: &Scene, plain: &Readings, dice: &mut Dice) -> Option<Vec<(Fault, f64)>> {
    let setting = scene.setting;
    let kinds: Vec<Kind> = match kind {
        RobotFilter::Any | RobotFilter::Nothing => Vec::new(),
        RobotFilter::Calibration => vec![Kind::Catalogue(dice.pick(&[Cause::Coulomb, Cause::Viscous]))],
        RobotFilter::AnyEffect => vec![Kind::Catalogue(draw_cause(setting, false, dice))],
        RobotFilter::AnyPair => {
            let first = draw_cause(setting, false, dice);
            let second = (0..FAULTS).map(|_| draw_cause(setting, true, dice)).find(|cause| can_pair(first, *cause))?;
            vec![Kind::Catalogue(first), Kind::Catalogue(second)]
        }
        RobotFilter::AnyOutside => {
            let list: Vec<RobotOutside> = RobotOutside::ALL
                .into_iter()
                .filter(|outside| RobotTrueCause::Outside(*outside).shows_in(setting))
                .collect();
            if list.is_empty() {
                return None;
            }
            vec![Kind::Outside(dice.pick(&list))]
        }
        RobotFilter::Only(RobotTrueCause::Nothing) => Vec::new(),
        RobotFilter::Only(RobotTrueCause::One(cause)) => vec![Kind::Catalogue(cause)],
        RobotFilter::Only(RobotTrueCause::Two(a, b)) => vec![Kind::Catalogue(a), Kind::Catalogue(b)],
        RobotFilter::Only(RobotTrueCause::Outside(outside)) => vec![Kind::Outside(outside)],
    };
    let moving = seen(scene, plain);
    let is_plain = kinds.len() > 1 || kinds.iter().any(|kind| matches!(kind, Kind::Outside(_)));
    let sizes = if is_plain { PLAIN } else { ONE };
    let mut found: Vec<(Fault, f64)> = Vec::with_capacity(kinds.len());
    for kind in kinds {
        let fault = Fault::draw(kind, scene, plain, dice);
        let at = strength(scene, &fault, &moving, sizes, dice)?;
        found.push((fault, at));
    }
    Some(found)
}

/// Two faults of one kind are one; all friction is one kind.
fn can_pair(first: Cause, second: Cause) -> bool {
    let kind = |cause: Cause| match cause {
        Cause::Coulomb | Cause::Viscous => 0,
        Cause::Effect(effect) => match effect {
            EffectId::Stribeck
            | EffectId::LoadFriction
            | EffectId::GearFriction
            | EffectId::QuadraticDrag
            | EffectId::AsymmetricFriction
            | EffectId::PositionFriction
            | EffectId::FrictionDrift => 0,
            EffectId::Backlash | EffectId::EndStop | EffectId::Compliance => 1,
            EffectId::JointSpring | EffectId::AngleOffset | EffectId::SensorGain => 2,
            EffectId::Delay | EffectId::SetpointHold | EffectId::SetpointProfile | EffectId::SensorDelay => 3,
            EffectId::TorqueLimit | EffectId::SpeedLimit | EffectId::MotorGain | EffectId::DeadBand => 4,
        },
        Cause::Payload => 5,
        Cause::FloorFriction | Cause::FloorSlope | Cause::FloorStiffness => 6,
    };
    kind(first) != kind(second)
}

/// Joints that show what is the matter with the whole robot.
fn seen(scene: &Scene, plain: &Readings) -> Vec<String> {
    scene.released.as_ref().map_or_else(|| scene.moving(plain), |joint| vec![joint.clone()])
}

fn finish(
    seed: u64,
    trial: u64,
    scene: Scene,
    plain: &Readings,
    faults: &[(Fault, f64)],
    dice: &mut Dice,
) -> Option<RobotMade> {
    let mut spec = scene.spec.clone();
    let must_stick = faults.iter().any(|(fault, _)| fault.sticks());
    let (method, step, tolerance) = match scene.setting {
        _ if faults.iter().any(|(fault, _)| fault.is_stiff()) => ("stiff", Some(FINE_S), None),
        // A joint that comes to rest by itself, as arms do between two steps, must stick truly: a smooth sign would creep.
        Setting::Drop | Setting::Arm => ("stiff", Some(STIFF_S), None),
        _ if must_stick || dice.chance(0.4) => ("stiff", Some(STIFF_S), None),
        _ => ("bdf", None, Some(TOLERANCE)),
    };
    let (stated, _) = Scene::truth_of(&mut spec);
    (stated.method, stated.step, stated.tolerance) = (Some(method.to_owned()), step, tolerance);
    let (scatter, friction_scatter) = (stated.scatter, stated.friction_scatter.unwrap_or(stated.scatter));
    let all: Vec<(&Fault, f64)> = faults.iter().map(|(fault, at)| (fault, *at)).collect();
    let made = make_with(&spec, &all, scene.states_noise)?;

    let moving = seen(&scene, plain);
    let whole = readings(&spec, &all)?;
    let ratio = |other: &Readings, fault: &Fault| whole.rms_rad(other, fault.seen_in(&moving)) / scene.noise_rad();
    let mut true_faults = Vec::with_capacity(faults.len());
    for (k, (fault, at)) in faults.iter().enumerate() {
        let others: Vec<(&Fault, f64)> = all.iter().enumerate().filter(|(j, _)| *j != k).map(|(_, f)| *f).collect();
        true_faults.push(TrueFault {
            id: fault.id(),
            joints: fault.joints.clone(),
            parameters: fault.named(*at),
            ratio: ratio(&readings(&spec, &others)?, fault),
        });
    }
    let total = match faults.first() {
        Some((first, _)) => ratio(&readings(&spec, &[])?, first),
        None => 0.0,
    };
    let outside = faults.iter().find_map(|(fault, _)| match fault.kind {
        Kind::Outside(outside) => Some(outside),
        Kind::Catalogue(_) => None,
    });
    let causes: Vec<Cause> = faults
        .iter()
        .filter_map(|(fault, _)| match fault.kind {
            Kind::Catalogue(cause) => Some(cause),
            Kind::Outside(_) => None,
        })
        .collect();
    let verdict = match (outside, causes.as_slice()) {
        (Some(_), _) => Verdict::Unexplained,
        (None, []) => Verdict::None,
        (None, causes) if causes.iter().all(|cause| cause.is_calibration()) => Verdict::Calibration,
        _ => Verdict::Effect,
    };
    let truth = RobotTruth {
        seed,
        trial,
        scenario: scene.setting.word(),
        robot: scene.robot.clone(),
        verdict,
        causes,
        outside,
        faults: true_faults,
        ratio: total,
        noise_rad: scene.noise_rad(),
        scatter,
        friction_scatter,
        method: made.truth.method.clone(),
        motions: scene.motions,
    };
    Some(RobotMade { study: made.files().collect(), truth })
}
