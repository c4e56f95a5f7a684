//! Small pieces of spatial algebra on several numbers at a time.

mod number;
mod pair;
mod sincos;
mod tensor;

pub(super) use number::Number;
pub(super) use pair::{Pair, Two, Widest};
pub(super) use sincos::sin_cos;
pub(super) use tensor::{Articulated, Turn, Vec3, add, at, cross, rotate, rotate_back, six, sub, three};
