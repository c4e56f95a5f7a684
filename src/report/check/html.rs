//! A check as one page that opens without a network.

use minijinja::{Value, context};

use super::summary::{COLUMNS, doubts, summary};
use super::{CheckReport, LEFT, SOUND, STILL, are_sound, left, plot, sizes, without_study};
use crate::gap::Checkup;
use crate::report::beliefs::{believed, moved};
use crate::report::gap::words;
use crate::report::gap::{detectable_view, with_code};
use crate::report::html::{both, figure_views, health_view, open_and_folded, render};
use crate::report::number::{quantity, significant};
use crate::report::rows::typeset_unit;
use crate::report::{LogHealthRow, ReportError};

/// Puts the checks of a joint, or of all joints of a robot, into one page: data health and figures of each log, what the
/// logs can and cannot determine, what they would show.
///
/// # Errors
/// [`ReportError`] from the figures or the template; none depends on the data.
pub fn check_html(name: &str, reports: &[CheckReport], notes: &[String]) -> Result<String, ReportError> {
    let Some(provenance) = reports.first().map(|report| report.provenance.clone()) else { return Ok(String::new()) };
    let joints: Vec<(&str, Option<&CheckReport>)> =
        reports.iter().map(|report| (report.joint.as_str(), Some(report))).collect();
    let is_study = reports.iter().any(CheckReport::is_of_study);
    let may_be_still = is_study && reports.iter().all(|report| !report.predicts_torques);
    let values = context! {
        name,
        doubts => match reports {
            [only] => only.doubts.clone(),
            _ => doubts(&joints),
        },
        sound => are_sound(&joints).then_some(SOUND),
        summary => summary(&joints).map(|rows| rows.view()),
        columns => COLUMNS,
        joints => reports.iter().map(view).collect::<Result<Vec<_>, _>>()?,
        still => may_be_still.then_some(STILL),
        no_study => (!is_study).then(|| with_code(&without_study(reports.iter()))),
        notes => notes.iter().map(|note| with_code(note)).collect::<Vec<_>>(),
        version => provenance.version,
        command => provenance.command,
        inputs => provenance.inputs,
    };
    render("check.html", include_str!("../templates/check.html"), values)
}

fn view(report: &CheckReport) -> Result<Value, ReportError> {
    let figures = || -> Result<Vec<_>, _> {
        let rows = report.health.iter().zip(&report.series);
        rows.enumerate().map(|(k, (row, series))| plot::series(&report.joint, k, row, series)).collect()
    };
    let (logs, folded) = open_and_folded(both(figures)?.each_ref());
    let noise = || Ok(plot::noise(&report.joint, &report.health)?.into_iter().collect());
    let checkup = report.checkup.as_ref();
    Ok(context! {
        joint => report.joint.as_str(),
        health => report.health.iter().map(health_view).collect::<Vec<_>>(),
        motion => report.health.iter().map(motion_view).collect::<Vec<_>>(),
        logs,
        folded,
        noise => figure_views(both(noise)?.each_ref()),
        sizes => checkup.map(|checkup| sizes(&report.joint, checkup)),
        numbers => checkup.map(numbers).unwrap_or_default(),
        undetermined_words => words::UNDETERMINED,
        undetermined => checkup.map(|checkup| checkup.undetermined.iter().map(|told| with_code(told)).collect::<Vec<_>>()),
        detectable_words => words::DETECTABLE,
        detectable => checkup.map(|checkup| checkup.detectable.iter().map(detectable_view).collect::<Vec<_>>()),
        left => checkup.is_some_and(left).then(|| with_code(LEFT)),
    })
}

fn motion_view(row: &LogHealthRow) -> Value {
    let more = &row.more;
    let dash = || "–".to_owned();
    context! {
        file => row.file.as_str(),
        travel => significant(more.travel_rad, 3),
        speed => significant(more.top_speed_rad_s, 3),
        reversals => more.reversals,
        still => format!("{:.0}", 100.0 * more.still_share),
        noise => more.noise_lasts_s.map_or_else(dash, |lasts_s| format!("{:.1}", 1e3 * lasts_s)),
        longest => significant(1e3 * more.longest_step_s, 3),
    }
}

/// What is believed of each number, and what the logs make of it.
fn numbers(checkup: &Checkup) -> Vec<Value> {
    let interval = |name: &str| checkup.parameters.iter().find(|p| p.name == name).and_then(|p| p.interval);
    let view = |belief: &crate::gap::BeliefFound| {
        context! {
            name => belief.name.as_str(),
            believed => typeset_unit(&believed(belief)),
            found => typeset_unit(&quantity(belief.found, interval(&belief.name), &belief.unit)),
            moved => moved(belief),
        }
    };
    checkup.beliefs.iter().map(view).collect()
}
