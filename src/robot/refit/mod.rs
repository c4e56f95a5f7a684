//! Which explanation do the drops of a joint need? Fits of the whole robot, with and without each.
//!
//! A pendulum that was fitted with rigid neighbours has taken in what they do, so that its values say nothing of whether
//! they give. Here every combination is refitted in the whole robot ([`bench_drop`]): the other joints rigid or held by
//! their controllers, the encoder's zero, the lower leg's mass, load friction, friction that differs with the direction,
//! Coulomb friction; viscous friction is always searched. [`Refits::of`] compares them by what they leave: RMS, distance at
//! rest, and Schwarz's information criterion `n ln(sum of squares) + p ln n` (1978), where n counts correlated residuals
//! once. A start is the mean reading before the joint is let go.

mod problem;

use super::Model;
use super::bench::{BenchDrop, Held, bench_drop};
use super::simulate::{Method, SimulateError};
use crate::fit::{self, Block, Budget, Rejected, Residuals, correlation_length, uncertainty};
use crate::geometry::{Ers7Tables, LegJoint, LinkBody};
use crate::identify::{Case, Experiment, LegCase};
use crate::joint::EffectId;
use crate::log::ExtraMass;
use problem::{Problem, Searched};
use rayon::prelude::*;

/// What may be behind a gap between the drops and the nominal robot, and its rest in particular.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cause {
    /// The other joints are held by their controllers (Table B.2) and give.
    HeldJoints,
    /// The encoder's zero.
    Zero,
    /// Another mass of the lower leg.
    Mass,
    /// Friction that grows with gravity's torque.
    LoadFriction,
    /// Coulomb friction that differs with the direction.
    Direction,
    /// Another Coulomb friction.
    Coulomb,
}

impl Cause {
    /// All of them.
    pub const ALL: [Cause; 6] =
        [Cause::HeldJoints, Cause::Zero, Cause::Mass, Cause::LoadFriction, Cause::Direction, Cause::Coulomb];

    /// The name in JSON, and of its parameter.
    pub fn id(self) -> &'static str {
        match self {
            Cause::HeldJoints => "held_joints",
            Cause::Zero => "zero",
            Cause::Mass => "mass_lower_leg",
            Cause::LoadFriction => "load_friction",
            Cause::Direction => "asymmetric_friction",
            Cause::Coulomb => "coulomb",
        }
    }

    /// A few words.
    pub fn words(self) -> &'static str {
        match self {
            Cause::HeldJoints => "held joints give",
            Cause::Zero => "encoder's zero",
            Cause::Mass => "lower leg's mass",
            Cause::LoadFriction => "load friction",
            Cause::Direction => "friction by direction",
            Cause::Coulomb => "Coulomb friction",
        }
    }

    /// Unit of its parameter.
    pub fn unit(self) -> &'static str {
        match self {
            Cause::HeldJoints | Cause::LoadFriction => "",
            Cause::Zero => "rad",
            Cause::Mass => "kg",
            Cause::Direction | Cause::Coulomb => "N m",
        }
    }
}

/// Numbers of a drop that may be searched.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Values {
    mass_kg: f64,
    coulomb_nm: f64,
    viscous_nm_s_rad: f64,
    zero_rad: f64,
    mu_l: f64,
    delta_nm: f64,
    /// What [`Cause::HeldJoints`] would have; it has no number.
    none: f64,
}

impl Values {
    fn at(&mut self, searched: Searched) -> &mut f64 {
        match searched {
            Searched::Viscous => &mut self.viscous_nm_s_rad,
            Searched::Of(Cause::HeldJoints) => &mut self.none,
            Searched::Of(Cause::Zero) => &mut self.zero_rad,
            Searched::Of(Cause::Mass) => &mut self.mass_kg,
            Searched::Of(Cause::LoadFriction) => &mut self.mu_l,
            Searched::Of(Cause::Direction) => &mut self.delta_nm,
            Searched::Of(Cause::Coulomb) => &mut self.coulomb_nm,
        }
    }
}

/// Swings of one joint of a leg.
pub struct BenchLogs<'a> {
    leg: &'a LegCase,
    logs: Vec<BenchLog<'a>>,
    nominal: Values,
    limb: Model,
}

struct BenchLog<'a> {
    e: &'a Experiment,
    extra: Option<ExtraMass>,
    /// Samples that are compared and before: the swing, and a little rest.
    samples: usize,
    release_s: f64,
}

/// Within this of its last angle a joint rests \[rad\]; so many samples of rest are compared.
const RESTS_RAD: f64 = 0.015;
const REST_SAMPLES: usize = 60;
/// The angle of rest is the mean of so many samples.
const END_SAMPLES: usize = 40;
/// Steps \[s\]: within 0.01 mrad of steps a quarter as long, in the air.
const METHOD: Method = Method::Stiff { step_s: 4e-3 };
const BUDGET: Budget = Budget { evaluations: 45 };
/// From this difference of the information criterion on, one of two is better.
pub const DECIDED: f64 = 10.0;

impl<'a> BenchLogs<'a> {
    /// Free swings of a case that begin held, up to `of_each_load` with each extra mass (more say the same again); `None` where there are none or the case is
    /// of no leg in a known pose.
    ///
    /// # Errors
    /// [`SimulateError`] where the robot has no such leg.
    pub fn of(case: &'a Case, of_each_load: usize) -> Result<Option<Self>, SimulateError> {
        let Some(leg) = case.leg.as_ref().filter(|leg| leg.pose_known) else { return Ok(None) };
        let mut logs: Vec<BenchLog<'a>> = Vec::new();
        for item in &case.items {
            let Some(e) = item.experiment.as_ref().filter(|e| !e.is_driven()) else { continue };
            let Some([_, release_s]) = e.release_window_s else { continue };
            let mass = |extra: &Option<ExtraMass>| extra.map_or(0.0, |extra| extra.mass_kg);
            let same = |log: &&BenchLog<'_>| mass(&log.extra) == mass(&item.entry.extra);
            let end = e.measured_rad.len();
            if logs.iter().filter(same).count() >= of_each_load || end < 2 * END_SAMPLES {
                continue;
            }
            let rest_rad = mean(&e.measured_rad[end - END_SAMPLES..]);
            let last = e.measured_rad.iter().rposition(|q| (q - rest_rad).abs() > RESTS_RAD).unwrap_or(0);
            let samples = (last + REST_SAMPLES).min(end);
            logs.push(BenchLog { e, extra: item.entry.extra, samples, release_s });
        }
        if logs.is_empty() {
            return Ok(None);
        }
        let lower = leg.bare()?.body(LinkBody::LowerLeg).map_or(f64::NAN, |body| body.mass_kg);
        let (coulomb_nm, viscous_nm_s_rad) = Ers7Tables::embedded().friction.estimated.of(leg.joint);
        let nominal =
            Values { mass_kg: lower, coulomb_nm, viscous_nm_s_rad, zero_rad: 0.0, mu_l: 0.0, delta_nm: 0.0, none: 0.0 };
        let robot = Model::ers7();
        let limb = robot.limb(robot.joint(&crate::geometry::joint_name(leg.leg, leg.joint))?)?;
        Ok(Some(Self { leg, logs, nominal, limb }))
    }

    /// The joint that swings.
    pub fn joint(&self) -> LegJoint {
        self.leg.joint
    }

    /// Names of the logs that are fitted.
    pub fn files(&self) -> Vec<String> {
        self.logs.iter().map(|log| log.e.file.clone()).collect()
    }

    fn drop(&self, log: &BenchLog<'_>, held: Held, values: &Values) -> BenchDrop<'a> {
        let mut effects = Vec::new();
        if values.mu_l != 0.0 {
            effects.push((EffectId::LoadFriction, vec![values.mu_l]));
        }
        if values.delta_nm != 0.0 {
            effects.push((EffectId::AsymmetricFriction, vec![values.delta_nm]));
        }
        BenchDrop {
            leg: self.leg,
            extra: log.extra,
            masses_kg: vec![(LinkBody::LowerLeg, values.mass_kg)],
            coulomb_nm: values.coulomb_nm,
            viscous_nm_s_rad: values.viscous_nm_s_rad,
            stribeck: None,
            effects,
            others: Vec::new(),
            zero_rad: values.zero_rad,
            angle_rad: log.e.start.angle_rad,
            rate_rad_s: 0.0,
            release_s: log.release_s,
            held,
        }
    }

    fn readings(&self, log: usize, held: Held, values: &Values) -> Result<Vec<f64>, SimulateError> {
        let log = &self.logs[log];
        let dropped = bench_drop(&self.limb, &self.drop(log, held, values), &log.e.t_s[..log.samples], METHOD)?;
        Ok(dropped.reading_rad)
    }
}

/// The whole robot with some causes, fitted.
#[derive(Clone, Debug)]
pub struct Refit {
    /// What was let in; viscous friction was searched, too.
    pub causes: Vec<Cause>,
    /// Value and 95 % interval of every cause with a number; no interval where the swings leave it open.
    pub found: Vec<(Cause, f64, Option<[f64; 2]>)>,
    /// Viscous friction \[N m s/rad\].
    pub viscous: (f64, Option<[f64; 2]>),
    /// RMS over all logs \[rad\].
    pub rms_rad: f64,
    /// Model less measurement at rest, by log \[rad\].
    pub rest_rad: Vec<f64>,
    values: Values,
    residuals: Vec<Vec<f64>>,
}

impl Refit {
    /// RMS of the distances at rest \[rad\].
    pub fn rest_rms_rad(&self) -> f64 {
        (self.rest_rad.iter().map(|d| d * d).sum::<f64>() / self.rest_rad.len().max(1) as f64).sqrt()
    }

    /// How the other joints are held.
    pub fn held(&self) -> Held {
        if self.causes.contains(&Cause::HeldJoints) { Held::ByController } else { Held::Rigid }
    }

    fn squares(&self) -> f64 {
        self.residuals.iter().flatten().map(|r| r * r).sum()
    }

    /// The drop of any experiment of the case with what was found.
    ///
    /// # Errors
    /// As [`bench_drop`].
    pub fn readings(
        &self,
        logs: &BenchLogs<'_>,
        e: &Experiment,
        extra: Option<ExtraMass>,
    ) -> Result<Vec<f64>, SimulateError> {
        let release_s = e.release_window_s.map_or(0.0, |[_, to]| to);
        let log = BenchLog { e, extra, samples: e.t_s.len(), release_s };
        Ok(bench_drop(&logs.limb, &logs.drop(&log, self.held(), &self.values), &e.t_s, METHOD)?.reading_rad)
    }
}

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
        let with = |cause: Cause, others: &[Cause]| [&[cause], others].concat();
        let nominal = refit(logs, &[], None)?;
        let rigid = refit(logs, &numbers, None)?;
        let controlled = refit(logs, &with(Cause::HeldJoints, &numbers), None)?;
        let counted = counted(if rigid.squares() < controlled.squares() { &rigid } else { &controlled });
        let gives_by = information(&rigid, counted) - information(&controlled, counted);
        let (best, other) = if gives_by < 0.0 { (&rigid, &controlled) } else { (&controlled, &rigid) };
        let noise_rad = noise(&best.residuals);
        let one = |cause: Cause| {
            let alone = refit(logs, &[cause], None)?;
            let (without, needed) = if cause == Cause::HeldJoints {
                (other.clone(), gives_by)
            } else {
                let others: Vec<Cause> = best.causes.iter().copied().filter(|c| *c != cause).collect();
                let without = refit(logs, &others, Some(&best.values))?;
                let needed = information(&without, counted) - information(best, counted);
                (without, needed)
            };
            Ok(Ranked { cause, alone, without, needed })
        };
        let causes: &[Cause] = if rank { &Cause::ALL } else { &[] };
        let mut ranked: Vec<Ranked> = causes.iter().copied().map(one).collect::<Result<_, Rejected>>()?;
        ranked.sort_by(|a, b| b.needed.total_cmp(&a.needed));
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

/// Residuals that count, correlated ones together.
fn counted(refit: &Refit) -> f64 {
    refit.residuals.iter().map(|r| r.len() as f64 / correlation_length(r)).sum()
}

fn information(refit: &Refit, counted: f64) -> f64 {
    let searched = 1 + refit.found.len();
    counted * refit.squares().max(f64::MIN_POSITIVE).ln() + searched as f64 * counted.ln()
}

/// Of white noise second differences have six times its variance, of a smooth misfit hardly any.
fn noise(residuals: &[Vec<f64>]) -> f64 {
    let squares: Vec<f64> =
        residuals.iter().flat_map(|r| r.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).powi(2))).collect();
    (squares.iter().sum::<f64>() / (6 * squares.len().max(1)) as f64).sqrt()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Fits the whole robot with some causes; also from `near`, where it is given.
fn refit(logs: &BenchLogs<'_>, causes: &[Cause], near: Option<&Values>) -> Result<Refit, Rejected> {
    let problem = Problem::new(logs, causes);
    let starts = std::iter::once(problem.start()).chain(near.map(|values| problem.coordinates_of(values)));
    let starts: Vec<Vec<f64>> = starts.collect();
    let solutions: Vec<fit::Solution> =
        starts.par_iter().map(|start| fit::solve(&problem, start, fit::Method::Lm, BUDGET)).collect();
    let best = solutions.into_iter().min_by(|a, b| a.criterion.total_cmp(&b.criterion));
    let x = best.map(|solution| solution.x).unwrap_or_default();
    let blocks: Vec<Block> = problem.linearise(&x)?;
    let spread = uncertainty(&problem, &blocks).ok();
    let values = problem.values(&x);
    let estimate = |searched: Searched| {
        let i = problem.place(searched)?;
        let half = spread.as_ref().map(|u| u.half_width_robust(i)).filter(|half| half.is_finite());
        Some((x[i], half.map(|half| [x[i] - half, x[i] + half])))
    };
    let found = causes.iter().filter_map(|cause| estimate(Searched::Of(*cause)).map(|(v, i)| (*cause, v, i))).collect();
    let viscous = estimate(Searched::Viscous).unwrap_or((values.viscous_nm_s_rad, None));
    let residuals: Vec<Vec<f64>> = blocks.into_iter().map(|block| block.residual).collect();
    let (squares, count) = residuals.iter().flatten().fold((0.0, 0usize), |(sum, count), r| (sum + r * r, count + 1));
    Ok(Refit {
        causes: causes.to_vec(),
        found,
        viscous,
        rms_rad: (squares / count.max(1) as f64).sqrt(),
        rest_rad: residuals.iter().map(|r| mean(&r[r.len().saturating_sub(END_SAMPLES)..])).collect(),
        values,
        residuals,
    })
}
