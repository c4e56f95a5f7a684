//! What a description has that no robot has: said, never mended.

use super::Description;
use nalgebra::Matrix3;

/// Share by which a rounded moment may exceed the sum of the other two, or lie below 0.
const ROUNDING: f64 = 1e-6;

impl Description {
    /// Adds warnings of links that no rigid body is.
    pub(super) fn check(&mut self) {
        for link in &self.links {
            let (mass, tensor) = (link.inertia.mass_kg, link.inertia.central_kg_m2());
            if let Some(what) = impossible(mass, &tensor) {
                self.warnings.push(format!("{}: link \"{}\": {what}", self.files[0].display(), link.name));
            }
        }
    }
}

/// Why no rigid body has this tensor about its centre of mass.
fn impossible(mass_kg: f64, tensor: &Matrix3<f64>) -> Option<String> {
    if *tensor == Matrix3::zeros() {
        return (mass_kg > 0.0).then(|| format!("{mass_kg} kg without a moment of inertia; a point mass is meant?"));
    }
    if mass_kg == 0.0 {
        return (tensor.amax() > 1e-12).then(|| "a moment of inertia without a mass".to_owned());
    }
    let mut moments = tensor.symmetric_eigenvalues();
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

    #[test]
    fn tensors_that_no_body_has_are_named() {
        let diagonal = |d: [f64; 3]| Matrix3::from_diagonal(&d.into());
        assert_eq!(impossible(1.0, &diagonal([1.0, 1.0, 2.0])), None);
        assert!(impossible(1.0, &diagonal([1.0, 1.0, 2.1])).unwrap().contains("above the others' sum"));
        assert!(impossible(1.0, &diagonal([1.0, -0.1, 1.0])).unwrap().contains("negative"));
        assert!(impossible(0.0, &diagonal([1.0, 1.0, 1.0])).unwrap().contains("without a mass"));
        assert!(impossible(1.0, &Matrix3::zeros()).unwrap().contains("without a moment"));
    }
}
