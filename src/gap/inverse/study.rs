//! The study of a robot with a clamped base, diagnosed by what it says to predict.

use super::diagnose::{TorqueDiagnosis, TorqueError, diagnose_torques};
use super::motion::diagnose_motion;
use crate::gap::GapOptions;
use crate::gap::clamped::{ClampedCase, ClampedDiagnosis, ClampedSetup};
use crate::log::Predict;
use crate::progress::Progress;

/// What was found about a robot with a clamped base.
#[derive(Debug)]
pub enum ClampedFound {
    /// By its motion.
    Motion {
        /// What was compared.
        case: ClampedCase,
        /// What was found, errors in rad.
        diagnosis: ClampedDiagnosis,
    },
    /// By the torques along it.
    Torque(TorqueDiagnosis),
}

/// Diagnoses a robot's joints by their motion or by torques, as its study says.
///
/// # Errors
/// [`TorqueError`] where the study makes no case, no joint can be diagnosed, or the diagnosis is no longer wanted.
pub fn diagnose_setup(
    setup: &ClampedSetup,
    options: &GapOptions,
    progress: &dyn Progress,
) -> Result<ClampedFound, TorqueError> {
    match setup.study.predict {
        Predict::Motion => {
            let (case, diagnosis) = diagnose_motion(setup, options, progress)?;
            Ok(ClampedFound::Motion { case, diagnosis })
        }
        Predict::Torque => diagnose_torques(setup, options, progress).map(ClampedFound::Torque),
    }
}
