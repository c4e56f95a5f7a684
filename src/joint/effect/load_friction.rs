//! Friction under load: it gains `mu_l |gravity torque of link and extra mass|`.
//!
//! Forms: `|g M* sin|` (gravity); its square over its largest value over a turn (square); and the whole force on the
//! bearing times the lever of the centre of mass (bearing), `hypot(g M* sin, g M* cos + I* q'^2)`, in which `I*` stands
//! for the mass times the square of that lever, as of a point mass, and the force that speeds the link up is left out.
//!
//! A bearing resists in proportion to the force on it, and on a pendulum most of that force goes with the gravity torque.
//! It shows as friction that rises with the added mass and with the angle.

use super::{Bounds, Effect, EffectParameter, Named, Reach};
use crate::joint::{Chain, Contact, FrictionTerm, Link, Real};

#[derive(Clone, Copy)]
pub(super) enum Term {
    Gravity,
    Square,
    Bearing,
}

impl Effect for Term {
    const FORMS: &'static [(Self, &'static str)] =
        &[(Term::Gravity, "gravity"), (Term::Square, "square"), (Term::Bearing, "bearing")];
    const NAMED: &'static [Named] = &[Named { name: "mu_l", unit: "", zero: 0.0, bounds: Bounds::NOT_NEGATIVE }];

    fn parameters(self, _reach: &Reach) -> Vec<EffectParameter> {
        vec![EffectParameter::linear("mu_l", "", [0.0, 0.9], 0.1)]
    }

    fn starts(self, _reach: &Reach) -> Vec<Vec<f64>> {
        vec![vec![0.03], vec![0.1], vec![0.3]]
    }

    fn apply<T: Real>(self, values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        chain.friction.terms.push(Box::new(LoadTerm { mu_l: values[0], link: chain.link, load: self }));
    }
}

struct LoadTerm<T> {
    mu_l: T,
    link: Link<T>,
    load: Term,
}

impl<T: Real> FrictionTerm<T> for LoadTerm<T> {
    fn resistance_nm(&self, at: &Contact<T>) -> T {
        let size = |x: T| if x.re() < 0.0 { -x } else { x };
        let load_nm = match self.load {
            Term::Gravity => size(at.gravity_nm),
            Term::Square => match self.link.peak_nm() {
                peak_nm if peak_nm.re() > 0.0 => at.gravity_nm * at.gravity_nm / peak_nm,
                _ => T::nought(),
            },
            Term::Bearing => {
                let swinging_nm = self.link.inertia_kg_m2 * at.speed_rad_s * at.speed_rad_s;
                let along_nm = self.link.along_nm(at.angle_rad) + swinging_nm;
                let square = at.gravity_nm * at.gravity_nm + along_nm * along_nm;
                if square.re() > 0.0 { square.sqrt() } else { T::nought() }
            }
        };
        self.mu_l * load_nm
    }

    fn slope_nm_s_rad(&self, speed_rad_s: f64, _t_s: f64) -> f64 {
        match self.load {
            Term::Bearing => 2.0 * self.mu_l.re() * self.link.inertia_kg_m2.re() * speed_rad_s,
            _ => 0.0,
        }
    }
}
