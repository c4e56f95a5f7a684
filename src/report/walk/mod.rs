//! The report of a walk: what was asked of the joints and what they did.

mod html;
mod panels;
mod plot;
mod study;
mod study_plot;
mod text;

pub use html::walk_html;
pub use plot::walk_figures;
pub use study::{StudyReport, StudyTable, study_html, study_text};
pub use study_plot::{
    Comparison, PairedCurves, before_and_after_figure, comparison_figure, joints_figure, sensitivity_figure,
    trunk_figure,
};
pub use text::walk_text;

use super::plot::canvas::{EXTENSIVE, GREEN, SETPOINT, SIMPLE};
use super::{Figure, Provenance};
use crate::robot::simulate::{Footfalls, TrunkCurves, Walked};
use plotters::style::RGBColor;
use serde::Serialize;

/// Colours of curves that stand beside each other.
pub(super) const COLOURS: [RGBColor; 4] = [EXTENSIVE, SIMPLE, GREEN, SETPOINT];

/// Everything that the report of `aibo-fit walk` shows.
#[derive(Clone, Debug, Serialize)]
pub struct WalkReport {
    /// The layout's version.
    pub schema: u32,
    /// Name of the robot.
    pub robot: String,
    /// Name of the gait, motion or table.
    pub gait: String,
    /// `floor` or `air`.
    pub scenario: String,
    /// One sentence a colleague would say.
    pub sentence: String,
    /// What the reader should know besides: limits that were exceeded, setpoints that were clipped.
    pub notes: Vec<String>,
    /// Method and step or tolerance, in words.
    pub method: String,
    /// Simulated time \[s\].
    pub duration_s: f64,
    /// How far the trunk went; absent in the air.
    #[serde(flatten)]
    pub ground: Option<Walked>,
    /// Simulated time over the time that the simulation took; no figure or page shows it.
    pub realtime_factor: f64,
    /// Evaluations of the equations of motion.
    pub evaluations: u64,
    /// Steps of the method that count.
    pub integration_steps: u64,
    /// Where the motion ran away, if it did.
    pub diverged: Option<Runaway>,
    /// Joints that were moved.
    pub joints: Vec<FollowRow>,
    /// Joints beyond their speed limits.
    pub speed_warnings: Vec<SpeedRow>,
    /// Legs to be drawn.
    #[serde(skip)]
    pub legs: Vec<LegCurves>,
    /// The trunk on its floor, to be drawn.
    #[serde(skip)]
    pub trunk: Option<TrunkCurves>,
    /// The feet on their floor, to be drawn.
    #[serde(skip)]
    pub footfalls: Option<Footfalls>,
    /// The robot at times of one cycle (Figure 4.4).
    #[serde(skip)]
    pub cycle: Option<Figure>,
    /// Time of one cycle of the gait \[s\].
    #[serde(skip)]
    pub cycle_s: f64,
    /// Where it comes from.
    #[serde(skip)]
    pub provenance: Provenance,
}

impl WalkReport {
    /// Robot, gait and where.
    pub fn title(&self) -> String {
        let place = if self.ground.is_some() { "on the floor" } else { "in the air" };
        format!("{}: {} {place}", self.robot, self.gait)
    }
}

/// A motion that ran away.
#[derive(Clone, Debug, Serialize)]
pub struct Runaway {
    /// When \[s\].
    pub at_s: f64,
    /// Which joint first; null: the base.
    pub joint: Option<String>,
    /// What may help.
    pub why: String,
}

/// A joint against its setpoint.
#[derive(Clone, Debug, Serialize)]
pub struct FollowRow {
    /// Its name.
    pub joint: String,
    /// Amplitude of the setpoint's fundamental \[rad\].
    pub amplitude_rad: f64,
    /// The joint's amplitude in units of the setpoint's.
    pub amplitude_ratio: f64,
    /// How much later the joint is \[s\].
    pub delay_s: f64,
    /// Root mean square of setpoint less reading \[rad\].
    pub rms_rad: f64,
    /// Largest difference \[rad\].
    pub worst_rad: f64,
    /// Largest speed \[rad/s\].
    pub peak_rad_s: f64,
}

/// A joint beyond its speed limit.
#[derive(Clone, Debug, Serialize)]
pub struct SpeedRow {
    /// Its name.
    pub joint: String,
    /// First sample beyond it \[s\].
    pub from_s: f64,
    /// Samples beyond it.
    pub samples: usize,
    /// Largest speed \[rad/s\].
    pub peak_rad_s: f64,
    /// The limit of Table A.3 \[rad/s\].
    pub limit_rad_s: f64,
}

/// Curves of one leg.
#[derive(Clone, Debug)]
pub struct LegCurves {
    /// `left front` for instance.
    pub name: String,
    /// \[s\]
    pub t_s: Vec<f64>,
    /// Its joints, in order.
    pub joints: Vec<JointCurves>,
}

/// Curves of one joint.
#[derive(Clone, Debug)]
pub struct JointCurves {
    /// Its name.
    pub name: String,
    /// \[rad\]
    pub setpoint_rad: Vec<f64>,
    /// What the encoder says \[rad\].
    pub reading_rad: Vec<f64>,
}
