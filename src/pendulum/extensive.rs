//! The extensive pendulum: bodies with inertias, Coulomb to Stribeck friction (3.12, 3.13).

use crate::joint::{Chain, Friction, Link, Motor, Real, Stribeck};

/// `I* theta'' + F(theta') + g M* sin(theta) = tau` (3.12), theta being the angle from where the link hangs.
///
/// With `tau = 0` and both sides divided by `I*` this is (3.13). `F` is (3.14), or (3.11) with a Stribeck part.
pub struct ExtensivePendulum<T> {
    /// Everything that turns: the bare link joined with what is hung on it (3.10).
    pub link: Link<T>,
    /// `mu_c` \[N m\]
    pub coulomb_nm: T,
    /// `mu_v` \[N m s/rad\]
    pub viscous_nm_s_rad: T,
    /// The Stribeck part of (3.11), where there is one.
    pub stribeck: Option<Stribeck<T>>,
}

impl<T: Real> ExtensivePendulum<T> {
    /// The pendulum as a joint chain.
    pub fn chain(self, motor: Option<Motor<T>>) -> Chain<T> {
        let friction = Friction::coulomb_viscous(self.coulomb_nm, self.viscous_nm_s_rad);
        Chain::new(self.link, Friction { stribeck: self.stribeck, ..friction }, motor)
    }
}
