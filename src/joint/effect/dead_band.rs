//! Small torques do not arrive: of a command's torque `tau` the part `tau - sign(tau) tau_0` is delivered, and nothing
//! where `|tau| <= tau_0`.
//!
//! Dead time of the power stage, or a deadband that the firmware has so that the joint is quiet. It acts before gain and
//! limits, on the torque that a motor fed by voltage would have at standstill. Driven logs only; the joint stops short of
//! its setpoint by an error in proportion to `tau_0`, as with friction, but the torque that is lost has no direction of
//! motion in it.

use super::{Bounds, Effect, EffectParameter, Named, Reach};
use crate::joint::{Chain, Real};

#[derive(Clone, Copy)]
pub(super) struct Term;

impl Effect for Term {
    const FORMS: &'static [(Self, &'static str)] = &[(Term, "")];
    const NAMED: &'static [Named] = &[Named { name: "tau_0", unit: "N m", zero: 0.0, bounds: Bounds::NOT_NEGATIVE }];

    fn parameters(self, reach: &Reach) -> Vec<EffectParameter> {
        let most = reach.driven.map_or(reach.torque_nm, |driven| driven.command_nm);
        vec![EffectParameter::linear("tau_0", "N m", [0.0, 0.8 * most], 0.03 * most)]
    }

    fn starts(self, reach: &Reach) -> Vec<Vec<f64>> {
        let Some(driven) = reach.driven else { return Vec::new() };
        [0.01, 0.04, 0.12, 0.3].map(|share| vec![share * driven.command_nm]).to_vec()
    }

    fn apply<T: Real>(self, values: &[T], _bare_kg_m2: T, chain: &mut Chain<T>) {
        if let Some(motor) = &mut chain.motor {
            motor.dead_band_nm = Some(values[0]);
        }
    }
}
