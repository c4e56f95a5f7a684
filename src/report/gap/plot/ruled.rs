//! Named rows over a ruler: the ground of bars and dots.

use plotters::prelude::PathElement;
use plotters::style::RGBColor;
use plotters::style::text_anchor::HPos;

use crate::report::plot::axis::Axis;
use crate::report::plot::canvas::{Area, Drawn, Look, px, stroke, text};

/// Height of a row \[px\].
pub(super) const ROW: f64 = 26.0;
/// Room for the ruler and its label under the rows \[px\].
pub(super) const RULER: f64 = 50.0;
/// Where names end \[px\].
const NAMES_END: f64 = 250.0;
const GRID: RGBColor = RGBColor(224, 224, 224);

/// Rows under each other, a ruler below them.
pub(super) struct Ruled<'a> {
    pub axis: &'a Axis,
    pub label: &'a str,
    /// Where the ruler ends \[px\].
    pub right: f64,
    pub top: f64,
    pub rows: usize,
}

impl Ruled<'_> {
    /// Where the ruler begins \[px\].
    pub const LEFT: f64 = NAMES_END + 12.0;

    /// Place of a coordinate of the axis \[px\].
    pub fn x(&self, at: f64) -> f64 {
        Self::LEFT + self.axis.share(at) * (self.right - Self::LEFT)
    }

    /// Middle of a row \[px\].
    pub fn y(&self, row: usize) -> f64 {
        self.top + (row as f64 + 0.5) * ROW
    }

    pub fn bottom(&self) -> f64 {
        self.top + self.rows as f64 * ROW
    }

    /// Lines of the ruler, its ticks and its label.
    pub fn draw(&self, root: &Area<'_>) -> Drawn {
        let centred = Look { anchor: HPos::Center, ..Look::default() };
        for (at, words) in self.axis.ticks() {
            self.upright(root, *at, GRID, 0.5)?;
            text(root, (self.x(*at), self.bottom() + 12.0), words, Look { size: 11.0, ..centred })?;
        }
        let middle = 0.5 * (Self::LEFT + self.right);
        text(root, (middle, self.bottom() + 36.0), self.label, centred)
    }

    /// A line through all rows.
    pub fn upright(&self, root: &Area<'_>, at: f64, colour: RGBColor, width: f64) -> Drawn {
        let x = px(self.x(at));
        root.draw(&PathElement::new([(x, px(self.top)), (x, px(self.bottom()))], stroke(colour, width)))
    }

    pub fn name(&self, root: &Area<'_>, row: usize, words: &str, bold: bool) -> Drawn {
        let look = Look { anchor: HPos::Right, bold, ..Look::default() };
        text(root, (NAMES_END, self.y(row)), &look.fit(words, NAMES_END - 16.0), look)
    }
}
