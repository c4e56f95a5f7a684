//! Do the joints give that were held while one joint of a leg swung? Fits of the whole robot, with and without each cause.
//!
//! A pendulum that was fitted with rigid neighbours has taken in what they do, so that its values say nothing of whether
//! they give. So every hypothesis is fitted to the swings in the whole robot ([`bench_drop`]): the other joints held rigidly or
//! by their controllers, and, each a [`Cause`] that may be let in, the lower leg's mass, Coulomb friction, the encoder's zero,
//! load friction, and friction that differs with the direction. Viscous friction is always searched; a start is the mean reading
//! before the joint is let go. [`Compared`] weighs hypotheses as all others of this layer are weighed: deviance, a charge for
//! every number and for every cause, and the noise that the readings themselves show. [`Repeated`] holds all logs of a case
//! against the whole robot, with the pendulum's values and with those that were fitted.
//!
//! [`bench_drop`]: crate::robot::bench::bench_drop

mod cause;
mod compared;
mod hypothesis;
mod problem;
mod repeated;
mod swings;
#[cfg(test)]
mod tests;

pub use super::hypothesis::score::EQUAL_DEVIANCE;
pub use super::verdict::decide::leaves_something;
pub use cause::Cause;
pub use compared::{Compared, Ranked};
pub use hypothesis::Hypothesis;
pub use repeated::{Apart, RepeatError, Repeated, RepeatedDrop};
pub use swings::Swings;
use swings::at_rest_rad;
