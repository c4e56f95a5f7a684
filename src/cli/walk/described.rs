//! A robot of any format, with what looks like a mistake said.

use super::super::CliError;
use super::super::common::warn;
use super::super::servo::servo;
use crate::log::{DescribedBeliefs, JointBeliefs};
use crate::robot::Model;
use crate::robot::description::Format;
use crate::robot::study::{Wanted, check_servos, read_described};
use clap::Args;
use std::path::Path;

/// What is said of a robot that somebody else described.
#[derive(Args, Debug)]
pub(super) struct DescribedArgs {
    /// Gain of all servos and its damping, in the place of a URDF's or MJCF's own [N m/rad, N m s/rad]
    #[arg(long, value_name = "KP[,KD]", requires = "robot")]
    servo: Option<String>,
    /// Links of a URDF or MJCF that are feet, with their radius [m], for example FL_foot=0.022,FR_foot=0.022 [default: the
    /// balls that collide at the ends of its legs]
    #[arg(long, value_name = "LINK=RADIUS", value_delimiter = ',', requires = "robot", conflicts_with = "air")]
    feet: Vec<String>,
}

impl DescribedArgs {
    fn is_empty(&self) -> bool {
        self.servo.is_none() && self.feet.is_empty()
    }

    fn spec(&self) -> Result<DescribedBeliefs, CliError> {
        let mut spec = DescribedBeliefs::default();
        if let Some(text) = &self.servo {
            let (kp_nm_rad, kd_nm_s_rad) = servo(text)?;
            spec.all = JointBeliefs { kp_nm_rad: Some(kp_nm_rad), kd_nm_s_rad, ..JointBeliefs::default() };
        }
        for word in &self.feet {
            let foot = word.split_once('=').and_then(|(link, radius)| Some((link, radius.trim().parse::<f64>().ok()?)));
            let (link, radius_m) =
                foot.filter(|(_, radius_m)| *radius_m > 0.0 && *radius_m <= 1.0).ok_or_else(|| {
                    CliError::Usage(format!("--feet {word}: expected LINK=RADIUS, a radius above 0, at most 1 m"))
                })?;
            if spec.feet_m.insert(link.trim().to_owned(), radius_m).is_some() {
                return Err(CliError::Usage(format!("--feet names {} twice; expected every foot once", link.trim())));
            }
        }
        Ok(spec)
    }
}

/// Reads a robot's file, to be moved in the air or on the floor.
pub(super) fn read(file: &Path, said: &DescribedArgs, is_in_air: bool) -> Result<Model, CliError> {
    if Format::of_file(file)? == Format::Toml {
        if !said.is_empty() {
            let what = "--servo and --feet are for a URDF or MJCF; a robot file of our own has [gains] and contact_mm";
            return Err(CliError::Usage(what.to_owned()));
        }
        return Ok(Model::read(file)?);
    }
    let wanted = if is_in_air { Wanted::InAir } else { Wanted::Standing };
    let (model, warnings) = read_described(file, &said.spec()?, wanted)?;
    check_servos(&model)?;
    warnings.iter().for_each(|warning| warn(warning));
    Ok(model)
}
