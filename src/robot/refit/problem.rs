//! Drops of the whole robot against logs, as a least-squares problem.

use super::values::{Searched, Values, coordinate};
use super::{BenchLogs, Cause};
use crate::fit::{Block, Coordinate, Rejected, Residuals, Rounding};
use crate::robot::bench::Held;
use rayon::prelude::*;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What is searched: viscous friction always, and what the causes ask for.
pub(super) struct Problem<'a> {
    pub logs: &'a BenchLogs<'a>,
    pub held: Held,
    /// Values of what is not searched.
    base: Values,
    searched: Vec<Searched>,
    coordinates: Vec<Coordinate>,
    weights: Vec<Vec<f64>>,
    last: Mutex<Last>,
}

/// What was computed last and where, so that no motion is computed twice.
#[derive(Default)]
struct Last {
    residuals: Option<(Vec<f64>, Vec<Vec<f64>>)>,
    blocks: Option<(Vec<f64>, Vec<Block>)>,
}

impl<'a> Problem<'a> {
    pub(super) fn new(logs: &'a BenchLogs<'a>, causes: &[Cause]) -> Self {
        let base = logs.nominal;
        let held = if causes.contains(&Cause::HeldJoints) { Held::ByController } else { Held::Rigid };
        let of_causes = causes.iter().filter(|cause| **cause != Cause::HeldJoints).map(|cause| Searched::Of(*cause));
        let searched: Vec<Searched> = std::iter::once(Searched::Viscous).chain(of_causes).collect();
        let coordinates = searched.iter().map(|searched| coordinate(*searched, &base)).collect();
        let weights = logs.logs.iter().map(|log| vec![1.0; log.samples - log.e.uncompared]).collect();
        Self { logs, held, base, searched, coordinates, weights, last: Mutex::default() }
    }

    /// Where a search begins that knows nothing: off the bounds, so that every coordinate can be felt.
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

    /// Samples that are compared.
    pub(super) fn samples(&self) -> usize {
        self.weights.iter().map(Vec::len).sum()
    }

    fn last(&self) -> MutexGuard<'_, Last> {
        self.last.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn residual(&self, x: &[f64], log: usize) -> Result<Vec<f64>, Rejected> {
        let log = &self.logs.logs[log];
        let readings = self.logs.readings(log, self.held, &self.values(x));
        let readings = readings.map_err(|error| Rejected { why: error.to_string() })?;
        let both = readings.iter().zip(&log.e.measured_rad).take(log.samples).skip(log.e.uncompared);
        let residual: Vec<f64> = both.map(|(model, measured)| model - measured).collect();
        match residual.iter().all(|r| r.is_finite()) {
            true => Ok(residual),
            false => Err(Rejected { why: "the motion runs away".into() }),
        }
    }

    fn residuals(&self, x: &[f64]) -> Result<Vec<Vec<f64>>, Rejected> {
        if let Some((_, residuals)) = self.last().residuals.as_ref().filter(|(at, _)| at == x) {
            return Ok(residuals.clone());
        }
        let all = (0..self.logs.logs.len()).into_par_iter().map(|log| self.residual(x, log));
        let residuals: Vec<Vec<f64>> = all.collect::<Result<_, _>>()?;
        self.last().residuals = Some((x.to_vec(), residuals.clone()));
        Ok(residuals)
    }
}

impl Residuals for Problem<'_> {
    fn coordinates(&self) -> &[Coordinate] {
        &self.coordinates
    }

    fn criterion(&self, x: &[f64]) -> Result<f64, Rejected> {
        Ok(self.residuals(x)?.iter().map(|residual| residual.iter().map(|r| r * r).sum::<f64>()).sum())
    }

    /// Differences to one side: the motion has kinks where a joint sticks, so that more would not be better.
    fn linearise(&self, x: &[f64]) -> Result<Vec<Block>, Rejected> {
        if let Some((_, blocks)) = self.last().blocks.as_ref().filter(|(at, _)| at == x) {
            return Ok(blocks.clone());
        }
        let here = self.residuals(x)?;
        let columns = x.len();
        let nudge = |c: usize| {
            let step = NUDGE * self.coordinates[c].scale;
            if x[c] + step > self.coordinates[c].upper { -step } else { step }
        };
        let jobs: Vec<(usize, usize)> =
            (0..here.len()).flat_map(|log| (0..columns).map(move |nudged| (log, nudged))).collect();
        let runs: Vec<Vec<f64>> = jobs
            .par_iter()
            .map(|&(log, nudged)| {
                let mut at = x.to_vec();
                at[nudged] += nudge(nudged);
                self.residual(&at, log)
            })
            .collect::<Result<_, _>>()?;
        let block = |(residual, runs): (Vec<f64>, &[Vec<f64>])| {
            let row = |i: usize| (0..columns).map(move |c| (i, c));
            let slope = |(i, c): (usize, usize)| (runs[c][i] - residual[i]) / nudge(c);
            let jacobian = (0..residual.len()).flat_map(row).map(slope).collect();
            Block { columns: (0..columns).collect(), residual, jacobian }
        };
        let blocks: Vec<Block> = here.into_iter().zip(runs.chunks_exact(columns)).map(block).collect();
        self.last().blocks = Some((x.to_vec(), blocks.clone()));
        Ok(blocks)
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
