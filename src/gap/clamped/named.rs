//! What `without` and `only` name of a study, by their ids: causes of joints, of bodies and of robots that walk.

use super::BodyKind;
use crate::gap::GapOptions;
use crate::gap::robot::{Cause, UnknownCause};
use crate::joint::EffectId;
use std::str::FromStr;

/// A cause by its id, of a robot of any kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NamedCause {
    /// Of a joint, or of a robot that is simulated as a whole; a payload is a cause of arms too.
    Cause(Cause),
    /// Another mass or centre of mass of a body of an arm.
    Body(BodyKind),
}

/// Why a study has no such cause.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NoSuchCause {
    /// A joint alone has no bodies and no floor.
    #[error("`{0}` is a cause of a whole robot, and this is the study of a joint")]
    OfRobot(&'static str),
    /// An arm stands on no floor.
    #[error("`{0}` is a cause of a robot that walks, and this is the study of a robot with a clamped base")]
    OfWalkingRobot(&'static str),
    /// A robot that walks is searched for a payload on its trunk only.
    #[error("`{0}` is looked for in studies with scenario = \"fixed\"")]
    OfArm(&'static str),
    /// Friction is searched with every other number of a joint.
    #[error(
        "`{0}` is a number that is refitted within what is believed of it, and no cause; friction = {{ {0} = 0.0 }} in \
         [uncertain] holds it as stated"
    )]
    NumberOfJoint(&'static str),
    /// The same of every joint of an arm.
    #[error(
        "`{0}` is a number of each joint that is refitted within what is believed of it, and no cause; friction = 0.0 \
         in [uncertain] holds it as stated"
    )]
    NumberOfArm(&'static str),
}

/// What of a body no other robot has.
const OF_ARMS: [BodyKind; 2] = [BodyKind::BodyMass, BodyKind::BodyCom];

impl FromStr for NamedCause {
    type Err = UnknownCause;

    fn from_str(word: &str) -> Result<Self, UnknownCause> {
        if let Some(kind) = OF_ARMS.into_iter().find(|kind| kind.id() == word) {
            return Ok(Self::Body(kind));
        }
        word.parse().map(Self::Cause).map_err(|error: UnknownCause| UnknownCause {
            known: format!("{}, {}", error.known, OF_ARMS.map(BodyKind::id).join(", ")),
            ..error
        })
    }
}

impl NamedCause {
    /// As it is written.
    pub fn id(self) -> &'static str {
        match self {
            Self::Cause(cause) => cause.id(),
            Self::Body(kind) => kind.id(),
        }
    }

    /// As a cause of a robot that is simulated as a whole.
    ///
    /// # Errors
    /// [`NoSuchCause::OfArm`] for what is looked for along the motion of arms alone.
    pub fn of_whole_robot(self) -> Result<Cause, NoSuchCause> {
        match self {
            Self::Cause(cause) => Ok(cause),
            Self::Body(kind) => Err(NoSuchCause::OfArm(kind.id())),
        }
    }

    fn of_joint(self) -> Result<EffectId, NoSuchCause> {
        match self {
            Self::Cause(Cause::Effect(effect)) => Ok(effect),
            Self::Cause(Cause::Coulomb | Cause::Viscous) => Err(NoSuchCause::NumberOfJoint(self.id())),
            Self::Cause(_) | Self::Body(_) => Err(NoSuchCause::OfRobot(self.id())),
        }
    }
}

/// Causes of an arm: those of its joints, and those of its bodies.
fn of_arm(named: &[NamedCause]) -> Result<(Vec<EffectId>, Vec<BodyKind>), NoSuchCause> {
    let (mut effects, mut bodies) = (Vec::new(), Vec::new());
    for cause in named {
        match *cause {
            NamedCause::Cause(Cause::Effect(effect)) => effects.push(effect),
            NamedCause::Cause(Cause::Payload) => bodies.push(BodyKind::Payload),
            NamedCause::Body(kind) => bodies.push(kind),
            NamedCause::Cause(Cause::Coulomb | Cause::Viscous) => return Err(NoSuchCause::NumberOfArm(cause.id())),
            NamedCause::Cause(_) => return Err(NoSuchCause::OfWalkingRobot(cause.id())),
        }
    }
    Ok((effects, bodies))
}

impl GapOptions {
    /// The diagnosis of a joint with some effects withheld, or with some alone.
    ///
    /// # Errors
    /// [`NoSuchCause`] for what a joint cannot have.
    pub fn of_joint(without: &[NamedCause], only: &[NamedCause]) -> Result<Self, NoSuchCause> {
        let effects =
            |named: &[NamedCause]| named.iter().copied().map(NamedCause::of_joint).collect::<Result<Vec<_>, _>>();
        Ok(Self { without: effects(without)?, only: effects(only)?, ..Self::default() })
    }

    /// The diagnosis of a robot with a clamped base, with some causes of joints and bodies withheld, or some alone. Who
    /// names effects alone asks for no bodies, and who names bodies alone for no effects.
    ///
    /// ```
    /// use aibo_fit::gap::GapOptions;
    /// use aibo_fit::gap::clamped::{BodyKind, NamedCause};
    ///
    /// let options = GapOptions::of_arm(&[], &[NamedCause::Body(BodyKind::BodyMass), "delay".parse()?])?;
    /// assert_eq!(options.only_bodies, [BodyKind::BodyMass]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`NoSuchCause`] for what such a robot cannot have.
    pub fn of_arm(without: &[NamedCause], only: &[NamedCause]) -> Result<Self, NoSuchCause> {
        let ((without, without_bodies), (only, only_bodies)) = (of_arm(without)?, of_arm(only)?);
        Ok(Self { without, only, without_bodies, only_bodies, ..Self::default() })
    }

    /// What of bodies is not considered, by demand.
    pub(crate) fn withheld_bodies(&self) -> Vec<BodyKind> {
        let is_considered = |kind: &BodyKind| {
            !self.without_bodies.contains(kind) && (self.only_bodies.contains(kind) || !self.names_alone())
        };
        BodyKind::ALL.into_iter().filter(|kind| !is_considered(kind)).collect()
    }

    /// Whether anything of bodies is considered.
    pub(in crate::gap) fn considers_bodies(&self) -> bool {
        self.withheld_bodies().len() < BodyKind::ALL.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(ids: &[&str]) -> Vec<NamedCause> {
        ids.iter().map(|id| id.parse().unwrap()).collect()
    }

    fn of_arm(without: &[&str], only: &[&str]) -> GapOptions {
        GapOptions::of_arm(&named(without), &named(only)).unwrap()
    }

    #[test]
    fn ids_are_read_back_and_what_is_none_is_told_all_there_are() {
        for id in ["delay", "payload", "body_mass", "body_com", "floor_slope", "coulomb"] {
            assert_eq!(id.parse::<NamedCause>().unwrap().id(), id);
        }
        let error = "gremlins".parse::<NamedCause>().unwrap_err().to_string();
        assert!(error.contains("`gremlins`") && error.contains("floor_stiffness, body_mass, body_com"), "{error}");
    }

    #[test]
    fn of_an_arm_what_is_withheld_is_withheld_and_the_rest_is_asked_for() {
        let asked = of_arm(&["payload", "delay"], &[]);
        assert_eq!(asked.without, [EffectId::Delay]);
        assert!(!asked.considers(EffectId::Delay) && asked.considers(EffectId::Stribeck));
        assert_eq!(asked.withheld_bodies(), [BodyKind::Payload]);
        assert!(asked.only.is_empty() && asked.only_bodies.is_empty() && asked.considers_bodies());
    }

    #[test]
    fn who_names_effects_of_an_arm_alone_asks_for_no_bodies() {
        let asked = of_arm(&[], &["delay", "stribeck"]);
        assert_eq!(asked.only, [EffectId::Delay, EffectId::Stribeck]);
        assert!(asked.without.is_empty() && asked.without_bodies.is_empty(), "nobody withheld anything");
        assert!(!asked.considers_bodies());
    }

    #[test]
    fn who_names_bodies_of_an_arm_alone_asks_for_no_effects() {
        let asked = of_arm(&[], &["payload"]);
        assert!(asked.only.is_empty() && asked.without.is_empty(), "what was named is kept as it was");
        assert_eq!(asked.only_bodies, [BodyKind::Payload]);
        assert!(EffectId::ALL.iter().all(|effect| !asked.considers(*effect)));
        assert_eq!(asked.withheld_bodies(), [BodyKind::BodyMass, BodyKind::BodyCom]);
    }

    #[test]
    fn effects_and_bodies_that_are_named_together_are_all_that_is_asked_for() {
        let asked = of_arm(&["body_mass"], &["delay", "body_com", "stribeck"]);
        let left: Vec<EffectId> = EffectId::ALL.iter().copied().filter(|effect| asked.considers(*effect)).collect();
        assert_eq!(left, [EffectId::Stribeck, EffectId::Delay]);
        assert_eq!(asked.withheld_bodies(), [BodyKind::Payload, BodyKind::BodyMass]);
    }

    #[test]
    fn what_a_study_cannot_have_is_refused_with_what_is_true_of_it() {
        let of_joint = |id: &str| GapOptions::of_joint(&[], &named(&[id])).unwrap_err().to_string();
        let of_arm = |id: &str| GapOptions::of_arm(&named(&[id]), &[]).unwrap_err().to_string();
        for id in ["payload", "body_mass", "floor_slope"] {
            let error = of_joint(id);
            assert!(error.contains(&format!("`{id}` is a cause of a whole robot")), "{error}");
        }
        assert!(of_joint("coulomb").contains("friction = { coulomb = 0.0 } in [uncertain]"), "{}", of_joint("coulomb"));
        assert!(of_arm("floor_slope").contains("`floor_slope` is a cause of a robot that walks"));
        assert!(of_arm("viscous").contains("`viscous` is a number of each joint"), "{}", of_arm("viscous"));
        assert!(of_arm("viscous").contains("friction = 0.0 in [uncertain]"), "{}", of_arm("viscous"));
        let body = NamedCause::Body(BodyKind::BodyMass);
        assert_eq!(body.of_whole_robot(), Err(NoSuchCause::OfArm("body_mass")));
        assert_eq!(NamedCause::Cause(Cause::Payload).of_whole_robot(), Ok(Cause::Payload));
    }
}
