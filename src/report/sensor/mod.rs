//! The report of a sensor test (section B.1): what the sensor does, and what the controller does under gravity.

mod plot;
mod text;

pub use plot::sensor_figures;
pub use text::{sensor_html, sensor_text};

use super::Provenance;
use crate::robot::simulate::Swept;
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
    pub sweeps: Vec<Swept>,
    /// Where it comes from.
    #[serde(skip)]
    pub provenance: Provenance,
}
