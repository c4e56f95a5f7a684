//! From a fit to what is shown of it.

use super::data_health::health_rows;
use super::notes::{notes, sentence};
use super::{
    Correlation, DropReport, FrictionPoint, LogCurves, ModelSummary, ParameterRow, ParameterStatus, Provenance,
};
use crate::fit::Stop;
use crate::identify::{Case, DropFit, Estimate, Experiment, Fitted, Item, JointModel, Named, Prediction, Status};
use crate::log::Role;

/// Everything the report of a drop shows.
pub fn drop_report(case: &Case, fit: &DropFit, provenance: Provenance) -> DropReport {
    let extensive = &fit.extensive;
    let names = extensive.free.iter().map(|&i| extensive.model.parameters()[i].name.clone());
    let mut report = DropReport {
        joint: case.joint.name.clone(),
        sentence: sentence(case, fit),
        notes: notes(case, fit),
        beliefs: fit.beliefs.clone(),
        undetermined: fit.undetermined.clone(),
        health: health_rows(case),
        logs: logs(case, fit),
        models: vec![simple_summary(fit), extensive_summary(fit)],
        correlation: Correlation { names: names.collect(), matrix: extensive.correlation() },
        friction: friction_curve(fit),
        full: None,
        provenance,
    };
    if is_relative(fit) {
        // Per unit of inertia a friction torque has no scale to be drawn on.
        report.friction.clear();
    }
    report
}

/// True where the logs determine ratios to the inertia only, and no nominal value gives the scale.
pub(super) fn is_relative(fit: &DropFit) -> bool {
    let inertia = fit.extensive.estimate(Named::Inertia);
    inertia.is_some_and(|e| e.status == Status::NotDetermined && e.nominal.is_none() && e.value == 1.0)
}

fn status(status: Status) -> ParameterStatus {
    match status {
        Status::Determined => ParameterStatus::Determined,
        Status::Held => ParameterStatus::Held,
        Status::NotDetermined => ParameterStatus::NotDetermined,
    }
}

/// An estimate as a row of the tables.
pub(super) fn row(e: &Estimate) -> ParameterRow {
    ParameterRow {
        name: e.name.clone(),
        symbol: e.symbol.clone(),
        unit: e.unit.clone(),
        status: status(e.status),
        value: e.value,
        interval: e.interval,
        interval_naive: e.interval_naive,
        nominal: e.nominal,
    }
}

/// A row for a function of the parameters.
fn derived_row(
    fit: &DropFit,
    (name, symbol, unit): (&str, &str, &str),
    determined: bool,
    function: impl Fn(&[f64]) -> f64,
) -> ParameterRow {
    let (value, interval, naive) = fit.extensive.derived(function);
    let determined = determined && interval[1] - interval[0] > 1e-9 * value.abs();
    ParameterRow {
        name: name.into(),
        symbol: symbol.into(),
        unit: unit.into(),
        status: if determined { ParameterStatus::Determined } else { ParameterStatus::Held },
        value,
        interval: determined.then_some(interval),
        interval_naive: determined.then_some(naive),
        nominal: None,
    }
}

/// Inertia, moment, frictions and rest angle of the bare link, whatever parameters they were written by.
pub(super) fn joint_rows(fit: &DropFit) -> Vec<ParameterRow> {
    let mut rows: Vec<ParameterRow> = fit.extensive.estimates.iter().map(row).collect();
    if fit.by_bodies() {
        let is_determined = |which: fn(Named) -> bool| {
            let mut those = fit.extensive.estimates.iter().filter(|e| e.named().is_some_and(which));
            those.any(|e| e.status == Status::Determined)
        };
        let masses = is_determined(|named| matches!(named, Named::Mass(_)));
        rows.push(derived_row(fit, ("inertia", "I*", "kg m^2"), masses, |v| fit.bare_link(v)[0]));
        rows.push(derived_row(fit, ("moment", "M*", "kg m"), masses, |v| fit.bare_link(v)[1]));
        let rest = masses || is_determined(|named| named == Named::Zero);
        rows.push(derived_row(fit, ("rest", "q_rest", "rad"), rest, |v| fit.bare_link(v)[2]));
    }
    if is_relative(fit) {
        for row in rows.iter_mut().filter(|row| row.name != "rest") {
            row.status = ParameterStatus::NotDetermined;
            row.value = f64::NAN;
            (row.interval, row.interval_naive) = (None, None);
        }
    }
    rows
}

/// Ratios to the inertia, where nothing else is determined.
pub(super) fn ratio_rows(fit: &DropFit) -> Vec<ParameterRow> {
    if !is_relative(fit) {
        return Vec::new();
    }
    let names = [
        (Named::Moment, "moment_per_inertia", "M*/I*", "1/m"),
        (Named::Coulomb, "coulomb_per_inertia", "mu_c/I*", "1/s^2"),
        (Named::Viscous, "viscous_per_inertia", "mu_v/I*", "1/s"),
    ];
    names
        .iter()
        .filter_map(|(named, ratio, symbol, unit)| {
            let e = fit.extensive.estimate(*named)?;
            Some(ParameterRow {
                name: (*ratio).into(),
                symbol: (*symbol).into(),
                unit: (*unit).into(),
                nominal: None,
                ..row(e)
            })
        })
        .collect()
}

/// `mu_st` and `v_st` by the catalogue's names, where the friction law has a Stribeck part.
pub(super) fn stribeck_rows(fit: &DropFit) -> Vec<ParameterRow> {
    let model = &fit.extensive.model;
    let index = |named: Named| model.parameters().iter().position(|p| p.named() == Some(named));
    let (Some(coulomb), Some(excess), Some(speed)) =
        (index(Named::Coulomb), index(Named::StaticExcess), index(Named::StribeckSpeed))
    else {
        return Vec::new();
    };
    let determined = fit.extensive.estimates[excess].status == Status::Determined;
    let mu_st = derived_row(fit, ("mu_st", "mu_st", "N m"), determined, |v| v[coulomb] + v[excess]);
    let v_st = ParameterRow { name: "v_st".into(), ..row(&fit.extensive.estimates[speed]) };
    vec![mu_st, v_st]
}

pub(super) fn role(role: Role) -> String {
    match role {
        Role::Fit => "fit".into(),
        Role::Validate => "validate".into(),
    }
}

/// Curves of every log that moves, in the case's order; one for each part of a log with holes.
fn logs(case: &Case, fit: &DropFit) -> Vec<LogCurves> {
    let (mut fitted, mut validated) = (0, 0);
    let mut curves = Vec::new();
    for item in case.items.iter().flat_map(|item| item.experiments.iter().map(move |_| item)) {
        match item.entry.role {
            Role::Fit => {
                let group = fit.simple.iter().find_map(|g| {
                    let at = g.experiments.iter().position(|&k| k == fitted)?;
                    Some(&g.fitted.predictions[at])
                });
                curves.push(log_curves(item, &fit.fitted[fitted], group, &fit.extensive.predictions[fitted]));
                fitted += 1;
            }
            Role::Validate => {
                let simple = fit.simple_predictions[validated].as_ref();
                curves.push(log_curves(item, &fit.validated[validated], simple, &fit.predictions[validated]));
                validated += 1;
            }
        }
    }
    curves
}

fn log_curves(item: &Item, e: &Experiment, simple: Option<&Prediction>, extensive: &Prediction) -> LogCurves {
    // Of a log with holes each part is drawn by itself, the first with what was held before it.
    let shown = match e.part {
        0 => 0..item.log.len(),
        1 => 0..e.first_sample + e.t_s.len(),
        _ => e.first_sample..e.first_sample + e.t_s.len(),
    };
    let n = shown.len();
    let begins = e.first_sample - shown.start;
    let first = begins + e.uncompared;
    let spread = |values: &[f64]| {
        let mut all = vec![f64::NAN; n];
        all[first..begins + values.len()].copy_from_slice(&values[e.uncompared..]);
        all
    };
    let t0 = item.log.t_s[0];
    LogCurves {
        file: e.label(),
        role: role(item.entry.role),
        t_s: item.log.t_s[shown.clone()].iter().map(|t| t - t0).collect(),
        measured_rad: item.log.q_rad[shown.clone()].to_vec(),
        first_fitted: first,
        release_s: item.health.start.held().filter(|_| e.part <= 1).map(|held| held.release_s),
        simple_rad: simple.map_or_else(|| vec![f64::NAN; n], |p| spread(&p.angle_rad)),
        extensive_rad: spread(&extensive.angle_rad),
        extensive_rate_rad_s: spread(&extensive.rate_rad_s),
        setpoint_rad: item.log.q_ref_rad.as_ref().filter(|_| e.is_driven()).map(|q_ref| q_ref[shown].to_vec()),
        half_step_rad: 0.5 * e.resolution_rad,
        simple_rms_rad: simple.map_or(f64::NAN, |p| p.rms_rad),
        extensive_rms_rad: extensive.rms_rad,
    }
}

/// All loads' simple fits as one summary; with several loads a parameter's name carries its load.
fn simple_summary(fit: &DropFit) -> ModelSummary {
    let several = fit.simple.len() > 1;
    let mut parameters = Vec::new();
    let (mut criterion, mut evaluations) = (0.0, 0);
    let mut trace: Vec<f64> = Vec::new();
    for group in &fit.simple {
        for e in &group.fitted.estimates {
            if e.named() == Some(Named::Ml2) && e.status == Status::Held {
                continue;
            }
            let mut row = row(e);
            if several {
                row.name = format!("{} ({})", row.name, group.load);
            }
            parameters.push(row);
        }
        for prediction in &group.fitted.predictions {
            criterion += prediction.criterion_rad2_s;
        }
        evaluations += group.fitted.found.solution.evaluations;
        add_trace(&mut trace, &group.fitted.found.solution.trace);
    }
    let stop = fit.simple.iter().map(|g| g.fitted.stop()).find(|s| *s != Stop::Converged).unwrap_or(Stop::Converged);
    ModelSummary {
        name: "simple (3.2)".into(),
        rms_rad: fit.simple_rms_rad(),
        criterion_rad2_s: criterion,
        parameters,
        method: fit.extensive.method.name().into(),
        stop: stop.words().into(),
        evaluations,
        trace_rad2_s: trace,
    }
}

/// Sums traces that end at different iterations: a search that has ended stays where it ended.
fn add_trace(sum: &mut Vec<f64>, trace: &[f64]) {
    let ended = |trace: &[f64]| trace.last().copied().unwrap_or(0.0);
    let (sum_end, trace_end) = (ended(sum), ended(trace));
    for i in 0..sum.len().max(trace.len()) {
        let add = trace.get(i).copied().unwrap_or(trace_end);
        match sum.get_mut(i) {
            Some(s) => *s += add,
            None => sum.push(sum_end + add),
        }
    }
}

fn extensive_summary(fit: &DropFit) -> ModelSummary {
    let Fitted { found, method, predictions, .. } = &fit.extensive;
    let rows = joint_rows(fit);
    let mut parameters: Vec<ParameterRow> = rows.into_iter().filter(|r| !r.name.is_empty()).collect();
    parameters.extend(ratio_rows(fit));
    parameters.extend(stribeck_rows(fit));
    ModelSummary {
        name: "extensive (3.13)".into(),
        rms_rad: fit.extensive.rms_rad(&fit.fitted),
        criterion_rad2_s: predictions.iter().map(|p| p.criterion_rad2_s).sum(),
        parameters,
        method: method.name().into(),
        stop: found.solution.stop.words().into(),
        evaluations: found.solution.evaluations,
        trace_rad2_s: found.solution.trace.clone(),
    }
}

/// Points of the friction-speed curve, either way.
const FRICTION_POINTS: i32 = 60;

fn friction_curve(fit: &DropFit) -> Vec<FrictionPoint> {
    let model = &fit.extensive.model;
    let [c, v] = model.friction_at();
    let open = |i: usize| fit.extensive.estimates[i].status == Status::NotDetermined;
    if open(c) || open(v) {
        return Vec::new();
    }
    let rates = fit.extensive.predictions.iter().flat_map(|p| &p.rate_rad_s);
    let fastest = rates.fold(0.0_f64, |fastest, rate| fastest.max(rate.abs()));
    if fastest == 0.0 {
        return Vec::new();
    }
    let Some(e) = fit.fitted.first() else { return Vec::new() };
    (-FRICTION_POINTS..=FRICTION_POINTS)
        .filter(|&i| i != 0)
        .map(|i| {
            let rate_rad_s = fastest * f64::from(i) / f64::from(FRICTION_POINTS);
            let (torque_nm, [low_nm, high_nm], _) = fit.extensive.derived(|values| {
                let chain = model.chain(values, e);
                let at = crate::joint::Contact {
                    t_s: 0.0,
                    angle_rad: 0.0,
                    speed_rad_s: rate_rad_s.abs(),
                    direction: rate_rad_s.signum(),
                    gravity_nm: 0.0,
                    motor_nm: 0.0,
                };
                rate_rad_s.signum() * chain.friction.resistance_nm(&at)
            });
            FrictionPoint { rate_rad_s, torque_nm, low_nm, high_nm }
        })
        .collect()
}
