//! The fleet as one page that opens without a network.

use super::{FleetReport, JointTrend, TrendPoint};
use crate::report::html::render;
use crate::report::number::{UNKNOWN, significant};
use crate::report::{ReportError, percent_of_answer};
use minijinja::{HtmlEscape, Value, context};
use std::fmt::Write as _;

/// Width of a trend \[px\].
const WIDTH: f64 = 180.0;
/// Height of a trend \[px\].
const HEIGHT: f64 = 36.0;
/// Room around its points \[px\].
const MARGIN: f64 = 5.0;

/// Puts the fleet into one page: joints that part from their models with their trends, those that do not, studies without
/// an answer.
///
/// # Errors
/// [`ReportError::Page`], which does not depend on the data.
pub fn fleet_html(report: &FleetReport) -> Result<String, ReportError> {
    let view = |joint: &JointTrend| of_joint(joint, report.pages.get(&joint.latest.study));
    let (off, fine): (Vec<&JointTrend>, Vec<&JointTrend>) = report.joints.iter().partition(|joint| joint.is_off());
    let views = |joints: Vec<&JointTrend>| joints.into_iter().map(view).collect::<Vec<_>>();
    let failed = report.failed().map(|(study, error)| context! { study, error });
    let values = context! {
        sentence => report.sentence(),
        off => views(off),
        fine => views(fine),
        failed => failed.collect::<Vec<_>>(),
        version => report.version.as_str(),
        command => report.command.as_str(),
    };
    render("fleet.html", include_str!("../templates/fleet.html"), values)
}

fn of_joint(joint: &JointTrend, page: Option<&String>) -> Value {
    let latest = &joint.latest;
    let day = |point: Option<&TrendPoint>| {
        point.and_then(|point| point.day).map_or_else(|| UNKNOWN.to_owned(), |day| day.to_string())
    };
    context! {
        robot => joint.robot.as_deref().unwrap_or("–"),
        joint => joint.joint.as_str(),
        since => joint.since.map_or_else(|| UNKNOWN.to_owned(), |day| day.to_string()),
        first_day => day(joint.points.first()),
        last_day => day(joint.points.last()),
        studies => joint.points.len(),
        gap => joint.measure().quantity(joint.gap()),
        growth => joint.growth().map(|growth| format!("× {}", significant(growth, 3))),
        cause => latest.cause.as_deref().unwrap_or_default(),
        probability => latest.probability.map(percent_of_answer),
        sentence => latest.sentence.as_deref().unwrap_or_default(),
        study => latest.study.as_str(),
        page,
        trend => Value::from_safe_string(trend(joint)),
    }
}

/// The gaps over the days, from zero; what parts from the model in the colour of warnings. A point under the pointer says
/// its study, its day and its gap.
fn trend(joint: &JointTrend) -> String {
    let points = &joint.points;
    let most = points.iter().map(|point| point.gap).filter(|gap| gap.is_finite()).fold(0.0, f64::max);
    let days: Vec<f64> = points.iter().filter_map(|point| point.day).map(|day| f64::from(day.number())).collect();
    let (first, last) = (days.first().copied().unwrap_or_default(), days.last().copied().unwrap_or_default());
    let place = |point: &TrendPoint| {
        let along = match point.day {
            Some(day) if last > first => (f64::from(day.number()) - first) / (last - first),
            _ => 0.5,
        };
        let up = if most > 0.0 && point.gap.is_finite() { point.gap / most } else { 0.0 };
        (MARGIN + along * (WIDTH - 2.0 * MARGIN), HEIGHT - MARGIN - up * (HEIGHT - 2.0 * MARGIN))
    };
    let mut svg = format!(
        "<svg width=\"{WIDTH}\" height=\"{HEIGHT}\" role=\"img\" aria-label=\"gap over days\">\
         <line x1=\"0\" x2=\"{WIDTH}\" y1=\"{y}\" y2=\"{y}\" stroke=\"var(--rule)\"/>",
        y = HEIGHT - MARGIN
    );
    let path: Vec<String> = points.iter().map(place).map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
    let _ = write!(svg, "<polyline points=\"{}\" fill=\"none\" stroke=\"var(--soft)\"/>", path.join(" "));
    for point in points {
        let (x, y) = place(point);
        let colour = if point.is_off { "var(--odd)" } else { "var(--accent)" };
        let day = point.day.map(|day| format!(", {day}")).unwrap_or_default();
        let words = format!("{}{day}: {}", point.study, joint.measure().quantity(point.gap));
        let title = HtmlEscape(&words);
        let _ = write!(
            svg,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"{colour}\"><title>{title}</title></circle>"
        );
    }
    svg + "</svg>"
}
