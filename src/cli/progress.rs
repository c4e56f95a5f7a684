//! Progress on standard error, where that is a terminal; nothing otherwise.

use crate::progress::{self, Step};
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::time::Duration;

/// A line that says what is being done.
pub(super) struct Progress(Option<ProgressBar>);

impl Progress {
    pub(super) fn new(quiet: bool) -> Self {
        Self::within(quiet, None)
    }

    /// The same of what has a time of its own.
    pub(super) fn within(quiet: bool, time: Option<Duration>) -> Self {
        if quiet || !std::io::stderr().is_terminal() {
            return Self(None);
        }
        let bar = ProgressBar::new_spinner();
        bar.set_style(
            ProgressStyle::with_template(&template(time)).unwrap_or_else(|_| ProgressStyle::default_spinner()),
        );
        bar.enable_steady_tick(Duration::from_millis(120));
        Self(Some(bar))
    }

    pub(super) fn say(&self, what: &str) {
        if let Some(bar) = &self.0 {
            bar.set_message(what.to_owned());
        }
    }

    /// Clears the line while something is printed.
    pub(super) fn pause(&self, print: impl FnOnce()) {
        match &self.0 {
            Some(bar) => bar.suspend(print),
            None => print(),
        }
    }
}

impl progress::Progress for Progress {
    fn step(&self, step: Step) {
        self.say(&told(step));
    }
}

/// How the line looks: with the time that is allowed, where it is.
fn template(time: Option<Duration>) -> String {
    let of = time.map_or_else(String::new, |time| format!(" of {} s", time.as_secs_f64()));
    format!("{{spinner}} {{msg}} ({{elapsed}}{of})")
}

/// `screening: 3 of 17`
fn told(Step { stage, done, of }: Step) -> String {
    if of == 0 { stage.to_owned() } else { format!("{stage}: {done} of {of}") }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_told_with_its_parts_where_they_are_counted() {
        assert_eq!(told(Step { stage: "screening", done: 3, of: 17 }), "screening: 3 of 17");
        assert_eq!(told(Step::stage("reading")), "reading");
    }

    #[test]
    fn a_time_that_is_allowed_is_told_beside_the_elapsed_one() {
        assert_eq!(template(None), "{spinner} {msg} ({elapsed})");
        assert_eq!(template(Some(Duration::from_secs(90))), "{spinner} {msg} ({elapsed} of 90 s)");
    }
}
