//! Joints that follow others rigidly.
//!
//! A follower's rate is its leader's times a number, so what holds the two together does no work: an unknown force pair
//! `lambda` along `A = e_follower - multiplier e_leader`. A step's solution `k` of `(M + D) k = tau` becomes that of
//! `(M + D) k = tau + A' lambda` with `A k = 0`; states that obey once then always do, because a step is linear in them.

use crate::robot::Following;
use nalgebra::{DMatrix, DVector};

/// The followers of a robot, with room for what a step needs.
pub(super) struct Followers {
    all: Vec<Following>,
    torque_nm: Vec<f64>,
    /// What a newton metre between each pair changes.
    responses: Vec<Vec<f64>>,
}

impl Followers {
    pub fn new(all: &[Following], joints: usize) -> Self {
        let responses = vec![vec![0.0; 6 + joints]; all.len()];
        Self { all: all.to_vec(), torque_nm: vec![0.0; joints], responses }
    }

    /// Holds the followers in the solution `k` for `torque_nm`; `solve` answers with the solution for other torques.
    pub fn hold(&mut self, torque_nm: &[f64], k: &mut [f64], mut solve: impl FnMut(&[f64], &mut [f64])) {
        if self.all.is_empty() {
            return;
        }
        for (one, response) in self.all.iter().zip(&mut self.responses) {
            self.torque_nm.copy_from_slice(torque_nm);
            self.torque_nm[one.follower] += 1.0;
            self.torque_nm[one.leader] -= one.multiplier;
            solve(&self.torque_nm, response);
            response.iter_mut().zip(&*k).for_each(|(with, without)| *with -= without);
        }
        let n = self.all.len();
        let apart = |k: &[f64], one: &Following| k[6 + one.follower] - one.multiplier * k[6 + one.leader];
        let gained = DMatrix::from_fn(n, n, |i, j| apart(&self.responses[j], &self.all[i]));
        let lack = DVector::from_fn(n, |i, _| -apart(k, &self.all[i]));
        let Some(forces_nm) = gained.lu().solve(&lack) else { return };
        for (response, force_nm) in self.responses.iter().zip(forces_nm.iter()) {
            k.iter_mut().zip(response).for_each(|(k, response)| *k += force_nm * response);
        }
        // What rounding leaves.
        self.all.iter().for_each(|one| k[6 + one.follower] = one.multiplier * k[6 + one.leader]);
    }
}
