//! What a description has that no robot has: said, never mended.

use super::{Description, RigidInertia};

/// Share by which a rounded moment may exceed the sum of the other two, or lie below 0.
const ROUNDING: f64 = 1e-6;
/// What stands for no moment of inertia in files that must not have 0 \[kg m^2\].
const NOTHING_KG_M2: f64 = 1e-12;

impl Description {
    /// Adds warnings of links that no rigid body is.
    pub(super) fn check(&mut self) {
        for link in &self.links {
            if let Some(what) = impossible(&link.inertia) {
                self.warnings.push(format!("{}: link \"{}\": {what}", self.files[0].display(), link.name));
            }
        }
    }
}

/// Why no rigid body has this inertia.
fn impossible(inertia: &RigidInertia) -> Option<String> {
    let (mass_kg, size) = (inertia.mass_kg, inertia.central_kg_m2().amax());
    if size == 0.0 {
        return (mass_kg > 0.0).then(|| format!("{mass_kg} kg without a moment of inertia; a point mass is meant?"));
    }
    if mass_kg == 0.0 {
        return (size > NOTHING_KG_M2).then(|| "a moment of inertia without a mass".to_owned());
    }
    let Some((mut moments, _)) = inertia.principal() else {
        return Some("a moment of inertia beyond computing".to_owned());
    };
    moments.as_mut_slice().sort_by(f64::total_cmp);
    let [a, b, c]: [f64; 3] = moments.into();
    let slack = ROUNDING * c.abs().max(a.abs());
    if a < -slack {
        return Some(format!("a principal moment of inertia is negative ({a:.3e} kg m^2)"));
    }
    (a + b < c - slack).then(|| {
        format!("principal moments of inertia {a:.3e}, {b:.3e}, {c:.3e} kg m^2: no body has one above the others' sum")
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Isometry3, Matrix3};

    #[test]
    fn tensors_that_no_body_has_are_named() {
        let of = |mass: f64, moments: [f64; 3]| {
            let tensor = Matrix3::from_diagonal(&moments.into());
            impossible(&RigidInertia::about_centre(mass, &tensor, &Isometry3::identity())).unwrap_or_default()
        };
        assert_eq!(of(1.0, [1.0, 1.0, 2.0]), "");
        assert!(of(1.0, [1.0, 1.0, 2.1]).contains("above the others' sum"));
        assert!(of(1.0, [1.0, -0.1, 1.0]).contains("negative"));
        assert!(of(0.0, [1.0, 1.0, 1.0]).contains("without a mass"));
        assert!(of(1.0, [0.0; 3]).contains("without a moment"));
        assert!(of(1.0, [f64::MAX, 1.0, 1.0]).contains("sum") || of(1.0, [f64::MAX, 1.0, 1.0]).contains("beyond"));
    }
}
