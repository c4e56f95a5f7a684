//! Mechanisms in joint and sensor that the catalogue does not have.

use super::{Mechanism, Scene};
use crate::blind::dice::Dice;
use crate::blind::sim::{Curve, Knock, Stribeck};
use crate::blind::truth::TrueNumber;
use crate::number::math;
use std::f64::consts::TAU;

/// Size: its torque.
pub(super) fn cogging(scene: &Scene<'_>, dice: &mut Dice) -> Mechanism {
    let (n, phi) = (dice.whole(8, 28) as f64, dice.uniform(0.0, TAU));
    let peak = scene.peak_nm();
    Mechanism::new([0.01 * peak, 0.6 * peak], move |torque_nm, machine| {
        machine.link.cogging = Some([torque_nm, n, phi]);
        vec![TrueNumber::new("torque", "N m", torque_nm), TrueNumber::new("periods", "", n)]
    })
}

/// Size: the displacement over which friction builds up.
pub(super) fn soft(scene: &Scene<'_>) -> Mechanism {
    let least = 2.0 * scene.joint.sensor.resolution_rad;
    Mechanism::new([least, 0.5_f64.max(4.0 * least)], move |bristle_rad, machine| {
        machine.friction.soften(bristle_rad, machine.inertia_kg_m2);
        vec![TrueNumber::new("displacement", "rad", bristle_rad)]
    })
}

/// Size: its amplitude.
pub(super) fn harmonic(dice: &mut Dice) -> Mechanism {
    let (n, phi_rad) = (dice.whole(5, 16) as f64, dice.uniform(0.0, TAU));
    Mechanism::new([0.0005, 0.05], move |a_rad, machine| {
        machine.reading.a_rad = a_rad;
        machine.reading.n = n;
        machine.reading.phi_rad = phi_rad;
        vec![TrueNumber::new("amplitude", "rad", a_rad), TrueNumber::new("periods", "", n)]
    })
}

/// Size: static friction above Coulomb's, which comes back and goes away late.
pub(super) fn memory(scene: &Scene<'_>, dice: &mut Dice) -> Mechanism {
    let speed_rad_s = scene.typical.speed_rad_s * dice.uniform(0.3, 0.8);
    let lag_s = dice.uniform(0.1, 0.4);
    let coulomb = scene.joint.coulomb_nm;
    let peak = scene.peak_nm();
    Mechanism::new([0.01 * peak, (2.0 * coulomb).max(0.15 * peak)], move |excess_nm, machine| {
        machine.friction.stribeck = Some(Stribeck { excess_nm, speed_rad_s, curve: Curve::Gaussian });
        machine.friction.memory_s = lag_s;
        vec![TrueNumber::new("excess", "N m", excess_nm), TrueNumber::new("lag", "s", lag_s)]
    })
}

/// Size: the factor by which Coulomb friction grows, as a logarithm.
pub(super) fn jump(scene: &Scene<'_>, dice: &mut Dice) -> Mechanism {
    let at_s: Vec<f64> = scene.plans.iter().map(|plan| moment(plan, dice, 0.15, 0.6)).collect();
    Mechanism::new([0.05, 2.0], move |size, machine| {
        machine.friction.jump = math::exp(size);
        machine.friction.jump_at_s.clone_from(&at_s);
        vec![TrueNumber::new("factor", "", math::exp(size))]
    })
}

/// An instant between two shares of a log.
fn moment(plan: &crate::blind::plan::LogPlan, dice: &mut Dice, from: f64, to: f64) -> f64 {
    let end = plan.times_s.last().copied().unwrap_or(0.0);
    plan.release_s + (end - plan.release_s) * dice.uniform(from, to)
}

/// Size: the tilt's amplitude.
pub(super) fn sway(scene: &Scene<'_>, dice: &mut Dice) -> Mechanism {
    let rate_rad_s = TAU * dice.uniform(0.6, 4.0);
    let phases: Vec<f64> = scene.plans.iter().map(|_| dice.uniform(0.0, TAU)).collect();
    Mechanism::new([0.002, 0.4], move |tilt_rad, machine| {
        machine.link.sway = Some([tilt_rad, rate_rad_s]);
        machine.link.sway_phase_rad.clone_from(&phases);
        vec![TrueNumber::new("tilt", "rad", tilt_rad), TrueNumber::new("frequency", "Hz", rate_rad_s / TAU)]
    })
}

/// Size: the share of the viscous friction that varies.
pub(super) fn angle_viscous(dice: &mut Dice) -> Mechanism {
    let (n, phi) = (dice.whole(3, 6) as f64, dice.uniform(-1.0, 1.0));
    Mechanism::new([0.1, 3.0], move |share, machine| {
        machine.friction.viscous_over_angle = Some([share, n, phi]);
        vec![TrueNumber::new("share", "", share), TrueNumber::new("periods", "-", n)]
    })
}

/// Size: its largest torque.
pub(super) fn detent(scene: &Scene<'_>, dice: &mut Dice) -> Mechanism {
    let (low, high) = (scene.typical.lowest_rad, scene.typical.highest_rad);
    let (place, width) = (0.6 * dice.uniform(low, high), dice.uniform(0.04, 0.12));
    let peak = scene.peak_nm();
    Mechanism::new([0.02 * peak, 0.8 * peak], move |torque_nm, machine| {
        machine.link.detent = Some([torque_nm, place, width]);
        vec![TrueNumber::new("torque", "N m", torque_nm), TrueNumber::new("place", "rad", place)]
    })
    .between([place - 2.0 * width, place + 2.0 * width])
}

/// Size: the torque at which it slips.
pub(super) fn cable(scene: &Scene<'_>, dice: &mut Dice) -> Mechanism {
    let travel_rad = dice.uniform(0.2, 0.6);
    let peak = scene.peak_nm();
    Mechanism::new([0.01 * peak, 0.5 * peak], move |slips_nm, machine| {
        machine.link.cable = Some([slips_nm, travel_rad]);
        vec![TrueNumber::new("slips", "N m", slips_nm), TrueNumber::new("travel", "rad", travel_rad)]
    })
}

/// Size: the largest torque of a knock. Most logs have one to three.
pub(super) fn knocks(scene: &Scene<'_>, dice: &mut Dice) -> Mechanism {
    let mut knocks = Vec::new();
    for (log, plan) in scene.plans.iter().enumerate() {
        let count = dice.pick(&[0, 1, 1, 2, 3]);
        for _ in 0..count {
            let from_s = moment(plan, dice, 0.05, 0.7);
            let share = dice.sign() * dice.uniform(0.4, 1.0);
            knocks.push(Knock { log, from_s, lasts_s: dice.uniform(0.03, 0.12), share });
        }
    }
    let peak = scene.peak_nm();
    Mechanism::new([0.02 * peak, 2.0 * peak], move |torque_nm, machine| {
        machine.link.knock_nm = torque_nm;
        machine.link.knocks.clone_from(&knocks);
        vec![TrueNumber::new("torque", "N m", torque_nm)]
    })
}

/// Size: how far the encoder's zero has wandered when a log ends.
pub(super) fn drift(dice: &mut Dice) -> Mechanism {
    let sign = dice.sign();
    Mechanism::new([0.001, 0.2], move |size_rad, machine| {
        machine.reading.drift_rad = sign * size_rad;
        vec![TrueNumber::new("drift", "rad", sign * size_rad)]
    })
}
