//! Which causes: what each would change, sets grown, exchanged and proven, and laws for what has no name.

pub(in crate::gap) mod attribute;
pub(in crate::gap) mod beginnings;
pub(in crate::gap) mod chance;
pub(in crate::gap) mod differs;
pub(in crate::gap) mod explore;
pub(in crate::gap) mod grow;
pub(in crate::gap) mod held_response;
pub(in crate::gap) mod hold_fit;
pub(in crate::gap) mod hold_scan;
pub(in crate::gap) mod judged;
pub(in crate::gap) mod kin;
pub(in crate::gap) mod law_candidates;
pub(in crate::gap) mod laws;
pub(in crate::gap) mod pairs;
pub(in crate::gap) mod projector;
pub(in crate::gap) mod refuted;
pub(in crate::gap) mod searched;
pub(in crate::gap) mod sight;
pub(in crate::gap) mod together;
pub(in crate::gap) mod unnamed;
pub(in crate::gap) mod within;
