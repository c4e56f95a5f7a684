//! Code of others that panics on a damaged file.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

thread_local! {
    /// Whether this thread is in such code.
    static IN_IT: Cell<bool> = const { Cell::new(false) };
}

/// What is told of panics elsewhere stays as it was before the first call of [`contained`].
static HOOK: Once = Once::new();

/// What `work` answers; `None` where it panics, of which nothing is printed.
pub(super) fn contained<T>(work: impl FnOnce() -> T) -> Option<T> {
    HOOK.call_once(|| {
        let told = take_hook();
        set_hook(Box::new(move |panic| {
            if !IN_IT.get() {
                told(panic);
            }
        }));
    });
    IN_IT.set(true);
    let answer = catch_unwind(AssertUnwindSafe(work));
    IN_IT.set(false);
    answer.ok()
}

#[cfg(test)]
mod tests {
    use super::contained;

    #[test]
    fn a_panic_is_no_answer_and_does_not_stay() {
        assert_eq!(contained(|| 1), Some(1));
        assert_eq!(contained(|| -> u8 { panic!("told to nobody") }), None);
        assert!(std::panic::catch_unwind(|| -> u8 { panic!("told as ever") }).is_err());
        assert_eq!(contained(|| 2), Some(2));
    }
}
