//! A robot of any format, with what looks like a mistake said.

use super::super::CliError;
use super::super::common::warn;
use crate::geometry::robot_file::GAIN_SET;
use crate::robot::description::{Description, Format};
use crate::robot::{Model, RobotError};
use std::path::Path;

/// Reads a robot's file, to be moved in the air or on the floor.
pub(super) fn read(file: &Path, is_in_air: bool) -> Result<Model, CliError> {
    if Format::of_file(file)? == Format::Toml {
        return Ok(Model::read(file)?);
    }
    let description = Description::read(file)?;
    description.warnings.iter().for_each(|warning| warn(warning));
    let model = Model::of_description(&description)?;
    if !is_in_air {
        let (file, what) = (file.display(), "which parts touch the floor stands in no URDF or MJCF that is read here");
        return Err(CliError::Usage(format!("{file}: {what}; add --air")));
    }
    if model.joint_ids().all(|joint| model.gains(GAIN_SET, joint).is_none()) {
        let what = "no joint has a position servo (a URDF has none; an MJCF has <position>)".to_owned();
        return Err(RobotError::NotSimulated { robot: model.name().to_owned(), what }.into());
    }
    Ok(model)
}
