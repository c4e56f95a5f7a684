//! Mass, centre and tensor of a body of any shape.

use nalgebra::{Isometry3, Matrix3, SymmetricEigen, Vector3};
use std::ops::AddAssign;

/// A body's inertia about the origin of a frame, in the frame's axes.
///
/// The first moment stands in the place of the centre of mass, so that a body of mass 0 with a tensor (they are in use) and
/// the sum of several bodies need no exceptions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RigidInertia {
    /// \[kg\]
    pub mass_kg: f64,
    /// Mass times centre of mass \[kg m\].
    pub first_moment_kg_m: Vector3<f64>,
    /// About the frame's origin \[kg m^2\].
    pub tensor_kg_m2: Matrix3<f64>,
}

impl RigidInertia {
    /// A body of a mass, with its tensor about its centre of mass in the axes of a pose whose origin is the centre.
    pub fn about_centre(mass_kg: f64, tensor_kg_m2: &Matrix3<f64>, centre: &Isometry3<f64>) -> Self {
        Self { mass_kg, first_moment_kg_m: Vector3::zeros(), tensor_kg_m2: *tensor_kg_m2 }.placed(centre)
    }

    /// The same body about the origin and in the axes of the frame in which its own frame has a pose.
    #[must_use]
    pub fn placed(&self, pose: &Isometry3<f64>) -> Self {
        self.moved(pose.rotation.to_rotation_matrix().matrix(), &pose.translation.vector)
    }

    /// As [`placed`](Self::placed), by the rotation from its own axes and its own origin in the other frame.
    #[must_use]
    pub fn moved(&self, rotation: &Matrix3<f64>, origin_m: &Vector3<f64>) -> Self {
        let (h, p) = (rotation * self.first_moment_kg_m, origin_m);
        // Parallel axes from any point to any other: m (|p|^2 1 - p p^T) + 2 p.h 1 - p h^T - h p^T.
        let along = self.mass_kg * p.norm_squared() + 2.0 * p.dot(&h);
        let across = p * p.transpose() * self.mass_kg + p * h.transpose() + h * p.transpose();
        Self {
            mass_kg: self.mass_kg,
            first_moment_kg_m: h + p * self.mass_kg,
            tensor_kg_m2: rotation * self.tensor_kg_m2 * rotation.transpose() + Matrix3::identity() * along - across,
        }
    }

    /// The centre of mass \[m\]; the origin where there is no mass.
    pub fn centre_m(&self) -> Vector3<f64> {
        if self.mass_kg == 0.0 { Vector3::zeros() } else { self.first_moment_kg_m / self.mass_kg }
    }

    /// The tensor about the centre of mass \[kg m^2\].
    pub fn central_kg_m2(&self) -> Matrix3<f64> {
        let c = self.centre_m();
        self.tensor_kg_m2 - (Matrix3::identity() * c.norm_squared() - c * c.transpose()) * self.mass_kg
    }

    /// Principal moments about the centre of mass \[kg m^2\] and their axes as columns; `None` where the numbers are
    /// beyond computing.
    pub fn principal(&self) -> Option<(Vector3<f64>, Matrix3<f64>)> {
        const MOST_STEPS: usize = 1000;
        let eigen = SymmetricEigen::try_new(self.central_kg_m2(), f64::EPSILON, MOST_STEPS)?;
        Some((eigen.eigenvalues, eigen.eigenvectors))
    }

    /// The same body, so many times as heavy.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            mass_kg: self.mass_kg * factor,
            first_moment_kg_m: self.first_moment_kg_m * factor,
            tensor_kg_m2: self.tensor_kg_m2 * factor,
        }
    }
}

impl AddAssign for RigidInertia {
    fn add_assign(&mut self, other: Self) {
        self.mass_kg += other.mass_kg;
        self.first_moment_kg_m += other.first_moment_kg_m;
        self.tensor_kg_m2 += other.tensor_kg_m2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use nalgebra::{Translation3, UnitQuaternion};

    #[test]
    fn two_moves_are_one_and_the_centre_keeps_its_tensor() {
        let tensor = Matrix3::new(3.0, 0.2, -0.1, 0.2, 4.0, 0.3, -0.1, 0.3, 5.0);
        let pose = |p: [f64; 3], r: f64| {
            Isometry3::from_parts(Translation3::from(p), UnitQuaternion::from_euler_angles(r, -0.4, 2.0 * r))
        };
        let (a, b) = (pose([0.3, -0.2, 0.5], 0.7), pose([-1.0, 0.1, 0.4], -0.3));
        let body = RigidInertia::about_centre(2.0, &tensor, &a);
        let (twice, once) = (body.placed(&b), RigidInertia::about_centre(2.0, &tensor, &(b * a)));
        assert_relative_eq!(twice.tensor_kg_m2, once.tensor_kg_m2, epsilon = 1e-12);
        assert_relative_eq!(twice.centre_m(), (b * a).translation.vector, epsilon = 1e-14);
        let turned = (b * a).rotation.to_rotation_matrix();
        assert_relative_eq!(
            twice.central_kg_m2(),
            turned.matrix() * tensor * turned.matrix().transpose(),
            epsilon = 1e-12
        );
    }
}
