//! Which Coulomb friction the extensive model finds in swings whose friction is another.

use super::bench::{Bench, Setting};
use crate::fit::{Budget, Method, solve};
use crate::identify::{Experiment, ExtensiveModel, JointModel, Named, Problem, Scale};
use crate::thesis::swings::JointSwings;

/// Coulomb friction by the extensive model with Coulomb and viscous friction (3.14), masses as they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoulombSeen {
    /// Of the bare leg; `None` where it does not move \[N m\].
    pub bare_nm: Option<f64>,
    /// With the first and the second extra mass \[N m\].
    pub loaded_nm: [Option<f64>; 2],
}

/// Frictions from which a search starts: Coulomb \[N m\], viscous \[N m s/rad\].
const STARTS: [[f64; 2]; 3] = [[0.001, 0.017], [0.02, 0.01], [0.04, 0.003]];
/// Evaluations for each.
const EVALUATIONS: usize = 40;
/// A leg that moves by less is not taken for swinging \[rad\].
const LEAST_RAD: f64 = 0.02;

/// Fits the swings of a setting.
pub(super) fn seen(bench: &Bench, swings: &JointSwings, setting: &Setting) -> CoulombSeen {
    let found: Vec<Option<f64>> = bench
        .experiments(setting)
        .iter()
        .map(|e| coulomb_nm(swings, e.as_ref()?, [setting.coulomb_nm, setting.viscous_nm_s_rad]))
        .collect();
    let at = |k: usize| found.get(k).copied().flatten();
    CoulombSeen { bare_nm: at(0), loaded_nm: [at(1), at(2)] }
}

/// The Coulomb friction found in one swing; `made` is the friction that it was made with, where a search starts as well.
fn coulomb_nm(swings: &JointSwings, e: &Experiment, made: [f64; 2]) -> Option<f64> {
    let moved = e.measured_rad.iter().map(|q| (q - e.measured_rad[0]).abs()).fold(0.0, f64::max);
    if moved < LEAST_RAD {
        return None;
    }
    let nominal = swings.case.joint.nominal.as_ref();
    let one = std::slice::from_ref(e);
    let masses = swings.leg().ok()?.masses().ok()?;
    let mut model = ExtensiveModel::bodies(&Scale::of(one, nominal, None), one, &masses, true, nominal, false);
    for p in model.parameters_mut() {
        if matches!(p.named(), Some(Named::Mass(_) | Named::Zero)) {
            (p.fixed, p.start) = (true, p.nominal.unwrap_or(p.start));
        }
    }
    let [c, v] = model.friction_at();
    let problem = Problem::new(&model, one);
    let best = STARTS
        .iter()
        .chain([&made])
        .map(|start| {
            let mut values: Vec<f64> = model.parameters().iter().map(|p| p.start).collect();
            (values[c], values[v]) = (start[0], start[1]);
            solve(&problem, &problem.coordinates_of(&values), Method::Lm, Budget { evaluations: EVALUATIONS })
        })
        .min_by(|a, b| a.criterion.total_cmp(&b.criterion))?;
    best.criterion.is_finite().then(|| problem.values(&best.x)[c])
}
