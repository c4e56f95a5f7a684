//! What a leg is doing, by what is asked of it.

use super::case::{CaseLog, RobotCase};
use super::diagnosis::GaitPhase;
use crate::robot::{Dynamics, JointId, State};

/// A stance begins with its touch-down for so long \[s\].
const TOUCH_DOWN_S: f64 = 0.08;
/// A foot is moved by its setpoints if it goes faster than this \[m/s\].
const STILL_M_S: f64 = 2e-3;

/// The phase of each joint of the robot at each sample of a log; joints that are on no leg run.
///
/// A foot that its leg's setpoints move to the rear carries, or would; one that they move to the front swings.
pub(super) fn phases(case: &RobotCase, log: &CaseLog) -> Vec<Vec<GaitPhase>> {
    let (model, t_s) = (&log.scene.model, &log.log.t_s);
    let mut by_joint: Vec<Vec<GaitPhase>> = vec![Vec::new(); case.names.len()];
    if let Some((_, at_s)) = log.release {
        let phase = |t: &f64| if *t < at_s { GaitPhase::Hold } else { GaitPhase::Run };
        by_joint.fill(t_s.iter().map(phase).collect());
        return by_joint;
    }
    let mut dynamics = Dynamics::new(model);
    let mut state = State::at_rest(model);
    // How far to the rear each body's foot is, at each sample.
    let rear_m: Vec<Vec<f64>> = t_s
        .iter()
        .map(|t| {
            for id in model.joint_ids() {
                state.angle_rad[id.index()] =
                    log.scene.setpoints.at(id, *t).unwrap_or(log.scene.start.angle_rad[id.index()]);
            }
            let bodies = dynamics.motions(&state).iter().zip(model.bodies());
            bodies.map(|(at, body)| at.point_m(&body.foot_m()).z).collect()
        })
        .collect();
    let begins_s = log.motion_begins_s();
    for id in model.joint_ids() {
        let foot = tip_of(case, id);
        let is_leg = model.bodies()[foot].touches_floor();
        let mut touched_s = f64::NEG_INFINITY;
        let mut was_swinging = false;
        by_joint[id.index()] = (0..t_s.len())
            .map(|k| {
                if t_s[k] < begins_s {
                    return GaitPhase::Hold;
                }
                if !is_leg {
                    return GaitPhase::Run;
                }
                let (before, after) = (k.saturating_sub(1), (k + 1).min(t_s.len() - 1));
                let rate_m_s = (rear_m[after][foot] - rear_m[before][foot]) / (t_s[after] - t_s[before]);
                if rate_m_s < -STILL_M_S {
                    was_swinging = true;
                    return GaitPhase::Swing;
                }
                if was_swinging {
                    (was_swinging, touched_s) = (false, t_s[k]);
                }
                if t_s[k] - touched_s < TOUCH_DOWN_S { GaitPhase::TouchDown } else { GaitPhase::Stance }
            })
            .collect();
    }
    by_joint
}

/// The last body of the chain that a joint is on, by place; of several the first.
fn tip_of(case: &RobotCase, joint: JointId) -> usize {
    let model = case.model();
    let mut body = joint.child();
    while let Some(next) = model.joint_ids().find(|id| model.carrier(*id) == body) {
        body = next.child();
    }
    body.index()
}
