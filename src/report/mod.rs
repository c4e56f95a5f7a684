//! Layer 8: reports and plots.

mod model;

pub use model::{
    Correlation, DropReport, FrictionPoint, LogCurves, LogHealthRow, ModelSummary, ParameterRow, ParameterStatus,
    Provenance,
};
