//! Every explanation against the others.

use super::measure::noise;
use super::{BenchLogs, Cause, Refit};
use crate::fit::Rejected;
use rayon::prelude::*;

/// From this difference of the information criterion on, one of two is better.
pub const DECIDED: f64 = 10.0;

/// Whether the other joints give.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Held by their controllers they explain the drops better.
    Give,
    /// Rigid ones do.
    Rigid,
    /// These drops do not tell.
    CannotTell,
}

/// One cause among the others.
#[derive(Clone, Debug)]
pub struct Ranked {
    /// Which.
    pub cause: Cause,
    /// The nominal robot with it alone.
    pub alone: Refit,
    /// Everything else but it; for the held joints: held the other way.
    pub without: Refit,
    /// Information criterion without it less that with it: how much it is needed.
    pub needed: f64,
}

/// All that was fitted about one joint.
#[derive(Clone, Debug)]
pub struct Refits {
    /// Logs that were fitted.
    pub files: Vec<String>,
    /// The nominal robot, only viscous friction searched.
    pub nominal: Refit,
    /// Everything, with rigid and with giving neighbours.
    pub rigid: Refit,
    /// The same with the others held by their controllers.
    pub controlled: Refit,
    /// Information criterion of `rigid` less that of `controlled`.
    pub gives_by: f64,
    /// Standard deviation of the readings' noise, from the residuals' roughness \[rad\].
    pub noise_rad: f64,
    /// Causes, the most needed first; empty where they were not asked for.
    pub ranked: Vec<Ranked>,
}

impl Refits {
    /// Fits everything with rigid and with giving neighbours, and, where `rank` says so, each cause alone and all but it.
    ///
    /// # Errors
    /// [`Rejected`] where no drop can be computed.
    pub fn of(logs: &BenchLogs<'_>, rank: bool) -> Result<Self, Rejected> {
        let numbers: Vec<Cause> = Cause::ALL.into_iter().filter(|cause| *cause != Cause::HeldJoints).collect();
        let everything = [&[Cause::HeldJoints], numbers.as_slice()].concat();
        let fit = |causes: &[Cause]| Refit::of(logs, causes);
        let (nominal, both) = rayon::join(|| fit(&[]), || rayon::join(|| fit(&numbers), || fit(&everything)));
        let (nominal, rigid, controlled) = (nominal?, both.0?, both.1?);
        let counted = (if rigid.rms_rad < controlled.rms_rad { &rigid } else { &controlled }).counted();
        let gives_by = rigid.information(counted) - controlled.information(counted);
        let (best, other) = if gives_by < 0.0 { (&rigid, &controlled) } else { (&controlled, &rigid) };
        let one = |cause: Cause| {
            let alone = Refit::of(logs, &[cause])?;
            let (without, needed) = match cause {
                Cause::HeldJoints => (other.clone(), gives_by),
                _ => all_but(logs, best, cause, counted)?,
            };
            Ok(Ranked { cause, alone, without, needed })
        };
        let causes: &[Cause] = if rank { &Cause::ALL } else { &[] };
        let mut ranked: Vec<Ranked> = causes.par_iter().copied().map(one).collect::<Result<_, Rejected>>()?;
        ranked.sort_by(|a, b| b.needed.total_cmp(&a.needed));
        let noise_rad = noise(best.residuals());
        Ok(Self { files: logs.files(), nominal, rigid, controlled, gives_by, noise_rad, ranked })
    }

    /// Whether the other joints give.
    pub fn verdict(&self) -> Verdict {
        match self.gives_by {
            by if by > DECIDED => Verdict::Give,
            by if by < -DECIDED => Verdict::Rigid,
            _ => Verdict::CannotTell,
        }
    }

    /// The better of the two.
    pub fn best(&self) -> &Refit {
        if self.gives_by < 0.0 { &self.rigid } else { &self.controlled }
    }

    /// Share of the mean square that rigid neighbours leave above the noise which giving ones explain.
    pub fn share(&self) -> f64 {
        let above = |refit: &Refit| (refit.rms_rad.powi(2) - self.noise_rad.powi(2)).max(0.0);
        let (rigid, controlled) = (above(&self.rigid), above(&self.controlled));
        if rigid > 0.0 { (1.0 - controlled / rigid).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Whether the best leaves more than noise.
    pub fn lacks_something(&self) -> bool {
        self.best().rms_rad > STRUCTURED * self.noise_rad
    }
}

/// An RMS this many times the noise is more than noise.
const STRUCTURED: f64 = 1.3;

/// All but one cause, and how much that is needed.
///
/// The search begins beside the fit with all of them. Nothing can leave less than their minimum, so where that first
/// search already comes within what decides, no other can show the cause to be needed; else one from the nominal robot
/// tries, too.
fn all_but(logs: &BenchLogs<'_>, best: &Refit, cause: Cause, counted: f64) -> Result<(Refit, f64), Rejected> {
    let needed = |without: &Refit| without.information(counted) - best.information(counted);
    let mut without = best.without(logs, cause)?;
    if needed(&without) >= DECIDED {
        let far = Refit::of(logs, &without.causes)?;
        if far.rms_rad < without.rms_rad {
            without = far;
        }
    }
    let needed = needed(&without);
    Ok((without, needed))
}
