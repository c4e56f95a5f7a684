//! The compiled half of the Python package `aibo_fit`: what takes time, without the interpreter's lock.
//!
//! Arrays, dictionaries and figures are the Python half's; here a question is a text (a study in TOML) with arrays, or a
//! path, and an answer is the program's own JSON, page and text.

mod answer;
mod ask;
mod check;
mod demands;
mod drop;
mod errors;
mod fleet;
mod gap;
mod robot;
mod run;

use pyo3::prelude::*;
use std::ffi::OsString;

/// Runs the program on a command line, its own name first, and gives its exit code; `program` begins a command line that
/// starts it again.
#[pyfunction]
fn main(py: Python<'_>, program: Vec<OsString>, words: Vec<OsString>) -> u8 {
    py.detach(|| aibo_fit::cli::run_within(program, words))
}

#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("Error", module.py().get_type::<errors::Error>())?;
    module.add("NeverMoved", module.py().get_type::<errors::NeverMoved>())?;
    module.add("Unreadable", module.py().get_type::<errors::Unreadable>())?;
    module.add_class::<answer::Answer>()?;
    module.add_class::<fleet::Fleet>()?;
    module.add_class::<robot::Robot>()?;
    module.add_function(wrap_pyfunction!(main, module)?)?;
    module.add_function(wrap_pyfunction!(gap::gap, module)?)?;
    module.add_function(wrap_pyfunction!(drop::drop, module)?)?;
    module.add_function(wrap_pyfunction!(check::check, module)?)
}
