//! Sizes for mechanisms that are there at once, so that each of them shows given the others.

use super::cause::Cause;
use super::dice::Dice;
use super::mechanism::servo::Part;
use super::sim::{Machine, Trace};
use super::size::{Yardstick, within};
use super::truth::{TrueMechanism, TrueNumber};
use crate::number::math;

/// How much each mechanism is to show, as multiples of the noise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// Sizes that are sought.
    wanted: [f64; 2],
    /// Natural sizes that are taken.
    allowed: [f64; 2],
    /// Least that is left after recalibration, and after the others have been adapted.
    left: f64,
    /// What is too small may stay, and is not asked for.
    some: bool,
}

impl Limits {
    pub(super) fn of(cause: &Cause) -> Self {
        match cause {
            Cause::Outside(_) => Self { wanted: [5.0, 60.0], allowed: [4.0, 300.0], left: 2.0, some: false },
            Cause::Effects(effects) if effects.len() > 1 => {
                Self { wanted: [4.0, 25.0], allowed: [3.0, 30.0], left: 1.0, some: false }
            }
            Cause::Servo => Self { wanted: [4.0, 25.0], allowed: [3.0, 60.0], left: 1.0, some: true },
            _ => Self { wanted: [1.5, 40.0], allowed: [1.3, 300.0], left: 0.4, some: false },
        }
    }
}

/// Rounds in which sizes are brought to where they show as they should.
const ROUNDS: usize = 6;

/// Mechanisms in one joint.
pub(super) struct Together {
    pub machine: Machine,
    /// Its motion, in steps good enough to judge by.
    pub whole: Vec<Trace>,
    pub mechanisms: Vec<TrueMechanism>,
}

impl Together {
    /// Draws sizes; `None` where one does not show as it should, unless it is `forced` or may be small.
    pub(super) fn new(
        parts: &[Part],
        limits: Limits,
        yard: &Yardstick<'_>,
        plain: &Machine,
        forced: bool,
        dice: &mut Dice,
    ) -> Option<Self> {
        let mut sizes = Vec::with_capacity(parts.len());
        for part in parts {
            let mechanism = &part.mechanism;
            let size = yard.size(mechanism, plain, limits.wanted, limits.allowed, dice);
            let [low, high] = mechanism.range;
            // a part that shows nothing alone may still be there
            sizes.push(size.or((forced || limits.some).then_some((low * high).sqrt()))?);
        }
        let with = |sizes: &[f64], skip: Option<usize>| {
            let mut machine = plain.clone();
            let mut numbers: Vec<Vec<TrueNumber>> = Vec::with_capacity(parts.len());
            for (i, (part, size)) in parts.iter().zip(sizes).enumerate() {
                numbers.push(if skip == Some(i) { vec![] } else { part.mechanism.install(*size, &mut machine) });
            }
            (machine, numbers)
        };
        let (mut machine, mut numbers) = with(&sizes, None);
        let mut whole = yard.move_all(&machine);
        let without = |sizes: &[f64], i: usize| {
            if parts.len() == 1 { yard.plain.clone() } else { yard.move_all(&with(sizes, Some(i)).0) }
        };
        let mut rests: Vec<Vec<Trace>> = (0..parts.len()).map(|i| without(&sizes, i)).collect();
        if parts.len() > 1 {
            for _ in 0..ROUNDS {
                let mut moved = false;
                for (i, part) in parts.iter().enumerate() {
                    let ratio = yard.ratio(&whole, &rests[i]);
                    if within(ratio, limits.allowed) {
                        continue;
                    }
                    // somewhere inside, so that the next part's change does not push it out again
                    let target = (limits.wanted[0] * limits.wanted[1]).sqrt();
                    let factor = math::powf(target / ratio.max(1e-3), 0.7).clamp(0.3, 3.0);
                    let size = (sizes[i] * factor).clamp(part.mechanism.range[0], part.mechanism.range[1]);
                    moved |= size != sizes[i];
                    sizes[i] = size;
                }
                if !moved {
                    break;
                }
                (machine, numbers) = with(&sizes, None);
                whole = yard.move_all(&machine);
                rests = (0..parts.len()).map(|i| without(&sizes, i)).collect();
            }
        }
        // what one does must not be what the others would do at other sizes
        let shapes: Vec<Vec<Vec<Trace>>> = if parts.len() > 1 {
            parts.iter().map(|part| yard.shapes(&part.mechanism, plain).into()).collect()
        } else {
            vec![vec![]]
        };
        let mut mechanisms = Vec::with_capacity(parts.len());
        for (i, (part, parameters)) in parts.iter().zip(numbers).enumerate() {
            let others: Vec<Vec<Trace>> =
                shapes.iter().enumerate().filter(|(j, _)| *j != i).flat_map(|(_, shapes)| shapes.clone()).collect();
            let ratio = yard.ratio(&whole, &rests[i]);
            let left = yard.left_beside(&whole, &rests[i], &others);
            let shows = ratio >= limits.allowed[0] && left >= limits.left;
            let suits = (shows || limits.some) && ratio <= limits.allowed[1];
            if !suits && !forced {
                return None;
            }
            let counts = shows || !limits.some;
            mechanisms.push(TrueMechanism { id: part.id, counts, stage: part.stage, parameters, ratio, left });
        }
        Some(Self { machine, whole, mechanisms })
    }
}
