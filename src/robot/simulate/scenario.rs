//! What is simulated: the problem, which no run changes.

use super::{Joints, Setpoints, SimulateError};
use crate::robot::{BodyId, BodyMotion, ContactDamping, Floor, Force, Model, Resting, State};

/// What the surroundings do to the robot at one instant.
#[derive(Clone, Debug, Default)]
pub struct External {
    /// Forces on bodies, whole: springs, dampers, friction.
    pub forces: Vec<Force>,
    /// How the forces change with the motion of their points: the stiff method takes that along, so that long steps stay
    /// stable. May be left empty.
    pub contacts: Vec<ContactDamping>,
}

impl External {
    /// Nothing; keeps its memory.
    pub fn clear(&mut self) {
        self.forces.clear();
        self.contacts.clear();
    }
}

/// Whatever acts on the robot from outside: a floor, a hand.
///
/// It answers from time, motion and what rests alone, so that a method may ask at any instant and as often as it likes.
pub trait Surroundings: Sync {
    /// Adds to `external`, which is empty, what acts while the bodies move so. Should not allocate once its lists have
    /// grown.
    fn act(&self, t_s: f64, bodies: &[BodyMotion], external: &mut External);

    /// The bodies that it looks at; `None`: any. The motion of others, but for those that carry these, is not kept up
    /// to date in `bodies`.
    fn looks_at(&self) -> Option<Vec<BodyId>> {
        None
    }

    /// How many points it has on which something may rest.
    fn points(&self) -> usize {
        0
    }

    /// Takes notice of what rests, at the begin of each step of the stiff method.
    fn notice(&self, _t_s: f64, _bodies: &[BodyMotion], _resting: &mut Resting) {}

    /// As [`Surroundings::act`], with what rests.
    fn act_resting(&self, t_s: f64, bodies: &[BodyMotion], _resting: &Resting, external: &mut External) {
        self.act(t_s, bodies, external);
    }
}

impl Surroundings for Floor {
    fn act(&self, t_s: f64, bodies: &[BodyMotion], external: &mut External) {
        self.act_resting(t_s, bodies, &Resting::none(), external);
    }

    fn looks_at(&self) -> Option<Vec<BodyId>> {
        Some(self.bodies().collect())
    }

    fn points(&self) -> usize {
        self.parts()
    }

    fn notice(&self, t_s: f64, bodies: &[BodyMotion], resting: &mut Resting) {
        Floor::notice(self, t_s, bodies, resting);
    }

    fn act_resting(&self, _t_s: f64, bodies: &[BodyMotion], resting: &Resting, external: &mut External) {
        self.forces(bodies, resting, &mut external.forces, &mut external.contacts);
    }
}

/// Nothing around.
#[derive(Clone, Copy, Debug, Default)]
pub struct Still;

impl Surroundings for Still {
    fn act(&self, _t_s: f64, _bodies: &[BodyMotion], _external: &mut External) {}
}

/// A robot, what is asked of it, and how it begins.
#[derive(Clone, Copy)]
pub struct Scenario<'a> {
    /// The robot; its base is clamped or floats.
    pub model: &'a Model,
    /// Its joints.
    pub joints: &'a Joints,
    /// What is asked of them, as their encoders are to read; the run goes from its first time to its last.
    pub setpoints: &'a Setpoints,
    /// Where everything is at first; true angles.
    pub start: &'a State,
    /// What acts from outside; `None`: nothing.
    pub surroundings: Option<&'a dyn Surroundings>,
    /// Samples are taken so often \[s\].
    pub period_s: f64,
}

impl Scenario<'_> {
    pub(super) fn check(&self) -> Result<(), SimulateError> {
        self.setpoints.check(self.model)?;
        let n = self.model.joints().len();
        let wrong = |what: &'static str, value: f64, allowed| Err(SimulateError::Value { what, value, allowed });
        if !(self.period_s >= 1e-5 && self.period_s <= 10.0) {
            return wrong("the sampling period [s]", self.period_s, "1e-5 to 10");
        }
        if self.start.angle_rad.len() != n || self.start.rate_rad_s.len() != n || self.joints.drives().len() != n {
            return wrong("the number of joints in start or drives", self.start.angle_rad.len() as f64, "the model's");
        }
        let numbers = self.start.angle_rad.iter().chain(&self.start.rate_rad_s);
        match numbers.into_iter().find(|x| !x.is_finite()) {
            Some(value) => wrong("an angle or rate at the start", *value, "a finite number"),
            None => Ok(()),
        }
    }
}
