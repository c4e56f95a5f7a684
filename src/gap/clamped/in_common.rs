//! What all joints of a robot have with one size, put into their answers.

use super::diagnose::{ClampedAnswer, ClampedDiagnosis, ClampedGap, SharedCause, gap, sentence, severity};
use crate::gap::hypothesis::held_out::closed;
use crate::gap::verdict::sentence::{REFITTED, words};
use crate::gap::{CauseShare, Diagnosis, Number, Verdict};
use crate::joint::EffectForm;
use crate::number::{capital, mrad, quantity};

/// Where no exam has asked how often such an answer is right.
const NOT_MEASURED: &str = "no probability is stated for what the whole robot tells and not the joint alone";

/// An effect with the values that all joints have.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::gap) struct Common {
    /// Which effect, and how.
    pub form: EffectForm,
    /// Its values under the catalogue's names, with their intervals.
    pub parameters: Vec<Number>,
}

impl Common {
    /// `a setpoint that is late (T = 24.985 [24.962, 25.007] ms)`
    fn words(&self) -> String {
        let sizes = self.parameters.iter().map(|n| format!("{} = {}", n.name, quantity(n.value, n.interval, &n.unit)));
        format!("{} ({})", words(self.form.id), sizes.collect::<Vec<_>>().join(", "))
    }
}

impl ClampedDiagnosis {
    /// The same where all joints have one cause as the whole robot has it, which leaves so much of each \[rad\]; alone joints
    /// were asked for that only, and `before` for anything.
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
            match own.causes.iter_mut().find(|cause| cause.effect == effect) {
                None => put_in(own, common, left_rad(&own.joint)),
                Some(cause) if cause.form == common.form.name() => cause.parameters.clone_from(&common.parameters),
                Some(_) => {}
            }
        }
        self.gap = ClampedGap { calibrated: self.gap.calibrated, ..gap(&self.joints) };
        self.causes.retain(|cause| cause.effect != effect);
        let (group, size) = (Some("all".to_owned()), common.parameters.first().cloned());
        // What others close is theirs.
        let others: f64 = self.causes.iter().map(|cause| cause.share).sum();
        let share = (1.0 - (self.gap.after / self.gap.calibrated).powi(2) - others).max(0.0);
        self.causes.push(SharedCause { effect, joints: all, group, size, share, common: true });
        self.causes.sort_by(|a, b| b.share.total_cmp(&a.share));
        // A joint that was asked for that alone bends its numbers; those that all have are the whole robot's.
        self.pooled.clear();
        let mut ids = self.causes.iter().map(|cause| cause.effect.id());
        let verdict = self.answer.verdict;
        self.answer = ClampedAnswer {
            verdict: if severity(verdict) < severity(Verdict::Effect) { Verdict::Effect } else { verdict },
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
    let is_lower = left_rad.is_some_and(|left_rad| left_rad < own.gap.after);
    if let Some(left_rad) = left_rad.filter(|_| is_lower) {
        own.gap.after = left_rad;
        own.gap.closed = closed(own.gap.before, left_rad, own.gap.floor);
        own.gap.closed_interval = None;
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
    let told = format!(
        "as all joints of the robot it has {}, which all of them simulated at once tell; alone, along the motion of the others, it is \
         too little here",
        common.words()
    );
    let of_whole = if is_lower { ", as the whole robot leaves it" } else { "" };
    let [before, calibrated, after] = [own.gap.before, own.gap.calibrated, own.gap.after].map(mrad);
    let answer = &mut own.answer;
    (answer.probability, answer.probability_source) = (None, NOT_MEASURED.to_owned());
    own.ranking.iter_mut().for_each(|candidate| candidate.probability = 0.0);
    if severity(answer.verdict) < severity(Verdict::Effect) {
        answer.verdict = Verdict::Effect;
        answer.effect = Some(effect.id().to_owned());
        answer.sentence = format!(
            "{}: {told}; the error goes from {before} as given to {calibrated} with {REFITTED} and to {after} with it{of_whole}.",
            own.joint
        );
    } else {
        answer.sentence += &format!(" {}{of_whole}.", capital(&told));
    }
}
