//! Layer 4: pendulums. The simple model (3.2-3.6), the extensive model (3.12, 3.13) and their motion.

mod extensive;
mod rollout;
mod simple;

pub use extensive::ExtensivePendulum;
pub use rollout::{Diverged, Input, Start, State, rollout, rollout_refined};
pub use simple::SimplePendulum;
