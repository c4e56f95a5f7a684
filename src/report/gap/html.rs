//! A diagnosis as one page that opens without a network.

use minijinja::{HtmlEscape, Value, context};

use super::GapReport;
use super::plot::GapFigures;
use super::rows::{effect_rows, joint_rows};
use super::{waterfall, words};
use crate::gap::{Candidate, Detectable, Diagnosis, LogGap};
use crate::joint::Stage;
use crate::report::html::{both, figure_views, health_view, open_and_folded, parameter_view, render};
use crate::report::measure::Measure;
use crate::report::number::{share, significant};
use crate::report::rows::typeset_unit;
use crate::report::{Figure, ReportError};

/// Puts a diagnosis into one HTML page: verdict, the steps to the floor, the next experiment, a close-up,
/// data health, what is undetermined, where, which, how far, logs, parameters, what could have been seen, notes,
/// provenance.
///
/// The page holds its figures, its font and its script, and loads nothing; it can be read without the script. Same report,
/// same bytes.
///
/// # Errors
/// [`ReportError::Draw`] or [`ReportError::Font`] from the figures, [`ReportError::Page`] from the template; none depends
/// on the data.
pub fn render_gap_html(report: &GapReport) -> Result<String, ReportError> {
    let GapReport { diagnosis, options, health, provenance, .. } = report;
    let Diagnosis { answer, gap, .. } = diagnosis;
    let measure = Measure::of(gap.unit);
    let [wide, narrow] = both(|| GapFigures::of(report))?;
    let views = |of: fn(&GapFigures) -> &Vec<Figure>| figure_views([of(&wide), of(&narrow)]);
    let (logs, folded) = open_and_folded([&wide.logs, &narrow.logs]);
    let rows = joint_rows(diagnosis).into_iter().chain(effect_rows(diagnosis));
    let chances = words::chances(diagnosis);
    let ranked = diagnosis.ranking.iter().zip(&chances.candidates);
    let values = context! {
        joint => diagnosis.joint.as_str(),
        sentence => with_code(&answer.sentence),
        verdict => answer.verdict.name(),
        probability => with_code(&chances.words()),
        source => with_code(answer.probability_source.trim_end_matches('.')),
        answer => words::answer(diagnosis),
        has_second => answer.second.is_some(),
        measure => measure.unit,
        what => measure.what,
        gap => gap_view(measure, [gap.before, gap.calibrated, gap.after_first, gap.after, gap.floor]),
        closed => words::closed(gap.closed, gap.closed_interval),
        held_out => with_code(&gap.held_out),
        is_held_out => gap.is_held_out(),
        logs_of => words::logs_of(gap),
        log_of => words::log_of(gap),
        steps => views(|all| &all.steps),
        laws => views(|all| &all.laws),
        close_up => views(|all| &all.close_up),
        steps_heading => waterfall::heading(diagnosis),
        moved => moved_views(diagnosis),
        undetermined => diagnosis.undetermined.iter().map(|sentence| with_code(sentence)).collect::<Vec<_>>(),
        undetermined_words => words::UNDETERMINED,
        health => health.iter().map(health_view).collect::<Vec<_>>(),
        chain => chain_view(diagnosis),
        location => with_code(&words::location(&diagnosis.location)),
        place => views(|all| &all.place),
        which => views(|all| &all.which),
        ranking => ranked.map(|(candidate, chance)| candidate_view(diagnosis, candidate, chance)).collect::<Vec<_>>(),
        rest => chances.is_shared_out.then_some(&chances.rest),
        mark => words::mark(answer),
        twins => views(|all| &all.twins),
        twins_command => diagnosis.confusion.as_ref().map(|table| table.command.as_str()),
        how_far => views(|all| &all.how_far),
        per_log => gap.per_log.iter().map(|log| log_view(measure, log)).collect::<Vec<_>>(),
        logs,
        folded,
        effects => !diagnosis.effect_parameters.is_empty(),
        untrusted => (!answer.intervals_trusted).then_some(words::UNTRUSTED),
        parameter_figures => views(|all| &all.parameters),
        parameters => rows.map(|row| parameter_view(&row)).collect::<Vec<_>>(),
        detectable => diagnosis.detectable.iter().map(detectable_view).collect::<Vec<_>>(),
        detectable_words => words::DETECTABLE,
        next => diagnosis.next.as_ref().map(|proposal| {
            context! { what => with_code(&proposal.what), power => with_code(&words::power(proposal.power)), figures => views(|all| &all.next) }
        }),
        no_next => words::no_next(diagnosis),
        notes => words::notes(report).iter().map(|note| with_code(note)).collect::<Vec<_>>(),
        version => provenance.version.as_str(),
        command => provenance.command.as_str(),
        seed => options.seed,
        twins_asked => options.twins,
        inputs => provenance.inputs.clone(),
    };
    render("gap.html", include_str!("../templates/gap.html"), values)
}

/// A text in which what stands between backticks is set as code, and no line ends before a `%`.
pub(in crate::report) fn with_code(text: &str) -> Value {
    let text = text.replace(" %", "\u{a0}%");
    let pieces = text.split('`').enumerate().map(|(i, piece)| {
        let escaped = HtmlEscape(piece).to_string();
        if i % 2 == 1 { format!("<code>{escaped}</code>") } else { escaped }
    });
    Value::from_safe_string(pieces.collect())
}

/// The numbers that are not as they were believed to be.
fn moved_views(diagnosis: &Diagnosis) -> Vec<Value> {
    let view = |row: waterfall::Moved<'_>| {
        context! {
            name => row.name,
            believed => typeset_unit(&row.believed),
            found => typeset_unit(&row.found),
            moved => row.moved,
            is_finding => row.is_finding,
        }
    };
    waterfall::moved(diagnosis).into_iter().map(view).collect()
}

/// The chain with the stage of the gap marked.
fn chain_view(diagnosis: &Diagnosis) -> Vec<Value> {
    let view = |stage: Stage| context! { name => stage.name(), here => diagnosis.location.stage == Some(stage) };
    Stage::ALL.into_iter().map(view).collect()
}

/// As given, recalibrated, with the first effect, with all, and the noise.
pub(in crate::report) fn gap_view(
    measure: Measure,
    [before, calibrated, after_first, after, floor]: [f64; 5],
) -> Value {
    context! {
        before => measure.quantity(before),
        calibrated => measure.quantity(calibrated),
        after_first => measure.quantity(after_first),
        after => measure.quantity(after),
        floor => measure.quantity(floor),
    }
}

fn log_view(measure: Measure, log: &LogGap) -> Value {
    context! {
        file => log.file.as_str(),
        before => measure.number(log.before),
        calibrated => measure.number(log.calibrated),
        after => measure.number(log.after),
        floor => measure.number(log.floor),
    }
}

fn candidate_view(diagnosis: &Diagnosis, candidate: &Candidate, chance: &str) -> Value {
    let dash = || "–".to_owned();
    let shown = |value: f64| if candidate.refitted { Measure::of(diagnosis.gap.unit).number(value) } else { dash() };
    context! {
        effect => candidate.effect.id(),
        stage => candidate.effect.stage().name(),
        named => words::is_named(&diagnosis.answer, candidate.effect),
        after => shown(candidate.after),
        closed => waterfall::closes_alone([diagnosis.gap.calibrated, diagnosis.gap.floor], candidate.after).map_or_else(dash, share),
        behind => significant(candidate.behind_sd, 2),
        probability => chance,
        parameters => candidate.parameters.iter().map(|p| typeset_unit(&words::parameter(p))).collect::<Vec<_>>(),
    }
}

pub(in crate::report) fn detectable_view(detectable: &Detectable) -> Value {
    context! {
        effect => detectable.effect.id(),
        stage => detectable.effect.stage().name(),
        size => typeset_unit(&words::threshold(detectable)),
    }
}

#[cfg(test)]
mod tests {
    use super::super::sample;
    use super::*;
    use crate::report::html::tests::is_alone;

    fn page(report: &GapReport) -> String {
        render_gap_html(report).expect("a page for any diagnosis")
    }

    #[test]
    fn page_needs_no_network_and_shows_only_numbers() {
        for (name, report) in sample::all() {
            let page = page(&report);
            is_alone(&page);
            let body = page.split_once("<body>").expect("a body").1;
            assert!(!body.contains("NaN") && !body.contains(">inf"), "{name}");
        }
    }

    #[test]
    fn sections_stand_in_the_order_in_which_one_reads() {
        let page = page(&sample::set_of_two());
        let headings = [
            "class=\"verdict\"",
            ">From as given to the floor<",
            ">Next experiment<",
            ">Close-up<",
            ">Data health<",
            ">What these logs cannot determine<",
            ">Where<",
            ">Which<",
            ">How far<",
            ">Logs<",
            ">Parameters<",
            ">What these logs could have shown<",
            ">Notes<",
            ">Provenance<",
        ];
        let places: Vec<_> = headings.iter().map(|heading| page.find(heading)).collect();
        assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{places:?}");
        assert!(page.contains("<li class=\"here\">link</li>"));
    }

    #[test]
    fn page_says_when_intervals_are_not_to_be_trusted() {
        assert!(page(&sample::unexplained()).contains("class=\"warning\""));
        assert!(!page(&sample::two_effects()).contains("class=\"warning\""));
    }

    #[test]
    fn texts_are_escaped_and_same_report_gives_same_bytes() {
        let report = sample::unexplained();
        let page_of = page(&report);
        assert!(page_of.contains("&lt;b&gt;name") && !page_of.contains("<b>name"));
        assert_eq!(page_of, page(&report));
    }
}
