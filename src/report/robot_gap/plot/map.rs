//! Where the gap lies: joint by phase, on a sketch of the robot and as a table.

use plotters::prelude::{Circle, PathElement, Polygon, Rectangle};
use plotters::style::text_anchor::HPos;
use plotters::style::{Color, RGBColor};

use super::sketch::{JointDot, Sketch};
use crate::gap::robot::{GaitCell, GaitPhase, RobotDiagnosis};
use crate::report::ReportError;
use crate::report::number::significant;
use crate::report::plot::canvas::{
    AFTER, Area, Drawn, INK, Look, POSITIVE, RIGHT, SHADE, Sign, filled, left, legend, legend_end, px, sketch, spot,
    stroke, text, width,
};
use crate::report::plot::heat::{Heat, HeatCell, NO_VALUE, draw_cell, heat, tint};
use crate::report::robot_gap::words::joints_and_phases;
use crate::report::rows::without_common_end;

/// Height of a joint's cells, and the room between those of two legs \[px\].
const ROW: f64 = 30.0;
const BETWEEN: f64 = 14.0;
/// Columns \[px\]: names end and cells begin left, cells end left; the same mirrored on the right.
const NAMES: f64 = 92.0;
const CELLS: [f64; 2] = [98.0, 294.0];
/// The robot lies between these columns \[px\].
const ROBOT: [f64; 2] = [324.0, 596.0];
/// Largest height of the robot \[px\].
const TALLEST: f64 = 460.0;
const PART: RGBColor = RGBColor(238, 238, 238);
const EDGE: RGBColor = RGBColor(190, 190, 190);

/// Words over the columns of cells.
fn short(phase: GaitPhase) -> &'static str {
    match phase {
        GaitPhase::TouchDown => "touch",
        other => other.name(),
    }
}

/// The cells of a diagnosis with their scale.
struct Map<'a> {
    cells: &'a [GaitCell],
    joints: Vec<&'a str>,
    phases: Vec<GaitPhase>,
    most_rad: f64,
}

impl<'a> Map<'a> {
    fn of(diagnosis: &'a RobotDiagnosis) -> Self {
        let cells = &diagnosis.location.cells;
        let (joints, phases) = joints_and_phases(cells);
        let most_rad = cells.iter().map(|cell| cell.excess_rad).filter(|x| x.is_finite()).fold(0.0, f64::max);
        Self { cells, joints, phases, most_rad }
    }

    fn cell(&self, joint: &str, phase: GaitPhase) -> HeatCell {
        match self.cells.iter().find(|cell| cell.joint == joint && cell.phase == phase) {
            Some(cell) => HeatCell {
                ground: self.ground(cell),
                words: significant(1e3 * cell.excess_rad, 2),
                framed: cell.significant,
            },
            None => HeatCell { ground: NO_VALUE, words: String::new(), framed: false },
        }
    }

    fn ground(&self, cell: &GaitCell) -> RGBColor {
        let share = if self.most_rad > 0.0 { cell.excess_rad / self.most_rad } else { 0.0 };
        tint(if cell.significant { POSITIVE } else { SHADE }, share)
    }

    /// Colour of a joint: that of its largest cell; `None` where it is not compared.
    fn dot(&self, joint: &str) -> Option<RGBColor> {
        let cells = self.cells.iter().filter(|cell| cell.joint == joint);
        cells
            .max_by(|a, b| {
                (a.significant, a.excess_rad)
                    .partial_cmp(&(b.significant, b.excess_rad))
                    .unwrap_or(std::cmp::Ordering::Equal)
            })
            .map(|cell| self.ground(cell))
    }

    fn most(&self) -> String {
        format!("{} mrad", significant(1e3 * self.most_rad, 2))
    }
}

/// A joint's cells beside the robot.
struct Strip<'a> {
    joint: &'a JointDot,
    is_left: bool,
    y: f64,
}

/// Draws the map on a sketch of the robot: seen from above, its front upwards, legs spread out.
pub(super) fn on_robot(diagnosis: &RobotDiagnosis, robot: &Sketch) -> Result<String, ReportError> {
    let map = Map::of(diagnosis);
    let names = [
        (Sign::Box, POSITIVE.to_rgba(), "gap above the noise".to_owned()),
        (Sign::Box, SHADE.to_rgba(), "no more than chance".to_owned()),
        (
            Sign::Dot,
            AFTER.to_rgba(),
            if diagnosis.answer.first.is_some() { "the cause is here" } else { "most of the gap is here" }.to_owned(),
        ),
    ];
    let top = legend_end(&names) + 24.0;
    let [left_m, right_m, rear_m, front_m] = robot.extent_m();
    let scale = ((ROBOT[1] - ROBOT[0]) / (right_m - left_m)).min(TALLEST / (front_m - rear_m));
    let tall = (scale * (front_m - rear_m)).max(0.5 * (ROW + BETWEEN) * map.joints.len() as f64);
    let (middle_x, middle_y) = (0.5 * (ROBOT[0] + ROBOT[1]), top + 0.5 * tall);
    let place = |[x, y]: [f64; 2]| {
        (middle_x + scale * (x - 0.5 * (left_m + right_m)), middle_y - scale * (y - 0.5 * (rear_m + front_m)))
    };
    let strips = strips(&map, robot, &place, [top, top + tall]);
    let bottom = strips.iter().map(|strip| strip.y + 0.5 * ROW).fold(top + tall, f64::max);

    sketch(&format!("{}: where the gap lies", diagnosis.robot), bottom + 56.0, |root| {
        legend(root, &names)?;
        for part in &robot.parts {
            let corners: Vec<_> = part.iter().map(|at| place(*at)).map(|(x, y)| (px(x), px(y))).collect();
            let edge: Vec<_> = corners.iter().chain(corners.first()).copied().collect();
            root.draw(&Polygon::new(corners, filled(PART, 1.0)))?;
            root.draw(&PathElement::new(edge, stroke(EDGE, 0.75)))?;
        }
        for strip in &strips {
            let (x, y) = place(strip.joint.at_m);
            let end = if strip.is_left { CELLS[1] + 3.0 } else { width() - CELLS[1] - 3.0 };
            root.draw(&PathElement::new([(px(end), px(strip.y)), (px(x), px(y))], stroke(SHADE, 0.75)))?;
        }
        for joint in &robot.joints {
            let (x, y) = place(joint.at_m);
            let at = (px(x), px(y));
            if diagnosis.location.joints.contains(&joint.name) {
                root.draw(&Circle::new(at, px(9.0), filled(AFTER, 1.0)))?;
            }
            let (colour, radius) = map.dot(&joint.name).map_or((EDGE, 2.5), |colour| (colour, 5.5));
            root.draw(&Circle::new(at, px(radius + 1.0), filled(INK, 1.0)))?;
            root.draw(&Circle::new(at, px(radius), filled(colour, 1.0)))?;
        }
        let names: Vec<&str> = strips.iter().map(|strip| strip.joint.name.as_str()).collect();
        let has_room = names.iter().all(|name| Look::default().width(name) <= NAMES - 20.0);
        let names = if has_room { names } else { without_common_end(&names) };
        for (strip, name) in strips.iter().zip(names) {
            draw_strip(root, &map, (strip, name), diagnosis.location.joints.contains(&strip.joint.name))?;
        }
        for is_left in [true, false] {
            let first = strips.iter().filter(|strip| strip.is_left == is_left).map(|strip| strip.y);
            let y = first.fold(f64::INFINITY, f64::min) - 0.5 * ROW - 9.0;
            for (k, phase) in map.phases.iter().enumerate().filter(|_| y.is_finite()) {
                let look = Look { size: 10.0, anchor: HPos::Center, ..Look::default() };
                text(root, (cell_x(&map, is_left, k as f64 + 0.5), y), short(*phase), look)?;
            }
        }
        let front = Look { size: 11.0, colour: RGBColor(90, 90, 90), anchor: HPos::Center, ..Look::default() };
        text(root, (middle_x, middle_y - 0.5 * scale * (front_m - rear_m) - 10.0), "front", front)?;
        scale_bar(root, &map, bottom + 26.0)
    })
}

/// Where a column of cells begins \[px\].
fn cell_x(map: &Map<'_>, is_left: bool, column: f64) -> f64 {
    let begin = if is_left { CELLS[0] } else { width() - CELLS[1] };
    begin + column * (CELLS[1] - CELLS[0]) / map.phases.len().max(1) as f64
}

/// Cells to the left of the robot for what is on its left, close to their leg and one under the other.
fn strips<'a>(
    map: &Map<'_>,
    robot: &'a Sketch,
    place: &dyn Fn([f64; 2]) -> (f64, f64),
    [top, bottom]: [f64; 2],
) -> Vec<Strip<'a>> {
    let shown: Vec<&JointDot> = robot.joints.iter().filter(|joint| map.joints.contains(&joint.name.as_str())).collect();
    let mut sides: [Vec<&JointDot>; 2] = [Vec::new(), Vec::new()];
    let on_side = |joint: &JointDot| joint.at_m[0].abs() > 5e-3;
    for joint in shown.iter().filter(|joint| on_side(joint)).chain(shown.iter().filter(|joint| !on_side(joint))) {
        let is_left = if on_side(joint) { joint.at_m[0] < 0.0 } else { sides[0].len() <= sides[1].len() };
        sides[usize::from(!is_left)].push(joint);
    }
    let mut strips = Vec::new();
    for (side, mut joints) in sides.into_iter().enumerate() {
        let front = |joint: &JointDot| robot.joints[joint.chain].at_m[1];
        joints.sort_by(|a, b| front(b).total_cmp(&front(a)));
        let mut y = f64::NEG_INFINITY;
        let mut heights = Vec::new();
        for chain in joints.chunk_by(|a, b| a.chain == b.chain) {
            let middle = chain.iter().map(|joint| place(joint.at_m).1).sum::<f64>() / chain.len() as f64;
            let wished = middle - 0.5 * ROW * (chain.len() as f64 - 1.0);
            let begin = wished.max(y + BETWEEN).max(top + 0.5 * ROW);
            heights.extend((0..chain.len()).map(|k| begin + k as f64 * ROW));
            y = begin + chain.len() as f64 * ROW;
        }
        // What hangs over the bottom moves up, as far as there is room.
        let over = heights.last().map_or(0.0, |last| last + 0.5 * ROW - bottom).max(0.0);
        let room = heights.first().map_or(0.0, |first| first - 0.5 * ROW - top).max(0.0);
        let up = over.min(room);
        strips.extend(joints.iter().zip(heights).map(|(joint, y)| Strip { joint, is_left: side == 0, y: y - up }));
    }
    strips
}

fn draw_strip(root: &Area<'_>, map: &Map<'_>, (strip, name): (&Strip<'_>, &str), is_blamed: bool) -> Drawn {
    let (x, anchor) = if strip.is_left { (NAMES, HPos::Right) } else { (width() - NAMES, HPos::Left) };
    let look = Look { bold: is_blamed, colour: if is_blamed { AFTER } else { INK }, anchor, ..Look::default() };
    text(root, (x, strip.y), &look.fit(name, NAMES - 20.0), look)?;
    let width = cell_x(map, true, 1.0) - cell_x(map, true, 0.0);
    for (column, phase) in map.phases.iter().enumerate() {
        let corner = [cell_x(map, strip.is_left, column as f64), strip.y - 0.5 * ROW + 1.0];
        let cell = map.cell(&strip.joint.name, *phase);
        draw_cell(root, corner, [width, ROW - 2.0], &cell, 11.0)?;
        spot(root, corner, [width, ROW - 2.0], &format!("{}, {}: {} mrad", strip.joint.name, phase.name(), cell.words));
    }
    Ok(())
}

/// From white to the largest cell.
fn scale_bar(root: &Area<'_>, map: &Map<'_>, y: f64) -> Drawn {
    const STEPS: usize = 40;
    let (from, to) = (left() + 150.0, width() - RIGHT - 250.0);
    let step = (to - from) / STEPS as f64;
    for (row, colour) in [(y - 7.0, POSITIVE), (y, SHADE)] {
        for k in 0..STEPS {
            let x = from + k as f64 * step;
            let corners = [(px(x), px(row)), (px(x + step), px(row + 7.0))];
            root.draw(&Rectangle::new(corners, filled(tint(colour, (k as f64 + 0.5) / STEPS as f64), 1.0)))?;
        }
    }
    let look = Look { size: 11.0, ..Look::default() };
    text(root, (from - 8.0, y), "0 mrad", Look { anchor: HPos::Right, ..look })?;
    text(root, (to + 8.0, y), &format!("{} RMS; framed: significant", map.most()), look)
}

/// Draws the same map as a table.
pub(super) fn table(diagnosis: &RobotDiagnosis) -> Result<String, ReportError> {
    let map = Map::of(diagnosis);
    let rows: Vec<String> = map.joints.iter().map(|joint| (*joint).to_owned()).collect();
    let columns: Vec<String> = map.phases.iter().map(|phase| phase.name().to_owned()).collect();
    let table = Heat {
        title: &format!("{}: gap above the noise by joint and phase [mrad RMS]", diagnosis.robot),
        rows: &rows,
        columns: &columns,
        name_room: 60.0,
        cell: [110.0, if rows.len() > 14 { 22.0 } else { 28.0 }],
        names_above: true,
        axes: ["", ""],
        colour: |share| tint(POSITIVE, share),
        scale: &[(1.0, &map.most()), (0.0, "0 mrad")],
        nothing: "no joint moves",
    };
    heat(&table, |row, column| match (map.joints.get(row), map.phases.get(column)) {
        (Some(joint), Some(phase)) => map.cell(joint, *phase),
        _ => HeatCell { ground: NO_VALUE, words: String::new(), framed: false },
    })
}
