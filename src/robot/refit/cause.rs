//! What may be behind a gap between the drops and the nominal robot.

/// What may be behind a gap between the drops and the nominal robot, and its rest in particular.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cause {
    /// The other joints are held by their controllers (Table B.2) and give.
    HeldJoints,
    /// The encoder's zero.
    Zero,
    /// Another mass of the lower leg.
    Mass,
    /// Friction that grows with gravity's torque.
    LoadFriction,
    /// Coulomb friction that differs with the direction.
    Direction,
    /// Another Coulomb friction.
    Coulomb,
}

impl Cause {
    /// All of them.
    pub const ALL: [Cause; 6] =
        [Cause::HeldJoints, Cause::Zero, Cause::Mass, Cause::LoadFriction, Cause::Direction, Cause::Coulomb];

    /// The name in JSON, and of its parameter.
    pub fn id(self) -> &'static str {
        match self {
            Cause::HeldJoints => "held_joints",
            Cause::Zero => "zero",
            Cause::Mass => "mass_lower_leg",
            Cause::LoadFriction => "load_friction",
            Cause::Direction => "asymmetric_friction",
            Cause::Coulomb => "coulomb",
        }
    }

    /// A few words.
    pub fn words(self) -> &'static str {
        match self {
            Cause::HeldJoints => "held joints give",
            Cause::Zero => "encoder's zero",
            Cause::Mass => "lower leg's mass",
            Cause::LoadFriction => "load friction",
            Cause::Direction => "friction by direction",
            Cause::Coulomb => "Coulomb friction",
        }
    }

    /// Unit of its parameter.
    pub fn unit(self) -> &'static str {
        match self {
            Cause::HeldJoints | Cause::LoadFriction => "",
            Cause::Zero => "rad",
            Cause::Mass => "kg",
            Cause::Direction | Cause::Coulomb => "N m",
        }
    }
}
