//! Every parameter with its intervals, on rulers that tell a wide one from a narrow one.

use crate::number::chance::HALF_95;
use plotters::prelude::{Circle, PathElement, Polygon, Rectangle};
use plotters::style::text_anchor::HPos;
use plotters::style::{Color, RGBColor};

use super::axis::{Axis, drawable};
use super::canvas::{
    Area, BAND, Drawn, GRID, INK, LegendEntry, Look, MEASURED, MODEL_COLOURS, RIGHT, Sign, filled, left, legend,
    legend_end, px, sketch, spot, stroke, text, width,
};
use super::layout::is_narrow;
use crate::identify::BeliefFound;
use crate::report::number::significant;
use crate::report::rows::{ParameterCells, is_shown, typeset_unit};
use crate::report::{ModelSummary, ParameterRow, ReportError};

/// Height of a row; in a narrow figure its words stand above its bar \[px\].
const ROWS: [f64; 2] = [30.0, 42.0];
/// Room for a ruler and its label \[px\].
const RULER: f64 = 48.0;
/// Room for numbers to the right of the bars \[px\].
const NUMBERS: f64 = 300.0;
const BELIEF_OPACITY: f64 = 0.22;
/// An end that is so many times farther out than the next one is cut, with an arrow.
const TOO_FAR: f64 = 20.0;

/// Parameters under one name, with what was believed of them.
pub(in crate::report) struct Group<'a> {
    pub name: &'a str,
    pub rows: &'a [ParameterRow],
    pub beliefs: &'a [BeliefFound],
}

/// Draws all parameters of all models: the estimate as a dot, its 95 % interval as a line, the naive one as a box.
///
/// Parameters with a nominal value stand on a ruler of the difference from it, others on one of the difference from the estimate.
/// Held parameters and those that the logs do not determine are named in words.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn parameter_intervals(joint: &str, models: &[ModelSummary]) -> Result<String, ReportError> {
    let group =
        |model: &'_ ModelSummary| -> (String, Vec<ParameterRow>) { (model.name.clone(), model.parameters.clone()) };
    let models: Vec<_> = models.iter().map(group).collect();
    let groups: Vec<_> = models.iter().map(|(name, rows)| Group { name, rows, beliefs: &[] }).collect();
    interval_bars(&format!("{joint} parameters with 95 % intervals"), &groups)
}

/// Against what a parameter is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Ground {
    /// What was believed of it and the standard deviation of that.
    Belief(f64, f64),
    /// Its nominal value.
    Nominal(f64),
    /// Its estimate.
    Own(f64),
    /// Nothing: there is no number, or no size to compare it with.
    Words,
}

impl Ground {
    fn of(row: &ParameterRow, beliefs: &[BeliefFound]) -> Self {
        let known = |value: f64| drawable(value) && value != 0.0;
        let belief = beliefs.iter().find(|belief| belief.name == row.name);
        let belief = belief.filter(|belief| drawable(belief.believed) && drawable(belief.sd) && belief.sd > 0.0);
        match (belief, row.nominal) {
            _ if !is_shown(row) || ends(row).is_none() => Self::Words,
            (Some(belief), _) => Self::Belief(belief.believed, belief.sd),
            (None, Some(nominal)) if known(nominal) => Self::Nominal(nominal),
            (None, None) if known(row.value) => Self::Own(row.value),
            _ => Self::Words,
        }
    }

    /// Which ruler it has, and what stands under that.
    fn ruler(self) -> (usize, &'static str) {
        match self {
            Self::Belief(..) => (0, "from what was believed [its standard deviations]"),
            Self::Nominal(_) => (1, "difference from the nominal value [%]"),
            Self::Own(_) => (2, "from the estimate [% of it]"),
            Self::Words => (3, ""),
        }
    }

    /// Place of a value on its ruler.
    fn along(self, value: f64) -> f64 {
        match self {
            Self::Belief(believed, sd) => (value - believed) / sd,
            Self::Nominal(nominal) => 100.0 * (value - nominal) / nominal.abs(),
            Self::Own(own) => 100.0 * (value - own) / own.abs(),
            Self::Words => 0.0,
        }
    }
}

/// The widest interval that a row has.
fn ends(row: &ParameterRow) -> Option<[f64; 2]> {
    row.interval.or(row.interval_naive).filter(|[low, high]| drawable(*low) && drawable(*high) && low <= high)
}

/// The rows of a group that share a ruler.
struct Part<'a> {
    /// Empty where it continues the group before it.
    name: &'a str,
    colour: RGBColor,
    rows: Vec<(&'a ParameterRow, Ground)>,
    axis: Axis,
}

impl Part<'_> {
    fn kind(&self) -> (usize, &'static str) {
        self.rows.first().map_or((3, ""), |(_, ground)| ground.ruler())
    }

    fn height(&self) -> f64 {
        let heading = if self.name.is_empty() { 0.0 } else { ROWS[0] };
        heading + row_height() * self.rows.len() as f64 + if self.kind().1.is_empty() { 0.0 } else { RULER }
    }
}

fn row_height() -> f64 {
    ROWS[usize::from(is_narrow())]
}

fn parts<'a>(groups: &[Group<'a>]) -> Vec<Part<'a>> {
    let mut parts = Vec::new();
    for (group, colour) in groups.iter().zip(MODEL_COLOURS.into_iter().cycle()) {
        let rows: Vec<_> = group.rows.iter().map(|row| (row, Ground::of(row, group.beliefs))).collect();
        let mut name = group.name;
        for kind in 0..4 {
            let rows: Vec<_> = rows.iter().copied().filter(|(_, ground)| ground.ruler().0 == kind).collect();
            if rows.is_empty() {
                continue;
            }
            let axis = axis(&rows);
            parts.push(Part { name, colour, rows, axis });
            name = "";
        }
    }
    parts
}

/// A ruler for rows of one kind: it holds the ground and all ends but those that are far out.
fn axis(rows: &[(&ParameterRow, Ground)]) -> Axis {
    let least: &[f64] = match rows[0].1 {
        Ground::Belief(..) => &[-2.2, 2.2],
        _ => &[-1.0, 1.0],
    };
    let farthest = |(row, ground): &(&ParameterRow, Ground)| {
        let [low, high] = ends(row).unwrap_or([row.value; 2]).map(|end| ground.along(end));
        low.abs().max(high.abs())
    };
    let mut far: Vec<f64> = rows.iter().map(farthest).filter(|far| drawable(*far)).collect();
    far.sort_by(f64::total_cmp);
    let most = match far[..] {
        [.., second, last] if last > TOO_FAR * second.max(least[1]) => 1.5 * second.max(least[1]),
        [.., last] => last.max(least[1]),
        [] => least[1],
    };
    let ends = rows.iter().flat_map(|(row, ground)| ends(row).unwrap_or([row.value; 2]).map(|end| ground.along(end)));
    Axis::over(ends.filter(|end| drawable(*end)).map(|end| end.clamp(-most, most)).chain(least.iter().copied()), 0.04)
}

/// Where bars begin and end \[px\].
fn bars() -> [f64; 2] {
    if is_narrow() { [12.0, width() - 16.0] } else { [left() + 140.0, width() - RIGHT - NUMBERS] }
}

fn place(axis: &Axis, at: f64) -> f64 {
    let [from, to] = bars();
    from + axis.share(at) * (to - from)
}

/// Draws groups of parameters.
pub(in crate::report) fn interval_bars(title: &str, groups: &[Group<'_>]) -> Result<String, ReportError> {
    let parts = parts(groups);
    let has = |kind: usize| parts.iter().any(|part| part.kind().0 == kind);
    let mut names: Vec<LegendEntry> = vec![
        (Sign::Dot, INK.to_rgba(), "estimate".to_owned()),
        (Sign::Line, INK.to_rgba(), "95 % interval".to_owned()),
        (Sign::Box, INK.mix(0.35), "naive interval (white residuals)".to_owned()),
    ];
    if has(0) {
        names.push((Sign::Box, BAND.mix(BELIEF_OPACITY), "what was believed, 95 %".to_owned()));
    }
    let top = legend_end(&names) + 6.0;
    let height = top + parts.iter().map(Part::height).sum::<f64>() + 12.0;
    sketch(title, height, |root| {
        legend(root, &names)?;
        let mut y = top;
        for part in &parts {
            draw_part(root, part, y)?;
            y += part.height();
        }
        Ok(())
    })
}

fn draw_part(root: &Area<'_>, part: &Part<'_>, mut y: f64) -> Drawn {
    let (kind, label) = part.kind();
    if !part.name.is_empty() {
        let from = if is_narrow() { 12.0 } else { 20.0 };
        text(root, (from, y + 0.5 * ROWS[0]), part.name, Look { bold: true, ..Look::default() })?;
        y += ROWS[0];
    }
    let end = y + row_height() * part.rows.len() as f64;
    if !label.is_empty() {
        if kind == 0 {
            let corners = [(px(place(&part.axis, -HALF_95)), px(y)), (px(place(&part.axis, HALF_95)), px(end))];
            root.draw(&Rectangle::new(corners, filled(BAND, BELIEF_OPACITY)))?;
        }
        let look = Look { size: 11.0, anchor: HPos::Center, ..Look::default() };
        for (tick, words) in part.axis.ticks() {
            let x = px(place(&part.axis, *tick));
            let style = if *tick == 0.0 { stroke(MEASURED, 0.75) } else { stroke(GRID, 0.5) };
            root.draw(&PathElement::new([(x, px(y)), (x, px(end))], style))?;
            text(root, (place(&part.axis, *tick), end + 10.0), words, look)?;
        }
        let middle = 0.5 * (bars()[0] + bars()[1]);
        text(root, (middle, end + 28.0), label, Look { anchor: HPos::Center, ..Look::default() })?;
    }
    for (row, ground) in &part.rows {
        parameter(root, y, row, *ground, part)?;
        y += row_height();
    }
    Ok(())
}

fn parameter(root: &Area<'_>, top: f64, row: &ParameterRow, ground: Ground, part: &Part<'_>) -> Drawn {
    let cells = ParameterCells::from(row);
    let said = said(row, &cells);
    spot(root, [0.0, top], [width(), row_height()], &format!("{}: {}", cells.label, in_full(row, &cells)));
    let label = Look::default();
    let numbers = Look { size: 11.0, colour: if is_shown(row) { INK } else { MEASURED }, ..label };
    let y = if is_narrow() {
        let (from, to) = (12.0, width() - 8.0);
        let said = numbers.fit(&said, 0.6 * width());
        let room = to - from - numbers.width(&said) - 10.0;
        text(root, (from, top + 12.0), &label.fit(&cells.label, room), label)?;
        text(root, (to, top + 12.0), &said, Look { anchor: HPos::Right, ..numbers })?;
        top + 29.0
    } else {
        let y = top + 0.5 * row_height();
        let right = Look { anchor: HPos::Right, ..label };
        text(root, (bars()[0] - 12.0, y), &right.fit(&cells.label, bars()[0] - 24.0), right)?;
        let from = bars()[1] + 18.0;
        text(root, (from, y), &numbers.fit(&said, width() - 8.0 - from), numbers)?;
        y
    };
    if ground == Ground::Words {
        return Ok(());
    }
    let at = |value: f64| place(&part.axis, ground.along(value));
    let styles = [(row.interval_naive, stroke(part.colour.mix(0.45), 8.0)), (row.interval, stroke(part.colour, 1.75))];
    for (interval, style) in styles {
        if let Some([low, high]) = interval.filter(|interval| interval.iter().all(|end| !end.is_nan())) {
            root.draw(&PathElement::new([(px(at(low)), px(y)), (px(at(high)), px(y))], style))?;
        }
    }
    for (is_high, end) in ends(row).unwrap_or([row.value; 2]).into_iter().enumerate().map(|(k, end)| (k == 1, end)) {
        let along = ground.along(end);
        if (is_high && along > part.axis.high()) || (!is_high && along < part.axis.low()) {
            root.draw(&arrow(at(end), y, is_high, part.colour))?;
        }
    }
    let along = ground.along(row.value);
    if (part.axis.low()..=part.axis.high()).contains(&along) {
        root.draw(&Circle::new((px(at(row.value)), px(y)), px(4.0), filled(part.colour, 1.0)))?;
    }
    Ok(())
}

/// The end of an interval that goes on beyond the ruler.
fn arrow(x: f64, y: f64, to_right: bool, colour: RGBColor) -> Polygon<(i32, i32)> {
    let ahead = if to_right { 8.0 } else { -8.0 };
    let corners = [(x - 0.2 * ahead, y - 6.0), (x + 0.8 * ahead, y), (x - 0.2 * ahead, y + 6.0)];
    Polygon::new(corners.map(|(x, y)| (px(x), px(y))), filled(colour, 1.0))
}

/// The estimate in few words.
fn said(row: &ParameterRow, cells: &ParameterCells) -> String {
    let unit = typeset_unit(&cells.unit);
    if !is_shown(row) {
        return match cells.estimate.as_str() {
            "not determined" => "these logs do not determine it".to_owned(),
            held => format!("{held} {unit}").trim_end().to_owned(),
        };
    }
    let Some([low, high]) = ends(row) else { return format!("{} {unit}, interval unknown", cells.estimate) };
    let share = 100.0 * 0.5 * (high - low) / row.value.abs();
    let share = if share < 1000.0 { format!(" (±{} %)", significant(share, 2)) } else { String::new() };
    let nominal = row.nominal.map(|_| format!(", nominal {}", cells.nominal)).unwrap_or_default();
    format!("{} {unit}{share}{nominal}", cells.estimate)
}

/// The same with its interval.
fn in_full(row: &ParameterRow, cells: &ParameterCells) -> String {
    let interval = if cells.interval.is_empty() { String::new() } else { format!(", 95 % {}", cells.interval) };
    said(row, cells) + &interval
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::ParameterStatus;

    fn row(name: &str, value: f64, half: f64, nominal: Option<f64>) -> ParameterRow {
        ParameterRow {
            name: name.into(),
            symbol: String::new(),
            unit: "N m".into(),
            status: ParameterStatus::Determined,
            value,
            interval: Some([value - half, value + half]),
            interval_naive: None,
            nominal,
        }
    }

    #[test]
    fn a_wide_interval_is_drawn_wider_than_a_narrow_one() {
        let belief = |name: &str, sd: f64| BeliefFound {
            name: name.into(),
            believed: 1.0,
            sd,
            found: 1.1,
            moved_sd: 0.1 / sd,
            unit: "N m".into(),
        };
        let rows = [row("a", 1.1, 0.1, Some(1.0)), row("b", 1.1, 0.4, Some(1.0)), row("c", 2.0, 0.1, None)];
        let beliefs = [belief("a", 0.2), belief("b", 0.2)];
        let parts = parts(&[Group { name: "joint", rows: &rows, beliefs: &beliefs }]);
        let kinds: Vec<_> = parts.iter().map(|part| (part.kind().0, part.rows.len())).collect();
        assert_eq!(kinds, [(0, 2), (2, 1)]);
        let long = |k: usize| {
            let (row, ground) = parts[0].rows[k];
            let [low, high] = row.interval.unwrap().map(|end| place(&parts[0].axis, ground.along(end)));
            high - low
        };
        assert!((long(1) / long(0) - 4.0).abs() < 0.01, "{} {}", long(0), long(1));
    }

    #[test]
    fn one_end_that_is_far_out_does_not_flatten_the_others() {
        let rows = [row("a", 1.1, 0.1, Some(1.0)), row("b", 1.0, 0.2, Some(1.0)), row("c", 300.0, 1.0, Some(1.0))];
        let parts = parts(&[Group { name: "joint", rows: &rows, beliefs: &[] }]);
        assert!(parts[0].axis.high() < 100.0, "{}", parts[0].axis.high());
    }
}
