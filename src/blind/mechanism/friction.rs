//! Effects of the catalogue that are friction.

use super::{Mechanism, Scene};
use crate::blind::dice::Dice;
use crate::blind::sim::{Curve, OverAngle, Stribeck};
use crate::blind::truth::TrueNumber;
use crate::number::math;

/// Size: `mu_st - mu_c`.
pub(super) fn stribeck(scene: &Scene<'_>, dice: &mut Dice) -> Mechanism {
    let coulomb = scene.joint.coulomb_nm;
    let speed_rad_s = scene.typical.speed_rad_s * dice.log_uniform(0.05, 0.5);
    let curve = if scene.textbook { Curve::Gaussian } else { dice.pick(&[Curve::Exponential, Curve::Rational]) };
    let most = (1.5 * coulomb).max(0.06 * scene.peak_nm());
    Mechanism::new([0.005 * scene.peak_nm(), most], move |excess_nm, machine| {
        machine.friction.stribeck = Some(Stribeck { excess_nm, speed_rad_s, curve });
        vec![TrueNumber::new("mu_st", "N m", coulomb + excess_nm), TrueNumber::new("v_st", "rad/s", speed_rad_s)]
    })
}

/// Size: `mu_l`. The variant presses a little by the force along the link too.
pub(super) fn load(scene: &Scene<'_>, dice: &mut Dice) -> Mechanism {
    let along = if scene.textbook { 0.0 } else { dice.uniform(0.1, 0.35) };
    Mechanism::new([0.01, 0.3], move |share, machine| {
        machine.friction.load = share;
        machine.friction.load_along = along;
        vec![TrueNumber::new("mu_l", "", share)]
    })
}

/// Size: `mu_g`. The variant's loss begins slowly, as `tau^2 / (|tau| + knee)`.
pub(super) fn gear(scene: &Scene<'_>) -> Mechanism {
    let knee_nm = if scene.textbook { 0.0 } else { 0.1 * scene.typical.torque_nm };
    Mechanism::new([0.01, 0.3], move |share, machine| {
        machine.friction.gear = share;
        machine.friction.gear_knee_nm = knee_nm;
        vec![TrueNumber::new("mu_g", "", share)]
    })
}

/// Size: `c2`. The variant goes with `|v|^1.8` and is as large at the typical speed.
pub(super) fn drag(scene: &Scene<'_>) -> Mechanism {
    let speed = scene.typical.speed_rad_s;
    let unit = scene.peak_nm() / speed.powi(2);
    let power = if scene.textbook { 2.0 } else { 1.8 };
    Mechanism::new([0.01 * unit, 0.8 * unit], move |c2, machine| {
        machine.friction.drag = c2 * math::powf(speed, 2.0 - power);
        machine.friction.drag_power = power;
        vec![TrueNumber::new("c2", "N m s^2/rad^2", c2)]
    })
}

/// Size: `|delta|`. The variant's difference is a third smaller near standstill.
pub(super) fn asymmetric(scene: &Scene<'_>, dice: &mut Dice) -> Mechanism {
    let (sign, coulomb) = (dice.sign(), scene.joint.coulomb_nm);
    let fade = if scene.textbook { 0.0 } else { 0.2 * scene.typical.speed_rad_s };
    Mechanism::new([0.03 * coulomb, 0.95 * coulomb], move |size, machine| {
        machine.friction.asymmetry_nm = sign * size;
        machine.friction.asymmetry_fade_rad_s = fade;
        vec![TrueNumber::new("delta", "N m", sign * size)]
    })
}

/// Size: `a`. The variant has one narrow bump.
pub(super) fn over_angle(scene: &Scene<'_>, dice: &mut Dice) -> Mechanism {
    let (phi_rad, narrow) = (dice.uniform(-3.1, 3.1), !scene.textbook);
    Mechanism::new([0.05, 1.0], move |a, machine| {
        machine.friction.over_angle = Some(OverAngle { a, phi_rad, narrow });
        vec![TrueNumber::new("a", "", a), TrueNumber::new("phi", "rad", phi_rad)]
    })
}

/// Size: `|r|`. The variant comes to rest, with a time constant about the length of a log.
pub(super) fn drift(scene: &Scene<'_>, dice: &mut Dice) -> Mechanism {
    let longest_s = scene.typical.longest_s;
    let sign = dice.sign();
    // friction never falls below a fifth of what it was
    let most = if sign > 0.0 { 0.4 } else { 0.8 / longest_s };
    let settles_s = if scene.textbook { 0.0 } else { longest_s * dice.uniform(0.6, 1.5) };
    Mechanism::new([0.005, most], move |size, machine| {
        machine.friction.drift_1_s = sign * size;
        machine.friction.drift_settles_s = settles_s;
        vec![TrueNumber::new("r", "1/s", sign * size)]
    })
}
