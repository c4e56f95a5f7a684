//! The parameters of the pendulum models, as types: what is looked up in a fit cannot be misspelt.

use crate::geometry::LinkBody;
use std::fmt;

/// A parameter of the simple or the extensive pendulum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Named {
    /// `I*` of the bare link \[kg m^2\] (3.8).
    Inertia,
    /// `M*` of the bare link \[kg m\] (3.9).
    Moment,
    /// Mass of a body of the leg \[kg\] (3.8).
    Mass(LinkBody),
    /// Coulomb friction \[N m\] (3.11).
    Coulomb,
    /// Viscous friction \[N m s/rad\] (3.11).
    Viscous,
    /// Static friction above Coulomb's, `mu_st - mu_c` \[N m\] (3.11).
    StaticExcess,
    /// Stribeck speed `v_st` \[rad/s\] (3.11).
    StribeckSpeed,
    /// Where the bare link hangs \[rad\].
    Rest,
    /// The encoder's zero \[rad\].
    Zero,
    /// `M L^2` of the simple pendulum \[kg m^2\] (3.2).
    Ml2,
    /// `B/ML^2` of the simple pendulum \[1/s\] (3.2).
    BOverMl2,
    /// `g/L` of the simple pendulum \[1/s^2\] (3.2).
    GOverL,
}

impl Named {
    /// Every one there is.
    pub const ALL: [Self; 15] = [
        Self::Inertia,
        Self::Moment,
        Self::Mass(LinkBody::Shoulder),
        Self::Mass(LinkBody::UpperLeg),
        Self::Mass(LinkBody::LowerLeg),
        Self::Mass(LinkBody::Extra),
        Self::Coulomb,
        Self::Viscous,
        Self::StaticExcess,
        Self::StribeckSpeed,
        Self::Rest,
        Self::Zero,
        Self::Ml2,
        Self::BOverMl2,
        Self::GOverL,
    ];

    /// The name in `fit.json` and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Inertia => "inertia",
            Self::Moment => "moment",
            Self::Mass(LinkBody::Shoulder) => "mass_shoulder",
            Self::Mass(LinkBody::UpperLeg) => "mass_upper_leg",
            Self::Mass(LinkBody::LowerLeg) => "mass_lower_leg",
            Self::Mass(LinkBody::Extra) => "mass_extra",
            Self::Coulomb => "coulomb",
            Self::Viscous => "viscous",
            Self::StaticExcess => "static_excess",
            Self::StribeckSpeed => "stribeck_speed",
            Self::Rest => "rest",
            Self::Zero => "zero",
            Self::Ml2 => "ml2",
            Self::BOverMl2 => "b_over_ml2",
            Self::GOverL => "g_over_l",
        }
    }

    /// The parameter of a name; `None` for one of another model.
    pub fn of(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|named| named.name() == name)
    }
}

impl fmt::Display for Named {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl From<Named> for String {
    fn from(named: Named) -> Self {
        named.name().to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_name_leads_back_to_its_parameter() {
        let names: BTreeSet<&str> = Named::ALL.into_iter().map(Named::name).collect();
        assert_eq!(names.len(), Named::ALL.len());
        assert!(Named::ALL.into_iter().all(|named| Named::of(named.name()) == Some(named)));
        assert_eq!(Named::of("v_st"), None);
    }
}
