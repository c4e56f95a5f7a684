//! What holds a joint that never moves.

use super::{Case, Item};
use crate::joint::Link;
use crate::log::{DriveMode, Start};

/// Gravity torque on a joint at rest, by the nominal model \[N m\]: its breakaway friction is at least that. `None` where
/// nothing is known of it.
pub fn resting_gravity_nm(case: &Case, item: &Item) -> Option<f64> {
    if item.entry.drive != DriveMode::Off || item.health.start == Start::AlwaysHeld {
        return None;
    }
    let nominal = case.joint.nominal?;
    let g = case.joint.gravity_m_s2;
    let angle_rad = item.log.q_rad.iter().sum::<f64>() / item.log.len() as f64;
    let rest = match &case.leg {
        Some(leg) if leg.pose_known => leg.bare().ok()?.rest_rad,
        _ => case.joint.rest_rad?,
    };
    let bare = Link::new(nominal.inertia_kg_m2, nominal.moment_kg_m, rest, g);
    let whole = match (&item.entry.extra, &case.leg) {
        (Some(extra), Some(leg)) => {
            let load = leg.load(extra).ok()?;
            bare.joined(Link::new(load.inertia_kg_m2, load.moment_kg_m, load.hanging_rad, g))
        }
        (Some(extra), None) => bare.joined(Link::new(0.0, extra.mass_kg * extra.distance_m, rest, g)),
        (None, _) => bare,
    };
    Some(whole.gravity_nm(angle_rad).abs())
}
