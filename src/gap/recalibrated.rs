//! How well a joint's numbers alone predict its held-out logs, without a search for causes.

use super::GapOptions;
use super::calibrate::calibrate;
use super::demands::resolved;
use super::evidence::Evidence;
use super::held_out::HeldOut;
use super::trial::Trial;
use crate::fit::Budget;
use crate::identify::Case;
use std::sync::Arc;

/// Evaluations of the fit to all samples, which begins near its end.
const AGAIN: Budget = Budget { evaluations: 24 };

/// Root of the mean squared residual that the recalibrated joint leaves \[rad\]; `None` where it cannot be recalibrated.
pub(super) fn recalibrated_rms_rad(case: &Case, options: &GapOptions) -> Option<f64> {
    let mut evidence = Evidence::of(case, case.joint.nominal?)?;
    evidence.demands = Arc::new(resolved(&options.demands, &evidence).ok()?);
    let (coarse, baseline) = (evidence.coarse(), evidence.baseline());
    let mut found = calibrate(&coarse, &baseline, &Trial::as_given(&coarse, &baseline));
    found.begin_as(&coarse, &evidence);
    let mut found = found.on(&evidence, AGAIN);
    found.predict(&evidence, None);
    let held = HeldOut::of(&evidence);
    Some(held.rms_rad(&held.residuals(&evidence, &found)))
}
