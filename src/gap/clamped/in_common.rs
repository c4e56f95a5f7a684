//! What all joints of a robot have with one size, put into their answers.

use super::diagnose::{ClampedAnswer, ClampedDiagnosis, ClampedGap, SharedCause, gap, gravity, sentence};
use crate::gap::held_out::closed;
use crate::gap::whole::Common;
use crate::gap::{CauseShare, Diagnosis, Verdict};

impl ClampedDiagnosis {
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
        for own in self.joints.iter_mut().filter_map(|joint| joint.diagnosis.as_mut()) {
            all.push(own.joint.clone());
            if let Some(first) = before.found().find(|first| first.joint == own.joint) {
                own.withheld.clone_from(&first.withheld);
                own.detectable.clone_from(&first.detectable);
            }
            if own.causes.iter().all(|cause| cause.effect != effect) {
                put_in(own, common, left_rad(&own.joint));
            }
        }
        self.gap = ClampedGap { calibrated: self.gap.calibrated, ..gap(&self.joints) };
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
        self
    }
}

/// Puts what all joints have into the answer of one that does not show it alone; the whole robot leaves so much of it \[rad\].
fn put_in(own: &mut Diagnosis, common: &Common, left_rad: Option<f64>) {
    let effect = common.form.id;
    let mut told = format!(
        " As all joints of the robot it has {}: all of them simulated at once tell that; alone, along the motion of the others, it \
         is too little here.",
        common.words()
    );
    if let Some(left_rad) = left_rad.filter(|left_rad| *left_rad < own.gap.after) {
        own.gap.after = left_rad;
        own.gap.closed = closed(own.gap.before, left_rad, own.gap.floor);
        told += " What is left with it is what the whole robot leaves.";
    }
    own.causes.push(CauseShare {
        effect,
        form: common.form.name(),
        only: None,
        equivalent: vec![effect],
        parameters: common.parameters.clone(),
        alone: None,
        last: None,
        after: own.gap.after,
    });
    own.effect_parameters.push((effect, common.parameters.clone()));
    let answer = &mut own.answer;
    answer.sentence += &told;
    if gravity(answer.verdict) < gravity(Verdict::Effect) {
        answer.verdict = Verdict::Effect;
        answer.effect = Some(effect.id().to_owned());
    }
}
