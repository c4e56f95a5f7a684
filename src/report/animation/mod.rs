//! The robot in motion (Figure 4.4): what did the walk look like?
//!
//! [`Recording`] keeps the places of a robot's parts at times; an [`Animation`] puts several of them side by side (a
//! nominal and a repaired model, a logged walk). [`animation_html`] makes one page with play, scrub, speed and a camera
//! that needs no network, [`animation_gif`] a small side view. Parts are drawn as the ellipsoids that they are
//! (Table A.2), seen from far away, which makes their outlines exact ellipses.

mod gif;
mod outline;
mod page;
mod recording;
mod strip;
#[cfg(test)]
mod tests;

pub use gif::{GifOptions, animation_gif};
pub(super) use outline::{Outline, View, outline};
pub use page::animation_html;
pub use recording::{Animation, Dog, Recording};
pub(super) use recording::{DOG_M, LEAST_UNIT, PICTURE_S};
pub use strip::animation_strip;
