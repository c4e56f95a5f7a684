//! When does an unstable gait fall, and how does that move with each parameter of robot, floor and gait?
//!
//! The thesis recommends such motions as the sharper test of a model (section 5.2), and has none. Each [`Change`] makes
//! another walk of one; what [`fall_s`] says of its recordings becomes [`Falls`].

use crate::geometry::robot_file::FRAME_S;
use crate::joint::EffectId;
use crate::robot::simulate::{Joints, Recording, Setpoints, SimulateError, tilt_rad};
use crate::robot::{Floor, FloorParameters, Gait, JointId, Model, RobotError, Setpoints as Source};
use serde::Serialize;

/// A trunk that leans by so much has fallen \[rad\]: 45 degrees.
const FALLEN_RAD: f64 = std::f64::consts::FRAC_PI_4;
/// How far each parameter is moved.
const SHARE: f64 = 0.1;

/// What is moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Knob {
    /// The mass of the trunk.
    TrunkMass,
    /// The masses of head and neck.
    HeadMass,
    /// The masses of all leg parts.
    LegMasses,
    /// The masses of the lower legs.
    LowerLegMasses,
    /// Coulomb friction of the joints.
    JointCoulomb,
    /// Viscous friction of the joints.
    JointViscous,
    /// All gains of the controllers.
    ControllerGains,
    /// Stiffness of the floor.
    FloorStiffness,
    /// Damping of the floor.
    FloorDamping,
    /// Static and Coulomb friction of the floor.
    FloorFriction,
    /// Steepness of the floor's friction.
    FloorSteepness,
    /// How far the gait moves the joints.
    Amplitude,
    /// Cycles of the gait per second.
    Frequency,
    /// How late the setpoints come: nothing, or a frame.
    Delay,
}

impl Knob {
    /// All of them.
    pub const ALL: [Self; 14] = [
        Self::TrunkMass,
        Self::HeadMass,
        Self::LegMasses,
        Self::LowerLegMasses,
        Self::JointCoulomb,
        Self::JointViscous,
        Self::ControllerGains,
        Self::FloorStiffness,
        Self::FloorDamping,
        Self::FloorFriction,
        Self::FloorSteepness,
        Self::Amplitude,
        Self::Frequency,
        Self::Delay,
    ];

    /// A property of the gait and not of robot or floor.
    fn is_of_gait(self) -> bool {
        matches!(self, Self::Amplitude | Self::Frequency | Self::Delay)
    }

    /// Its name in a sentence.
    pub fn words(self) -> &'static str {
        match self {
            Self::TrunkMass => "mass of the trunk",
            Self::HeadMass => "masses of head and neck",
            Self::LegMasses => "masses of all leg parts",
            Self::LowerLegMasses => "masses of the lower legs",
            Self::JointCoulomb => "Coulomb friction of the joints",
            Self::JointViscous => "viscous friction of the joints",
            Self::ControllerGains => "gains of the controllers (P, I, D)",
            Self::FloorStiffness => "stiffness of the floor",
            Self::FloorDamping => "damping of the floor",
            Self::FloorFriction => "friction of the floor (mu_st, mu_c)",
            Self::FloorSteepness => "steepness of the friction (s)",
            Self::Amplitude => "amplitude of the gait",
            Self::Frequency => "frequency of the gait",
            Self::Delay => "delay of the setpoints (0 and 8 ms)",
        }
    }
}

/// One parameter moved, and nothing else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// Which; `None`: none.
    pub knob: Option<Knob>,
    /// By which factor; a delay is there where it is above 1.
    pub factor: f64,
}

impl Change {
    /// None, then less and more of each parameter.
    pub fn all() -> Vec<Self> {
        let both = |knob| [1.0 - SHARE, 1.0 + SHARE].map(|factor| Self { knob: Some(knob), factor });
        std::iter::once(Self { knob: None, factor: 1.0 }).chain(Knob::ALL.into_iter().flat_map(both)).collect()
    }

    /// The robot with it.
    ///
    /// # Errors
    /// As [`Model::with_mass`].
    pub fn model(&self, model: &Model) -> Result<Model, RobotError> {
        let heavier = |name: &str| match self.knob {
            Some(Knob::TrunkMass) => name == "trunk",
            Some(Knob::HeadMass) => ["neck", "head", "mouth"].contains(&name),
            Some(Knob::LegMasses) => ["_shoulder", "_upper", "_lower"].iter().any(|part| name.ends_with(part)),
            Some(Knob::LowerLegMasses) => name.ends_with("_lower"),
            _ => false,
        };
        let mut moved = model.clone();
        for body in model.body_ids() {
            let part = &model.bodies()[body.index()];
            if heavier(&part.name) {
                moved = moved.with_mass(body, self.factor * part.mass_kg)?;
            }
        }
        Ok(moved)
    }

    /// Moves the joints of that robot.
    ///
    /// # Errors
    /// As [`Joints::add_effect`].
    pub fn move_joints(&self, model: &Model, joints: &mut Joints) -> Result<(), SimulateError> {
        for id in model.joint_ids() {
            let friction = &mut joints.drive_mut(id).chain.friction;
            match self.knob {
                Some(Knob::JointCoulomb) => friction.coulomb_nm *= self.factor,
                Some(Knob::JointViscous) => friction.viscous_nm_s_rad *= self.factor,
                Some(Knob::ControllerGains) => joints.add_effect(model, id, EffectId::MotorGain, &[self.factor])?,
                // A delay has no nominal value to take a share of.
                Some(Knob::Delay) if self.factor > 1.0 => joints.add_effect(model, id, EffectId::Delay, &[FRAME_S])?,
                _ => {}
            }
        }
        Ok(())
    }

    /// The floor with it.
    pub fn floor(&self, mut floor: FloorParameters) -> FloorParameters {
        match self.knob {
            Some(Knob::FloorStiffness) => floor.stiffness_n_m *= self.factor,
            Some(Knob::FloorDamping) => floor.damping_n_s_m2 *= self.factor,
            Some(Knob::FloorSteepness) => floor.steepness_s_m *= self.factor,
            Some(Knob::FloorFriction) => {
                floor.static_friction *= self.factor;
                floor.coulomb *= self.factor;
            }
            _ => {}
        }
        floor
    }

    /// The gait with it, as a table.
    ///
    /// # Errors
    /// As [`Setpoints::sampled`].
    pub fn setpoints(&self, gait: &Gait, model: &Model, end_s: f64, period_s: f64) -> Result<Setpoints, SimulateError> {
        let faster = match self.knob {
            Some(Knob::Frequency) => gait.at_frequency(self.factor / gait.period_s()),
            _ => gait.clone(),
        };
        let factor = if self.knob == Some(Knob::Amplitude) { self.factor } else { 1.0 };
        Setpoints::sampled(&Scaled { gait: &faster, factor }, model, end_s, period_s)
    }
}

/// A gait with its amplitude scaled.
struct Scaled<'a> {
    gait: &'a Gait,
    factor: f64,
}

impl Source for Scaled<'_> {
    fn joints(&self) -> usize {
        self.gait.joints()
    }

    fn angle_rad(&self, joint: JointId, t_s: f64) -> f64 {
        let stand_rad = self.gait.angle_rad(joint, 0.0);
        stand_rad + self.factor * (self.gait.angle_rad(joint, t_s) - stand_rad)
    }
}

/// When the trunk has leant over, between two samples \[s\]; `None`: it does not fall.
pub fn fall_s(floor: &Floor, recording: &Recording) -> Option<f64> {
    let tilts: Vec<f64> = recording.base.iter().map(|base| tilt_rad(floor, base)).collect();
    let k = tilts.iter().position(|tilt| *tilt > FALLEN_RAD).filter(|k| *k > 0)?;
    let share = (FALLEN_RAD - tilts[k - 1]) / (tilts[k] - tilts[k - 1]);
    Some(recording.t_s[k - 1] + share * (recording.t_s[k] - recording.t_s[k - 1]))
}

/// What a parameter does to the fall.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Moved {
    /// Which.
    pub parameter: Knob,
    /// Fall time after the walk's start with 10 % less; null: it does not fall. A delay has no less \[s\].
    pub less_s: Option<f64>,
    /// The same with 10 % more, of a delay with 8 ms \[s\].
    pub more_s: Option<f64>,
    /// Per cent of the fall time for a per cent of the parameter; null where it does not fall.
    pub sensitivity: Option<f64>,
}

impl Moved {
    fn of(parameter: Knob, [less_s, more_s]: [Option<f64>; 2], nominal_s: Option<f64>) -> Self {
        let less_s = if parameter == Knob::Delay { None } else { less_s };
        let sensitivity = match (parameter, less_s, more_s, nominal_s) {
            (Knob::Delay, ..) => None,
            (_, Some(less), Some(more), Some(nominal)) => Some((more - less) / (2.0 * SHARE * nominal)),
            _ => None,
        };
        Self { parameter, less_s, more_s, sensitivity }
    }

    /// Whether the gait falls with less and with more of it.
    pub fn falls(&self) -> bool {
        self.more_s.is_some() && (self.less_s.is_some() || self.parameter == Knob::Delay)
    }

    /// How far the fall moves at the most \[s\].
    fn spread_s(&self, nominal_s: Option<f64>) -> f64 {
        let nominal_s = nominal_s.unwrap_or(0.0);
        [self.less_s, self.more_s].into_iter().flatten().map(|t| (t - nominal_s).abs()).fold(0.0, f64::max)
    }
}

/// When a gait falls, and how each parameter moves that.
#[derive(Clone, Debug, PartialEq)]
pub struct Falls {
    /// As it is, after the walk's start \[s\]; `None`: it does not fall.
    pub nominal_s: Option<f64>,
    /// The parameters: what stops the fall comes first, then what moves it most.
    pub moved: Vec<Moved>,
}

impl Falls {
    /// Of the fall times of [`Change::all`], in its order, after the walk's start \[s\].
    pub fn of(times_s: &[Option<f64>]) -> Self {
        let nominal_s = times_s.first().copied().flatten();
        let pairs = times_s.iter().skip(1).step_by(2).zip(times_s.iter().skip(2).step_by(2));
        let row = |(knob, (less_s, more_s)): (Knob, (&Option<f64>, &Option<f64>))| {
            Moved::of(knob, [*less_s, *more_s], nominal_s)
        };
        let mut moved: Vec<Moved> = Knob::ALL.into_iter().zip(pairs).map(row).collect();
        let rank = |row: &Moved| if row.falls() { row.spread_s(nominal_s) } else { f64::INFINITY };
        moved.sort_by(|a, b| rank(b).total_cmp(&rank(a)));
        Self { nominal_s, moved }
    }

    /// The parameter that moves the fall most without stopping it, of the gait or of robot and floor, and by how much \[s\].
    pub fn sharpest(&self, of_gait: bool) -> Option<(Knob, f64)> {
        let candidates = self.moved.iter().filter(|row| row.parameter.is_of_gait() == of_gait && row.falls());
        let by = candidates.map(|row| (row.parameter, row.spread_s(self.nominal_s)));
        by.max_by(|(_, a), (_, b)| a.total_cmp(b))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stops_the_fall_comes_first_then_what_moves_it_most() {
        let mut times_s = vec![Some(1.0); Change::all().len()];
        let at = |knob: Knob| 1 + 2 * Knob::ALL.iter().position(|other| *other == knob).unwrap();
        times_s[at(Knob::HeadMass)] = None;
        times_s[at(Knob::FloorFriction) + 1] = Some(1.2);
        times_s[at(Knob::Delay)] = None;
        times_s[at(Knob::Delay) + 1] = Some(0.9);
        let falls = Falls::of(&times_s);
        let first: Vec<Knob> = falls.moved.iter().take(3).map(|row| row.parameter).collect();
        assert_eq!(first, [Knob::HeadMass, Knob::FloorFriction, Knob::Delay]);
        assert_eq!((falls.moved.len(), falls.moved[0].falls(), falls.moved[2].falls()), (14, false, true));
        assert_eq!(falls.sharpest(false).map(|(knob, _)| knob), Some(Knob::FloorFriction));
        assert_eq!(falls.sharpest(true).map(|(knob, _)| knob), Some(Knob::Delay));
    }
}
