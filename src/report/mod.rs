//! Layer 8: reports and plots.
//!
//! Which question: what did the fit find, how sure is it, and what did the logs look like? A [`DropReport`] is plain
//! data; [`drop_text`] writes it for a terminal, [`render_html`] as one page that needs no network, [`figures`] as SVG.
//! Nothing is computed here but what the eye needs (thinning, a smoothed speed for the phase portrait).

mod animation;
mod assemble;
mod beliefs;
mod blind;
mod by_joint;
mod chances;
mod check;
mod clamped_gap;
mod data_health;
mod draft;
mod error;
mod fit_json;
#[cfg(feature = "fleet")]
mod fleet;
mod friction_table;
mod full;
mod gap;
mod gate;
mod grid;
mod html;
mod mcap;
mod measure;
mod model;
mod notes;
#[cfg(test)]
mod pages;
mod plot;
mod robot_gap;
mod rows;
#[cfg(test)]
mod sample;
mod sensor;
mod table;
mod text;
mod thesis;
mod walk;

pub(crate) use crate::number;
pub use crate::number::{WithUncertainty, format_with_uncertainty};
pub use animation::{Animation, Dog, GifOptions, Recording, animation_gif, animation_html, animation_strip};
pub use assemble::drop_report;
pub use blind::{
    BlindReport, RobotBlindReport, blind_figures, blind_html, blind_text, robot_blind_figures, robot_blind_html,
    robot_blind_text,
};
pub use chances::percent_of_answer;
pub use check::{
    CheckReport, LogSeries, PREDICTS_TORQUES, check_html, check_json, check_text, checks_json, checks_text,
};
pub use clamped_gap::{
    ANIMATION_FILE, ClampedGapReport, clamped_gap_figures, clamped_gap_html, clamped_gap_json, clamped_gap_text,
};
pub use draft::{Draft, DraftError, draft_study};
pub use error::ReportError;
pub use fit_json::{DriveGains, EffectFit, FitFile, JointFit, LogFit, ModelFit, Quantity, SCHEMA};
#[cfg(feature = "fleet")]
pub use fleet::{
    DayFrom, FleetReport, FleetRow, FleetSize, FleetStudy, JointTrend, TrendPoint, fleet_html, fleet_json,
    fleet_parquet, fleet_text,
};
pub use friction_table::{FrictionTable, friction_csv, friction_tables};
pub use full::{FullCurves, FullDrop, FullRow, HeldRow, RefitFit, RefitSummary};
pub use gap::{GapReport, NEXT_FILE, gap_figures, gap_json, gap_text, law_figure, render_gap_html};
pub use gate::{gate_baseline, gate_json, gate_junit, gate_markdown, gate_study, gate_text};
pub use html::render_html;
pub use mcap::trace_topics;
pub use model::{
    Correlation, DropReport, FrictionPoint, HashedInput, HealthMore, LogCurves, LogHealthRow, ModelSummary,
    ParameterRow, ParameterStatus, Provenance,
};
pub use notes::still;
pub use plot::{
    Figure, correlation_matrix, figures, friction_curve, optimiser_trace, parameter_intervals, phase_portrait, swing,
};
pub use robot_gap::{
    LogRow, REPAIRED_FILE, RobotGapReport, Sketch, repaired_robot, robot_gap_animation, robot_gap_figures,
    robot_gap_html, robot_gap_json, robot_gap_text,
};
pub use sensor::{SensorReport, sensor_figures, sensor_html, sensor_text};
pub use table::drop_text;
pub use text::{limit_width, list_item};
pub use thesis::{ThesisReport, thesis_csv, thesis_figures, thesis_html, thesis_json, thesis_markdown, thesis_text};
pub use walk::{
    Comparison, FollowRow, JointCurves, LegCurves, PairedCurves, Runaway, SpeedRow, StudyReport, StudyTable,
    WalkReport, before_and_after_figure, comparison_figure, joints_figure, sensitivity_figure, study_html, study_text,
    trunk_figure, walk_figures, walk_html, walk_text,
};
