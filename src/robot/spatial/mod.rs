//! Small pieces of spatial algebra on two numbers at a time.

mod pair;
mod sincos;
mod tensor;

pub(super) use pair::Pair;
pub(super) use sincos::sin_cos;
pub(super) use tensor::{Articulated, Turn, Vec3, add, at, cross, rotate, rotate_back, sub};
