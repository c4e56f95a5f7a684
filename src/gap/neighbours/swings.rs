//! The swings that are fitted, and the drops of the whole robot that repeat them.

use crate::gap::hypothesis::model::parameters_of;
use crate::gap::reach_of;
use crate::gap::search::grow::FACTORS;
use crate::geometry::{LinkBody, joint_name};
use crate::identify::{Case, Experiment, LegCase, Named, Parameter, starts_of};
use crate::joint::{EffectId, Reach};
use crate::log::{ExtraMass, Nominal};
use crate::robot::Model;
use crate::robot::bench::{BenchDrop, Held, bench_drop};
use crate::robot::simulate::{Method, SimulateError};

/// Swings of one joint of a leg whose other joints were held.
pub struct Swings<'a> {
    case: &'a Case,
    leg: &'a LegCase,
    /// Those that are fitted.
    pub(super) fit: Vec<Experiment>,
    /// What may be searched, at its nominal values.
    pub(super) parameters: Vec<Parameter>,
    limb: Model,
}

/// Where the numbers stand among the parameters; those of effects follow.
const MASS: usize = 0;
const COULOMB: usize = 1;
pub(super) const VISCOUS: usize = 2;
const ZERO: usize = 3;
const NUMBERS: usize = 4;
/// The effects on the joint that swings, each with one parameter.
const EFFECTS: [EffectId; 2] = [EffectId::LoadFriction, EffectId::AsymmetricFriction];

/// Within this of its last angle a joint rests \[rad\]; so many samples of rest are fitted.
const RESTS_RAD: f64 = 0.015;
const REST_SAMPLES: usize = 60;
/// Span at the end of a log over which its angle of rest is the mean \[s\].
const REST_S: f64 = 0.3;
/// Steps \[s\]: within 0.01 mrad of steps a quarter as long, in the air.
const METHOD: Method = Method::Stiff { step_s: 4e-3 };

impl<'a> Swings<'a> {
    /// Free swings of a case that begin held, up to `of_each_load` with each extra mass; `None` where there are none or the
    /// case is of no leg in a known pose.
    ///
    /// # Errors
    /// [`SimulateError`] where the robot has no such leg.
    pub fn of(case: &'a Case, of_each_load: usize) -> Result<Option<Self>, SimulateError> {
        let Some(leg) = case.leg.as_ref().filter(|leg| leg.pose_known) else { return Ok(None) };
        let mass_kg = |e: &Experiment| extra_of(case, e).map_or(0.0, |extra| extra.mass_kg);
        let mut fit: Vec<Experiment> = Vec::new();
        for e in case.items.iter().flat_map(|item| &item.experiments) {
            let alike = fit.iter().filter(|other| mass_kg(other) == mass_kg(e)).count();
            if !e.is_driven() && e.release_window_s.is_some() && alike < of_each_load {
                fit.push(swing(e));
            }
        }
        if fit.is_empty() {
            return Ok(None);
        }
        let nominal = leg.nominal()?;
        let lower_kg = leg.bare()?.body(LinkBody::LowerLeg).map_or(f64::NAN, |body| body.mass_kg);
        let parameters = parameters(lower_kg, &nominal, &reach_of(&fit, &nominal));
        let robot = Model::ers7();
        let limb = robot.limb(robot.joint(&joint_name(leg.leg, leg.joint))?)?;
        Ok(Some(Self { case, leg, fit, parameters, limb }))
    }

    /// Names of the logs that are fitted.
    pub fn files(&self) -> Vec<String> {
        self.fit.iter().map(|e| e.file.clone()).collect()
    }

    /// Values of all parameters from which a search begins that knows nothing: the nominal ones, the first, and those with other
    /// friction, with which the joint stops in other half swings.
    pub(super) fn starts(&self) -> Vec<Vec<f64>> {
        let nominal = starts_of(&self.parameters);
        let times = |(friction, factor): (usize, f64)| {
            let mut other = nominal.clone();
            other[friction] *= factor;
            other
        };
        let others = [COULOMB, VISCOUS].into_iter().flat_map(|at| FACTORS.map(|factor| (at, factor))).map(times);
        std::iter::once(nominal.clone()).chain(others).collect()
    }

    /// What the encoder reads along a log of the case \[rad\].
    pub(super) fn readings(&self, e: &Experiment, held: Held, values: &[f64]) -> Result<Vec<f64>, SimulateError> {
        let drop = BenchDrop {
            leg: self.leg,
            extra: extra_of(self.case, e),
            masses_kg: vec![(LinkBody::LowerLeg, values[MASS])],
            coulomb_nm: values[COULOMB],
            viscous_nm_s_rad: values[VISCOUS],
            stribeck: None,
            effects: EFFECTS.into_iter().zip(values[NUMBERS..].iter().map(|value| vec![*value])).collect(),
            others: Vec::new(),
            zero_rad: values[ZERO],
            angle_rad: e.start.angle_rad,
            rate_rad_s: 0.0,
            release_s: e.release_window_s.map_or(0.0, |[_, to]| to),
            held,
        };
        Ok(bench_drop(&self.limb, &drop, &e.t_s, METHOD)?.reading_rad)
    }
}

fn extra_of(case: &Case, e: &Experiment) -> Option<ExtraMass> {
    case.items.get(e.log_index).and_then(|item| item.entry.extra)
}

/// The swing of a log and a little rest: it may rest for much longer than it swings.
fn swing(e: &Experiment) -> Experiment {
    let rest_rad = at_rest_rad(e, &e.measured_rad[e.uncompared..]);
    let last = e.measured_rad.iter().rposition(|q| (q - rest_rad).abs() > RESTS_RAD).unwrap_or(0);
    e.part_of_log(0..(last + REST_SAMPLES).min(e.t_s.len()), e.part)
}

fn parameters(lower_kg: f64, nominal: &Nominal, reach: &Reach) -> Vec<Parameter> {
    let (coulomb, viscous) = (nominal.coulomb_nm, nominal.viscous_nm_s_rad);
    let damping = reach.torque_nm / reach.speed_rad_s;
    let mut parameters = vec![
        Parameter::positive(Named::Mass(LinkBody::LowerLeg), "M_L", "kg", Some(lower_kg), lower_kg),
        Parameter::friction(Named::Coulomb, "mu_c", "N m", Some(coulomb), coulomb, reach.torque_nm),
        Parameter::friction(Named::Viscous, "mu_v", "N m s/rad", Some(viscous), viscous, damping),
        Parameter::angle(Named::Zero, "q_0", Some(0.0), 0.0),
    ];
    parameters.extend(EFFECTS.into_iter().flat_map(|effect| {
        let absent = effect.named_parameters().iter().map(|named| named.zero);
        parameters_of(effect.into(), reach).into_iter().zip(absent).map(|(p, absent)| Parameter { start: absent, ..p })
    }));
    parameters
}

/// Mean at the end of a log of a column beside its compared samples.
pub(super) fn at_rest_rad(e: &Experiment, compared_rad: &[f64]) -> f64 {
    let end_s = e.t_s.last().copied().unwrap_or(0.0);
    let rests = e.t_s[e.uncompared..].iter().zip(compared_rad).filter(|(t, _)| **t >= end_s - REST_S);
    let (sum, count) = rests.fold((0.0, 0), |(sum, count), (_, value)| (sum + value, count + 1));
    sum / f64::from(count.max(1))
}
