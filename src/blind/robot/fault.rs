//! A fault on joints, or of the robot, at any strength.

use super::cause::RobotOutside;
use super::outside::Altered;
use super::scene::Scene;
use super::setting::Setting;
use super::size::Readings;
use crate::blind::dice::{Dice, significant};
use crate::blind::truth::TrueNumber;
use crate::gap::robot::Cause;
use crate::joint::EffectId;
use crate::number::math;
use crate::robot::FloorParameters;
use crate::synth::{EffectSpec, JointChoice, PayloadSpec, TruthSpec};
use std::f64::consts::PI;

/// Digits of a fault's numbers.
const DIGITS: i32 = 4;

/// What kind of fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Catalogue(Cause),
    Outside(RobotOutside),
}

/// How its numbers grow with a strength from 0 to 1.
type Numbers = Box<dyn Fn(f64) -> Vec<f64> + Sync>;

/// A fault that is drawn, but for its strength.
pub(super) struct Fault {
    pub kind: Kind,
    /// None: the whole robot.
    pub joints: Vec<String>,
    numbers: Numbers,
    seed: u64,
}

impl Fault {
    /// Draws place and side numbers.
    pub fn draw(kind: Kind, scene: &Scene, plain: &Readings, dice: &mut Dice) -> Self {
        let moving = scene.moving(plain);
        let joints = match kind {
            Kind::Catalogue(cause) if cause.is_of_robot() => Vec::new(),
            Kind::Outside(RobotOutside::TiltedTrunk) => Vec::new(),
            _ => place(kind, scene, &moving, dice),
        };
        let first = joints.first().map_or("", String::as_str);
        let numbers = match kind {
            Kind::Catalogue(cause) => of_cause(cause, first, scene, plain, dice),
            Kind::Outside(outside) => of_outside(outside, scene, plain, dice),
        };
        Self { kind, joints, numbers, seed: dice.seed() }
    }

    /// The word in reports and JSON.
    pub fn id(&self) -> &'static str {
        match self.kind {
            Kind::Catalogue(cause) => cause.id(),
            Kind::Outside(outside) => outside.id(),
        }
    }

    /// Joints in which it is measured: its own, or all that move.
    pub fn seen_in<'a>(&'a self, moving: &'a [String]) -> &'a [String] {
        if self.joints.is_empty() { moving } else { &self.joints }
    }

    /// Whether it takes a fine step to follow.
    pub fn is_stiff(&self) -> bool {
        matches!(self.kind, Kind::Catalogue(Cause::Effect(EffectId::Backlash | EffectId::EndStop)))
    }

    /// Whether it is friction that sticks: a smooth sign would be another fault.
    pub fn sticks(&self) -> bool {
        use EffectId::*;
        match self.kind {
            Kind::Catalogue(Cause::Effect(effect)) => matches!(
                effect,
                Stribeck | LoadFriction | GearFriction | AsymmetricFriction | PositionFriction | FrictionDrift
            ),
            Kind::Catalogue(cause) => cause == Cause::Coulomb,
            Kind::Outside(outside) => matches!(outside, RobotOutside::Cogging | RobotOutside::HotGear),
        }
    }

    fn values(&self, strength: f64) -> Vec<f64> {
        (self.numbers)(strength).into_iter().map(|value| significant(value, DIGITS)).collect()
    }

    /// Its numbers with names and units.
    pub fn named(&self, strength: f64) -> Vec<TrueNumber> {
        let names = match self.kind {
            Kind::Catalogue(cause) => cause.named(),
            Kind::Outside(outside) => outside.named().to_vec(),
        };
        let values = self.values(strength);
        names.into_iter().zip(values).map(|((name, unit), value)| TrueNumber::new(name, unit, value)).collect()
    }

    /// Puts what a spec can say into a spec.
    pub fn install(&self, strength: f64, (truth, effects): (&mut TruthSpec, &mut Vec<EffectSpec>)) {
        let values = self.values(strength);
        match self.kind {
            Kind::Catalogue(Cause::Effect(effect)) => effects.push(EffectSpec {
                id: effect.id().to_owned(),
                joints: JointChoice::Many(self.joints.clone()),
                parameters: self.named(strength).into_iter().map(|n| (n.name.to_owned(), n.value)).collect(),
            }),
            Kind::Catalogue(Cause::Coulomb) => {
                self.joints.iter().for_each(|j| truth.friction.entry(j.clone()).or_default().coulomb = Some(values[0]));
            }
            Kind::Catalogue(Cause::Viscous) => {
                self.joints.iter().for_each(|j| truth.friction.entry(j.clone()).or_default().viscous = Some(values[0]));
            }
            Kind::Catalogue(Cause::Payload) => {
                truth.payload.push(PayloadSpec { mass: values[0], body: None, at: [values[1], 0.03, values[2]] });
            }
            Kind::Catalogue(Cause::FloorFriction) => {
                let believed = FloorParameters::default();
                truth.floor.coulomb = Some(values[0]);
                truth.floor.static_friction = Some(values[0] * believed.static_friction / believed.coulomb);
            }
            Kind::Catalogue(Cause::FloorSlope) => truth.slope = values[0],
            Kind::Catalogue(Cause::FloorStiffness) => truth.floor.stiffness = Some(values[0]),
            Kind::Outside(RobotOutside::Boot) => {
                let leg = self.joints.first().map_or("lf", |joint| &joint[..2]);
                let body = Some(format!("{leg}_lower"));
                truth.payload.push(PayloadSpec { mass: values[0], body, at: [0.0, -0.03, 0.0] });
            }
            Kind::Outside(_) => {}
        }
    }

    /// What no spec can say.
    pub fn alteration(&self, strength: f64) -> Option<Altered> {
        match self.kind {
            Kind::Outside(outside) if outside != RobotOutside::Boot => {
                Some(Altered { outside, joints: self.joints.clone(), values: self.values(strength), seed: self.seed })
            }
            _ => None,
        }
    }
}

/// How often all joints of an arm have it.
const ON_ALL: f64 = 0.2;

/// One joint, a left-right or front-rear pair, all joints of a number, or all.
fn place(kind: Kind, scene: &Scene, moving: &[String], dice: &mut Dice) -> Vec<String> {
    use EffectId::{EndStop, JointSpring};
    if let Some(released) = &scene.released {
        return vec![released.clone()];
    }
    if moving.is_empty() {
        return Vec::new();
    }
    let joint = moving[dice.whole(0, moving.len() - 1)].clone();
    if scene.setting == Setting::Arm {
        return if dice.chance(ON_ALL) { moving.to_vec() } else { vec![joint] };
    }
    // These have an angle in them, which not all joints share; a boot is on one leg.
    let few = match kind {
        Kind::Catalogue(Cause::Effect(EndStop | JointSpring)) => 0.75,
        Kind::Outside(RobotOutside::Boot) => 0.0,
        _ => 1.0,
    };
    let (side, end, number) = (&joint[..1], &joint[1..2], &joint[2..]);
    let across = if side == "l" { "r" } else { "l" };
    let along = if end == "f" { "r" } else { "f" };
    let of_names = |is: &dyn Fn(&str) -> bool| moving.iter().filter(|name| is(name)).cloned().collect();
    match dice.uniform(0.0, 1.0) * few {
        x if x < 0.50 => vec![joint],
        x if x < 0.63 => of_names(&|name| name == joint || name == format!("{across}{end}{number}")),
        x if x < 0.75 => of_names(&|name| name == joint || name == format!("{side}{along}{number}")),
        x if x < 0.85 => of_names(&|name| name.ends_with(number)),
        _ => moving.to_vec(),
    }
}

/// From weak to as strong as a robot may plausibly have it, by equal ratios.
fn grow(weak: f64, strong: f64) -> impl Fn(f64) -> f64 + Sync {
    move |strength| weak * math::powf(strong / weak, strength)
}

/// One number that grows, and others that stay.
fn one(weak: f64, strong: f64, others: &[f64]) -> Numbers {
    let (grows, others) = (grow(weak, strong), others.to_vec());
    Box::new(move |strength| std::iter::once(grows(strength)).chain(others.iter().copied()).collect())
}

fn of_cause(cause: Cause, joint: &str, scene: &Scene, plain: &Readings, dice: &mut Dice) -> Numbers {
    use EffectId::*;
    let [low, high] = plain.range(joint);
    let span = (high - low).max(0.02);
    let sign = dice.sign();
    let ([coulomb, viscous], nm) = (scene.friction(joint), scene.torque);
    let floor = FloorParameters::default();
    match cause {
        Cause::Effect(effect) => match effect {
            Stribeck => {
                let (grows, v_st) = (grow(0.002 * nm, 0.4 * nm), dice.log_uniform(0.03, 0.5));
                Box::new(move |strength| vec![coulomb + grows(strength), v_st])
            }
            LoadFriction => one(0.02, 1.0, &[]),
            GearFriction => one(0.01, 0.9, &[]),
            QuadraticDrag => one(1e-4 * nm, 0.2 * nm, &[]),
            AsymmetricFriction => one(sign * 5e-4 * nm, sign * 0.1 * nm, &[]),
            PositionFriction => one(0.2, 2.0, &[dice.uniform(-PI, PI)]),
            FrictionDrift => one(0.02, 0.6, &[]),
            Backlash => one(0.003, 0.12, &[dice.uniform(0.15, 0.5)]),
            JointSpring => one(0.005 * nm, 4.0 * nm, &[low - 0.3 + dice.uniform(0.0, 1.0) * (span + 0.6)]),
            EndStop => {
                let (depth, stiffness) = (grow(0.01, 0.5), nm * dice.log_uniform(10.0, 60.0));
                let damping = 0.002 * stiffness;
                let from = if sign > 0.0 { high } else { low };
                Box::new(move |strength| vec![from - sign * depth(strength) * span, sign, stiffness, damping])
            }
            AngleOffset => one(sign * 0.002, sign * 0.15, &[]),
            SensorGain => one(sign * 0.004, sign * 0.3, &[]),
            Delay => one(0.001, 0.12, &[]),
            SetpointHold => one(0.010, 0.25, &[]),
            DeadBand => one(0.003 * nm, 0.6 * nm, &[]),
            SetpointProfile => one(8.0, 0.2, &[dice.log_uniform(5.0, 60.0)]),
            // Whole robots do not have them, so they are never drawn.
            Compliance | SensorDelay => Box::new(|_| Vec::new()),
            TorqueLimit => one(1.5 * nm, 0.01 * nm, &[]),
            SpeedLimit => one(15.0, 0.4, &[nm * dice.log_uniform(0.3, 1.2)]),
            MotorGain => {
                let grows = grow(0.01, if sign > 0.0 { 1.0 } else { 0.8 });
                Box::new(move |strength| vec![1.0 + sign * grows(strength)])
            }
        },
        Cause::Coulomb => {
            let grows = grow(0.002 * nm, 0.3 * nm);
            Box::new(move |strength| vec![coulomb + grows(strength)])
        }
        Cause::Viscous => {
            let grows = grow(0.002 * nm, 0.5 * nm);
            Box::new(move |strength| vec![viscous + grows(strength)])
        }
        Cause::Payload => {
            one(0.02 * scene.mass, 0.7 * scene.mass, &[dice.uniform(-0.03, 0.03), dice.uniform(-0.08, 0.08)])
        }
        Cause::FloorFriction => one(0.9 * floor.coulomb, 0.08, &[]),
        Cause::FloorSlope => one(sign * 0.003, sign * 0.12, &[0.0]),
        Cause::FloorStiffness => {
            let to = if dice.chance(0.7) { 0.02 } else { 20.0 };
            one(floor.stiffness_n_m * if to < 1.0 { 0.9 } else { 1.1 }, floor.stiffness_n_m * to, &[])
        }
    }
}

fn of_outside(outside: RobotOutside, scene: &Scene, plain: &Readings, dice: &mut Dice) -> Numbers {
    let nm = scene.torque;
    match outside {
        RobotOutside::Boot => one(0.003 * scene.mass, 0.15 * scene.mass, &[]),
        RobotOutside::TiltedTrunk => one(0.02, 0.5, &[dice.uniform(-PI, PI)]),
        RobotOutside::CoarseSetpoints => one(0.005, 0.25, &[]),
        RobotOutside::LostSetpoints => one(0.002, 0.15, &[]),
        RobotOutside::SlowSetpoints => one(0.002, 0.2, &[]),
        RobotOutside::Cogging => one(0.002 * nm, 0.3 * nm, &[dice.uniform(12.0, 40.0)]),
        RobotOutside::HotGear => {
            let samples = plain.angle_rad.values().next().map_or(1, Vec::len);
            one(0.002, 0.9, &[0.008 * samples as f64])
        }
    }
}
