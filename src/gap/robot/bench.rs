//! Where hypotheses about a robot are tried: the study, the vector of all samples, and simulations of them.

use super::case::RobotCase;
use super::cause::Change;
use super::forward::{Predicted, floor_of, of_those, predict};
use super::glance::Walks;
use super::layout::{Channel, FORWARD_SD_M, Layout, Row, less};
use super::limbs::Limbs;
use super::noise::Noise;
use super::place::Place;
use super::reach::reach_of;
use super::scatter::{FLOOR, Number, Scatter, Spreads};
use super::start::Body;
use super::still::flickers;
use crate::deadline::Deadline;
use crate::joint::Reach;
use crate::number::math;
use rayon::prelude::*;

/// Steps of the simulations \[s\].
#[derive(Clone, Copy, Debug)]
pub(super) struct Steps {
    /// For changes against the study's robot at the same step.
    pub coarse: f64,
    /// For the study's robot itself and for what is reported.
    pub fine: f64,
}

/// In the air joints are the same to 0.01 mrad at all these steps, and what a number changes of them is, to a
/// thousandth; on the floor feet land a little differently.
const CLAMPED: Steps = Steps { coarse: 4e-3, fine: 1e-3 };
const ON_THE_FLOOR: Steps = Steps { coarse: 5e-4, fine: 2.5e-4 };
/// A joint with free play hunts between its flanks many hundred times a second, which longer steps do not follow \[s\]; a
/// look at what play would change does with the longer of the two.
const PLAY: f64 = 5e-5;
const PLAY_AT_A_GLANCE: f64 = 1e-4;
/// Differences by which columns of uncertain numbers are taken, in their standard deviations.
const NUDGE: f64 = 0.2;
/// Robots that are drawn to see how much a walk changes with numbers that are never quite right.
const DRAWN: u64 = 24;
/// So many of them however late it is.
const AT_LEAST: u64 = 4;
/// Share of their variance that is taken as common shapes; the rest, and more, is taken as each sample's own.
const COMMON: f64 = 0.7;
const OWN: f64 = 0.5;
/// Samples to either side over which what a step does not resolve is taken as one.
const NEAR: usize = 12;

/// Logs that are simulated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Logs {
    All,
    /// Those with samples that fits see: enough to search.
    Fitted,
}

/// A study with what hypotheses about it are weighed by.
pub(super) struct Bench<'a> {
    pub case: &'a RobotCase,
    /// Until when causes are looked for.
    pub deadline: Deadline,
    pub layout: Layout,
    pub steps: Steps,
    /// What the logs read.
    pub measured: Vec<f64>,
    /// The study's robot as stated, at the fine and at the coarse step.
    pub stated: Vec<f64>,
    stated_coarse: Vec<f64>,
    pub given_logs: Vec<Predicted>,
    /// On the floor: where causes are screened.
    walks: Option<Walks>,
    /// What is simulated together.
    pub limbs: Limbs,
    /// By joint of the robot.
    pub reach: Vec<Reach>,
    pub body: Body,
    /// Standard deviation of a joint's reading \[rad\].
    pub sigma_rad: f64,
    /// Clamped: the uncertain numbers, as the first columns of the noise have them, and their standard deviations.
    pub numbers: Vec<Number>,
    pub spreads: Spreads,
    /// Samples that fits see, weighed.
    pub noise: Noise,
    /// All of them.
    pub noise_of_all: Noise,
}

/// The robot as given runs away.
#[derive(Debug)]
pub(super) struct RanAway;

impl<'a> Bench<'a> {
    pub fn new(case: &'a RobotCase, deadline: &Deadline) -> Result<Self, RanAway> {
        let layout = Layout::of(case);
        let steps = if case.is_clamped() { CLAMPED } else { ON_THE_FLOOR };
        let none = Scatter::none(case.model());
        let every = vec![true; case.logs.len()];
        let as_stated = |step_s| simulate_all(case, (&every, None), (&none, &[]), step_s, None).ok_or(RanAway);
        let given_logs = as_stated(steps.fine)?;
        let coarse = as_stated(steps.coarse)?;
        let (measured, stated) = (layout.measured(case), layout.predicted(case, &given_logs));
        let stated_coarse = layout.predicted(case, &coarse);
        let limbs = Limbs::of(case, &layout.moving());
        let reach: Vec<Reach> = (0..case.names.len()).map(|joint| reach_of(case, &given_logs, joint)).collect();
        let sigma_rad = sigma_rad(case, &layout, &measured, &stated);
        let blank = || Noise::new(Vec::new(), Vec::new()).expect("nothing is finite");
        let body = Body { floor: floor_of(case), mass_kg: case.model().total_mass_kg() };
        let walks = if case.is_clamped() { None } else { Some(Walks::new(case, &layout).ok_or(RanAway)?) };
        let mut bench = Self {
            case,
            deadline: deadline.clone(),
            layout,
            steps,
            measured,
            stated,
            stated_coarse,
            given_logs,
            walks,
            limbs,
            spreads: Spreads::of(case, &reach),
            reach,
            body,
            sigma_rad,
            numbers: Vec::new(),
            noise: blank(),
            noise_of_all: blank(),
        };
        if case.is_clamped() {
            let (columns, numbers) = bench.uncertain(&bench.limbs.all(), Logs::All, (&none, &[])).ok_or(RanAway)?;
            bench.numbers = numbers;
            bench.weigh_by(columns, &vec![0.0; bench.layout.len])?;
        } else {
            let (columns, mut extra) = bench.drawn();
            extra.iter_mut().zip(bench.unresolved()).for_each(|(extra, more)| *extra += more);
            bench.weigh_by(columns, &extra)?;
        }
        Ok(bench)
    }

    /// Takes columns of what is uncertain, and what each sample's variance has more, for the noise.
    fn weigh_by(&mut self, columns: Vec<Vec<f64>>, extra: &[f64]) -> Result<(), RanAway> {
        let variance = |row: &Row| match row.channel {
            Channel::Joint(_) => self.sigma_rad.powi(2),
            Channel::Base(_) => rough(&self.measured[row.range.clone()]).max(1e-4).powi(2),
            Channel::Forward => FORWARD_SD_M.powi(2),
        };
        let half_rad = self.half_a_step_rad();
        let mut weight = vec![0.0; self.layout.len];
        for row in &self.layout.rows {
            let own = variance(row);
            let flickers = match row.channel {
                Channel::Joint(_) => flickers(&self.measured[row.range.clone()], 2.0 * half_rad),
                _ => vec![false; row.range.len()],
            };
            for (k, flickers) in row.range.clone().zip(flickers) {
                let own = if flickers { own.max(half_rad.powi(2)) } else { own };
                weight[k] = if self.layout.compared[k] { 1.0 / (own + extra[k]) } else { 0.0 };
            }
        }
        self.noise_of_all = Noise::new(weight, columns).ok_or(RanAway)?;
        self.noise = self.noise_of_all.only(|k| !self.layout.held[k]);
        Ok(())
    }

    /// Readings with changes; NaN beyond `until_s`, `None` where the motion runs away.
    pub fn simulate(
        &self,
        scatter: &Scatter,
        changes: &[Change],
        step_s: f64,
        until_s: Option<f64>,
    ) -> Option<Vec<f64>> {
        let logs = simulate_all(self.case, (&self.asked(Logs::All), None), (scatter, changes), step_s, until_s)?;
        Some(self.layout.predicted(self.case, &logs))
    }

    /// What other numbers and changes make of the robot; 0 in logs that are not simulated.
    pub fn difference(&self, logs: Logs, scatter: &Scatter, changes: &[Change]) -> Option<Vec<f64>> {
        self.difference_of(&self.limbs.touched(scatter, changes), logs, (scatter, changes))
    }

    /// The same of some limbs, 0 elsewhere.
    pub fn difference_of(&self, limbs: &[usize], logs: Logs, of: (&Scatter, &[Change])) -> Option<Vec<f64>> {
        self.difference_at(limbs, logs, of, (PLAY, None))
    }

    /// What changes make of what fits see, roughly where there is free play; 0 beyond `until_s`.
    pub fn glance(&self, changes: &[Change], until_s: Option<f64>) -> Option<Vec<f64>> {
        if self.deadline.leaves_out("a look at some causes and joints") {
            return None;
        }
        match (&self.walks, until_s) {
            (Some(walks), Some(until_s)) if !has_play(changes) => {
                walks.difference(self.case, &self.layout, &self.asked(Logs::Fitted), changes, until_s)
            }
            _ => {
                let none = Scatter::none(self.case.model());
                let limbs = self.limbs.touched(&none, changes);
                self.difference_at(&limbs, Logs::Fitted, (&none, changes), (PLAY_AT_A_GLANCE, until_s))
            }
        }
    }

    /// At the coarse step against the coarse step, so that errors cancel; limbs with free play at that for play, and clamped
    /// ones whose torque jumps at the fine one, against the fine one.
    fn difference_at(
        &self,
        limbs: &[usize],
        logs: Logs,
        (scatter, changes): (&Scatter, &[Change]),
        (play_s, until_s): (f64, Option<f64>),
    ) -> Option<Vec<f64>> {
        let asked = self.asked(logs);
        let play = changes.iter().filter(|change| change.cause.is_play());
        let playing = self.limbs.of_places(play.map(|change| &change.place));
        let (playing, others): (Vec<usize>, Vec<usize>) = limbs.iter().partition(|limb| playing.contains(limb));
        let jumps = changes.iter().filter(|change| self.case.is_clamped() && change.cause.jumps());
        let jumping = self.limbs.of_places(jumps.map(|change| &change.place));
        let (jumping, calm): (Vec<usize>, Vec<usize>) = others.into_iter().partition(|limb| jumping.contains(limb));
        let mut difference = vec![0.0; self.layout.len];
        let parts = [
            (calm, self.steps.coarse, &self.stated_coarse),
            (jumping, self.steps.fine, &self.stated),
            (playing, play_s, &self.stated),
        ];
        for (limbs, step_s, given) in parts {
            if limbs.is_empty() {
                continue;
            }
            let joints = self.limbs.joints_of(&limbs);
            let logs = simulate_all(self.case, (&asked, Some(&joints)), (scatter, changes), step_s, until_s)?;
            let there = less(&self.layout.predicted(self.case, &logs), given);
            let is_its = |row: &&Row| match row.channel {
                Channel::Joint(joint) => joints.contains(&joint),
                _ => true,
            };
            for row in self.layout.rows.iter().filter(is_its) {
                difference[row.range.clone()].copy_from_slice(&there[row.range.clone()]);
            }
        }
        Some(difference)
    }

    /// Whether a search simulates all logs.
    pub fn fits_see_all_logs(&self) -> bool {
        self.asked(Logs::Fitted).iter().all(|asked| *asked)
    }

    /// By log, whether it is simulated.
    fn asked(&self, logs: Logs) -> Vec<bool> {
        let mut asked = vec![logs == Logs::All; self.case.logs.len()];
        for row in &self.layout.rows {
            asked[row.log] |= self.fits_see(row);
        }
        asked
    }

    /// Whether a row has samples that fits see.
    pub fn fits_see(&self, row: &Row) -> bool {
        self.layout.held[row.range.clone()].iter().any(|held| !held)
    }

    /// Measured less stated.
    pub fn gap(&self) -> Vec<f64> {
        self.measured.iter().zip(&self.stated).map(|(measured, stated)| measured - stated).collect()
    }

    /// RMS of a residual over the samples of a joint that are compared \[rad\].
    pub fn rms_rad(&self, joint: usize, left: &[f64]) -> f64 {
        let rows = self.layout.joints().filter(|(of, _)| *of == joint);
        let samples = rows.flat_map(|(_, row)| row.range.clone()).filter(|k| self.layout.compared[*k]);
        let (sum, count) = samples.fold((0.0, 0.0), |(sum, count), k| (sum + left[k].powi(2), count + 1.0));
        f64::sqrt(sum / f64::max(count, 1.0))
    }

    /// Keeps the rows of some joints, all else 0.
    pub fn restricted(&self, mut column: Vec<f64>, joints: &[usize]) -> Vec<f64> {
        for row in &self.layout.rows {
            if !matches!(row.channel, Channel::Joint(joint) if joints.contains(&joint)) {
                column[row.range.clone()].fill(0.0);
            }
        }
        column
    }

    /// A number as the study states it, in its unit.
    pub fn believed(&self, number: Number) -> f64 {
        let law = |joint: usize| {
            let id = self.case.model().joint_ids().nth(joint);
            id.map(|id| &self.case.nominal.joints.drive(id).chain.friction)
        };
        match number {
            Number::Mass(body) => self.case.model().bodies()[body].mass_kg,
            Number::Coulomb(joint) => law(joint).map_or(0.0, |law| law.coulomb_nm),
            Number::Viscous(joint) => law(joint).map_or(0.0, |law| law.viscous_nm_s_rad),
        }
    }

    /// Joints that are compared on the limb of a body.
    pub fn limb_of(&self, body: usize) -> Place {
        let limb = self.limbs.of_body(body);
        Place { joints: limb.map_or_else(Vec::new, |limb| self.limbs.joints_of(&[limb])) }
    }

    /// Clamped: what each mass and friction of some limbs changes of a robot, per standard deviation, and what the sensors
    /// may have in common. A number with which it runs away is left out; `None` where it does so without.
    pub fn uncertain(
        &self,
        limbs: &[usize],
        logs: Logs,
        (scatter, changes): (&Scatter, &[Change]),
    ) -> Option<(Vec<Vec<f64>>, Vec<Number>)> {
        let bodies = self.case.model().bodies();
        let numbers_of = |limb: &usize| -> Vec<Number> {
            let hangs = |body: &usize| self.limbs.of_body(*body) == Some(*limb) && bodies[*body].mass_kg > 0.0;
            let masses = (0..bodies.len()).filter(hangs).map(Number::Mass);
            let joints = self.limbs.joints()[*limb].iter();
            masses.chain(joints.flat_map(|joint| [Number::Coulomb(*joint), Number::Viscous(*joint)])).collect()
        };
        let by_limb: Vec<(usize, Vec<Number>)> = limbs.iter().map(|limb| (*limb, numbers_of(limb))).collect();
        let here = self.difference_of(limbs, logs, (scatter, changes))?;
        let longest = by_limb.iter().map(|(_, numbers)| numbers.len()).max().unwrap_or(0);
        let together = |k: usize| -> Vec<(Vec<f64>, Number)> {
            let nudged: Vec<(usize, Number)> =
                by_limb.iter().filter_map(|(limb, numbers)| Some((*limb, *numbers.get(k)?))).collect();
            let limbs: Vec<usize> = nudged.iter().map(|(limb, _)| *limb).collect();
            let mut other = scatter.clone();
            nudged.iter().for_each(|(_, number)| other.put(*number, NUDGE * self.spreads.sd(*number)));
            let Some(mut column) = self.difference_of(&limbs, logs, (&other, changes)) else { return Vec::new() };
            column.iter_mut().zip(&here).for_each(|(there, here)| *there = (*there - here) / NUDGE);
            let of = |(limb, number): &(usize, Number)| {
                (self.restricted(column.clone(), &self.limbs.joints()[*limb]), *number)
            };
            nudged.iter().map(of).collect()
        };
        let (mut columns, numbers): (Vec<Vec<f64>>, Vec<Number>) =
            (0..longest).into_par_iter().flat_map(together).unzip();
        columns.push(self.common_offset());
        Some((columns, numbers))
    }

    /// On the floor: robots drawn at random. Where and when feet land changes with anything, and not in proportion.
    fn drawn(&self) -> (Vec<Vec<f64>>, Vec<f64>) {
        let law = |id| {
            let law = &self.case.nominal.joints.drive(id).chain.friction;
            [law.coulomb_nm, law.viscous_nm_s_rad]
        };
        let friction: Vec<[f64; 2]> = self.case.model().joint_ids().map(law).collect();
        let study = &self.case.study;
        // Nobody measured the floor under a robot that somebody else described: it is as uncertain as the study says.
        let floor = if study.described.is_some() { study.uncertain.floor.all } else { FLOOR };
        let one =
            |number: u64| self.difference(Logs::All, &Scatter::drawn(self.case.model(), &friction, floor, number), &[]);
        let is_in_time = |number: &u64| {
            *number < AT_LEAST || !self.deadline.leaves_out("some of the robots that a walk is weighed by")
        };
        let robots: Vec<Vec<f64>> = (0..DRAWN).into_par_iter().filter(is_in_time).filter_map(one).collect();
        let count = robots.len().max(1) as f64;
        let mean_square = |k: usize| robots.iter().map(|robot: &Vec<f64>| robot[k].powi(2)).sum::<f64>() / count;
        let extra = (0..self.layout.len).map(|k| OWN * mean_square(k)).collect();
        let share = (COMMON / count).sqrt();
        let mut columns: Vec<Vec<f64>> =
            robots.iter().map(|robot| robot.iter().map(|difference| share * difference).collect()).collect();
        columns.push(self.common_offset());
        (columns, extra)
    }

    /// Variance by sample of what the steps of a simulation do not resolve: feet land a little earlier or later by any other
    /// integrator too \[rad^2\].
    fn unresolved(&self) -> Vec<f64> {
        let squares: Vec<f64> =
            self.stated.iter().zip(&self.stated_coarse).map(|(fine, coarse)| (fine - coarse).powi(2)).collect();
        let mut variance = vec![0.0; self.layout.len];
        for row in &self.layout.rows {
            for k in row.range.clone() {
                let near = k.saturating_sub(NEAR).max(row.range.start)..(k + NEAR + 1).min(row.range.end);
                let count = near.len() as f64;
                variance[k] = squares[near].iter().sum::<f64>() / count;
            }
        }
        variance
    }

    fn half_a_step_rad(&self) -> f64 {
        0.5 * self.case.study.sensor.resolution_rad.unwrap_or(0.0)
    }

    /// A sensor that reads up or down by half a step, all joints alike (section B.1).
    fn common_offset(&self) -> Vec<f64> {
        let half_rad = self.half_a_step_rad();
        let mut column = vec![0.0; self.layout.len];
        for (_, row) in self.layout.joints() {
            column[row.range.clone()].fill(half_rad);
        }
        column
    }
}

/// Whether a joint has free play.
fn has_play(changes: &[Change]) -> bool {
    changes.iter().any(|change| change.cause.is_play())
}

/// A step, or the one that free play needs \[s\].
pub(super) fn followed_s(step_s: f64, changes: &[Change]) -> f64 {
    if has_play(changes) { PLAY } else { step_s }
}

fn simulate_all(
    case: &RobotCase,
    (logs, joints): (&[bool], Option<&[usize]>),
    of: (&Scatter, &[Change]),
    step_s: f64,
    until_s: Option<f64>,
) -> Option<Vec<Predicted>> {
    let until_s = until_s.unwrap_or(f64::INFINITY);
    of_those(case, &case.logs, logs, |log| predict(case, log, joints, of, step_s, until_s).ok().flatten())
}

/// Standard deviation of a reading: what the study says, or the roughness of what the study's robot leaves.
fn sigma_rad(case: &RobotCase, layout: &Layout, measured: &[f64], given: &[f64]) -> f64 {
    let rounding = case.study.sensor.resolution_rad.unwrap_or(0.0) / 12f64.sqrt();
    if let Some(noise_rad) = case.study.sensor.noise_rad {
        return math::hypot(noise_rad, rounding).max(1e-6);
    }
    let left = |range: std::ops::Range<usize>| -> Vec<f64> { range.map(|k| measured[k] - given[k]).collect() };
    let mut by_row: Vec<f64> = layout.joints().map(|(_, row)| rough(&left(row.range.clone()))).collect();
    by_row.sort_by(f64::total_cmp);
    by_row.get(by_row.len() / 2).copied().unwrap_or(0.0).max(rounding).max(1e-6)
}

/// Standard deviation of white noise in a column, by second differences: the median of short blocks, which impacts do
/// not move.
fn rough(column: &[f64]) -> f64 {
    const BLOCK: usize = 24;
    let of = |block: &[f64]| {
        let sum: f64 = block.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).powi(2)).sum();
        sum / (6.0 * (block.len() - 2) as f64)
    };
    let mut blocks: Vec<f64> = column.chunks_exact(BLOCK).map(of).collect();
    blocks.sort_by(f64::total_cmp);
    blocks.get(blocks.len() / 2).copied().unwrap_or(0.0).sqrt()
}
