//! `<inertial>`: mass, centre and tensor of a body.

use super::compiler::Compiler;
use super::orientation::{ORIENTATIONS, pose};
use crate::robot::description::error::DescriptionError;
use crate::robot::description::inertia::RigidInertia;
use crate::robot::description::xml::Element;
use nalgebra::{Matrix3, Vector3};

/// The inertia, in the axes of what the element stands in.
pub(super) fn read(
    inertial: &Element,
    compiler: &Compiler,
    warnings: &mut Vec<String>,
) -> Result<RigidInertia, DescriptionError> {
    let mass_kg = inertial.not_negative("mass")?.ok_or_else(|| inertial.bad("mass", "a mass [kg]"))?;
    if inertial.text("pos").is_none() {
        return Err(inertial.bad("pos", "the centre of mass [m]"));
    }
    let tensor = match (inertial.exactly::<6>("fullinertia")?, inertial.exactly::<3>("diaginertia")?) {
        (Some([xx, yy, zz, xy, xz, yz]), _) => {
            if ORIENTATIONS.iter().any(|name| inertial.text(name).is_some()) {
                return Err(inertial.bad("fullinertia", "no orientation beside it: it is in the body's axes"));
            }
            Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
        }
        (None, Some(moments)) => Matrix3::from_diagonal(&Vector3::from(moments)),
        (None, None) => {
            warnings.push(inertial.say("neither diaginertia nor fullinertia: a point mass"));
            Matrix3::zeros()
        }
    };
    Ok(RigidInertia::about_centre(mass_kg, &tensor, &pose(inertial, compiler)?))
}
