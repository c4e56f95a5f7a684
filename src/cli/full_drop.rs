//! The fitted drop repeated by the whole robot.

use super::CliError;
use crate::geometry::LinkBody;
use crate::identify::{Case, DropError, DropFit, Experiment, LegCase, Prediction};
use crate::joint::Stribeck;
use crate::report::{FullCurves, FullDrop, FullRow, HeldRow, RefitSummary};
use crate::robot::Model;
use crate::robot::bench::{BenchDrop, Dropped, Held, bench_drop};
use crate::robot::refit::{BenchLogs, Refit, Refits};
use crate::robot::simulate::Method;
use rayon::prelude::*;

/// Span at the end of a log over which its angle of rest is the mean \[s\].
const REST_S: f64 = 0.3;

/// Swings with each extra mass that are refitted.
const OF_EACH_LOAD: usize = 2;

/// Every log of a leg in the full model; `None` where the logs are not of an ERS-7 leg whose pose and masses are known.
///
/// `robot` is the robot that drops, with the masses of the fit.
pub(super) fn full_drop(case: &Case, fit: &DropFit, robot: &Model) -> Result<Option<FullDrop>, CliError> {
    let Some(leg) = case.leg.as_ref().filter(|leg| leg.pose_known && fit.by_bodies()) else { return Ok(None) };
    let fitted = fit.fitted.iter().zip(&fit.extensive.predictions);
    let all: Vec<(&Experiment, &Prediction)> = fitted.chain(fit.validated.iter().zip(&fit.predictions)).collect();
    let free = all.into_iter().filter(|(e, _)| !e.is_driven());
    let benches: Vec<Bench<'_>> =
        free.map(|(e, prediction)| Bench::of((case, robot), fit, leg, e, prediction)).collect();
    if benches.is_empty() {
        return Ok(None);
    }
    let logs = BenchLogs::of(case, OF_EACH_LOAD)?;
    let refits = logs.as_ref().map(|logs| Refits::of(logs, true).map_err(DropError::from)).transpose()?;
    let refitted = logs.as_ref().zip(refits.as_ref());
    let answers: Vec<(FullRow, FullCurves)> =
        benches.par_iter().map(|bench| bench.answer(refitted)).collect::<Result<_, _>>()?;
    let (rows, curves) = answers.into_iter().unzip();
    Ok(Some(FullDrop { rows, curves, refit: refits.as_ref().map(RefitSummary::of) }))
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
        let value = |name: &str| fit.extensive.estimate(name).map(|e| e.value);
        let bodies = [
            ("mass_shoulder", LinkBody::Shoulder),
            ("mass_upper_leg", LinkBody::UpperLeg),
            ("mass_lower_leg", LinkBody::LowerLeg),
        ];
        let coulomb_nm = value("coulomb").unwrap_or(0.0);
        let stribeck = value("static_excess").zip(value("v_st")).map(|(excess, speed_rad_s)| Stribeck {
            static_nm: coulomb_nm + excess,
            speed_rad_s,
            curve: Default::default(),
        });
        let begins = e.t_s.first().copied().unwrap_or(0.0);
        let (release_s, rate_rad_s) = match e.release_window_s {
            Some(_) => (prediction.start[1], 0.0),
            None => (begins, prediction.start[1]),
        };
        let drop = BenchDrop {
            leg,
            extra: case.items.iter().find(|item| item.entry.file == e.file).and_then(|item| item.entry.extra),
            masses_kg: bodies.into_iter().filter_map(|(name, body)| Some((body, value(name)?))).collect(),
            coulomb_nm,
            viscous_nm_s_rad: value("viscous").unwrap_or(0.0),
            stribeck,
            effects: Vec::new(),
            others: Vec::new(),
            zero_rad: value("zero").unwrap_or(0.0),
            angle_rad: prediction.start[0],
            rate_rad_s,
            release_s,
            held: Held::Rigid,
        };
        Self { e, prediction, robot, drop }
    }

    fn run(&self, held: Held) -> Result<Dropped, CliError> {
        let drop = BenchDrop { held, ..self.drop.clone() };
        Ok(bench_drop(self.robot, &drop, &self.e.t_s, Method::default())?)
    }

    fn answer(&self, refitted: Option<(&BenchLogs<'_>, &Refits)>) -> Result<(FullRow, FullCurves), CliError> {
        let e = self.e;
        let (rigid, controlled) = (self.run(Held::Rigid)?, self.run(Held::ByController)?);
        let (rigid_rad, controlled_rad) = match refitted.filter(|_| e.release_window_s.is_some()) {
            Some((logs, refits)) => {
                let readings = |refit: &Refit| refit.readings(logs, e, self.drop.extra);
                (readings(&refits.rigid)?, readings(&refits.controlled)?)
            }
            None => (rigid.reading_rad.clone(), controlled.reading_rad.clone()),
        };
        let row = FullRow {
            file: e.label(),
            pendulum_rms: self.prediction.rms_rad,
            rigid: held_row(e, &rigid.reading_rad),
            controlled: held_row(e, &controlled.reading_rad),
            give: controlled.give_rad,
            rigid_refitted: held_row(e, &rigid_rad),
            controlled_refitted: held_row(e, &controlled_rad),
        };
        let curves = FullCurves {
            file: e.label(),
            t_s: e.t_s.clone(),
            measured_rad: e.measured_rad.clone(),
            first: e.uncompared,
            pendulum_rad: self.prediction.angle_rad.clone(),
            rigid_rad,
            controlled_rad,
            half_step_rad: 0.5 * e.resolution_rad,
        };
        Ok((row, curves))
    }
}

fn held_row(e: &Experiment, model_rad: &[f64]) -> HeldRow {
    let squares = e.measured_rad.iter().zip(model_rad).skip(e.uncompared).map(|(q, model)| (q - model).powi(2));
    let rms = (squares.sum::<f64>() / e.compared().max(1) as f64).sqrt();
    let rest = |column: &[f64]| {
        let end = e.t_s.last().copied().unwrap_or(0.0);
        let last: Vec<f64> = column.iter().zip(&e.t_s).filter(|(_, t)| **t >= end - REST_S).map(|(q, _)| *q).collect();
        last.iter().sum::<f64>() / last.len().max(1) as f64
    };
    let rests = rest(&e.measured_rad);
    let passage = |column: &[f64]| {
        let begin = *column.first()? - rests;
        let k = column.iter().position(|q| (q - rests) * begin < 0.0).filter(|k| *k > 0)?;
        let (a, b) = (column[k - 1] - rests, column[k] - rests);
        Some(e.t_s[k - 1] + (e.t_s[k] - e.t_s[k - 1]) * a / (a - b))
    };
    let finite = |value: f64| value.is_finite().then_some(value);
    HeldRow {
        rms: finite(rms),
        first_swing: passage(model_rad).zip(passage(&e.measured_rad)).map(|(model, measured)| model - measured),
        rest: finite(rest(model_rad) - rests),
    }
}
