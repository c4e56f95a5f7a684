//! From where a cause's values are searched, and within which bounds.

use super::cause::Cause;
use crate::joint::{EffectId, EffectParameter, Reach, Scan};
use crate::number::math::powf;
use crate::robot::FloorParameters;
use std::f64::consts::FRAC_PI_2;

/// Values from which a search starts.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Start {
    /// As they are searched.
    pub values: Vec<f64>,
    /// The response grows about in proportion to the distance of the first `sizes` values from here.
    zero: f64,
    sizes: usize,
    /// Amplitudes that are allowed, in units of that distance; from 1 to 1 where the response is not proportional.
    pub amplitude: [f64; 2],
}

impl Start {
    fn at_size(values: &[f64], zero: f64, amplitude: [f64; 2]) -> Self {
        Self { values: values.to_vec(), zero, sizes: 1, amplitude }
    }

    pub fn fixed(values: &[f64]) -> Self {
        Self { values: values.to_vec(), zero: 0.0, sizes: 0, amplitude: [1.0, 1.0] }
    }

    /// Whether the response grows about in proportion.
    pub fn is_proportional(&self) -> bool {
        self.amplitude != [1.0, 1.0]
    }

    /// The values at an amplitude.
    pub fn at(&self, amplitude: f64) -> Vec<f64> {
        let mut values = self.values.clone();
        for value in values.iter_mut().take(self.sizes) {
            *value = self.zero + amplitude * (*value - self.zero);
        }
        values
    }
}

/// How many starts are tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Grid {
    /// So many that none is far from the truth.
    Fine,
    /// Fewer, where every try is a walk of the whole robot.
    Coarse,
}

/// How far beyond what the logs show a joint's travel may go \[rad\], and how many times the torque that its motor is
/// asked for friction may have: a walk uses little of either.
const BEYOND_RAD: f64 = 0.6;
const BEYOND_TORQUE: f64 = 3.0;
/// How far the zero of an angle may be off \[rad\].
const ZERO_RAD: f64 = 0.4;

/// Holds of the setpoint, in periods of the log at least, and at most \[s\].
const SHORTEST_HOLD: f64 = 0.5;
const LONGEST_HOLD_S: f64 = 0.5;

fn beyond(reach: &Reach) -> Reach {
    let [low, high] = reach.angle_rad;
    Reach { angle_rad: [low - BEYOND_RAD, high + BEYOND_RAD], torque_nm: BEYOND_TORQUE * reach.torque_nm, ..*reach }
}

/// Torque of a joint [N m] and mass of a robot [kg] up to which the sizes below hold; those of larger ones grow in proportion,
/// lengths with the cube root of the mass.
const STRONG_NM: f64 = 1.0;
const HEAVY_KG: f64 = 1.7;
/// Share of its motor's torque by which a search moves a joint's friction in a step; and how many times as much it may be.
const FRICTION_STEP: f64 = 0.05;
const FRICTION_MOST: f64 = 3.0;

/// What a robot's causes are measured by, beside the reach of their joint.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body {
    pub floor: FloorParameters,
    pub mass_kg: f64,
}

impl Body {
    fn larger(&self) -> f64 {
        (self.mass_kg / HEAVY_KG).max(1.0)
    }

    fn longer(&self) -> f64 {
        powf(self.larger(), 1.0 / 3.0)
    }
}

fn stronger(reach: &Reach) -> f64 {
    (reach.torque_nm / STRONG_NM).max(1.0)
}

const EITHER_WAY: [f64; 2] = [-20.0, 20.0];
const GROWN: [f64; 2] = [0.0, 20.0];

impl Cause {
    /// Values at which it is tried first, on a joint of a reach and a friction (Coulomb, viscous), on a robot.
    pub(super) fn starts(self, reach: &Reach, [coulomb, viscous]: [f64; 2], body: &Body, grid: Grid) -> Vec<Start> {
        use EffectId as E;
        let is_coarse = grid == Grid::Coarse;
        let size = |values: &[f64], amplitude| Start::at_size(values, 0.0, amplitude);
        // On the floor what is tried has to rise above where feet happen to land.
        let strong = stronger(reach);
        let of = |in_the_air: f64, on_the_floor: f64| strong * if is_coarse { on_the_floor } else { in_the_air };
        let [low, high] = reach.angle_rad;
        let span = (high - low).max(1e-3);
        let (speed, most) = (reach.speed_rad_s, reach.driven.map_or(reach.torque_nm, |driven| driven.command_nm));
        let period_s = reach.driven.map_or(0.008, |driven| driven.period_s);
        match self {
            Cause::Effect(E::Stribeck) => {
                let speeds: &[f64] = if is_coarse { &[0.05, 0.4] } else { &[0.05, 0.15, 0.4] };
                speeds.iter().map(|speed| size(&[of(0.01, 0.02), *speed], GROWN)).collect()
            }
            Cause::Effect(E::LoadFriction) => vec![size(&[0.2], GROWN)],
            Cause::Effect(E::GearFriction) => vec![size(&[0.1], [0.0, 5.0]), Start::fixed(&[0.7])],
            Cause::Effect(E::QuadraticDrag) => vec![size(&[of(0.003, 0.02)], GROWN)],
            Cause::Effect(E::AsymmetricFriction) => {
                vec![size(&[of(0.3 * coulomb.max(1e-3) / strong, 0.004)], EITHER_WAY)]
            }
            Cause::Effect(E::PositionFriction) => {
                let quarters: &[f64] = if is_coarse { &[0.0, 2.0] } else { &[0.0, 1.0, 2.0, -1.0] };
                quarters.iter().map(|quarters| size(&[0.5, quarters * FRAC_PI_2], [0.0, 2.0])).collect()
            }
            Cause::Effect(E::FrictionDrift) => {
                let rate = if is_coarse { 0.15 } else { 0.02 };
                vec![size(&[rate], [-0.08 / rate, 1.0 / rate])]
            }
            Cause::Effect(E::Backlash) => {
                let plays: &[f64] = if is_coarse { &[0.03] } else { &[0.007, 0.015, 0.03, 0.06, 0.1] };
                plays.iter().map(|play| Start::fixed(&[*play, 0.25])).collect()
            }
            Cause::Effect(E::JointSpring) => {
                let away: &[f64] = if is_coarse { &[0.1] } else { &[0.1, 0.35] };
                let rests = away.iter().flat_map(|away| [low - away, high + away]);
                let middle = 0.5 * (low + high);
                // To first order a stiff spring looks soft.
                let stiff = Start::fixed(&[3.0 * strong, middle]);
                rests.chain([middle]).map(|rest| size(&[0.05 * strong, rest], GROWN)).chain([stiff]).collect()
            }
            Cause::Effect(E::EndStop) => {
                let shares: &[f64] = if is_coarse { &[0.04, 0.2] } else { &[0.01, 0.04, 0.1, 0.2, 0.35] };
                let stiffness = 30.0 * most / span;
                let damping = 0.1 * (stiffness * reach.inertia_kg_m2).sqrt();
                let places = shares.iter().flat_map(|share| [(high - share * span, 1.0), (low + share * span, -1.0)]);
                places.map(|(angle, side)| Start::fixed(&[angle, side, stiffness, damping])).collect()
            }
            Cause::Effect(E::AngleOffset) => vec![size(&[if is_coarse { 0.06 } else { 0.02 }], [-8.0, 8.0])],
            Cause::Effect(E::SensorGain) => vec![size(&[0.02], [-8.0, 8.0])],
            Cause::Effect(E::Delay) => [0.006, 0.02, 0.06].map(|late| size(&[late], [0.3, 2.0])).to_vec(),
            Cause::Effect(E::SetpointHold) => {
                let periods: &[f64] = if is_coarse {
                    &[3.0, 6.0, 10.0, 16.0]
                } else {
                    &[2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 16.0, 20.0, 25.0]
                };
                periods.iter().map(|n| Start::fixed(&[n * period_s])).collect()
            }
            Cause::Effect(E::DeadBand) => {
                [0.03, 0.1, 0.3].map(|share| Start::at_size(&[share * most], 0.0, [0.1, 3.0])).to_vec()
            }
            Cause::Effect(E::SetpointProfile) => {
                let coarse = [(0.5, 10.0), (1.0, 10.0), (1.0, 40.0)];
                let more = [(0.3, 30.0), (0.7, 4.0), (3.0, 5.0), (3.0, 20.0)];
                let more = if is_coarse { &more[..0] } else { &more[..] };
                let limits = coarse.iter().chain(more);
                limits.map(|(share, per_s)| Start::fixed(&[share * speed, per_s * speed])).collect()
            }
            // The trees have neither; they are not among the causes.
            Cause::Effect(E::Compliance | E::SensorDelay) => Vec::new(),
            Cause::Effect(E::TorqueLimit) => {
                let shares: &[f64] = if is_coarse {
                    &[0.9, 0.75, 0.6, 0.45, 0.3]
                } else {
                    &[0.97, 0.92, 0.86, 0.8, 0.74, 0.67, 0.6, 0.52, 0.44, 0.35, 0.25]
                };
                shares.iter().map(|share| Start::fixed(&[share * most])).collect()
            }
            Cause::Effect(E::SpeedLimit) => {
                let coarse = [(1.1, 0.5), (1.6, 1.0), (1.6, 0.5), (0.7, 2.0)];
                let more = [(1.1, 1.0), (3.0, 0.9), (3.0, 0.6), (0.3, 4.0), (0.5, 8.0), (0.9, 5.0), (0.5, 2.0)];
                let more = if is_coarse { &more[..0] } else { &more[..] };
                coarse
                    .iter()
                    .chain(more)
                    .map(|(no_load, stall)| Start::fixed(&[no_load * speed, stall * most]))
                    .collect()
            }
            Cause::Effect(E::MotorGain) => {
                let far = [0.45, 0.2].map(|gain| Start::fixed(&[gain]));
                std::iter::once(Start::at_size(&[0.8], 1.0, [-10.0, 4.5])).chain(far).collect()
            }
            Cause::Coulomb => {
                let more = of(0.003, 0.005);
                vec![Start::at_size(&[coulomb + more], coulomb, [-coulomb / more, 60.0])]
            }
            Cause::Viscous => {
                let more = of(0.004, 0.01);
                vec![Start::at_size(&[viscous + more], viscous, [-viscous / more, 60.0])]
            }
            Cause::Payload => [[0.0, 0.0], [0.0, -0.07], [0.0, 0.07], [0.04, 0.0], [-0.04, 0.0]]
                .map(|at| at.map(|m| m * body.longer()))
                .map(|[right, rear]| size(&[0.15 * body.larger(), right, rear], [0.1, 5.0]))
                .into_iter()
                .chain([Start::fixed(&[0.6 * body.larger(), 0.0, 0.0])])
                .collect(),
            Cause::FloorFriction => {
                [0.3, 0.5, 0.7, 1.5].map(|share| Start::fixed(&[share * body.floor.coulomb])).to_vec()
            }
            Cause::FloorSlope => [[0.02, 0.0], [-0.02, 0.0], [0.0, 0.02], [0.0, -0.02]]
                .map(|slope| Start { sizes: 2, ..size(&slope, [0.2, 4.0]) })
                .to_vec(),
            Cause::FloorStiffness => {
                [0.15, 0.4, 2.5].map(|share| Start::fixed(&[share * body.floor.stiffness_n_m])).to_vec()
            }
        }
    }

    /// How its values are searched.
    pub(super) fn parameters(self, reach: &Reach, body: &Body) -> Vec<EffectParameter> {
        let linear = |name, unit, [lower, upper]: [f64; 2], scale| EffectParameter {
            name,
            unit,
            lower,
            upper,
            scan: Scan::Linear(scale),
            likely: None,
        };
        let logarithm = |name, unit, [lower, upper]: [f64; 2]| EffectParameter {
            name,
            unit,
            lower,
            upper,
            scan: Scan::Logarithm,
            likely: None,
        };
        match self {
            Cause::Effect(effect @ (EffectId::AsymmetricFriction | EffectId::Stribeck)) => {
                effect.parameters(&beyond(reach))
            }
            // From one that hardly shows to one that holds the joint.
            Cause::Effect(EffectId::JointSpring) => {
                let mut parameters = EffectId::JointSpring.parameters(&beyond(reach));
                parameters[0] = logarithm("k", "N m/rad", [1e-3, 300.0].map(|share| share * reach.torque_nm));
                parameters
            }
            Cause::Effect(EffectId::SpeedLimit) => {
                let most_nm = reach.driven.map_or(reach.torque_nm, |driven| driven.command_nm);
                vec![
                    logarithm("w_max", "rad/s", [0.15 * reach.speed_rad_s, 5.0 * reach.speed_rad_s]),
                    logarithm("tau_stall", "N m", [0.02 * most_nm, 20.0 * most_nm]),
                ]
            }
            Cause::Effect(EffectId::FrictionDrift) => {
                let unit = 1.0 / reach.duration_s;
                vec![linear("r", "1/s", [-0.98 * unit, 20.0 * unit], unit)]
            }
            // An encoder's zero is off by a tooth of a gear, not by half a turn.
            Cause::Effect(EffectId::AngleOffset) => vec![linear("d", "rad", [-ZERO_RAD, ZERO_RAD], 0.1)],
            // What moves the last hold of a log by a period.
            Cause::Effect(EffectId::SetpointHold) => {
                let period_s = reach.driven.map_or(0.001, |driven| driven.period_s);
                let steps_s = period_s.powi(2) / reach.duration_s;
                vec![linear("T_h", "s", [SHORTEST_HOLD * period_s, LONGEST_HOLD_S], steps_s)]
            }
            Cause::Effect(effect) => effect.parameters(reach),
            Cause::Coulomb => {
                let [step, most] = [FRICTION_STEP, FRICTION_MOST].map(|share| share * reach.torque_nm);
                vec![linear("mu_c", "N m", [0.0, most.max(0.5)], step.max(0.005))]
            }
            Cause::Viscous => {
                let [step, most] =
                    [FRICTION_STEP, FRICTION_MOST].map(|share| share * reach.torque_nm / reach.speed_rad_s);
                vec![linear("mu_v", "N m s/rad", [0.0, most.max(1.0)], step.max(0.01))]
            }
            Cause::Payload => {
                let within = |most: f64| [-most, most].map(|m| m * body.longer());
                vec![
                    linear("mass", "kg", [0.0, 2.0 * body.larger()], 0.1 * body.larger()),
                    linear("right", "m", within(0.1), 0.03 * body.longer()),
                    linear("rear", "m", within(0.15), 0.05 * body.longer()),
                ]
            }
            Cause::FloorFriction => vec![logarithm("mu", "", [0.03, 3.0])],
            Cause::FloorSlope => {
                vec![linear("forward", "rad", [-0.4, 0.4], 0.03), linear("right", "rad", [-0.4, 0.4], 0.03)]
            }
            Cause::FloorStiffness => {
                vec![logarithm("stiffness", "N/m", [0.02, 50.0].map(|share| share * body.floor.stiffness_n_m))]
            }
        }
    }

    /// The values under the names of [`Cause::named`], of those that are searched.
    pub(super) fn to_named(self, searched: &[f64], coulomb_nm: f64) -> Vec<f64> {
        match self {
            Cause::Effect(effect) => effect.named(searched, coulomb_nm),
            _ => searched.to_vec(),
        }
    }
}
