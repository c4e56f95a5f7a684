//! The fitted drop repeated by the whole robot.

use super::CliError;
use crate::geometry::LinkBody;
use crate::identify::{Case, DropFit, Experiment, LegCase, Prediction};
use crate::joint::Stribeck;
use crate::report::{FullCurves, FullDrop, FullRow, HeldRow};
use crate::robot::Model;
use crate::robot::bench::{BenchDrop, Dropped, Held, bench_drop};
use crate::robot::simulate::Method;
use rayon::prelude::*;

/// Span at the end of a log over which its angle of rest is the mean \[s\].
const REST_S: f64 = 0.3;

/// Steps of the search for the zero; it converges like Newton's.
const ZERO_STEPS: usize = 3;
/// The zero is moved by this much to see what that does \[rad\].
const NUDGE_RAD: f64 = 2e-3;

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
    let zero_rad = benches[0].drop.zero_rad;
    let refitted_rad = refitted(&benches, zero_rad)?;
    let answers: Vec<(FullRow, FullCurves)> =
        benches.par_iter().map(|bench| bench.answer(refitted_rad)).collect::<Result<_, _>>()?;
    let (rows, curves) = answers.into_iter().unzip();
    Ok(Some(FullDrop { rows, curves, zero_rad, refitted_rad }))
}

/// The encoder's zero that suits the robot whose joints give \[rad\].
///
/// A zero that was fitted with rigid joints has taken in how far the others droop; only with this one do "rigid" and "by
/// PID" differ by what the held joints do. Newton's method on the sum of squares, all else as fitted.
fn refitted(benches: &[Bench<'_>], fitted_rad: f64) -> Result<f64, CliError> {
    let mut zero_rad = fitted_rad;
    for _ in 0..ZERO_STEPS {
        let sums = |bench: &Bench<'_>| -> Result<[f64; 2], CliError> {
            let low = bench.run(Held::ByController, zero_rad - NUDGE_RAD)?.reading_rad;
            let high = bench.run(Held::ByController, zero_rad + NUDGE_RAD)?.reading_rad;
            let both = low.iter().zip(&high).zip(&bench.e.measured_rad).skip(bench.e.uncompared);
            let terms =
                both.map(|((low, high), measured)| (measured - 0.5 * (low + high), (high - low) / (2.0 * NUDGE_RAD)));
            let finite = terms.filter(|(error, slope)| error.is_finite() && slope.is_finite());
            Ok(finite.fold([0.0, 0.0], |[a, b], (error, slope)| [a + error * slope, b + slope * slope]))
        };
        let by_log: Vec<[f64; 2]> = benches.par_iter().map(sums).collect::<Result<_, _>>()?;
        let [a, b] = by_log.iter().fold([0.0, 0.0], |[a, b], [c, d]| [a + c, b + d]);
        if !(b > 0.0) {
            break;
        }
        zero_rad += (a / b).clamp(-0.1, 0.1);
    }
    Ok(zero_rad)
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
        let stribeck = value("static_excess")
            .zip(value("v_st"))
            .map(|(excess, speed_rad_s)| Stribeck { static_nm: coulomb_nm + excess, speed_rad_s });
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
            zero_rad: value("zero").unwrap_or(0.0),
            angle_rad: prediction.start[0],
            rate_rad_s,
            release_s,
            held: Held::Rigid,
        };
        Self { e, prediction, robot, drop }
    }

    fn run(&self, held: Held, zero_rad: f64) -> Result<Dropped, CliError> {
        let drop = BenchDrop { held, zero_rad, ..self.drop.clone() };
        Ok(bench_drop(self.robot, &drop, &self.e.t_s, Method::default())?)
    }

    fn answer(&self, refitted_rad: f64) -> Result<(FullRow, FullCurves), CliError> {
        let e = self.e;
        let fitted_rad = self.drop.zero_rad;
        let row = |dropped: &Dropped| held_row(e, &dropped.reading_rad);
        let controlled = self.run(Held::ByController, fitted_rad)?;
        let (rigid_apart, controlled_apart) =
            (self.run(Held::Rigid, refitted_rad)?, self.run(Held::ByController, refitted_rad)?);
        let row = FullRow {
            file: e.file.clone(),
            pendulum_rms: self.prediction.rms_rad,
            rigid: row(&self.run(Held::Rigid, fitted_rad)?),
            controlled: row(&controlled),
            give: controlled.give_rad,
            zero_apart: refitted_rad,
            rigid_apart: row(&rigid_apart),
            controlled_apart: row(&controlled_apart),
        };
        let curves = FullCurves {
            file: e.file.clone(),
            t_s: e.t_s.clone(),
            measured_rad: e.measured_rad.clone(),
            first: e.uncompared,
            pendulum_rad: self.prediction.angle_rad.clone(),
            rigid_rad: rigid_apart.reading_rad,
            controlled_rad: controlled_apart.reading_rad,
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
