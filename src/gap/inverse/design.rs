//! A joint's torque as columns: numbers, effects and curves, each what it adds to the torque that a motion asks for.

use super::numbers::{Asked, Believed, Values, Which};
use super::signals::{Grid, Signals};
use super::system::{Block, Unknown};
use crate::joint::{EffectId, LawVariable};
use crate::number::math;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

/// Seconds of a block.
const BLOCK_S: f64 = 1.0;
/// Parts of a log that is the only one.
const PARTS: usize = 4;
/// Knots of a curve.
const KNOTS: usize = 9;
/// Periods of a ripple that the motion has to show, times a turn that are tried, and points by which it is told.
const FEWEST_PERIODS: f64 = 1.5;
const MOST_PER_TURN: u32 = 24;
const POINTS_PER_PERIOD: f64 = 12.0;
const MOST_KNOTS: usize = 200;
/// Standard deviation of a knot before a log is seen, as a share of the drive's torque.
const KNOT: f64 = 0.2;
/// Speeds at which static friction may have fallen, as shares of the fastest.
const STRIBECK: [f64; 5] = [0.02, 0.05, 0.1, 0.2, 0.4];
/// Where a stop may begin, as shares of the range.
const STOPS: [f64; 3] = [0.7, 0.8, 0.9];
/// Half the distance of two of them.
const BETWEEN_STOPS: f64 = 0.05;
/// What any engineer believes of an effect's size before a log is seen: encoders are not wrong by halves, and readings do
/// not wait for tenths of seconds.
fn plausible(effect: EffectId) -> Option<f64> {
    match effect {
        EffectId::SensorGain => Some(0.05),
        EffectId::AngleOffset => Some(0.15),
        EffectId::SensorDelay => Some(0.05),
        _ => None,
    }
}

/// One joint, its logs and beliefs.
#[derive(Clone, Debug)]
pub(super) struct JointData {
    pub name: String,
    pub believed: Believed,
    /// One for each log of the study; `None` where the log has no torque of this joint.
    pub logs: Vec<Option<Signals>>,
}

/// A log of the study.
#[derive(Clone, Debug)]
pub(super) struct LogData {
    pub file: String,
    pub is_fit: bool,
    pub grid: Grid,
    /// Samples that count for one.
    pub tied: f64,
}

/// An effect with a shape that is given: what it adds is linear.
#[derive(Clone, Debug)]
pub(super) struct Family {
    pub effect: EffectId,
    /// What of it is no unknown: a speed, an angle, a side.
    pub shape: Vec<f64>,
    /// Its columns.
    pub columns: Vec<usize>,
}

/// A curve over a variable.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    pub variable: LawVariable,
    /// Where it is told.
    pub knots: Vec<f64>,
    /// Cosine and sine of so many times the angle; else straight lines between the knots.
    pub per_turn: Option<u32>,
    pub columns: Vec<usize>,
}

impl Curve {
    /// Its value at a knot for values of its columns.
    pub fn at_knot(&self, knot: usize, x: &[f64]) -> f64 {
        match self.per_turn {
            Some(times) => {
                let phase = f64::from(times) * self.knots[knot];
                x[0] * math::cos(phase) + x[1] * math::sin(phase)
            }
            None => x[knot],
        }
    }
}

/// Samples of one log that are compared.
#[derive(Clone, Debug, Default)]
pub(super) struct Compared {
    pub t_s: Vec<f64>,
    /// Logged \[N m\].
    pub measured_nm: Vec<f64>,
    /// As believed \[N m\].
    pub believed_nm: Vec<f64>,
    /// One for each unknown.
    pub columns: Vec<Vec<f64>>,
}

/// All columns of a joint.
#[derive(Clone, Debug)]
pub(super) struct Design {
    /// The first of them, those that may move.
    pub numbers: Vec<Which>,
    pub families: Vec<Family>,
    pub curves: Vec<Curve>,
    pub unknowns: Vec<Unknown>,
    /// One for each log of the study; empty where it shows nothing of the joint.
    pub logs: Vec<Compared>,
    /// Where friction holds the joint, by log and sample of the grid.
    pub is_held: Vec<Vec<bool>>,
}

/// Limits of what the logs show.
struct Reach {
    angle_rad: [f64; 2],
    rate_rad_s: f64,
    load_nm: [f64; 2],
    duration_s: f64,
    torque_nm: f64,
    farthest_rad: f64,
}

/// What a column is, sample by sample of the grid.
type Term<'a> = Box<dyn Fn(&Signals, &Asked, &Grid, usize) -> f64 + 'a>;

impl JointData {
    /// What nobody knows better over some logs \[N m\].
    pub fn noise_nm(&self, is_asked: impl Fn(usize) -> bool) -> f64 {
        let shown = self.logs.iter().enumerate().filter(|(log, _)| is_asked(*log));
        let noise: Vec<f64> = shown.filter_map(|(_, signals)| Some(signals.as_ref()?.noise_nm)).collect();
        (noise.iter().map(|noise| noise * noise).sum::<f64>() / noise.len().max(1) as f64).sqrt()
    }
}

impl Design {
    /// `now` are values near which the torque is linear.
    pub fn new(joint: &JointData, logs: &[LogData], now: &Values, allows: &dyn Fn(EffectId) -> bool) -> Self {
        let believed = &joint.believed;
        let reach = reach(joint, logs);
        let numbers: Vec<Which> = Which::ALL.into_iter().filter(|which| believed.is_free(*which)).collect();
        let mut terms: Vec<(Term<'_>, Option<Unknown>, [f64; 2])> = Vec::new();
        for which in &numbers {
            terms.push((number(*which, believed), Some(believed.unknown(*which)), [0.0; 2]));
        }
        let mut families = Vec::new();
        for (effect, shape, parts) in effects(&reach, now) {
            // To first order, which many turns are not.
            let is_linear = effect != EffectId::SensorGain || reach.farthest_rad < PI;
            if allows(effect) && is_linear {
                let columns = (terms.len()..terms.len() + parts.len()).collect();
                families.push(Family { effect, shape, columns });
                terms.extend(parts.into_iter().map(|(term, bounds)| (term, None, bounds)));
            }
        }
        let mut curves = Vec::new();
        for (variable, range) in [
            (LawVariable::Angle, reach.angle_rad),
            (LawVariable::Speed, [-reach.rate_rad_s, reach.rate_rad_s]),
            (LawVariable::Load, reach.load_nm),
            (LawVariable::Time, [0.0, reach.duration_s]),
        ] {
            if range[1] - range[0] > 1e-9 {
                let step = (range[1] - range[0]) / (KNOTS - 1) as f64;
                let knots: Vec<f64> = (0..KNOTS).map(|k| range[0] + step * k as f64).collect();
                let columns = (terms.len()..terms.len() + KNOTS).collect();
                let free = [f64::NEG_INFINITY, f64::INFINITY];
                terms.extend((0..KNOTS).map(|k| (hat(variable, knots.clone(), k), None, free)));
                curves.push(Curve { variable, knots, per_turn: None, columns });
            }
        }
        // Torque ripple: poles, slots and teeth repeat so many times a turn.
        let [low, high] = reach.angle_rad;
        let fewest = (FEWEST_PERIODS * 2.0 * PI / (high - low)).ceil().max(2.0);
        for times in 2..=MOST_PER_TURN {
            let k = f64::from(times);
            if k < fewest {
                continue;
            }
            let columns = vec![terms.len(), terms.len() + 1];
            let free = [f64::NEG_INFINITY, f64::INFINITY];
            terms.push((Box::new(move |s, _, _, i| math::cos(k * s.angle_rad[i])), None, free));
            terms.push((Box::new(move |s, _, _, i| math::sin(k * s.angle_rad[i])), None, free));
            let count = ((POINTS_PER_PERIOD * k * (high - low) / (2.0 * PI)).ceil() as usize).clamp(KNOTS, MOST_KNOTS);
            let knots = (0..count).map(|i| low + (high - low) * i as f64 / (count - 1) as f64).collect();
            curves.push(Curve { variable: LawVariable::Angle, knots, per_turn: Some(times), columns });
        }
        let late = LateColumns::of(&families);
        let of_log = |(log, signals): (&LogData, &Option<Signals>)| match signals {
            Some(signals) => compared(log, signals, believed, now, &terms, &late),
            None => Default::default(),
        };
        let (logs, is_held): (Vec<Compared>, Vec<Vec<bool>>) = logs.iter().zip(&joint.logs).map(of_log).unzip();
        let unknown = |(i, (_, known, bounds)): (usize, &(Term<'_>, Option<Unknown>, [f64; 2]))| {
            known.unwrap_or_else(|| {
                let is_knot = curves.iter().any(|curve: &Curve| curve.columns.contains(&i));
                if is_knot {
                    return Unknown { sd: KNOT * reach.torque_nm.max(f64::MIN_POSITIVE), bounds: *bounds };
                }
                let family = families.iter().find(|family| family.columns.contains(&i));
                let believed = family.and_then(|family| plausible(family.effect));
                let sd = believed.unwrap_or_else(|| reach.torque_nm / rms_of(&logs, i));
                Unknown { sd: if sd.is_finite() { sd } else { 1e-12 }, bounds: *bounds }
            })
        };
        let unknowns = terms.iter().enumerate().map(unknown).collect();
        Self { numbers, families, curves, unknowns, logs, is_held }
    }

    /// An unknown where others than the joint's own are asked: friction is known little, and says nothing of bodies.
    pub fn loosened(&self, unknown: usize) -> Unknown {
        const LOOSER: f64 = 3.0;
        let is_friction = matches!(self.numbers.get(unknown), Some(Which::Coulomb | Which::Viscous));
        let own = self.unknowns[unknown];
        Unknown { sd: if is_friction { LOOSER * own.sd } else { own.sd }, ..own }
    }

    /// Indices of the numbers.
    pub fn baseline(&self) -> Vec<usize> {
        (0..self.numbers.len()).collect()
    }

    /// Blocks of all logs for a problem whose unknowns are some of this joint's, behind `offset`, and others: column
    /// number `i` of log `k` by `others(i, k)`. `sd_nm` is that of a sample.
    pub fn blocks<'a>(
        &'a self,
        logs: &[LogData],
        (own, offset, unknowns): (&[usize], usize, usize),
        others: &dyn Fn(usize, usize) -> Option<&'a [f64]>,
        sd_nm: f64,
    ) -> Vec<Block> {
        let mut blocks = Vec::new();
        for (at, (log, compared)) in logs.iter().zip(&self.logs).enumerate() {
            for (from, to, part) in pieces(&compared.t_s) {
                let columns = DMatrix::from_fn(to - from, unknowns, |k, i| {
                    let own = i.checked_sub(offset).and_then(|i| own.get(i)).map(|i| &*compared.columns[*i]);
                    own.or_else(|| others(i, at)).map_or(0.0, |column| column[from + k])
                });
                let target =
                    DVector::from_fn(to - from, |k, _| compared.measured_nm[from + k] - compared.believed_nm[from + k]);
                let sd = sd_nm * log.tied.sqrt();
                blocks.push(Block::new([at, part], log.is_fit, &columns, &target, sd));
            }
        }
        blocks
    }

    /// What unknowns leave of a log \[N m\].
    pub fn left_nm(&self, log: usize, x: &[f64]) -> Vec<f64> {
        let compared = &self.logs[log];
        let predicted = self.predicted_nm(log, x);
        compared.measured_nm.iter().zip(predicted).map(|(measured, predicted)| measured - predicted).collect()
    }

    /// The torque that unknowns predict for a log \[N m\].
    pub fn predicted_nm(&self, log: usize, x: &[f64]) -> Vec<f64> {
        let compared = &self.logs[log];
        let mut predicted = compared.believed_nm.clone();
        for (column, x) in compared.columns.iter().zip(x).filter(|(_, x)| **x != 0.0) {
            predicted.iter_mut().zip(column).for_each(|(sum, value)| *sum += x * value);
        }
        predicted
    }
}

/// Stretches of about a second, and the part of the log that each is in.
fn pieces(t_s: &[f64]) -> Vec<(usize, usize, usize)> {
    let (Some(first), Some(last)) = (t_s.first(), t_s.last()) else { return Vec::new() };
    let count = ((last - first) / BLOCK_S).round().max(1.0) as usize;
    let count = count.max(PARTS).min(t_s.len());
    let edge = |k: usize| k * t_s.len() / count;
    (0..count).map(|k| (edge(k), edge(k + 1), k * PARTS / count)).collect()
}

/// What a number adds for each unit that it is more than believed.
fn number<'a>(which: Which, believed: &'a Believed) -> Term<'a> {
    let value = believed.values[which as usize];
    match which {
        Which::Inertia => Box::new(move |s, _, _, k| s.inertial_nm[k] / value),
        Which::Moment => Box::new(move |s, _, _, k| s.gravity_nm[k] / value),
        Which::Armature => Box::new(|s, _, _, k| s.acceleration_rad_s2[k]),
        Which::Coulomb => Box::new(|_, a, _, k| a.used[k]),
        Which::Viscous => Box::new(|s, _, _, k| s.rate_rad_s[k]),
        // Before the low pass, as the others: what all numbers times one factor leave has to be nothing.
        Which::Gain => Box::new(|_, a, _, k| -a.raw_nm[k]),
    }
}

/// An effect, its shape, and its columns with their bounds.
type Parts<'a> = (EffectId, Vec<f64>, Vec<(Term<'a>, [f64; 2])>);

const FREE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
const MORE: [f64; 2] = [0.0, f64::INFINITY];

/// Every effect that changes the torque along a measured motion, in the shapes that are tried.
fn effects<'a>(reach: &Reach, now: &'a Values) -> Vec<Parts<'a>> {
    let one = |effect, term: Term<'a>, bounds| (effect, Vec::new(), vec![(term, bounds)]);
    let mut all: Vec<Parts<'a>> = vec![
        one(EffectId::LoadFriction, Box::new(|s, a, _, k| a.used[k] * s.gravity_nm[k].abs()), MORE),
        // The torque that the motion asks for, not the logged one: that would explain itself.
        one(EffectId::GearFriction, Box::new(|_, a, _, k| a.used[k] * a.all_nm[k].abs()), MORE),
        one(EffectId::QuadraticDrag, Box::new(|s, _, _, k| s.rate_rad_s[k] * s.rate_rad_s[k].abs()), MORE),
        one(EffectId::AsymmetricFriction, Box::new(|_, _, _, _| 1.0), FREE),
        (
            EffectId::PositionFriction,
            Vec::new(),
            vec![
                (Box::new(|s, a, _, k| a.used[k] * math::cos(s.angle_rad[k])), FREE),
                (Box::new(|s, a, _, k| a.used[k] * math::sin(s.angle_rad[k])), FREE),
            ],
        ),
        one(
            EffectId::FrictionDrift,
            Box::new(move |s, a, g, k| {
                let friction_nm =
                    now[Which::Coulomb as usize] * a.used[k] + now[Which::Viscous as usize] * s.rate_rad_s[k];
                (g.t_s[k] - g.t_s[0]) * friction_nm
            }),
            FREE,
        ),
        (
            EffectId::JointSpring,
            Vec::new(),
            vec![(Box::new(|s, _, _, k| s.angle_rad[k]), MORE), (Box::new(|_, _, _, _| 1.0), FREE)],
        ),
        one(EffectId::AngleOffset, Box::new(|s, _, _, k| s.slope_nm_rad[k]), FREE),
        one(
            EffectId::SensorGain,
            Box::new(move |s, _, _, k| {
                let [armature, viscous] = [now[Which::Armature as usize], now[Which::Viscous as usize]];
                -(s.inertial_nm[k]
                    + s.slope_nm_rad[k] * s.angle_rad[k]
                    + armature * s.acceleration_rad_s2[k]
                    + viscous * s.rate_rad_s[k])
            }),
            FREE,
        ),
        one(EffectId::SensorDelay, Box::new(|_, a, g, k| g.slope(&a.all_nm, k)), MORE),
        one(EffectId::DeadBand, Box::new(|_, a, _, k| (a.all_nm[k] / 1e-3).clamp(-1.0, 1.0)), MORE),
    ];
    for share in STRIBECK {
        let v_st = share * reach.rate_rad_s;
        let term: Term<'a> = Box::new(move |s, a, _, k| a.used[k] * math::exp(-(s.rate_rad_s[k] / v_st).powi(2)));
        all.push((EffectId::Stribeck, vec![v_st], vec![(term, MORE)]));
    }
    let [low, high] = reach.angle_rad;
    for share in STOPS {
        for side in [-1.0, 1.0] {
            let at = if side > 0.0 { low + share * (high - low) } else { high - share * (high - low) };
            let term: Term<'a> = Box::new(move |s, _, _, k| side * (side * (s.angle_rad[k] - at)).max(0.0));
            all.push((EffectId::EndStop, vec![at, side, BETWEEN_STOPS * (high - low)], vec![(term, MORE)]));
        }
    }
    all
}

/// Knot `k` of a curve of straight lines, level beyond its ends.
fn hat<'a>(variable: LawVariable, knots: Vec<f64>, k: usize) -> Term<'a> {
    Box::new(move |s, _, g, i| {
        let x = match variable {
            LawVariable::Angle => s.angle_rad[i],
            LawVariable::Speed => s.rate_rad_s[i],
            LawVariable::Load => s.gravity_nm[i],
            _ => g.t_s[i] - g.t_s[0],
        };
        let step = knots[1] - knots[0];
        let x = x.clamp(knots[0], knots[knots.len() - 1]);
        (1.0 - (x - knots[k]).abs() / step).max(0.0)
    })
}

/// Columns that were smoothed before they were made: they pass the filter no second time.
struct LateColumns {
    columns: Vec<usize>,
}

impl LateColumns {
    fn of(families: &[Family]) -> Self {
        let late = families.iter().filter(|family| family.effect == EffectId::SensorDelay);
        Self { columns: late.flat_map(|family| family.columns.clone()).collect() }
    }
}

fn compared(
    log: &LogData,
    signals: &Signals,
    believed: &Believed,
    now: &Values,
    terms: &[(Term<'_>, Option<Unknown>, [f64; 2])],
    late: &LateColumns,
) -> (Compared, Vec<bool>) {
    let grid = &log.grid;
    let asked_now = Asked::new(signals, grid, now, believed);
    // As believed, with friction used up where it is now: what an unknown adds is told from there.
    let values = &believed.values;
    let n = signals.angle_rad.len();
    let from_belief = |k: usize| {
        if asked_now.is_held[k] {
            return signals.torque_nm.as_ref().map_or(0.0, |torque| torque[k]);
        }
        signals.inertial_nm[k]
            + signals.gravity_nm[k]
            + signals.spring_nm[k]
            + values[Which::Armature as usize] * signals.acceleration_rad_s2[k]
            + values[Which::Coulomb as usize] * asked_now.used[k]
            + values[Which::Viscous as usize] * signals.rate_rad_s[k]
    };
    let column = |(i, (term, _, _)): (usize, &(Term<'_>, Option<Unknown>, [f64; 2]))| {
        // What friction holds anyway is nobody's to tell.
        let raw: Vec<f64> =
            (0..n).map(|k| if asked_now.is_held[k] { 0.0 } else { term(signals, &asked_now, grid, k) }).collect();
        let is_smooth = late.columns.contains(&i);
        if is_smooth { grid.kept(&raw) } else { grid.passed(&raw) }
    };
    let compared = Compared {
        t_s: grid.kept(&grid.t_s),
        measured_nm: grid.kept(signals.torque_nm.as_deref().unwrap_or_default()),
        believed_nm: grid.passed(&(0..n).map(from_belief).collect::<Vec<_>>()),
        columns: terms.iter().enumerate().map(column).collect(),
    };
    (compared, asked_now.is_held)
}

fn reach(joint: &JointData, logs: &[LogData]) -> Reach {
    let all = || joint.logs.iter().zip(logs).filter_map(|(signals, log)| Some((signals.as_ref()?, log)));
    let spread = |of: fn(&Signals) -> &[f64]| {
        let mut values: Vec<f64> = all().flat_map(|(signals, _)| of(signals).iter().copied()).collect();
        values.sort_by(f64::total_cmp);
        let at = |share: f64| values.get((share * values.len() as f64) as usize).copied().unwrap_or(0.0);
        [at(0.01), at(0.99)]
    };
    let rates = spread(|s| &s.rate_rad_s);
    let torques = || all().flat_map(|(signals, _)| signals.torque_nm.iter().flatten());
    let count = torques().count().max(1) as f64;
    let duration = |log: &LogData| log.grid.t_s[log.grid.t_s.len() - 1] - log.grid.t_s[0];
    Reach {
        angle_rad: spread(|s| &s.angle_rad),
        rate_rad_s: rates[1].max(-rates[0]).max(1e-9),
        load_nm: spread(|s| &s.gravity_nm),
        duration_s: all().map(|(_, log)| duration(log)).fold(0.0, f64::max),
        farthest_rad: all().flat_map(|(s, _)| &s.angle_rad).fold(0.0, |most, angle| most.max(angle.abs())),
        torque_nm: (torques().map(|torque| torque * torque).sum::<f64>() / count).sqrt(),
    }
}

/// Root of the mean square of a column over all logs.
fn rms_of(logs: &[Compared], column: usize) -> f64 {
    let values = || logs.iter().filter_map(|log| log.columns.get(column)).flatten();
    (values().map(|value| value * value).sum::<f64>() / values().count().max(1) as f64).sqrt()
}
