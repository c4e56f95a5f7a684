//! A table that is the same in the terminal and on the page.

use comfy_table::Cell;
use minijinja::{Value, context};

use super::rows::shorten;
use super::text::{finish, number, one_line, table};

/// Characters of a name in a terminal.
const NAME: usize = 36;

/// A column of names, then columns of numbers. Heads may have two lines.
pub(super) struct Grid {
    pub name: &'static str,
    pub numbers: Vec<&'static str>,
    /// Each with its name and as many numbers as there are heads.
    pub rows: Vec<(String, Vec<String>)>,
}

impl Grid {
    /// For a terminal.
    pub fn text(&self, width: usize) -> String {
        let mut rows = table(width, &[self.name], &self.numbers);
        for (name, numbers) in &self.rows {
            let name = Cell::new(shorten(&one_line(name), NAME));
            rows.add_row(std::iter::once(name).chain(numbers.iter().cloned().map(number)));
        }
        finish(&mut rows)
    }

    /// For a page's template.
    pub fn view(&self) -> Value {
        let columns: Vec<&str> = std::iter::once(self.name).chain(self.numbers.iter().copied()).collect();
        let row = |(name, numbers): &(String, Vec<String>)| -> Vec<String> {
            std::iter::once(name).chain(numbers).cloned().collect()
        };
        context! { columns, rows => self.rows.iter().map(row).collect::<Vec<_>>() }
    }
}
