//! Figures 4.1, 4.2, 4.5, 4.6, C.1 and C.2: which feet are down, what is asked of the joints, where the trunk goes, what
//! the joints make of it.

use super::panels::{Curve, Panel, stacked};
use super::study_plot::{at, plane};
use super::{JointCurves, LegCurves, WalkReport};
use crate::report::plot::axis::Axis;
use crate::report::plot::canvas::{EXTENSIVE, INK, SETPOINT, Sign, filled, px, spot};
use crate::report::{Figure, ReportError};
use crate::robot::simulate::{Footfalls, TrunkCurves};
use plotters::prelude::Rectangle;
use plotters::style::Color;

/// A run of so long is the one of section C.1 \[s\].
const LONG_S: f64 = 60.0;
/// Cycles that enlarged figures show.
const CYCLES: f64 = 2.0;

/// The trunk's displacement where there is a floor, one step cycle and the feet; the setpoints; then one figure for each
/// leg, a panel for each of its joints.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn walk_figures(report: &WalkReport) -> Result<Vec<Figure>, ReportError> {
    let (name, place) =
        if report.trunk.is_some() { ("Figure 4.6", "on the floor") } else { ("Figure C.2", "in the air") };
    let is_long = report.duration_s > LONG_S;
    let mut figures = Vec::new();
    let mut add = |file: &str, title: String, caption: String, svg: String| {
        figures.push(Figure { file_name: format!("{file}.svg"), title, caption, svg });
    };
    if let Some(trunk) = &report.trunk {
        let name = if is_long { "Figure C.1" } else { "Figure 4.5" };
        let caption = format!(
            "{name}. Where the trunk's centre is: forward and to the right from where it was dropped, and its height over \
             the floor. The robot falls, settles, and walks."
        );
        add("walk-trunk", format!("{name}, displacement of the trunk"), caption, draw_trunk(trunk)?);
    }
    figures.extend(report.cycle.clone());
    let mut add = |file: &str, title: String, caption: String, svg: String| {
        figures.push(Figure { file_name: format!("{file}.svg"), title, caption, svg });
    };
    if let Some(feet) = &report.footfalls {
        let caption = format!(
            "Figure 4.1, {}. Which feet are on the floor, over the last {CYCLES} cycles. A trot has two diagonal feet up at \
             a time, a crawl one, a pace both of a side.",
            report.gait
        );
        let title = format!("Figure 4.1, feet on the floor: {}", report.gait);
        let svg = draw_feet(&title, feet, CYCLES * report.cycle_s)?;
        add("walk-feet", title, caption, svg);
    }
    if !report.legs.is_empty() {
        let window = last(&report.legs[0].t_s, CYCLES * report.cycle_s);
        let caption = "Figure 4.2. What is asked of the legs' joints over two cycles; the thesis shows its own in \
                       Denavit-Hartenberg angles and gives no numbers.";
        let legs: Vec<LegCurves> = report.legs.iter().map(|leg| leg.within(&window)).collect();
        let title = format!("Figure 4.2, setpoints of the gait: {}", report.gait);
        add("walk-setpoints", title, caption.to_owned(), draw_setpoints(&report.gait, &legs)?);
        let asked = "Setpoint and simulated reading. Where the dashes lie on the line the joint follows without delay and at full amplitude.";
        if !report.legs[0].joints.is_empty() && window.start > 0 && report.trunk.is_some() {
            let leg = &legs[0];
            let words = format!("{name}, {} leg, enlarged", leg.name);
            add("walk-enlarged", words.clone(), format!("{words}: two cycles. {asked}"), draw(leg, place)?);
        }
        for (leg, enlarged) in report.legs.iter().zip(&legs) {
            let leg = if is_long { enlarged } else { leg };
            let file = format!("walk-{}", leg.name.replace(' ', "-"));
            add(&file, format!("{name}, {} leg", leg.name), format!("{name}. {asked}"), draw(leg, place)?);
        }
    }
    Ok(figures)
}

/// The samples of the last so many seconds.
fn last(t_s: &[f64], span_s: f64) -> std::ops::Range<usize> {
    let from_s = t_s.last().map_or(0.0, |end| end - span_s);
    t_s.partition_point(|t| *t < from_s - 1e-9)..t_s.len()
}

impl LegCurves {
    fn within(&self, samples: &std::ops::Range<usize>) -> Self {
        let cut = |column: &[f64]| column[samples.start.min(column.len())..samples.end.min(column.len())].to_vec();
        let joint = |joint: &JointCurves| JointCurves {
            name: joint.name.clone(),
            setpoint_rad: cut(&joint.setpoint_rad),
            reading_rad: cut(&joint.reading_rad),
        };
        Self { name: self.name.clone(), t_s: cut(&self.t_s), joints: self.joints.iter().map(joint).collect() }
    }
}

fn draw(leg: &LegCurves, place: &str) -> Result<String, ReportError> {
    let names = [
        (Sign::Line, SETPOINT.to_rgba(), "setpoint".to_owned()),
        (Sign::Line, EXTENSIVE.to_rgba(), "simulated".to_owned()),
    ];
    let curve = |y, colour, width| Curve { x: &leg.t_s, y, colour, width };
    let panel = |joint: &'_ JointCurves| -> (String, [Vec<f64>; 2]) {
        (format!("{} [rad]", joint.name), [joint.setpoint_rad.clone(), joint.reading_rad.clone()])
    };
    let columns: Vec<_> = leg.joints.iter().map(panel).collect();
    let panels: Vec<Panel<'_>> = columns
        .iter()
        .map(|(label, [setpoint, reading])| Panel {
            label: label.clone(),
            curves: vec![curve(reading, EXTENSIVE, 1.5), curve(setpoint, SETPOINT, 1.25)],
        })
        .collect();
    stacked(&format!("walk {place}, {} leg", leg.name), &names, "time [s]", &panels)
}

/// One panel for each joint of a leg, a curve for each leg.
fn draw_setpoints(gait: &str, legs: &[LegCurves]) -> Result<String, ReportError> {
    let colours = crate::report::walk::COLOURS;
    let names: Vec<_> =
        legs.iter().zip(colours).map(|(leg, colour)| (Sign::Line, colour.to_rgba(), leg.name.clone())).collect();
    let joints = legs.iter().map(|leg| leg.joints.len()).max().unwrap_or(0);
    let panel = |joint: usize| Panel {
        label: format!("q{} [rad]", joint + 1),
        curves: legs
            .iter()
            .zip(colours)
            .enumerate()
            .filter_map(|(k, (leg, colour))| {
                // Diagonal legs often do the same: the rear ones are dashed upon wider lines.
                let width = if k < 2 { 4.0 } else { 1.75 };
                Some(Curve { x: &leg.t_s, y: &leg.joints.get(joint)?.setpoint_rad, colour, width })
            })
            .collect(),
    };
    stacked(&format!("{gait}: setpoints"), &names, "time [s]", &(0..joints).map(panel).collect::<Vec<_>>())
}

/// The trunk's three curves.
pub(super) fn draw_trunk(trunk: &TrunkCurves) -> Result<String, ReportError> {
    let panel = |(label, y)| Panel {
        label: String::from(label),
        curves: vec![Curve { x: &trunk.t_s, y, colour: EXTENSIVE, width: 1.5 }],
    };
    let curves =
        [("forward [m]", &trunk.forward_m[..]), ("right [m]", &trunk.right_m), ("height [m]", &trunk.height_m)];
    stacked("walk on the floor, displacement of the trunk", &[], "time [s]", &curves.map(panel))
}

/// A bar wherever a foot is down.
fn draw_feet(title: &str, feet: &Footfalls, span_s: f64) -> Result<String, ReportError> {
    let window = last(&feet.t_s, span_s);
    let t_s = &feet.t_s[window.clone()];
    let time = Axis::over(t_s.iter().copied(), 0.01);
    let labels: Vec<&str> = feet.feet.iter().map(|(name, _)| name.as_str()).collect();
    plane(title, "time [s]", &[], &time, &labels, |root, k, y| {
        let bar = |from: f64, to: f64| {
            let corners = [(px(at(&time, from)), px(y - 8.0)), (px(at(&time, to)), px(y + 8.0))];
            let size = [at(&time, to) - at(&time, from), 16.0];
            spot(root, [at(&time, from), y - 8.0], size, &format!("{} down from {from:.3} to {to:.3} s", labels[k]));
            root.draw(&Rectangle::new(corners, filled(INK, 0.8)))
        };
        let mut begin: Option<f64> = None;
        for (t, is_down) in t_s.iter().zip(&feet.feet[k].1[window.clone()]) {
            match (*is_down, begin) {
                (true, None) => begin = Some(*t),
                (false, Some(from)) => {
                    bar(from, *t)?;
                    begin = None;
                }
                _ => {}
            }
        }
        match (begin, t_s.last()) {
            (Some(from), Some(to)) => bar(from, *to),
            _ => Ok(()),
        }
    })
}
