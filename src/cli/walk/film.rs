//! The walk as a moving picture, and one cycle of it as a row of pictures (Figure 4.4).

use super::super::CliError;
use crate::log::Outputs;
use crate::report::{self, Animation, Figure, GifOptions, ReportError, animation_gif, animation_html, animation_strip};
use crate::robot::simulate::Recording;
use crate::robot::{Dynamics, Model, State};
use std::path::Path;

/// Time between two pictures [s].
const PICTURE_S: f64 = 0.04;
/// Cycles of the gait that the small picture shows.
const CYCLES: f64 = 2.0;

/// A walk's pictures.
pub(super) struct Film {
    animation: Animation,
    /// Of the gait [s].
    period_s: f64,
}

impl Film {
    /// Takes the pictures.
    pub fn of(model: &Model, recording: &Recording, (title, note, period_s): (&str, &str, f64)) -> Self {
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
        Self { animation: Animation::new(title, note).with(model.name(), film), period_s }
    }

    /// The last whole cycle, where there is one.
    pub fn cycle(&self) -> Result<Option<Figure>, ReportError> {
        let (begin_s, end_s) = self.animation.span_s();
        let from_s = end_s - self.period_s;
        if from_s <= begin_s { Ok(None) } else { animation_strip(&self.animation, from_s, self.period_s).map(Some) }
    }

    /// Adds `animation.html` and `walk.gif`.
    pub fn add(&self, outputs: &mut Outputs, folder: &Path) -> Result<(), CliError> {
        let (begin_s, to_s) = self.animation.span_s();
        let from_s = (to_s - CYCLES * self.period_s).max(begin_s);
        let options = GifOptions { from_s, to_s, ..GifOptions::default() };
        outputs.add(folder.join("animation.html"), animation_html(&self.animation)?);
        outputs.add(folder.join("walk.gif"), animation_gif(&self.animation, &options)?);
        Ok(())
    }
}
