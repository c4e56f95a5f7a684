//! Which explanation do the drops of a joint need? Fits of the whole robot, with and without each.
//!
//! A pendulum that was fitted with rigid neighbours has taken in what they do, so that its values say nothing of whether
//! they give. Here every combination is refitted in the whole robot ([`bench_drop`]): the other joints rigid or held by
//! their controllers, the encoder's zero, the lower leg's mass, load friction, friction that differs with the direction,
//! Coulomb friction; viscous friction is always searched. [`Refits::of`] compares them by what they leave: RMS, distance at
//! rest, and Schwarz's information criterion `n ln(sum of squares) + p ln n` (1978), where n counts correlated residuals
//! once. A start is the mean reading before the joint is let go.
//!
//! [`bench_drop`]: super::bench::bench_drop

mod cause;
mod compare;
mod logs;
mod measure;
mod one;
mod problem;
mod search;
mod values;

pub use cause::Cause;
pub use compare::{DECIDED, Ranked, Refits, Verdict};
pub use logs::BenchLogs;
pub use one::Refit;
