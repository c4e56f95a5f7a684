//! Layer 3: the joint as a chain of stages.
//!
//! ```text
//! setpoint -> controller (PID) -> motor (limits) -> link (inertia, gravity, friction) -> encoder -> log
//! ```
//!
//! A stage is perfect until the logs say otherwise; an unmodelled effect is a term added to one stage. The equations
//! are written once, over [`Real`], so that a run on dual numbers gives exact sensitivities.

mod chain;
mod effect;
mod friction;
mod gain;
mod link;
mod motor;
mod passive;
mod real;
mod sensor;
mod setpoint;

pub use chain::Chain;
pub use effect::{Bounds, DrivenReach, EffectId, EffectParameter, Named, Reach, Scan, Stage, UnknownEffect};
pub use friction::{Contact, Friction, FrictionTerm, Stribeck};
pub use gain::{Unrepresentable, gain, gain_word};
pub use link::Link;
pub(crate) use motor::Driven;
pub use motor::{Motor, Setpoint, SpeedLine};
pub use passive::{EndStop, Spring};
pub use real::Real;
pub(crate) use real::{gradient, variable};
pub use sensor::Encoder;
pub use setpoint::{Play, SetpointPath};
