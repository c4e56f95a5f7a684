//! Every explanation against the others.

use super::{Cause, EQUAL_DEVIANCE, Hypothesis, Swings};
use crate::fit::Rejected;
use crate::gap::hypothesis::floor::noise_of;
use crate::gap::hypothesis::held_out::closed;
use crate::gap::hypothesis::score::Measure;
use crate::gap::verdict::decide::leaves_something;
use crate::identify::Experiment;
use crate::robot::bench::Held;
use rayon::prelude::*;

/// One cause among the others.
#[derive(Clone, Debug)]
pub struct Ranked {
    /// Which.
    pub cause: Cause,
    /// The nominal robot with it alone.
    pub alone: Hypothesis,
    /// Everything else but it; for the held joints: held the other way.
    pub without: Hypothesis,
    /// Score without it less score with it: how much it is needed.
    pub needed: f64,
}

/// All that was fitted about one joint.
#[derive(Clone, Debug)]
pub struct Compared {
    /// Logs that were fitted.
    pub files: Vec<String>,
    /// The nominal robot, only viscous friction searched.
    pub nominal: Hypothesis,
    /// Everything, with rigid and with giving neighbours.
    pub rigid: Hypothesis,
    /// The same with the others held by their controllers.
    pub controlled: Hypothesis,
    /// Score of `rigid` less that of `controlled`.
    pub gives_by: f64,
    /// Standard deviation of the readings' noise \[rad\].
    pub noise_rad: f64,
    /// Causes, the most needed first; empty where they were not asked for.
    pub ranked: Vec<Ranked>,
}

impl Compared {
    /// Fits everything with rigid and with giving neighbours, and, where `rank` says so, each cause alone and all but it.
    ///
    /// # Errors
    /// [`Rejected`] where no drop can be computed.
    pub fn of(swings: &Swings<'_>, rank: bool) -> Result<Self, Rejected> {
        let all_but =
            |cause: Cause, of: &[Cause]| -> Vec<Cause> { of.iter().copied().filter(|other| *other != cause).collect() };
        let numbers = all_but(Cause::HeldJoints, &Cause::ALL);
        let starts = swings.starts();
        let fit = |causes: &[Cause], starts: &[Vec<f64>]| Hypothesis::fitted(swings, causes, starts);
        let nominal = fit(&[], &starts)?;
        let near = [nominal.values.clone()];
        let (mut rigid, mut controlled) = (fit(&numbers, &near)?, fit(&Cause::ALL, &near)?);
        let noise_rad = noise_rad(swings, &[&nominal, &rigid, &controlled]);
        if leaves_something(rigid.rms_rad.min(controlled.rms_rad), noise_rad) {
            // Each may have missed what the other has found, and both what other friction leads to.
            let all = [&[rigid.values, controlled.values], starts.as_slice()].concat();
            (rigid, controlled) = (fit(&numbers, &all)?, fit(&Cause::ALL, &all)?);
        }
        let closest = if rigid.rms_rad < controlled.rms_rad { &rigid } else { &controlled };
        let measure = Measure::of(&swings.fit, &closest.left_rad);
        let gives_by = rigid.score(measure) - controlled.score(measure);
        let (best, other) = if gives_by < 0.0 { (&rigid, &controlled) } else { (&controlled, &rigid) };
        let one = |cause: Cause| {
            let alone = fit(&[cause], &near)?;
            let (without, needed) = match cause {
                Cause::HeldJoints => (other.clone(), gives_by),
                _ => {
                    let without = fit(&all_but(cause, &best.causes), &[best.values.clone(), starts[0].clone()])?;
                    let needed = without.score(measure) - best.score(measure);
                    (without, needed)
                }
            };
            Ok(Ranked { cause, alone, without, needed })
        };
        let causes: &[Cause] = if rank { &Cause::ALL } else { &[] };
        let mut ranked: Vec<Ranked> = causes.par_iter().copied().map(one).collect::<Result<_, Rejected>>()?;
        ranked.sort_by(|a, b| b.needed.total_cmp(&a.needed));
        Ok(Self { files: swings.files(), nominal, rigid, controlled, gives_by, noise_rad, ranked })
    }

    /// How the other joints were held; `None` where these swings do not tell.
    pub fn held(&self) -> Option<Held> {
        match self.gives_by {
            by if by > EQUAL_DEVIANCE => Some(Held::ByController),
            by if by < -EQUAL_DEVIANCE => Some(Held::Rigid),
            _ => None,
        }
    }

    /// The better of the two.
    pub fn best(&self) -> &Hypothesis {
        if self.gives_by < 0.0 { &self.rigid } else { &self.controlled }
    }

    /// Share of what rigid neighbours leave above the noise that giving ones close.
    pub fn share(&self) -> f64 {
        closed(self.rigid.rms_rad, self.controlled.rms_rad, self.noise_rad).map_or(0.0, |share| share.clamp(0.0, 1.0))
    }

    /// Whether the best leaves more than noise.
    pub fn lacks_something(&self) -> bool {
        leaves_something(self.best().rms_rad, self.noise_rad)
    }
}

/// Noise of the readings, by what is left of them \[rad\].
fn noise_rad(swings: &Swings<'_>, fits: &[&Hypothesis]) -> f64 {
    let logs: Vec<&Experiment> = swings.fit.iter().collect();
    let models: Vec<Vec<&[f64]>> = fits.iter().map(|fit| fit.left_rad.iter().map(Vec::as_slice).collect()).collect();
    noise_of(&logs, &models, logs.iter().map(|e| e.resolution_rad).fold(0.0, f64::max))
}
