//! A robot of any format, with what looks like a mistake said.

use super::super::CliError;
use super::super::common::warn;
use crate::robot::Model;
use crate::robot::description::{Description, Format};
use std::path::Path;

/// Reads a robot's file.
pub(super) fn read(file: &Path) -> Result<Model, CliError> {
    if Format::of_file(file)? == Format::Toml {
        return Ok(Model::read(file)?);
    }
    let description = Description::read(file)?;
    description.warnings.iter().for_each(|warning| warn(warning));
    Ok(Model::of_description(&description)?)
}
