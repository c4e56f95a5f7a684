//! Until when a computation may search, and what it leaves out to be done by then.
//!
//! A search asks its [`Deadline`] before each thing that it could as well not try; what was found until then is weighed in
//! the time that is left. Who sets none gets the same answer whatever the clock does.

use serde::Serialize;
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Share of the time after which nothing new is tried: weighing what was found takes time as well.
const SEARCHES: f64 = 0.6;

/// The longest time that is allowed: a year.
const LONGEST: Duration = Duration::from_secs(31_557_600);

/// A time in which nothing can be answered, or for which nobody waits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("expected more than 0 s and no more than a year")]
pub struct NoBudget;

/// So many seconds as a time for an answer.
///
/// ```
/// use aibo_fit::deadline::{NoBudget, budget};
///
/// assert_eq!(budget(90.0)?.as_secs(), 90);
/// assert_eq!(budget(f64::NAN), Err(NoBudget));
/// # Ok::<(), NoBudget>(())
/// ```
///
/// # Errors
/// [`NoBudget`] where that is no time, or more than a year.
pub fn budget(time_s: f64) -> Result<Duration, NoBudget> {
    let time = Duration::try_from_secs_f64(time_s).ok().filter(|time| *time <= LONGEST);
    time.filter(|_| time_s > 0.0).ok_or(NoBudget)
}

/// Until when a computation may take; by default as long as it does.
#[derive(Clone, Debug, Default)]
pub struct Deadline(Option<Arc<Limit>>);

#[derive(Debug)]
struct Limit {
    asked: Duration,
    began: Instant,
    /// From here on nothing new is tried ...
    searches_until: Instant,
    /// ... and from here on fits end where they are.
    fits_until: Instant,
    omitted: Mutex<Omitted>,
    /// Of what this is a part.
    whole: Deadline,
}

#[derive(Debug, Default)]
struct Omitted {
    /// What the answer would have been found by.
    search: BTreeSet<&'static str>,
    /// What would have been told beside it.
    beside: BTreeSet<&'static str>,
}

impl Deadline {
    /// So much time from now on, of which a year at most is taken.
    pub fn within(asked: Duration) -> Self {
        let began = Instant::now();
        Self::between((asked, began), (began, asked.min(LONGEST)), Self::default())
    }

    fn between((asked, began): (Duration, Instant), (from, time): (Instant, Duration), whole: Self) -> Self {
        let (searches_until, fits_until) = (from + time.mul_f64(SEARCHES), from + time);
        let omitted = Mutex::default();
        Self(Some(Arc::new(Limit { asked, began, searches_until, fits_until, omitted, whole })))
    }

    /// For one of so many parts that are still to be done, as many at once as there are threads: its share of the time that
    /// is left. What it leaves out is left out of the whole.
    pub(crate) fn part(&self, still: usize) -> Self {
        let Some(limit) = &self.0 else { return Self::default() };
        let now = Instant::now();
        let share = rayon::current_num_threads() as f64 / still.max(1) as f64;
        let time = limit.fits_until.saturating_duration_since(now).mul_f64(share.min(1.0));
        Self::between((limit.asked, limit.began), (now, time), self.clone())
    }

    /// Whether it is too late to try something that the answer may depend on; what that is is noted then, in plain words.
    pub(crate) fn leaves_out(&self, what: &'static str) -> bool {
        self.notes(what, |limit| limit.searches_until, |omitted| &mut omitted.search)
    }

    /// The same of what would be told beside the answer.
    pub(crate) fn leaves_aside(&self, what: &'static str) -> bool {
        self.notes(what, |limit| limit.searches_until, |omitted| &mut omitted.beside)
    }

    /// Whether it is even too late to weigh what was found; what is not done is noted then.
    pub(crate) fn cuts(&self, what: &'static str) -> bool {
        self.notes(what, |limit| limit.fits_until, |omitted| &mut omitted.search)
    }

    fn notes(
        &self,
        what: &'static str,
        until: fn(&Limit) -> Instant,
        kind: fn(&mut Omitted) -> &mut BTreeSet<&'static str>,
    ) -> bool {
        let Some(limit) = &self.0 else { return false };
        let is_late = Instant::now() >= until(limit);
        if is_late {
            self.note(what, kind);
        }
        is_late
    }

    fn note(&self, what: &'static str, kind: fn(&mut Omitted) -> &mut BTreeSet<&'static str>) {
        let Some(limit) = &self.0 else { return };
        kind(&mut limit.omitted.lock().unwrap_or_else(PoisonError::into_inner)).insert(what);
        limit.whole.note(what, kind);
    }

    /// What became of the time until now; `None` where there was no limit.
    pub fn spent(&self) -> Option<Spent> {
        let limit = self.0.as_ref()?;
        let omitted = limit.omitted.lock().unwrap_or_else(PoisonError::into_inner);
        let words = omitted.search.iter().chain(omitted.beside.difference(&omitted.search));
        Some(Spent {
            asked_s: limit.asked.as_secs_f64(),
            used_s: limit.began.elapsed().as_secs_f64(),
            not_tried: words.map(|what| (*what).to_owned()).collect(),
            finished: omitted.search.is_empty(),
        })
    }
}

/// What became of a limited time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Spent {
    /// Time that was allowed \[s\].
    pub asked_s: f64,
    /// Time that was used \[s\].
    pub used_s: f64,
    /// What was not tried, or not told, because of it.
    pub not_tried: Vec<String>,
    /// Whether all was tried that the answer may depend on.
    pub finished: bool,
}

impl Spent {
    /// An answer's sentence, with what has to be known before it.
    pub fn before(&self, sentence: &str) -> String {
        if self.finished {
            return sentence.to_owned();
        }
        format!("The search was ended by its time of {} and is not finished. So far: {sentence}", seconds(self.asked_s))
    }

    /// The sentence without what [`Self::before`] put before it: where many are told it is said once.
    pub(crate) fn bare<'a>(&self, sentence: &'a str) -> &'a str {
        sentence.strip_prefix(self.before("").as_str()).unwrap_or(sentence)
    }

    /// In a note: what was asked and used, and what was left out for it.
    pub fn words(&self) -> String {
        let [asked, used] = [self.asked_s, self.used_s].map(seconds);
        match (&*self.not_tried.join("; "), self.finished) {
            ("", _) => format!("Of the {asked} that --budget allows {used} were used; nothing was left out."),
            (what, true) => format!(
                "--budget allows {asked}, {used} were used. The search was finished; what was left out beside the answer: \
                 {what}."
            ),
            (what, false) => format!(
                "--budget allows {asked}, {used} were used. Not done, or not to the end, because of it: {what}. The answer may \
                 be another with more time."
            ),
        }
    }
}

/// Why an unfinished search states no probability.
pub const NO_PROBABILITY: &str =
    "the search was ended by its time, and how often such answers are right has not been counted";

fn seconds(time_s: f64) -> String {
    if time_s < 10.0 { format!("{time_s:.1} s") } else { format!("{time_s:.0} s") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_more_than_none_and_no_more_than_a_year() {
        assert_eq!(budget(0.5), Ok(Duration::from_millis(500)));
        assert_eq!(budget(365.25 * 86_400.0), Ok(LONGEST));
        for wrong in [0.0, -0.0, -1.0, f64::NAN, f64::INFINITY, 31_557_601.0, 1e19, 1e300] {
            assert_eq!(budget(wrong), Err(NoBudget), "{wrong}");
        }
        // What is more than any clock has is no panic.
        assert!(!Deadline::within(Duration::MAX).leaves_out("causes"));
    }

    #[test]
    fn without_a_limit_nothing_is_left_out() {
        let none = Deadline::default();
        assert!(!none.leaves_out("causes") && !none.cuts("fits") && !none.part(3).leaves_aside("next"));
        assert_eq!(none.spent(), None);
    }

    #[test]
    fn what_is_left_out_of_a_part_is_left_out_of_the_whole_and_makes_it_unfinished() {
        let whole = Deadline::within(Duration::ZERO);
        assert!(whole.leaves_aside("the next experiment"));
        let spent = whole.spent().unwrap();
        assert!(spent.finished && spent.before("q1: so.") == "q1: so.", "{spent:?}");
        let part = whole.part(4);
        assert!(part.leaves_out("pairs of causes"));
        assert_eq!(part.spent().unwrap().not_tried, ["pairs of causes"]);
        let spent = whole.spent().unwrap();
        assert_eq!(spent.not_tried, ["pairs of causes", "the next experiment"]);
        assert!(!spent.finished && spent.before("q1: so.").ends_with("is not finished. So far: q1: so."));
        assert!(spent.words().contains("pairs of causes; the next experiment"), "{}", spent.words());
    }

    #[test]
    fn a_part_has_its_share_of_what_is_left() {
        let whole = Deadline::within(Duration::from_secs(100));
        let share = rayon::current_num_threads() as f64 / 1e3;
        let until = |d: &Deadline| d.0.as_ref().unwrap().fits_until.saturating_duration_since(Instant::now());
        let part = until(&whole.part(1000)).as_secs_f64();
        assert!(part < 100.0 * share && part > 90.0 * share, "{part}");
        assert!(!whole.leaves_out("causes") && whole.spent().unwrap().finished);
    }
}
