//! What the logs of a study cannot determine, in words, and what would.
//!
//! Where the logs say less about a combination of numbers than the beliefs do, it is the beliefs that decide. In units of
//! the beliefs' standard deviations the information of the logs has eigenvectors; those with an eigenvalue below one are
//! such combinations.

use super::{Experiment, JointModel, Problem, Signal};
use crate::fit::{Normal, Residuals};
use crate::number::as_given;
use nalgebra::{DMatrix, DVector};

/// Information below which beliefs decide.
const LITTLE: f64 = 1.0;
/// A number has a part in a combination from this share of it on.
const PART: f64 = 0.25;

/// The drive's gain among a joint's numbers.
const GAIN: &str = "gain";

/// What is said of numbers that the logs leave to one another, before what would help; the same for all of a study.
const TOGETHER: &str = " apart: they can be changed together";

/// What is searched whatever is believed of it counts as believed to a factor of e, or to this in its unit.
const FREED: f64 = 1.0;

/// One sentence for each combination of numbers that the experiments leave to the beliefs. `is_number` says which
/// parameters are numbers of the joint, by index; `unit_rad2_s` is what one unit of deviance weighs in the criterion.
pub(crate) fn undetermined<M: JointModel>(
    problem: &Problem<'_, M>,
    x: &[f64],
    is_number: impl Fn(usize) -> bool,
    unit_rad2_s: f64,
) -> Vec<String> {
    let experiments = problem.experiments;
    let Ok(blocks) = problem.linearise(x) else { return Vec::new() };
    let normal = Normal::of(&blocks[..experiments.len()], x.len());
    let parameters = problem.model.parameters();
    let free: Vec<usize> = (0..parameters.len()).filter(|&i| !parameters[i].fixed).collect();
    let believed: Vec<(usize, f64)> = free
        .iter()
        .enumerate()
        .filter(|(_, i)| is_number(**i))
        .map(|(k, &i)| (k, parameters[i].belief.map_or(FREED, |belief| belief.sd)))
        .collect();
    if believed.is_empty() || !(unit_rad2_s > 0.0) {
        return Vec::new();
    }
    // What the starts and the causes can take up says nothing about the numbers.
    let others: Vec<usize> = (0..x.len()).filter(|c| !believed.iter().any(|(k, _)| k == c)).collect();
    let Some(mut information) = reduced(&normal.jtj, &believed, &others, unit_rad2_s) else { return Vec::new() };
    for (row, (k, sd)) in believed.iter().enumerate() {
        let seen = parameters[free[*k]].seen.map_or(0.0, |seen| (sd / seen.sd).powi(2));
        information[(row, row)] += seen;
    }
    let eigen = information.symmetric_eigen();
    let name = |row: usize| parameters[free[believed[row].0]].name.as_str();
    let mut sentences: Vec<String> = Vec::new();
    let mut has_scale = (0..believed.len()).any(|row| name(row) == GAIN);
    for v in (0..believed.len()).filter(|&v| eigen.eigenvalues[v] < LITTLE) {
        let direction: DVector<f64> = eigen.eigenvectors.column(v).into_owned();
        let parts: Vec<&str> = (0..believed.len()).filter(|&r| direction[r].abs() > PART).map(name).collect();
        has_scale &= !parts.contains(&GAIN);
        let said = sentence(experiments, &parts);
        // Two directions may have their parts in the same numbers.
        if !sentences.contains(&said) {
            sentences.push(said);
        }
    }
    let mut sentences = told_once(sentences);
    sentences.extend(limit_reached_nm(problem, x).filter(|_| has_scale).map(|limit_nm| {
        format!(
            "How large gain, inertia, moment and friction are together rests on the stated torque limit of {} N m, which these logs \
             reach and which is taken as exact: a weighed link would check it.",
            as_given(limit_nm)
        )
    }));
    sentences
}

/// A stated limit of the drive that is in force and that the experiments ask for more than: it tells how large all torques are
/// \[N m\].
fn limit_reached_nm<M: JointModel>(problem: &Problem<'_, M>, x: &[f64]) -> Option<f64> {
    let values = problem.values(x);
    problem.experiments.iter().find_map(|e| {
        let motor = problem.model.chain(&values, e).motor?;
        motor.stated_limit_nm().filter(|limit_nm| e.largest_command_nm() > *limit_nm)
    })
}

/// What would help is told by the first of the sentences that it is true of.
fn told_once(mut sentences: Vec<String>) -> Vec<String> {
    let mut told = false;
    for sentence in &mut sentences {
        if let Some(at) = sentence.find(TOGETHER) {
            if told {
                sentence.replace_range(at.., " apart either.");
            }
            told = true;
        }
    }
    sentences
}

/// Information about the believed numbers in units of their beliefs, with everything else free.
fn reduced(jtj: &DMatrix<f64>, believed: &[(usize, f64)], others: &[usize], unit: f64) -> Option<DMatrix<f64>> {
    let n = believed.len();
    let own = DMatrix::from_fn(n, n, |i, k| jtj[(believed[i].0, believed[k].0)]);
    let cross = DMatrix::from_fn(others.len(), n, |i, k| jtj[(others[i], believed[k].0)]);
    let mut rest = DMatrix::from_fn(others.len(), others.len(), |i, k| jtj[(others[i], others[k])]);
    for i in 0..others.len() {
        rest[(i, i)] += 1e-9 * rest[(i, i)] + 1e-300;
    }
    let taken = cross.transpose() * rest.cholesky()?.solve(&cross);
    let left = own - taken;
    Some(DMatrix::from_fn(n, n, |i, k| left[(i, k)] * believed[i].1 * believed[k].1 / unit))
}

fn sentence(experiments: &[Experiment], parts: &[&str]) -> String {
    let unseen = |e: &Experiment| matches!(e.signal, Signal::Position { .. }) && e.torque_seen_nm.is_none();
    let by_setpoint = experiments.iter().any(unseen);
    let driven = experiments.iter().any(|e| e.is_driven());
    let listed = match parts {
        [] => return "These logs leave a combination of the numbers to what is believed of them.".into(),
        [only] => {
            let number = match *only {
                "coulomb" => "Coulomb friction",
                "viscous" => "viscous friction",
                other => other,
            };
            return format!("These logs do not tell the {number} better than it is believed to be: {}.", alone(only));
        }
        [first, last] => format!("{first} and {last}"),
        [most @ .., last] => format!("{} and {last}", most.join(", ")),
    };
    if parts.iter().all(|name| matches!(*name, "coulomb" | "viscous")) {
        return format!("These logs cannot tell {listed} apart; slow and fast motions beside one another would.");
    }
    if parts.contains(&"kd") && parts.iter().all(|name| matches!(*name, "coulomb" | "viscous" | "kd")) {
        return format!("These logs cannot tell {listed} apart; swings with the motor off would.");
    }
    let remedy = match (by_setpoint, driven) {
        (true, _) => {
            "no torque of these position-driven logs is known; weigh the link, hang on a known mass, or log the current"
        }
        (false, true) => "the torque's scale is only believed; weigh the link or hang on a known mass",
        (false, false) => "free swings show ratios of torques; weigh the link, or hang on a known mass",
    };
    format!("These logs cannot tell {listed}{TOGETHER}. {}{}.", remedy[..1].to_uppercase(), &remedy[1..])
}

fn alone(name: &str) -> &'static str {
    match name {
        "coulomb" => "swings that come to rest, or slow motions with reversals, would",
        "viscous" => "fast motions would",
        "kd" => "setpoints that move fast would",
        "ki" => "setpoints that rest for long would",
        "inertia" => "motions with more acceleration would",
        "moment" => "a hung-on known mass, or wider swings, would",
        _ => "a known load, or a logged torque, would",
    }
}
