//! An ellipsoid seen from far away.

use super::recording::{Place, Shape};
use crate::number::math;
use nalgebra::{Matrix2, Matrix2x3, Vector2, Vector3};

/// A view without perspective: two rows that lead from the world to the picture (right, up), and the way towards the
/// eye.
pub(in crate::report) struct View {
    pub picture: Matrix2x3<f64>,
    pub towards_eye: Vector3<f64>,
}

impl View {
    /// From the robot's right side, a little from above: forward (-z) is to the right.
    pub fn side(above_rad: f64) -> Self {
        let (sin, cos) = math::sin_cos(above_rad);
        let (right, up) = (Vector3::new(0.0, 0.0, -1.0), Vector3::new(-sin, cos, 0.0));
        Self {
            picture: Matrix2x3::from_rows(&[right.transpose(), up.transpose()]),
            towards_eye: Vector3::new(cos, sin, 0.0),
        }
    }

    /// From above: forward (-z) is up.
    pub fn top() -> Self {
        let (right, up) = (Vector3::x(), -Vector3::z());
        Self { picture: Matrix2x3::from_rows(&[right.transpose(), up.transpose()]), towards_eye: Vector3::y() }
    }
}

/// An ellipse of the picture: the points c with `(c - centre)^T form^-1 (c - centre) <= 1`.
pub(in crate::report) struct Outline {
    pub centre: Vector2<f64>,
    pub form: Matrix2<f64>,
    /// Distance towards the eye \[m\].
    pub near_m: f64,
}

/// The outline of a part: its form is the picture of `R A^2 R^T` with the semi-axes A.
pub(in crate::report) fn outline(view: &View, shape: &Shape, place: &Place) -> Outline {
    let turned = view.picture * place.orientation.to_rotation_matrix().matrix();
    let squared = shape.radii_m.component_mul(&shape.radii_m);
    let form = turned * nalgebra::Matrix3::from_diagonal(&squared) * turned.transpose();
    Outline { centre: view.picture * place.position_m, form, near_m: view.towards_eye.dot(&place.position_m) }
}

/// The ball of a foot: a sphere inside the lower end of its part.
pub(super) fn foot(shape: &Shape, place: &Place) -> (Shape, Place) {
    let radius_m = shape.foot_m;
    let down = Vector3::new(0.0, radius_m - shape.radii_m.y, 0.0);
    let ball = Shape { name: String::new(), radii_m: Vector3::repeat(radius_m), foot_m: 0.0 };
    (ball, Place { position_m: place.position_m + place.orientation * down, ..*place })
}
