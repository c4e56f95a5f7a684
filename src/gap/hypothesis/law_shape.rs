//! A law as it is searched: waves over the range of its variable, believed to be smooth or rough.

use crate::identify::{Belief, Parameter, Search};
use crate::joint::{Chain, Law, LawActs, LawVariable, Real, Stage};
use crate::number::math;
use std::f64::consts::PI;
use std::sync::Arc;

/// A law to be fitted: what it is of, where its knots are, and the waves that add up to it.
#[derive(Clone, Debug)]
pub(in crate::gap) struct LawShape {
    pub variable: LawVariable,
    pub acts: LawActs,
    /// Knots, in the variable's unit.
    pub at: Arc<[f64]>,
    /// Values of each wave at the knots.
    waves: Arc<[Vec<f64>]>,
    /// Standard deviation that is believed of each wave's size, in the law's unit.
    sd: Vec<f64>,
    /// What the freedom of the law is charged, in deviance: how much its data tell of it (logarithm of the ratio of
    /// what is believed before and after, MacKay 1992).
    pub charge: f64,
}

/// Knots for each wave.
const KNOTS: usize = 2;
/// Share of a curve's square that its strongest range holds.
const MOST: f64 = 0.8;
impl LawShape {
    /// A law over a range, with so many waves of size one.
    pub fn between(acts: LawActs, variable: LawVariable, [from, to]: [f64; 2], count: usize) -> Self {
        let knots = KNOTS * count;
        let place = |k: usize| k as f64 / knots as f64;
        // Constants have names: Coulomb friction, one that differs with the direction, a wrong zero.
        let wave = |j: usize| (0..=knots).map(|k| math::cos(PI * j as f64 * place(k))).collect::<Vec<f64>>();
        Self {
            variable,
            acts,
            at: (0..=knots).map(|k| from + (to - from) * place(k)).collect(),
            waves: (1..count).map(wave).collect(),
            sd: (1..count).map(|j| 1.0 / j as f64).collect(),
            charge: 0.0,
        }
    }

    /// The same law, believed to be so large, with waves that get smaller the faster they swing, or all alike.
    pub fn sized(&self, size: f64, falls: bool) -> Self {
        let alike = 1.0 / (self.sd.len() as f64).sqrt();
        let sd = |j: usize| size * if falls { 1.0 / (j + 1) as f64 } else { alike };
        Self { sd: (0..self.sd.len()).map(sd).collect(), ..self.clone() }
    }

    /// The same law with what its freedom is charged.
    pub fn charged(self, charge: f64) -> Self {
        Self { charge, ..self }
    }

    /// How many numbers it has.
    pub fn count(&self) -> usize {
        self.waves.len()
    }

    /// What is believed of the size of each wave.
    pub fn sd(&self) -> &[f64] {
        &self.sd
    }

    /// Its numbers as parameters of a model.
    pub fn parameters(&self) -> impl Iterator<Item = Parameter> + '_ {
        self.sd.iter().enumerate().map(|(j, &sd)| Parameter {
            search: Search::Linear { scale: sd },
            lower: f64::NEG_INFINITY,
            upper: f64::INFINITY,
            belief: Some(Belief::new(0.0, sd)),
            ..Parameter::positive(format!("law {j}"), "f", self.acts.unit(), None, 0.0)
        })
    }

    /// Values at the knots for numbers of the law.
    pub fn values<T: Real>(&self, numbers: &[T]) -> Vec<T> {
        let at_knot = |k: usize| {
            numbers.iter().zip(self.waves.iter()).fold(T::nought(), |sum, (number, wave)| sum + *number * wave[k])
        };
        (0..self.at.len()).map(at_knot).collect()
    }

    /// Puts the law on a chain.
    pub fn apply<T: Real>(&self, numbers: &[T], chain: &mut Chain<T>) {
        // Numbers that make no curve leave the joint without the law.
        if let Ok(law) = Law::new(self.variable, self.acts, self.at.clone(), &self.values(numbers)) {
            chain.add_law(law);
        }
    }

    /// The stage of the chain that it changes.
    pub fn stage(&self) -> Stage {
        self.acts.stage(self.variable)
    }

    /// Where the curve is farthest from its mean: the shortest range that holds [`MOST`] of its square.
    pub fn strongest(&self, numbers: &[f64]) -> [f64; 2] {
        let values = self.values(numbers);
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let square: Vec<f64> = values.iter().map(|y| (y - mean).powi(2)).collect();
        let needed = MOST * square.iter().sum::<f64>();
        let n = square.len();
        let holds = |width: usize, from: usize| square[from..from + width].iter().sum::<f64>() >= needed;
        let found =
            (1..=n).find_map(|width| (0..=n - width).find(|from| holds(width, *from)).map(|from| (from, width)));
        let (from, width) = found.unwrap_or((0, n));
        [self.at[from], self.at[from + width - 1]]
    }
}
