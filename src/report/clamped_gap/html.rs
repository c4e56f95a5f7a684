//! A robot's diagnosis as one page that opens without a network; its joints have pages of their own.

use minijinja::{Value, context};

use super::map::map;
use super::{ClampedGapReport, logs_of, step_by_step, summary, sure, waterfall};
use crate::gap::whole::WholeJoint;
use crate::report::data_health::together;
use crate::report::gap::plot::how_far::errors;
use crate::report::gap::plot::{close_up, figure};
use crate::report::gap::{gap_view, with_code};
use crate::report::html::{both, figure_views, health_view, render};
use crate::report::measure::{ANGLE, Measure};
use crate::report::number::share;
use crate::report::{Figure, GapReport, LogHealthRow, ReportError};

/// Figures by their place in the report.
struct ClampedFigures {
    steps: Vec<Figure>,
    close_up: Vec<Figure>,
    joints: Vec<Figure>,
}

impl ClampedFigures {
    fn of(report: &ClampedGapReport) -> Result<Self, ReportError> {
        let caption = waterfall::explanation(report);
        let steps = figure("waterfall", waterfall::HEADING, &caption, waterfall::figure(report)?);
        // The joint of which most is closed; where nothing is, the one that is farthest off.
        let parts = |of: &GapReport| (of.diagnosis.gap.calibrated - of.diagnosis.gap.after, of.diagnosis.gap.after);
        let telling = report.joints.iter().map(|(_, joint)| joint).max_by(|a, b| {
            let [(a, a_left), (b, b_left)] = [parts(a), parts(b)];
            a.total_cmp(&b).then(a_left.total_cmp(&b_left))
        });
        let close_up = telling.map_or_else(|| Ok(Vec::new()), close_up)?;
        Ok(Self { steps: vec![steps], close_up, joints: at_a_glance(report)? })
    }
}

/// Draws the steps from as given to the floor, a close-up, and the joints at a glance.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn clamped_gap_figures(report: &ClampedGapReport) -> Result<Vec<Figure>, ReportError> {
    let ClampedFigures { steps, close_up, joints } = ClampedFigures::of(report)?;
    Ok([steps, close_up, joints].into_iter().flatten().collect())
}

fn at_a_glance(report: &ClampedGapReport) -> Result<Vec<Figure>, ReportError> {
    let rows = report.rows();
    let measure = Measure::of(report.diagnosis.gap.unit);
    let title = format!("{}: error of each joint", report.diagnosis.robot);
    let mut figures = vec![Figure {
        file_name: "joints.svg".to_owned(),
        title: title.clone(),
        caption: format!(
            "RMS of the {} over the {}: as given, with numbers refitted within their beliefs, with the causes that were found, \
             and what the sensor leaves.",
            measure.what,
            logs_of(&report.diagnosis)
        ),
        svg: errors(&title, &rows.iter().collect::<Vec<_>>(), measure, Some("with causes".to_owned()))?,
    }];
    figures.extend(map(report)?.map(|svg| Figure {
        file_name: "map.svg".to_owned(),
        title: format!("{}: where the gap lies, joint by phase", report.diagnosis.robot),
        caption: "Shares of the whole robot's squares above the sensors' noise, as given. Framed: more than chance gives in \
                  one of the joint's logs."
            .to_owned(),
        svg,
    }));
    Ok(figures)
}

/// Puts a robot's diagnosis into one HTML page: verdict, the steps to the floor, what would tell more, a
/// close-up, joints at a glance, what each of them says, notes, provenance.
///
/// # Errors
/// [`ReportError`] from the figures or the template; none depends on the data.
pub fn clamped_gap_html(report: &ClampedGapReport) -> Result<String, ReportError> {
    let ClampedGapReport { diagnosis, joints, provenance, .. } = report;
    let (gap, answer) = (&diagnosis.gap, &diagnosis.answer);
    let measure = Measure::of(gap.unit);
    let still = diagnosis.joints.iter().filter(|joint| joint.diagnosis.is_none());
    let (health, remarks) = together(&report.health());
    let health = health.into_iter().map(|row| LogHealthRow { remarks: Vec::new(), ..row });
    let [wide, narrow] = both(|| ClampedFigures::of(report))?;
    let views = |of: fn(&ClampedFigures) -> &Vec<Figure>| figure_views([of(&wide), of(&narrow)]);
    let values = context! {
        robot => diagnosis.robot.as_str(),
        sentence => with_code(&answer.sentence),
        verdict => answer.verdict.name(),
        measure => measure.unit,
        what => measure.what,
        gap => gap_view(measure, [gap.before, gap.calibrated, gap.after, gap.after, gap.floor]),
        closed => gap.closed.map_or_else(|| "–".to_owned(), share),
        health => health.map(|row| health_view(&row)).collect::<Vec<_>>(),
        remarks => remarks.iter().map(|(of, said)| format!("{of}: {}.", said.join("; "))).collect::<Vec<_>>(),
        steps => views(|all| &all.steps),
        steps_heading => waterfall::HEADING,
        close_up => views(|all| &all.close_up),
        figures => views(|all| &all.joints),
        joints => joints.iter().map(|(folder, joint)| joint_view(report, folder, joint)).collect::<Vec<_>>(),
        still => still.map(|joint| joint.joint.clone()).collect::<Vec<_>>(),
        animation => report.animation.is_some().then_some(super::ANIMATION_FILE),
        whole => report.whole_words(),
        whole_joints => whole_joints(report),
        columns => report.columns(),
        undetermined => report.undetermined(),
        next => report.next(),
        notes => report.notes().iter().map(|note| with_code(note)).collect::<Vec<_>>(),
        version => provenance.version.as_str(),
        command => provenance.command.as_str(),
        inputs => provenance.inputs.clone(),
    };
    render("clamped_gap.html", include_str!("../templates/clamped_gap.html"), values)
}

fn joint_view(report: &ClampedGapReport, folder: &str, joint: &GapReport) -> Value {
    let diagnosis = &joint.diagnosis;
    let measure = Measure::of(diagnosis.gap.unit);
    context! {
        joint => diagnosis.joint.as_str(),
        page => format!("{folder}/report.html"),
        verdict => diagnosis.answer.verdict.name(),
        what => summary(report, diagnosis),
        before => measure.number(diagnosis.gap.before),
        calibrated => measure.number(diagnosis.gap.calibrated),
        after => measure.number(diagnosis.gap.after),
        floor => measure.number(diagnosis.gap.floor),
        probability => sure(diagnosis),
        sentence => with_code(report.own_sentence(diagnosis)),
        steps => step_by_step(diagnosis),
    }
}

/// An error in mrad; of a joint that stands where it stood it is rounding.
fn at_least(rad: f64) -> String {
    if rad < LEAST_RAD { "< 0.001".to_owned() } else { ANGLE.number(rad) }
}

/// Less than this is no error of an angle [rad].
const LEAST_RAD: f64 = 1e-6;

/// Every joint in one simulation of the whole robot.
fn whole_joints(report: &ClampedGapReport) -> Vec<Value> {
    let Some(Ok(whole)) = &report.whole else { return Vec::new() };
    let view = |joint: &WholeJoint| {
        context! { joint => joint.joint.as_str(), before => at_least(joint.before), after => at_least(joint.after) }
    };
    whole.joints.iter().map(view).collect()
}
