//! The numbers of a drop that may be searched, and between which bounds.

use super::Cause;
use crate::fit::Coordinate;

/// Numbers of a drop that may be searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Values {
    pub mass_kg: f64,
    pub coulomb_nm: f64,
    pub viscous_nm_s_rad: f64,
    pub zero_rad: f64,
    pub mu_l: f64,
    pub delta_nm: f64,
    /// What [`Cause::HeldJoints`] would have; it has no number.
    pub none: f64,
}

impl Values {
    pub(super) fn at(&mut self, searched: Searched) -> &mut f64 {
        match searched {
            Searched::Viscous => &mut self.viscous_nm_s_rad,
            Searched::Of(Cause::HeldJoints) => &mut self.none,
            Searched::Of(Cause::Zero) => &mut self.zero_rad,
            Searched::Of(Cause::Mass) => &mut self.mass_kg,
            Searched::Of(Cause::LoadFriction) => &mut self.mu_l,
            Searched::Of(Cause::Direction) => &mut self.delta_nm,
            Searched::Of(Cause::Coulomb) => &mut self.coulomb_nm,
        }
    }
}

/// A number that can be searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Searched {
    Viscous,
    Of(Cause),
}

/// Its bounds and its scale.
pub(super) fn coordinate(searched: Searched, nominal: &Values) -> Coordinate {
    let (name, lower, upper, scale) = match searched {
        Searched::Viscous => ("viscous", 0.0, 0.2, 0.005),
        Searched::Of(cause) => {
            let (lower, upper, scale) = match cause {
                Cause::HeldJoints => (0.0, 0.0, 1.0),
                Cause::Zero => (-0.3, 0.3, 0.03),
                Cause::Mass => (0.05 * nominal.mass_kg, 20.0 * nominal.mass_kg, 0.5 * nominal.mass_kg),
                Cause::LoadFriction => (0.0, 0.9, 0.1),
                Cause::Direction => (-0.1, 0.1, 0.005),
                Cause::Coulomb => (0.0, 0.3, 0.005),
            };
            (cause.id(), lower, upper, scale)
        }
    };
    Coordinate { name: name.to_owned(), lower, upper, scale }
}
