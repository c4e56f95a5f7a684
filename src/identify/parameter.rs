//! Parameters of a joint model: names, units, bounds, and the coordinate in which each is searched.

use super::Named;
use super::belief::FINDING_SD;
use crate::fit::Coordinate;
use crate::joint::Real;
use crate::number::math;

/// How a parameter is searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Search {
    /// By its logarithm: a quantity that is never zero, and known to a factor rather than to a difference.
    Logarithm,
    /// As it is, with a typical change: friction, which may be zero, and angles.
    Linear {
        /// A typical change, in the parameter's unit.
        scale: f64,
    },
}

/// One parameter of a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// The name in `fit.json` and on the command line, e.g. `inertia`.
    pub name: String,
    /// The letter in the equations, e.g. `I*`.
    pub symbol: String,
    /// Its unit.
    pub unit: String,
    /// How it is searched.
    pub search: Search,
    /// What the engineer believes, where known.
    pub nominal: Option<f64>,
    /// Where the search begins; the value, where the parameter is fixed.
    pub start: f64,
    /// Lowest value; 0 for a logarithm means its own reach.
    pub lower: f64,
    /// Highest value.
    pub upper: f64,
    /// Not searched.
    pub fixed: bool,
    /// Half-width, as a logarithm or in typical sizes, below which no log can tell the parameter, because other things
    /// that are taken as known are not known better.
    pub known_to: f64,
    /// What is believed of it beforehand; `None`: nothing but its bounds.
    pub belief: Option<Belief>,
    /// What logs show of it directly, beside their motion.
    pub seen: Option<Belief>,
}

/// What is believed of a parameter beforehand: a distribution of its search coordinate that is normal near its middle
/// and has the heavier tails of Student's t, because a number that was written down wrongly is not a little wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Belief {
    /// Middle, in the search coordinate.
    pub at: f64,
    /// Standard deviation, in the search coordinate: for a logarithm the relative one.
    pub sd: f64,
    /// Degrees of freedom; infinite: a normal distribution.
    pub freedom: f64,
    /// From so many standard deviations on the tails are those of a normal distribution again; infinite: nowhere.
    pub tails_to: f64,
}

/// Degrees of freedom of a belief, unless it is normal.
const TAIL: f64 = 4.0;
/// What was measured is off by so many standard deviations at the most without paying for each.
const MEASURED_TO: f64 = 10.0;

impl Belief {
    /// A belief with the tails of Student's t.
    pub fn new(at: f64, sd: f64) -> Self {
        Self { at, sd, freedom: TAIL, tails_to: f64::INFINITY }
    }

    /// The same without heavy tails.
    pub fn normal(self) -> Self {
        Self { freedom: f64::INFINITY, ..self }
    }

    /// The same of what was measured: it may be off by what is written down wrongly, but not by anything.
    pub fn of_measured(self) -> Self {
        Self { tails_to: MEASURED_TO, ..self }
    }

    /// Root of what a value of the search coordinate costs in deviance, with its sign: how many standard deviations it
    /// lies away, less and less of those that are many; and the slope of that.
    pub fn strain(&self, x: f64) -> [f64; 2] {
        let away = (x - self.at) / self.sd;
        if self.freedom.is_infinite() {
            return [away, 1.0 / self.sd];
        }
        let share = away * away / self.freedom;
        let beyond = (away.abs() - self.tails_to).max(0.0);
        let root = (self.freedom * math::ln_1p(share) + beyond * beyond).sqrt();
        let slope = if root > 1e-6 { (away.abs() / (1.0 + share) + beyond) / root } else { 1.0 };
        [root.copysign(away), slope / self.sd]
    }
}

/// Search range of a logarithmic parameter, either way of its start: a factor of 150.
const LOG_REACH: f64 = 5.0;

/// What numbers are usually known to: relative, or in typical sizes.
const USUAL: f64 = 0.1;

impl Parameter {
    /// A positive quantity, searched by its logarithm.
    pub fn positive(name: impl Into<String>, symbol: &str, unit: &str, nominal: Option<f64>, start: f64) -> Self {
        Self {
            name: name.into(),
            symbol: symbol.into(),
            unit: unit.into(),
            search: Search::Logarithm,
            nominal,
            start,
            lower: 0.0,
            upper: f64::INFINITY,
            fixed: false,
            known_to: 0.0,
            belief: None,
            seen: None,
        }
    }

    /// A friction, zero or above.
    pub fn friction(
        name: impl Into<String>,
        symbol: &str,
        unit: &str,
        nominal: Option<f64>,
        start: f64,
        scale: f64,
    ) -> Self {
        Self { search: Search::Linear { scale }, ..Self::positive(name, symbol, unit, nominal, start) }
    }

    /// An angle \[rad\] within half a turn of its start.
    pub fn angle(name: impl Into<String>, symbol: &str, nominal: Option<f64>, start: f64) -> Self {
        Self {
            lower: start - std::f64::consts::PI,
            upper: start + std::f64::consts::PI,
            search: Search::Linear { scale: 0.1 },
            ..Self::positive(name, symbol, "rad", nominal, start)
        }
    }

    /// The same parameter, believed to lie about its start within a standard deviation: relative where it is searched by
    /// its logarithm, in its unit elsewhere. One that is believed exactly is not searched.
    pub fn believed(self, sd: f64) -> Self {
        let belief = Belief::new(self.to_coordinate(self.start), sd);
        Self { belief: (sd > 0.0).then_some(belief), fixed: self.fixed || sd <= 0.0, ..self }
    }

    /// What is believed of it, and what is seen of it.
    pub fn known_of(&self) -> impl Iterator<Item = Belief> {
        self.belief.into_iter().chain(self.seen)
    }

    /// How many standard deviations of its belief a value lies away; `None` where nothing is believed.
    pub fn moved_sd(&self, value: f64) -> Option<f64> {
        self.belief.map(|belief| (self.to_coordinate(value) - belief.at) / belief.sd)
    }

    /// Range of the search coordinate in which its belief makes no finding of it, widened to hold `x`.
    pub fn believable(&self, x: f64) -> [f64; 2] {
        let reach = |belief: Belief| FINDING_SD * belief.sd;
        let range = self.belief.map(|belief| [belief.at - reach(belief), belief.at + reach(belief)]);
        range.map_or([f64::NEG_INFINITY, f64::INFINITY], |[low, high]| [low.min(x), high.max(x)])
    }

    /// How far a value lies from the nominal one: in standard deviations of the belief, or of what would usually be
    /// believed where the user wants none.
    pub fn moved(&self, value: f64) -> f64 {
        let usual = USUAL * if let Search::Linear { scale } = self.search { scale } else { 1.0 };
        let away = |nominal: f64| (self.to_coordinate(value) - self.to_coordinate(nominal)) / usual;
        self.moved_sd(value).or(self.nominal.map(away)).filter(|moved| moved.is_finite()).unwrap_or(0.0)
    }

    /// Which of the pendulum models' parameters it is; `None` for one of another model.
    pub fn named(&self) -> Option<Named> {
        Named::of(&self.name)
    }

    /// The same parameter, not searched.
    pub fn fixed(self) -> Self {
        Self { fixed: true, ..self }
    }

    /// The coordinate of this parameter.
    pub fn coordinate(&self) -> Coordinate {
        let (lower, upper, scale) = match self.search {
            Search::Logarithm => {
                let reach =
                    |bound: f64, default: f64| if bound > 0.0 && bound.is_finite() { math::ln(bound) } else { default };
                let middle = math::ln(self.start);
                (reach(self.lower, middle - LOG_REACH), reach(self.upper, middle + LOG_REACH), 1.0)
            }
            Search::Linear { scale } => (self.lower, self.upper, scale),
        };
        Coordinate { name: self.name.clone(), lower, upper, scale }
    }

    /// The coordinate's value at a parameter value.
    pub fn to_coordinate(&self, value: f64) -> f64 {
        match self.search {
            Search::Logarithm => math::ln(value),
            Search::Linear { .. } => value,
        }
    }

    /// The parameter's value at a coordinate value.
    pub fn from_coordinate<T: Real>(&self, x: T) -> T {
        match self.search {
            Search::Logarithm => x.exp(),
            Search::Linear { .. } => x,
        }
    }
}

/// Values of all parameters over `T`: `base`, with the free ones taken from the coordinates `x`.
///
/// `seed` turns the value of the k-th coordinate into a variable, or leaves it a constant.
pub(crate) fn values_in<T: Real>(
    parameters: &[Parameter],
    base: &[f64],
    free: &[usize],
    x: &[f64],
    seed: impl Fn(f64, usize) -> T,
) -> Vec<T> {
    let mut values: Vec<T> = base.iter().map(|&v| T::constant(v)).collect();
    for (k, &i) in free.iter().enumerate() {
        values[i] = parameters[i].from_coordinate(seed(x[k], k));
    }
    values
}

/// Indices of the parameters that are searched.
pub(crate) fn free_of(parameters: &[Parameter]) -> Vec<usize> {
    (0..parameters.len()).filter(|&i| !parameters[i].fixed).collect()
}

/// Start values of all parameters.
pub(crate) fn starts_of(parameters: &[Parameter]) -> Vec<f64> {
    parameters.iter().map(|p| p.start).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn what_is_written_down_may_be_far_off_and_what_is_measured_pays_for_it() {
        let (written, measured) = (Belief::new(0.0, 0.1), Belief::new(0.0, 0.1).of_measured());
        for x in [-0.9, 0.05, 1.0] {
            assert_eq!(written.strain(x), measured.strain(x));
        }
        assert!(written.strain(2.9)[0] < 5.0 && measured.strain(2.9)[0] > 19.0);
        for x in [-2.9, -0.3, 0.2, 1.5] {
            let [before, after] = [x - 1e-6, x + 1e-6].map(|x| measured.strain(x)[0]);
            assert_relative_eq!(measured.strain(x)[1], (after - before) / 2e-6, max_relative = 1e-5);
        }
    }

    #[test]
    fn coordinates_go_there_and_back() {
        let inertia = Parameter::positive("inertia", "I*", "kg m^2", None, 2e-3);
        assert_relative_eq!(inertia.from_coordinate(inertia.to_coordinate(5e-4)), 5e-4, max_relative = 1e-14);
        let c = inertia.coordinate();
        assert!(c.lower < 2e-3f64.ln() && c.upper > 2e-3f64.ln() && c.lower.is_finite());
        let mu_c = Parameter::friction("coulomb", "mu_c", "N m", None, 0.0, 0.1);
        assert_eq!((mu_c.coordinate().lower, mu_c.from_coordinate(0.0)), (0.0, 0.0));
    }
}
