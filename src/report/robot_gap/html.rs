//! A robot's diagnosis as one page that opens without a network.

use minijinja::{Value, context};

use super::RobotGapReport;
use super::plot::RobotGapFigures;
use super::{waterfall, words};
use crate::gap::robot::{Displacement, JointGap, RobotCandidate, RobotDetectable, RobotDiagnosis};
use crate::report::chances::power;
use crate::report::gap::waterfall::closes_alone;
use crate::report::gap::{gap_view, with_code, words as joint_words};
use crate::report::html::{both, figure_views, open_and_folded, render};
use crate::report::measure::ANGLE;
use crate::report::number::{share, significant};
use crate::report::rows::typeset_unit;
use crate::report::{Figure, ReportError};

/// Puts a robot's diagnosis into one HTML page: verdict, the steps to the floor, next experiment, where, which, how far,
/// joints, what could have been seen, notes, logs, provenance.
///
/// The page holds its figures, its font and its script, and loads nothing but, by links, what was written beside it.
/// Same report, same bytes.
///
/// # Errors
/// [`ReportError::Draw`] or [`ReportError::Font`] from the figures, [`ReportError::Page`] from the template; none depends
/// on the data.
pub fn robot_gap_html(report: &RobotGapReport) -> Result<String, ReportError> {
    let RobotGapReport { diagnosis, provenance, .. } = report;
    let RobotDiagnosis { answer, gap, .. } = diagnosis;
    let [wide, narrow] = both(|| RobotGapFigures::of(report))?;
    let views = |of: fn(&RobotGapFigures) -> &Vec<Figure>| figure_views([of(&wide), of(&narrow)]);
    let (joints, folded) = open_and_folded([&wide.joints, &narrow.joints]);
    let chances = words::chances(diagnosis);
    let ranked = diagnosis.ranking.iter().zip(&chances.candidates);
    let values = context! {
        robot => diagnosis.robot.as_str(),
        scenario => diagnosis.scenario.word(),
        sentence => with_code(&answer.sentence),
        verdict => answer.verdict.name(),
        probability => chances.words(),
        source => with_code(answer.probability_source.trim_end_matches('.')),
        answer => words::answer(answer),
        has_second => answer.second.is_some(),
        gap => gap_view(ANGLE, [gap.before, gap.calibrated, gap.after_first, gap.after, gap.floor]),
        closed => joint_words::closed(gap.closed, gap.closed_interval),
        held_out => with_code(&gap.held_out),
        location => with_code(&words::location(&diagnosis.location)),
        steps => views(|all| &all.steps),
        steps_heading => waterfall::HEADING,
        behind => words::BEHIND,
        rest => chances.is_shared_out.then_some(&chances.rest),
        place => views(|all| &all.place),
        which => views(|all| &all.which),
        ranking => ranked.map(|(candidate, chance)| candidate_view(diagnosis, candidate, chance)).collect::<Vec<_>>(),
        mark => words::mark(answer),
        untrusted => (!answer.intervals_trusted).then_some(joint_words::UNTRUSTED),
        how_far => views(|all| &all.how_far),
        first => diagnosis.answer.first.as_ref().filter(|_| diagnosis.answer.second.is_some()).map(|first| first.cause.id()),
        per_joint => gap.per_joint.iter().map(joint_view).collect::<Vec<_>>(),
        displacement => gap.displacement.iter().map(displacement_view).collect::<Vec<_>>(),
        joints,
        folded,
        beside => report.beside.clone(),
        detectable => diagnosis.detectable.iter().map(detectable_view).collect::<Vec<_>>(),
        detectable_words => words::DETECTABLE,
        next => diagnosis.next.as_ref().map(|next| {
            context! { what => with_code(&next.what), power => with_code(&power(next.power)) }
        }),
        notes => words::notes(report).iter().map(|note| with_code(note)).collect::<Vec<_>>(),
        logs => report.logs.iter().map(log_view).collect::<Vec<_>>(),
        version => provenance.version.as_str(),
        command => provenance.command.as_str(),
        inputs => provenance.inputs.clone(),
    };
    render("robot_gap.html", include_str!("../templates/robot_gap.html"), values)
}

fn joint_view(joint: &JointGap) -> Value {
    let milli = |rad: f64| significant(1e3 * rad, 3);
    context! {
        joint => joint.joint.as_str(),
        before => milli(joint.before),
        calibrated => milli(joint.calibrated),
        after_first => milli(joint.after_first),
        after => milli(joint.after),
    }
}

fn displacement_view(of: &Displacement) -> Value {
    let metres = |m: f64| format!("{m:.3}");
    context! {
        file => of.file.as_str(),
        measured => metres(of.measured),
        before => metres(of.before),
        after => metres(of.after),
    }
}

fn candidate_view(diagnosis: &RobotDiagnosis, candidate: &RobotCandidate, chance: &str) -> Value {
    let found = &candidate.found;
    context! {
        effect => found.cause.id(),
        joints => words::place(&found.joints),
        stage => found.cause.stage().name(),
        named => words::is_named(&diagnosis.answer, candidate),
        after => significant(1e3 * candidate.after, 3),
        closed => closes_alone([diagnosis.gap.calibrated, diagnosis.gap.floor], candidate.after).map_or_else(|| "–".to_owned(), share),
        behind => significant(candidate.behind, 2),
        probability => chance,
        parameters => found.parameters.iter().map(|p| typeset_unit(&joint_words::parameter(p))).collect::<Vec<_>>(),
    }
}

fn detectable_view(detectable: &RobotDetectable) -> Value {
    context! {
        effect => detectable.cause.id(),
        stage => detectable.cause.stage().name(),
        size => typeset_unit(&words::threshold(detectable)),
    }
}

fn log_view(log: &super::LogRow) -> Value {
    context! {
        file => log.file.as_str(),
        role => log.role.as_str(),
        samples => log.samples,
        duration_s => format!("{:.3}", log.duration_s),
        joints => log.joints,
    }
}
