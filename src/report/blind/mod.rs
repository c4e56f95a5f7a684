//! The report of sealed trials.

mod confusion;
mod html;
mod reliability;
mod robot;
mod rows;
#[cfg(test)]
mod tests;
mod text;

pub use html::blind_html;
pub use robot::{RobotBlindReport, robot_blind_figures, robot_blind_html, robot_blind_text};
pub use text::blind_text;

use super::plot::Figure;
use super::{Provenance, ReportError};
use crate::blind::{Score, Trial};
use confusion::confusion;
use reliability::reliability;

/// Sealed trials, opened and scored.
#[derive(Clone, Debug)]
pub struct BlindReport<S = Score, R = Trial> {
    /// Seed of all that was drawn.
    pub seed: u64,
    /// SHA-256 of the answers, stated before the first diagnosis.
    pub sha256: String,
    /// The answers as they were opened have that hash.
    pub seal_holds: bool,
    /// The score.
    pub score: S,
    /// The trials.
    pub trials: Vec<R>,
    /// Where it comes from.
    pub provenance: Provenance,
}

/// Draws the figures: confusion, and reliability of the stated probabilities.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub fn blind_figures(report: &BlindReport) -> Result<Vec<Figure>, ReportError> {
    let score = &report.score;
    let figure = |file_name: &str, title: &str, caption: &str, svg: String| Figure {
        file_name: file_name.to_owned(),
        title: title.to_owned(),
        caption: caption.to_owned(),
        svg,
    };
    let map = confusion(&score.confusion)?;
    let top = reliability("Stated probabilities: the whole answer is right", &score.stated.bins)?;
    let set = reliability("Stated probabilities: what is there is in the set", &score.stated_set.bins)?;
    let caption = "Dots on the line: answers are right as often as they say. Below it, they are too sure.";
    Ok(vec![
        figure(
            "confusion.svg",
            "Confusion",
            "Framed cells are right answers. Of several effects at once the table tells only that several were named.",
            map,
        ),
        figure("reliability.svg", "Reliability", caption, top),
        figure("reliability-set.svg", "Reliability of the set", caption, set),
    ])
}
