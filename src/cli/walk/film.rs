//! The walk as a moving picture (Figure 4.4).

use super::super::CliError;
use crate::log::Outputs;
use crate::report::{self, Animation, GifOptions, animation_gif, animation_html};
use crate::robot::Model;
use crate::robot::simulate::Recording;
use std::path::Path;

/// Cycles of the gait that the small picture shows.
const CYCLES: f64 = 2.0;

/// Adds `animation.html` and `walk.gif`.
pub(super) fn add(
    outputs: &mut Outputs,
    folder: &Path,
    model: &Model,
    recording: &Recording,
    (title, note, period_s): (&str, &str, f64),
) -> Result<(), CliError> {
    let animation = Animation::new(title, note).with(model.name(), report::Recording::of_run(model, recording));
    let (from_s, to_s) = animation.span_s();
    let options = GifOptions { from_s: (to_s - CYCLES * period_s).max(from_s), to_s, ..GifOptions::default() };
    outputs.add(folder.join("animation.html"), animation_html(&animation)?);
    outputs.add(folder.join("walk.gif"), animation_gif(&animation, &options)?);
    Ok(())
}
