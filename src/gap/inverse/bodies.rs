//! What is other than described about a robot's bodies: a payload, a mass, a centre of mass.
//!
//! Each is linear in the torques of every joint that carries the body, so it is one column for all of them, fitted to the
//! logs of all at once beside each joint's own numbers. It is named where it explains what would otherwise be a coincidence
//! of several numbers, or causes joint by joint.

use super::bench::Bench;
use super::body_fit::{Fitted, Hypothesis, PRICE, price};
use super::case::TorqueCase;
use super::search::{Choice, Found};
use crate::deadline::Deadline;
use crate::gap::Number;
use crate::gap::clamped::{BELIEVED, BODY_OPEN, BodyCause, BodyKind, BodyName, ClampedCaseError, ClampedSetup};
use crate::number::chance::HALF_95;
use crate::robot::description::LinkId;
use nalgebra::Vector3;
use rayon::prelude::*;

/// What is left out where these are not looked for.
pub(super) const BODIES: &str = "whether a body's mass is another than described";

/// What a body cause has to save beyond its price to be told: criteria are squares of standard deviations.
pub(super) const MARGIN: f64 = 16.0;
/// Standard deviations before a log is seen: of a payload as a share of what the robot moves, of a body's share; of a centre
/// of mass and of a payload's place as shares of the centre's distance from the link's origin, and at least \[m\].
const MASS_SHARE: f64 = 0.5;
const BODY_SHARE: f64 = 0.5;
const CENTRE_SD_SHARE: f64 = 0.1;
const LEAST_CENTRE_M: f64 = 0.005;
const PLACE_SHARE: f64 = 1.0;
const LEAST_PLACE_M: f64 = 0.05;
/// Standard deviation of a centre that is as believed, as a share of its distance.
const CENTRE_SHARE: f64 = 0.02;
/// So many bodies are tried beside joints' causes.
const BESIDE_CAUSES: usize = 3;

/// The body cause of each kind that explains most, and a payload on the tip, of those that save at least so much; best first.
/// `founds` are the joints' own answers, in the case's order; bodies that are `taken` were changed already, kinds `without` are
/// withheld.
pub(super) fn find(
    setup: &ClampedSetup,
    case: &TorqueCase,
    founds: &[Found],
    taken: &[LinkId],
    without: &[BodyKind],
    least: f64,
    deadline: &Deadline,
) -> Result<Vec<BodyCause>, ClampedCaseError> {
    let bench = Bench::new(setup, case, founds)?;
    let nothing = vec![Choice::default(); founds.len()];
    let own: Vec<Choice> = founds.iter().map(|found| Choice { curve: None, ..found.choice() }).collect();
    let without_body = |choices: &[Choice]| Ok((bench.criterion(choices) + price(choices), ()));
    let bare = without_body(&nothing)?.0.min(pruned(own.clone(), &without_body)?.0);
    let is_asked = |h: &Hypothesis| !taken.contains(&h.link) && !without.contains(&h.kind);
    let asked: Vec<Hypothesis> = hypotheses(setup).into_iter().filter(is_asked).collect();
    let in_time = |hypothesis: Hypothesis| match deadline.leaves_out(BODIES) {
        true => Ok(None),
        false => bench.fitted(hypothesis, None, &nothing).map(Some),
    };
    let tried: Vec<Option<Fitted>> = asked.into_par_iter().map(in_time).collect::<Result<_, ClampedCaseError>>()?;
    let Some(mut tried) = tried.into_iter().collect::<Option<Vec<Fitted>>>() else { return Ok(Vec::new()) };
    tried.retain(|fitted| !bench.is_believed(fitted) && fitted.is_told());
    tried.sort_by(|a, b| a.priced.total_cmp(&b.priced));
    if own != nothing {
        tried.par_iter_mut().take(BESIDE_CAUSES).try_for_each(|fitted| {
            let beside = |choices: &[Choice]| {
                let beside = bench.fitted(fitted.hypothesis.clone(), Some(&fitted.x), choices)?;
                Ok((beside.priced, beside))
            };
            let (priced, beside) = pruned(own.clone(), &beside)?;
            if priced < fitted.priced && !bench.is_believed(&beside) && beside.is_told() {
                *fitted = beside;
            }
            Ok::<(), ClampedCaseError>(())
        })?;
        tried.sort_by(|a, b| a.priced.total_cmp(&b.priced));
    }
    let (mut kinds, tip): (Vec<BodyKind>, _) = (Vec::new(), tip(setup));
    let mut found = Vec::new();
    for best in tried.iter().take_while(|fitted| bare - fitted.priced >= least) {
        let Hypothesis { kind, link, .. } = best.hypothesis;
        let is_at_tip = kind == BodyKind::Payload && Some(link) == tip;
        if kinds.contains(&kind) && !is_at_tip {
            continue;
        }
        kinds.push(kind);
        let is_one =
            |other: &Fitted| is_one_payload(setup, (kind, link), (other.hypothesis.kind, other.hypothesis.link));
        let is_as_good = |other: &&Fitted| {
            std::ptr::eq(*other, best) || (other.priced - best.priced).abs() < 2.0 * PRICE && !is_one(other)
        };
        let name = |other: &Fitted| BodyName { kind: other.hypothesis.kind, body: bench.name(other.hypothesis.link) };
        let (own, others): (Vec<&Fitted>, Vec<&Fitted>) =
            tried.iter().filter(is_as_good).partition(|other| std::ptr::eq(*other, best));
        let as_good = own.into_iter().chain(others).map(name).collect();
        found.push(bench.cause(best, as_good, bare - best.priced));
    }
    Ok(found)
}

/// Whether two bodies are one payload, on links that are fixed to one another.
pub(super) fn is_one_payload(setup: &ClampedSetup, one: (BodyKind, LinkId), other: (BodyKind, LinkId)) -> bool {
    let carriers = |link| setup.description.carriers(link);
    [one.0, other.0] == [BodyKind::Payload; 2] && carriers(one.1) == carriers(other.1)
}

/// What causes of joints come to with their price, and what is told of them there.
type Priced<'a, T> = &'a dyn Fn(&[Choice]) -> Result<(f64, T), ClampedCaseError>;

/// The joints' causes without those that cost more than they save, one after the other, with what is told of them there.
fn pruned<T>(mut choices: Vec<Choice>, tried: Priced<'_, T>) -> Result<(f64, T), ClampedCaseError> {
    let mut best = tried(&choices)?;
    loop {
        let mut better = None;
        for joint in 0..choices.len() {
            for &family in &choices[joint].causes {
                let mut less = choices.clone();
                less[joint] = less[joint].without(family);
                let found = tried(&less)?;
                if found.0 < best.0 {
                    (best, better) = (found, Some(less));
                }
            }
        }
        match better {
            Some(less) => choices = less,
            None => return Ok(best),
        }
    }
}

impl Bench<'_> {
    fn name(&self, link: LinkId) -> String {
        self.setup.description.links[link.0].name.clone()
    }

    /// Whether a body is within three standard deviations of what the study believes of it.
    fn is_believed(&self, fitted: &Fitted) -> bool {
        let Hypothesis { kind, link, .. } = fitted.hypothesis;
        let inertia = &self.setup.description.links[link.0].inertia;
        let carrier = self.setup.description.carriers(link).last().map(|joint| joint.0);
        let name = carrier.map_or("", |joint| &self.setup.description.joints[joint].name);
        let sd = BELIEVED * self.setup.study.uncertain.mass.of(name);
        match kind {
            // A small mass far from the body's centre is more than the body may be heavier.
            BodyKind::Payload => {
                let place_m = Vector3::from_row_slice(&fitted.x[1..]).norm();
                let moved_m = (BELIEVED * CENTRE_SHARE * inertia.centre_m().norm()).max(LEAST_CENTRE_M);
                let is_small = fitted.x[0] < sd * inertia.mass_kg && fitted.x[0] * place_m < moved_m * inertia.mass_kg;
                is_small || fitted.x[0] <= 0.0
            }
            BodyKind::BodyMass => fitted.x[0].abs() < sd,
            BodyKind::BodyCom => {
                Vector3::from_row_slice(&fitted.x).norm() < BELIEVED * CENTRE_SHARE * inertia.centre_m().norm()
            }
        }
    }

    fn criterion(&self, choices: &[Choice]) -> f64 {
        let system = self.system(&|joint| choices[joint].columns(&self.founds[joint].design), &Vec::new(), &[]);
        system.criterion(&system.fit(&system.all(), |block| block.is_fit))
    }

    fn cause(&self, fitted: &Fitted, as_good: Vec<BodyName>, saved: f64) -> BodyCause {
        let Hypothesis { kind, link, sd, .. } = &fitted.hypothesis;
        let described = &self.setup.description.links[link.0];
        let number = |name: &str, unit: &str, k: usize, offset: f64, scale: f64| {
            let estimated = fitted.numbers[k];
            let least = if unit == "kg" { 0.0 } else { f64::NEG_INFINITY };
            let around = |sd: f64| {
                [-1.0, 1.0].map(|side| (offset + scale * estimated.value + side * HALF_95 * scale * sd).max(least))
            };
            let is_told = estimated.sd < BODY_OPEN * sd[k] && !estimated.is_held();
            Number {
                name: name.to_owned(),
                value: offset + scale * estimated.value,
                unit: unit.to_owned(),
                interval: is_told.then(|| around(estimated.sd)),
                interval_naive: is_told.then(|| around(estimated.naive_sd)),
            }
        };
        let origin = &fitted.hypothesis.origin_m;
        let centre = described.inertia.centre_m();
        let mass_kg = described.inertia.mass_kg;
        let parameters = match kind {
            BodyKind::Payload => vec![
                number("mass", "kg", 0, 0.0, 1.0),
                number("x", "m", 1, origin.x, 1.0),
                number("y", "m", 2, origin.y, 1.0),
                number("z", "m", 3, origin.z, 1.0),
            ],
            BodyKind::BodyMass => vec![number("mass", "kg", 0, mass_kg, mass_kg)],
            BodyKind::BodyCom => vec![
                number("x", "m", 0, centre.x, 1.0),
                number("y", "m", 1, centre.y, 1.0),
                number("z", "m", 2, centre.z, 1.0),
            ],
        };
        let carriers = self.setup.description.carriers(*link);
        let joints = carriers.iter().map(|joint| self.setup.description.joints[joint.0].name.clone());
        let diagnosed = |name: &String| self.case.joints.iter().any(|joint| joint.name == *name);
        BodyCause {
            kind: *kind,
            body: described.name.clone(),
            link: *link,
            change: fitted.hypothesis.change(&fitted.x),
            joints: joints.filter(diagnosed).collect(),
            parameters,
            saved,
            equivalent: as_good,
        }
    }
}

/// Where a payload hangs most often: the study's tip, or the robot's.
fn tip(setup: &ClampedSetup) -> Option<LinkId> {
    let robot = &setup.description;
    let named = setup.study.tip.as_ref().and_then(|tip| robot.link(tip));
    named.or_else(|| robot.tip())
}

/// Bodies that may be other than described: the heaviest link of each that moves, and the tip.
fn hypotheses(setup: &ClampedSetup) -> Vec<Hypothesis> {
    let robot = &setup.description;
    let moved_kg: f64 = (0..robot.links.len())
        .filter(|k| !robot.carriers(LinkId(*k)).is_empty())
        .map(|k| robot.links[k].inertia.mass_kg)
        .sum();
    let heaviest = robot.heaviest();
    let tip = tip(setup);
    let mut all = Vec::new();
    for link in heaviest.iter().copied().chain(tip) {
        let centre = robot.links[link.0].inertia.centre_m();
        let place_m = (PLACE_SHARE * centre.norm()).max(LEAST_PLACE_M);
        let centre_m = (CENTRE_SD_SHARE * centre.norm()).max(LEAST_CENTRE_M);
        let is_tip = Some(link) == tip;
        if is_tip || heaviest.contains(&link) {
            let sd = [MASS_SHARE * moved_kg, place_m, place_m, place_m].to_vec();
            all.push(Hypothesis { kind: BodyKind::Payload, link, origin_m: centre, sd });
        }
        if robot.links[link.0].inertia.mass_kg > 0.0 {
            let bodies = [(BodyKind::BodyMass, vec![BODY_SHARE]), (BodyKind::BodyCom, vec![centre_m; 3])];
            all.extend(bodies.map(|(kind, sd)| Hypothesis { kind, link, origin_m: centre, sd }));
        }
    }
    // The tip may be the heaviest of its body already.
    let mut seen: Vec<(BodyKind, LinkId)> = Vec::new();
    all.retain(|hypothesis| {
        let own = (hypothesis.kind, hypothesis.link);
        let is_new = !seen.contains(&own);
        seen.push(own);
        is_new
    });
    all
}

#[cfg(test)]
mod tests {
    use super::super::body_fit::PRICE_OF_CAUSE;
    use super::*;

    #[test]
    fn causes_that_save_less_than_they_cost_go() {
        let causes = |of: &[&[usize]]| -> Vec<Choice> {
            of.iter().map(|own| Choice { causes: own.to_vec(), curve: None }).collect()
        };
        // Beside the body one of three causes still saves anything.
        let criterion = |choices: &[Choice]| if choices[1].causes.contains(&7) { 60.0 } else { 100.0 };
        let tried = |choices: &[Choice]| Ok((criterion(choices) + price(choices), choices.to_vec()));
        let (priced, kept) = pruned(causes(&[&[3, 5], &[7]]), &tried).unwrap();
        assert_eq!(kept, causes(&[&[], &[7]]));
        assert_eq!(priced, 60.0 + PRICE_OF_CAUSE);
    }
}
