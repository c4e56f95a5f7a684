//! The whole robot refitted to the swings of each joint: do the joints that are held give, and what is left to weigh?

use super::swings::JointSwings;
use super::{Of, Printed, Row, TablesError};
use crate::geometry::LegJoint;
use crate::robot::refit::{BenchLogs, Cause, Refits, Verdict};

/// One joint's swings in the whole robot.
#[derive(Clone, Debug)]
pub struct Whole {
    /// The joint.
    pub joint: LegJoint,
    /// With rigid and with giving neighbours.
    pub refits: Refits,
    /// What the better of the two found.
    pub found: Vec<Row>,
}

/// Swings of a joint that are refitted, shared out over the extra masses.
const LOGS: usize = 4;

/// Refits the whole robot to swings; `None` where none begins held.
pub(super) fn whole(swings: &JointSwings) -> Result<Option<Whole>, TablesError> {
    let loads = swings.loads.iter().filter(|load| !load.moving.is_empty()).count();
    let Some(logs) = BenchLogs::of(&swings.case, (LOGS / loads.max(1)).max(1))? else { return Ok(None) };
    let refits = Refits::of(&logs, false)?;
    let held = match refits.verdict() {
        Verdict::Give => "others give",
        Verdict::Rigid => "others rigid",
        Verdict::CannotTell => "either way",
    };
    let printed = Printed::embedded();
    let friction = printed.estimated(swings.joint);
    let best = refits.best();
    let joint = || Of::Joint(swings.joint.to_string());
    let row = |cause: Cause, value: f64, interval: Option<[f64; 2]>| {
        let (of, quantity, thesis) = match cause {
            Cause::Mass => (Of::Body("lower leg".into()), "mass", printed.mass_kg("lower leg")),
            Cause::Coulomb => (joint(), "coulomb", friction.map(|row| row.coulomb_nm)),
            Cause::LoadFriction => (joint(), "mu_l", Some(0.0)),
            Cause::Direction => (joint(), "delta", Some(0.0)),
            _ => (joint(), cause.id(), Some(0.0)),
        };
        estimate(Row::new(of, quantity, held, unit(cause), thesis), value, interval)
    };
    let mut found: Vec<Row> =
        best.found.iter().map(|(cause, value, interval)| row(*cause, *value, *interval)).collect();
    let thesis = friction.map(|row| row.viscous_nm_s_rad);
    let (value, interval) = best.viscous;
    found.push(estimate(Row::new(joint(), "viscous", held, "N m s/rad", thesis), value, interval));
    if refits.lacks_something() {
        for row in &mut found {
            row.identifiable = false;
        }
        if let Some(mass) = found.iter_mut().find(|row| row.quantity == "mass") {
            mass.remark =
                format!("about {}, something else is in these drops; the interval leaves out its bias", swings.joint);
        }
    }
    Ok(Some(Whole { joint: swings.joint, refits, found }))
}

fn unit(cause: Cause) -> &'static str {
    if cause.unit().is_empty() { "1" } else { cause.unit() }
}

fn estimate(row: Row, value: f64, interval: Option<[f64; 2]>) -> Row {
    match interval {
        Some(interval) => row.estimated(value, interval),
        None => Row { remark: "not determined".into(), ..row },
    }
}
