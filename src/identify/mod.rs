//! Between fit and pendulum: logs made ready, models with named parameters, and what the logs say about them.

mod belief;
mod case;
mod conclude;
mod directives;
mod drop;
mod equation_error;
mod experiment;
mod holes;
mod leg;
mod model;
mod named;
mod parameter;
mod problem;
mod run;
mod scale;
mod smooth;
mod undetermined;
mod unit;
mod weights;

pub use belief::BeliefFound;
pub(crate) use belief::Deviations;
pub use case::{Case, CaseError, Item};
pub use conclude::{Estimate, Fitted, Status, conclude};
pub use directives::{DirectiveError, Directives};
pub use drop::{DropError, DropFit, DropOptions, SimpleFit, fit_drop};
pub use experiment::{Body, Experiment, Load, Signal};
pub use leg::LegCase;
pub use model::{BodyMass, ExtensiveModel, JointModel, LinkBy, SimpleModel};
pub use named::Named;
pub use parameter::{Belief, Parameter, Search};
pub use problem::Problem;
pub use run::{Found, Prediction, predict, prediction, search};
pub(crate) use run::{candidates, ranked};
pub use scale::Scale;
pub(crate) use undetermined::undetermined;
pub(crate) use unit::{correlation_length, counts, unit_rad2_s};
