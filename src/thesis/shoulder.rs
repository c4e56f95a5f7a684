//! Why can the shoulder mass not be found, and which experiment would find it?
//!
//! The shoulder lies on q1's axis: it adds nothing to the gravity torque and little to the inertia. Both are shares of
//! what turns, and a share is known no better than the bench. The leg's pose is what can be chosen: turned outward it
//! lies along q1's axis, and the shoulder's share grows. Gravity then hardly moves it, so the motor
//! has to. For each experiment the interval that 6 s of readings would leave is computed from the model's sensitivities
//! (Cramer and Rao), the encoder's noise being that of Appendix B.

use super::TablesError;
use super::swings::JointSwings;
use crate::fit::{Normal, Residuals};
use crate::geometry::{Ers7Tables, LegJoint, LegPose, LinkBody, joint_name, lump};
use crate::identify::{Experiment, ExtensiveModel, JointModel, LegCase, Named, Problem, Scale, Signal};
use crate::number::chance::HALF_95;
use crate::number::math;
use crate::pendulum::Start;

/// What the shoulder's mass does about q1, and what would show it.
#[derive(Clone, Debug)]
pub struct Shoulder {
    /// Its share in the moment `M*` of the bare leg.
    pub share_of_moment: f64,
    /// Its share in the inertia `I*`: extra mass \[kg\] and share.
    pub share_of_inertia: Vec<(f64, f64)>,
    /// Shares over poses of the bare leg: angles of q2 and q3 \[rad\].
    pub poses: Vec<(f64, f64, f64)>,
    /// Experiments, as they stand in the text.
    pub experiments: Vec<Proposal>,
}

/// An experiment and what it would leave open of the shoulder's mass.
#[derive(Clone, Debug)]
pub struct Proposal {
    /// What is done.
    pub what: String,
    /// Angles of q2 and q3 \[rad\].
    pub pose_rad: [f64; 2],
    /// The shoulder's share in `I*`.
    pub share: f64,
    /// Half of the 95 % interval by the encoder's noise, over the mass.
    pub by_noise: f64,
    /// With 1 % of uncertainty in the inertia of the rest, or in the torque, as well.
    pub with_bench: f64,
}

/// Noise of a reading by Appendix B: uniform within half a step, then rounded \[rad\].
const NOISE_RAD: f64 = 0.00245;
const PERIOD_S: f64 = 0.008;
const SAMPLES: usize = 750;
/// A motor torque that rises from 1 to 6 Hz \[N m\].
const TORQUE_NM: f64 = 0.1;
const SWEEP_HZ: [f64; 2] = [1.0, 6.0];
/// Uncertainty of lengths, masses and torques of a bench.
const BENCH: f64 = 0.01;
/// Poses in each direction.
const POSES: usize = 15;

/// What can be said of the shoulder's mass about q1; `None` for another joint.
pub(super) fn shoulder(swings: &JointSwings) -> Result<Option<Shoulder>, TablesError> {
    if swings.joint != LegJoint::Q1 {
        return Ok(None);
    }
    let leg = swings.leg()?;
    let bare = leg.bare()?;
    let Some(own) = bare.body(LinkBody::Shoulder) else { return Ok(None) };
    let own_inertia = own.mass_kg * own.inertia_per_kg_m2;
    let mut share_of_inertia = vec![(0.0, own_inertia / bare.inertia_kg_m2)];
    for load in swings.loaded() {
        let extra = load.moving.first().and_then(|e| e.load).map_or(0.0, |l| l.inertia_kg_m2);
        share_of_inertia.push((load.extra_mass_kg, own_inertia / (bare.inertia_kg_m2 + extra)));
    }
    let robot = Ers7Tables::embedded();
    let limits = |joint| -> Result<[f64; 2], TablesError> {
        let row = robot.joint(&joint_name(leg.leg, joint))?;
        Ok(row.software_rad.or(row.hardware_rad).unwrap_or([0.0, 0.0]))
    };
    let (outward, fold) = (limits(LegJoint::Q2)?, limits(LegJoint::Q3)?);
    let at = |[low, high]: [f64; 2], k: usize| low + (high - low) * k as f64 / (POSES - 1) as f64;
    let mut poses = Vec::with_capacity(POSES * POSES);
    for i in 0..POSES {
        for k in 0..POSES {
            let (q2, q3) = (at(outward, i), at(fold, k));
            poses.push((q2, q3, share_at(leg, q2, q3)?));
        }
    }
    let best = poses.iter().copied().max_by(|a, b| a.2.total_cmp(&b.2)).unwrap_or((0.0, 0.0, 0.0));
    let here = (leg.held.q2_rad, leg.held.q3_rad);
    let experiments = vec![
        proposal(swings, "let go, the leg as in the tests", here, false)?,
        proposal(swings, "driven by the motor, the leg as in the tests", here, true)?,
        proposal(swings, "driven by the motor, the leg turned outward", (best.0, best.1), true)?,
    ];
    let share_of_moment = own.mass_kg * own.distance_m() / bare.moment_kg_m;
    Ok(Some(Shoulder { share_of_moment, share_of_inertia, poses, experiments }))
}

fn posed(leg: &LegCase, q2_rad: f64, q3_rad: f64) -> LegCase {
    let held = LegPose::STRAIGHT.with(LegJoint::Q2, q2_rad).with(LegJoint::Q3, q3_rad);
    LegCase { held, ..leg.clone() }
}

/// The shoulder's share in the bare leg's inertia about q1 at a pose.
fn share_at(leg: &LegCase, q2_rad: f64, q3_rad: f64) -> Result<f64, TablesError> {
    let posed = posed(leg, q2_rad, q3_rad);
    let bare = lump(Ers7Tables::embedded(), leg.leg, leg.joint, &posed.held, leg.gravity_trunk_m_s2, None)?;
    let own = bare.body(LinkBody::Shoulder).map_or(0.0, |b| b.mass_kg * b.inertia_per_kg_m2);
    Ok(own / bare.inertia_kg_m2)
}

/// What an experiment with the bare leg would leave open.
fn proposal(
    swings: &JointSwings,
    what: &str,
    (q2_rad, q3_rad): (f64, f64),
    driven: bool,
) -> Result<Proposal, TablesError> {
    let leg = posed(swings.leg()?, q2_rad, q3_rad);
    let share = share_at(&leg, q2_rad, q3_rad)?;
    let none = Proposal {
        what: what.into(),
        pose_rad: [q2_rad, q3_rad],
        share,
        by_noise: f64::INFINITY,
        with_bench: f64::INFINITY,
    };
    let Some(like) = swings.moving().into_iter().next() else { return Ok(none) };
    let bare = leg.bare()?;
    let t_s: Vec<f64> = (0..SAMPLES).map(|k| k as f64 * PERIOD_S).collect();
    let length_s = SAMPLES as f64 * PERIOD_S;
    let sweep = |t: f64| {
        let [from, to] = SWEEP_HZ;
        TORQUE_NM * math::sin(std::f64::consts::TAU * (from * t + 0.5 * (to - from) * t * t / length_s))
    };
    let signal = match driven {
        true => Signal::Torque { torque_nm: t_s.iter().map(|t| sweep(*t)).collect(), on: None },
        false => Signal::Off,
    };
    let start_rad = bare.rest_rad + if driven { 0.0 } else { 0.5 };
    let e = Experiment {
        uncompared: 0,
        first_sample: 0,
        weights_s: vec![PERIOD_S; SAMPLES],
        measured_rad: vec![start_rad; SAMPLES],
        t_s,
        signal,
        motor: None,
        release_window_s: None,
        start: Start { angle_rad: start_rad, rate_rad_s: 0.0, release_s: None },
        load: None,
        bodies: leg.bodies()?,
        gravity_m_s2: bare.gravity_m_s2,
        runs: Vec::new(),
        ..like
    };
    let (one, masses, nominal) = (std::slice::from_ref(&e), leg.masses()?, leg.nominal()?);
    let model =
        ExtensiveModel::bodies(&Scale::of(one, Some(&nominal), None), one, &masses, true, Some(&nominal), false);
    let problem = Problem::new(&model, one);
    let values: Vec<f64> = model.parameters().iter().map(|p| p.nominal.unwrap_or(p.start)).collect();
    let blocks = problem.linearise(&problem.coordinates_of(&values))?;
    let size = problem.coordinates().len();
    // The start's speed is free in the model but known here; a joint at rest does not answer to it.
    let information = Normal::of(&blocks, size).jtj;
    let answering: Vec<usize> = (0..size).filter(|&i| information[(i, i)] > 0.0).collect();
    let reduced =
        nalgebra::DMatrix::from_fn(answering.len(), answering.len(), |i, k| information[(answering[i], answering[k])]);
    let Some(place) = problem.free().iter().position(|p| matches!(p.named(), Some(Named::Mass(_)))) else {
        return Ok(none);
    };
    let Some(at) = answering.iter().position(|&i| i == place) else { return Ok(none) };
    let Some(covariance) = reduced.try_inverse() else { return Ok(none) };
    let by_noise = HALF_95 * NOISE_RAD * (PERIOD_S * covariance[(at, at)]).max(0.0).sqrt();
    Ok(Proposal { by_noise, with_bench: math::hypot(by_noise, BENCH / share), ..none })
}
