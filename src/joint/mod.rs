//! Layer 3: the joint as a chain of stages.
//!
//! ```text
//! setpoint -> controller (PID) -> motor (limits) -> link (inertia, gravity, friction) -> encoder -> log
//! ```
//!
//! A stage is perfect until the logs say otherwise; an unmodelled effect is a term added to one stage. The equations
//! are written once, over [`Real`], so that a run on dual numbers gives exact sensitivities.

mod carriage;
mod chain;
mod dual;
mod effect;
mod friction;
mod gain;
mod gearing;
mod law;
mod link;
mod motor;
mod passive;
mod real;
mod sensor;
mod setpoint;

pub use carriage::{Carriage, Carried};
pub use chain::Chain;
pub(crate) use chain::TwoSides;
pub use dual::Dual;
pub use effect::{
    Bounds, DrivenReach, EffectForm, EffectId, EffectParameter, Named, Reach, Scan, Stage, UnknownEffect,
};
pub use friction::{Contact, Friction, FrictionTerm, Stribeck, StribeckCurve};
pub use gain::{Unrepresentable, gain, gain_word};
pub use gearing::{Compliance, Play};
pub use law::{BadLaw, Curve, CurveTable, Law, LawActs, LawTable, LawVariable};
pub use link::Link;
pub(crate) use motor::Driven;
pub use motor::{Beyond, Braking, DeadBand, Knee, Motor, Setpoint, SpeedLine, TorqueLimit};
pub use passive::{EndStop, Push, Spring, SpringCurve};
pub use real::Real;
pub use sensor::{Eccentric, Encoder};
pub use setpoint::{ProfileLimits, SetpointPath};
