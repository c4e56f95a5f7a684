//! Every mechanism on a joint: it does nothing at no size, and something at its largest.

use super::*;
use crate::blind::plan::{Driven, one_sided, plan};
use crate::blind::sim::{Drive, simulate};

pub(super) fn drawn(trial: u64, textbook: bool, mut check: impl FnMut(&Scene<'_>, &Machine, &mut Dice)) {
    let mut dice = Dice::new(99, trial);
    let joint = Joint::draw(&mut dice);
    let mut plans = plan(&joint, Driven::Some, &mut dice);
    one_sided(&mut plans, 1.0);
    let mut machine =
        Machine::plain(joint.inertia_kg_m2, joint.peak_gravity_nm(), joint.coulomb_nm, joint.viscous_nm_s_rad);
    machine.drive = Drive { kp: joint.kp, kd: joint.kd, ..Drive::default() };
    let traces: Vec<Trace> = plans.iter().enumerate().map(|(i, p)| simulate(&machine, p, i, 2e-4)).collect();
    let typical = Typical::of(&plans, &traces);
    check(&Scene { joint: &joint, plans: &plans, typical, textbook }, &machine, &mut dice);
}

/// Largest change of a reading that a mechanism of a size makes \[rad\].
fn change(mechanism: &Mechanism, size: f64, scene: &Scene<'_>, plain: &Machine) -> f64 {
    let mut machine = plain.clone();
    let numbers = mechanism.install(size, &mut machine);
    assert!(numbers.iter().all(|number| number.value.is_finite()), "{numbers:?}");
    let both = |(i, plan): (usize, &LogPlan)| {
        let [a, b] = [plain, &machine].map(|machine| simulate(machine, plan, i, 2e-4));
        a.q_rad.iter().zip(&b.q_rad).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    scene.plans.iter().enumerate().map(both).fold(0.0, f64::max)
}

#[test]
fn every_mechanism_vanishes_with_its_size_and_grows_with_it() {
    for (trial, textbook) in [(1, true), (2, false)] {
        drawn(trial, textbook, |scene, machine, dice| {
            let resolution = scene.joint.sensor.resolution_rad;
            let mut all: Vec<(&str, Mechanism)> =
                EffectId::ALL.iter().map(|id| (id.id(), effect(*id, scene, dice))).collect();
            all.extend(OutsideId::ALL.iter().map(|id| (id.id(), outside(*id, scene, dice))));
            for (id, mechanism) in &all {
                let [least, most] = mechanism.range;
                assert!(0.0 < least && least < most, "{id}: {least} to {most}");
                let tiny = match *id {
                    // a setpoint that is held for less than its own step is not held
                    "setpoint_hold" => 1e-3 * scene.joint.sensor.period_s,
                    // the size of these is a logarithm, and they vanish where nothing reaches the limit
                    "torque_limit" => -9.0,
                    // so fast that it is there within one of these steps
                    "setpoint_profile" => -16.0,
                    // stiffer ones would need shorter steps
                    "compliance" => 1e-4 * most,
                    _ => 1e-6 * most,
                };
                let none = change(mechanism, tiny, scene, machine);
                // without its speed, a speed limit is still a torque limit
                assert!(*id == "speed_limit" || none < resolution, "{id} at size {tiny}: {none} rad");
                let much = change(mechanism, most, scene, machine);
                assert!(much > resolution, "{id} at size {most}: {much} rad");
            }
        });
    }
}
