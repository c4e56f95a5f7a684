//! The robot as given, as found and logged, moving together, drawn from its own tree.

use crate::gap::Diagnosis;
use crate::gap::clamped::ClampedSetup;
use crate::gap::whole::Whole;
use crate::log::RobotLog;
use crate::report::animation::{DOG_M, LEAST_UNIT, PICTURE_S};
use crate::report::{Animation, Recording};
use crate::robot::{Dynamics, Model, State};
use nalgebra::{UnitQuaternion, Vector3};

/// The longest film \[s\].
const FILM_S: f64 = 60.0;
/// Joints that are lit have at least this share of the worst joint's error.
const GUILTY: f64 = 0.7;

/// The first log that the whole robot was simulated on; `None` where nothing can be drawn.
pub(super) fn animation(setup: &ClampedSetup, whole: &Whole, joints: &[&Diagnosis]) -> Option<Animation> {
    let model = Model::of_description(&setup.description).ok()?;
    let log = setup.logs.get(whole.shown.log)?;
    let logged: Vec<Vec<f64>> = log.joints.iter().map(|joint| joint.q_rad.clone()).collect();
    let film = |motion: &[Vec<f64>]| film(&model, setup, log, motion);
    let (given, found, logged) = (film(&whole.shown.before), film(&whole.shown.after), film(&logged));
    let [low, far] = logged.extent_m();
    let worst = joints.iter().map(|own| own.gap.before).fold(0.0, f64::max);
    let guilty = joints.iter().filter(|own| own.gap.before >= GUILTY * worst && own.gap.before > 2.0 * own.gap.floor);
    let part = |own: &&Diagnosis| {
        let id = model.joint(&own.joint).ok()?;
        Some(model.bodies()[id.child().index()].name.clone())
    };
    let lit: Vec<String> = guilty.filter_map(part).collect();
    let name = &setup.description.name;
    let entry = setup.study.logs.get(whole.shown.log)?;
    let note = format!(
        "{}: every part is the ellipsoid of its inertia. Framed: the parts whose joints are farthest off.",
        entry.file
    );
    let mut animation = Animation::new(format!("{name}: as given, as found and logged"), note)
        .with("as given", given)
        .with("as found", found)
        .with("logged", logged)
        .lit(&lit);
    (animation.floor_m, animation.unit) = (low, (far / DOG_M).max(LEAST_UNIT));
    Some(animation)
}

/// Angles of a log's joints as a motion; those that follow others with them; the others stand as drawn. What is up for
/// the robot is up in the picture.
fn film(model: &Model, setup: &ClampedSetup, log: &RobotLog, motion: &[Vec<f64>]) -> Recording {
    let (mut dynamics, mut state) = (Dynamics::new(model), State::at_rest(model));
    let up = -setup.tree.gravity_m_s2();
    state.base_orientation = UnitQuaternion::rotation_between(&up, &Vector3::y()).unwrap_or_default();
    let mut film = Recording::of_tree(model);
    let mut next_s = f64::NEG_INFINITY;
    for (k, t_s) in log.t_s.iter().enumerate() {
        if *t_s < next_s - 1e-9 {
            continue;
        }
        if *t_s > log.t_s[0] + FILM_S {
            break;
        }
        next_s = t_s + PICTURE_S;
        for (joint, angles) in log.joints.iter().zip(motion) {
            if let (Ok(id), Some(angle)) = (model.joint(&joint.name), angles.get(k)) {
                state.angle_rad[id.index()] = *angle;
            }
        }
        model.follow(&mut state);
        film.push(*t_s, dynamics.motions(&state));
    }
    film
}
