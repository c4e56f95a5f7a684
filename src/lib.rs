//! Turns logs of robot joints into trustworthy dynamics.
//!
//! A joint log (time, angle, perhaps a setpoint or a torque) goes in; inertia, moment and friction come out, each with
//! an interval that stays honest when the model lacks something, or with the plain statement that the log does not
//! determine it. The models are those of a 2005 thesis on the Sony ERS-7 (equation numbers throughout are its own):
//! the simple pendulum (3.2) and the extensive one with Coulomb, viscous and Stribeck friction (3.11-3.13), integrated
//! with true sticking and fitted by Levenberg-Marquardt, BFGS or DFP to the integral of the squared error (3.7).
//!
//! # The joint as a chain
//! ```text
//! setpoint -> controller (PID) -> motor (limits) -> link (inertia, gravity, friction) -> encoder -> log
//! ```
//! A stage is perfect until the logs say otherwise. The stages live in [`joint`]; they are generic over the number
//! type, so that dual numbers carry exact sensitivities through sticking, release and breakaway.
//!
//! # Layers, each using only those above it
//! [`log`] reads and checks · [`geometry`] lumps a leg into a pendulum · [`joint`] has the stages · [`integrate`] and
//! [`pendulum`] move them · [`fit`] minimises and says how sure it is · [`identify`] brings logs and models together ·
//! [`robot`] moves a whole tree of bodies · [`gap`] says what the model lacks · [`synth`] makes logs from a known truth ·
//! [`blind`] tests the diagnosis on sealed studies · [`thesis`] repeats the thesis's chapter 3 · `report` draws (feature
//! `report`) · `fleet` puts many studies together (feature `fleet`) · the program (feature `cli`) is on top.
//!
//! With `default-features = false` there are neither robots, pages, exams nor the program, and none of what they depend on:
//! logs of a joint as arrays or files go in, diagnoses come out, which serialise (`examples/from_arrays.rs`). The feature
//! `robots` has arms and whole robots and reads bags, MCAP and `.npz`, `parquet` reads LeRobot datasets.
//!
//! # A swing, fitted
//! ```
//! use aibo_fit::geometry::LinkBody;
//! use aibo_fit::progress::Silent;
//! use aibo_fit::{Case, DropOptions, Named, Status, fit_drop};
//!
//! // Reads data/q1.csv, its sidecar data/q1.toml and data/pose.toml beside it.
//! let case = Case::of_logs(&["data/q1.csv".into()], None)?;
//! let fit = fit_drop(&case, &DropOptions::default(), &Silent)?;
//!
//! let coulomb = fit.extensive.estimate(Named::Coulomb).expect("every extensive model has it");
//! let [low, high] = coulomb.interval.expect("this swing determines it");
//! assert!(low < 0.001 && 0.001 < high, "Table 3.3 has 0.001 N m");
//!
//! // The shoulder lies on the axis of q1: no swing can weigh it, and the fit says so.
//! let shoulder = fit.extensive.estimate(Named::Mass(LinkBody::Shoulder)).expect("a body of the leg");
//! assert_eq!(shoulder.status, Status::NotDetermined);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![deny(unsafe_code)]
// The same bits on every processor: see `number::math`.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
// What only pages use is idle without them.
#![cfg_attr(not(feature = "report"), allow(dead_code, unused_imports))]

#[cfg(feature = "report")]
pub mod blind;
// Its docs are what the terminal shows, not Markdown.
#[allow(rustdoc::invalid_html_tags)]
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
pub mod deadline;
pub mod fit;
#[cfg(feature = "fleet")]
pub mod fleet;
pub mod gap;
pub mod geometry;
pub mod identify;
pub mod integrate;
pub mod joint;
pub mod log;
mod number;
pub mod pendulum;
pub mod progress;
#[cfg(feature = "report")]
pub mod report;
#[cfg(feature = "robots")]
pub mod robot;
#[cfg(feature = "robots")]
pub mod synth;
#[cfg(feature = "report")]
pub mod thesis;

pub use fit::{Budget, Method, Stop};
pub use geometry::{Ers7Tables, Leg, LegJoint, LegPose, lump};
pub use identify::{
    Case, Directives, DropFit, DropOptions, Estimate, Experiment, ExtensiveModel, Named, Parameter, Status, conclude,
    fit_drop,
};
pub use log::{Log, Study, read_log, read_study};
pub use pendulum::{ExtensivePendulum, SimplePendulum, rollout};
