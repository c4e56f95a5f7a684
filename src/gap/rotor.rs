//! What turns with a motor: no better known than the inertia of the link, so one number is searched for both.

use super::evidence::Evidence;
use super::model::INERTIA;
use super::trial::Trial;
use crate::identify::JointModel;
use crate::joint::Real;
use crate::number::quantity;

/// A rotor is not taken for lighter than this share of what is stated: a joint without inertia is too stiff to be simulated.
const LEAST: f64 = 0.1;

/// The armature \[kg m^2\], of which a study states so much, where the link has this share of its stated inertia.
pub(crate) fn armature_kg_m2<T: Real>(stated_kg_m2: f64, share: T) -> T {
    let share = if share.re() < LEAST { T::constant(LEAST) } else { share };
    share * stated_kg_m2
}

/// What became of it, as a sentence to follow that of the inertia; `None` where the study states none.
pub(super) fn in_words(evidence: &Evidence, answer: &Trial) -> Option<String> {
    let stated_kg_m2 = evidence.fit.iter().find_map(|e| e.motor)?.armature_kg_m2;
    let share = answer.found.values[INERTIA] / answer.model.parameters()[INERTIA].nominal?;
    let told = |value: f64| quantity(value, None, "kg m^2");
    (stated_kg_m2 > 0.0).then(|| {
        let [found, stated] = [armature_kg_m2(stated_kg_m2, share), stated_kg_m2].map(told);
        format!(" The armature goes with the inertia: {found} instead of {stated}.")
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn an_armature_moves_with_the_inertia_of_its_link_but_does_not_vanish() {
        assert_relative_eq!(armature_kg_m2(0.028, 0.3), 0.0084, max_relative = 1e-12);
        assert_relative_eq!(armature_kg_m2(0.028, 1e-6), 0.0028, max_relative = 1e-12);
    }
}
