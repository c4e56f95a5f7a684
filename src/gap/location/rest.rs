//! Where along a log the joint rests.

use super::along::Along;
use crate::identify::Experiment;
use crate::joint::Chain;
use std::ops::Range;

/// A joint at rest at one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::gap) struct Rest {
    /// How far the torque on it is beyond the model's breakaway \[N m\], with the torque's sign; 0: the model sticks too.
    pub beyond_nm: f64,
    /// How many readings this rest has.
    pub readings: usize,
}

/// A rest has at least this many readings, and lasts at least this long \[s\].
const FEWEST: usize = 5;
const SHORTEST_S: f64 = 0.03;
/// Where readings flicker it takes more of them to see that nothing moves.
const FEWEST_FLICKERING: usize = 12;
/// Noise is a flicker beyond rounding from this ratio to the rounding error on.
const FLICKERS: f64 = 1.2;
/// A rest that the model does not explain is longer than coming and going at a turning point by this factor.
const LONGER: f64 = 2.0;

/// Breakaway is not known better than this share of it.
const UNSURE: f64 = 0.1;

/// For each sample whether the joint rests there; before `from` nothing is asked.
///
/// Readings within their noise of one value are a rest if the model would stick there too, or if a joint that the
/// model lets go would have left that value long since: then the model lacks a torque that holds it.
pub(in crate::gap) fn rests(
    chain: &Chain<f64>,
    along: &Along<'_>,
    e: &Experiment,
    from: usize,
    noise_rad: f64,
) -> Vec<Option<Rest>> {
    let n = e.t_s.len();
    let mut rests = vec![None; n];
    let flickers = !(noise_rad <= FLICKERS * e.resolution_rad / 12f64.sqrt());
    let (band_rad, fewest) = if flickers {
        ((4.0 * noise_rad).max(2.02 * e.resolution_rad), FEWEST_FLICKERING)
    } else {
        (0.01 * e.resolution_rad, FEWEST)
    };
    let calm = Calm { chain, along, e, reach_rad: 0.5 * (band_rad + e.resolution_rad) };
    let mut at = from;
    while at < n {
        let to = at + within(&e.measured_rad[at..], band_rad);
        let too_few = to - at < fewest || e.t_s[to - 1] - e.t_s[at] < SHORTEST_S;
        if too_few || (flickers && drifts(&e.measured_rad[at..at + fewest], noise_rad)) {
            at += 1;
            continue;
        }
        calm.judge(at..to, &mut rests);
        at = to;
    }
    rests
}

/// How many readings share each reading's error: all of a rest, and as many identical ones as come within `width_s`.
pub(in crate::gap) fn together(e: &Experiment, rests: &[Option<Rest>], width_s: f64) -> Vec<f64> {
    let mut counts = Vec::with_capacity(rests.len());
    for run in e.measured_rad.chunk_by(|a, b| a == b) {
        let from = counts.len();
        let lasts_s = e.t_s[from + run.len() - 1] - e.t_s[from];
        let shared = if lasts_s > width_s { run.len() as f64 * width_s / lasts_s } else { 1.0 };
        counts.extend((from..from + run.len()).map(|k| rests[k].map_or(shared.max(1.0), |r| r.readings as f64)));
    }
    counts
}

/// How many readings, from the first on, lie within `band_rad` of each other.
fn within(readings: &[f64], band_rad: f64) -> usize {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let inside = |reading: &&f64| {
        (low, high) = (low.min(**reading), high.max(**reading));
        high - low <= band_rad
    };
    readings.iter().take_while(inside).count()
}

/// Whether readings with a noise move between their first and their second half, by more than two standard deviations.
fn drifts(readings: &[f64], noise_rad: f64) -> bool {
    let (early, late) = readings.split_at(readings.len() / 2);
    let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len() as f64;
    (mean(late) - mean(early)).abs() > 4.0 * noise_rad / (readings.len() as f64).sqrt()
}

/// What it takes to judge calm readings.
struct Calm<'a, 'b> {
    chain: &'a Chain<f64>,
    along: &'a Along<'b>,
    e: &'a Experiment,
    /// How far from the mean reading the joint may be \[rad\].
    reach_rad: f64,
}

impl Calm<'_, '_> {
    fn judge(&self, run: Range<usize>, rests: &mut [Option<Rest>]) {
        let t_s = &self.e.t_s[run.clone()];
        let mean_rad = self.e.measured_rad[run.clone()].iter().sum::<f64>() / run.len() as f64;
        let beyond_nm: Vec<f64> = run.clone().map(|k| self.beyond_nm(k, mean_rad)).collect();
        let pull_nm = beyond_nm.iter().map(|b| b.abs()).sum::<f64>() / run.len() as f64;
        let end_s = t_s[t_s.len() - 1];
        if end_s - t_s[0] > 2.0 * LONGER * self.leaving_s(pull_nm) {
            let readings = run.len();
            for ((rest, &beyond_nm), t_s) in rests[run].iter_mut().zip(&beyond_nm).zip(t_s) {
                // The end of a rest, pulled by a setpoint that has just moved, is the beginning of a motion.
                if beyond_nm == 0.0 || end_s - t_s > LONGER * self.leaving_s(beyond_nm.abs()) {
                    *rest = Some(Rest { beyond_nm, readings });
                }
            }
            return;
        }
        // Only the parts in which the model sticks.
        let mut at = 0;
        while at < beyond_nm.len() {
            let readings = beyond_nm[at..].iter().take_while(|b| **b == 0.0).count();
            if readings >= FEWEST {
                let part = run.start + at..run.start + at + readings;
                rests[part].fill(Some(Rest { beyond_nm: 0.0, readings }));
            }
            at += readings.max(1);
        }
    }

    /// How long a joint let go near a reading takes to leave it \[s\].
    fn leaving_s(&self, pull_nm: f64) -> f64 {
        (4.0 * self.reach_rad * self.chain.inertia_kg_m2() / pull_nm).sqrt()
    }

    /// The least by which the torque on the resting joint is beyond breakaway, anywhere near `angle_rad`.
    fn beyond_nm(&self, k: usize, angle_rad: f64) -> f64 {
        let at = |angle_rad: f64| {
            let motor_nm = self.along.resting_nm(k, angle_rad);
            let net_nm = self.chain.drive_nm(self.e.t_s[k], angle_rad, motor_nm);
            let direction = if net_nm < 0.0 { -1.0 } else { 1.0 };
            let breakaway_nm = self.chain.breakaway_nm(self.e.t_s[k], angle_rad, direction, motor_nm);
            let beyond_nm = net_nm.abs() - breakaway_nm;
            if beyond_nm > UNSURE * breakaway_nm { beyond_nm * direction } else { 0.0 }
        };
        let near = [angle_rad, angle_rad - self.reach_rad, angle_rad + self.reach_rad].map(at);
        near.into_iter().fold(near[0], |least, b| if b.abs() < least.abs() { b } else { least })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::location::made::{LEG, Swing, made};

    fn share_at_rest(swing: &Swing, coulomb_nm: f64, from_s: f64, to_s: f64) -> (f64, f64) {
        let mut m = made(&LEG, swing);
        m.chain.friction.coulomb_nm = coulomb_nm;
        let e = &m.experiment;
        let rests = rests(&m.chain, &Along::new(&m.chain, e.input(), &e.t_s), e, 1, m.noise_rad);
        let inside = |k: &usize| (from_s..to_s).contains(&e.t_s[*k]);
        let all: Vec<_> = (0..e.t_s.len()).filter(inside).map(|k| rests[k]).collect();
        let beyond = all.iter().flatten().map(|r| r.beyond_nm.abs()).fold(0.0, f64::max);
        (all.iter().flatten().count() as f64 / all.len() as f64, beyond)
    }

    #[test]
    fn the_tail_of_a_swing_rests_and_its_turning_points_do_not() {
        for (step, noise, period) in [(0.006, 0.0, 0.008), (0.006, 0.006, 0.008), (0.0004, 0.0, 0.002)] {
            let swing = Swing { step, noise, period, lasts: 5.0, ..Swing::from(1.2) };
            let (moving, _) = share_at_rest(&swing, LEG.coulomb, 0.3, 2.0);
            let (resting, beyond) = share_at_rest(&swing, LEG.coulomb, 4.0, 5.0);
            assert!(moving == 0.0 && resting > 0.9 && beyond == 0.0, "{step} {noise}: {moving} {resting} {beyond}");
        }
    }

    #[test]
    fn a_rest_that_the_model_does_not_explain_is_seen_with_the_torque_that_it_lacks() {
        // The joint comes to rest where gravity pulls with some 0.001 N m; a model without friction would swing on.
        let (resting, beyond) = share_at_rest(&Swing { lasts: 6.0, ..Swing::from(1.2) }, 0.0, 4.0, 5.5);
        assert!(resting == 1.0 && beyond > 2e-4 && beyond <= LEG.coulomb, "{resting} {beyond}");
    }
}
