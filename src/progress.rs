//! How far a long computation is, and whether it is still wanted: what a computation tells and what it asks.
//!
//! A computation takes a `&dyn Progress` and tells it each [`Step`]; it asks [`Progress::cancelled`] between two steps
//! and ends early, with what it has, where the answer is yes. Steps may come from several threads and in any order.

/// A step of a computation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// What is being done, e.g. `screening`.
    pub stage: &'static str,
    /// Parts of the stage that are done.
    pub done: usize,
    /// Parts of the stage altogether; 0 where that is not known.
    pub of: usize,
}

impl Step {
    /// The beginning of a stage whose parts are not counted.
    pub fn stage(stage: &'static str) -> Self {
        Self { stage, done: 0, of: 0 }
    }
}

/// Somebody who wants to know how far a computation is.
pub trait Progress: Sync {
    /// Takes note of a step.
    fn step(&self, step: Step);

    /// Whether the computation is no longer wanted.
    fn cancelled(&self) -> bool {
        false
    }

    /// Goes on to a step, where the computation is still wanted.
    ///
    /// # Errors
    /// [`Cancelled`] where it is not.
    fn go_on(&self, step: Step) -> Result<(), Cancelled> {
        if self.cancelled() {
            return Err(Cancelled);
        }
        self.step(step);
        Ok(())
    }
}

/// A computation ended because it was no longer wanted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

/// Nobody wants to know.
#[derive(Clone, Copy, Debug, Default)]
pub struct Silent;

impl Progress for Silent {
    fn step(&self, _: Step) {}
}

/// Tells nothing, and is wanted as long as another.
#[derive(Clone, Copy)]
pub(crate) struct Quiet<'a>(pub &'a dyn Progress);

impl Progress for Quiet<'_> {
    fn step(&self, _: Step) {}

    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}

/// Any closure that takes steps.
impl<F: Fn(Step) + Sync> Progress for F {
    fn step(&self, step: Step) {
        self(step);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// Counts up, and stops where it is no longer wanted.
    fn count(to: usize, progress: &dyn Progress) -> usize {
        for done in 0..to {
            if progress.cancelled() {
                return done;
            }
            progress.step(Step { stage: "counting", done: done + 1, of: to });
        }
        to
    }

    #[test]
    fn a_closure_hears_every_step_and_nobody_stops_nothing() {
        let heard = Mutex::new(Vec::new());
        let listener = |step: Step| heard.lock().unwrap().push((step.stage, step.done, step.of));
        assert_eq!(count(2, &listener), 2);
        assert_eq!(*heard.lock().unwrap(), [("counting", 1, 2), ("counting", 2, 2)]);
        assert_eq!(count(3, &Silent), 3);
    }

    #[test]
    fn a_computation_that_is_no_longer_wanted_ends_early() {
        struct AtMost(usize, AtomicUsize);
        impl Progress for AtMost {
            fn step(&self, _: Step) {
                self.1.fetch_add(1, Ordering::Relaxed);
            }
            fn cancelled(&self) -> bool {
                self.1.load(Ordering::Relaxed) >= self.0
            }
        }
        let listener = AtMost(4, AtomicUsize::new(0));
        assert_eq!(count(10, &listener), 4);
        assert_eq!(listener.go_on(Step::stage("more")), Err(Cancelled));
        assert!(Quiet(&listener).cancelled() && Silent.go_on(Step::stage("more")).is_ok());
    }
}
