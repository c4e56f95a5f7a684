//! TEMPORARY: stands in for the diagnosis until that is there. Answers at random.

use super::dice::Dice;
use crate::gap::*;
use crate::identify::Case;
use crate::joint::EffectId;

/// A random answer.
pub fn diagnose(case: &Case, options: &GapOptions, progress: &(dyn Fn(&str) + Sync)) -> Result<Diagnosis, String> {
    progress("guessing");
    let samples: usize = case.items.iter().map(|item| item.log.len()).sum();
    let mut dice = Dice::new(options.seed, samples as u64);
    let effect = dice.pick(EffectId::ALL);
    let verdict =
        dice.pick(&[Verdict::Effect, Verdict::Effect, Verdict::None, Verdict::Calibration, Verdict::Unexplained]);
    let named = verdict == Verdict::Effect;
    Ok(Diagnosis {
        joint: case.joint.name.clone(),
        answer: Answer {
            verdict,
            effect: named.then(|| effect.id().to_owned()),
            second: None,
            equivalent: if named { vec![effect] } else { vec![] },
            probability: dice.uniform(0.0, 1.0),
            probability_source: String::new(),
            sentence: String::new(),
            partial: None,
            intervals_trusted: true,
        },
        location: Where {
            stage: named.then(|| effect.stage()),
            variable: None,
            range: None,
            phase: None,
            logs: vec![],
            share: 0.0,
            cells: vec![],
            variables: vec![],
            profile: vec![],
        },
        gap: Gap {
            unit: "rad",
            before: 0.0,
            calibrated: 0.0,
            after_first: 0.0,
            after: 0.0,
            floor: 0.0,
            closed: None,
            closed_interval: None,
            held_out: String::new(),
            per_log: vec![],
        },
        ranking: vec![],
        detectable: vec![],
        parameters: vec![],
        effect_parameters: vec![],
        next: None,
        confusion: None,
        traces: vec![],
        notes: vec![],
        withheld: vec![],
    })
}
