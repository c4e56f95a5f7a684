//! The report of a sensor test (section B.1): what the sensor does, and what the controller does under gravity.

mod plot;
mod text;

pub use plot::sensor_figures;
pub use text::{sensor_html, sensor_text};

use super::Provenance;
use serde::Serialize;

/// Both sweeps of a joint.
#[derive(Clone, Debug, Serialize)]
pub struct SensorReport {
    /// The layout's version.
    pub schema: u32,
    /// The joint.
    pub joint: String,
    /// One sentence a colleague would say.
    pub sentence: String,
    /// The wide sweep, then the fine one.
    pub sweeps: Vec<SweepPart>,
    /// Where it comes from.
    #[serde(skip)]
    pub provenance: Provenance,
}

/// One sweep.
#[derive(Clone, Debug, Serialize)]
pub struct SweepPart {
    /// First and last setpoint \[rad\].
    pub range_rad: [f64; 2],
    /// Measurements.
    pub measurements: usize,
    /// RMS of reading less setpoint \[rad\].
    pub rms_rad: f64,
    /// RMS of reading less true angle: the sensor \[rad\].
    pub sensor_rms_rad: f64,
    /// RMS of true angle less setpoint: the controller under gravity and friction \[rad\].
    pub droop_rms_rad: f64,
    /// Largest of these \[rad\].
    pub droop_worst_rad: f64,
    /// Least and greatest of reading less true angle \[rad\].
    pub sensor_range_rad: [f64; 2],
    /// Share of readings that are not below their setpoint.
    pub not_below: f64,
    /// Setpoints \[rad\].
    #[serde(skip)]
    pub setpoint_rad: Vec<f64>,
    /// Readings \[rad\].
    #[serde(skip)]
    pub reading_rad: Vec<f64>,
    /// True angles \[rad\].
    #[serde(skip)]
    pub angle_rad: Vec<f64>,
}
