//! What a figure's script may say of a place on it: axes of its charts, names of its colours, words of its spots.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::ops::Deref;
use std::rc::Rc;

use plotters::coord::Shift;
use plotters::prelude::{DrawingArea, SVGBackend};
use plotters::style::RGBAColor;
use serde_json::json;

use super::axis::Axis;

/// Box of a chart with its axes, in drawing units and in the axes' own numbers.
struct Panel {
    corners: [i32; 4],
    x: [f64; 2],
    y: [f64; 2],
    is_log: [bool; 2],
    labels: [String; 2],
}

/// What is gathered while a figure is drawn.
#[derive(Default)]
struct Gathered {
    panels: Vec<Panel>,
    names: BTreeMap<String, String>,
    spots: Vec<([i32; 4], String)>,
}

/// The ground of a figure, or a part of it, with what its script may say.
pub(in crate::report) struct Area<'a> {
    ground: DrawingArea<SVGBackend<'a>, Shift>,
    gathered: Rc<RefCell<Gathered>>,
}

impl<'a> Deref for Area<'a> {
    type Target = DrawingArea<SVGBackend<'a>, Shift>;

    fn deref(&self) -> &Self::Target {
        &self.ground
    }
}

impl<'a> Area<'a> {
    /// The ground of a figure that is begun.
    pub(super) fn new(ground: DrawingArea<SVGBackend<'a>, Shift>) -> Self {
        Self { ground, gathered: Rc::default() }
    }

    /// Its left and its right part, cut at a column in drawing units.
    pub(in crate::report) fn halves(&self, at: i32) -> [Self; 2] {
        let (left, right) = self.ground.split_horizontally(at);
        [left, right].map(|ground| Self { ground, gathered: Rc::clone(&self.gathered) })
    }

    /// A chart was drawn: lines and dots in its box have coordinates.
    pub(super) fn has_panel(&self, corners: [i32; 4], (x, y): (&Axis, &Axis), (x_label, y_label): (&str, &str)) {
        self.gathered.borrow_mut().panels.push(Panel {
            corners,
            x: [x.low(), x.high()],
            y: [y.low(), y.high()],
            is_log: [x.is_log(), y.is_log()],
            labels: [x_label.to_owned(), y_label.to_owned()],
        });
    }

    /// Lines and dots of a colour have this name.
    pub(super) fn has_name(&self, RGBAColor(red, green, blue, _): RGBAColor, name: &str) {
        let colour = format!("#{red:02X}{green:02X}{blue:02X}");
        self.gathered.borrow_mut().names.entry(colour).or_insert_with(|| name.to_owned());
    }

    /// A box, in drawing units, of which there is something to say.
    pub(super) fn has_spot(&self, corners: [i32; 4], words: &str) {
        self.gathered.borrow_mut().spots.push((corners, words.to_owned()));
    }

    /// All of it as JSON; `None` where there is nothing to say.
    pub(super) fn told(&self) -> Option<String> {
        let mut gathered = self.gathered.borrow_mut();
        // Of panels under each other only the last names the axis that they share.
        let mut below = String::new();
        for panel in gathered.panels.iter_mut().rev() {
            if panel.labels[0].is_empty() {
                panel.labels[0].clone_from(&below);
            }
            below.clone_from(&panel.labels[0]);
        }
        let Gathered { panels, names, spots } = &*gathered;
        if panels.is_empty() && spots.is_empty() {
            return None;
        }
        let panel = |of: &Panel| json!([of.corners, of.x, of.y, of.is_log, of.labels]);
        let panels: Vec<_> = panels.iter().map(panel).collect();
        Some(json!({ "panels": panels, "names": names, "spots": spots }).to_string())
    }
}
