//! The floor (section 2.3.1): which forces does it put on the parts that touch it, and how do they change with the
//! motion?
//!
//! - [`FloorParameters`]: the numbers of eqs 2.3-2.6, as a robot study writes them.
//! - [`Floor`]: those numbers checked, with the parts of a robot that may touch.
//!
//! A part touches with the lowest point of its ellipsoid (Table A.2). Hunt and Crossley's normal force (2.3) acts
//! there, never pulling; friction (2.4, 2.5) against the sliding velocity of the body's point there; a torque about the
//! normal (2.6) against its spin. The text prints both Stribeck exponents without an absolute value or square and with
//! only `v_st` squared; used here is `exp(-(v/v_st)^2)` (Armstrong-Helouvry et al. 1994).
//!
//! Left out: the patch of contact. A point has no torsional friction of its own, and (2.6) as printed has the
//! dimension of a force: it is given a contact radius here, 0 (no torsion) by default.
//!
//! - [`Resting`]: points that have stood for a while are held, for (2.4) alone creeps under any load.

mod exp;
mod floor;
mod law;
mod resting;
#[cfg(test)]
mod tests;

pub(crate) use floor::STEEPEST_RAD;
pub use floor::{Floor, FloorParameters, Touching};
pub use law::Contact;
pub use resting::Resting;
