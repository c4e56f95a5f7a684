//! Effects of the catalogue in gearing, link and sensor.

use super::{Mechanism, Scene};
use crate::blind::dice::Dice;
use crate::blind::sim::{Coupling, Stop};
use crate::blind::truth::TrueNumber;
use std::f64::consts::TAU;

/// Size: `b`. The variant's flanks spring and damp.
pub(super) fn backlash(scene: &Scene<'_>, dice: &mut Dice) -> Mechanism {
    let joint = scene.joint;
    let (rotor, friction) = (dice.uniform(0.1, 0.5), dice.uniform(0.9, 1.0));
    // the lighter side on the flank's spring
    let reduced = rotor * (1.0 - rotor) * joint.inertia_kg_m2;
    let rate_rad_s = dice.uniform(500.0, 1000.0);
    let (stiffness, damping) = if scene.textbook {
        (f64::INFINITY, 0.0)
    } else {
        (reduced * rate_rad_s.powi(2), 2.0 * 0.7 * reduced * rate_rad_s)
    };
    let least = (0.7 * joint.sensor.resolution_rad).max(0.001);
    Mechanism::new([least, 0.08], move |play_rad, machine| {
        machine.coupling = Some(Coupling { rotor, friction, play_rad, stiffness, damping, spring: false });
        vec![TrueNumber::new("b", "rad", play_rad), TrueNumber::new("rotor", "", rotor)]
    })
}

/// Size: the spring's softness \[rad/(N m)\]. The variant has another share of the inertia on the motor side.
pub(super) fn compliance(scene: &Scene<'_>, dice: &mut Dice) -> Mechanism {
    let rotor = if scene.textbook { 0.3 } else { dice.uniform(0.15, 0.6) };
    let (friction, damping_ratio) = (dice.uniform(0.9, 1.0), dice.uniform(0.01, 0.1));
    let reduced = rotor * (1.0 - rotor) * scene.joint.inertia_kg_m2;
    // 2.5 to 25 Hz
    let softness = |hz: f64| 1.0 / (reduced * (TAU * hz).powi(2));
    Mechanism::new([softness(25.0), softness(2.5)], move |softness, machine| {
        let stiffness = 1.0 / softness;
        let damping = 2.0 * damping_ratio * (stiffness * reduced).sqrt();
        machine.coupling = Some(Coupling { rotor, friction, play_rad: 0.0, stiffness, damping, spring: true });
        vec![TrueNumber::new("k", "N m/rad", stiffness), TrueNumber::new("d", "N m s/rad", damping)]
    })
}

/// Size: `T`.
pub(super) fn late() -> Mechanism {
    Mechanism::new([0.001, 0.03], move |late_s, machine| {
        machine.reading.late_s = late_s;
        vec![TrueNumber::new("T", "s", late_s)]
    })
}

/// Size: `k`. The variant hardens.
pub(super) fn spring(scene: &Scene<'_>, dice: &mut Dice) -> Mechanism {
    let at_rad = dice.uniform(scene.typical.lowest_rad, scene.typical.highest_rad).clamp(-1.5, 1.5);
    let hardens = if scene.textbook { 0.0 } else { 0.15 };
    let peak = scene.peak_nm();
    Mechanism::new([0.005 * peak, 0.6 * peak], move |k, machine| {
        machine.link.spring_nm_rad = k;
        machine.link.spring_at_rad = at_rad;
        machine.link.spring_hardens = hardens;
        vec![TrueNumber::new("k", "N m/rad", k), TrueNumber::new("q_s", "rad", at_rad)]
    })
}

/// Size: how deep the stop reaches into the swing. The variant presses as Hertz and damps as Hunt and Crossley have it.
///
/// The joint is let go on the other side, [`one_sided`](crate::blind::plan::one_sided): nobody holds it beyond a stop.
pub(super) fn stop(scene: &Scene<'_>, dice: &mut Dice) -> Mechanism {
    let below = scene.plans.iter().any(|plan| !plan.is_driven() && plan.start_rad < 0.0);
    let side = if below { 1.0 } else { -1.0 };
    let swing = if below { scene.typical.highest_rad } else { -scene.typical.lowest_rad };
    let stiffness = scene.peak_nm() * dice.log_uniform(30.0, 300.0);
    let damping = 2.0 * dice.uniform(0.15, 0.7) * (stiffness * scene.joint.inertia_kg_m2).sqrt();
    let hertz_depth_rad = if scene.textbook { 0.0 } else { 0.02 };
    Mechanism::new([0.01, (0.6 * swing).max(0.02)], move |depth_rad, machine| {
        let at_rad = side * (swing - depth_rad);
        machine.link.stop = Some(Stop { at_rad, side, stiffness, damping, hertz_depth_rad });
        vec![
            TrueNumber::new("q_e", "rad", at_rad),
            TrueNumber::new("side", "", side),
            TrueNumber::new("stiffness", "N m/rad", stiffness),
            TrueNumber::new("damping", "N m s/rad", damping),
        ]
    })
}

/// Size: `|d|`.
pub(super) fn offset(dice: &mut Dice) -> Mechanism {
    let sign = dice.sign();
    Mechanism::new([0.001, 0.25], move |size, machine| {
        machine.link.offset_rad = sign * size;
        vec![TrueNumber::new("d", "rad", sign * size)]
    })
}

/// Size: `|e|`.
pub(super) fn gain(dice: &mut Dice) -> Mechanism {
    let sign = dice.sign();
    Mechanism::new([0.002, 0.15], move |size, machine| {
        machine.reading.gain = 1.0 + sign * size;
        vec![TrueNumber::new("e", "", sign * size)]
    })
}
