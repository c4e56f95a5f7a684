//! What is other than described about a robot's bodies: a payload, a mass, a centre of mass.
//!
//! Each is linear in the torques of every joint that carries the body, so it is one column for all of them, fitted to the
//! logs of all at once beside each joint's own numbers. It is named where it explains what would otherwise be a coincidence
//! of several numbers, or causes joint by joint.

use super::case::TorqueCase;
use super::parameters::Estimated;
use super::search::{Choice, Found};
use super::signals::Motion;
use super::system::{Block, Solved, System, Unknown};
use crate::deadline::Deadline;
use crate::gap::Number;
use crate::gap::clamped::{BELIEVED, BODY_OPEN, BodyCause, BodyKind, BodyName, ClampedCaseError, ClampedSetup};
use crate::number::chance::HALF_95;
use crate::robot::description::{BodyChange, Description, LinkId};
use crate::robot::tree::{Tree, TreeBase};
use nalgebra::Vector3;
use rayon::prelude::*;

/// What is left out where these are not looked for.
pub(super) const BODIES: &str = "whether a body's mass is another than described";

/// What a body cause has to save beyond its price to be told: criteria are squares of standard deviations.
pub(super) const MARGIN: f64 = 16.0;
/// What an unknown costs, and a cause of a single joint.
const PRICE: f64 = 4.0;
const PRICE_OF_CAUSE: f64 = 8.0;
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
/// Steps of Gauss and Newton, and beside joints' causes, from where they end without.
const STEPS: usize = 8;
const STEPS_BESIDE: usize = 2;
/// So many bodies are tried beside joints' causes.
const BESIDE_CAUSES: usize = 3;
/// Of differences, in units of what is believed.
const NUDGE: f64 = 1e-3;
/// The least payload whose place is told, in such units.
const LEAST_PAYLOAD: f64 = 0.05;

/// A body that may be other than described.
#[derive(Clone, Debug)]
struct Hypothesis {
    kind: BodyKind,
    link: LinkId,
    /// From where a payload's place is counted, in the link's frame.
    origin_m: Vector3<f64>,
    /// Standard deviations of the unknowns.
    sd: Vec<f64>,
}

impl Hypothesis {
    /// What unknowns mean.
    fn change(&self, x: &[f64]) -> BodyChange {
        let vector = |x: &[f64]| Vector3::new(x[0], x[1], x[2]);
        match self.kind {
            BodyKind::Payload => BodyChange::Payload { mass_kg: x[0], place_m: self.origin_m + vector(&x[1..]) },
            BodyKind::BodyMass => BodyChange::Mass { factor: 1.0 + x[0] },
            BodyKind::BodyCom => BodyChange::Centre { shift_m: vector(x) },
        }
    }

    /// Where torques are made linear for unknowns near these: the place of no mass at all would not matter.
    fn linear_at(&self, x: &[f64]) -> Vec<f64> {
        let mut at = x.to_vec();
        if self.kind == BodyKind::Payload {
            at[0] = at[0].max(LEAST_PAYLOAD * self.sd[0]);
        }
        at
    }

    /// Bounds of the unknowns.
    fn bounds(&self, unknown: usize) -> [f64; 2] {
        match (self.kind, unknown) {
            (BodyKind::Payload, 0) => [0.0, f64::INFINITY],
            (BodyKind::BodyMass, _) => [-0.95, f64::INFINITY],
            _ => [f64::NEG_INFINITY, f64::INFINITY],
        }
    }
}

/// A hypothesis where it fits best.
struct Fitted {
    hypothesis: Hypothesis,
    x: Vec<f64>,
    /// The criterion with what its unknowns cost, and the causes beside it.
    priced: f64,
    numbers: Vec<Estimated>,
}

impl Fitted {
    /// Whether its 95 % interval leaves out a body as described. A payload's mass may be any where its place is open: that
    /// there is one shows in the criterion.
    fn is_told(&self) -> bool {
        let is_told = |number: &Estimated| number.value.abs() > HALF_95 * number.sd;
        match self.hypothesis.kind {
            BodyKind::Payload => true,
            BodyKind::BodyMass => self.numbers.first().is_some_and(is_told),
            BodyKind::BodyCom => self.numbers.iter().any(is_told),
        }
    }
}

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
        false => bench.fitted(hypothesis, None, &nothing, STEPS).map(Some),
    };
    let tried: Vec<Option<Fitted>> = asked.into_par_iter().map(in_time).collect::<Result<_, ClampedCaseError>>()?;
    let Some(mut tried) = tried.into_iter().collect::<Option<Vec<Fitted>>>() else { return Ok(Vec::new()) };
    tried.retain(|fitted| !bench.is_believed(fitted) && fitted.is_told());
    tried.sort_by(|a, b| a.priced.total_cmp(&b.priced));
    if own != nothing {
        tried.par_iter_mut().take(BESIDE_CAUSES).try_for_each(|fitted| {
            let beside = |choices: &[Choice]| {
                let beside = bench.fitted(fitted.hypothesis.clone(), Some(&fitted.x), choices, STEPS_BESIDE)?;
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
        let is_as_good = |other: &&Fitted| (other.priced - best.priced).abs() < 2.0 * PRICE;
        let name = |other: &Fitted| BodyName { kind: other.hypothesis.kind, body: bench.name(other.hypothesis.link) };
        let (own, others): (Vec<&Fitted>, Vec<&Fitted>) =
            tried.iter().filter(is_as_good).partition(|other| std::ptr::eq(*other, best));
        let as_good = own.into_iter().chain(others).map(name).collect();
        found.push(bench.cause(best, as_good, bare - best.priced));
    }
    Ok(found)
}

/// What causes of joints cost.
fn price(choices: &[Choice]) -> f64 {
    PRICE_OF_CAUSE * choices.iter().map(|choice| choice.causes.len()).sum::<usize>() as f64
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

/// What every hypothesis is tried on.
pub(super) struct Bench<'a> {
    setup: &'a ClampedSetup,
    case: &'a TorqueCase,
    founds: &'a [Found],
    motions: Vec<Motion>,
    /// Standard deviation of a sample of each joint, recalibrated \[N m\].
    sd_nm: Vec<f64>,
    /// Places of the case's joints among the tree's.
    places: Vec<usize>,
    /// Where friction holds a joint, by joint, log and sample: nothing is told there.
    masks: Vec<Vec<Vec<bool>>>,
}

/// Columns by unknown, log and joint.
pub(super) type Shared = Vec<Vec<Vec<Vec<f64>>>>;

impl<'a> Bench<'a> {
    pub fn new(setup: &'a ClampedSetup, case: &'a TorqueCase, founds: &'a [Found]) -> Result<Self, ClampedCaseError> {
        let tree = bare_tree(setup, &setup.description)?;
        let names: Vec<&str> = tree.joint_names().collect();
        let place = |name: &str| names.iter().position(|own| *own == name);
        let sd = |found: &Found| {
            let solved = found.fit(&Choice::default());
            let fitted = found.system.blocks.iter().filter(|block| block.is_fit);
            let (squares, samples) = fitted
                .fold((0.0, 0), |(sum, n), block| (sum + block.unit * block.squares(&solved.x), n + block.samples));
            (squares / samples.max(1) as f64).sqrt().max(f64::MIN_POSITIVE)
        };
        Ok(Self {
            setup,
            case,
            founds,
            motions: case.motions(setup, &tree),
            sd_nm: founds.iter().map(sd).collect(),
            masks: founds.iter().map(|found| found.design.is_held.clone()).collect(),
            places: case.joints.iter().filter_map(|joint| place(&joint.name)).collect(),
        })
    }

    fn name(&self, link: LinkId) -> String {
        self.setup.description.links[link.0].name.clone()
    }

    /// All joints as one problem, each with columns of its own, and shared ones behind them.
    pub fn system(&self, own: &dyn Fn(usize) -> Vec<usize>, shared: &Shared, unknowns: &[Unknown]) -> System {
        let own: Vec<Vec<usize>> = (0..self.founds.len()).map(own).collect();
        let count: usize = own.iter().map(Vec::len).sum();
        let (mut all, mut blocks, mut offset) = (Vec::new(), Vec::<Block>::new(), 0);
        for (joint, found) in self.founds.iter().enumerate() {
            let others = |i: usize, log: usize| {
                let unknown = i.checked_sub(count)?;
                shared.get(unknown)?[log].get(joint).map(Vec::as_slice).filter(|column| !column.is_empty())
            };
            let place = (&*own[joint], offset, count + unknowns.len());
            blocks.extend(found.design.blocks(&self.case.logs, place, &others, self.sd_nm[joint]));
            all.extend(own[joint].iter().map(|k| found.design.loosened(*k)));
            offset += own[joint].len();
        }
        all.extend(unknowns);
        System { unknowns: all, blocks }
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
        let all: Vec<usize> = (0..system.unknowns.len()).collect();
        system.criterion(&system.fit(&all, |block| block.is_fit))
    }

    /// Torques of the joints along the logs with a changed description.
    pub fn torques(&self, description: &Description) -> Result<Vec<Vec<Vec<f64>>>, ClampedCaseError> {
        let tree = bare_tree(self.setup, description)?;
        let of_log = |(log, motion): (usize, &Motion)| {
            let needed = motion.needed(&tree);
            let joint = |(joint, place): (usize, &usize)| {
                let mask = self.masks[joint].get(log).map_or(&[][..], Vec::as_slice);
                let raw = needed[*place].iter().enumerate();
                let torque: Vec<f64> =
                    raw.map(|(k, torque)| if mask.get(k) == Some(&true) { 0.0 } else { *torque }).collect();
                motion.grid.passed(&torque)
            };
            self.places.iter().enumerate().map(joint).collect()
        };
        Ok(self.motions.iter().enumerate().map(of_log).collect())
    }

    /// A hypothesis beside these causes of joints, from unknowns on that are near, or from a body as described.
    fn fitted(
        &self,
        hypothesis: Hypothesis,
        near: Option<&[f64]>,
        choices: &[Choice],
        steps: usize,
    ) -> Result<Fitted, ClampedCaseError> {
        let described = self.torques(&self.setup.description)?;
        let mut x = near.map_or_else(|| vec![0.0; hypothesis.sd.len()], <[f64]>::to_vec);
        let mut best: Option<(f64, Vec<Estimated>)> = None;
        for _ in 0..steps {
            let torques =
                |x: &[f64]| self.torques(&self.setup.description.with_change(hypothesis.link, &hypothesis.change(x)));
            let at = hypothesis.linear_at(&x);
            let here = torques(&at)?;
            let mut shared: Shared = Vec::new();
            for k in 0..x.len() {
                let mut there = at.clone();
                let step = NUDGE * hypothesis.sd[k];
                there[k] += step;
                shared.push(differences(&torques(&there)?, &here, step));
            }
            // What the change adds beyond its columns is taken as known.
            let beyond: Vec<Vec<Vec<f64>>> = here
                .iter()
                .zip(&described)
                .enumerate()
                .map(|(log, (here, described))| {
                    let joint = |joint: usize| {
                        let added = here[joint].iter().zip(&described[joint]).map(|(a, b)| a - b);
                        let told =
                            |s: usize| at.iter().zip(&shared).map(|(x, column)| x * column[log][joint][s]).sum::<f64>();
                        added.enumerate().map(|(s, added)| added - told(s)).collect()
                    };
                    (0..here.len()).map(joint).collect()
                })
                .collect();
            shared.push(beyond);
            let mut unknowns: Vec<Unknown> = hypothesis
                .sd
                .iter()
                .enumerate()
                .map(|(k, sd)| Unknown { sd: *sd, bounds: hypothesis.bounds(k) })
                .collect();
            // Its factor is one, and nobody may say otherwise.
            unknowns.push(Unknown { sd: 1.0, bounds: [1.0, 1.0] });
            let system = self.system(&|joint| choices[joint].columns(&self.founds[joint].design), &shared, &unknowns);
            let all: Vec<usize> = (0..system.unknowns.len()).collect();
            let first = all.len() - unknowns.len();
            let solved = system.fit(&all, |block| block.is_fit);
            // Less the one of the factor that is held.
            let criterion = system.criterion(&solved) - 1.0;
            x = (0..x.len()).map(|k| solved.x[first + k]).collect();
            let refits: Vec<Solved> = system.refits(&all);
            let numbers = (0..x.len()).map(|k| Estimated::new(first + k, &solved, &refits)).collect();
            best = Some((criterion, numbers));
            if x.len() == 1 {
                break;
            }
        }
        let (criterion, numbers) = best.expect("there is at least one step");
        let priced = criterion + PRICE * x.len() as f64 + price(choices);
        Ok(Fitted { hypothesis, x, priced, numbers })
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
            let is_told = estimated.sd < BODY_OPEN * sd[k];
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

/// Differences by log and joint, per step.
pub(super) fn differences(there: &[Vec<Vec<f64>>], here: &[Vec<Vec<f64>>], step: f64) -> Vec<Vec<Vec<f64>>> {
    let column = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| (a - b) / step).collect();
    there.iter().zip(here).map(|(there, here)| there.iter().zip(here).map(column).collect()).collect()
}

fn bare_tree(setup: &ClampedSetup, description: &Description) -> Result<Tree, ClampedCaseError> {
    let bare = super::signals::without_armature(description);
    let of_tree = |source| ClampedCaseError::Tree { file: setup.study.model_path.clone(), source };
    Ok(Tree::new(&bare, TreeBase::Fixed).map_err(of_tree)?.with_gravity(setup.tree.gravity_m_s2()))
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
