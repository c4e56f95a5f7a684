//! Work on a thread of its own, while the interpreter's looks after progress and Ctrl-C.

use crate::errors::{Failed, Unwanted};
use aibo_fit::progress::{Cancelled, Progress, Step};
use pyo3::prelude::*;
use std::panic;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// How long Ctrl-C may go unnoticed.
const POLL: Duration = Duration::from_millis(50);

/// Hands steps to the interpreter's thread, and knows whether the work is still wanted.
pub struct Listener {
    steps: Mutex<Sender<Step>>,
    is_unwanted: AtomicBool,
}

impl Listener {
    /// A step of work that only tells what it does, and cannot be asked to end: it is unwound where it is not wanted.
    pub fn say(&self, what: &str) {
        if self.cancelled() {
            panic::resume_unwind(Box::new(Unwanted(Cancelled)));
        }
        // The words of such work are few and the program's own.
        self.step(Step::stage(Box::leak(what.to_owned().into_boxed_str())));
    }
}

impl Progress for Listener {
    fn step(&self, step: Step) {
        // Nobody who listens any more is no error.
        let _ = self.steps.lock().unwrap_or_else(PoisonError::into_inner).send(step);
    }

    fn cancelled(&self) -> bool {
        self.is_unwanted.load(Ordering::Relaxed)
    }
}

/// Does work without the interpreter's lock. `progress` is called with stage, parts done and parts in all (0: not known);
/// what it raises, and Ctrl-C, ends the work.
pub fn run<T: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(&Listener) -> Result<T, Failed> + Send,
) -> PyResult<T> {
    let (send, steps) = channel();
    let listener = Listener { steps: Mutex::new(send), is_unwanted: AtomicBool::new(false) };
    let is_done = AtomicBool::new(false);
    let (listener, is_done) = (&listener, &is_done);
    py.detach(move || {
        thread::scope(|scope| {
            let worker = scope.spawn(move || {
                let done = Done(is_done);
                let answer = work(listener);
                drop(done);
                // The last step wakes who waits for it.
                listener.step(Step::stage("done"));
                answer
            });
            let interrupted = attend(&steps, progress.as_ref(), is_done);
            if interrupted.is_err() {
                listener.is_unwanted.store(true, Ordering::Relaxed);
            }
            let answer = worker.join();
            interrupted?;
            match answer {
                Ok(answer) => Ok(answer?),
                Err(cause) => panic::resume_unwind(cause),
            }
        })
    })
}

/// Says so when it goes, however that comes about.
struct Done<'a>(&'a AtomicBool);

impl Drop for Done<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
    }
}

fn attend(steps: &Receiver<Step>, progress: Option<&Py<PyAny>>, is_done: &AtomicBool) -> PyResult<()> {
    loop {
        match steps.recv_timeout(POLL) {
            Ok(Step { stage, done, of }) => {
                if let Some(progress) = progress {
                    Python::attach(|py| progress.call1(py, (stage, done, of)).map(|_| ()))?;
                }
            }
            Err(RecvTimeoutError::Timeout) => Python::attach(|py| py.check_signals())?,
            Err(RecvTimeoutError::Disconnected) => return Ok(()),
        }
        if is_done.load(Ordering::Acquire) {
            return Ok(());
        }
    }
}
