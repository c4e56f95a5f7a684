//! Integration of ordinary differential equations.
//!
//! [`rk4`] is the kernel that the pendulums step with, over any number type. For systems of any size there is
//! one interface: an [`Ode`] says what is asked, a [`Method`] how (step or tolerance only), a [`Solver`] is the working
//! memory that carries a state on and counts what it cost. The methods are those of Table 4.1 and its neighbours:
//! Runge-Kutta 2 and 4 with a fixed step, Dormand and Prince's 5(4) pair (1980), and multistep formulas of variable
//! order in Nordsieck's form (Gear 1971; Hindmarsh 1983): Adams to order 12 and backward differentiation to order 5.
//!
//! Not here: a robot's own method, which knows sticking joints and stiff controllers (`robot::simulate`).

mod dense;
mod dormand_prince;
mod fixed;
mod kernel;
mod multistep;
mod solver;
#[cfg(test)]
mod tests;

pub use kernel::rk4;
pub use solver::{Counts, Method, Ode, Solver, Stalled, Tolerance};
