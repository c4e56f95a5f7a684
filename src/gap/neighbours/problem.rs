//! Drops of the whole robot against swings, as a least-squares problem.

use super::Cause;
use super::swings::{Swings, VISCOUS};
use crate::fit::{Block, Coordinate, Rejected, Residuals, Rounding};
use crate::identify::{Experiment, Parameter, free_of, starts_of, values_in};
use crate::robot::bench::Held;
use rayon::prelude::*;

/// The whole robot with some causes let in.
pub(super) struct Problem<'a> {
    swings: &'a Swings<'a>,
    held: Held,
    /// Those are free that are searched.
    pub parameters: Vec<Parameter>,
    free: Vec<usize>,
    coordinates: Vec<Coordinate>,
}

impl<'a> Problem<'a> {
    pub fn new(swings: &'a Swings<'a>, causes: &[Cause]) -> Self {
        let mut parameters = swings.parameters.clone();
        for (i, p) in parameters.iter_mut().enumerate() {
            p.fixed = i != VISCOUS && !causes.iter().any(|cause| cause.frees(&p.name));
        }
        let free = free_of(&parameters);
        let coordinates = free.iter().map(|&i| parameters[i].coordinate()).collect();
        Self { swings, held: held(causes), parameters, free, coordinates }
    }

    /// Coordinates of values of all parameters.
    pub fn coordinates_of(&self, values: &[f64]) -> Vec<f64> {
        self.free.iter().map(|&i| self.parameters[i].to_coordinate(values[i])).collect()
    }

    /// Values of all parameters.
    pub fn values(&self, x: &[f64]) -> Vec<f64> {
        values_in(&self.parameters, &starts_of(&self.parameters), &self.free, x, |value, _| value)
    }

    /// Model less reading of the compared samples of each swing \[rad\].
    pub fn residuals_rad(&self, x: &[f64]) -> Result<Vec<Vec<f64>>, Rejected> {
        self.swings.fit.par_iter().map(|e| self.residual_rad(x, e)).collect()
    }

    fn residual_rad(&self, x: &[f64], e: &Experiment) -> Result<Vec<f64>, Rejected> {
        let readings = self.swings.readings(e, self.held, &self.values(x));
        let readings = readings.map_err(|error| Rejected { why: error.to_string() })?;
        let both = readings.iter().zip(&e.measured_rad).skip(e.uncompared);
        let residual: Vec<f64> = both.map(|(model, measured)| model - measured).collect();
        match residual.iter().all(|r| r.is_finite()) {
            true => Ok(residual),
            false => Err(Rejected { why: "the motion runs away".into() }),
        }
    }

    /// Differences to one side: the motion has kinks where a joint sticks, so that more would not be better.
    fn block(&self, x: &[f64], e: &Experiment) -> Result<Block, Rejected> {
        let here = self.residual_rad(x, e)?;
        let slope = |(column, c): (usize, &Coordinate)| {
            let step = NUDGE * c.scale;
            let step = if x[column] + step > c.upper { -step } else { step };
            let mut nudged = x.to_vec();
            nudged[column] += step;
            let there = self.residual_rad(&nudged, e)?;
            Ok(there.iter().zip(&here).map(|(there, here)| (there - here) / step).collect())
        };
        let slopes: Vec<Vec<f64>> = self.coordinates.par_iter().enumerate().map(slope).collect::<Result<_, _>>()?;
        let roots: Vec<f64> = e.weights_s.iter().map(|weight| weight.sqrt()).collect();
        Ok(Block {
            columns: (0..x.len()).collect(),
            residual: here.iter().zip(&roots).map(|(r, root)| root * r).collect(),
            jacobian: roots.iter().enumerate().flat_map(|(k, root)| slopes.iter().map(move |s| root * s[k])).collect(),
        })
    }
}

/// How the other joints are held with some causes.
pub(super) fn held(causes: &[Cause]) -> Held {
    if causes.contains(&Cause::HeldJoints) { Held::ByController } else { Held::Rigid }
}

impl Residuals for Problem<'_> {
    fn coordinates(&self) -> &[Coordinate] {
        &self.coordinates
    }

    fn criterion(&self, x: &[f64]) -> Result<f64, Rejected> {
        let squares = |(r, e): (Vec<f64>, &Experiment)| r.iter().zip(&e.weights_s).map(|(r, w)| w * r * r).sum::<f64>();
        Ok(self.residuals_rad(x)?.into_iter().zip(&self.swings.fit).map(squares).sum())
    }

    fn linearise(&self, x: &[f64]) -> Result<Vec<Block>, Rejected> {
        self.swings.fit.par_iter().map(|e| self.block(x, e)).collect()
    }

    fn rounding(&self, block: usize) -> Rounding {
        self.swings.fit[block].rounding()
    }

    fn weights(&self, block: usize) -> &[f64] {
        &self.swings.fit[block].weights_s
    }
}

/// Steps of the finite differences, in scales of the coordinates.
const NUDGE: f64 = 1e-4;
