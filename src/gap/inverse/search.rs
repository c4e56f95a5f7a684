//! Causes of a joint's torque error: grown and pruned by what they predict of logs that were not fitted.

use super::design::{Design, Family, JointData, LogData};
use super::numbers::Values;
use super::system::{Solved, System, saved};
use crate::joint::EffectId;

/// A cause has to save this many standard deviations of what it saves, one that is there may stay with fewer.
pub(super) const COMES: f64 = 3.0;
const STAYS: f64 = 2.0;
/// A curve without a name has more freedom.
const CURVE_COMES: f64 = 3.5;
/// And this share of what recalibrated numbers leave.
pub(super) const LEAST: f64 = 0.02;
/// Weighed squares that an unknown costs where shapes and families are compared.
const PRICE: f64 = 2.0;
/// Causes that a joint may have.
const MOST: usize = 6;
/// Times that the torque is made linear anew.
const ROUNDS: usize = 4;

/// What a joint was found to be.
#[derive(Clone, Debug)]
pub(super) struct Found {
    pub design: Design,
    pub system: System,
    /// Which families, in the order in which they were found.
    pub causes: Vec<usize>,
    /// Which curve.
    pub curve: Option<usize>,
    /// With all of them.
    pub solved: Solved,
    /// Families that the fitted logs asked for and the others refuted.
    pub refuted: Vec<usize>,
    /// The same of a curve.
    pub is_curve_refuted: bool,
}

/// Columns of a choice.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Choice {
    pub causes: Vec<usize>,
    pub curve: Option<usize>,
}

impl Choice {
    pub fn columns(&self, design: &Design) -> Vec<usize> {
        let causes = self.causes.iter().flat_map(|family| design.families[*family].columns.iter().copied());
        let curve = self.curve.iter().flat_map(|curve| design.curves[*curve].columns.iter().copied());
        design.baseline().into_iter().chain(causes).chain(curve).collect()
    }

    pub fn with(&self, family: usize) -> Self {
        Self { causes: self.causes.iter().copied().chain([family]).collect(), curve: self.curve }
    }

    pub fn without(&self, family: usize) -> Self {
        Self { causes: self.causes.iter().copied().filter(|own| *own != family).collect(), curve: self.curve }
    }
}

impl Found {
    /// Takes causes that are known otherwise, each in the shape that explains most.
    pub fn with_causes(&mut self, known: impl Iterator<Item = EffectId>) {
        for effect in known {
            let families = || self.design.families.iter().enumerate().filter(|(_, family)| family.effect == effect);
            if families().any(|(k, _)| self.causes.contains(&k)) {
                continue;
            }
            let criterion = |k: usize| {
                let columns = self.choice().with(k).columns(&self.design);
                self.system.criterion(&self.system.fit(&columns, |block| block.is_fit))
            };
            let shapes = families().map(|(k, _)| (k, criterion(k)));
            if let Some((best, _)) = shapes.min_by(|a, b| a.1.total_cmp(&b.1)) {
                self.causes.push(best);
            }
        }
    }
}

/// Looks for the causes of one joint.
pub(super) fn search(joint: &JointData, logs: &[LogData], allows: &dyn Fn(EffectId) -> bool) -> Found {
    let mut now = joint.believed.values;
    let mut choice = Choice::default();
    let mut sd_nm = None;
    let mut found = None;
    for _ in 0..ROUNDS {
        let design = Design::new(joint, logs, &now, allows);
        let mut state = State::new(design, logs, sd_nm, joint.noise_nm(|log| logs[log].is_fit));
        state.settle(&choice, logs);
        choice = state.grow(choice, logs);
        state.settle(&choice, logs);
        let solved = state.fit(&choice);
        now = values(joint, &state.design, &solved);
        sd_nm = Some(state.sd_nm);
        found = Some((state, solved));
    }
    let (state, solved) = found.expect("there is at least one round");
    let State { design, system, .. } = state;
    let Choice { causes, curve } = choice;
    let mut found = Found { design, system, causes, curve, solved, refuted: Vec::new(), is_curve_refuted: false };
    found.refute();
    found
}

/// A joint's numbers where unknowns are solved.
pub(super) fn values(joint: &JointData, design: &Design, solved: &Solved) -> Values {
    let mut values = joint.believed.values;
    for (k, which) in design.numbers.iter().enumerate() {
        values[*which as usize] += solved.x[k];
    }
    values
}

/// The problem as it is weighed now.
struct State {
    design: Design,
    system: System,
    sd_nm: f64,
    /// What nobody knows better \[N m\].
    noise_nm: f64,
    /// The longest of the logs \[s\].
    period_s: f64,
}

impl State {
    fn new(design: Design, logs: &[LogData], sd_nm: Option<f64>, noise_nm: f64) -> Self {
        let period_s = logs.iter().map(|log| log.grid.period_s).fold(0.0, f64::max);
        let sd_nm = sd_nm.unwrap_or_else(|| rms(&design, logs, &vec![0.0; design.unknowns.len()])).max(noise_nm);
        let system = system(&design, logs, sd_nm);
        Self { design, system, sd_nm, noise_nm, period_s }
    }

    /// Weighs samples by what a choice leaves.
    fn settle(&mut self, choice: &Choice, logs: &[LogData]) {
        for _ in 0..3 {
            let solved = self.fit(choice);
            let sd_nm = rms(&self.design, logs, solved.x.as_slice()).max(self.noise_nm);
            self.system.blocks.iter_mut().for_each(|block| block.rescale(sd_nm / self.sd_nm));
            self.sd_nm = sd_nm;
        }
    }

    /// Whether a choice leaves more than nobody knows better.
    fn is_above_noise(&self, choice: &Choice, logs: &[LogData]) -> bool {
        rms(&self.design, logs, self.fit(choice).x.as_slice()) > self.noise_nm
    }

    fn fit(&self, choice: &Choice) -> Solved {
        self.system.fit(&choice.columns(&self.design), |block| block.is_fit)
    }

    fn held_out(&self, choice: &Choice) -> Vec<f64> {
        self.system.held_out(&choice.columns(&self.design))
    }

    /// Adds what predicts held-out logs better, best first, and takes away what no longer does.
    fn grow(&mut self, mut choice: Choice, logs: &[LogData]) -> Choice {
        choice.curve = None;
        while choice.causes.len() < MOST && self.is_above_noise(&choice, logs) {
            let whole: f64 = self.held_out(&Choice::default()).iter().sum();
            let before = self.held_out(&choice);
            let taken: Vec<EffectId> = choice.causes.iter().map(|k| self.design.families[*k].effect).collect();
            let saves = |k: usize| {
                let after = self.held_out(&choice.with(k));
                let (gain, sds) = saved(&before, &after);
                let comes = sds >= COMES && gain > LEAST * whole && self.most_logs_gain(&before, &after);
                let gain = gain - PRICE * self.design.families[k].columns.len() as f64;
                (k, gain, comes && self.is_whole(&choice.with(k), k))
            };
            let open = (0..self.design.families.len()).filter(|k| !taken.contains(&self.design.families[*k].effect));
            let best = open.map(saves).filter(|(_, _, comes)| *comes).max_by(|a, b| a.1.total_cmp(&b.1));
            let Some((best, _, _)) = best else { break };
            choice = choice.with(best);
            self.settle(&choice, logs);
            choice = self.pruned(choice);
            self.settle(&choice, logs);
            if !choice.causes.contains(&best) {
                break;
            }
        }
        choice.curve = self.is_above_noise(&choice, logs).then(|| self.best_curve(&choice)).flatten();
        choice
    }

    /// Whether none of a family's unknowns is at the end of what it may be: a spring without stiffness is something else.
    fn is_whole(&self, choice: &Choice, family: usize) -> bool {
        let solved = self.fit(choice);
        let columns = &self.design.families[family].columns;
        // Nobody knows stamps better than to a sample.
        let is_timing = self.design.families[family].effect == EffectId::SensorDelay;
        columns.iter().all(|k| {
            let (x, bounds) = (solved.x[*k], self.design.unknowns[*k].bounds);
            !bounds.contains(&x) && (!is_timing || x > self.period_s)
        })
    }

    fn pruned(&self, mut choice: Choice) -> Choice {
        loop {
            let with = self.held_out(&choice);
            let needless = choice.causes.iter().map(|k| (*k, saved(&self.held_out(&choice.without(*k)), &with).1));
            match needless.min_by(|a, b| a.1.total_cmp(&b.1)) {
                Some((k, sds)) if sds < STAYS => choice = choice.without(k),
                _ => return choice,
            }
        }
    }

    fn best_curve(&self, choice: &Choice) -> Option<usize> {
        let before = self.held_out(choice);
        let whole: f64 = self.held_out(&Choice::default()).iter().sum();
        let saves = |k: usize| {
            let after = self.held_out(&Choice { curve: Some(k), ..choice.clone() });
            let (gain, sds) = saved(&before, &after);
            let comes = sds >= CURVE_COMES && gain > LEAST * whole && self.most_logs_gain(&before, &after);
            (k, gain - PRICE * self.design.curves[k].columns.len() as f64, comes)
        };
        let all = (0..self.design.curves.len()).map(saves).filter(|(_, _, comes)| *comes);
        all.max_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _, _)| k)
    }

    /// Whether most of the fitted logs are predicted better.
    fn most_logs_gain(&self, before: &[f64], after: &[f64]) -> bool {
        let fitted: Vec<usize> = self.system.blocks.iter().filter(|b| b.is_fit).map(|b| b.log).collect();
        let mut logs = fitted.clone();
        logs.dedup();
        let gain = |log: &&usize| {
            let own = fitted.iter().zip(before.iter().zip(after)).filter(|(own, _)| own == log);
            own.map(|(_, (before, after))| before - after).sum::<f64>() > 0.0
        };
        2 * logs.iter().filter(gain).count() >= logs.len()
    }
}

/// The problem with samples of one standard deviation \[N m\].
fn system(design: &Design, logs: &[LogData], sd_nm: f64) -> System {
    let all: Vec<usize> = (0..design.unknowns.len()).collect();
    let blocks = design.blocks(logs, (&all, 0, all.len()), &|_, _| None, sd_nm);
    System { unknowns: design.unknowns.clone(), blocks }
}

/// Root of the mean square of what is left of the fitted logs \[N m\].
fn rms(design: &Design, logs: &[LogData], x: &[f64]) -> f64 {
    let fitted = (0..logs.len()).filter(|log| logs[*log].is_fit);
    let left: Vec<f64> = fitted.flat_map(|log| design.left_nm(log, x)).collect();
    (left.iter().map(|left| left * left).sum::<f64>() / left.len().max(1) as f64).sqrt().max(f64::MIN_POSITIVE)
}

impl Found {
    /// Takes away what logs that were not fitted are predicted clearly better without.
    fn refute(&mut self) {
        while self.has_outer() {
            let choice = self.choice();
            let with = self.outer(&choice);
            let mut less: Vec<(Choice, Option<usize>)> =
                choice.causes.iter().map(|family| (choice.without(*family), Some(*family))).collect();
            if choice.curve.is_some() {
                less.push((Choice { curve: None, ..choice.clone() }, None));
            }
            let saves = less.into_iter().map(|(less, family)| (saved(&with, &self.outer(&less)), less, family));
            let clearly = saves.filter(|((_, sds), ..)| *sds >= STAYS);
            let Some((_, less, family)) = clearly.max_by(|a, b| a.0.0.total_cmp(&b.0.0)) else { return };
            match family {
                Some(family) => self.refuted.push(family),
                None => self.is_curve_refuted = true,
            }
            (self.causes, self.curve) = (less.causes.clone(), less.curve);
            self.solved = self.fit(&less);
        }
    }

    /// Weighed squares that a choice leaves on each block that is not fitted.
    fn outer(&self, choice: &Choice) -> Vec<f64> {
        let solved = self.fit(choice);
        let outer = self.system.blocks.iter().filter(|block| !block.is_fit);
        outer.map(|block| block.squares(&solved.x)).collect()
    }

    /// Whether logs that were not fitted had a say in the choice.
    pub fn asked_outer(&self) -> bool {
        !self.refuted.is_empty() || self.is_curve_refuted
    }

    /// What was chosen.
    pub fn choice(&self) -> Choice {
        Choice { causes: self.causes.clone(), curve: self.curve }
    }

    /// A choice fitted to the fitted logs.
    pub fn fit(&self, choice: &Choice) -> Solved {
        self.system.fit(&choice.columns(&self.design), |block| block.is_fit)
    }

    /// Root of the mean square of what a choice leaves of held-out logs \[N m\], of all and of each: of those that are not
    /// fitted, or where there are none of the fitted ones, each predicted from the others.
    pub fn figure(&self, choice: &Choice) -> (f64, Vec<(usize, f64)>) {
        let columns = choice.columns(&self.design);
        let squares: Vec<(usize, f64, usize)> = if self.has_outer() {
            let solved = self.fit(choice);
            let outer = self.system.blocks.iter().filter(|block| !block.is_fit);
            outer.map(|block| (block.log, block.unit * block.squares(&solved.x), block.samples)).collect()
        } else {
            let fitted = self.system.blocks.iter().filter(|block| block.is_fit);
            let left = fitted.zip(self.system.held_out(&columns));
            left.map(|(block, squares)| (block.log, block.unit * squares, block.samples)).collect()
        };
        self.roots(&squares)
    }

    /// The same as believed.
    pub fn figure_as_given(&self) -> (f64, Vec<(usize, f64)>) {
        let nothing = nalgebra::DVector::zeros(self.design.unknowns.len());
        let compared = self.system.blocks.iter().filter(|block| block.is_fit != self.has_outer());
        let squares: Vec<_> =
            compared.map(|block| (block.log, block.unit * block.squares(&nothing), block.samples)).collect();
        self.roots(&squares)
    }

    /// Whether logs are there that no choice was made on.
    pub fn has_outer(&self) -> bool {
        self.system.blocks.iter().any(|block| !block.is_fit)
    }

    fn roots(&self, squares: &[(usize, f64, usize)]) -> (f64, Vec<(usize, f64)>) {
        // Samples that are tied together count for one in the weights, not in the figures.
        let root = |of: &dyn Fn(usize) -> bool| {
            let own = squares.iter().filter(|(log, _, _)| of(*log));
            let (sum, count) = own.fold((0.0, 0), |(sum, count), (_, square, n)| (sum + square, count + n));
            (sum / f64::from(u32::try_from(count).unwrap_or(u32::MAX)).max(1.0)).sqrt()
        };
        let mut logs: Vec<usize> = squares.iter().map(|(log, _, _)| *log).collect();
        logs.dedup();
        (root(&|_| true), logs.into_iter().map(|log| (log, root(&|own| own == log))).collect())
    }

    /// Families that would do as well in the place of one that was found, itself first.
    pub fn equivalent(&self, family: usize) -> Vec<EffectId> {
        let choice = self.choice();
        let own = self.design.families[family].effect;
        let others = choice.without(family);
        let (before, with) = (self.system.held_out(&others.columns(&self.design)), {
            self.system.held_out(&choice.columns(&self.design))
        });
        let gain = saved(&before, &with).0;
        let does_as_well = |(k, other): (usize, &Family)| {
            let is_open = choice.causes.iter().all(|c| self.design.families[*c].effect != other.effect);
            let there = is_open.then(|| self.system.held_out(&others.with(k).columns(&self.design)))?;
            let (behind, sds) = saved(&there, &with);
            (sds < 1.0 || behind < 0.05 * gain).then_some(other.effect)
        };
        let mut all = vec![own];
        for effect in self.design.families.iter().enumerate().filter_map(does_as_well) {
            if !all.contains(&effect) {
                all.push(effect);
            }
        }
        if own == EffectId::SensorDelay {
            // A torque that acts late and a reading that is late look the same from here.
            all.push(EffectId::Delay);
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::super::system::{Block, Unknown};
    use super::*;
    use nalgebra::DMatrix;

    /// A cause of size 1 on the fitted log, and of these sizes on stretches of the one that is not.
    fn refuted(outer: &[f64]) -> Found {
        let block = |k: usize, is_fit: bool, size: f64| {
            let column = DMatrix::from_fn(20, 1, |i, _| ((i + 7 * k) as f64 * 0.7).sin());
            Block::new([usize::from(!is_fit), k], is_fit, &column, &(&column * size).column(0).into_owned(), 1.0)
        };
        let fitted = (0..4).map(|k| block(k, true, 1.0));
        let blocks = fitted.chain(outer.iter().enumerate().map(|(k, size)| block(k, false, *size))).collect();
        let unknowns = vec![Unknown { sd: 10.0, bounds: [f64::NEG_INFINITY, f64::INFINITY] }];
        let family = Family { effect: EffectId::JointSpring, shape: Vec::new(), columns: vec![0] };
        let design = Design {
            numbers: Vec::new(),
            families: vec![family],
            curves: Vec::new(),
            unknowns: unknowns.clone(),
            logs: Vec::new(),
            is_held: Vec::new(),
        };
        let system = System { unknowns, blocks };
        let solved = system.fit(&[0], |block| block.is_fit);
        let (causes, refuted) = (vec![0], Vec::new());
        let mut found = Found { design, system, causes, curve: None, solved, refuted, is_curve_refuted: false };
        found.refute();
        found
    }

    #[test]
    fn held_out_logs_refute_what_they_clearly_do_without_and_nothing_by_chance() {
        let chance = refuted(&[2.0, -1.5, 2.0, -1.5]);
        let left = |choice: &Choice| chance.outer(choice).iter().sum::<f64>();
        assert!(left(&Choice::default()) < left(&chance.choice()));
        assert!(chance.causes == [0] && !chance.asked_outer());
        let clear = refuted(&[0.0, 0.05, 0.0, -0.05]);
        assert!(clear.causes.is_empty() && clear.asked_outer() && clear.solved.x[0] == 0.0);
    }
}
