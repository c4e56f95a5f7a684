//! Where the gap lies: the torque that the recalibrated joint lacks, over what it depends on, without looking at any effect.

pub(in crate::gap) mod along;
pub(in crate::gap) mod binned;
pub(in crate::gap) mod blocks;
pub(in crate::gap) mod localise;
pub(in crate::gap) mod log_part;
pub(in crate::gap) mod looks_like;
#[cfg(test)]
pub(in crate::gap) mod made;
pub(in crate::gap) mod map;
pub(in crate::gap) mod phases;
pub(in crate::gap) mod residual_torque;
pub(in crate::gap) mod rest;
pub(in crate::gap) mod smoother;
pub(in crate::gap) mod stage;
pub(in crate::gap) mod strength;
pub(in crate::gap) mod variables;
