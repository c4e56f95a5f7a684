//! The whole robot fitted to the swings of each joint: do the joints that are held give, and what is left to weigh?

use super::swings::JointSwings;
use super::{Of, Printed, Row, TablesError};
use crate::gap::neighbours::{Compared, Swings};
use crate::geometry::LegJoint;
use crate::identify::{Estimate, Named};
use crate::robot::bench::Held;

/// One joint's swings in the whole robot.
#[derive(Clone, Debug)]
pub struct Whole {
    /// The joint.
    pub joint: LegJoint,
    /// With rigid and with giving neighbours.
    pub compared: Compared,
    /// What the better of the two found.
    pub found: Vec<Row>,
}

/// Swings of a joint that are fitted, shared out over the extra masses.
const LOGS: usize = 4;

/// Fits the whole robot to swings; `None` where none begins held.
pub(super) fn whole(swings: &JointSwings) -> Result<Option<Whole>, TablesError> {
    let loads = swings.loads.iter().filter(|load| !load.moving.is_empty()).count();
    let Some(held) = Swings::of(&swings.case, (LOGS / loads.max(1)).max(1))? else { return Ok(None) };
    let compared = Compared::of(&held, false)?;
    let how = match compared.held() {
        Some(Held::ByController) => "others give",
        Some(Held::Rigid) => "others rigid",
        None => "either way",
    };
    let printed = Printed::embedded();
    let friction = printed.estimated(swings.joint);
    let row = |estimate: &Estimate| {
        let joint = || Of::Joint(swings.joint.to_string());
        let own = estimate.name.rsplit('.').next().unwrap_or(&estimate.name);
        let (of, quantity, thesis) = match estimate.named() {
            Some(Named::Mass(_)) => (Of::Body("lower leg".into()), "mass", printed.mass_kg("lower leg")),
            Some(Named::Coulomb) => (joint(), own, friction.map(|row| row.coulomb_nm)),
            Some(Named::Viscous) => (joint(), own, friction.map(|row| row.viscous_nm_s_rad)),
            _ => (joint(), own, Some(0.0)),
        };
        let unit = if estimate.unit.is_empty() { "1" } else { &estimate.unit };
        let row = Row::new(of, quantity, how, unit, thesis);
        match estimate.interval {
            Some(interval) => row.estimated(estimate.value, interval),
            None => Row { remark: "not determined".into(), ..row },
        }
    };
    let mut found: Vec<Row> = compared.best().found.iter().map(row).collect();
    if compared.lacks_something() {
        for row in &mut found {
            row.identifiable = false;
        }
        if let Some(mass) = found.iter_mut().find(|row| row.quantity == "mass") {
            mass.remark =
                format!("about {}, something else is in these drops; the interval leaves out its bias", swings.joint);
        }
    }
    Ok(Some(Whole { joint: swings.joint, compared, found }))
}
