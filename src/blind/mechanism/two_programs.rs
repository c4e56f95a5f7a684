//! The maker's joints against those of the fit: two programs that share no code must agree where they mean the same.

use super::tests::drawn;
use super::*;
use crate::blind::plan::Load;
use crate::blind::sim::simulate;
use crate::joint::{Chain, Friction, Link, Motor};
use crate::log::{Hold, MotorSpec};
use crate::pendulum::{Input, Start, readings};

/// Readings of the fit's program, with one effect at the catalogue's values.
fn fitted(id: EffectId, named: &[f64], scene: &Scene<'_>, plan: &LogPlan, first_rad: f64) -> Vec<f64> {
    let joint = scene.joint;
    let load = plan.load.map_or(Load { inertia_kg_m2: 0.0, peak_gravity_nm: 0.0 }, |extra| extra.load());
    let inertia = joint.inertia_kg_m2 + load.inertia_kg_m2;
    let link = Link::new(inertia, joint.moment_kg_m + load.peak_gravity_nm / 9.81, 0.0, 9.81);
    let motor = plan.is_driven().then(|| Motor::new(MotorSpec::pd(joint.kp, joint.kd)));
    let mut chain = Chain::new(link, Friction::coulomb_viscous(joint.coulomb_nm, joint.viscous_nm_s_rad), motor);
    id.apply(&id.searched(named, joint.coulomb_nm), joint.inertia_kg_m2, &mut chain);
    let setpoint_rad: Vec<f64> = match &plan.changes {
        Some(changes) => {
            let at =
                |t: &f64| changes.iter().rev().find(|(from, _)| *from <= t + 1e-9).map_or(0.0, |(_, value)| *value);
            plan.times_s.iter().map(at).collect()
        }
        None => Vec::new(),
    };
    let input = if plan.is_driven() {
        Input::Position { setpoint_rad: &setpoint_rad, hold: Hold::Step, on: None }
    } else {
        Input::Off
    };
    let release_s = (plan.release_s > 0.0).then_some(plan.release_s);
    let start = Start { angle_rad: first_rad, rate_rad_s: 0.0, release_s };
    let mut read = Vec::new();
    let moved = readings(&chain, input, &plan.times_s, start, 1.0, |_, state| read.push(state.angle_rad));
    moved.unwrap_or_else(|error| panic!("{id} {named:?}: {error:?}"));
    read
}

#[test]
fn both_programs_move_the_same_joint_the_same_way() {
    for trial in 0..4 {
        drawn(trial, true, |scene, plain, dice| {
            let noise_rad = scene.joint.sensor.noise_rad();
            for id in EffectId::ALL {
                let mechanism = effect(*id, scene, dice);
                let size = (mechanism.range[0] * mechanism.range[1]).sqrt();
                let mut machine = plain.clone();
                let named: Vec<f64> = mechanism.install(size, &mut machine).iter().map(|n| n.value).collect();
                if let Some(coupling) = &mut machine.coupling {
                    // the share of friction on the motor side is no parameter of the catalogue's; the fit has it fixed
                    coupling.friction = 0.97;
                }
                // after impacts on a stop small differences grow
                let most = if *id == EffectId::EndStop { 1.5 } else { 0.2 };
                // a late reading of a free swing is the same swing later, which the maker leaves out
                let told = |plan: &LogPlan| *id != EffectId::SensorDelay || plan.is_driven();
                for (i, plan) in scene.plans.iter().enumerate().filter(|(_, plan)| told(plan)) {
                    let made = simulate(&machine, plan, i, 2.5e-5);
                    // a loop that rings itself up is no study, and no two programs agree on it
                    if made.q_rad.iter().any(|q| q.abs() > 2.7) {
                        continue;
                    }
                    let other = fitted(*id, &named, scene, plan, made.q_rad[0]);
                    let squares: f64 = made.q_rad.iter().zip(&other).map(|(a, b)| (a - b).powi(2)).sum();
                    let ratio = (squares / other.len() as f64).sqrt() / noise_rad;
                    assert!(ratio < most, "{id}, trial {trial}, log {i}: {ratio:.3} of the noise");
                }
            }
        });
    }
}
