//! The report of a walk: what was asked of the joints and what they did.

mod html;
mod plot;
mod text;

pub use html::walk_html;
pub use plot::walk_figures;
pub use text::walk_text;

use super::Provenance;
use serde::Serialize;

/// Everything that the report of `aibo-fit walk` shows.
#[derive(Clone, Debug, Serialize)]
pub struct WalkReport {
    /// The layout's version.
    pub schema: u32,
    /// Name of the robot.
    pub robot: String,
    /// `air`.
    pub scenario: String,
    /// One sentence a colleague would say.
    pub sentence: String,
    /// What the reader should know besides: limits that were exceeded, setpoints that were clipped.
    pub notes: Vec<String>,
    /// Method and step or tolerance, in words.
    pub method: String,
    /// Simulated time \[s\].
    pub duration_s: f64,
    /// Evaluations of the equations of motion.
    pub evaluations: u64,
    /// Steps that count.
    pub steps: u64,
    /// Where the motion ran away, if it did.
    pub diverged: Option<Runaway>,
    /// Joints that were moved.
    pub joints: Vec<FollowRow>,
    /// Joints beyond their speed limits.
    pub speed_warnings: Vec<SpeedRow>,
    /// Legs to be drawn.
    #[serde(skip)]
    pub legs: Vec<LegCurves>,
    /// Where it comes from.
    #[serde(skip)]
    pub provenance: Provenance,
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
