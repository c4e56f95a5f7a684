//! The walk as a moving picture (Figure 4.4).

use super::super::CliError;
use crate::log::Outputs;
use crate::report::{self, Animation, GifOptions, animation_gif, animation_html};
use crate::robot::simulate::Recording;
use crate::robot::{Dynamics, Model, State};
use std::path::Path;

/// Time between two pictures [s].
const PICTURE_S: f64 = 0.04;
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
    let (mut dynamics, mut state) = (Dynamics::new(model), State::at_rest(model));
    let mut film = report::Recording::new(model);
    let mut next_s = f64::NEG_INFINITY;
    for (k, t_s) in recording.t_s.iter().enumerate() {
        if *t_s < next_s - 1e-9 {
            continue;
        }
        next_s = t_s + PICTURE_S;
        recording.state_at(k, &mut state);
        film.push(*t_s, dynamics.motions(&state));
    }
    let animation = Animation::new(title, note).with(model.name(), film);
    let (from_s, to_s) = animation.span_s();
    let options = GifOptions { from_s: (to_s - CYCLES * period_s).max(from_s), to_s, ..GifOptions::default() };
    outputs.add(folder.join("animation.html"), animation_html(&animation)?);
    outputs.add(folder.join("walk.gif"), animation_gif(&animation, &options)?);
    Ok(())
}
