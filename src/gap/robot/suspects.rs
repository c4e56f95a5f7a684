//! Which joints have most left to explain.

use super::bench::Bench;

/// Free play is slow to simulate: it is tried on the joints that have most left only, and if that is so many variances.
const PLAYS: usize = 3;
const PLAY_LEAVES: f64 = 1.15;

/// Joints by what they have left beyond what noise and uncertain numbers leave, most first.
pub(super) struct Suspects {
    /// All that move.
    pub joints: Vec<usize>,
    /// Those of the first that have so much left that free play is worth a try.
    pub play: Vec<usize>,
}

impl Suspects {
    pub fn of(bench: &Bench<'_>, residual: &[f64]) -> Self {
        let adapted = bench.noise.adapted(residual);
        let variances = |joint: usize| {
            let rows = bench.layout.joints().filter(|(of, _)| *of == joint);
            let samples = rows.flat_map(|(_, row)| row.range.clone()).filter(|k| bench.noise.weight[*k] > 0.0);
            let (sum, count) =
                samples.fold((0.0, 0.0), |(s, n), k| (s + bench.noise.weight[k] * adapted[k].powi(2), n + 1.0));
            sum / f64::max(count, 1.0)
        };
        let mut joints: Vec<(f64, usize)> =
            bench.layout.moving().into_iter().map(|joint| (variances(joint), joint)).collect();
        joints.sort_by(|a, b| b.0.total_cmp(&a.0));
        let play = joints.iter().take(PLAYS).filter(|(left, _)| *left > PLAY_LEAVES).map(|(_, joint)| *joint).collect();
        Self { joints: joints.into_iter().map(|(_, joint)| joint).collect(), play }
    }
}
