//! Masses of a robot's bodies within what the study believes of them: what the torques of all joints ask for at once.
//!
//! A joint's own inertia and moment say what it carries, but not what the joints push one another with: that is linear in the
//! masses of single bodies, which no joint tells alone. Here they are unknowns that all joints share, beside each joint's
//! friction, gain and causes, but instead of its inertia and moment.

use super::bench::{Bench, differences};
use super::case::TorqueCase;
use super::diagnose::{TorqueError, searched};
use super::numbers::Which;
use super::parameters::Estimated;
use super::search::{Choice, Found};
use super::system::{Block, System, Unknown};
use crate::gap::GapOptions;
use crate::gap::clamped::{BELIEVED, ClampedCase, ClampedCaseError, ClampedSetup};
use crate::gap::hypothesis::evidence::WholeLeft;
use crate::gap::verdict::recalibrated::Refitted;
use crate::gap::whole::{Settled, as_stated_at_best};
use crate::number::chance::HALF_95;
use crate::number::math;
use crate::progress::{Progress, Step};
use crate::robot::description::{BodyChange, FoundKey, FoundNumber, LinkId};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// What of their errors recalibrated joints have to leave on average with masses that all of them ask for.
const WORTH_WEIGHING: f64 = 0.98;
/// What is left out where these are not looked for.
const MASSES: &str = "masses that all joints ask for";
/// Share of a mass by which its column is told: it is linear.
const NUDGE: f64 = 0.01;
/// A mass is not below this share of what is described.
const LEAST: f64 = 0.05;
/// Times that logs are weighed by what they leave.
const SETTLES: usize = 4;

/// The case of a robot, with masses that all joints ask for where recalibrated joints predict better so.
pub(super) fn weighed_case(
    setup: &ClampedSetup,
    options: &GapOptions,
    progress: &dyn Progress,
) -> Result<(ClampedCase, Vec<FoundNumber>), TorqueError> {
    let described = ClampedCase::of(setup)?;
    if options.deadline.leaves_out(MASSES) {
        return Ok((described, Vec::new()));
    }
    progress.go_on(Step::stage(MASSES))?;
    let left = |case: &ClampedCase| -> Vec<Option<f64>> {
        case.joints.par_iter().map(|joint| Some(Refitted::of(&joint.case, options)?.left_rad)).collect()
    };
    let left_as_described = left(&described);
    let share = |case: &ClampedCase| mean_share(&left(case), &left_as_described);
    let whole = as_stated_at_best(setup, &options.deadline);
    let along = |whole: &Settled| Ok::<_, ClampedCaseError>((ClampedCase::settled(setup, whole)?, whole.masses()));
    // Of an arm that is not as it is simulated, masses bend to what is missing.
    let leaves_no_more = |whole: &&Settled| {
        let left: Vec<Option<f64>> = described.joints.iter().map(|joint| whole.left_rad(&joint.name)).collect();
        mean_share(&left, &left_as_described) <= 1.0
    };
    let at_best = whole.as_ref().filter(leaves_no_more);
    let rivals = [by_torques(setup, options)?, at_best.map(along).transpose()?];
    let tried = rivals.into_iter().flatten().map(|(case, masses)| (share(&case), case, masses));
    let best = tried.filter(|(share, ..)| *share < WORTH_WEIGHING).min_by(|a, b| a.0.total_cmp(&b.0));
    let (mut case, masses) = match best {
        None => (described, Vec::new()),
        Some((_, mut case, masses)) => {
            let are_other = masses.iter().any(FoundNumber::is_other);
            for (joint, described) in case.joints.iter_mut().zip(described.joints) {
                joint.as_described = Some(described.case);
                joint.has_bodies = are_other;
            }
            (case, masses)
        }
    };
    for joint in &mut case.joints {
        let left_rad = whole.as_ref().and_then(|whole| whole.left_rad(&joint.name));
        joint.whole = left_rad.map(|rad| WholeLeft { bare_rad: rad, found_rad: rad });
    }
    Ok((case, masses))
}

/// What joints leave of what they left, as a geometric mean over those that both know.
pub(super) fn mean_share(left: &[Option<f64>], of: &[Option<f64>]) -> f64 {
    let ratios: Vec<f64> = left.iter().zip(of).filter_map(|(left, of)| Some(math::ln((*left)? / (*of)?))).collect();
    math::exp(ratios.iter().sum::<f64>() / ratios.len().max(1) as f64)
}

/// The case with masses that torques along the measured motion ask for.
fn by_torques(
    setup: &ClampedSetup,
    options: &GapOptions,
) -> Result<Option<(ClampedCase, Vec<FoundNumber>)>, TorqueError> {
    let commanded = TorqueCase::commanded(setup, &BTreeMap::new())?;
    let (_, founds, moving) = searched(&commanded, &[], &|effect| options.considers(effect));
    if founds.is_empty() {
        return Ok(None);
    }
    let masses = weighed(setup, &moving, &founds)?;
    Ok(Some((ClampedCase::with_masses(setup, &masses)?, masses)))
}

/// The mass of each body that moves and is believed to be uncertain. `founds` are the joints' own answers, in the case's order.
fn weighed(setup: &ClampedSetup, case: &TorqueCase, founds: &[Found]) -> Result<Vec<FoundNumber>, ClampedCaseError> {
    let robot = &setup.description;
    let believed = |link: LinkId| {
        let carrier = robot.carriers(link).last().map_or("", |joint| robot.joints[joint.0].name.as_str());
        setup.study.uncertain.mass.of(carrier)
    };
    let links: Vec<(LinkId, f64)> = robot.heaviest().into_iter().map(|link| (link, believed(link))).collect();
    let links: Vec<(LinkId, f64)> = links.into_iter().filter(|(_, sd)| *sd > 0.0).collect();
    let bench = Bench::new(setup, case, founds)?;
    let described = bench.torques(robot)?;
    let column = |(link, _): &(LinkId, f64)| {
        let heavier = robot.with_change(*link, &BodyChange::Mass { factor: 1.0 + NUDGE });
        Ok(differences(&bench.torques(&heavier)?, &described, NUDGE))
    };
    let shared = links.iter().map(column).collect::<Result<_, ClampedCaseError>>()?;
    let unknown =
        |(_, sd): &(LinkId, f64)| Unknown { sd: *sd, bounds: [(-BELIEVED * sd).max(LEAST - 1.0), BELIEVED * sd] };
    let unknowns: Vec<Unknown> = links.iter().map(unknown).collect();
    // What a body's mass says is not said again by what a joint carries.
    let own = |joint: usize| {
        let found = &founds[joint];
        let columns = Choice { curve: None, ..found.choice() }.columns(&found.design);
        let is_load = |k: &usize| matches!(found.design.numbers.get(*k), Some(Which::Inertia | Which::Moment));
        columns.into_iter().filter(|k| !is_load(k)).collect()
    };
    let mut system = bench.system(&own, &shared, &unknowns);
    let all: Vec<usize> = (0..system.unknowns.len()).collect();
    settle(&mut system, &all, case, founds);
    let (solved, refits) = (system.fit(&all, |block| block.is_fit), system.refits(&all));
    let first = all.len() - unknowns.len();
    let mass = |(k, (link, _)): (usize, &(LinkId, f64))| {
        let (body, share) = (&robot.links[link.0], Estimated::new(first + k, &solved, &refits));
        weighed_mass(&body.name, body.inertia.mass_kg, share)
    };
    Ok(links.iter().enumerate().map(mass).collect())
}

/// A body's mass that is other than described by a share \[kg\].
///
/// At the end of what is believed of it nothing says how far the logs would go: there it has no interval.
fn weighed_mass(body: &str, was_kg: f64, share: Estimated) -> FoundNumber {
    let value = (1.0 + share.value) * was_kg;
    let half = HALF_95 * share.sd * was_kg;
    FoundNumber {
        name: body.to_owned(),
        key: FoundKey::Mass,
        was: Some(was_kg),
        value,
        interval: (half.is_finite() && !share.is_held()).then_some([value - half, value + half]),
        unit: "kg".to_owned(),
        place_m: None,
    }
}

/// Weighs every log of every joint by what it leaves: some motions the samples hardly resolve.
fn settle(system: &mut System, all: &[usize], case: &TorqueCase, founds: &[Found]) {
    for _ in 0..SETTLES {
        let solved = system.fit(all, |block| block.is_fit);
        let mut from = 0;
        for found in founds {
            let own = &mut system.blocks[from..from + found.system.blocks.len()];
            from += own.len();
            for (log, data) in case.logs.iter().enumerate() {
                let of_log = |block: &&Block| block.log == log;
                let squares: f64 = own.iter().filter(of_log).map(|block| block.squares(&solved.x)).sum();
                let samples: usize = own.iter().filter(of_log).map(|block| block.samples).sum();
                let times = (squares * data.tied / samples.max(1) as f64).sqrt();
                if times > 0.0 {
                    own.iter_mut().filter(|block| block.log == log).for_each(|block| block.rescale(times));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `mass 0.4025 [0.4025, 0.4025] kg` once, three standard deviations of its belief from what was described.
    #[test]
    fn a_mass_at_the_end_of_what_is_believed_has_no_interval() {
        let share = |naive_sd: f64, sd: f64| Estimated { value: 0.15, sd, naive_sd };
        let mass = |naive_sd, sd| weighed_mass("fore", 0.35, share(naive_sd, sd));
        let told = mass(0.02, 0.03);
        let [low, high] = told.interval.unwrap();
        assert!(low < told.value && told.value < high, "{}", told.words());
        for held in [mass(0.0, 0.0), mass(0.0, 0.005), mass(f64::INFINITY, f64::INFINITY)] {
            assert_eq!(held.interval, None, "{}", held.words());
        }
        assert_eq!(mass(0.0, 0.0).words(), "mass 0.402 kg, was 0.35");
    }
}
