//! What the report says in words: the sentence that opens it, and what the reader should not overlook.

use super::assemble::is_relative;
use super::format_with_uncertainty;
use crate::fit::Stop;
use crate::geometry::Ers7Tables;
use crate::identify::{Case, DropFit, Estimate, Item, Status};
use crate::joint::Link;
use crate::log::Start;

/// Correlation of residuals, in samples, from which on it is mentioned.
const CORRELATED_SAMPLES: f64 = 5.0;

fn with_interval(e: &Estimate) -> Option<String> {
    let interval = e.interval?;
    let f = format_with_uncertainty(e.value, interval);
    Some(format!("{} {} [{}, {}]", f.value, e.unit, f.low, f.high))
}

fn mrad(rad: f64) -> String {
    if rad < 0.01 { format!("{:.2} mrad", 1e3 * rad) } else { format!("{:.1} mrad", 1e3 * rad) }
}

/// The sentence a colleague would say.
pub(super) fn sentence(case: &Case, fit: &DropFit) -> String {
    let logs = fit.fitted.len();
    let friction: Vec<String> = [("coulomb", "Coulomb friction"), ("viscous", "viscous friction")]
        .iter()
        .filter_map(|(name, words)| {
            let e = fit.extensive.estimate(name)?;
            (!is_relative(fit)).then(|| with_interval(e)).flatten().map(|text| format!("{words} {text}"))
        })
        .collect();
    let found = match friction.len() {
        0 => "the logs determine ratios to the inertia only".to_owned(),
        _ => friction.join(" and "),
    };
    let floor = fit.fitted.iter().map(|e| e.resolution_rad / 12f64.sqrt()).fold(0.0, f64::max);
    let rounding = if floor > 0.0 { format!(" (rounding alone: {})", mrad(floor)) } else { String::new() };
    format!(
        "{}: {found}; the extensive model follows {} to {} RMS{rounding}, the simple model to {}.",
        case.joint.name,
        if logs == 1 { "the log".to_owned() } else { format!("{logs} logs") },
        mrad(fit.extensive.rms_rad(&fit.fitted)),
        mrad(simple_rms(fit)),
    )
}

fn simple_rms(fit: &DropFit) -> f64 {
    let (mut squares, mut samples) = (0.0, 0);
    for group in &fit.simple {
        for (p, &k) in group.fitted.predictions.iter().zip(&group.experiments) {
            squares += p.rms_rad.powi(2) * fit.fitted[k].compared() as f64;
            samples += fit.fitted[k].compared();
        }
    }
    (squares / samples.max(1) as f64).sqrt()
}

/// Honest messages, most important first.
pub(super) fn notes(case: &Case, fit: &DropFit) -> Vec<String> {
    let mut notes = Vec::new();
    let open: Vec<&Estimate> = fit.extensive.estimates.iter().filter(|e| e.status == Status::NotDetermined).collect();
    if is_relative(fit) {
        notes.push(
            "These logs determine the moment and the frictions only in ratio to the inertia: free swings with one load \
             have no scale. A study with a nominal moment, a swing with a known extra mass, or a torque-driven log \
             gives it."
                .to_owned(),
        );
    } else {
        notes.extend(open_notes(case, fit, &open));
    }
    for e in &fit.extensive.estimates {
        if e.status == Status::Determined && e.value == 0.0 && e.unit != "rad" {
            notes.push(format!(
                "{} is at its bound of zero: the logs would rather have it negative.",
                capital(&words(&e.name))
            ));
        }
        if let (Some(nominal), Some([low, high])) = (e.nominal, e.interval)
            && !(low..=high).contains(&nominal)
            && e.name != "zero"
        {
            notes.push(format!(
                "{} came out as {} {unit}; the {} {unit} that was believed lies outside its interval.",
                capital(&words(&e.name)),
                format_with_uncertainty(e.value, [low, high]).value,
                crate::report::number::significant(nominal, 4),
                unit = e.unit
            ));
        }
    }
    let longest = fit.extensive.uncertainty.correlation_length.iter().copied().fold(0.0, f64::max);
    if longest > CORRELATED_SAMPLES {
        notes.push(format!(
            "The residuals hang together over about {longest:.0} samples: the model lacks something that these logs \
             show. The 95 % intervals allow for that; the naive ones do not. No interval allows for the bias it causes."
        ));
    }
    if fit.extensive.stop() != Stop::Converged {
        notes.push(format!("The optimiser stopped before it converged: {}.", fit.extensive.stop().words()));
    }
    if let Some(leg) = &case.leg
        && !leg.pose_known
    {
        notes.push(
            "No pose.toml stands beside the log: the rest of the leg is taken to be straight and the trunk level; the \
             hanging angle is estimated."
                .to_owned(),
        );
    }
    notes.extend(case.items.iter().filter(|i| i.experiment.is_none()).map(|i| still(case, i)));
    notes
}

/// What is not determined, and what was done about it.
fn open_notes(case: &Case, fit: &DropFit, open: &[&Estimate]) -> Vec<String> {
    let mut notes = Vec::new();
    if fit.by_bodies() {
        for e in open.iter().filter(|e| e.name.starts_with("mass_")) {
            let why = if e.name == "mass_shoulder" { ": it lies on the joint's axis" } else { "" };
            notes.push(format!(
                "{} is not determined by these logs{why}. It was left at Table A.2's {} kg, which changes nothing that is \
                 shown.",
                capital(&words(&e.name)),
                e.value
            ));
        }
    }
    let others: Vec<&&Estimate> = open.iter().filter(|e| !e.name.starts_with("mass_")).collect();
    let names = |estimates: &[&&Estimate]| estimates.iter().map(|e| words(&e.name)).collect::<Vec<_>>().join(", ");
    let (scale, rest): (Vec<&&Estimate>, Vec<&&Estimate>) = others.iter().partition(|e| e.name == "moment");
    if let Some(moment) = scale.first() {
        let source = if case.by_bodies { "Table A.2" } else { "the study" };
        notes.push(format!(
            "The moment is not determined by these logs (with one load, free swings show ratios only). It was held at \
             {} {}, as {source} has it; inertia and frictions are in proportion to it.",
            moment.value, moment.unit
        ));
    }
    if !rest.is_empty() {
        let verb = if rest.len() == 1 { "is" } else { "are" };
        notes.push(format!(
            "{} {verb} not determined by these logs: a wide range of values explains them equally well.",
            capital(&names(&rest))
        ));
    }
    notes
}

/// A parameter in words.
fn words(name: &str) -> String {
    match name {
        "coulomb" => "Coulomb friction".into(),
        "viscous" => "viscous friction".into(),
        "rest" => "the hanging angle".into(),
        "zero" => "the encoder's zero".into(),
        "static_excess" => "static friction above Coulomb's".into(),
        "stribeck_speed" => "the Stribeck speed".into(),
        "inertia" | "moment" => format!("the {name}"),
        _ if name.starts_with("mass_") => format!("the {} mass", name.trim_start_matches("mass_").replace('_', " ")),
        _ => name.into(),
    }
}

fn capital(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or_else(String::new, |c| c.to_uppercase().collect::<String>() + chars.as_str())
}

/// What a log says in which nothing moves: at least how large the breakaway friction is.
pub fn still(case: &Case, item: &Item) -> String {
    let file = &item.entry.file;
    if item.health.start == Start::AlwaysHeld {
        return format!("{file}: the joint is held throughout (column drive is 1): there is no swing to fit.");
    }
    let mut text = format!("{file}: the joint never moves: friction holds it.");
    let gravity = resting_gravity_nm(case, item);
    if let Some(gravity) = gravity {
        text += &format!(
            " Gravity pulls with {gravity:.4} N m there by the nominal model, so its breakaway friction is at least that."
        );
        if let Some(leg) = &case.leg {
            let tables = &Ers7Tables::embedded().friction;
            let (estimated, chosen) = (tables.estimated.of(leg.joint).0, tables.chosen.of(leg.joint).0);
            if estimated != chosen {
                let would = |mu_c: f64| if mu_c >= gravity { "it sticks" } else { "it would swing" };
                text += &format!(
                    " With the {estimated:.3} N m of Table 3.3 {}, with the {chosen:.3} N m of Table 3.4 {}.",
                    would(estimated),
                    would(chosen)
                );
            }
        }
    }
    text
}

/// Gravity torque on a joint at rest, by the nominal model \[N m\]; `None` where nothing is known of it.
pub fn resting_gravity_nm(case: &Case, item: &Item) -> Option<f64> {
    let nominal = case.joint.nominal?;
    let g = case.joint.gravity_m_s2;
    let angle_rad = item.log.q_rad.iter().sum::<f64>() / item.log.len() as f64;
    let rest = match &case.leg {
        Some(leg) if leg.pose_known => leg.bare().ok()?.rest_rad,
        _ => case.joint.rest_rad?,
    };
    let bare = Link::new(nominal.inertia_kg_m2, nominal.moment_kg_m, rest, g);
    let whole = match (&item.entry.extra, &case.leg) {
        (Some(extra), Some(leg)) => {
            let load = leg.load(extra).ok()?;
            bare.joined(Link::new(load.inertia_kg_m2, load.moment_kg_m, load.hanging_rad, g))
        }
        (Some(extra), None) => bare.joined(Link::new(0.0, extra.mass_kg * extra.distance_m, rest, g)),
        (None, _) => bare,
    };
    Some(whole.gravity_nm(angle_rad).abs())
}
