//! How well a joint's numbers alone predict its held-out logs, without a search for causes.

use crate::gap::diagnosis::GapOptions;
use crate::gap::hypothesis::calibrate::calibrate;
use crate::gap::hypothesis::demands::resolved;
use crate::gap::hypothesis::evidence::Evidence;
use crate::gap::hypothesis::held_out::HeldOut;
use crate::gap::hypothesis::trial::{AGAIN, Trial};
use crate::identify::{BeliefFound, Case, JointModel};
use std::sync::Arc;

/// A joint with its numbers refitted.
pub(in crate::gap) struct Refitted {
    /// Root of the mean squared residual that it leaves \[rad\].
    pub left_rad: f64,
    /// How many of its numbers are far from what is believed of them.
    pub far: usize,
}

impl Refitted {
    /// `None` where the joint cannot be recalibrated.
    pub fn of(case: &Case, options: &GapOptions) -> Option<Self> {
        let (evidence, found) = recalibrated(case, options)?;
        let beliefs = BeliefFound::of(found.model.parameters(), &found.found.values);
        let far = beliefs.iter().filter(|belief| belief.is_finding()).count();
        Some(Self { left_rad: left_rad(&evidence, found), far })
    }
}

fn recalibrated(case: &Case, options: &GapOptions) -> Option<(Evidence, Trial)> {
    let mut evidence = Evidence::of(case, case.joint.nominal?)?;
    evidence.demands = Arc::new(resolved(&options.demands, &evidence).ok()?);
    let (coarse, baseline) = (evidence.coarse(), evidence.baseline());
    let found = calibrate(&coarse, &baseline, &Trial::as_given(&coarse, &baseline));
    let found = found.carried(&coarse, &evidence, AGAIN);
    Some((evidence, found))
}

fn left_rad(evidence: &Evidence, mut found: Trial) -> f64 {
    found.predict(evidence, None);
    let held = HeldOut::of(evidence);
    held.rms_rad(&held.residuals(evidence, &found))
}
