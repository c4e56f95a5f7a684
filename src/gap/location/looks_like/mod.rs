//! What a law looks like: plain words for a curve, from the curve alone.
//!
//! Shapes with few parameters are fitted to the curve by least squares, all of them, and compared by how much of it they
//! leave against how many parameters they take (Schwarz 1978, with the knots as samples). The best is said only where it
//! is most of the curve; a law need not have a name.

mod shape;
mod words;

use crate::joint::{LawTable, Stage};
use crate::number::math;
use shape::{Samples, Shape, shapes};

/// Places along the curve at which shapes are compared with it.
const PLACES: usize = 241;
/// Share of the curve's variation that a shape must be to be said.
const MOST: f64 = 0.85;
/// A fit that leaves less than this share of the curve's span is as good as any: nobody would see it.
const UNSEEN: f64 = 0.02;
/// A curve that strays from its mean by less than this share of it is constant.
const LEVEL: f64 = 0.1;
/// A curve whose mean square is below this many times its variance is none at all.
const NOISE: f64 = 2.0;

/// What is said of a curve that may be nothing.
pub(in crate::gap) const NOTHING: &str = "nothing that stands out of its uncertainty";

/// What the curve of a law looks like, in plain words; `sd` are standard deviations of the table's values, where known.
///
/// ```
/// use aibo_fit::{gap::looks_like, joint::{LawActs, LawTable, LawVariable}};
/// let x: Vec<f64> = (0..9).map(|k| 0.25 * f64::from(k) - 1.0).collect();
/// let y = x.iter().map(|q| -0.12 * (q - 0.1)).collect();
/// let law = LawTable::new(LawVariable::Angle, LawActs::Torque, x, y);
/// assert_eq!(looks_like(&law, None), "like a spring of 0.12 N m/rad, slack at 0.10 rad");
/// ```
pub fn looks_like(law: &LawTable, sd: Option<&[f64]>) -> String {
    look(law, sd).words
}

/// What is seen of a curve.
pub(in crate::gap) struct Look {
    pub words: String,
    /// Whether it is a torque or friction that teeth or magnets make.
    is_of_teeth: bool,
}

impl Look {
    /// Writes into a law's table what it looks like and, where that tells, the stage.
    pub fn told(self, table: &mut LawTable) {
        table.looks_like = self.words;
        if self.is_of_teeth {
            table.stage = Stage::Gearing.name().to_owned();
        }
    }
}

impl From<String> for Look {
    fn from(words: String) -> Self {
        Self { words, is_of_teeth: false }
    }
}

/// The same, and what makes it.
pub(in crate::gap) fn look(law: &LawTable, sd: Option<&[f64]>) -> Look {
    const NONE: &str = "no simple shape";
    let (Ok(variable), Ok(curve)) = (law.variable(), law.law()) else { return NONE.to_owned().into() };
    let x = &law.table.x;
    let [from, to] = [x[0], x[x.len() - 1]];
    let places = (0..PLACES).map(|k| from + (to - from) * k as f64 / (PLACES - 1) as f64);
    let at: Vec<f64> = places.collect();
    let value: Vec<f64> = at.iter().map(|x| curve.at(*x)).collect();
    let usable = sd.filter(|sd| sd.len() == x.len() && sd.iter().all(|sd| sd.is_finite() && *sd > 0.0));
    let sd: Option<Vec<f64>> = usable.map(|sd| at.iter().map(|place| between(x, sd, *place)).collect());
    let samples = Samples::new(at, value, sd.as_deref(), x.len());
    let speak = words::Words { variable, acts: law.acts, range: [from, to] };
    if samples.noise > 0.0 && samples.mean_square() < NOISE * samples.noise {
        return NOTHING.to_owned().into();
    }
    let variation = samples.variation();
    let mean = samples.mean();
    if variation < (LEVEL * mean).powi(2) || samples.noise > 0.0 && variation < NOISE * samples.noise {
        return speak.of(&Shape::Constant { value: mean }).into();
    }
    let floor = samples.noise.max((UNSEEN * samples.span()).powi(2));
    let knots = x.len() as f64;
    let score = |left: f64, parameters: usize| knots * math::ln(left + floor) + parameters as f64 * math::ln(knots);
    let best = shapes(&samples)
        .into_iter()
        .filter(|fit| fit.parameters + 1 < x.len())
        .min_by(|a, b| score(a.left, a.parameters).total_cmp(&score(b.left, b.parameters)));
    match best {
        Some(best) if best.left < (1.0 - MOST) * variation => {
            Look { words: speak.of(&best.shape), is_of_teeth: speak.is_of_teeth(&best.shape) }
        }
        _ => format!("{NONE}; {}", speak.extremes(samples.extremes())).into(),
    }
}

/// A table's value between its knots, on a straight line.
fn between(x: &[f64], y: &[f64], at: f64) -> f64 {
    let k = x.partition_point(|knot| *knot <= at).clamp(1, x.len() - 1);
    let share = ((at - x[k - 1]) / (x[k] - x[k - 1])).clamp(0.0, 1.0);
    y[k - 1] + share * (y[k] - y[k - 1])
}

#[cfg(test)]
mod tests;
