//! The drop repeated by the whole robot (Figure 3.6): what the pendulum cannot know of, and what remains.

mod plot;
mod ranking;
mod text;

pub(super) use plot::full_figures;
pub use ranking::{RefitFit, RefitSummary};
pub(super) use ranking::{causes_figure, causes_table, refit_words};
pub(super) use text::{full_tables, full_text, summary};

use crate::gap::neighbours::{Apart, Repeated, RepeatedDrop};
use serde::{Deserialize, Serialize};

/// A drop in the full model beside the measurement and the pendulum.
#[derive(Clone, Debug, Default)]
pub struct FullDrop {
    /// One for each log that moves.
    pub rows: Vec<FullRow>,
    /// Their curves, in the same order.
    pub curves: Vec<FullCurves>,
    /// The whole robot refitted; `None` where no log begins held.
    pub refit: Option<RefitSummary>,
}

impl FullDrop {
    /// What was repeated, as it is shown.
    pub fn of(repeated: Repeated) -> Self {
        let refit = repeated.compared.as_ref().map(RefitSummary::of);
        let shown = repeated.drops.into_iter().map(|drop| (FullRow::of(&drop), FullCurves::of(drop)));
        let (rows, curves) = shown.unzip();
        Self { rows, curves, refit }
    }
}

/// Numbers of one log.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct FullRow {
    /// As the user named it.
    pub file: String,
    /// RMS of the extensive pendulum \[rad\].
    pub pendulum_rms: f64,
    /// The whole robot with the pendulum's values and the other joints held rigidly.
    pub rigid: HeldRow,
    /// The same with the other joints held by their controllers.
    pub controlled: HeldRow,
    /// How far another joint of the leg gives way there \[rad\].
    pub give: f64,
    /// Rigid, refitted in the whole robot.
    #[serde(default)]
    pub rigid_refitted: HeldRow,
    /// By controllers, refitted in the whole robot.
    #[serde(default)]
    pub controlled_refitted: HeldRow,
}

impl FullRow {
    fn of(drop: &RepeatedDrop) -> Self {
        Self {
            file: drop.file.clone(),
            pendulum_rms: drop.pendulum_rms_rad,
            rigid: drop.rigid.into(),
            controlled: drop.controlled.into(),
            give: drop.give_rad,
            rigid_refitted: drop.rigid_refitted.into(),
            controlled_refitted: drop.controlled_refitted.into(),
        }
    }
}

/// The full model against the measurement, with the other joints held in one way.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct HeldRow {
    /// RMS error \[rad\]; null where the motion ran away.
    pub rms: Option<f64>,
    /// First passage through the angle of rest, model less measurement \[s\]; null where there is none.
    pub first_swing: Option<f64>,
    /// Angle at rest, model less measurement \[rad\].
    pub rest: Option<f64>,
}

impl From<Apart> for HeldRow {
    fn from(apart: Apart) -> Self {
        Self { rms: apart.rms_rad, first_swing: apart.first_swing_s, rest: apart.rest_rad }
    }
}

/// Curves of one log.
#[derive(Clone, Debug, Default)]
pub struct FullCurves {
    /// As the user named it.
    pub file: String,
    /// \[s\]
    pub t_s: Vec<f64>,
    /// \[rad\]
    pub measured_rad: Vec<f64>,
    /// First sample that is compared.
    pub first: usize,
    /// \[rad\]
    pub pendulum_rad: Vec<f64>,
    /// \[rad\]
    pub rigid_rad: Vec<f64>,
    /// \[rad\]
    pub controlled_rad: Vec<f64>,
    /// Half a quantisation step \[rad\].
    pub half_step_rad: f64,
}

impl FullCurves {
    fn of(drop: RepeatedDrop) -> Self {
        Self {
            file: drop.file,
            t_s: drop.t_s,
            measured_rad: drop.measured_rad,
            first: drop.first,
            pendulum_rad: drop.pendulum_rad,
            rigid_rad: drop.rigid_rad,
            controlled_rad: drop.controlled_rad,
            half_step_rad: drop.half_step_rad,
        }
    }
}
