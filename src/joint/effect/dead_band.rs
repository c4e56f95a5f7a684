//! Small torques do not arrive: nothing of a command's torque `tau` where `|tau| <= tau_0`.
//!
//! Forms: beyond it `tau - sign(tau) tau_0` is delivered (rest), or all of `tau` (whole; it comes up within a tenth of `tau_0`).
//!
//! Dead time of the power stage takes its part of every command; a deadband that the firmware has so that the joint is
//! quiet takes small ones only. It acts before gain and limits, on the torque that a motor fed by voltage would have at
//! standstill. Driven logs only; the joint stops short of its setpoint by an error in proportion to `tau_0`, as with
//! friction, but the torque that is lost has no direction of motion in it.

use super::{Bounds, Effect, EffectParameter, Named, Reach};
use crate::joint::{Beyond, Chain, DeadBand, Real};

#[derive(Clone, Copy)]
pub(super) struct Term(Beyond);

impl Effect for Term {
    const FORMS: &'static [(Self, &'static str)] = &[(Term(Beyond::Rest), "rest"), (Term(Beyond::Whole), "whole")];
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
            motor.dead_band = Some(DeadBand { band_nm: values[0], beyond: self.0 });
        }
    }
}
