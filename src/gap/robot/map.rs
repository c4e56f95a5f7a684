//! Where the gap lies: joint by phase, and what it depends on. Nothing here looks at a cause.

use super::bench::Bench;
use super::diagnosis::{GaitCell, GaitPhase};
use super::layout::Row;
use crate::gap::Variable;
use crate::gap::hypothesis::reach::mean_period_s;
use crate::gap::location::map::discoveries;
use crate::joint::Setpoint;
use crate::number::chance::normal_tail;

/// Samples of an impact or a drift go together: so many count as one.
const TOGETHER: f64 = 4.0;
/// Cells with fewer samples say nothing.
const FEWEST: usize = 12;

/// The map of what is left of the robot as given, once what is uncertain anyway is taken out.
pub(super) fn cells(bench: &Bench<'_>, phases: &[Vec<Vec<GaitPhase>>], left: &[f64]) -> Vec<GaitCell> {
    let case = bench.case;
    let period_s = |row: &Row| mean_period_s(&case.logs[row.log].log.t_s);
    let mut cells = Vec::new();
    let mut p_values = Vec::new();
    for joint in bench.layout.moving() {
        for phase in GaitPhase::ALL {
            let (mut energy, mut statistic, mut count, mut time_s) = (0.0, 0.0, 0_usize, 0.0);
            for (_, row) in bench.layout.joints().filter(|(of, _)| *of == joint) {
                let those = row.range.clone().zip(&phases[row.log][joint]).filter(|(_, of)| **of == phase);
                for (k, _) in those.filter(|(k, _)| bench.layout.compared[*k]) {
                    let weight = bench.noise_of_all.weight[k];
                    energy += left[k].powi(2) - 1.0 / weight;
                    statistic += weight * left[k].powi(2) - 1.0;
                    count += 1;
                    time_s += period_s(row);
                }
            }
            if count < FEWEST {
                continue;
            }
            p_values.push(normal_tail(statistic / (2.0 * TOGETHER * count as f64).sqrt()));
            cells.push(GaitCell {
                joint: case.names[joint].clone(),
                phase,
                time_s,
                excess_rad: f64::max(energy / count as f64, 0.0).sqrt(),
                share: energy.max(0.0),
                significant: false,
            });
        }
    }
    let whole: f64 = cells.iter().map(|cell| cell.share).sum();
    for (cell, found) in cells.iter_mut().zip(discoveries(&p_values)) {
        cell.share = if whole > 0.0 { cell.share / whole } else { 0.0 };
        cell.significant = found;
    }
    cells
}

/// Bins of a variable.
const BINS: usize = 10;
/// The range that is named holds this share of the gap.
const IN_RANGE: f64 = 0.6;

/// What a residual may depend on.
pub(super) const VARIABLES: [Variable; 6] =
    [Variable::Speed, Variable::Direction, Variable::Angle, Variable::Time, Variable::SetpointRate, Variable::Torque];

/// A variable that travels less explains nothing.
const STILL: f64 = 1e-6;

/// What the gap of some joints depends on most, and between which values most of it lies.
pub(super) fn dependence(bench: &Bench<'_>, joints: &[usize], left: &[f64]) -> Option<(Variable, [f64; 2])> {
    let of = |variable: Variable| -> Option<(f64, [f64; 2])> {
        let mut pairs: Vec<(f64, f64)> = Vec::new();
        for (joint, row) in bench.layout.joints().filter(|(of, _)| joints.contains(of)) {
            let values = along(bench, row, joint, variable)?;
            let counts = row.range.clone().zip(values).filter(|(k, _)| bench.layout.compared[*k]);
            pairs.extend(counts.map(|(k, value)| (value, left[k])));
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let travels = pairs.last()?.0 - pairs.first()?.0 > STILL;
        let total: f64 = pairs.iter().map(|(_, r)| r * r).sum();
        let bins = if variable == Variable::Direction { 2 } else { BINS };
        let size = pairs.len().div_ceil(bins).max(1);
        let binned: Vec<&[(f64, f64)]> = pairs.chunks(size).collect();
        let mean = |bin: &[(f64, f64)]| bin.iter().map(|(_, r)| r).sum::<f64>() / bin.len() as f64;
        let explained: f64 = binned.iter().map(|bin| bin.len() as f64 * mean(bin).powi(2)).sum();
        let energy: Vec<f64> = binned
            .iter()
            .map(|bin| f64::max(bin.iter().map(|(_, r)| r * r - bench.sigma_rad.powi(2)).sum(), 0.0))
            .collect();
        let needed = IN_RANGE * energy.iter().sum::<f64>();
        // The shortest run of bins that holds that much.
        let runs = (1..=binned.len()).flat_map(|n| (0..=binned.len() - n).map(move |from| (from, n)));
        let run = runs.filter(|(from, n)| energy[*from..from + n].iter().sum::<f64>() >= needed).min_by(|a, b| {
            let held = |(from, n): &(usize, usize)| energy[*from..from + n].iter().sum::<f64>();
            a.1.cmp(&b.1).then(held(b).total_cmp(&held(a)))
        });
        let (from, n) = run?;
        let range = [binned[from].first()?.0, binned[from + n - 1].last()?.0];
        (travels && total > 0.0).then_some((explained / total, range))
    };
    let best = VARIABLES.into_iter().filter_map(|variable| of(variable).map(|(share, range)| (share, variable, range)));
    let best = best.max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some((best.1, best.2))
}

/// A variable along a joint's row, by the robot as given.
pub(super) fn along(bench: &Bench<'_>, row: &Row, joint: usize, variable: Variable) -> Option<Vec<f64>> {
    let log = &bench.case.logs[row.log];
    let given = &bench.given_logs[row.log];
    let (q, t_s) = (&given.reading_rad[joint], &log.log.t_s);
    let n = q.len();
    let slope = |values: &dyn Fn(usize) -> f64, k: usize| {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(n - 1));
        (values(after) - values(before)) / (t_s[after] - t_s[before])
    };
    let rate = |k: usize| slope(&|k| q[k], k);
    let id = bench.case.model().joint_ids().nth(joint)?;
    let setpoint = |k: usize| log.scene.setpoints.at(id, t_s[k]).unwrap_or(q[k]);
    let chain = &bench.case.nominal.joints.drive(id).chain;
    let asked_nm = |k: usize| {
        let setpoint = Setpoint { angle_rad: setpoint(k), rate_rad_s: slope(&setpoint, k) };
        chain.motor_nm(t_s[k], setpoint, [q[k], rate(k)], 0.0)
    };
    Some(
        (0..n)
            .map(|k| match variable {
                Variable::Speed => rate(k).abs(),
                Variable::Direction => rate(k).signum(),
                Variable::Time => t_s[k],
                Variable::SetpointRate => slope(&setpoint, k),
                Variable::Torque => asked_nm(k),
                _ => q[k],
            })
            .collect(),
    )
}
