//! The floor of a walk that was asked for.

use super::super::CliError;
use crate::log::FloorSpec;
use crate::robot::study::floor_on;
use crate::robot::{Floor, FloorParameters, Model, STEEPEST_RAD, State, Touching};
use clap::{Args, ValueEnum};

/// The lowest foot point hangs so high at first (4.2.2) [m].
const DROP_M: f64 = 0.02;

/// Options for the floor.
#[derive(Args, Debug)]
pub(super) struct GroundArgs {
    /// The floor rises by this angle towards the front [rad]
    #[arg(long, value_name = "RAD", default_value_t = 0.0, allow_negative_numbers = true)]
    slope: f64,
    /// The floor's parameters, for example static=0.9,coulomb=0.8: those of a study's [floor], which are stiffness [N/m^n],
    /// damping [N s/m^(n+1)], exponent, static, coulomb, viscous [s/m], steepness [s/m], stribeck_speed [m/s] and
    /// torsion_radius [m], and besides dwell [s] (a point that has crept for so long is held; inf: never), which a study has not
    #[arg(long, value_name = "KEY=VALUE", value_delimiter = ',')]
    floor: Vec<String>,
    /// Which parts touch the floor
    #[arg(long, value_enum, default_value_t = TouchArg::Legs)]
    touch: TouchArg,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum TouchArg {
    /// The lower legs, as in the thesis
    Legs,
    /// All parts: for robots that fall
    All,
}

impl GroundArgs {
    /// The floor's parameters that were asked for.
    pub fn parameters(&self, model: &Model) -> Result<FloorParameters, CliError> {
        // Beyond a right angle the same planes would come again.
        if !(self.slope.abs() <= STEEPEST_RAD) {
            let allowed = format!("at most {STEEPEST_RAD} rad up or down; 10 degrees are 0.175 rad");
            return Err(CliError::Usage(format!("--slope is {} rad, expected {allowed}", self.slope)));
        }
        let mut parameters = floor_on(model, &FloorSpec::default());
        for word in &self.floor {
            let wrong =
                || CliError::Usage(format!("--floor {word}: expected KEY=VALUE with one of the keys of --help"));
            let (key, value) = word.split_once('=').ok_or_else(wrong)?;
            let place = match key.trim() {
                "stiffness" => &mut parameters.stiffness_n_m,
                "damping" => &mut parameters.damping_n_s_m2,
                "exponent" => &mut parameters.exponent,
                "static" => &mut parameters.static_friction,
                "coulomb" => &mut parameters.coulomb,
                "viscous" => &mut parameters.viscous_s_m,
                "steepness" => &mut parameters.steepness_s_m,
                "stribeck_speed" => &mut parameters.stribeck_speed_m_s,
                "dwell" => &mut parameters.dwell_s,
                "torsion_radius" => &mut parameters.torsion_radius_m,
                _ => return Err(wrong()),
            };
            *place = value.trim().parse().map_err(|_| wrong())?;
        }
        Ok(if self.slope == 0.0 { parameters } else { parameters.sloped(self.slope, 0.0) })
    }

    /// The floor that was asked for.
    pub fn floor(&self, model: &Model) -> Result<Floor, CliError> {
        let touching = match self.touch {
            TouchArg::Legs => Touching::Marked,
            TouchArg::All => Touching::All,
        };
        Floor::new(self.parameters(model)?, model, touching).map_err(|error| CliError::Usage(error.to_string()))
    }
}

/// Puts the robot where the drop begins: trunk level, lowest foot point above the floor.
pub(super) fn lift(floor: &Floor, model: &Model, start: &mut State) {
    crate::robot::study::lift(floor, model, start, DROP_M);
}
