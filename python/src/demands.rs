//! What is demanded of the numbers of a fit, as `--fix`, `--free`, `--bound` and `--start` have it.

use crate::errors::Failed;
use aibo_fit::identify::Directives;
use pyo3::prelude::*;

/// The demands as the Python half gives them.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Demands {
    fix: Vec<(String, Option<f64>)>,
    free: Vec<String>,
    bound: Vec<(String, [f64; 2])>,
    start: Vec<(String, f64)>,
}

impl Demands {
    /// The demands as a fit takes them.
    pub fn directives(self) -> Result<Directives, Failed> {
        let Self { fix, free, bound, start } = self;
        let finite = |name: &str, value: f64| match value.is_finite() {
            true => Ok(()),
            false => Err(Failed::of(format!("`{name}`: {value} is not a number"))),
        };
        for (name, value) in fix.iter().filter_map(|(name, value)| Some((name, (*value)?))) {
            finite(name, value)?;
        }
        for (name, value) in &start {
            finite(name, *value)?;
        }
        for (name, [low, high]) in &bound {
            finite(name, *low)?;
            finite(name, *high)?;
            if low >= high {
                return Err(Failed::of(format!("`{name}`: the lower bound {low} must be below the upper {high}")));
            }
        }
        Ok(Directives { fix, free, bound, start })
    }
}

/// As they stand on a command line.
pub fn words(demands: &Directives) -> String {
    let fix = demands.fix.iter().map(|(name, value)| match value {
        Some(value) => format!(" --fix {name}={value}"),
        None => format!(" --fix {name}"),
    });
    let free = demands.free.iter().map(|name| format!(" --free {name}"));
    let bound = demands.bound.iter().map(|(name, [low, high])| format!(" --bound {name}={low}:{high}"));
    let start = demands.start.iter().map(|(name, value)| format!(" --start {name}={value}"));
    fix.chain(free).chain(bound).chain(start).collect()
}
