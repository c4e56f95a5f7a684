//! Promises of the simulation.

use super::terms::At;
use super::*;
use crate::geometry::robot_file::Base;
use crate::integrate::{self, Tolerance};
use crate::joint::{Chain, EffectForm, EffectId, Link, Motor};
use crate::log::{Hold, MotorSpec};
use crate::pendulum::{Command, Input as PendulumInput, Start, rollout};
use crate::robot::{Dynamics, Gait, JointId, Model, State};
use nalgebra::Vector3;
use std::path::Path;

/// A rod on one joint, as a robot.
const ROD: &str = r#"
schema = 1
name = "rod"
root = "stand"
base = "clamped"
[[part]]
name = "stand"
diameter_m = [0.1, 0.1, 0.1]
mass_kg = 1.0
[[part]]
name = "rod"
diameter_m = [0.02, 0.2, 0.02]
mass_kg = 0.1
inertia_kg_m2 = [2.0e-4, 1.0e-5, 2.0e-4]
[[joint]]
name = "q1"
parent = "stand"
child = "rod"
axis = "z"
parent_mm = [0.0, 0.0, 0.0]
child_mm = [0.0, 100.0, 0.0]
phi_deg = [0.0, 0.0, 0.0]
"#;

const INERTIA: f64 = 2.0e-4 + 0.1 * 0.01;
const MOMENT: f64 = 0.1 * 0.1;

fn rod() -> Model {
    Model::from_toml(Path::new("rod.toml"), ROD).unwrap()
}

/// Setpoints of the rod's joint: a sine over four seconds, the motor on or off throughout.
fn sine(on: bool) -> Setpoints {
    let t_s: Vec<f64> = (0..=500).map(|k| 0.008 * f64::from(k)).collect();
    let angle_rad = t_s.iter().map(|t| 0.8 * (5.0 * t).sin()).collect();
    let columns = vec![Some(Column { angle_rad, on: Some(vec![on; t_s.len()]) })];
    Setpoints { t_s, columns, hold: Hold::Step }
}

fn spec() -> MotorSpec {
    MotorSpec { ki_nm_rad_s: 0.05, ..MotorSpec::pd(0.4, 0.01) }
}

fn rod_joints(model: &Model, effect: Option<(EffectId, &[f64])>) -> Joints {
    let mut joints = Joints::passive(model);
    let id = model.joint("q1").unwrap();
    let chain = &mut joints.drive_mut(id).chain;
    (chain.friction.coulomb_nm, chain.friction.viscous_nm_s_rad) = (0.002, 0.001);
    chain.motor = Some(Motor::new(spec()));
    if let Some((effect, named)) = effect {
        joints.add_effect(model, id, effect, named).unwrap();
    }
    joints
}

/// Largest difference between the tree and the pendulum, and how far the joint moves [rad].
fn against_rollout(on: bool, effect: Option<(EffectId, &[f64])>, method: Method) -> (f64, f64) {
    let model = rod();
    let joints = rod_joints(&model, effect);
    let mut start = State::at_rest(&model);
    start.angle_rad[0] = if on { 0.0 } else { 1.2 };
    let setpoints = sine(on);
    let scenario = Scenario {
        model: &model,
        joints: &joints,
        setpoints: &setpoints,
        start: &start,
        surroundings: None,
        period_s: 0.008,
    };
    let recording = run(&scenario, method).unwrap();
    assert!(recording.diverged.is_none(), "{:?}", recording.diverged);
    let link = Link::new(INERTIA, MOMENT, 0.0, 9.81);
    let friction = crate::joint::Friction::coulomb_viscous(0.002, 0.001);
    let mut chain = Chain::new(link, friction, Some(Motor::new(spec())));
    if let Some((effect, named)) = effect {
        effect.apply(&effect.searched(named, 0.002), INERTIA, &mut chain);
    }
    let column = setpoints.columns[0].as_ref().unwrap();
    let input = match on {
        true => PendulumInput::Position { setpoint_rad: &column.angle_rad, hold: Hold::Step, on: None },
        false => PendulumInput::Off,
    };
    let begin = Start { angle_rad: start.angle_rad[0], rate_rad_s: 0.0, release_s: None };
    let (mut worst, mut reach) = (0.0f64, 0.0f64);
    rollout(&chain, input, &setpoints.t_s, begin, |k, state| {
        worst = worst.max((state.angle_rad - recording.angle_rad[0][k]).abs());
        reach = reach.max((state.angle_rad - start.angle_rad[0]).abs());
    })
    .unwrap();
    (worst, reach)
}

const STIFF: Method = Method::Stiff { step_s: 1e-3 };

#[test]
fn a_tree_of_one_joint_moves_as_the_pendulum() {
    for on in [false, true] {
        let (worst, reach) = against_rollout(on, None, STIFF);
        assert!(worst < 3e-4 && reach > 0.5, "{on}: {worst:e} {reach}");
        let (finer, _) = against_rollout(on, None, Method::Stiff { step_s: 2.5e-4 });
        assert!(finer < 3e-5, "{on}: {finer:e}");
    }
}

/// Sizes at which each effect of the catalogue shows on the rod, in the catalogue's order of parameters.
fn size_of(effect: EffectId) -> &'static [f64] {
    match effect {
        EffectId::Stribeck => &[0.004, 0.2],
        EffectId::LoadFriction => &[0.1],
        EffectId::GearFriction => &[0.1],
        EffectId::QuadraticDrag => &[1e-3],
        EffectId::AsymmetricFriction => &[1e-3],
        EffectId::PositionFriction => &[0.5, 0.3],
        EffectId::FrictionDrift => &[0.3],
        EffectId::Backlash => &[0.05, 0.2],
        EffectId::JointSpring => &[0.02, 0.3],
        EffectId::EndStop => &[0.4, 1.0, 2.0, 0.01],
        EffectId::AngleOffset => &[0.1],
        EffectId::SensorGain => &[0.1],
        EffectId::Delay => &[0.013],
        EffectId::SetpointHold => &[0.128],
        EffectId::TorqueLimit => &[0.03],
        EffectId::SpeedLimit => &[4.0, 0.1],
        EffectId::MotorGain => &[0.8],
        EffectId::DeadBand => &[0.01],
        EffectId::SetpointProfile => &[1.0, 10.0],
        EffectId::Compliance | EffectId::SensorDelay => &[],
    }
}

#[test]
fn every_effect_moves_the_tree_as_it_moves_the_pendulum() {
    for effect in EffectId::ALL.iter().copied().filter(|effect| effect.is_known_to_robots()) {
        // The encoder's zero is another thing on the tree, which knows the true angle.
        if effect == EffectId::AngleOffset {
            continue;
        }
        let (worst, _) = against_rollout(true, Some((effect, size_of(effect))), Method::Stiff { step_s: 2.5e-4 });
        assert!(worst < 4e-4, "{effect}: {worst:e}");
    }
}

fn legs(effect: Option<(&str, EffectId, &[f64])>, method: Method) -> Recording {
    legs_along(short, effect.map(|(joint, effect, named)| (joint, effect.into(), named)), method)
}

/// The legs in the air along setpoints, with a form of an effect on a joint.
fn legs_along(
    setpoints: fn(&Model) -> Setpoints,
    effect: Option<(&str, EffectForm, &[f64])>,
    method: Method,
) -> Recording {
    let model = Model::ers7().with_base(Base::Clamped);
    let mut joints = Joints::of_thesis(&model).unwrap();
    if let Some((joint, form, named)) = effect {
        joints.add_effect(&model, model.joint(joint).unwrap(), form, named).unwrap();
    }
    let setpoints = setpoints(&model);
    let mut start = State::at_rest(&model);
    for id in model.joint_ids() {
        start.angle_rad[id.index()] = setpoints.at(id, 0.0).unwrap();
    }
    let scenario = Scenario {
        model: &model,
        joints: &joints,
        setpoints: &setpoints,
        start: &start,
        surroundings: None,
        period_s: 0.008,
    };
    run(&scenario, method).unwrap()
}

/// The trot in the air: the end of its stand and a little more than one cycle.
fn short(model: &Model) -> Setpoints {
    late(model, 1.8, 1.0, 1.5)
}

/// The trot in the air at a frequency \[Hz\], from a time on, for a time \[s\].
fn late(model: &Model, from_s: f64, frequency_hz: f64, duration_s: f64) -> Setpoints {
    struct Late(Gait, f64);
    impl crate::robot::Setpoints for Late {
        fn joints(&self) -> usize {
            self.0.joints()
        }
        fn angle_rad(&self, joint: JointId, t_s: f64) -> f64 {
            self.0.angle_rad(joint, t_s + self.1)
        }
    }
    let gait = Gait::built_in("trot", model).unwrap().with_amplitude("air").unwrap().at_frequency(frequency_hz);
    Setpoints::sampled(&Late(gait, from_s), model, duration_s, 0.008).unwrap()
}

fn worst(a: &Recording, b: &Recording) -> f64 {
    let columns = a.angle_rad.iter().flatten().zip(b.angle_rad.iter().flatten());
    columns.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn every_effect_on_a_leg_changes_something_and_is_refused_out_of_bounds() {
    let plain = legs(None, STIFF);
    for effect in EffectId::ALL.iter().copied().filter(|effect| effect.is_known_to_robots()) {
        // Sizes for a joint that moves by tenths of a radian with torques of tenths of a newton metre.
        let named: &[f64] = match effect {
            EffectId::EndStop => &[-0.2, 1.0, 5.0, 0.01],
            EffectId::Stribeck => &[0.05, 0.2],
            EffectId::TorqueLimit => &[0.03],
            EffectId::SpeedLimit => &[2.0, 0.1],
            _ => size_of(effect),
        };
        let changed = legs(Some(("rf1", effect, named)), STIFF);
        assert!(changed.diverged.is_none(), "{effect}: {:?}", changed.diverged);
        assert!(worst(&plain, &changed) > 2e-5, "{effect}: {:e}", worst(&plain, &changed));
    }
    let model = Model::ers7();
    let mut joints = Joints::passive(model);
    let id = model.joint("rf1").unwrap();
    let error = joints.add_effect(model, id, EffectId::Delay, &[-1.0]).unwrap_err().to_string();
    assert!(error.contains("rf1") && error.contains("delay") && error.contains("-1"), "{error}");
    let error = joints.add_effect(model, id, EffectId::SensorDelay, &[0.01]).unwrap_err().to_string();
    assert!(error.contains("rf1") && error.contains("sensor_delay"), "{error}");
    assert!(joints.set_friction(model, "nosuch").unwrap_err().to_string().contains("nosuch"));
}

#[test]
fn motors_that_bend_move_alike_in_long_and_short_steps() {
    // A knee with half of what it needs, one that is too slow, and one that small torques do not move: with a law whose
    // damping is 1e4 times faster than the step.
    let fast: fn(&Model) -> Setpoints = |model| late(model, 1.8, 2.0, 1.0);
    for (effect, values, setpoints) in [
        (EffectId::TorqueLimit, &[0.02][..], short as fn(&Model) -> Setpoints),
        (EffectId::SpeedLimit, &[2.0, 0.05], short),
        (EffectId::SpeedLimit, &[3.0, 1.0], fast),
        (EffectId::DeadBand, &[0.04], fast),
    ] {
        for form in effect.forms() {
            let run = |step_s| legs_along(setpoints, Some(("lf3", form, values)), Method::Stiff { step_s });
            let (fine, free) = (run(2e-5), legs_along(setpoints, None, Method::Stiff { step_s: 2.5e-4 }));
            let moved = worst(&fine, &free);
            println!("{form:?}: {moved:e} rad");
            assert!(moved > 2e-3, "{form:?}: {moved:e} rad");
            for (step_s, allowed_rad) in [(2e-3, 6e-4), (1e-3, 4e-4), (2.5e-4, 1e-4)] {
                let error = worst(&run(step_s), &fine);
                println!("  {step_s} s: {error:e} rad");
                assert!(error < allowed_rad, "{form:?}, {step_s} s: {error:e} of {moved:e} rad");
            }
        }
    }
}

#[test]
fn an_encoder_off_its_centre_reads_so_and_is_read_back() {
    let model = Model::ers7();
    let mut joints = Joints::passive(model);
    let id = model.joint("lf3").unwrap();
    let eccentric = EffectForm::named_so(EffectId::SensorGain, Some("eccentric")).unwrap();
    joints.add_effect(model, id, eccentric, &[0.03, 0.4]).unwrap();
    let drive = joints.drive_mut(id);
    drive.zero_rad = 0.1;
    for angle_rad in [-1.2f64, 0.3, 2.0] {
        let reading_rad = drive.reading_rad(angle_rad);
        let turned_rad = angle_rad - 0.1;
        assert!((reading_rad - turned_rad - 0.03 * (turned_rad - 0.4).sin()).abs() < 1e-12);
        assert!((drive.true_rad(reading_rad) - angle_rad).abs() < 1e-9);
    }
}

#[test]
fn zero_effects_change_nothing() {
    let plain = legs(None, STIFF);
    for (effect, named) in [
        (EffectId::LoadFriction, &[0.0][..]),
        (EffectId::GearFriction, &[0.0]),
        (EffectId::QuadraticDrag, &[0.0]),
        (EffectId::AsymmetricFriction, &[0.0]),
        (EffectId::PositionFriction, &[0.0, 0.0]),
        (EffectId::FrictionDrift, &[0.0]),
        (EffectId::JointSpring, &[0.0, 0.0]),
        (EffectId::AngleOffset, &[0.0]),
        (EffectId::SensorGain, &[0.0]),
        (EffectId::Delay, &[0.0]),
        (EffectId::SetpointHold, &[0.0]),
        (EffectId::TorqueLimit, &[1e6]),
        (EffectId::SpeedLimit, &[1e6, 1e6]),
        (EffectId::MotorGain, &[1.0]),
    ] {
        let with = legs(Some(("rf2", effect, named)), STIFF);
        // Another way through the schedule may cut the steps at other places by rounding.
        assert!(worst(&plain, &with) < 1e-6, "{effect}: {:e}", worst(&plain, &with));
    }
}

#[test]
fn steps_of_a_millisecond_are_stable_and_of_second_order_with_all_gains_of_table_b_2() {
    let exact = legs(None, Method::Stiff { step_s: 2e-5 });
    let coarse = worst(&legs(None, STIFF), &exact);
    let fine = worst(&legs(None, Method::Stiff { step_s: 2.5e-4 }), &exact);
    println!("1 ms: {coarse:e} rad, 0.25 ms: {fine:e} rad");
    assert!(coarse < 2e-3 && fine < coarse / 5.0, "{coarse:e} {fine:e}");
}

#[test]
fn the_methods_agree_in_the_air() {
    let ours = legs(None, Method::Stiff { step_s: 1e-4 });
    for (method, allowed) in [
        (integrate::Method::Rk2 { step_s: 2e-5 }, 2e-3),
        (integrate::Method::Rk4 { step_s: 2e-5 }, 2e-3),
        (integrate::Method::DormandPrince(Tolerance::of(1e-5)), 2e-3),
        (integrate::Method::Bdf(Tolerance::of(1e-5)), 2e-3),
    ] {
        let other = legs(None, Method::Smooth(method));
        assert!(other.diverged.is_none(), "{method:?}: {:?}", other.diverged);
        println!("{method:?}: {:e} rad, {:?}", worst(&ours, &other), other.counts);
        assert!(worst(&ours, &other) < allowed, "{method:?}: {:e}", worst(&ours, &other));
    }
}

#[test]
fn a_free_robot_with_passive_joints_keeps_energy_and_momentum() {
    let model = Model::ers7();
    let mut joints = Joints::passive(model);
    for id in model.joint_ids() {
        joints.drive_mut(id).spring = None;
    }
    let mut start = State::at_rest(model);
    for (k, rate) in start.rate_rad_s.iter_mut().enumerate().take(12) {
        *rate = 2.0 * (k as f64).sin();
    }
    start.base_rate_rad_s = Vector3::new(0.5, -1.0, 0.7);
    let t_s = vec![0.0, 0.4];
    let setpoints = Setpoints { t_s, columns: vec![None; 22], hold: Hold::Step };
    let mut dynamics = Dynamics::new(model);
    let (before, momentum) = (dynamics.energy(&start).total_j(), dynamics.momentum(&start));
    let mut drift = |method: Method| {
        let scenario = Scenario {
            model,
            joints: &joints,
            setpoints: &setpoints,
            start: &start,
            surroundings: None,
            period_s: 0.1,
        };
        let end = run(&scenario, method).unwrap().end;
        let after = dynamics.momentum(&end);
        let turned = (after.angular_kg_m2_s - momentum.angular_kg_m2_s).norm();
        ((dynamics.energy(&end).total_j() - before).abs(), turned)
    };
    let (coarse, _) = drift(Method::Stiff { step_s: 1e-3 });
    let (fine, turned) = drift(Method::Stiff { step_s: 2.5e-4 });
    println!("energy drifts by {coarse:e} and {fine:e} J of {before}, angular momentum by {turned:e}");
    assert!(fine < coarse / 8.0 && fine < 1e-3 && turned < 1e-4);
    let (energy, turned) = drift(Method::Smooth(integrate::Method::Rk4 { step_s: 2.5e-4 }));
    assert!(energy < 1e-8 && turned < 1e-8, "{energy:e} {turned:e}");
}

#[test]
fn friction_only_removes_energy_and_brings_the_leg_to_rest() {
    let model = Model::ers7().with_base(Base::Clamped);
    let mut joints = Joints::passive(&model);
    joints.set_friction(&model, "estimated").unwrap();
    let setpoints = Setpoints { t_s: vec![0.0, 3.0], columns: vec![None; 22], hold: Hold::Step };
    let mut dynamics = Dynamics::new(&model);
    for seed in 0..4 {
        let mut start = State::at_rest(&model);
        for (k, q) in start.angle_rad.iter_mut().enumerate().take(12) {
            *q = 0.8 * ((3 * k + seed) as f64).sin();
        }
        let scenario = Scenario {
            model: &model,
            joints: &joints,
            setpoints: &setpoints,
            start: &start,
            surroundings: None,
            period_s: 0.01,
        };
        let recording = run(&scenario, STIFF).unwrap();
        // Head, ears and tail have no friction: they are left out by holding them.
        let mut last = f64::INFINITY;
        let mut state = start.clone();
        for k in 0..recording.t_s.len() {
            for j in 0..12 {
                state.angle_rad[j] = recording.angle_rad[j][k];
                state.rate_rad_s[j] = recording.rate_rad_s[j][k];
            }
            let energy = dynamics.energy(&state).total_j();
            assert!(energy <= last + 2e-6, "seed {seed}, t = {}: {energy} after {last}", recording.t_s[k]);
            last = energy;
        }
        let moving = (0..12).map(|j| recording.end.rate_rad_s[j].abs()).fold(0.0, f64::max);
        assert!(moving < 0.05, "{moving}");
    }
}

#[test]
fn an_explicit_law_in_frames_diverges_and_says_where() {
    let model = Model::ers7().with_base(Base::Clamped);
    let mut joints = Joints::of_thesis(&model).unwrap();
    let control = Control { sample_period_s: Some(0.008), ..Control::default() };
    joints.set_control(&model, "printed", control).unwrap();
    let setpoints = short(&model);
    let mut start = State::at_rest(&model);
    for id in model.joint_ids() {
        start.angle_rad[id.index()] = setpoints.at(id, 0.0).unwrap();
    }
    let scenario = Scenario {
        model: &model,
        joints: &joints,
        setpoints: &setpoints,
        start: &start,
        surroundings: None,
        period_s: 0.008,
    };
    let recording = run(&scenario, STIFF).unwrap();
    let diverged = recording.diverged.unwrap();
    assert!(diverged.joint.is_some() && diverged.at_s < 1.5 && diverged.to_string().contains("joint"), "{diverged}");
    assert!(!recording.t_s.is_empty() && recording.angle_rad[0].len() == recording.t_s.len());
}

/// A foot in honey, on a spring.
struct Honey {
    body: crate::robot::BodyId,
    with_dampers: bool,
}

impl Surroundings for Honey {
    fn act(&self, _t_s: f64, bodies: &[crate::robot::BodyMotion], external: &mut External) {
        let motion = &bodies[self.body.index()];
        let place = Vector3::new(0.0, -0.045, 0.0);
        let (at_m, velocity) = (motion.point_m(&place), motion.point_velocity_m_s(&place));
        let force = -velocity * HONEY_N_S_M - (at_m - Vector3::new(0.1, -0.15, -0.1)) * 200.0;
        external.forces.push(crate::robot::Force::at(self.body, at_m, force));
        if self.with_dampers {
            external.contacts.push(crate::robot::ContactDamping {
                body: self.body,
                at_m,
                velocity_m_s: velocity,
                damping_n_s_m: nalgebra::Matrix3::identity() * HONEY_N_S_M,
                stiffness_n_m: nalgebra::Matrix3::identity() * 200.0,
                spin_damping_nm_s_rad: nalgebra::Matrix3::zeros(),
            });
        }
    }
}

const HONEY_N_S_M: f64 = 100.0;

#[test]
fn dampers_of_the_surroundings_are_stable_and_of_second_order() {
    let model = Model::ers7();
    let joints = Joints::of_thesis(model).unwrap();
    let setpoints = late(model, 1.95, 3.0, 0.4);
    let mut start = State::at_rest(model);
    for id in model.joint_ids() {
        start.angle_rad[id.index()] = setpoints.at(id, 0.0).unwrap();
    }
    let at = |step_s: f64, with_dampers: bool| {
        let honey = Honey { body: model.body("rf_lower").unwrap(), with_dampers };
        let scenario = Scenario {
            model,
            joints: &joints,
            setpoints: &setpoints,
            start: &start,
            surroundings: Some(&honey),
            period_s: 0.008,
        };
        let recording = run(&scenario, Method::Stiff { step_s }).unwrap();
        assert!(recording.diverged.is_none(), "{:?}", recording.diverged);
        recording
    };
    let exact = at(1e-5, false);
    let [coarse, middle, fine] = [2e-3, 1e-3, 2.5e-4].map(|step_s| worst(&at(step_s, true), &exact));
    println!("honey: 2 ms {coarse:e}, 1 ms {middle:e}, 0.25 ms {fine:e} rad");
    assert!(coarse < 2e-2 && middle < 5e-3 && fine < middle / 8.0, "{coarse:e} {middle:e} {fine:e}");
}

/// Angle of the floor, time, and the robot that stands there at last.
fn stand(slope_rad: f64, dwell_s: f64, duration_s: f64) -> (crate::robot::Floor, Recording) {
    use crate::robot::{Floor, FloorParameters, Touching};
    let model = Model::ers7();
    let joints = Joints::of_thesis(model).unwrap();
    let trot = Gait::built_in("trot", model).unwrap();
    let t_s = vec![0.0, duration_s];
    let column = |id| Some(Column { angle_rad: vec![crate::robot::Setpoints::angle_rad(&trot, id, 0.0); 2], on: None });
    let setpoints = Setpoints { t_s, columns: model.joint_ids().map(column).collect(), hold: Hold::Linear };
    let parameters = FloorParameters { dwell_s, ..FloorParameters::default() }.sloped(slope_rad, 0.0);
    let floor = Floor::new(parameters, model, Touching::Marked).unwrap();
    let mut start = State::at_rest(model);
    for id in model.joint_ids() {
        start.angle_rad[id.index()] = setpoints.at(id, 0.0).unwrap();
    }
    start.base_position_m.y = floor.height_on_m(&mut Dynamics::new(model), &start) + 2e-3;
    let scenario = Scenario {
        model,
        joints: &joints,
        setpoints: &setpoints,
        start: &start,
        surroundings: Some(&floor),
        period_s: 0.1,
    };
    let recording = run(&scenario, Method::Stiff { step_s: 1e-3 }).unwrap();
    (floor, recording)
}

#[test]
fn a_robot_that_stands_creeps_less_than_a_tenth_of_a_millimetre_in_a_minute_and_its_feet_bear_its_weight() {
    let model = Model::ers7();
    let (floor, level) = stand(0.0, 1.0, 62.0);
    let crept = |recording: &Recording| {
        let place = |k: usize| recording.base[k].position_m;
        (20..recording.base.len()).map(|k| (place(k) - place(20)).norm()).fold(0.0, f64::max)
    };
    println!("level: {:e} m in a minute", crept(&level));
    assert!(crept(&level) < 1e-4 / 10.0);
    let mut dynamics = Dynamics::new(model);
    let motions = dynamics.motions(&level.end);
    let normal_n: f64 = floor.contacts(motions, &crate::robot::Resting::none()).map(|c| c.3.normal_n).sum();
    approx::assert_relative_eq!(normal_n, model.total_mass_kg() * 9.81, max_relative = 1e-6);
    // On a slope too, which (2.4) alone cannot: it slides down at g sin / (mu_st s cos) = 1 mm/s.
    let (_, held) = stand(0.2, 1.0, 12.0);
    let (_, creeps) = stand(0.2, f64::INFINITY, 12.0);
    println!("slope of 0.2: {:e} m, by (2.4) alone {:e} m in ten seconds", crept(&held), crept(&creeps));
    assert!(crept(&held) < 1e-5 && crept(&creeps) > 5e-3);
    // Steeper than its friction it slides.
    let (_, slides) = stand(0.8, 1.0, 3.0);
    assert!(slides.diverged.is_none() && crept(&slides) > 0.3, "{}", crept(&slides));
}

#[test]
fn slopes_are_those_of_nudges() {
    let model = rod();
    let command = |slope_rad_s| Command::Pid { setpoint_rad: 0.3, slope_rad_s, from_s: 0.0, curve: None };
    let at = At { t_s: 0.02, angle_rad: 0.1, rate_rad_s: 0.7, integral_rad_s: 0.0 };
    let joint = model.joint_ids().next().unwrap();
    for (effect, values) in [
        (EffectId::MotorGain, &[1.0][..]),
        (EffectId::MotorGain, &[0.6]),
        (EffectId::SensorGain, &[0.1]),
        (EffectId::TorqueLimit, &[0.1]),
        (EffectId::DeadBand, &[0.01]),
    ] {
        let joints = rod_joints(&model, Some((effect, values)));
        let drive = joints.drive(joint);
        for command in [command(0.0), command(2.0), Command::Torque(0.1), Command::Off] {
            let (torque_nm, asked) = (drive.motor_nm(command, at), drive.asked(command, at));
            let torque = JointDrive::nudged(command, at, torque_nm, |at| drive.motor_nm(command, at));
            let answer = JointDrive::nudged(command, at, asked, |at| drive.asked(command, at));
            let pairs = [
                (drive.motor_slopes(command, at, torque_nm), torque),
                (drive.slopes_of_answer(command, at, asked), answer),
            ];
            for (told, nudged) in pairs {
                for (a, b) in [
                    (told.stiffness, nudged.stiffness),
                    (told.damping, nudged.damping),
                    (told.per_time, nudged.per_time),
                ] {
                    approx::assert_relative_eq!(a, b, max_relative = 1e-7, epsilon = 1e-8);
                }
            }
        }
    }
}
