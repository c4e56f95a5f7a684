//! The floor of a walk: what was asked for, and how far the trunk went on it.

use super::super::CliError;
use crate::log::FloorSpec;
use crate::report::{Footfalls, Ground, TrunkCurves};
use crate::robot::simulate::{BaseSample, Recording};
use crate::robot::study::floor_on;
use crate::robot::{BodyId, Dynamics, Floor, FloorParameters, Model, State, Touching};
use clap::{Args, ValueEnum};

/// The lowest foot point hangs so high at first (4.2.2) [m].
const DROP_M: f64 = 0.02;
/// The bobbing is measured after the first second of walking [s].
const BOB_AFTER_S: f64 = 1.0;

/// A foot that is up for less has only bounced [s].
const UP_S: f64 = 0.04;

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

/// Which feet are on the floor, sample by sample.
pub(super) fn footfalls(floor: &Floor, model: &Model, recording: &Recording) -> Footfalls {
    let (mut dynamics, mut state) = (Dynamics::new(model), State::at_rest(model));
    let name = |body: BodyId| model.bodies()[body.index()].name.clone();
    let is_foot = |body: &BodyId| model.bodies()[body.index()].touches_floor;
    let mut feet: Vec<(String, Vec<bool>)> =
        floor.bodies().filter(is_foot).map(|body| (name(body), Vec::new())).collect();
    for k in 0..recording.t_s.len() {
        recording.state_at(k, &mut state);
        let points = floor.lowest_points(dynamics.motions(&state)).filter(|(body, _)| is_foot(body));
        for ((_, down), (_, point)) in feet.iter_mut().zip(points) {
            down.push(floor.depth_m(&point) > 0.0);
        }
    }
    Footfalls { t_s: recording.t_s.clone(), feet }
}

/// How often a foot came down after it had been up for a while, from a time on.
pub(super) fn landings(t_s: &[f64], down: &[bool], from_s: f64) -> usize {
    let (mut up_since_s, mut count) = (None, 0);
    for (t, is_down) in t_s.iter().zip(down).filter(|(t, _)| **t >= from_s) {
        if !is_down {
            up_since_s = up_since_s.or(Some(*t));
        } else if up_since_s.take().is_some_and(|since_s| t - since_s > UP_S) {
            count += 1;
        }
    }
    count
}

/// Angle between the trunk's vertical axis and the floor's normal at a sample [rad].
pub(super) fn tilt_rad(floor: &Floor, base: &BaseSample) -> f64 {
    (base.orientation * nalgebra::Vector3::y()).angle(&floor.normal())
}

/// How far the trunk went from a time to the end.
pub(super) fn measure(floor: &Floor, model: &Model, recording: &Recording, from_s: f64) -> Option<Ground> {
    let after = |t_s: f64| recording.t_s.partition_point(|t| *t < t_s - 1e-6);
    let first = after(from_s);
    let (from, to) = (recording.base.get(first)?, recording.base.last()?);
    let span_s = recording.t_s.last()? - recording.t_s[first];
    if !(span_s > 0.0) {
        return None;
    }
    let bob_from = after(from_s + BOB_AFTER_S.min(0.5 * span_s));
    let heights = recording.base[bob_from..].iter().map(|base| -floor.depth_m(&base.position_m));
    let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), y| (low.min(y), high.max(y)));
    let went = to.position_m - from.position_m;
    let turned = to.roll_pitch_yaw_rad()[2] - from.roll_pitch_yaw_rad()[2];
    Some(Ground {
        from_s: recording.t_s[first],
        displacement_m: -went.z,
        drift_m: went.x,
        turn_rad: turned,
        speed_m_s: -went.z / span_s,
        bob_m: high - low,
        height_m: -floor.depth_m(&from.position_m),
        steps: footfalls(floor, model, recording)
            .feet
            .first()
            .map_or(0, |(_, down)| landings(&recording.t_s, down, from_s)),
        tilt_rad: recording.base[first..].iter().map(|base| tilt_rad(floor, base)).fold(0.0, f64::max),
    })
}

/// The trunk over time, from where it began.
pub(super) fn trunk(floor: &Floor, recording: &Recording) -> Option<TrunkCurves> {
    let begin = recording.base.first()?.position_m;
    let of = |f: fn(&nalgebra::Vector3<f64>) -> f64| -> Vec<f64> {
        recording.base.iter().map(|base| f(&(base.position_m - begin))).collect()
    };
    Some(TrunkCurves {
        t_s: recording.t_s.clone(),
        forward_m: of(|p| -p.z),
        right_m: of(|p| p.x),
        height_m: recording.base.iter().map(|base| -floor.depth_m(&base.position_m)).collect(),
    })
}
