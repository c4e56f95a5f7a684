//! What a description has that no robot has: said, never mended.

use super::{Description, RigidInertia};
use crate::number::as_given;

/// Share by which a rounded moment may exceed the sum of the other two, or lie below 0.
const ROUNDING: f64 = 1e-6;
/// What stands for no moment of inertia in files that must not have 0 \[kg m^2\].
const NOTHING_KG_M2: f64 = 1e-12;
/// No link of a machine is heavier: a thousand tonnes \[kg\].
const HEAVIEST_KG: f64 = 1e6;
/// Nor has one more inertia: that mass 30 m from its centre \[kg m^2\].
const MOST_INERTIA_KG_M2: f64 = 1e9;

impl Description {
    /// Adds warnings of links that no rigid body is.
    pub(super) fn check(&mut self) {
        for link in &self.links {
            if let Some(what) = impossible(&link.inertia) {
                self.warnings.push(format!("{}: link \"{}\": {what}", self.files[0].display(), link.name));
            }
        }
    }

    /// A link that joints move and that is heavier than any of a machine, or has more inertia, in words. Motions of one are beyond
    /// computing; what stands on the world may weigh what it will.
    pub(crate) fn too_heavy_to_move(&self) -> Option<String> {
        let mut is_moved = vec![false; self.links.len()];
        for (k, link) in self.links.iter().enumerate() {
            is_moved[k] = !link.joints.is_empty() || link.parent.is_some_and(|parent| is_moved[parent.0]);
            if let Some(what) = too_heavy(&link.inertia).filter(|_| is_moved[k]) {
                return Some(format!("link \"{}\": {what}", link.name));
            }
        }
        None
    }
}

/// Why no link of a machine has this mass or inertia, and what was expected.
fn too_heavy(inertia: &RigidInertia) -> Option<String> {
    let (mass_kg, most_kg_m2) = (inertia.mass_kg, inertia.central_kg_m2().amax());
    if !(mass_kg <= HEAVIEST_KG) {
        let (mass, most) = (as_given(mass_kg), as_given(HEAVIEST_KG));
        return Some(format!("a mass of {mass} kg, expected at most {most} kg; are masses in kg?"));
    }
    (!(most_kg_m2 <= MOST_INERTIA_KG_M2)).then(|| {
        let (found, most) = (as_given(most_kg_m2), as_given(MOST_INERTIA_KG_M2));
        format!(
            "a moment of inertia of {found} kg m^2, expected at most {most} kg m^2; are lengths in m and masses in kg?"
        )
    })
}

/// Why no rigid body has this inertia.
fn impossible(inertia: &RigidInertia) -> Option<String> {
    let (mass_kg, size) = (inertia.mass_kg, inertia.central_kg_m2().amax());
    if mass_kg > HEAVIEST_KG {
        return too_heavy(inertia);
    }
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

    fn arm(lower: &str) -> Description {
        let dir = tempfile::tempdir().unwrap();
        let file = dir.path().join("arm.xml");
        let text = format!(
            r#"<mujoco><worldbody><body name="floor"><geom size=".1" mass="1e9"/><body name="upper"><joint axis="0 1 0"/>
            <geom size=".1" mass="1"/><body name="lower" pos="0 0 -.4">{lower}</body></body></body></worldbody></mujoco>"#
        );
        std::fs::write(&file, text).unwrap();
        Description::read(&file).unwrap()
    }

    #[test]
    fn what_moves_has_a_mass_and_an_inertia_of_machines() {
        // What stands on the world may weigh what it will, and is said.
        let sound = arm(r#"<geom size=".1" mass=".5"/>"#);
        assert_eq!(sound.too_heavy_to_move(), None);
        assert!(
            sound.warnings.iter().any(|said| said.contains("link \"floor\": a mass of 1e9 kg")),
            "{:?}",
            sound.warnings
        );
        let heavy = arm(r#"<geom size=".1" mass="1e30"/>"#).too_heavy_to_move().unwrap();
        assert!(heavy.contains("link \"lower\": a mass of 1e30 kg, expected at most 1e6 kg"), "{heavy}");
        let wide = r#"<inertial pos="0 0 0" mass="1" diaginertia="1e12 1e12 1e12"/>"#;
        let wide = arm(wide).too_heavy_to_move().unwrap();
        assert!(wide.contains("link \"lower\": a moment of inertia of 1e12 kg m^2"), "{wide}");
    }

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
