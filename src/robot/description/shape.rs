//! Shapes of bodies: volumes and moments of inertia, solid and as shells, and the balls and points that they touch a floor
//! with.

use crate::number::math;
use nalgebra::Vector3;
use std::f64::consts::PI;

/// A shape about its centre; lengths are MuJoCo's half-lengths \[m\], the long axis is z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// Its radius.
    Sphere(f64),
    /// Radius, and half of the length without the caps.
    Capsule(f64, f64),
    /// Radius and half-length.
    Cylinder(f64, f64),
    /// Semi-axes.
    Ellipsoid(Vector3<f64>),
    /// Half-lengths.
    Box(Vector3<f64>),
}

/// MuJoCo's thickness of an ellipsoid's shell \[m\]: the moment is that of the difference of two solid ones.
const SHELL_M: f64 = 1e-6;
/// Semi-axis of what has none: an edge, a corner \[m\].
const POINT_M: f64 = 1e-9;
/// Exponent of Thomsen's formula for the surface of an ellipsoid, good to 1.1 %.
const THOMSEN: f64 = 1.6075;

impl Shape {
    /// Ellipsoids about whose lowest points it stands, by their centres \[m\] and semi-axes \[m\] along the shape's own axes:
    /// a capsule stands on the balls at its ends, a cylinder on two discs, a box on its corners.
    pub(crate) fn touching(&self) -> Vec<(Vector3<f64>, Vector3<f64>)> {
        let ends =
            |half: f64, semi_m: Vector3<f64>| [-half, half].map(|z| (Vector3::new(0.0, 0.0, z), semi_m)).to_vec();
        match *self {
            Self::Sphere(r) => vec![(Vector3::zeros(), Vector3::repeat(r))],
            Self::Capsule(r, h) => ends(h, Vector3::repeat(r)),
            Self::Cylinder(r, h) => ends(h, Vector3::new(r, r, POINT_M)),
            Self::Ellipsoid(s) => vec![(Vector3::zeros(), s)],
            Self::Box(s) => {
                let side = |corner: usize, k: usize| if corner >> k & 1 == 1 { s[k] } else { -s[k] };
                (0..8).map(|corner| (Vector3::from_fn(|k, _| side(corner, k)), Vector3::repeat(POINT_M))).collect()
            }
        }
    }

    /// Volume \[m^3\] and moments about x, y, z through the centre for 1 kg \[m^2\].
    pub(super) fn solid(&self) -> (f64, Vector3<f64>) {
        match *self {
            Self::Sphere(r) => (4.0 / 3.0 * PI * r.powi(3), Vector3::repeat(0.4 * r * r)),
            Self::Cylinder(r, h) => (2.0 * PI * r * r * h, round(r * r / 4.0 + h * h / 3.0, r * r / 2.0)),
            Self::Capsule(r, h) => {
                let (tube, ball) = (2.0 * PI * r * r * h, 4.0 / 3.0 * PI * r.powi(3));
                let (tube_share, ball_share) = (tube / (tube + ball), ball / (tube + ball));
                // Half a ball has its centre of mass 3/8 r from its flat side.
                let caps = 0.4 * r * r + (h + 0.375 * r).powi(2) - (0.375 * r).powi(2);
                let across = tube_share * (r * r / 4.0 + h * h / 3.0) + ball_share * caps;
                (tube + ball, round(across, tube_share * r * r / 2.0 + ball_share * 0.4 * r * r))
            }
            Self::Ellipsoid(s) => (4.0 / 3.0 * PI * s.product(), crosswise(s.component_mul(&s)) / 5.0),
            Self::Box(s) => (8.0 * s.product(), crosswise(s.component_mul(&s)) / 3.0),
        }
    }

    /// Surface \[m^2\] and moments for 1 kg \[m^2\] of what has its mass on the surface.
    pub(super) fn shell(&self) -> (f64, Vector3<f64>) {
        match *self {
            Self::Sphere(r) => (4.0 * PI * r * r, Vector3::repeat(2.0 / 3.0 * r * r)),
            Self::Cylinder(r, h) => {
                let (tube, discs) = (4.0 * PI * r * h, 2.0 * PI * r * r);
                let (tube_share, disc_share) = (tube / (tube + discs), discs / (tube + discs));
                let across = tube_share * (r * r / 2.0 + h * h / 3.0) + disc_share * (r * r / 4.0 + h * h);
                (tube + discs, round(across, tube_share * r * r + disc_share * r * r / 2.0))
            }
            Self::Capsule(r, h) => {
                let (tube, ball) = (4.0 * PI * r * h, 4.0 * PI * r * r);
                let (tube_share, ball_share) = (tube / (tube + ball), ball / (tube + ball));
                // Half a hollow ball has its centre of mass r/2 from its open side.
                let caps = 2.0 / 3.0 * r * r + (h + 0.5 * r).powi(2) - (0.5 * r).powi(2);
                let across = tube_share * (r * r / 2.0 + h * h / 3.0) + ball_share * caps;
                (tube + ball, round(across, tube_share * r * r + ball_share * 2.0 / 3.0 * r * r))
            }
            Self::Ellipsoid(s) => {
                let outer = s.add_scalar(SHELL_M);
                let moment = |s: Vector3<f64>| crosswise(s.component_mul(&s)) * (s.product() / 5.0);
                let p = s.map(|half| math::powf(half, THOMSEN));
                let mean = (p.x * p.y + p.x * p.z + p.y * p.z) / 3.0;
                let moments = (moment(outer) - moment(s)) / (outer.product() - s.product());
                (4.0 * PI * math::powf(mean, 1.0 / THOMSEN), moments)
            }
            Self::Box(s) => {
                let faces = Vector3::new(s.y * s.z, s.x * s.z, s.x * s.y);
                let area = faces.sum();
                // Each pair of faces lies at its half-length and spreads along the two others.
                let second = Vector3::from_fn(|i, _| {
                    let along = |k: usize| if k == i { 1.0 } else { 1.0 / 3.0 };
                    (0..3).map(|k| faces[k] / area * along(k)).sum::<f64>() * s[i] * s[i]
                });
                (8.0 * area, crosswise(second))
            }
        }
    }
}

/// Moments of a round body: across its axis, along it.
fn round(across: f64, along: f64) -> Vector3<f64> {
    Vector3::new(across, across, along)
}

/// From second moments along the axes to moments of inertia about them.
fn crosswise(second: Vector3<f64>) -> Vector3<f64> {
    Vector3::new(second.y + second.z, second.x + second.z, second.x + second.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_it_touches_with_is_as_long_as_the_shape() {
        let s = Vector3::new(0.1, 0.2, 0.3);
        let shapes = [
            (Shape::Sphere(0.1), 1, [0.1; 3]),
            (Shape::Capsule(0.1, 0.2), 2, [0.1, 0.1, 0.3]),
            (Shape::Cylinder(0.1, 0.2), 2, [0.1, 0.1, 0.2]),
            (Shape::Ellipsoid(s), 1, s.into()),
            (Shape::Box(s), 8, s.into()),
        ];
        for (shape, count, reach) in shapes {
            let touching = shape.touching();
            assert_eq!(touching.len(), count, "{shape:?}");
            for (k, expected) in reach.into_iter().enumerate() {
                let far = touching.iter().map(|(centre, semi)| centre[k] + semi[k]).fold(0.0, f64::max);
                assert!((far - expected).abs() < 1e-8, "{shape:?} {far}");
            }
        }
    }

    /// Masses at 1000 kg/m^3 or kg/m^2 and inertias of MuJoCo 4.0.0, for 2 kg where that is a shell.
    #[test]
    fn solids_and_shells_weigh_what_they_weigh_in_mujoco() {
        let s = Vector3::new(0.1, 0.2, 0.3);
        let solid: [(Shape, f64, [f64; 3]); 5] = [
            (Shape::Box(s), 48.0, [2.08, 1.6, 0.8]),
            (Shape::Sphere(0.1), 4.188790205, [0.01675516, 0.01675516, 0.01675516]),
            (Shape::Capsule(0.1, 0.2), 16.755160819, [0.44610616, 0.44610616, 0.07958701]),
            (Shape::Cylinder(0.1, 0.2), 12.566370614, [0.19896753, 0.19896753, 0.06283185]),
            (Shape::Ellipsoid(s), 25.132741229, [0.65345127, 0.50265482, 0.25132741]),
        ];
        for (shape, mass, moments) in solid {
            let (volume, per_kg) = shape.solid();
            assert!((1000.0 * volume - mass).abs() < 1e-8);
            assert!((per_kg * mass - Vector3::from(moments)).amax() < 1e-8, "{shape:?}");
        }
        let shell: [(Shape, f64, [f64; 3]); 5] = [
            (Shape::Box(s), 880.0, [0.1230303, 0.09575758, 0.05515152]),
            (Shape::Sphere(0.1), 125.663706144, [0.01333333, 0.01333333, 0.01333333]),
            (Shape::Capsule(0.1, 0.2), 376.991118431, [0.06888889, 0.06888889, 0.01777778]),
            (Shape::Cylinder(0.1, 0.2), 314.159265359, [0.04633333, 0.04633333, 0.018]),
            (Shape::Ellipsoid(s), 489.719333337, [0.07381851, 0.05745481, 0.03309112]),
        ];
        for (shape, mass, moments) in shell {
            let (area, per_kg) = shape.shell();
            assert!((1000.0 * area - mass).abs() < 1e-8, "{shape:?}");
            assert!((per_kg * 2.0 - Vector3::from(moments)).amax() < 1e-8, "{shape:?}");
        }
    }
}
