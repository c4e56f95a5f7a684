//! Probabilities in whole percent: of an answer, of what does as well as it, of something else. As printed they make 100 %,
//! wherever they stand.

use super::number::{UNKNOWN, share, whole_percents};

/// Computed probabilities above this are called so: noise that is not as it is taken to be leaves no certainty.
const NEARLY_CERTAIN: f64 = 0.99;

/// The probability with which an experiment would decide.
pub(in crate::report) fn power(power: f64) -> String {
    match power {
        p if !p.is_finite() => UNKNOWN.to_owned(),
        p if p > NEARLY_CERTAIN => "over 99 %".to_owned(),
        p => share(p),
    }
}

/// Of what may be the answer, or a part of it.
pub(in crate::report) struct Candidate {
    /// As the ranking names it.
    pub name: String,
    /// Its own.
    pub probability: f64,
    /// Whether the answer names it, or cannot tell it from what it names.
    pub is_named: bool,
}

/// Probabilities as they are shown.
pub(in crate::report) struct Chances {
    /// Of the answer, with all that cannot be told apart from it.
    pub answer: String,
    /// Of each candidate, in the order of the ranking; with that of something else 100 %.
    pub candidates: Vec<String>,
    /// Of something else.
    pub rest: String,
    /// Whether any candidate has a part of it.
    pub is_shared_out: bool,
    /// Whether there is any.
    is_stated: bool,
    /// What the answer's probability is shared out among, where that are several, and those beside it.
    among: Vec<String>,
    beside: Vec<String>,
}

/// Probabilities that are the same up to rounding.
const SAME: f64 = 1e-9;

impl Chances {
    /// Of an answer's probability, where one is stated, and its candidates'.
    ///
    /// Candidates that are named share the answer's, where together they have it; where they do not, it is that of the one
    /// that has it all, and the others are beside it.
    pub fn of(answer: Option<f64>, candidates: &[Candidate]) -> Self {
        let Some(answer) = answer else {
            return Self {
                answer: "not stated".to_owned(),
                candidates: vec!["-".to_owned(); candidates.len()],
                rest: "-".to_owned(),
                is_shared_out: false,
                among: Vec::new(),
                beside: Vec::new(),
                is_stated: false,
            };
        };
        let has_part = |candidate: &Candidate| candidate.probability > 0.0;
        let named: f64 = candidates.iter().filter(|of| of.is_named).map(|of| of.probability).sum();
        let are_all = (named - answer).abs() < SAME;
        let alone = candidates.iter().position(|of| of.is_named && (of.probability - answer).abs() < SAME);
        let is_answer = |k: usize| {
            let is_own = alone.filter(|_| !are_all).is_none_or(|alone| alone == k);
            candidates[k].is_named && has_part(&candidates[k]) && is_own
        };
        let (own, others): (Vec<usize>, Vec<usize>) = (0..candidates.len()).partition(|k| is_answer(*k));
        let beside: f64 = others.iter().map(|k| candidates[*k].probability).sum();
        let parts = others.iter().map(|k| candidates[*k].probability);
        let parts: Vec<f64> = [answer, 1.0 - answer - beside].into_iter().chain(parts).collect();
        let whole = whole_percents(&parts, 100);
        let mut percents = vec![0; candidates.len()];
        others.iter().zip(&whole[2..]).for_each(|(k, percent)| percents[*k] = *percent);
        let shared: Vec<f64> = own.iter().map(|k| candidates[*k].probability).collect();
        own.iter().zip(whole_percents(&shared, whole[0])).for_each(|(k, percent)| percents[*k] = percent);
        let said = |k: &usize| format!("{} {} %", candidates[*k].name, percents[*k]);
        Self {
            answer: format!("{} %", whole[0]),
            rest: format!("{} %", whole[1]),
            is_shared_out: candidates.iter().any(has_part),
            is_stated: true,
            among: if own.len() > 1 { own.iter().map(said).collect() } else { Vec::new() },
            beside: others.iter().filter(|k| percents[**k] > 0).map(said).collect(),
            candidates: percents.iter().map(|percent| format!("{percent} %")).collect(),
        }
    }

    /// `69 % (angle_offset 35 %, joint_spring 34 %), of something else 31 %`
    pub fn words(&self) -> String {
        if !self.is_stated {
            return self.answer.clone();
        }
        let among = if self.among.is_empty() { String::new() } else { format!(" ({})", self.among.join(", ")) };
        let beside: String = self.beside.iter().map(|said| format!(", of {said}")).collect();
        format!("{}{among}{beside}, of something else {}", self.answer, self.rest)
    }
}

/// An answer's probability in whole percent, as text and page have it: `69 %`.
pub fn percent_of_answer(probability: f64) -> String {
    Chances::of(Some(probability), &[]).answer
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn number(percent: &str) -> u32 {
        percent.trim_end_matches(" %").parse().expect("a whole percentage")
    }

    fn candidates(of: &[(&str, f64, bool)]) -> Vec<Candidate> {
        let candidate = |(name, probability, is_named): &(&str, f64, bool)| Candidate {
            name: (*name).to_owned(),
            probability: *probability,
            is_named: *is_named,
        };
        of.iter().map(candidate).collect()
    }

    #[test]
    fn no_experiment_is_certain_to_decide() {
        let said = [0.734, 0.9895, 0.9912, 1.0, f64::NAN].map(power);
        assert_eq!(said, ["73 %", "99 %", "over 99 %", "over 99 %", UNKNOWN]);
    }

    #[test]
    fn those_that_cannot_be_told_apart_share_the_answers_probability() {
        let of = |answer: f64, all: &[(&str, f64, bool)]| Chances::of(Some(answer), &candidates(all));
        let unfinished = Chances::of(None, &candidates(&[("delay", 0.0, true)]));
        assert_eq!((unfinished.words().as_str(), &*unfinished.candidates[0]), ("not stated", "-"));
        let two = of(0.75, &[("delay", 0.375, true), ("hold", 0.375, true), ("play", 0.0, false)]);
        assert_eq!(two.words(), "75 % (delay 38 %, hold 37 %), of something else 25 %");
        assert_eq!(two.candidates, ["38 %", "37 %", "0 %"]);
        let one = of(0.755, &[("delay", 0.755, true)]);
        assert_eq!((one.words().as_str(), one.is_shared_out), ("76 %, of something else 24 %", true));
        let none = of(0.4667, &[("delay", 0.0, true)]);
        assert_eq!((none.words().as_str(), none.is_shared_out), ("47 %, of something else 53 %", false));
        assert_eq!(percent_of_answer(0.755), "76 %");
    }

    #[test]
    fn rivals_with_a_probability_of_their_own_stand_beside_the_answer() {
        let all = candidates(&[("drag", 0.905, true), ("play", 0.055, true), ("gain", 0.02, false)]);
        let shown = Chances::of(Some(0.905), &all);
        assert_eq!(shown.words(), "91 %, of play 5 %, of gain 2 %, of something else 2 %");
        assert_eq!(shown.candidates, ["91 %", "5 %", "2 %"]);
    }

    proptest! {
        #[test]
        fn what_is_printed_adds_up(answer in 0.0..=1.0f64, among in 1..9usize, beside in 0.0..1.0f64) {
            let part = answer / among as f64;
            let mut all: Vec<_> = (0..among).map(|k| (if k > 0 { "b" } else { "a" }, part, true)).collect();
            all.push(("c", beside * (1.0 - answer), false));
            let shown = Chances::of(Some(answer), &candidates(&all));
            let [all, rest] = [shown.candidates.iter().map(|of| number(of)).sum::<u32>(), number(&shown.rest)];
            prop_assert_eq!(all + rest, 100);
            let own: u32 = shown.candidates[..among].iter().map(|of| number(of)).sum();
            prop_assert_eq!(own, number(&shown.answer));
        }
    }
}
