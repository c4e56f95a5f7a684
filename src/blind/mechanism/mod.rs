//! Mechanisms: how each effect is put into a made joint, at any size.
//!
//! Half of the studies use the catalogue's definitions to the letter, the others a variant of the same physics.

mod friction;
mod link;
mod motor;
mod outside;
mod outside_drive;
pub(super) mod servo;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod two_programs;

use super::cause::OutsideId;
use super::dice::Dice;
use super::joint::Joint;
use super::plan::LogPlan;
use super::sim::{Machine, Trace};
use super::truth::TrueNumber;
use crate::joint::EffectId;

/// Puts a mechanism of a size into a joint, and says by which numbers.
type Install = Box<dyn Fn(f64, &mut Machine) -> Vec<TrueNumber>>;

/// A mechanism with everything drawn but its size.
pub(super) struct Mechanism {
    /// Smallest and largest plausible size; growing sizes have growing consequences.
    pub range: [f64; 2],
    /// Between which values of what it depends on it acts; `None`: everywhere.
    pub place: Option<[f64; 2]>,
    install: Install,
}

impl Mechanism {
    fn new(range: [f64; 2], install: impl Fn(f64, &mut Machine) -> Vec<TrueNumber> + 'static) -> Self {
        Self { range, place: None, install: Box::new(install) }
    }

    /// Acts only between these values of what it depends on.
    fn between(self, place: [f64; 2]) -> Self {
        Self { place: Some(place), ..self }
    }

    /// Puts it in.
    pub(super) fn install(&self, size: f64, machine: &mut Machine) -> Vec<TrueNumber> {
        (self.install)(size, machine)
    }
}

/// What the joint does before anything is the matter with it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Typical {
    /// Lowest and highest angle of all logs \[rad\].
    pub lowest_rad: f64,
    pub highest_rad: f64,
    /// Speed that is passed in one sample of ten \[rad/s\].
    pub speed_rad_s: f64,
    /// Speed that is passed in one sample of fifty of the driven logs \[rad/s\].
    pub driven_speed_rad_s: f64,
    /// Commanded torque that is passed in one sample of fifty of the driven logs \[N m\].
    pub torque_nm: f64,
    /// Longest log \[s\].
    pub longest_s: f64,
}

impl Typical {
    /// Looks at the logs of the plain joint.
    pub(super) fn of(plans: &[LogPlan], traces: &[Trace]) -> Self {
        let (mut speeds, mut driven_speeds, mut torques) = (Vec::new(), Vec::new(), Vec::new());
        let mut typical = Self::default();
        for (plan, trace) in plans.iter().zip(traces) {
            for (t, q) in plan.times_s.windows(2).zip(trace.q_rad.windows(2)) {
                let speed = ((q[1] - q[0]) / (t[1] - t[0])).abs();
                speeds.push(speed);
                if plan.is_driven() {
                    driven_speeds.push(speed);
                }
            }
            if plan.is_driven() {
                torques.extend(trace.tau_nm.iter().map(|tau| tau.abs()));
            }
            for &q in &trace.q_rad {
                typical.lowest_rad = typical.lowest_rad.min(q);
                typical.highest_rad = typical.highest_rad.max(q);
            }
            typical.longest_s = typical.longest_s.max(plan.times_s.last().copied().unwrap_or(0.0));
        }
        typical.speed_rad_s = passed(&mut speeds, 0.9);
        typical.driven_speed_rad_s = passed(&mut driven_speeds, 0.98);
        typical.torque_nm = passed(&mut torques, 0.98);
        typical
    }
}

/// The value below which a share of the values lies; 1 where there are none.
fn passed(values: &mut [f64], share: f64) -> f64 {
    if values.is_empty() {
        return 1.0;
    }
    let k = ((values.len() - 1) as f64 * share) as usize;
    let (_, value, _) = values.select_nth_unstable_by(k, f64::total_cmp);
    value.max(1e-6)
}

/// Where a mechanism is to be put in.
pub(super) struct Scene<'a> {
    pub joint: &'a Joint,
    pub plans: &'a [LogPlan],
    pub typical: Typical,
    /// By the catalogue's definition, to the letter.
    pub textbook: bool,
}

impl Scene<'_> {
    fn peak_nm(&self) -> f64 {
        self.joint.peak_gravity_nm()
    }
}

/// Draws an effect of the catalogue.
pub(super) fn effect(id: EffectId, scene: &Scene<'_>, dice: &mut Dice) -> Mechanism {
    use EffectId::*;
    match id {
        Stribeck => friction::stribeck(scene, dice),
        LoadFriction => friction::load(scene, dice),
        GearFriction => friction::gear(scene),
        QuadraticDrag => friction::drag(scene),
        AsymmetricFriction => friction::asymmetric(scene, dice),
        PositionFriction => friction::over_angle(scene, dice),
        FrictionDrift => friction::drift(scene, dice),
        Backlash => link::backlash(scene, dice),
        JointSpring => link::spring(scene, dice),
        EndStop => link::stop(scene, dice),
        AngleOffset => link::offset(dice),
        SensorGain => link::gain(dice),
        Delay => motor::delay(scene, dice),
        SetpointHold => motor::hold(scene, dice),
        TorqueLimit => motor::torque_limit(scene, dice),
        Compliance => link::compliance(scene, dice),
        SensorDelay => link::late(),
        SetpointProfile => motor::profile(scene, dice),
        DeadBand => motor::dead_band(scene, dice),
        SpeedLimit => motor::speed_limit(scene, dice),
        MotorGain => motor::gain(dice),
    }
}

/// Draws a mechanism that the catalogue does not have.
pub(super) fn outside(id: OutsideId, scene: &Scene<'_>, dice: &mut Dice) -> Mechanism {
    use OutsideId::*;
    match id {
        Cogging => outside::cogging(scene, dice),
        SoftPresliding => outside::soft(scene),
        EncoderHarmonic => outside::harmonic(dice),
        FrictionMemory => outside::memory(scene, dice),
        FrictionJump => outside::jump(scene, dice),
        BaseSway => outside::sway(scene, dice),
        AngleViscous => outside::angle_viscous(dice),
        MagneticDetent => outside::detent(scene, dice),
        HystereticSpring => outside::cable(scene, dice),
        Knocks => outside::knocks(scene, dice),
        SupplySag => outside_drive::sag(),
        EncoderDrift => outside::drift(dice),
        TorqueRipple => outside_drive::ripple(dice),
        ProgressiveGain => outside_drive::progressive(scene),
        HiddenIntegral => outside_drive::integral(),
    }
}
