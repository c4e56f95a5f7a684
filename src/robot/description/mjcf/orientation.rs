//! The ways to say how a frame is turned: quat, axisangle, xyaxes, zaxis, euler.

use super::compiler::Compiler;
use crate::number::math;
use crate::robot::description::error::DescriptionError;
use crate::robot::description::xml::Element;
use nalgebra::{Isometry3, Matrix3, Quaternion, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};

/// The attributes that turn something; at most one may stand on an element.
pub(super) const ORIENTATIONS: &[&str] = &["quat", "axisangle", "xyaxes", "zaxis", "euler"];
/// A vector shorter than this has no direction; a direction is along z, up or down, where it is no further off.
const NOTHING: f64 = 1e-14;
const ALONG_Z: f64 = 1e-7;

/// `eulerseq`: axes in turn, about the turned frame (small letters) or the fixed one (capitals).
#[derive(Clone, Copy, Debug)]
pub(super) struct Sequence([(Unit<Vector3<f64>>, bool); 3]);

impl Default for Sequence {
    fn default() -> Self {
        Self([(Vector3::x_axis(), true), (Vector3::y_axis(), true), (Vector3::z_axis(), true)])
    }
}

impl Sequence {
    /// Of its letters.
    pub fn of(letters: &str) -> Option<Self> {
        let axis = |letter: char| match letter.to_ascii_lowercase() {
            'x' => Some(Vector3::x_axis()),
            'y' => Some(Vector3::y_axis()),
            'z' => Some(Vector3::z_axis()),
            _ => None,
        };
        let all: Option<Vec<_>> = letters.chars().map(|c| Some((axis(c)?, c.is_ascii_lowercase()))).collect();
        <[_; 3]>::try_from(all?).ok().map(Self)
    }

    /// The rotation of three angles \[rad\].
    pub fn rotation(&self, angles_rad: [f64; 3]) -> UnitQuaternion<f64> {
        let mut turned = UnitQuaternion::identity();
        for ((axis, is_intrinsic), angle) in self.0.iter().zip(angles_rad) {
            let turn = UnitQuaternion::from_axis_angle(axis, angle);
            turned = if *is_intrinsic { turned * turn } else { turn * turned };
        }
        turned
    }
}

/// The pose that `pos` and an orientation give.
pub(super) fn pose(of: &Element, compiler: &Compiler) -> Result<Isometry3<f64>, DescriptionError> {
    let place = of.exactly::<3>("pos")?.unwrap_or_default();
    Ok(Isometry3::from_parts(Translation3::from(place), rotation(of, compiler)?))
}

/// How an element is turned.
pub(super) fn rotation(of: &Element, compiler: &Compiler) -> Result<UnitQuaternion<f64>, DescriptionError> {
    let given: Vec<&str> = ORIENTATIONS.iter().copied().filter(|name| of.text(name).is_some()).collect();
    let [one] = given[..] else {
        return match given.first() {
            None => Ok(UnitQuaternion::identity()),
            Some(first) => Err(of.bad(first, format!("one orientation, found {}", given.join(", ")))),
        };
    };
    let long = |name: &str, vector: Vector3<f64>| {
        Unit::try_new(vector, NOTHING).ok_or_else(|| of.bad(name, "a vector that is not zero"))
    };
    match one {
        "quat" => {
            let [w, x, y, z] = of.exactly::<4>(one)?.unwrap_or([1.0, 0.0, 0.0, 0.0]);
            // By its largest number first: the square of a large one is beyond all numbers.
            let largest = [w, x, y, z].into_iter().fold(1.0, |most: f64, one| most.max(one.abs()));
            UnitQuaternion::try_new(Quaternion::new(w, x, y, z) / largest, NOTHING)
                .ok_or_else(|| of.bad(one, "a quaternion that is not zero"))
        }
        "axisangle" => {
            let [x, y, z, angle] = of.exactly::<4>(one)?.unwrap_or_default();
            Ok(UnitQuaternion::from_axis_angle(&long(one, Vector3::new(x, y, z))?, compiler.angle(angle)))
        }
        "xyaxes" => {
            let six = of.exactly::<6>(one)?.unwrap_or_default();
            let x = long(one, Vector3::from_column_slice(&six[..3]))?.into_inner();
            let y = Vector3::from_column_slice(&six[3..]);
            let y = long(one, y - x * x.dot(&y))?.into_inner();
            let axes = Matrix3::from_columns(&[x, y, x.cross(&y)]);
            Ok(UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes)))
        }
        "zaxis" => Ok(from_z(&long(one, Vector3::from(of.exactly::<3>(one)?.unwrap_or_default()))?)),
        _ => {
            let angles = of.exactly::<3>(one)?.unwrap_or_default();
            Ok(compiler.sequence.rotation(angles.map(|angle| compiler.angle(angle))))
        }
    }
}

/// The smallest turn of z to a direction; about x where that is -z, nearly.
pub(super) fn from_z(to: &Unit<Vector3<f64>>) -> UnitQuaternion<f64> {
    let across = Vector3::z().cross(to);
    match Unit::try_new(across, ALONG_Z) {
        Some(axis) => UnitQuaternion::from_axis_angle(&axis, math::atan2(across.norm(), to.z)),
        None => UnitQuaternion::from_axis_angle(&Vector3::x_axis(), math::atan2(0.0, to.z)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mixed_sequences_are_mujocos() {
        // MuJoCo 4.0.0: body_quat of <compiler eulerseq="xYz"/>, euler="10 20 30".
        let turned = Sequence::of("xYz").unwrap().rotation([10.0, 20.0, 30.0].map(f64::to_radians));
        let expected = [0.95154852, 0.12767944, 0.14487813, 0.23929834];
        for (found, expected) in [turned.w, turned.i, turned.j, turned.k].iter().zip(expected) {
            assert!((found - expected).abs() < 1e-8);
        }
        assert!(Sequence::of("xy").is_none() && Sequence::of("xyw").is_none());
    }

    #[test]
    fn z_turns_to_any_direction() {
        for to in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 2.0, -0.5], [0.0, 3.0, 0.0]] {
            let to = Unit::new_normalize(Vector3::from(to));
            assert!((from_z(&to) * Vector3::z() - to.into_inner()).norm() < 1e-14);
        }
        // MuJoCo 4.0.0 turns about x, where the smallest turn is about y.
        let nearly = Unit::new_normalize(Vector3::new(-8.742e-8, 0.0, -1.0));
        assert!((from_z(&nearly) * Vector3::y() + Vector3::y()).norm() < 1e-14);
    }
}
