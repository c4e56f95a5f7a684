//! Moments of inertia: ellipsoids (3.1), hollow cylinders (3.8), parallel axes (3.9).
//!
//! Tensors are 3x3, symmetric, \[kg m^2\], about the body's centre of mass unless the name says otherwise. Masses and
//! lengths are taken as they come: every function is linear in the mass, so it may be 1 for "per kilogram".

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

/// Inertia tensor of a solid ellipsoid about its centre, from its **radii** (eq. 3.1).
///
/// `I_x = M (y^2 + z^2) / 5`, cyclic; mass in kg, radii in m along x, y, z, result in kg m^2.
/// Table A.2 prints diameters: use [`ellipsoid_inertia_from_diameters`] for those.
///
/// ```
/// use aibo_fit::geometry::inertia::ellipsoid_inertia;
/// let sphere = ellipsoid_inertia(5.0, &nalgebra::Vector3::new(1.0, 1.0, 1.0));
/// assert_eq!(sphere[(0, 0)], 2.0); // 2/5 M r^2
/// ```
pub fn ellipsoid_inertia(mass_kg: f64, radii_m: &Vector3<f64>) -> Matrix3<f64> {
    let s = radii_m.component_mul(radii_m);
    Matrix3::from_diagonal(&(Vector3::new(s.y + s.z, s.x + s.z, s.x + s.y) * (mass_kg / 5.0)))
}

/// Inertia tensor of a solid ellipsoid about its centre, from its **diameters**, as Table A.2 prints them (eq. 3.1).
pub fn ellipsoid_inertia_from_diameters(mass_kg: f64, diameters_m: &Vector3<f64>) -> Matrix3<f64> {
    ellipsoid_inertia(mass_kg, &(diameters_m * 0.5))
}

/// Inertia of a thin-walled hollow cylinder across its axis, through its centre: `M R^2 / 2 + M L^2 / 12` (eq. 3.8,
/// `I_E,x`).
pub fn hollow_cylinder_across(mass_kg: f64, radius_m: f64, length_m: f64) -> f64 {
    mass_kg * (radius_m * radius_m / 2.0 + length_m * length_m / 12.0)
}

/// Inertia tensor of a thin-walled hollow cylinder about its centre, with its axis along `axis`.
///
/// Across the axis [`hollow_cylinder_across`] (eq. 3.8), along it `M R^2` (not in the text: the leg never turns about
/// it in the thesis, but does at a pose with the knee bent out of the plane).
pub fn hollow_cylinder_inertia(mass_kg: f64, radius_m: f64, length_m: f64, axis: &Unit<Vector3<f64>>) -> Matrix3<f64> {
    let across = hollow_cylinder_across(mass_kg, radius_m, length_m);
    let along = mass_kg * radius_m * radius_m;
    let projector = axis.into_inner() * axis.transpose();
    Matrix3::identity() * across + projector * (along - across)
}

/// Moves a tensor from the centre of mass to a point at `offset_m` from it (eq. 3.9, all axes at once).
///
/// `I + M (|d|^2 1 - d d^T)`. For a single axis at distance `D` this is the thesis's `I + M D^2`, see
/// [`parallel_axis_scalar`].
pub fn parallel_axis(inertia_kg_m2: &Matrix3<f64>, mass_kg: f64, offset_m: &Vector3<f64>) -> Matrix3<f64> {
    inertia_kg_m2 + (Matrix3::identity() * offset_m.norm_squared() - offset_m * offset_m.transpose()) * mass_kg
}

/// Moves a moment of inertia from an axis through the centre of mass to a parallel one at `distance_m` (eq. 3.9):
/// `I + M D^2`.
pub fn parallel_axis_scalar(inertia_kg_m2: f64, mass_kg: f64, distance_m: f64) -> f64 {
    inertia_kg_m2 + mass_kg * distance_m * distance_m
}

/// The same tensor in other axes: `R I R^T`, with `R` from the tensor's axes to the wanted ones.
pub fn rotate_inertia(inertia_kg_m2: &Matrix3<f64>, rotation: &Rotation3<f64>) -> Matrix3<f64> {
    rotation * inertia_kg_m2 * rotation.transpose()
}

/// Moment of inertia about an axis through the tensor's point: `a^T I a`.
pub fn about_axis(inertia_kg_m2: &Matrix3<f64>, axis: &Unit<Vector3<f64>>) -> f64 {
    axis.dot(&(inertia_kg_m2 * axis.into_inner()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    #[test]
    fn ellipsoid_by_hand() {
        // M/5 (y^2 + z^2) with M = 5: sums of squares.
        let i = ellipsoid_inertia(5.0, &Vector3::new(1.0, 2.0, 3.0));
        assert_eq!(i, Matrix3::from_diagonal(&Vector3::new(13.0, 10.0, 5.0)));
        assert_eq!(ellipsoid_inertia_from_diameters(5.0, &Vector3::new(2.0, 4.0, 6.0)), i);
    }

    #[test]
    fn hollow_cylinder_by_hand() {
        // 0.402 kg, R 0.018, L 0.038: 0.402 (1.62e-4 + 1.20333e-4) = 1.13498e-4 across; 0.402 * 3.24e-4 = 1.30248e-4
        // along.
        let i = hollow_cylinder_inertia(0.402, 0.018, 0.038, &Vector3::y_axis());
        assert_relative_eq!(i[(0, 0)], 1.13498e-4, max_relative = 1e-6);
        assert_relative_eq!(i[(1, 1)], 1.30248e-4, max_relative = 1e-6);
        assert_relative_eq!(i[(2, 2)], i[(0, 0)]);
        assert_relative_eq!(i[(0, 1)], 0.0);
    }

    #[test]
    fn hollow_cylinder_tilted_is_the_rotated_one() {
        let r = Rotation3::from_euler_angles(0.3, -0.7, 1.1);
        let upright = hollow_cylinder_inertia(0.22, 0.015, 0.03, &Vector3::y_axis());
        let tilted = hollow_cylinder_inertia(0.22, 0.015, 0.03, &(r * Vector3::y_axis()));
        assert_relative_eq!(rotate_inertia(&upright, &r), tilted, epsilon = 1e-18);
    }

    #[test]
    fn lower_leg_about_the_knee_by_hand() {
        // (3.1): 0.036/5 (0.045^2 + 0.0225^2) = 1.8225e-5; (3.9): + 0.036 * 0.045^2 = 7.29e-5.
        let i = ellipsoid_inertia_from_diameters(0.036, &Vector3::new(0.042, 0.09, 0.045));
        let knee = parallel_axis(&i, 0.036, &Vector3::new(0.0, 0.045, 0.0));
        assert_relative_eq!(knee[(0, 0)], 9.1125e-5, max_relative = 1e-12);
        assert_relative_eq!(parallel_axis_scalar(i[(0, 0)], 0.036, 0.045), 9.1125e-5, max_relative = 1e-12);
    }

    fn vector(range: std::ops::Range<f64>) -> impl Strategy<Value = Vector3<f64>> {
        (range.clone(), range.clone(), range).prop_map(|(x, y, z)| Vector3::new(x, y, z))
    }

    proptest! {
        /// A real body's tensor is positive definite and its principal moments obey the triangle inequality, after any
        /// rotation and shift.
        #[test]
        fn tensors_are_physical(
            mass in 0.001..2.0, radii in vector(0.001..0.2), angles in vector(-3.0..3.0), offset in vector(-0.2..0.2),
            radius in 0.001..0.1, length in 0.001..0.3,
        ) {
            let r = Rotation3::from_euler_angles(angles.x, angles.y, angles.z);
            let cylinder = hollow_cylinder_inertia(mass, radius, length, &(r * Vector3::y_axis()));
            for centre in [rotate_inertia(&ellipsoid_inertia(mass, &radii), &r), cylinder] {
                let moments = parallel_axis(&centre, mass, &offset).symmetric_eigenvalues();
                let (sum, tiny) = (moments.sum(), 1e-12 * moments.max());
                for m in moments.iter() {
                    prop_assert!(*m > 0.0);
                    prop_assert!(2.0 * m <= sum + tiny, "moments {moments}");
                }
            }
        }

        /// (3.9) about one axis is the full theorem seen along that axis.
        #[test]
        fn parallel_axis_scalar_agrees(mass in 0.0..2.0, radii in vector(0.001..0.2), offset in vector(-0.2..0.2)) {
            let i = ellipsoid_inertia(mass, &radii);
            let distance = offset.y.hypot(offset.z);
            let full = about_axis(&parallel_axis(&i, mass, &offset), &Vector3::x_axis());
            prop_assert!((full - parallel_axis_scalar(i[(0, 0)], mass, distance)).abs() < 1e-15);
        }
    }
}
