//! Both ratios of Table 3.1 as a plane: where (3.5) gives a positive mass, and what moves the ratios where.

use plotters::style::{Color, RGBColor};

use crate::report::ReportError;
use crate::report::number::as_given;
use crate::report::plot::axis::Axis;
use crate::report::plot::canvas::{
    BAND, BEFORE, CALIBRATED, EXTENSIVE, INK, LegendEntry, POSITIVE, SETPOINT, SHADE, Sign, band, chart, dashed, dots,
    filled, legend, legend_end, line, sketch, stroke,
};
use crate::thesis::{JointPuzzle, Printed, RatioTable, Tables};

const JOINT_COLOURS: [RGBColor; 3] = [EXTENSIVE, POSITIVE, SETPOINT];
const HEIGHT: f64 = 460.0;
/// Masses whose lines are drawn \[kg\].
const LINES_KG: [f64; 4] = [0.02, 0.05, 0.1, 0.2];

/// Figure 3.3: the region of positive mass, printed ratios and those of the swings.
pub(super) fn positive_mass(tables: &Tables) -> Result<String, ReportError> {
    let printed = &Printed::embedded().table_3_1;
    let [m1, m2] = printed.first().map_or([0.220, 0.402], |row| row.extra_mass_kg);
    let most = printed.iter().map(|row| row.b_over_ml2_1_s[0]).fold(1.0, f64::max) * 1.15;
    let (x, y) = (Axis::between(0.0, most), Axis::between(0.0, 0.75 * most));
    let names = names_of(printed.iter().map(|row| row.joint.to_string()));
    let title = "Figure 3.3: where equation 3.5 gives a positive mass";
    let labels = ("V_1 = B/ML² with 0.220 kg [1/s]", "V_2 = B/ML² with 0.402 kg [1/s]");
    sketch(title, HEIGHT, |root| {
        let top = legend(root, &names)?.max(legend_end(&names));
        let mut chart = chart(root, (top, HEIGHT - 4.0), (&x, &y), labels)?;
        let wedge: Vec<(f64, f64, f64)> =
            (0..=60).map(|k| most * f64::from(k) / 60.0).map(|v| (v, v * m1 / m2, v.min(y.high()))).collect();
        band(&mut chart, &wedge, filled(BAND, 0.3))?;
        for mass in LINES_KG {
            let slope = (mass + m1) / (mass + m2);
            let end = most.min(y.high() / slope);
            line(&mut chart, &[(0.0, 0.0), (end, end * slope)], stroke(SHADE, 0.75))?;
        }
        for (k, row) in printed.iter().enumerate() {
            let [v1, v2] = row.b_over_ml2_1_s;
            let colour = JOINT_COLOURS[k % JOINT_COLOURS.len()];
            dots(&mut chart, &[(v1, v2)], 5.0, filled(colour, 1.0))?;
            if let Some([v1, v2]) = tables.ratios.get(k).and_then(ours) {
                dots(&mut chart, &[(v1, v2)], 5.0, stroke(colour, 1.5))?;
            }
        }
        Ok(())
    })
}

fn names_of(joints: impl Iterator<Item = String>) -> Vec<LegendEntry> {
    let mut names: Vec<LegendEntry> = joints
        .zip(JOINT_COLOURS)
        .map(|(joint, colour)| (Sign::Dot, colour.to_rgba(), format!("{joint}: filled printed, ring ours")))
        .collect();
    let lines = LINES_KG.map(as_given).join(", ");
    names.push((Sign::Box, BAND.mix(0.3), "positive mass".to_owned()));
    names.push((Sign::Line, SHADE.to_rgba(), format!("mass {lines} kg, from below")));
    names
}

/// Both ratios of the swings.
fn ours(table: &RatioTable) -> Option<[f64; 2]> {
    let mut ratios = table.fitted.iter().filter(|row| row.quantity == "b_over_ml2").map(|row| row.ours);
    Some([ratios.next()??, ratios.next()??])
}

/// Candidates that have a colour of their own.
const NAMED: [(&str, RGBColor); 6] = [
    ("coulomb", POSITIVE),
    ("viscous", BEFORE),
    ("load_friction", EXTENSIVE),
    ("friction_drift", BAND),
    ("release of the second test", SETPOINT),
    ("mass of the second test", CALIBRATED),
];

/// Drawn wide, because another lies upon it.
const WIDE: &str = "release of the second test";

/// What each candidate alone does to the first ratio and to the ratio of both.
pub(super) fn ratio_plane(title: &str, joint: &JointPuzzle) -> Result<String, ReportError> {
    let [p1, p2] = joint.printed_1_s;
    let from = joint.as_printed.as_ref().map(|point| point.ratios_1_s);
    let low = from.map_or(p1, |[v1, _]| v1.min(p1));
    let high = from.map_or(p1, |[v1, _]| v1.max(p1));
    let (x, y) = (Axis::between((0.4 * low).max(0.0), 1.7 * high), Axis::between(0.4, 0.8));
    let limit =
        Printed::embedded().ratios(joint.joint).map_or(f64::NAN, |row| row.extra_mass_kg[0] / row.extra_mass_kg[1]);
    let mut names: Vec<LegendEntry> =
        NAMED.iter().map(|(name, colour)| (Sign::Line, colour.to_rgba(), (*name).to_owned())).collect();
    names.push((Sign::Line, SHADE.to_rgba(), "the others".to_owned()));
    names.push((Sign::Dot, INK.to_rgba(), "printed (large), Table 3.3's friction (small)".to_owned()));
    let height = HEIGHT + 20.0;
    let labels = ("V_1 [1/s]", "V_2 / V_1");
    sketch(title, height, |root| {
        let top = legend(root, &names)?;
        let mut chart = chart(root, (top, height - 4.0), (&x, &y), labels)?;
        dashed(&mut chart, (x.low(), x.high()), limit, stroke(INK, 1.0))?;
        let colour_of = |name: &str| NAMED.iter().find(|(named, _)| *named == name).map(|(_, colour)| *colour);
        let mut scans: Vec<_> = joint.alone.iter().map(|scan| (scan, colour_of(scan.candidate.name))).collect();
        // Those with a colour are drawn last, above the others.
        scans.sort_by_key(|(scan, colour)| (colour.is_some(), scan.candidate.name != WIDE));
        for (scan, colour) in scans {
            let inside =
                |v1: f64, share: f64| (x.low()..=x.high()).contains(&v1) && (y.low()..=y.high()).contains(&share);
            let points: Vec<(f64, f64)> = scan
                .curve
                .iter()
                .map(|(_, [v1, v2])| (*v1, v2 / v1))
                .map(|(v1, share)| if inside(v1, share) { (v1, share) } else { (f64::NAN, f64::NAN) })
                .collect();
            // Two of them lie on one another: the wider one is drawn first.
            let width = match (scan.candidate.name, colour) {
                (WIDE, _) => 5.0,
                (_, Some(_)) => 1.75,
                _ => 0.75,
            };
            let style = stroke(colour.unwrap_or(SHADE), width);
            line(&mut chart, &points, style)?;
            dots(&mut chart, &points, 1.25, filled(colour.unwrap_or(SHADE), 1.0))?;
        }
        dots(&mut chart, &[(p1, p2 / p1)], 6.0, filled(INK, 1.0))?;
        let start: Vec<(f64, f64)> = from.iter().map(|[v1, v2]| (*v1, v2 / v1)).collect();
        dots(&mut chart, &start, 3.5, filled(INK, 1.0))
    })
}
