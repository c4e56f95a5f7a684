//! Masses and friction that explain most, within what is believed of them, without any cause.
//!
//! Numbers are found by steps of Gauss and Newton, the whole robot simulated at every one: friction that is three times
//! the believed one is far from what it does to first order. What is far off is weighed by how far it is off: as if that
//! were noise, so that no step trusts a first order that does not hold.

use super::attained::Attained;
use super::bench::{Bench, RanAway};
use super::noise::Noise;
use super::scatter::Scatter;

/// Steps, and halvings of one that explains less.
const STEPS: usize = 8;
const HALVINGS: usize = 3;
/// Numbers that would move by less, in their standard deviations, have arrived.
const ARRIVED: f64 = 0.15;

/// The robot with the numbers that explain most; the bench rests on the robot as stated again, and weighs by what each
/// number changes there.
pub(super) fn recalibrated(bench: &mut Bench<'_>) -> Result<Attained, RanAway> {
    let none = vec![0.0; bench.layout.len];
    let (stated, numbers) = bench.uncertain();
    bench.numbers = numbers;
    bench.weigh_by(stated.clone(), &none)?;
    let (mut sizes, mut columns) = (vec![0.0; bench.numbers.len()], stated.clone());
    for _ in 0..STEPS {
        let mut left = bench.left();
        for (size, column) in sizes.iter().zip(&columns) {
            left.iter_mut().zip(column).for_each(|(left, change)| *left += size * change);
        }
        let noise = bench.noise.tempered(temper(bench, &bench.left()));
        let wanted = noise.sizes(&left);
        let farthest = sizes.iter().zip(&wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        if farthest < ARRIVED || !moved(bench, &noise, &mut sizes, &wanted) {
            break;
        }
        let (there, numbers) = bench.uncertain();
        // A number at which the robot runs away has no column: the last ones are near enough.
        if numbers == bench.numbers {
            columns = there;
            bench.weigh_by(columns.clone(), &none)?;
        }
    }
    let undone: Vec<f64> = sizes.iter().map(|size| -size).collect();
    let wanted = bench.noise.sizes(&bench.noise.less(bench.left(), &undone));
    let mut common = wanted.clone();
    common[..sizes.len()].fill(0.0);
    let price = price(&bench.noise, &bench.left(), &sizes, &wanted[sizes.len()..]);
    let attained = Attained { price, residual: bench.noise.less(bench.left(), &common), sizes };
    let none_moved = Scatter::none(bench.case.model());
    if !bench.rest_on(none_moved) {
        return Err(RanAway);
    }
    bench.weigh_by(stated, &none)?;
    Ok(attained)
}

/// Goes towards the numbers that are wanted as far as that explains more; `false` where it does not.
fn moved(bench: &mut Bench<'_>, noise: &Noise, sizes: &mut Vec<f64>, wanted: &[f64]) -> bool {
    let offset = &wanted[sizes.len()..];
    let here = price(noise, &bench.left(), sizes, offset);
    let base = bench.base.clone();
    for halving in 0..=HALVINGS {
        let share = 0.5_f64.powi(halving as i32);
        let there: Vec<f64> = sizes.iter().zip(wanted).map(|(from, to)| from + share * (to - from)).collect();
        if bench.rest_on(scattered(bench, &there)) && price(noise, &bench.left(), &there, offset) < here {
            *sizes = there;
            return true;
        }
    }
    if bench.base != base {
        bench.rest_on(base);
    }
    false
}

/// The robot whose numbers are off by so many of their standard deviations.
pub(super) fn scattered(bench: &Bench<'_>, sizes: &[f64]) -> Scatter {
    let mut scatter = Scatter::none(bench.case.model());
    let numbers = bench.numbers.iter().zip(sizes);
    numbers.for_each(|(number, size)| scatter.put(*number, size * bench.spreads.sd(*number)));
    scatter
}

/// How many times the noise's variance is left, at least once.
fn temper(bench: &Bench<'_>, left: &[f64]) -> f64 {
    let squares: f64 = bench.noise.weight.iter().zip(left).map(|(weight, left)| weight * left.powi(2)).sum();
    (squares / bench.noise.count().max(1) as f64).max(1.0)
}

/// Weighed squares of what is left, with what the sensors have in common taken out, and the price of the numbers.
pub(super) fn price(noise: &Noise, left: &[f64], sizes: &[f64], offset: &[f64]) -> f64 {
    let common: Vec<f64> = vec![0.0; sizes.len()].into_iter().chain(offset.iter().copied()).collect();
    let read = noise.less(left.to_vec(), &common);
    let squares: f64 = noise.weight.iter().zip(&read).map(|(weight, left)| weight * left.powi(2)).sum();
    squares + sizes.iter().chain(offset).map(|size| size.powi(2)).sum::<f64>()
}
