//! What columns mean: parameters of effects under the catalogue's names, curves as laws.

use super::design::{Curve, Family};
use super::numbers::{Values, Which};
use super::system::Solved;
use crate::gap::location::looks_like::look;
use crate::gap::{Detectable, LawFound, Number};
use crate::joint::{EffectId, LawActs, LawTable};
use crate::number::chance::HALF_95;
use crate::number::math;

/// A size that stands out of what the logs leave open by so many standard deviations would have been seen.
const SEEN: f64 = 3.0;

/// An unknown with its standard deviation, that of refits included.
#[derive(Clone, Copy, Debug)]
pub(super) struct Estimated {
    pub value: f64,
    pub sd: f64,
    /// By curvature and belief alone.
    pub naive_sd: f64,
}

impl Estimated {
    /// An unknown of a fit and of the refits without a log each.
    pub fn new(unknown: usize, solved: &Solved, refits: &[Solved]) -> Self {
        let naive_sd = solved.sd(unknown);
        let n = refits.len() as f64;
        let mean = refits.iter().map(|refit| refit.x[unknown]).sum::<f64>() / n.max(1.0);
        let squares: f64 = refits.iter().map(|refit| (refit.x[unknown] - mean).powi(2)).sum();
        // The jackknife's variance.
        let spread = if refits.len() > 1 { (n - 1.0) / n * squares } else { 0.0 };
        Self { value: solved.x[unknown], sd: math::hypot(naive_sd, spread.sqrt()), naive_sd }
    }

    /// Whether it is held at an end of what it may be: curvature says nothing of it there.
    pub fn is_held(self) -> bool {
        self.naive_sd == 0.0
    }

    fn number(self, name: &str, unit: &str, offset: f64, scale: f64) -> Number {
        let value = offset + scale * self.value;
        let around = |sd: f64| {
            let half = HALF_95 * (scale * sd).abs();
            half.is_finite().then_some([value - half, value + half])
        };
        Number {
            name: name.to_owned(),
            value,
            unit: unit.to_owned(),
            interval: around(self.sd),
            interval_naive: around(self.naive_sd),
        }
    }
}

/// The parameters of an effect, of its unknowns; `now` are the joint's numbers.
pub(super) fn named(family: &Family, found: &[Estimated], now: &Values) -> Vec<Number> {
    let parameters = family.effect.named_parameters();
    // Shapes are tried on a grid: as far as its next points nobody knows better.
    let as_is = |k: usize, value: f64, interval: Option<[f64; 2]>| Number {
        name: parameters[k].name.to_owned(),
        value,
        unit: parameters[k].unit.to_owned(),
        interval,
        interval_naive: interval,
    };
    let of = |k: usize, unknown: Estimated, offset: f64, scale: f64| {
        unknown.number(parameters[k].name, parameters[k].unit, offset, scale)
    };
    let coulomb_nm = now[Which::Coulomb as usize];
    match (family.effect, found) {
        (EffectId::Stribeck, [more]) => vec![
            of(0, *more, coulomb_nm, 1.0),
            as_is(1, family.shape[0], Some([0.5, 2.0].map(|times| times * family.shape[0]))),
        ],
        (EffectId::EndStop, [stiffness]) => {
            let [at, side, half] = [family.shape[0], family.shape[1], family.shape[2]];
            let place = as_is(0, at, Some([at - half, at + half]));
            vec![place, as_is(1, side, None), of(2, *stiffness, 0.0, 1.0), as_is(3, 0.0, None)]
        }
        (EffectId::JointSpring, [k, level]) => {
            let rest =
                Estimated { value: -level.value / k.value, sd: level.sd / k.value, naive_sd: level.naive_sd / k.value };
            vec![of(0, *k, 0.0, 1.0), of(1, rest, 0.0, 1.0)]
        }
        (EffectId::PositionFriction, [cos, sin]) => {
            let size = math::hypot(cos.value, sin.value);
            let one = Estimated { value: size, sd: cos.sd.max(sin.sd), naive_sd: cos.naive_sd.max(sin.naive_sd) };
            let angle = Estimated {
                value: math::atan2(sin.value, cos.value),
                sd: one.sd / size,
                naive_sd: one.naive_sd / size,
            };
            vec![of(0, one, 0.0, 1.0 / coulomb_nm.max(f64::MIN_POSITIVE)), of(1, angle, 0.0, 1.0)]
        }
        (_, [size, ..]) => vec![of(0, *size, 0.0, 1.0)],
        (_, []) => Vec::new(),
    }
}

/// The size of an effect that would have stood out; `sd` is that of its first unknown where it is fitted beside the rest.
pub(super) fn detectable(family: &Family, sd: f64, now: &Values) -> Detectable {
    let parameter = &family.effect.named_parameters()[0];
    let coulomb_nm = now[Which::Coulomb as usize];
    let value = match family.effect {
        EffectId::EndStop => None,
        EffectId::Stribeck => Some(coulomb_nm + SEEN * sd),
        EffectId::PositionFriction => (coulomb_nm > 0.0).then(|| SEEN * sd / coulomb_nm),
        _ => Some(SEEN * sd),
    };
    let value = value.filter(|value| value.is_finite());
    Detectable { effect: family.effect, value, name: parameter.name, unit: parameter.unit }
}

/// A curve as a law: a torque that acts on the joint is one that its drive need not give.
pub(super) fn law(joint: &str, curve: &Curve, found: &[Estimated], after: f64, closed: Option<f64>) -> LawFound {
    let values: Vec<f64> = found.iter().map(|unknown| unknown.value).collect();
    let knots = 0..curve.knots.len();
    let y = knots.clone().map(|knot| -curve.at_knot(knot, &values)).collect();
    let sd_at = |knot: usize| match curve.per_turn {
        Some(_) => found.iter().map(|unknown| unknown.sd).fold(0.0, f64::max),
        None => found[knot].sd,
    };
    let sd: Vec<f64> = knots.map(sd_at).collect();
    let mut table = LawTable::new(curve.variable, LawActs::Torque, curve.knots.clone(), y);
    look(&table, Some(&sd)).told(&mut table);
    table.joints = vec![joint.to_owned()];
    table.closed = closed;
    LawFound { table, sd: Some(sd), after }
}
