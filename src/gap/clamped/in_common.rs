//! What all joints of a robot have with one size, put into their answers.

use super::diagnose::{ClampedAnswer, ClampedDiagnosis, ClampedGap, SharedCause, gap, gravity, sentence};
use crate::gap::held_out::closed;
use crate::gap::whole::Common;
use crate::gap::{Diagnosis, Verdict};

/// Where a joint's own page lacks what all joints have.
const TOO_LITTLE: &str =
    "all of them simulated at once tell it, and alone along the motion of the others it is too little here";

impl ClampedDiagnosis {
    /// The cause that all joints have, where a joint's own answer lacks it.
    pub(in crate::gap) fn common_beside(&self, own: &Diagnosis) -> Option<&Common> {
        self.common.as_ref().filter(|common| own.causes.iter().all(|cause| cause.effect != common.form.id))
    }

    /// The same where all joints have one cause as the whole robot has it, which leaves so much of each \[rad\]; alone joints were
    /// asked for that only, and `before` for anything.
    pub(in crate::gap) fn with_common(
        mut self,
        common: &Common,
        left_rad: &dyn Fn(&str) -> Option<f64>,
        before: &Self,
    ) -> Self {
        let effect = common.form.id;
        let mut all = Vec::new();
        let mut lacking = Vec::new();
        for own in self.joints.iter_mut().filter_map(|joint| joint.diagnosis.as_mut()) {
            all.push(own.joint.clone());
            let mut first = before.joints.iter().filter_map(|joint| joint.diagnosis.as_ref());
            if let Some(first) = first.find(|first| first.joint == own.joint) {
                own.withheld.clone_from(&first.withheld);
                own.detectable.clone_from(&first.detectable);
            }
            if own.causes.iter().any(|cause| cause.effect == effect) {
                continue;
            }
            lacking.push(own.joint.clone());
            let mut note = format!("All joints of the robot have {}: {TOO_LITTLE}", common.words());
            if let Some(left_rad) = left_rad(&own.joint).filter(|left_rad| *left_rad < own.gap.after) {
                own.gap.after = left_rad;
                own.gap.closed = closed(own.gap.before, left_rad, own.gap.floor);
                note += ". What is left in the end is what the whole robot leaves";
            }
            own.notes.push(note + ".");
        }
        self.gap = ClampedGap { calibrated: self.gap.calibrated, ..gap(&self.joints) };
        if !lacking.is_empty() {
            self.notes.push(format!("{}: {}, as all joints: {TOO_LITTLE}.", lacking.join(", "), common.words()));
        }
        self.causes.retain(|cause| cause.effect != effect);
        let (group, size) = (Some("all".to_owned()), common.parameters.first().cloned());
        let share = (1.0 - (self.gap.after / self.gap.calibrated).powi(2)).max(0.0);
        self.causes.push(SharedCause { effect, joints: all, group, size, share });
        self.causes.sort_by(|a, b| b.share.total_cmp(&a.share));
        let mut ids = self.causes.iter().map(|cause| cause.effect.id());
        let verdict = self.answer.verdict;
        self.answer = ClampedAnswer {
            verdict: if gravity(verdict) < gravity(Verdict::Effect) { Verdict::Effect } else { verdict },
            effect: ids.next(),
            second: ids.next(),
            sentence: sentence(&self.robot, &self.joints, &self.gap, &self.bodies, &self.causes, &self.pooled),
            ..self.answer
        };
        self.common = Some(common.clone());
        self
    }
}
