//! The drop test on the whole robot (Figure 3.6): trunk clamped, one joint of a leg switched off, the others held.
//!
//! The pendulum of chapter 3 takes the other joints as rigid. Here they may also be held by their controllers (Table
//! B.2), as on the real robot, where they give under the load; the difference of the two is what the pendulum cannot
//! know of.

use super::simulate::{Column, Control, Diverged, Joints, Method, Recording, Scenario, Setpoints, SimulateError, run};
use super::{Attached, JointId, Model, State};
use crate::geometry::inertia::hollow_cylinder_inertia;
use crate::geometry::robot_file::{Base, GAIN_SET};
use crate::geometry::{LegJoint, LinkBody, joint_name};
use crate::identify::LegCase;
use crate::joint::{EffectId, Stribeck};
use crate::log::{ExtraMass, Hold};

/// How the joints that do not swing are held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Held {
    /// Rigidly, as the pendulum models take them.
    Rigid,
    /// By their controllers, with the gains of Table B.2 and the friction of Table 3.3.
    ByController,
}

/// One drop.
#[derive(Clone, Debug)]
pub struct BenchDrop<'a> {
    /// Leg, joint and pose.
    pub leg: &'a LegCase,
    /// A mass on the lower leg.
    pub extra: Option<ExtraMass>,
    /// Masses of the leg's bodies where they are not the tables' \[kg\].
    pub masses_kg: Vec<(LinkBody, f64)>,
    /// Coulomb friction of the joint that swings \[N m\].
    pub coulomb_nm: f64,
    /// Its viscous friction \[N m s/rad\].
    pub viscous_nm_s_rad: f64,
    /// Its Stribeck part.
    pub stribeck: Option<Stribeck<f64>>,
    /// Other effects on it, with their values in the catalogue's order.
    pub effects: Vec<(EffectId, Vec<f64>)>,
    /// Coulomb \[N m\] and viscous friction \[N m s/rad\] of other joints of the leg where they are not Table 3.3's.
    pub others: Vec<(LegJoint, [f64; 2])>,
    /// What its encoder reads beyond the angle \[rad\].
    pub zero_rad: f64,
    /// Its reading until it is let go \[rad\].
    pub angle_rad: f64,
    /// Its rate when it is let go \[rad/s\]; 0 where it was held.
    pub rate_rad_s: f64,
    /// When it is let go \[s\].
    pub release_s: f64,
    /// How the others are held.
    pub held: Held,
}

/// The swinging joint along a drop.
#[derive(Clone, Debug)]
pub struct Dropped {
    /// What its encoder reads at each time that was asked for \[rad\].
    pub reading_rad: Vec<f64>,
    /// Largest distance of another joint of the leg from where it is held \[rad\], while the joint swings.
    pub give_rad: f64,
    /// Where the motion ran away.
    pub diverged: Option<Diverged>,
}

/// Samples of the run, between which the motion is interpolated by cubics \[s\].
const SAMPLE_S: f64 = 0.004;
/// Controllers settle under the load for so long before the joint is let go \[s\].
pub(super) const SETTLE_S: f64 = 2.0;
/// Friction of the joints that do not swing (Table 3.3).
const FRICTION: &str = "estimated";

/// Simulates a drop and answers with the reading at each of the times \[s\], which rise.
///
/// # Errors
/// [`SimulateError`] where the robot has no such leg, or a value is impossible.
pub fn bench_drop(model: &Model, drop: &BenchDrop<'_>, t_s: &[f64], method: Method) -> Result<Dropped, SimulateError> {
    let model = on_the_bench(&model.limb(model.joint(&joint_name(drop.leg.leg, drop.leg.joint))?)?, drop)?;
    let released = model.joint(&joint_name(drop.leg.leg, drop.leg.joint))?;
    let mut joints = Joints::passive(&model);
    if drop.held == Held::ByController {
        joints.set_friction(&model, FRICTION)?;
        joints.set_control(&model, GAIN_SET, Control::default())?;
    }
    for (joint, [coulomb_nm, viscous_nm_s_rad]) in &drop.others {
        let friction = &mut joints.drive_mut(model.joint(&joint_name(drop.leg.leg, *joint))?).chain.friction;
        (friction.coulomb_nm, friction.viscous_nm_s_rad) = (*coulomb_nm, *viscous_nm_s_rad);
    }
    joints.add_effects_of_file(&model)?;
    let in_leg: Vec<JointId> =
        LegJoint::ALL.iter().map(|joint| model.joint(&joint_name(drop.leg.leg, *joint))).collect::<Result<_, _>>()?;
    for id in model.joint_ids() {
        let gives = drop.held == Held::ByController && in_leg.contains(&id);
        joints.drive_mut(id).is_rigid = !gives || id == released;
    }
    let drive = joints.drive_mut(released);
    drive.zero_rad = -drop.zero_rad;
    drive.chain.motor = None;
    let friction = &mut drive.chain.friction;
    (friction.coulomb_nm, friction.viscous_nm_s_rad) = (drop.coulomb_nm, drop.viscous_nm_s_rad);
    friction.stribeck = drop.stribeck;
    for (effect, values) in &drop.effects {
        joints.add_effect(&model, released, *effect, values)?;
    }
    let drive = joints.drive(released);
    let begin_rad = drive.true_rad(drop.angle_rad);
    let mut start = pose(&model, drop)?;
    start.angle_rad[released.index()] = begin_rad;
    let held = start.angle_rad.clone();
    if drop.held == Held::ByController {
        let settled = simulate(&model, &joints, &start, &held, [0.0, SETTLE_S], method)?;
        start = settled.end;
        if settled.diverged.is_some() {
            return Ok(Dropped {
                reading_rad: vec![f64::NAN; t_s.len()],
                give_rad: f64::NAN,
                diverged: settled.diverged,
            });
        }
    }
    joints.drive_mut(released).is_rigid = false;
    start.rate_rad_s[released.index()] = drop.rate_rad_s;
    let end_s = t_s.last().copied().unwrap_or(0.0).max(drop.release_s) + 2.0 * SAMPLE_S;
    let swing = simulate(&model, &joints, &start, &held, [drop.release_s, end_s], method)?;
    let drive = joints.drive(released);
    let reading = |t: &f64| match *t <= drop.release_s {
        true => drop.angle_rad,
        false => drive.reading_rad(swing.angle_at_rad(released, *t)),
    };
    let give = in_leg.iter().filter(|id| **id != released).flat_map(|id| {
        let held_rad = held[id.index()];
        swing.angle_rad[id.index()].iter().map(move |angle| (angle - held_rad).abs())
    });
    Ok(Dropped {
        reading_rad: t_s.iter().map(reading).collect(),
        give_rad: give.fold(0.0, f64::max),
        diverged: swing.diverged,
    })
}

/// The robot with the bench's gravity, masses and load.
fn on_the_bench(model: &Model, drop: &BenchDrop<'_>) -> Result<Model, SimulateError> {
    let mut model = model.with_base(Base::Clamped).with_gravity(drop.leg.gravity_trunk_m_s2);
    let leg = drop.leg.leg;
    for (body, mass_kg) in &drop.masses_kg {
        let part = match body {
            LinkBody::Shoulder => "shoulder",
            LinkBody::UpperLeg => "upper",
            LinkBody::LowerLeg => "lower",
            LinkBody::Extra => continue,
        };
        model = model.with_mass(model.body(&format!("{leg}_{part}"))?, *mass_kg)?;
    }
    match &drop.extra {
        Some(extra) => loaded(&model, drop.leg, extra),
        None => Ok(model),
    }
}

/// The robot with a mass on the lower leg of a case.
///
/// # Errors
/// [`SimulateError`] where the robot has no such leg, or no point of its lower leg has the mass's distance.
pub(super) fn loaded(model: &Model, case: &LegCase, extra: &ExtraMass) -> Result<Model, SimulateError> {
    let mounted = case.mounted(extra)?;
    let knee = model.joint(&joint_name(case.leg, LegJoint::Q3))?;
    let in_child_m = model.joints()[knee.index()].in_child_m;
    // From the knee through the lower leg's centre, which is its frame's origin.
    let line = nalgebra::Unit::new_normalize(-in_child_m);
    let load = Attached {
        mass_kg: mounted.mass_kg,
        at_m: in_child_m + line.into_inner() * mounted.mount_m,
        inertia_kg_m2: hollow_cylinder_inertia(mounted.mass_kg, mounted.radius_m, mounted.length_m, &line),
    };
    Ok(model.with_attached(knee.child(), load)?)
}

/// At rest, everything at its setpoint.
fn pose(model: &Model, drop: &BenchDrop<'_>) -> Result<State, SimulateError> {
    let mut state = State::at_rest(model);
    for (joint, angle_rad) in model.joints().iter().zip(&mut state.angle_rad) {
        *angle_rad = joint.resting_rad();
    }
    for joint in LegJoint::ALL {
        let id = model.joint(&joint_name(drop.leg.leg, joint))?;
        state.angle_rad[id.index()] = drop.leg.held.angle(joint);
    }
    Ok(state)
}

fn simulate(
    model: &Model,
    joints: &Joints,
    start: &State,
    held_rad: &[f64],
    [from_s, to_s]: [f64; 2],
    method: Method,
) -> Result<Recording, SimulateError> {
    let t_s = vec![from_s, to_s];
    let columns = held_rad.iter().map(|angle| Some(Column { angle_rad: vec![*angle; 2], on: None })).collect();
    let setpoints = Setpoints { t_s, columns, hold: Hold::Linear };
    let scenario = Scenario { model, joints, setpoints: &setpoints, start, surroundings: None, period_s: SAMPLE_S };
    run(&scenario, method)
}
