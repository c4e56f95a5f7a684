//! Sizes of a joint's causes as a simulation of the whole robot tells them: the joint alone is simulated along its neighbours'
//! motion, which is smoothed where their setpoints jump.

use crate::gap::diagnosis::Number;
use crate::gap::hypothesis::trial::Trial;
use crate::joint::{EffectForm, EffectId};
use crate::number::chance::HALF_95;

/// A cause as the whole robot has it, at its best.
#[derive(Clone, Debug)]
pub(in crate::gap) struct AtBest {
    /// Which effect, and how.
    pub form: EffectForm,
    /// Its values under the catalogue's names, in their order, with standard deviations; 0 where it was held.
    pub values: Vec<(f64, f64)>,
}

/// Writes the values into an answer's, where that has the same causes.
pub(in crate::gap) fn tell(at_best: &[AtBest], answer: &Trial, numbers: &mut [(EffectId, Vec<Number>)]) {
    let forms = answer.model.forms();
    let is_same = forms.len() == at_best.len() && at_best.iter().all(|cause| forms.contains(&cause.form));
    for cause in at_best.iter().filter(|_| is_same) {
        let own = numbers.iter_mut().filter(|(effect, _)| *effect == cause.form.id).flat_map(|(_, own)| own);
        let own = own.zip(cause.form.named_parameters()).zip(&cause.values);
        for ((number, named), (value, sd)) in own.filter(|(_, (_, sd))| *sd > 0.0) {
            let interval = Some(named.bounds.clip([value - HALF_95 * sd, value + HALF_95 * sd]));
            *number = Number { value: *value, interval, interval_naive: interval, ..number.clone() };
        }
    }
}
