//! Drops of the whole robot against logs, as a least-squares problem.

use super::{BenchLogs, Cause, Values};
use crate::fit::{Block, Coordinate, Rejected, Residuals, Rounding};
use crate::robot::bench::Held;
use rayon::prelude::*;

/// What is searched: viscous friction always, and what the causes ask for.
pub(super) struct Problem<'a> {
    pub logs: &'a BenchLogs<'a>,
    pub held: Held,
    /// Values of what is not searched.
    base: Values,
    searched: Vec<Searched>,
    coordinates: Vec<Coordinate>,
    weights: Vec<Vec<f64>>,
}

/// A number that can be searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Searched {
    Viscous,
    Of(Cause),
}

impl<'a> Problem<'a> {
    pub(super) fn new(logs: &'a BenchLogs<'a>, causes: &[Cause]) -> Self {
        let base = logs.nominal;
        let held = if causes.contains(&Cause::HeldJoints) { Held::ByController } else { Held::Rigid };
        let of_causes = causes.iter().filter(|cause| **cause != Cause::HeldJoints).map(|cause| Searched::Of(*cause));
        let searched: Vec<Searched> = std::iter::once(Searched::Viscous).chain(of_causes).collect();
        let coordinates = searched.iter().map(|searched| coordinate(*searched, &base)).collect();
        let weights = logs.logs.iter().map(|log| vec![1.0; log.samples - log.e.uncompared]).collect();
        Self { logs, held, base, searched, coordinates, weights }
    }

    /// Where a search begins: off the bounds, so that every coordinate can be felt.
    pub(super) fn start(&self) -> Vec<f64> {
        let off = |(x, c): (f64, &Coordinate)| if x <= c.lower { c.lower + 0.2 * c.scale } else { x };
        self.coordinates_of(&self.base).into_iter().zip(&self.coordinates).map(off).collect()
    }

    pub(super) fn coordinates_of(&self, values: &Values) -> Vec<f64> {
        let mut values = *values;
        self.searched.iter().map(|searched| *values.at(*searched)).collect()
    }

    pub(super) fn values(&self, x: &[f64]) -> Values {
        let mut values = self.base;
        for (searched, x) in self.searched.iter().zip(x) {
            *values.at(*searched) = *x;
        }
        values
    }

    pub(super) fn place(&self, searched: Searched) -> Option<usize> {
        self.searched.iter().position(|other| *other == searched)
    }

    fn residual(&self, x: &[f64], log: usize) -> Result<Vec<f64>, Rejected> {
        let readings = self.logs.readings(log, self.held, &self.values(x));
        let readings = readings.map_err(|error| Rejected { why: error.to_string() })?;
        let log = &self.logs.logs[log];
        let both = readings.iter().zip(&log.e.measured_rad).take(log.samples).skip(log.e.uncompared);
        let residual: Vec<f64> = both.map(|(model, measured)| model - measured).collect();
        match residual.iter().all(|r| r.is_finite()) {
            true => Ok(residual),
            false => Err(Rejected { why: "the motion runs away".into() }),
        }
    }
}

impl Residuals for Problem<'_> {
    fn coordinates(&self) -> &[Coordinate] {
        &self.coordinates
    }

    fn criterion(&self, x: &[f64]) -> Result<f64, Rejected> {
        let sum = |log| Ok(self.residual(x, log)?.iter().map(|r| r * r).sum::<f64>());
        let sums: Vec<f64> = (0..self.logs.logs.len()).into_par_iter().map(sum).collect::<Result<_, Rejected>>()?;
        Ok(sums.iter().sum())
    }

    /// Differences to one side: the motion has kinks where a joint sticks, so that more would not be better.
    fn linearise(&self, x: &[f64]) -> Result<Vec<Block>, Rejected> {
        let columns = x.len();
        let nudge = |c: usize| {
            let step = NUDGE * self.coordinates[c].scale;
            if x[c] + step > self.coordinates[c].upper { -step } else { step }
        };
        let jobs: Vec<(usize, usize)> =
            (0..self.logs.logs.len()).flat_map(|log| (0..=columns).map(move |nudged| (log, nudged))).collect();
        let runs: Vec<Vec<f64>> = jobs
            .par_iter()
            .map(|&(log, nudged)| {
                let mut at = x.to_vec();
                if nudged > 0 {
                    at[nudged - 1] += nudge(nudged - 1);
                }
                self.residual(&at, log)
            })
            .collect::<Result<_, _>>()?;
        let block = |runs: &[Vec<f64>]| {
            let residual = runs[0].clone();
            let row = |i: usize| (0..columns).map(move |c| (i, c));
            let slope = |(i, c): (usize, usize)| (runs[c + 1][i] - runs[0][i]) / nudge(c);
            let jacobian = (0..residual.len()).flat_map(row).map(slope).collect();
            Block { columns: (0..columns).collect(), residual, jacobian }
        };
        Ok(runs.chunks_exact(columns + 1).map(block).collect())
    }

    fn rounding(&self, _block: usize) -> Rounding {
        Rounding::default()
    }

    fn weights(&self, block: usize) -> &[f64] {
        &self.weights[block]
    }
}

/// Steps of the finite differences, in scales of the coordinates.
const NUDGE: f64 = 5e-3;

fn coordinate(searched: Searched, nominal: &Values) -> Coordinate {
    let (name, lower, upper, scale) = match searched {
        Searched::Viscous => ("viscous", 0.0, 0.2, 0.005),
        Searched::Of(cause) => {
            let (lower, upper, scale) = match cause {
                Cause::HeldJoints => (0.0, 0.0, 1.0),
                Cause::Zero => (-0.3, 0.3, 0.03),
                Cause::Mass => (0.05 * nominal.mass_kg, 20.0 * nominal.mass_kg, 0.5 * nominal.mass_kg),
                Cause::LoadFriction => (0.0, 0.9, 0.1),
                Cause::Direction => (-0.1, 0.1, 0.005),
                Cause::Coulomb => (0.0, 0.3, 0.005),
            };
            (cause.id(), lower, upper, scale)
        }
    };
    Coordinate { name: name.to_owned(), lower, upper, scale }
}
