//! Parameters of a diagnosis as rows of the tables that every report has.

use crate::gap::{Diagnosis, LogTraces, Number};
use crate::joint::EffectId;
use crate::report::assemble::row;
use crate::report::{ParameterRow, ParameterStatus};

/// A parameter of an effect. Without an interval the logs do not determine it; a side was chosen, not estimated.
pub(super) fn number_row(number: &Number) -> ParameterRow {
    ParameterRow {
        name: number.name.clone(),
        symbol: String::new(),
        unit: number.unit.clone(),
        status: match number.interval {
            Some(_) => ParameterStatus::Determined,
            None if is_side(number) => ParameterStatus::Held,
            None => ParameterStatus::NotDetermined,
        },
        value: number.value,
        interval: number.interval,
        interval_naive: number.interval_naive,
        nominal: None,
    }
}

/// A plain +1 or -1.
pub(super) fn is_side(number: &Number) -> bool {
    number.unit.is_empty() && number.value.abs() == 1.0
}

/// The joint's parameters.
pub(super) fn joint_rows(diagnosis: &Diagnosis) -> Vec<ParameterRow> {
    diagnosis.parameters.iter().map(row).collect()
}

/// The parameters of the effects of the answer, with the effect in the name.
pub(super) fn effect_rows(diagnosis: &Diagnosis) -> Vec<ParameterRow> {
    let of_effect = |(effect, numbers): &(EffectId, Vec<Number>)| {
        let named = |number: &Number| {
            let mut row = ParameterRow { name: format!("{effect} {}", number.name), ..number_row(number) };
            let held = format!("{effect}.{}", number.name);
            if diagnosis.demands.fix.iter().any(|(name, _)| *name == held) {
                row.status = ParameterStatus::Held;
            }
            row
        };
        numbers.iter().map(named).collect::<Vec<_>>()
    };
    diagnosis.effect_parameters.iter().flat_map(of_effect).collect()
}

/// RMS of readings minus model over the samples that have both \[rad\]; NaN where there are none.
pub(super) fn residual_rms_rad(log: &LogTraces, model_rad: &[f64]) -> f64 {
    let squares = log.measured_rad.iter().zip(model_rad).map(|(measured, model)| (measured - model).powi(2));
    let add = |(sum, count): (f64, f64), square: f64| (sum + square, count + 1.0);
    let (sum, count) = squares.filter(|square| square.is_finite()).fold((0.0, 0.0), add);
    (sum / count).sqrt()
}
