//! What a body touches a floor with.

use crate::robot::description::{Collider, Shape};
use nalgebra::{Isometry3, Matrix3, Vector3};

/// An ellipsoid of a body, which touches a floor with its lowest point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// In the body's frame \[m\].
    pub centre_m: Vector3<f64>,
    /// Its semi-axes, one in each column, in the body's axes \[m\].
    pub semi_m: Matrix3<f64>,
    /// Whether it is of a foot; the rest touches only where a robot may fall.
    pub is_foot: bool,
}

impl Touch {
    /// The ellipsoid of a part, about the body's origin, by its semi-axes along x, y, z \[m\].
    pub(super) fn of_part(radii_m: &Vector3<f64>, is_foot: bool) -> Self {
        Self { centre_m: Vector3::zeros(), semi_m: Matrix3::from_diagonal(radii_m), is_foot }
    }

    /// What a shape touches with, the frame that its pose is in placed in the body's.
    pub(super) fn of_collider(collider: &Collider, place: &Isometry3<f64>) -> Vec<Self> {
        let pose = place * collider.pose;
        let axes = pose.rotation.to_rotation_matrix();
        let of = |(centre, semi_m): (Vector3<f64>, Vector3<f64>)| Self {
            centre_m: (pose * nalgebra::Point3::from(centre)).coords,
            semi_m: axes.matrix() * Matrix3::from_diagonal(&semi_m),
            is_foot: false,
        };
        collider.shape.touching().into_iter().map(of).collect()
    }

    /// A ball about a place \[m\].
    pub(super) fn ball(centre_m: Vector3<f64>, radius_m: f64) -> Self {
        Self { centre_m, semi_m: Matrix3::from_diagonal_element(radius_m), is_foot: true }
    }

    /// The lowest point in the body's frame \[m\], for a unit vector `up` in the body's axes: `c - S S^T up / |S^T up|`, where
    /// the outward normal points down.
    #[inline]
    pub fn lowest_m(&self, up: &Vector3<f64>) -> Vector3<f64> {
        let scaled = self.semi_m.tr_mul(up);
        self.centre_m + self.semi_m * scaled / -scaled.norm()
    }
}

/// Whether a shape is a ball, as feet are drawn.
pub(super) fn is_ball(collider: &Collider) -> bool {
    matches!(collider.shape, Shape::Sphere(_))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Translation3, UnitQuaternion};

    #[test]
    fn a_lying_cylinder_touches_along_its_side_and_a_standing_one_in_the_middle_of_its_disc() {
        let turned = |angle_rad: f64| {
            let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), angle_rad);
            let pose = Isometry3::from_parts(Translation3::new(0.0, 0.0, 1.0), turn);
            let collider = Collider { shape: Shape::Cylinder(0.1, 0.2), pose, friction: None };
            let touches = Touch::of_collider(&collider, &Isometry3::identity());
            touches.iter().map(|touch| touch.lowest_m(&Vector3::z())).collect::<Vec<_>>()
        };
        let lying = turned(std::f64::consts::FRAC_PI_2);
        assert!(lying.iter().all(|point| (point.z - 0.9).abs() < 1e-8 && (point.y.abs() - 0.2).abs() < 1e-8));
        let standing = turned(0.0);
        assert!((standing[0] - Vector3::new(0.0, 0.0, 0.8)).norm() < 1e-8);
    }
}
