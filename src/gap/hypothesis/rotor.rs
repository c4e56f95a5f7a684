//! What turns with a motor: no better known than the inertia of the link, so one number is searched for both.

use crate::joint::Real;

/// A rotor is not taken for lighter than this share of what is stated: a joint without inertia is too stiff to be simulated.
const LEAST: f64 = 0.1;

/// The armature \[kg m^2\], of which a study states so much, where the link has this share of its stated inertia.
pub(crate) fn armature_kg_m2<T: Real>(stated_kg_m2: f64, share: T) -> T {
    let share = if share.re() < LEAST { T::constant(LEAST) } else { share };
    share * stated_kg_m2
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
