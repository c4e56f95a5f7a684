//! A body that may be other than described, fitted beside joints' causes to the torques of all joints along their motion.

use super::bench::{Bench, Shared, differences};
use super::parameters::Estimated;
use super::search::Choice;
use super::system::{Solved, System, Unknown};
use crate::gap::clamped::{BodyKind, ClampedCaseError};
use crate::number::chance::HALF_95;
use crate::robot::description::{BodyChange, LinkId};
use nalgebra::Vector3;

/// What an unknown costs, and a cause of a single joint.
pub(super) const PRICE: f64 = 4.0;
pub(super) const PRICE_OF_CAUSE: f64 = 8.0;
/// Points about which torques are made linear at most.
const POINTS: usize = 16;
/// How far the next of them is at most, in what is believed: at first, and how that grows where it explains more, and shrinks
/// where it does not. A payload's mass and its place are known together, and straight lines lead far astray.
const REACH: f64 = 1.0;
const FARTHER: f64 = 2.0;
const NEARER: f64 = 0.25;
/// A point that gains less is the last.
const WORTH_A_POINT: f64 = 0.1;
/// What straight lines may promise at the last of them without being doubted.
const AS_PROMISED: f64 = 1.0;
/// Of differences, in units of what is believed.
const NUDGE: f64 = 1e-3;
/// The least payload whose place is told, in such units.
const LEAST_PAYLOAD: f64 = 0.05;

/// A body that may be other than described.
#[derive(Clone, Debug)]
pub(super) struct Hypothesis {
    pub kind: BodyKind,
    pub link: LinkId,
    /// From where a payload's place is counted, in the link's frame.
    pub origin_m: Vector3<f64>,
    /// Standard deviations of the unknowns.
    pub sd: Vec<f64>,
}

impl Hypothesis {
    /// What unknowns mean.
    pub fn change(&self, x: &[f64]) -> BodyChange {
        let vector = |x: &[f64]| Vector3::new(x[0], x[1], x[2]);
        match self.kind {
            BodyKind::Payload => BodyChange::Payload { mass_kg: x[0], place_m: self.origin_m + vector(&x[1..]) },
            BodyKind::BodyMass => BodyChange::Mass { factor: 1.0 + x[0] },
            BodyKind::BodyCom => BodyChange::Centre { shift_m: vector(x) },
        }
    }

    /// Where torques are made linear for unknowns near these: the place of no mass at all would not matter.
    fn linear_at(&self, x: &[f64]) -> Vec<f64> {
        let mut at = x.to_vec();
        if self.kind == BodyKind::Payload {
            at[0] = at[0].max(LEAST_PAYLOAD * self.sd[0]);
        }
        at
    }

    /// Bounds of the unknowns.
    fn bounds(&self, unknown: usize) -> [f64; 2] {
        match (self.kind, unknown) {
            (BodyKind::Payload, 0) => [0.0, f64::INFINITY],
            (BodyKind::BodyMass, _) => [-0.95, f64::INFINITY],
            _ => [f64::NEG_INFINITY, f64::INFINITY],
        }
    }
}

/// A hypothesis where it fits best.
pub(super) struct Fitted {
    pub hypothesis: Hypothesis,
    pub x: Vec<f64>,
    /// The criterion with what its unknowns cost, and the causes beside it.
    pub priced: f64,
    pub numbers: Vec<Estimated>,
}

impl Fitted {
    /// Whether its 95 % interval leaves out a body as described. A payload's mass may be any where its place is open: that
    /// there is one shows in the criterion.
    pub fn is_told(&self) -> bool {
        let is_told = |number: &Estimated| number.value.abs() > HALF_95 * number.sd;
        match self.hypothesis.kind {
            BodyKind::Payload => true,
            BodyKind::BodyMass => self.numbers.first().is_some_and(is_told),
            BodyKind::BodyCom => self.numbers.iter().any(is_told),
        }
    }
}

/// What causes of joints cost.
pub(super) fn price(choices: &[Choice]) -> f64 {
    PRICE_OF_CAUSE * choices.iter().map(|choice| choice.causes.len()).sum::<usize>() as f64
}

/// Torques made linear about a body.
struct Linear {
    /// Unknowns of the body, where it is.
    at: Vec<f64>,
    /// Joints' own unknowns, the body's behind them, and what it adds beyond its columns.
    system: System,
}

impl Linear {
    /// What is best within these bounds of the body's unknowns.
    fn within(&self, bounds: &dyn Fn(usize) -> [f64; 2]) -> Solved {
        let mut system = self.system.clone();
        let first = self.first();
        for k in 0..self.at.len() {
            system.unknowns[first + k].bounds = bounds(k);
        }
        system.fit(&system.all(), |block| block.is_fit)
    }

    /// Place of the body's first unknown.
    fn first(&self) -> usize {
        self.system.unknowns.len() - self.at.len() - 1
    }

    /// The body's unknowns.
    fn of_body<'a>(&self, solved: &'a Solved) -> &'a [f64] {
        &solved.x.as_slice()[self.first()..][..self.at.len()]
    }

    /// Squares that are left, less the one of the factor that is held.
    fn criterion(&self, solved: &Solved) -> f64 {
        self.system.criterion(solved) - 1.0
    }

    /// The same where the body is.
    fn here(&self) -> f64 {
        self.criterion(&self.within(&|k| [self.at[k]; 2]))
    }
}

impl Bench<'_> {
    /// A hypothesis beside these causes of joints, from unknowns on that are near, or from a body as described.
    pub fn fitted(
        &self,
        hypothesis: Hypothesis,
        near: Option<&[f64]>,
        choices: &[Choice],
    ) -> Result<Fitted, ClampedCaseError> {
        let described = self.torques(&self.setup.description)?;
        let linear = |x: &[f64]| self.linear(&hypothesis, hypothesis.linear_at(x), &described, choices);
        let start = near.map_or_else(|| vec![0.0; hypothesis.sd.len()], <[f64]>::to_vec);
        let mut best = linear(&start)?;
        let (mut left, mut reach) = (best.here(), REACH);
        for _ in 1..POINTS {
            let around = |k: usize| {
                let [low, high] = hypothesis.bounds(k);
                let by = reach * hypothesis.sd[k];
                [(best.at[k] - by).max(low), (best.at[k] + by).min(high)]
            };
            let solved = best.within(&around);
            if left - best.criterion(&solved) < WORTH_A_POINT {
                break;
            }
            let there = linear(best.of_body(&solved))?;
            let left_there = there.here();
            if left_there < left {
                (best, left) = (there, left_there);
                reach *= FARTHER;
            } else {
                reach *= NEARER;
            }
        }
        let free = best.within(&|k| hypothesis.bounds(k));
        // Where straight lines promise more than the way there keeps, it is where the way ends.
        let is_there = left - best.criterion(&free) < AS_PROMISED;
        let x = if is_there { best.of_body(&free).to_vec() } else { best.at.clone() };
        let refits: Vec<Solved> = best.system.refits(&best.system.all());
        let number =
            |(k, value): (usize, &f64)| Estimated { value: *value, ..Estimated::new(best.first() + k, &free, &refits) };
        let numbers = x.iter().enumerate().map(number).collect();
        let priced = if is_there { best.criterion(&free) } else { left } + PRICE * x.len() as f64 + price(choices);
        Ok(Fitted { x, hypothesis, priced, numbers })
    }

    /// Torques made linear about a body that is so much other than described.
    fn linear(
        &self,
        hypothesis: &Hypothesis,
        at: Vec<f64>,
        described: &[Vec<Vec<f64>>],
        choices: &[Choice],
    ) -> Result<Linear, ClampedCaseError> {
        let torques =
            |x: &[f64]| self.torques(&self.setup.description.with_change(hypothesis.link, &hypothesis.change(x)));
        let here = torques(&at)?;
        let mut shared: Shared = Vec::new();
        for k in 0..at.len() {
            let mut there = at.clone();
            let step = NUDGE * hypothesis.sd[k];
            there[k] += step;
            shared.push(differences(&torques(&there)?, &here, step));
        }
        // What the change adds beyond its columns is taken as known.
        let beyond = |log: usize| -> Vec<Vec<f64>> {
            let joint = |joint: usize| {
                let added = here[log][joint].iter().zip(&described[log][joint]).map(|(a, b)| a - b);
                let told = |s: usize| at.iter().zip(&shared).map(|(x, column)| x * column[log][joint][s]).sum::<f64>();
                added.enumerate().map(|(s, added)| added - told(s)).collect()
            };
            (0..here[log].len()).map(joint).collect()
        };
        let beyond: Vec<Vec<Vec<f64>>> = (0..here.len()).map(beyond).collect();
        shared.push(beyond);
        let unknown = |(k, sd): (usize, &f64)| Unknown { sd: *sd, bounds: hypothesis.bounds(k) };
        let mut unknowns: Vec<Unknown> = hypothesis.sd.iter().enumerate().map(unknown).collect();
        // Its factor is one, and nobody may say otherwise.
        unknowns.push(Unknown { sd: 1.0, bounds: [1.0, 1.0] });
        let system = self.system(&|joint| choices[joint].columns(&self.founds[joint].design), &shared, &unknowns);
        Ok(Linear { at, system })
    }
}
