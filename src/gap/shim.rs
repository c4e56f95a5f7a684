//! TEMPORARY: stands in for the engine until it is there.

use super::{Diagnosis, GapOptions};
use crate::identify::Case;

/// Why no diagnosis can be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GapError {
    /// The study has no nominal model.
    #[error(
        "the study has no nominal model: [joint] needs inertia, moment, coulomb and viscous, what the engineer believes today"
    )]
    NoNominal,
    /// Nothing moves in any log.
    #[error("the joint never moved in any log")]
    NeverMoved,
    /// No motion can be computed.
    #[error("no motion can be computed: {0}")]
    Rejected(String),
}

/// Diagnoses a case.
///
/// # Errors
/// [`GapError`].
pub fn diagnose(case: &Case, _options: &GapOptions, progress: &(dyn Fn(&str) + Sync)) -> Result<Diagnosis, GapError> {
    progress("nothing");
    Err(if case.joint.nominal.is_none() { GapError::NoNominal } else { GapError::NeverMoved })
}
