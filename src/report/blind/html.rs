//! The report of sealed trials as one page that opens without a network.

use minijinja::{Value, context};

use super::rows::{counts, interval, numbers, percent, rates, sentence, share};
use super::{BlindReport, blind_figures};
use crate::blind::{Judgement, Trial};
use crate::gap::Verdict;
use crate::report::ReportError;
use crate::report::html::{both, figure_views, render};

/// Puts the report of sealed trials into one HTML page.
///
/// The page holds its figures, its font and its script, and loads nothing; it can be read without the script. Same report,
/// same bytes.
///
/// # Errors
/// [`ReportError::Draw`] or [`ReportError::Font`] from the figures, [`ReportError::Page`] from the template; none depends
/// on the data.
pub fn blind_html(report: &BlindReport) -> Result<String, ReportError> {
    let score = &report.score;
    let rates: Vec<Value> = rates(score)
        .into_iter()
        .map(|row| context! { what => row.what, count => row.count, share => row.share, interval => row.interval })
        .collect();
    let causes: Vec<Value> = score
        .causes
        .iter()
        .map(|cause| {
            context! {
                cause => cause.cause.as_str(),
                top => counts(&cause.top),
                set => counts(&cause.set),
                stage => if cause.stage.of > 0 { counts(&cause.stage) } else { String::new() },
                taken_for => cause.taken_for.as_ref().map(|(name, count)| format!("{name} ({count})")),
            }
        })
        .collect();
    let sets: Vec<Value> = score
        .sets
        .iter()
        .map(|set| {
            context! {
                what => set.what, exact => counts(&set.exact), all => counts(&set.all), half => counts(&set.half),
                clean => counts(&set.clean), stage => counts(&set.stage), needless => format!("{:.2}", set.needless),
            }
        })
        .collect();
    let noises: Vec<Value> = score
        .noises
        .iter()
        .map(|noise| {
            context! { what => noise.what, alarms => counts(&noise.false_alarms), top => counts(&noise.top) }
        })
        .collect();
    let sizes: Vec<Value> = score
        .sizes
        .iter()
        .map(|size| {
            context! {
                from => size.from, to => size.to,
                top => counts(&size.top), set => counts(&size.set), missed => counts(&size.missed),
            }
        })
        .collect();
    let bins: Vec<Value> = score
        .stated
        .bins
        .iter()
        .filter(|bin| bin.right.of > 0)
        .map(|bin| {
            context! {
                range => format!("{} to {}", bin.range[0], bin.range[1]),
                stated => bin.stated.map(percent),
                right => counts(&bin.right), share => share(&bin.right), interval => interval(&bin.right),
            }
        })
        .collect();
    let coverage: Vec<Value> = score
        .coverage
        .iter()
        .filter(|row| row.textbook.of + row.variant.of > 0)
        .map(|row| {
            context! {
                name => row.name.as_str(),
                robust => counts(&row.textbook), share => share(&row.textbook),
                naive => counts(&row.textbook_naive), variant => counts(&row.variant),
            }
        })
        .collect();
    let values = context! {
        trials => score.trials,
        seed => report.seed,
        sha256 => report.sha256.as_str(),
        seal_holds => report.seal_holds,
        sentence => sentence(score),
        rates,
        numbers => numbers(score),
        figures => figure_views(both(|| blind_figures(report))?.each_ref()),
        causes,
        sets,
        noises,
        sizes,
        bins,
        coverage,
        studies => report.trials.iter().map(study).collect::<Vec<_>>(),
        version => report.provenance.version.as_str(),
        command => report.provenance.command.as_str(),
    };
    render("blind.html", include_str!("../templates/blind.html"), values)
}

fn study(trial: &Trial) -> Value {
    let truth = &trial.truth;
    let there = match truth.verdict {
        Verdict::Effect => truth.effects().join(" + "),
        Verdict::Unexplained => truth.outside.map_or_else(String::new, |id| format!("outside: {id}")),
        Verdict::None | Verdict::Calibration => truth.verdict.name().to_owned(),
    };
    let (answered, probability) = match &trial.answer {
        Err(why) => (format!("failed: {why}"), String::new()),
        Ok(answer) if answer.verdict == Verdict::Effect => {
            let others = answer.equivalent.iter().filter(|e| !answer.named().contains(&e.id()));
            let others: Vec<&str> = others.map(|e| e.id()).collect();
            let alike = if others.is_empty() { String::new() } else { format!(" (or {})", others.join(", ")) };
            (answer.named().join(" + ") + &alike, percent(answer.probability))
        }
        Ok(answer) => (answer.verdict.name().to_owned(), percent(answer.probability)),
    };
    let judgement = Judgement::of(trial);
    context! {
        number => truth.trial,
        joint => truth.family.name(),
        logs => format!("{} free, {} driven", truth.free_logs, truth.driven_logs),
        there,
        left => if truth.left > 0.0 { format!("{:.1}", truth.left) } else { String::new() },
        answered,
        probability,
        word => if judgement.top { "right" } else if judgement.set { "in the set" } else { "wrong" },
        wall => format!("{:.2}", trial.wall_s),
    }
}
