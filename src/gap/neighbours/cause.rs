//! What may be behind a gap between swings and the nominal robot.

use crate::geometry::LinkBody;
use crate::identify::Named;
use crate::joint::EffectId;

/// What may be behind a gap between swings and the nominal robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cause {
    /// The other joints are held by their controllers (Table B.2) and give.
    HeldJoints,
    /// A number of the pendulum models is another.
    Number(Named),
    /// An effect of the catalogue on the joint that swings.
    Effect(EffectId),
}

impl Cause {
    /// All of them.
    pub const ALL: [Cause; 6] = [
        Cause::HeldJoints,
        Cause::Number(Named::Zero),
        Cause::Number(Named::Mass(LinkBody::LowerLeg)),
        Cause::Effect(EffectId::LoadFriction),
        Cause::Effect(EffectId::AsymmetricFriction),
        Cause::Number(Named::Coulomb),
    ];

    /// Whether it sets a parameter free: a number by its name, an effect's by the effect's id before its own.
    pub fn frees(self, parameter: &str) -> bool {
        match self {
            Cause::HeldJoints => false,
            Cause::Number(named) => parameter == named.name(),
            Cause::Effect(effect) => parameter.split_once('.').is_some_and(|(of, _)| of == effect.id()),
        }
    }
}
