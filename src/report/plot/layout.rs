//! How wide a figure is drawn: for a page and a file, or for a narrow screen.

use std::cell::Cell;

/// Width of a figure on a page and in a file \[px\].
const WIDE: f64 = 920.0;
/// Width of a figure on a narrow screen: that of a page of 500 px without its margins \[px\].
const NARROW: f64 = 460.0;
/// Left margin that every chart keeps \[px\], wide and narrow.
const MARGINS: [f64; 2] = [84.0, 66.0];

thread_local! {
    static WIDTH: Cell<f64> = const { Cell::new(WIDE) };
}

/// Width of the figures that are being drawn \[px\].
pub(in crate::report) fn width() -> f64 {
    WIDTH.get()
}

/// Whether they are for a narrow screen.
pub(in crate::report) fn is_narrow() -> bool {
    width() < WIDE
}

/// Left margin that every chart keeps \[px\].
pub(in crate::report) fn left() -> f64 {
    MARGINS[usize::from(is_narrow())]
}

/// Where titles and legends begin \[px\].
pub(in crate::report) fn heading_left() -> f64 {
    if is_narrow() { 8.0 } else { left() }
}

/// Draws figures for a narrow screen: the same data, less wide, texts as large.
pub(in crate::report) fn narrow<T>(draw: impl FnOnce() -> T) -> T {
    /// Restores the width also where drawing panics.
    struct Back(f64);
    impl Drop for Back {
        fn drop(&mut self) {
            WIDTH.set(self.0);
        }
    }
    let _back = Back(WIDTH.replace(NARROW));
    draw()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_narrow_only_while_they_are_drawn_so() {
        assert_eq!(narrow(|| (width(), is_narrow())), (NARROW, true));
        assert_eq!((width(), is_narrow()), (WIDE, false));
    }
}
