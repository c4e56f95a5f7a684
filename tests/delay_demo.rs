//! The demonstration of docs/gallery/delay.md: a pendulum whose setpoints act 16 ms late, which the study does not know, ten
//! times with fresh readings. The logs come from data/examples/make.py, which shares nothing with the program.

mod support;

use aibo_fit::gap::{GapOptions, Verdict, diagnose};
use aibo_fit::identify::Case;
use aibo_fit::progress::Silent;
use support::root;

/// What make.py has.
const TRUTH: [(&str, f64); 4] = [("inertia", 0.011), ("moment", 0.05), ("coulomb", 0.02), ("viscous", 0.03)];
const DELAY_S: f64 = 0.016;

#[test]
#[ignore = "slow: ten diagnoses; see docs/gallery/delay.md"]
fn a_delay_is_named_and_its_intervals_cover_the_truth() {
    let examples = root().join("data/examples/delay");
    let text = std::fs::read_to_string(examples.join("study.toml")).expect("the study is there");
    let folder = tempfile::tempdir().expect("a folder");
    let (mut named, mut covered, mut asked) = (0, 0, 0);
    for run in 0..10 {
        let log = format!("chirp-{run}.csv");
        std::fs::copy(examples.join(&log), folder.path().join(&log)).expect("the log is there");
        let study = folder.path().join("study.toml");
        std::fs::write(&study, text.replace("chirp-0.csv", &log)).expect("writable");
        let case = Case::of_study(&study).expect("a good study");
        let found = diagnose(&case, &GapOptions::default(), &Silent).expect("a diagnosis");
        let answer = &found.answer;
        named += u32::from(answer.verdict == Verdict::Effect && answer.effect.as_deref() == Some("delay"));
        let mut cover = |interval: Option<[f64; 2]>, truth: f64| {
            let [low, high] = interval.expect("determined");
            asked += 1;
            covered += u32::from(low <= truth && truth <= high);
        };
        let (_, delay) = &found.effect_parameters[0];
        cover(delay[0].interval, DELAY_S);
        for (name, truth) in TRUTH {
            let estimate = found.parameters.iter().find(|e| e.name == name).expect("one of the four");
            cover(estimate.interval, truth);
        }
    }
    println!("delay named in {named} of 10 runs; 95 % intervals cover the truth in {covered} of {asked}");
    assert_eq!(named, 10);
    assert!(covered * 100 >= asked * 88, "{covered} of {asked}");
}
