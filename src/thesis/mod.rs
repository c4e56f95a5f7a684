//! Chapter 3 of the thesis as one procedure: swings in, Tables 3.1 to 3.4 out, the printed numbers beside ours. And
//! chapter 4's open question ([`weak_q2`]), and the falls that section 5.2 recommends ([`falls`]).
//!
//! A layer between the fits and the reports. What the thesis prints is data (`data/thesis-tables.toml`), the swings are
//! a folder of logs with sidecars. [`tables`] runs everything in the thesis's order: the simple pendulum with two extra
//! masses (3.2-3.6), then the extensive one about q3, q2 and q1 (3.8-3.14).

mod chain;
mod drop;
pub mod falls;
mod knee;
mod printed;
mod puzzle;
mod ratios;
mod robot;
mod row;
mod shoulder;
mod swings;
pub mod weak_q2;
mod whole;

pub use chain::Weighed;
pub use drop::Drop;
pub use knee::Knee;
pub use printed::{CoulombByLoad, FrictionRow, MassRow, Printed, RatioRow, Rounding};
pub use puzzle::{
    Approach, BARE_FACTOR, Candidate, CoulombSeen, JointPuzzle, LOADED_FACTOR, NEAR, Puzzle, Scan, Setting,
};
pub use ratios::RatioTable;
pub use row::{Of, Row};
pub use shoulder::{Proposal, Shoulder};
pub use swings::{JointSwings, Load};
pub use whole::Whole;

use crate::fit::Rejected;
use crate::geometry::{GeometryError, LegJoint};
use crate::identify::{CaseError, DirectiveError, Named};
use crate::log::LogError;
use crate::pendulum::Diverged;
use crate::robot::simulate::SimulateError;
use std::path::{Path, PathBuf};

/// Chapter 3 on a folder of swings.
#[derive(Clone, Debug)]
pub struct Tables {
    /// The swings, q1, q2, q3.
    pub swings: Vec<JointSwings>,
    /// Table 3.1, by joint.
    pub ratios: Vec<RatioTable>,
    /// Tables 3.2 to 3.4, by joint.
    pub weighed: Vec<Weighed>,
    /// The swings of each joint in the whole robot.
    pub whole: Vec<Whole>,
    /// Figure 3.6, about q1.
    pub drop: Option<Drop>,
    /// What may be behind Table 3.1 and section 3.3.2.
    pub puzzle: Puzzle,
    /// Whether the bare lower leg moves.
    pub knee: Option<Knee>,
    /// What would find the shoulder's mass.
    pub shoulder: Option<Shoulder>,
    /// A robot file with what was found.
    pub robot_toml: String,
}

/// Why the tables cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TablesError {
    /// A file or the folder cannot be read.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The logs do not make a case.
    #[error(transparent)]
    Case(#[from] CaseError),
    /// The folder lacks swings.
    #[error("{}: no swings of {joint} with two extra masses; logs NAME.csv with sidecars NAME.toml that state [joint] name and [log.extra] are expected", folder.display())]
    TooFewSwings {
        /// The folder.
        folder: PathBuf,
        /// The joint.
        joint: LegJoint,
    },
    /// The leg's pose is not known, or the joint is no leg's.
    #[error(
        "{joint}: the logs are not of a leg of the ERS-7 whose bodies are known; their sidecars must not state a nominal model"
    )]
    NoPose {
        /// The joint.
        joint: LegJoint,
    },
    /// The geometry is impossible.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// A parameter cannot be held.
    #[error(transparent)]
    Directive(#[from] DirectiveError),
    /// No motion can be computed.
    #[error("no fit: {0}")]
    Rejected(#[from] Rejected),
    /// The whole robot cannot be simulated.
    #[error(transparent)]
    Simulate(Box<SimulateError>),
    /// A motion runs away.
    #[error(transparent)]
    Diverged(#[from] Diverged),
}

impl From<SimulateError> for TablesError {
    fn from(error: SimulateError) -> Self {
        TablesError::Simulate(Box::new(error))
    }
}

/// Chapter 3 on the swings of a folder. `progress` is told what is being done.
///
/// # Errors
/// [`TablesError`] where the folder has no such swings or a fit cannot be made.
pub fn tables(folder: &Path, progress: &(dyn Fn(&str) + Sync)) -> Result<Tables, TablesError> {
    progress("reading");
    let swings = swings::read(folder)?;
    progress("simple model");
    let ratios = swings.iter().map(ratios::table).collect::<Result<_, _>>()?;
    let all = chain::weigh(&swings, progress)?;
    let puzzle = puzzle::scan(&swings, progress)?;
    progress("the whole robot");
    let whole = swings.iter().filter_map(|swings| whole::whole(swings).transpose()).collect::<Result<Vec<_>, _>>()?;
    let of_joint = |joint| swings.iter().zip(&all).find(|(swings, _)| swings.joint == joint);
    let (mut drop, mut knee, mut shoulder) = (None, None, None);
    if let Some((q1, weighed)) = of_joint(LegJoint::Q1) {
        let identifiable = all.iter().filter(|weighed| weighed.mass.identifiable);
        let masses_kg = identifiable.filter_map(|weighed| Some((weighed.body, weighed.mass.ours?))).collect();
        drop = drop::drop(q1, masses_kg, &weighed.chosen)?;
        shoulder = shoulder::shoulder(q1)?;
    }
    if let Some((q3, weighed)) = of_joint(LegJoint::Q3) {
        let coulomb = weighed.friction.iter().find(|row| row.quantity == Named::Coulomb.name());
        knee = knee::knee(q3, coulomb.and_then(|row| Some((row.ours?, row.interval?))))?;
    }
    let friction: Vec<&Row> = all.iter().flat_map(|weighed| &weighed.chosen).collect();
    let robot_toml = robot::robot_toml(&weighed_masses(&all), &friction);
    Ok(Tables { swings, ratios, weighed: all, whole, drop, puzzle, knee, shoulder, robot_toml })
}

fn weighed_masses(all: &[Weighed]) -> Vec<&Row> {
    all.iter().map(|weighed| &weighed.mass).collect()
}

impl Tables {
    /// Every file that was read.
    pub fn inputs(&self) -> Vec<PathBuf> {
        self.swings.iter().flat_map(|swings| swings.case.inputs()).collect()
    }

    /// Table 3.1 from the swings.
    pub fn table_3_1(&self) -> Vec<&Row> {
        self.ratios.iter().flat_map(|table| &table.fitted).collect()
    }

    /// Table 3.2.
    pub fn table_3_2(&self) -> Vec<&Row> {
        weighed_masses(&self.weighed)
    }

    /// Table 3.3.
    pub fn table_3_3(&self) -> Vec<&Row> {
        self.weighed.iter().flat_map(|weighed| &weighed.friction).collect()
    }

    /// Table 3.4.
    pub fn table_3_4(&self) -> Vec<&Row> {
        self.weighed.iter().flat_map(|weighed| &weighed.chosen).collect()
    }
}
