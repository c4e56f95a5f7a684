//! A model with laws that are known.

use super::{Experiment, JointModel, Parameter};
use crate::joint::{Chain, Law, Real};

/// A model whose joint has laws without a formula, held as they are.
#[derive(Clone, Debug)]
pub struct WithLaws<M> {
    /// The model without them.
    pub model: M,
    /// What is added to its joint.
    pub laws: Vec<Law<f64>>,
}

impl<M: JointModel> JointModel for WithLaws<M> {
    fn parameters(&self) -> &[Parameter] {
        self.model.parameters()
    }

    fn parameters_mut(&mut self) -> &mut [Parameter] {
        self.model.parameters_mut()
    }

    fn chain<T: Real>(&self, values: &[T], experiment: &Experiment) -> Chain<T> {
        let mut chain = self.model.chain(values, experiment);
        for law in &self.laws {
            chain.add_law(law.held());
        }
        chain
    }

    fn unit_rad2_s(&self) -> f64 {
        self.model.unit_rad2_s()
    }
}
