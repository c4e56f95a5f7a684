//! The drops that a pendulum was fitted to, repeated by the whole robot: with the pendulum's values, and refitted.

use super::{Compared, Hypothesis, Swings, at_rest_rad};
use crate::fit::Rejected;
use crate::geometry::LinkBody;
use crate::identify::{Case, DropFit, Experiment, LegCase, Named, Prediction};
use crate::robot::Model;
use crate::robot::bench::{BenchDrop, Dropped, Held, bench_drop};
use crate::robot::simulate::{Method, SimulateError};
use rayon::prelude::*;

/// Swings with each extra mass that are fitted in the whole robot.
const OF_EACH_LOAD: usize = 2;

/// All logs of a case in the whole robot.
#[derive(Clone, Debug)]
pub struct Repeated {
    /// One for each log that moves.
    pub drops: Vec<RepeatedDrop>,
    /// The whole robot refitted; `None` where no log begins held.
    pub compared: Option<Compared>,
}

/// One log: measurement, pendulum, whole robot.
#[derive(Clone, Debug)]
pub struct RepeatedDrop {
    /// As the user named it.
    pub file: String,
    /// \[s\]
    pub t_s: Vec<f64>,
    /// \[rad\]
    pub measured_rad: Vec<f64>,
    /// First sample that is compared.
    pub first: usize,
    /// Half a quantisation step \[rad\].
    pub half_step_rad: f64,
    /// The extensive pendulum \[rad\].
    pub pendulum_rad: Vec<f64>,
    /// Its RMS error \[rad\].
    pub pendulum_rms_rad: f64,
    /// The whole robot with the pendulum's values and the other joints held rigidly.
    pub rigid: Apart,
    /// The same with the other joints held by their controllers.
    pub controlled: Apart,
    /// How far another joint of the leg gives way there \[rad\].
    pub give_rad: f64,
    /// Rigid, refitted where that was done \[rad\].
    pub rigid_rad: Vec<f64>,
    /// By controllers, refitted where that was done \[rad\].
    pub controlled_rad: Vec<f64>,
    /// What [`rigid_rad`](Self::rigid_rad) leaves.
    pub rigid_refitted: Apart,
    /// What [`controlled_rad`](Self::controlled_rad) leaves.
    pub controlled_refitted: Apart,
}

/// How far a model is from the measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apart {
    /// RMS error \[rad\]; `None` where the motion ran away.
    pub rms_rad: Option<f64>,
    /// First passage through the angle of rest, model less measurement \[s\]; `None` where there is none.
    pub first_swing_s: Option<f64>,
    /// Angle at rest, model less measurement \[rad\].
    pub rest_rad: Option<f64>,
}

/// Why the whole robot does not repeat the drops.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RepeatError {
    /// The robot has no such leg, or a value is impossible.
    #[error(transparent)]
    Simulate(Box<SimulateError>),
    /// No drop can be computed.
    #[error("no fit: {0}")]
    Rejected(#[from] Rejected),
}

impl From<SimulateError> for RepeatError {
    fn from(error: SimulateError) -> Self {
        Self::Simulate(Box::new(error))
    }
}

impl Repeated {
    /// Every log of a leg in the whole robot; `None` where the logs are not of an ERS-7 leg whose pose and masses are
    /// known.
    ///
    /// `robot` is the robot that drops, with the masses of the fit.
    ///
    /// # Errors
    /// [`RepeatError`].
    pub fn of(case: &Case, fit: &DropFit, robot: &Model) -> Result<Option<Self>, RepeatError> {
        let Some(leg) = case.leg.as_ref().filter(|leg| leg.pose_known && fit.by_bodies()) else { return Ok(None) };
        let fitted = fit.fitted.iter().zip(&fit.extensive.predictions);
        let all: Vec<(&Experiment, &Prediction)> = fitted.chain(fit.validated.iter().zip(&fit.predictions)).collect();
        let free = all.into_iter().filter(|(e, _)| !e.is_driven());
        let benches: Vec<Bench<'_>> =
            free.map(|(e, prediction)| Bench::of((case, robot), fit, leg, e, prediction)).collect();
        if benches.is_empty() {
            return Ok(None);
        }
        let swings = Swings::of(case, OF_EACH_LOAD)?;
        let compared = swings.as_ref().map(|swings| Compared::of(swings, true)).transpose()?;
        let refitted = swings.as_ref().zip(compared.as_ref());
        let drops: Vec<RepeatedDrop> =
            benches.par_iter().map(|bench| bench.answer(refitted)).collect::<Result<_, _>>()?;
        Ok(Some(Self { drops, compared }))
    }
}

/// A log with the drop that repeats it.
struct Bench<'a> {
    e: &'a Experiment,
    prediction: &'a Prediction,
    robot: &'a Model,
    /// With the fitted zero and the others rigid.
    drop: BenchDrop<'a>,
}

impl<'a> Bench<'a> {
    fn of(
        (case, robot): (&Case, &'a Model),
        fit: &DropFit,
        leg: &'a LegCase,
        e: &'a Experiment,
        prediction: &'a Prediction,
    ) -> Self {
        let value = |named: Named| fit.extensive.estimate(named).map(|e| e.value);
        let bodies = [LinkBody::Shoulder, LinkBody::UpperLeg, LinkBody::LowerLeg];
        let (model, values) = (&fit.extensive.model, &fit.extensive.found.values);
        let [coulomb_nm, viscous_nm_s_rad] = model.friction_at().map(|at| values[at]);
        let begins = e.t_s.first().copied().unwrap_or(0.0);
        let (release_s, rate_rad_s) = match e.release_window_s {
            Some(_) => (prediction.start[1], 0.0),
            None => (begins, prediction.start[1]),
        };
        let drop = BenchDrop {
            leg,
            extra: case.items.iter().find(|item| item.entry.file == e.file).and_then(|item| item.entry.extra),
            masses_kg: bodies.into_iter().filter_map(|body| Some((body, value(Named::Mass(body))?))).collect(),
            coulomb_nm,
            viscous_nm_s_rad,
            stribeck: model.stribeck_of(values),
            effects: Vec::new(),
            others: Vec::new(),
            zero_rad: value(Named::Zero).unwrap_or(0.0),
            angle_rad: prediction.start[0],
            rate_rad_s,
            release_s,
            held: Held::Rigid,
        };
        Self { e, prediction, robot, drop }
    }

    fn run(&self, held: Held) -> Result<Dropped, SimulateError> {
        let drop = BenchDrop { held, ..self.drop.clone() };
        bench_drop(self.robot, &drop, &self.e.t_s, Method::default())
    }

    fn answer(&self, refitted: Option<(&Swings<'_>, &Compared)>) -> Result<RepeatedDrop, SimulateError> {
        let e = self.e;
        let (rigid, controlled) = (self.run(Held::Rigid)?, self.run(Held::ByController)?);
        let (rigid_rad, controlled_rad) = match refitted.filter(|_| e.release_window_s.is_some()) {
            Some((swings, compared)) => {
                let readings = |hypothesis: &Hypothesis| hypothesis.readings(swings, e);
                (readings(&compared.rigid)?, readings(&compared.controlled)?)
            }
            None => (rigid.reading_rad.clone(), controlled.reading_rad.clone()),
        };
        Ok(RepeatedDrop {
            file: e.label(),
            t_s: e.t_s.clone(),
            measured_rad: e.measured_rad.clone(),
            first: e.uncompared,
            half_step_rad: 0.5 * e.resolution_rad,
            pendulum_rad: self.prediction.angle_rad.clone(),
            pendulum_rms_rad: self.prediction.rms_rad,
            rigid: Apart::of(e, &rigid.reading_rad),
            controlled: Apart::of(e, &controlled.reading_rad),
            give_rad: controlled.give_rad,
            rigid_refitted: Apart::of(e, &rigid_rad),
            controlled_refitted: Apart::of(e, &controlled_rad),
            rigid_rad,
            controlled_rad,
        })
    }
}

impl Apart {
    fn of(e: &Experiment, model_rad: &[f64]) -> Self {
        let squares = e.measured_rad.iter().zip(model_rad).skip(e.uncompared).map(|(q, model)| (q - model).powi(2));
        let rms = (squares.sum::<f64>() / e.compared().max(1) as f64).sqrt();
        let rest = |column: &[f64]| at_rest_rad(e, &column[e.uncompared..]);
        let rests = rest(&e.measured_rad);
        let passage = |column: &[f64]| {
            let begin = *column.first()? - rests;
            let k = column.iter().position(|q| (q - rests) * begin < 0.0).filter(|k| *k > 0)?;
            let (a, b) = (column[k - 1] - rests, column[k] - rests);
            Some(e.t_s[k - 1] + (e.t_s[k] - e.t_s[k - 1]) * a / (a - b))
        };
        let finite = |value: f64| value.is_finite().then_some(value);
        Self {
            rms_rad: finite(rms),
            first_swing_s: passage(model_rad).zip(passage(&e.measured_rad)).map(|(model, measured)| model - measured),
            rest_rad: finite(rest(model_rad) - rests),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::{Directives, DropOptions, fit_drop};
    use crate::progress::Silent;
    use std::path::Path;

    #[test]
    fn the_whole_robot_drops_with_every_friction_that_was_fitted() {
        let log = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/thesis-robot/q2-bare-0.csv");
        let case = Case::of_logs(&[log], None).unwrap();
        let held = [("coulomb", 0.005), ("static_excess", 0.004), ("stribeck_speed", 0.3)];
        let fix = held.map(|(name, value)| (name.to_owned(), Some(value))).to_vec();
        let options = DropOptions {
            stribeck: true,
            directives: Directives { fix, ..Directives::default() },
            ..DropOptions::default()
        };
        let fit = fit_drop(&case, &options, &Silent).unwrap();
        let (leg, e, prediction) = (case.leg.as_ref().unwrap(), &fit.fitted[0], &fit.extensive.predictions[0]);
        let drop = Bench::of((&case, Model::ers7()), &fit, leg, e, prediction).drop;
        assert_eq!(drop.coulomb_nm, 0.005);
        assert_eq!(drop.viscous_nm_s_rad, fit.extensive.estimate(Named::Viscous).unwrap().value);
        let stribeck = drop.stribeck.expect("the fit has a Stribeck part");
        approx::assert_relative_eq!(stribeck.static_nm, 0.009, max_relative = 1e-12);
        assert_eq!(stribeck.speed_rad_s, 0.3);
        assert_eq!(drop.masses_kg.len(), fit.extensive.model.friction_at()[0]);
    }
}
