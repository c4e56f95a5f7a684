//! What the report says in words: the sentence that opens it, and what the reader should not overlook.

use super::assemble::{is_relative, joint_rows, ratio_rows};
use super::number::{as_given, capital, mrad, significant};
use super::{ParameterRow, ParameterStatus, format_with_uncertainty};
use crate::fit::Stop;
use crate::geometry::{Ers7Tables, LinkBody};
use crate::identify::{Case, DropFit, Estimate, Experiment, Item, Named, Status, resting_gravity_nm};
use crate::log::{DriveMode, Start};

/// Correlation of residuals, in samples, from which on it is mentioned.
const CORRELATED_SAMPLES: f64 = 5.0;

/// The sentence a colleague would say.
pub(super) fn sentence(case: &Case, fit: &DropFit) -> String {
    let logs = fit.fitted.len();
    let floor = fit.fitted.iter().map(|e| e.resolution_rad / 12f64.sqrt()).fold(0.0, f64::max);
    let rounding = if floor > 0.0 { format!(" (rounding alone: {})", mrad(floor)) } else { String::new() };
    format!(
        "{}: {}; the extensive model follows {} to {} RMS{rounding}, the simple model to {}.",
        case.joint.name,
        friction_found(fit),
        if logs == 1 { "the log".to_owned() } else { format!("{logs} logs") },
        mrad(fit.extensive.rms_rad(&fit.fitted)),
        mrad(fit.simple_rms_rad()),
    )
}

/// What was found of the friction.
fn friction_found(fit: &DropFit) -> String {
    let words = |row: &ParameterRow, words: &str| {
        let f = format_with_uncertainty(row.value, row.interval?);
        Some(format!("{words} {} {} [{}, {}]", f.value, row.unit, f.low, f.high))
    };
    let of = |rows: &[ParameterRow], names: [&str; 2]| -> Vec<String> {
        let found = names.iter().zip(["Coulomb friction", "viscous friction"]).filter_map(|(name, friction)| {
            let row = rows.iter().find(|r| r.name == *name && r.status == ParameterStatus::Determined)?;
            words(row, friction)
        });
        found.collect()
    };
    let absolute = of(&joint_rows(fit), ["coulomb", "viscous"]);
    let relative = of(&ratio_rows(fit), ["coulomb_per_inertia", "viscous_per_inertia"]);
    match (absolute.is_empty(), relative.is_empty()) {
        (false, _) => absolute.join(" and "),
        (true, false) => format!("per unit of inertia, {}", relative.join(" and ")),
        (true, true) if fit.extensive.estimates.iter().any(|e| is_friction(e) && e.status == Status::Held) => {
            "friction held as given".to_owned()
        }
        (true, true) => "these logs do not determine the friction".to_owned(),
    }
}

fn is_friction(e: &Estimate) -> bool {
    matches!(e.named(), Some(Named::Coulomb | Named::Viscous))
}

fn is_mass(e: &Estimate) -> bool {
    matches!(e.named(), Some(Named::Mass(_)))
}

/// Honest messages, most important first.
pub(super) fn notes(case: &Case, fit: &DropFit) -> Vec<String> {
    let mut notes = fit.undetermined.clone();
    let open: Vec<&Estimate> = fit.extensive.estimates.iter().filter(|e| e.status == Status::NotDetermined).collect();
    if !is_relative(fit) {
        notes.extend(open_notes(case, fit, &open));
    } else if ratio_rows(fit).iter().any(|row| row.status == ParameterStatus::Determined) {
        notes.push(
            "These logs determine the moment and the frictions only in ratio to the inertia: free swings with one load \
             have no scale. A study with a nominal moment, a swing with a known extra mass, or a torque-driven log \
             gives it."
                .to_owned(),
        );
    } else {
        notes.push(
            "These logs hold too little motion to determine the joint. Let it swing from further out, or record longer."
                .to_owned(),
        );
    }
    notes.extend(fit.extensive.estimates.iter().filter(|e| is_friction(e) && on_zero(e)).map(|e| {
        format!(
            "{} ended on its bound of zero; without the bound it would be negative. Another law of friction would fit \
             these logs better.",
            capital(&words(&e.name))
        )
    }));
    notes.extend(misled(fit));
    notes.extend(contradicted(fit));
    notes.extend(correlated(fit));
    notes.extend(held_back(fit));
    notes.extend(held_out_in_turn(fit));
    notes.extend(match fit.extensive.stop() {
        Stop::Converged => None,
        Stop::NoFurtherDecrease => Some(
            "The optimiser ended where no step makes the criterion smaller, though its slope is not quite zero: sticking \
             makes the criterion kinked. The minimum may lie a little beside."
                .to_owned(),
        ),
        other => Some(format!("The optimiser stopped before it converged: {}.", other.words())),
    });
    if let Some(leg) = &case.leg
        && !leg.pose_known
    {
        notes.push(
            "No pose.toml stands beside the log: the rest of the leg is taken to be straight and the trunk level; the \
             hanging angle is estimated."
                .to_owned(),
        );
    }
    notes.extend(case.items.iter().filter(|i| i.log.len() < i.health.samples).map(|i| {
        format!(
            "{} is long: {} of its {} samples were fitted, evenly spaced while it moves, fewer at rest.",
            i.entry.file,
            i.log.len(),
            i.health.samples
        )
    }));
    notes.extend(case.items.iter().filter(|i| i.experiments.is_empty()).map(|i| still(case, i)));
    notes
}

fn on_zero(e: &Estimate) -> bool {
    e.status == Status::Determined && e.value == 0.0
}

/// The simple model, which believes nothing that is stated of the link, follows the logs much better.
fn misled(fit: &DropFit) -> Option<String> {
    let (simple, extensive) = (fit.simple_rms_rad(), fit.extensive.rms_rad(&fit.fitted));
    (extensive > MUCH_WORSE * simple).then(|| {
        format!(
            "The simple model follows these logs much better ({} against {} RMS): what is stated of the link contradicts \
             them. Check masses, extra mass, distance, pose and the joint's name.",
            mrad(simple),
            mrad(extensive)
        )
    })
}

/// Nominal values that the logs contradict, in one sentence.
fn contradicted(fit: &DropFit) -> Option<String> {
    let outside: Vec<String> = fit
        .extensive
        .estimates
        .iter()
        .filter(|e| e.named() != Some(Named::Zero))
        .filter_map(|e| {
            let ([low, high], nominal) = (e.interval?, e.nominal?);
            (!(low..=high).contains(&nominal)).then(|| {
                let found = format_with_uncertainty(e.value, [low, high]).value;
                format!(
                    "{} {} {} (found {found})",
                    words(&e.name).trim_start_matches("the "),
                    as_given(nominal),
                    e.unit
                )
            })
        })
        .collect();
    (!outside.is_empty()).then(|| format!("Nominal values outside their 95 % intervals: {}.", outside.join(", ")))
}

/// Residuals that are not white, by the log in which they are worst.
fn correlated(fit: &DropFit) -> Option<String> {
    let lengths = fit.extensive.uncertainty.correlation_length.iter().copied();
    let (e, samples) = fit.fitted.iter().zip(lengths).max_by(|a, b| a.1.total_cmp(&b.1))?;
    if !(samples > CORRELATED_SAMPLES) {
        return None;
    }
    let period_s = (e.t_s.last()? - e.t_s.first()?) / (e.t_s.len() - 1) as f64;
    Some(format!(
        "The residuals are correlated, over about {:.2} s in {}: the model lacks something that these logs show. The \
         95 % intervals allow for the correlation but not for the bias that comes with it; the naive intervals allow \
         for neither.",
        samples * period_s,
        e.file
    ))
}

/// How well each log is predicted from the others, where no log is held back.
fn held_out_in_turn(fit: &DropFit) -> Option<String> {
    let worst = fit.held_out_rms_rad.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let squares = fit.held_out_rms_rad.iter().zip(&fit.fitted).map(|(rms, e)| rms * rms * e.compared() as f64);
    let samples: usize = fit.fitted.iter().map(Experiment::compared).sum();
    Some(format!(
        "Each log predicted from the others alone: {} RMS, at worst {} in {}.",
        mrad((squares.sum::<f64>() / samples.max(1) as f64).sqrt()),
        mrad(worst.1),
        fit.fitted[worst.0].file
    ))
}

/// How many times larger an RMS has to be than what it is compared with to be mentioned.
const MUCH_WORSE: f64 = 2.0;

/// Held-back logs that the model does not predict as well as it follows the fitted ones.
fn held_back(fit: &DropFit) -> Option<String> {
    let samples: usize = fit.validated.iter().map(Experiment::compared).sum();
    let squares: f64 =
        fit.predictions.iter().zip(&fit.validated).map(|(p, e)| p.rms_rad.powi(2) * e.compared() as f64).sum();
    let (held_back, fitted) = ((squares / samples.max(1) as f64).sqrt(), fit.extensive.rms_rad(&fit.fitted));
    (held_back > MUCH_WORSE * fitted).then(|| {
        format!(
            "On the held-back logs the extensive model errs by {} RMS, on the fitted ones by {}: it does not carry over.",
            mrad(held_back),
            mrad(fitted)
        )
    })
}

/// What is not determined, and what was done about it.
fn open_notes(case: &Case, fit: &DropFit, open: &[&Estimate]) -> Vec<String> {
    let mut notes = Vec::new();
    if fit.by_bodies() {
        for e in open.iter().filter(|e| is_mass(e)) {
            let (why, what_follows) = if e.named() == Some(Named::Mass(LinkBody::Shoulder)) {
                (": it lies on the joint's axis", "which changes nothing that is shown")
            } else {
                ("", "and the rest is conditional on it")
            };
            // The table's value is given up where these logs contradict it.
            let left = match e.nominal.filter(|nominal| *nominal != e.value) {
                None => format!("It was left at Table A.2's {} kg, {what_follows}", as_given(e.value)),
                Some(nominal) => format!(
                    "The search left it at {} kg (Table A.2: {} kg), and the rest is conditional on it",
                    significant(e.value, 3),
                    as_given(nominal)
                ),
            };
            notes.push(format!("{} is not determined by these logs{why}. {left}.", capital(&words(&e.name))));
        }
    }
    let others: Vec<&Estimate> = open.iter().filter(|e| !is_mass(e)).copied().collect();
    let (scale, rest): (Vec<&Estimate>, Vec<&Estimate>) =
        others.into_iter().partition(|e| e.named() == Some(Named::Moment) && e.nominal == Some(e.value));
    if let Some(moment) = scale.first() {
        let source = if case.by_bodies { "Table A.2" } else { "the study" };
        let driven = fit.fitted.iter().any(Experiment::is_driven);
        let why = if driven { "" } else { " (free swings with one load show ratios only)" };
        notes.push(format!(
            "The moment is not determined by these logs{why}. It was held at {} {}, as {source} has it; inertia and \
             frictions are in proportion to it.",
            as_given(moment.value),
            moment.unit
        ));
    }
    if let Some((last, first)) = rest.split_last() {
        let last = words(&last.name);
        let first: Vec<String> = first.iter().map(|e| words(&e.name)).collect();
        let (names, verb) =
            if first.is_empty() { (last, "is") } else { (format!("{} and {last}", first.join(", ")), "are") };
        notes.push(format!(
            "{} {verb} not determined by these logs: a wide range of values explains them equally well.",
            capital(&names)
        ));
    }
    notes
}

/// A parameter in words.
fn words(name: &str) -> String {
    match Named::of(name) {
        Some(Named::Coulomb) => "Coulomb friction".into(),
        Some(Named::Viscous) => "viscous friction".into(),
        Some(Named::Rest) => "the hanging angle".into(),
        Some(Named::Zero) => "the encoder's zero".into(),
        Some(Named::StaticExcess) => "static friction above Coulomb's".into(),
        Some(Named::StribeckSpeed) => "the Stribeck speed".into(),
        Some(Named::Inertia | Named::Moment) => format!("the {name}"),
        Some(Named::Mass(body)) => format!("the {body} mass"),
        Some(Named::Ml2 | Named::BOverMl2 | Named::GOverL) | None => name.into(),
    }
}

/// What a log says in which nothing moves: at least how large the breakaway friction is.
pub fn still(case: &Case, item: &Item) -> String {
    let (file, health) = (&item.entry.file, &item.health);
    if health.start == Start::AlwaysHeld {
        return format!("{file}: the joint is held throughout (column drive is 1): there is no swing to fit.");
    }
    if item.entry.drive != DriveMode::Off {
        return format!("{file}: the joint never moves, although it is driven: check `drive`, setpoint and torque.");
    }
    let step = item.sensor.resolution_rad.or(health.step_rad).unwrap_or(0.0);
    if health.span_rad > 3.0 * step.max(1e-3) {
        return format!(
            "{file}: no motion stands out: the readings vary by {} or less, which their scatter of {} explains.",
            mrad(health.span_rad),
            mrad(health.noise_rad)
        );
    }
    let mut text = format!("{file}: the joint never moves: friction holds it.");
    let Some(gravity) = resting_gravity_nm(case, item) else { return text };
    text += &format!(
        " Gravity pulls with {gravity:.4} N m there by the nominal model, so its breakaway friction is at least that."
    );
    if let Some(leg) = &case.leg {
        let tables = &Ers7Tables::embedded().friction;
        let [estimated, chosen] = [&tables.estimated, &tables.chosen].map(|table| table.of(leg.joint).0);
        if estimated != chosen {
            text += &tables_say(estimated, chosen, gravity, leg.bare().ok().map(|b| b.moment_kg_m * b.gravity_m_s2));
        }
    }
    text
}

/// What the two frictions of the thesis mean for a joint that does not move; the gravity torque is at most `steepest`.
fn tables_say(estimated: f64, chosen: f64, gravity: f64, steepest: Option<f64>) -> String {
    let holds = |mu_c: f64| if mu_c >= gravity { "would hold it" } else { "would let it swing" };
    let mut text = if holds(estimated) == holds(chosen) {
        format!(" Both Table 3.3's {estimated:.3} N m and Table 3.4's {chosen:.3} N m {}.", holds(chosen))
    } else {
        format!(" Table 3.3's {estimated:.3} N m {}, Table 3.4's {chosen:.3} N m {}.", holds(estimated), holds(chosen))
    };
    if let Some(steepest) = steepest.filter(|s| gravity <= chosen && chosen < *s && *s <= estimated) {
        text += &format!(
            " Let go level, where gravity pulls with {steepest:.4} N m, the bare link would swing with the latter only."
        );
    }
    text
}
