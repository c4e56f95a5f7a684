//! Pairs of effects that explain together what neither shows alone.
//!
//! To first order what two effects change adds up, so that every pair of starting points can be judged from what each of
//! them changes by itself. The pairs that promise most are refitted.

use super::explore::{Added, refitted};
use super::sight::{LARGEST, Point, Sight};
use crate::gap::hypothesis::evidence::Evidence;
use crate::gap::hypothesis::trial::Trial;
use nalgebra::{DMatrix, DVector};

/// Pairs that are refitted from each view.
const PROMISING: usize = 6;

/// The best fits of `base` with two effects added; best first.
pub(in crate::gap) fn pairs(evidence: &Evidence, base: &Trial, sights: &[Sight]) -> Vec<Trial> {
    let candidates = sights.iter().flat_map(promising).collect();
    refitted(evidence, base, candidates, f64::INFINITY)
}

/// The pairs that promise most, with the values from which to refit.
fn promising(sight: &Sight) -> Vec<Added> {
    let usable: Vec<&Point> = sight.points.iter().filter(|p| p.moved.iter().all(|m| m.is_finite())).collect();
    let absent = DVector::from_column_slice(&sight.absent);
    let rows = absent.len();
    let moved = DMatrix::from_iterator(rows, usable.len(), usable.iter().flat_map(|p| p.moved.iter().copied()));
    let (gram, slopes) = (moved.tr_mul(&moved), moved.tr_mul(&absent));
    let mut best: Vec<(f64, usize, usize)> = Vec::new();
    for i in 0..usable.len() {
        for j in i + 1..usable.len() {
            let pair = [usable[i].effect, usable[j].effect];
            if pair[0] == pair[1] || pair.iter().any(|effect| effect.parts_two_bodies()) {
                continue;
            }
            let gained = least([slopes[i], slopes[j]], [gram[(i, i)], gram[(j, j)]], gram[(i, j)]);
            let same = |(_, a, b): &&mut (f64, usize, usize)| {
                let known = [usable[*a].effect, usable[*b].effect];
                known == pair || known == [pair[1], pair[0]]
            };
            match best.iter_mut().find(same) {
                Some(known) if known.0 <= gained => {}
                Some(known) => *known = (gained, i, j),
                None => best.push((gained, i, j)),
            }
        }
    }
    best.sort_by(|a, b| a.0.total_cmp(&b.0));
    best.truncate(PROMISING);
    let chosen = |&(_, i, j): &(f64, usize, usize)| {
        (vec![usable[i].effect.into(), usable[j].effect.into()], sight.with(&[usable[i], usable[j]]))
    };
    best.iter().map(chosen).collect()
}

/// Least of `2 s.slopes + s.A s` over two sizes from zero to [`LARGEST`], `A` with this diagonal and cross term.
fn least(slopes: [f64; 2], diagonal: [f64; 2], cross: f64) -> f64 {
    let value = |s: [f64; 2]| {
        let linear = 2.0 * (s[0] * slopes[0] + s[1] * slopes[1]);
        linear + s[0] * s[0] * diagonal[0] + s[1] * s[1] * diagonal[1] + 2.0 * s[0] * s[1] * cross
    };
    let inside = |s: f64| (0.0..=LARGEST).contains(&s);
    let determinant = diagonal[0] * diagonal[1] - cross * cross;
    let free = [
        (cross * slopes[1] - diagonal[1] * slopes[0]) / determinant,
        (cross * slopes[0] - diagonal[0] * slopes[1]) / determinant,
    ];
    if determinant > 1e-12 * diagonal[0] * diagonal[1] && inside(free[0]) && inside(free[1]) {
        return value(free);
    }
    // Otherwise the least lies on an edge of the square of sizes.
    let edge = |fixed: usize, at: f64| {
        let other = 1 - fixed;
        let size = (-(slopes[other] + at * cross) / diagonal[other]).clamp(0.0, LARGEST);
        let mut s = [0.0; 2];
        s[fixed] = at;
        s[other] = if size.is_finite() { size } else { 0.0 };
        value(s)
    };
    [edge(0, 0.0), edge(0, LARGEST), edge(1, 0.0), edge(1, LARGEST)].into_iter().fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_least_is_below_every_point_of_the_square(
            slopes in prop::array::uniform2(-3.0..3.0f64),
            diagonal in prop::array::uniform2(0.1..3.0f64),
            share in -0.95..0.95f64,
            s in prop::array::uniform2(0.0..LARGEST),
        ) {
            let cross = share * (diagonal[0] * diagonal[1]).sqrt();
            let there = 2.0 * (s[0] * slopes[0] + s[1] * slopes[1])
                + s[0] * s[0] * diagonal[0] + s[1] * s[1] * diagonal[1] + 2.0 * s[0] * s[1] * cross;
            prop_assert!(least(slopes, diagonal, cross) <= there + 1e-9);
        }
    }
}
