//! Effects of the catalogue between setpoint and motor.

use super::{Mechanism, Scene};
use crate::blind::dice::Dice;
use crate::blind::truth::TrueNumber;
use crate::number::math;

/// Size: `T`. The variant's changes come up to a quarter of it earlier or later.
pub(super) fn delay(scene: &Scene<'_>, dice: &mut Dice) -> Mechanism {
    let (jitter, seed) = (if scene.textbook { 0.0 } else { 0.25 }, dice.seed());
    Mechanism::new([0.002, 0.04], move |delay_s, machine| {
        machine.drive.delay_s = delay_s;
        machine.drive.delay_jitter = jitter;
        machine.drive.jitter_seed = seed;
        vec![TrueNumber::new("T", "s", delay_s)]
    })
}

/// Size: `T_h`. The variant's instants wander by up to an eighth of it.
pub(super) fn hold(scene: &Scene<'_>, dice: &mut Dice) -> Mechanism {
    let (jitter, seed) = (if scene.textbook { 0.0 } else { 0.25 }, dice.seed());
    let least = (2.0 * scene.joint.sensor.period_s * scene.joint.setpoint_every as f64).max(0.016);
    Mechanism::new([least, 0.13], move |hold_s, machine| {
        machine.drive.hold_s = hold_s;
        machine.drive.hold_jitter = jitter;
        machine.drive.jitter_seed = seed;
        vec![TrueNumber::new("T_h", "s", hold_s)]
    })
}

/// Size: how many times the largest torque that is often commanded exceeds the limit, as a logarithm. The variant's
/// limit is round.
pub(super) fn torque_limit(scene: &Scene<'_>, dice: &mut Dice) -> Mechanism {
    let power = if scene.textbook { 0.0 } else { dice.uniform(4.0, 8.0) };
    let peak_nm = 1.3 * scene.typical.torque_nm;
    // the link can still be lifted
    let least_nm = (1.1 * (0.7 * scene.peak_nm() + scene.joint.coulomb_nm)).min(0.7 * peak_nm);
    Mechanism::new([0.02, math::ln(peak_nm / least_nm)], move |size, machine| {
        let limit_nm = peak_nm * math::exp(-size);
        machine.drive.limit_nm = limit_nm;
        machine.drive.limit_power = power;
        vec![TrueNumber::new("tau_max", "N m", limit_nm)]
    })
}

/// Size: how many times two and a half times the typical speed exceeds the no-load speed, as a logarithm.
///
/// A no-load speed far above the motion would leave nothing but a torque limit.
pub(super) fn speed_limit(scene: &Scene<'_>, dice: &mut Dice) -> Mechanism {
    let stall_nm = scene.typical.torque_nm * dice.uniform(0.7, 2.0);
    let fast = 2.5 * scene.typical.driven_speed_rad_s;
    Mechanism::new([0.01, 1.7], move |size, machine| {
        let no_load = fast * math::exp(-size);
        machine.drive.speed = Some([no_load, stall_nm]);
        vec![TrueNumber::new("w_max", "rad/s", no_load), TrueNumber::new("tau_stall", "N m", stall_nm)]
    })
}

/// Size: `|ln c|`.
pub(super) fn gain(dice: &mut Dice) -> Mechanism {
    let sign = if dice.chance(0.65) { -1.0 } else { 1.0 };
    Mechanism::new([0.01, 0.6], move |size, machine| {
        let c = math::exp(sign * size);
        machine.drive.gain = c;
        vec![TrueNumber::new("c", "", c)]
    })
}

/// Size: how many times six times the typical speed exceeds `v_max`, as a logarithm. The variant does not limit the
/// acceleration.
pub(super) fn profile(scene: &Scene<'_>, dice: &mut Dice) -> Mechanism {
    let fast = 6.0 * scene.typical.driven_speed_rad_s;
    let (speeds_up_s, textbook) = (dice.log_uniform(0.02, 0.2), scene.textbook);
    Mechanism::new([0.05, 3.0], move |size, machine| {
        let v_max = fast * math::exp(-size);
        machine.drive.slew_rad_s = v_max;
        let mut numbers = vec![TrueNumber::new("v_max", "rad/s", v_max)];
        if textbook {
            machine.drive.slew_rad_s2 = v_max / speeds_up_s;
            numbers.push(TrueNumber::new("a_max", "rad/s^2", v_max / speeds_up_s));
        }
        numbers
    })
}

/// Size: `tau_0`. Of the variants half lose less of larger commands, half ignore small errors instead of small commands.
pub(super) fn dead_band(scene: &Scene<'_>, dice: &mut Dice) -> Mechanism {
    let takes = if scene.textbook { 1.0 } else { dice.uniform(0.0, 0.8) };
    let (of_errors, kp) = (!scene.textbook && dice.chance(0.5), scene.joint.kp);
    let typical_nm = scene.typical.torque_nm;
    Mechanism::new([0.005 * typical_nm, 0.5 * typical_nm], move |torque_nm, machine| {
        if of_errors {
            machine.drive.dead_zone_rad = torque_nm / kp;
        } else {
            machine.drive.dead_band_nm = torque_nm;
            machine.drive.dead_band_takes = takes;
        }
        vec![TrueNumber::new("tau_0", "N m", torque_nm)]
    })
}
