//! The report of trials made by hand.

use super::*;
use crate::blind::{
    Answered, Believed, Family, FourNumbers, GapNumbers, Noise, Stamps, TrueMechanism, TrueNumber, Truth, score,
};
use crate::gap::Verdict;
use crate::joint::EffectId;

fn truth(trial: u64, verdict: Verdict, effect: Option<EffectId>) -> Truth {
    let numbers = FourNumbers { inertia: 1.0, moment: 2.0, coulomb: 3.0, viscous: 4.0 };
    let mechanism = |effect: EffectId| TrueMechanism {
        id: effect.id(),
        counts: true,
        stage: effect.stage(),
        parameters: vec![TrueNumber { name: "T", unit: "s", value: 0.01 }],
        ratio: 12.0,
        left: 8.0,
    };
    Truth {
        seed: 7,
        trial,
        verdict,
        causes: effect.into_iter().collect(),
        servo: false,
        numbers: vec![],
        within: false,
        outside: None,
        location: None,
        stage: effect.map(EffectId::stage),
        mechanisms: effect.map(mechanism).into_iter().collect(),
        ratio: 12.0,
        left: 8.0,
        nearest: None,
        joint: numbers,
        nominal: numbers,
        gains: None,
        nominal_gains: None,
        believed: Believed { inertia: 0.1, moment: 0.05, friction: 0.5, gain: 0.1, written: false },
        family: Family::Leg,
        textbook: true,
        noise: Noise::Rounding,
        stamps: Stamps::Regular,
        holes: 0,
        noise_rad: 1e-3,
        free_logs: 4,
        driven_logs: 2,
        loaded_logs: 1,
    }
}

fn answered(verdict: Verdict, effect: Option<EffectId>, probability: f64) -> Answered {
    Answered {
        verdict,
        effect: effect.map(|effect| effect.id().to_owned()),
        causes: effect.into_iter().collect(),
        equivalent: effect.into_iter().chain([EffectId::MotorGain]).collect(),
        probability,
        standing: String::new(),
        partial: None,
        intervals_trusted: true,
        stage: effect.map(EffectId::stage),
        variable: None,
        range: None,
        gap: GapNumbers {
            before: 0.03,
            calibrated: 0.02,
            after_first: 0.002,
            after: 0.002,
            floor: 0.002,
            closed: None,
            closed_interval: None,
        },
        ranking: vec![],
        effects: vec![],
        joint: vec![],
    }
}

fn report(trials: Vec<Trial>) -> BlindReport {
    BlindReport {
        seed: 7,
        sha256: "cafe".to_owned(),
        seal_holds: true,
        score: score(&trials),
        trials,
        provenance: Provenance { version: "1".to_owned(), command: "aibo-fit blind <b>".to_owned(), inputs: vec![] },
    }
}

fn some() -> BlindReport {
    let delay = Some(EffectId::Delay);
    let trial = |truth, answer| Trial { truth, answer, wall_s: 0.5 };
    report(vec![
        trial(truth(0, Verdict::Effect, delay), Ok(answered(Verdict::Effect, delay, 0.9))),
        trial(truth(1, Verdict::Effect, delay), Ok(answered(Verdict::Calibration, None, 0.6))),
        trial(truth(2, Verdict::None, None), Ok(answered(Verdict::None, None, 0.97))),
        trial(truth(3, Verdict::None, None), Err("log-00.csv: cannot be read".to_owned())),
    ])
}

#[test]
fn text_says_how_often_answers_were_right_and_what_was_taken_for_what() {
    let text = blind_text(&some());
    for words in [
        "4 studies, seed 7; answers opened: SHA-256 cafe, as stated before the first diagnosis.",
        "2 of 4 answers were wholly right (50 %); 0 false alarms in 2 studies without an effect (below 78 %",
        "1 delay",
        "calibration (1)",
        "diagnoses that failed: 1",
        "3 to 10 times the noise",
    ] {
        assert!(text.contains(words), "no `{words}` in\n{text}");
    }
    let broken = BlindReport { seal_holds: false, ..some() };
    assert!(blind_text(&broken).contains("NOT WHAT WAS SEALED"));
}

#[test]
fn page_needs_no_network_and_escapes_texts() {
    let page = blind_html(&some()).expect("a page");
    crate::report::html::tests::is_alone(&page);
    assert!(!page.contains("href="));
    assert!(page.contains("aibo-fit blind &lt;b&gt;") && page.contains("failed: log-00.csv: cannot be read"));
    assert!(page.contains("delay (or motor_gain)"));
    assert_eq!(page, blind_html(&some()).expect("a page"), "same report, same bytes");
}

#[test]
fn a_report_of_nothing_is_still_a_report() {
    let nothing = report(vec![]);
    assert!(blind_html(&nothing).expect("a page").contains("</html>"));
    assert!(blind_text(&nothing).contains("no study without an effect"));
}

#[test]
fn figures_are_whole_svg_documents() {
    for figure in blind_figures(&some()).expect("figures") {
        let svg = roxmltree::Document::parse(&figure.svg).expect("well formed");
        assert_eq!(svg.root_element().tag_name().name(), "svg");
    }
}
