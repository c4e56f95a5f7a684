//! Hypotheses about a joint: what there is to argue from, the model with its numbers and causes, fits of it, and what a fit is worth.

pub(in crate::gap) mod calibrate;
pub(in crate::gap) mod compare;
pub(in crate::gap) mod demands;
pub(in crate::gap) mod evidence;
pub(in crate::gap) mod floor;
pub(in crate::gap) mod folds;
pub(in crate::gap) mod held_out;
pub(in crate::gap) mod law_shape;
pub(in crate::gap) mod logs;
pub(in crate::gap) mod model;
pub(in crate::gap) mod reach;
pub(crate) mod rotor;
pub(in crate::gap) mod score;
pub(in crate::gap) mod torque_seen;
pub(in crate::gap) mod trial;
