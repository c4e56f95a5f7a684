//! Named rows over a ruler: the ground of bars and dots.

use plotters::prelude::PathElement;
use plotters::style::RGBColor;
use plotters::style::text_anchor::HPos;

use crate::report::plot::axis::Axis;
use crate::report::plot::canvas::{Area, Drawn, GRID, Look, px, spot, stroke, text, width};
use crate::report::plot::layout::is_narrow;

/// Height of a row \[px\]; in a narrow figure its name stands above it.
const ROWS: [f64; 2] = [26.0, 44.0];
/// Room for the ruler and its label under the rows \[px\].
pub(super) const RULER: f64 = 50.0;
/// Where names end \[px\].
const NAMES_END: f64 = 250.0;
/// Where a narrow figure's rows begin \[px\].
const NARROW_LEFT: f64 = 10.0;
/// Width of a mark, and how far it reaches to both sides of a narrow figure's bars \[px\].
const MARK: f64 = 2.0;
const BESIDE: f64 = 11.0;

/// Rows under each other, a ruler below them.
pub(super) struct Ruled<'a> {
    pub axis: &'a Axis,
    pub label: &'a str,
    /// Where the ruler ends \[px\].
    pub right: f64,
    pub top: f64,
    pub rows: usize,
}

/// Height of a row \[px\].
pub(super) fn row_height() -> f64 {
    ROWS[usize::from(is_narrow())]
}

impl Ruled<'_> {
    /// Where the ruler begins \[px\].
    pub fn left() -> f64 {
        if is_narrow() { NARROW_LEFT } else { NAMES_END + 12.0 }
    }

    /// Place of a coordinate of the axis \[px\].
    pub fn x(&self, at: f64) -> f64 {
        Self::left() + self.axis.share(at) * (self.right - Self::left())
    }

    /// Middle of a row's bar \[px\].
    pub fn y(&self, row: usize) -> f64 {
        self.top + (row as f64 + if is_narrow() { 0.7 } else { 0.5 }) * row_height()
    }

    /// What there is to say of a row.
    pub fn says(&self, root: &Area<'_>, row: usize, words: &str) {
        spot(root, [0.0, self.top + row as f64 * row_height()], [width(), row_height()], words);
    }

    pub fn bottom(&self) -> f64 {
        self.top + self.rows as f64 * row_height()
    }

    /// Lines of the ruler, its ticks and its label.
    pub fn draw(&self, root: &Area<'_>) -> Drawn {
        let centred = Look { anchor: HPos::Center, ..Look::default() };
        let ticks = Look { size: 11.0, ..centred };
        let mut written_to = f64::NEG_INFINITY;
        for (at, words) in self.axis.ticks() {
            self.upright(root, *at, GRID, 0.5)?;
            // Labels that would meet are left out.
            let half = 0.5 * ticks.width(words);
            if self.x(*at) - half > written_to + 3.0 {
                text(root, (self.x(*at), self.bottom() + 12.0), words, ticks)?;
                written_to = self.x(*at) + half;
            }
        }
        let middle = if is_narrow() { 0.5 * width() } else { 0.5 * (Self::left() + self.right) };
        text(root, (middle, self.bottom() + 36.0), self.label, centred)
    }

    /// A line through all rows.
    pub fn upright(&self, root: &Area<'_>, at: f64, colour: RGBColor, width: f64) -> Drawn {
        let x = px(self.x(at));
        root.draw(&PathElement::new([(x, px(self.top)), (x, px(self.bottom()))], stroke(colour, width)))
    }

    /// A mark at one value of every row; where names stand above their bars it is drawn beside the bars alone.
    pub fn mark(&self, root: &Area<'_>, at: f64, colour: RGBColor) -> Drawn {
        if !is_narrow() {
            return self.upright(root, at, colour, MARK);
        }
        let x = px(self.x(at));
        for row in 0..self.rows {
            let ends = [self.y(row) - BESIDE, self.y(row) + BESIDE].map(|y| (x, px(y)));
            root.draw(&PathElement::new(ends, stroke(colour, MARK)))?;
        }
        Ok(())
    }

    pub fn name(&self, root: &Area<'_>, row: usize, words: &str, bold: bool) -> Drawn {
        let look = Look { bold, ..Look::default() };
        if is_narrow() {
            let above = self.top + (row as f64 + 0.2) * row_height();
            return text(root, (NARROW_LEFT, above), &look.fit(words, width() - 2.0 * NARROW_LEFT), look);
        }
        let look = Look { anchor: HPos::Right, ..look };
        text(root, (NAMES_END, self.y(row)), &look.fit(words, NAMES_END - 16.0), look)
    }
}
