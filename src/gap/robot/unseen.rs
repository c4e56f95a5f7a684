//! Samples that no fit saw, and what hypotheses leave of them.

use super::attained::Attained;
use super::bench::Bench;

/// Samples that no fit saw.
pub(super) struct Unseen<'a> {
    bench: &'a Bench<'a>,
    samples: Vec<usize>,
}

/// On samples that no fit saw a cause gains at least so much, and this share of what is promised of them.
const GAINED: f64 = 8.0;
const OF_PROMISED: f64 = 0.3;
/// A cause that changes no more than this share of that on them is one that they cannot show: a motor's limit, say, which only
/// the faster logs reach.
const SILENT: f64 = 0.02;

impl<'a> Unseen<'a> {
    pub fn of(bench: &'a Bench<'a>) -> Self {
        let weight = &bench.noise_of_all.weight;
        Self { bench, samples: (0..weight.len()).filter(|k| bench.layout.held[*k] && weight[*k] > 0.0).collect() }
    }

    /// What is left on the floor with the uncertain numbers adapted, to first order.
    ///
    /// The numbers are those of robots drawn at random, and together they imitate much of what a walk does once and never
    /// again, as it lands. Where they predict the samples that no fit saw worse than the numbers as stated, these stand.
    pub fn adapted(&self, residual: &[f64]) -> Vec<f64> {
        let adapted = self.bench.noise.adapted(residual);
        if self.squares(residual) < self.squares(&adapted) { residual.to_vec() } else { adapted }
    }

    /// What is left of them per sample, above a noise variance; `None` where every sample was fitted.
    pub fn excess(&self, attained: &Attained) -> Option<f64> {
        (!self.samples.is_empty()).then(|| self.squares(&attained.residual) / self.samples.len() as f64 - 1.0)
    }

    /// Whether these samples, too, are for the richer hypothesis: it gains some of what it says that it changes of them, and
    /// some of what the fitted ones promise. That numbers stay nearer to what is believed of them promises nothing of others.
    pub fn shows(&self, rich: &Attained, simple: &Attained) -> bool {
        let share = self.samples.len() as f64 / self.bench.noise.count().max(1) as f64;
        let promised = share * (simple.misfit() - rich.misfit());
        let changes: Vec<f64> =
            simple.residual.iter().zip(&rich.residual).map(|(simple, rich)| simple - rich).collect();
        let changed = self.squares(&changes);
        let gained = self.squares(&simple.residual) - self.squares(&rich.residual);
        changed < SILENT * promised || gained > GAINED.max(OF_PROMISED * promised.min(changed))
    }

    /// Weighed sum of squares of a residual over them.
    pub fn squares(&self, residual: &[f64]) -> f64 {
        self.samples.iter().map(|k| self.bench.noise_of_all.weight[*k] * residual[*k].powi(2)).sum()
    }
}
