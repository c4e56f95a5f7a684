//! The report of the thesis's chapter 3.

mod export;
mod figures;
mod html;
mod plane;
mod sections;
mod text;
mod words;

pub use export::{thesis_csv, thesis_json, thesis_markdown};
pub use figures::thesis_figures;
pub use html::thesis_html;
pub use text::thesis_text;

use super::Provenance;
use crate::thesis::Tables;

/// Chapter 3 repeated on a folder of swings.
#[derive(Clone, Debug)]
pub struct ThesisReport {
    /// The folder, as the user named it.
    pub data: String,
    /// What was found.
    pub tables: Tables,
    /// Where it comes from.
    pub provenance: Provenance,
}
