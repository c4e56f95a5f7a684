//! A diagnosis of a robot from beginning to end.

use super::attribute::attribute;
use super::beliefs::{beliefs, broken, changes, off};
use super::bench::{Bench, followed_s};
use super::case::RobotCase;
use super::cause::Cause;
use super::comes_back::may_be_noise;
use super::decide::{Decision, decide, needed};
use super::diagnosis::{
    Found, GaitCell, GaitPhase, JointTrace, RobotAnswer, RobotCandidate, RobotDetectable, RobotDiagnosis, RobotGap,
    RobotOptions, RobotWhere,
};
use super::map::{cells, dependence};
use super::measure::{gap, held_out_rms_rad};
use super::next::next;
use super::numbers::found;
use super::phases::phases;
use super::rank::detectable;
use super::refine::Hypothesis;
use super::scatter::Scatter;
use super::sentence::{Said, sentence};
use super::standing::standing;
use super::suspects::Suspects;
use super::torque::residual_torque_nm;
use super::tried::Attribution;
use crate::deadline::NO_PROBABILITY;
use crate::gap::hypothesis::held_out::closed;
use crate::gap::on_demand::told_in;
use crate::gap::verdict::rates::{Rates, probability};
use crate::gap::{Next, Verdict};
use crate::log::RobotLog;
use rayon::prelude::*;

/// Why no diagnosis of a robot can be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RobotGapError {
    /// No joint of a log is asked to move, or let go.
    #[error("no joint of the study moves: expected setpoints (`<joint>.q_ref`) that change, or a joint that is let go")]
    NeverMoved,
    /// The study's robot has no motion that stays finite.
    #[error("the robot as given runs away on the logs; check friction, gains and floor of the study")]
    Diverged,
}

/// More than so many times the sensor's noise is more than noise.
const NOT_ALL: f64 = 1.07;
/// Joints with at least this share of the gap are named where no cause is.
const HAS_MUCH: f64 = 0.1;
const NAMED_AT_MOST: usize = 4;

/// Diagnoses the gap of a robot study. `progress` is told what is being tried.
///
/// # Errors
/// [`RobotGapError`] where there is nothing to diagnose.
pub fn diagnose_robot(
    case: &RobotCase,
    options: &RobotOptions,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<RobotDiagnosis, RobotGapError> {
    if !case.logs.iter().any(|log| (0..case.names.len()).any(|joint| log.moves(joint))) {
        return Err(RobotGapError::NeverMoved);
    }
    progress("simulating the robot as given");
    let bench = Bench::new(case, &options.deadline).map_err(|_| RobotGapError::Diverged)?;
    let floor_or_trunk = |cause: Cause| !case.is_clamped() || !cause.is_of_robot();
    let considered = |cause: Cause| options.considers(cause) && floor_or_trunk(cause);
    let tried = attribute(&bench, &considered, progress).ok_or(RobotGapError::Diverged)?;
    progress("weighing");
    let decision = decide(&bench, &tried);
    let gap = gap(&bench, &tried.given, &decision);
    let standing = standing(&bench, &decision);
    let (probability, probability_source) = probability(&standing, &Rates::shipped_for_robots());
    let part = |k: usize| decision.answer.parts.get(k).map(|_| found(&bench, decision.answer, k));
    let (leading, other) = (part(decision.leading), part(1 - decision.leading));
    let is_named = matches!(decision.verdict, Verdict::Effect | Verdict::Calibration);
    let (first, second) = if is_named { (leading.clone(), other) } else { (None, None) };
    let is_refitted = first.is_none();
    let first = first.or_else(|| off(&bench, &decision).filter(|_| decision.verdict == Verdict::Calibration));
    let partial = if decision.verdict == Verdict::Unexplained { leading } else { None };
    let beliefs = beliefs(&bench, &decision);
    let equivalent = if is_named { decision.equivalent.clone() } else { Vec::new() };
    let places: Vec<Vec<String>> = if is_named && first.as_ref().is_some_and(|first| !first.cause.is_of_robot()) {
        decision.places.iter().map(|place| place.names(&case.names)).collect()
    } else {
        Vec::new()
    };
    let said = Said {
        robot: case.robot(),
        verdict: decision.verdict,
        first: first.as_ref(),
        is_refitted,
        second: second.as_ref(),
        partial: partial.as_ref(),
        equivalent: &equivalent,
        places: &places,
        broken: &broken(&beliefs),
    };
    let mut sentence = sentence(&said, &gap);
    let phases: Vec<_> = case.logs.iter().map(|log| phases(case, log)).collect();
    let location = location(&bench, &decision, &phases, first.as_ref());
    progress("what these logs could have shown");
    let next: Option<Next> = next(&bench, &tried, &decision);
    let budget = options.deadline.spent();
    let is_finished = budget.as_ref().is_none_or(|spent| spent.finished);
    let ranking = ranking(&bench, &tried, &decision, &gap, if is_finished { probability } else { 0.0 });
    let least = needed(&bench, &tried.given);
    // Nothing is known of what was left out for want of time, nor of free play where it was not tried.
    let is_tried = |cause: &Cause| tried.columns.iter().any(|column| column.cause == *cause);
    let is_known = |cause: &Cause| is_tried(cause) || is_finished && !cause.is_play();
    let shown = detectable(&bench, &tried.columns, least);
    let detectable = Cause::all().filter(|cause| considered(*cause)).filter(is_known).map(|cause| {
        let (name, unit) = cause.named()[0];
        RobotDetectable { cause, value: shown(cause), name, unit }
    });
    let detectable = detectable.collect();
    let mut notes = notes(&bench, &decision, &gap);
    let ids = |causes: &[Cause]| -> Vec<&'static str> { causes.iter().map(|cause| cause.id()).collect() };
    sentence = told_in(&sentence, case.robot(), &ids(&options.without), &ids(&options.only));
    if let Some(spent) = &budget {
        sentence = spent.before(&sentence);
        notes.insert(0, spent.words());
    }
    Ok(RobotDiagnosis {
        robot: case.robot().to_owned(),
        scenario: case.study.scenario,
        answer: RobotAnswer {
            verdict: decision.verdict,
            intervals_trusted: decision.is_explained(&bench),
            first,
            second,
            equivalent,
            places,
            probability: is_finished.then_some(probability),
            probability_source: if is_finished { probability_source } else { NO_PROBABILITY.to_owned() },
            standing,
            sentence,
            partial,
        },
        location,
        ranking,
        detectable,
        next,
        traces: traces(&bench, &decision, &phases),
        changes: changes(&bench, &decision),
        beliefs,
        notes,
        withheld: options.without.clone(),
        gap,
        budget,
    })
}

/// Where the gap lies: of a named cause its joints, else those that have most.
fn location(
    bench: &Bench<'_>,
    decision: &Decision<'_>,
    phases: &[Vec<Vec<GaitPhase>>],
    first: Option<&Found>,
) -> RobotWhere {
    let left = bench.noise_of_all.adapted(&bench.gap());
    // What the map shows is the gap itself where a cause is named, for the uncertain numbers would take some of it.
    let shown = if first.is_some() { bench.gap() } else { left };
    let cells = cells(bench, phases, &shown);
    let of_joint = |name: &str| cells.iter().filter(|cell| cell.joint == name).map(|cell| cell.share).sum::<f64>();
    let has_gap = decision.verdict != Verdict::None;
    let joints: Vec<usize> = match (first, has_gap) {
        (_, false) => Vec::new(),
        (Some(first), _) => {
            let place = |joint: &usize| first.joints.contains(&bench.case.names[*joint]);
            (0..bench.case.names.len()).filter(place).collect()
        }
        (None, true) => {
            let mut joints = Suspects::of(bench, &bench.gap()).joints;
            joints.retain(|joint| of_joint(&bench.case.names[*joint]) > HAS_MUCH);
            joints.truncate(NAMED_AT_MOST);
            joints
        }
    };
    let names: Vec<String> = joints.iter().map(|joint| bench.case.names[*joint].clone()).collect();
    let looked_at = if joints.is_empty() { bench.layout.moving() } else { joints };
    let (variable, range) = match dependence(bench, &looked_at, &shown).filter(|_| has_gap) {
        Some((variable, range)) => (Some(variable), Some(range)),
        None => (None, None),
    };
    let in_phase = |phase: GaitPhase| {
        let those = |cell: &&GaitCell| cell.phase == phase && (names.is_empty() || names.contains(&cell.joint));
        cells.iter().filter(those).map(|cell| cell.share).sum::<f64>()
    };
    let phase = GaitPhase::ALL.into_iter().filter(|_| has_gap).max_by(|a, b| in_phase(*a).total_cmp(&in_phase(*b)));
    let mean = bench.case.logs.len() as f64;
    let energy = |index: usize| -> f64 {
        let rows = bench.layout.joints().filter(|(_, row)| row.log == index);
        rows.flat_map(|(_, row)| row.range.clone()).map(|k| shown[k].powi(2)).sum()
    };
    let all: f64 = (0..bench.case.logs.len()).map(energy).sum();
    let logs = bench.case.logs.iter().enumerate().filter(|(index, _)| has_gap && energy(*index) >= all / mean);
    let share = names.iter().map(|name| of_joint(name)).sum::<f64>();
    RobotWhere {
        joints: names,
        stage: first.map(|found| found.cause.stage()),
        variable,
        range,
        phase,
        logs: logs.map(|(_, log)| log.file.clone()).collect(),
        share,
        cells,
    }
}

fn ranking(
    bench: &Bench<'_>,
    tried: &Attribution,
    decision: &Decision<'_>,
    gap: &RobotGap,
    probability: f64,
) -> Vec<RobotCandidate> {
    let best = tried.firsts.first().map_or(0.0, |first| first.loss());
    let stands = |hypothesis: &&Hypothesis| {
        let part = &hypothesis.parts[0];
        decision.verdict == Verdict::Effect
            && decision.equivalent.contains(&part.cause)
            && (part.cause.is_of_robot() || decision.places.contains(&part.place))
    };
    let among = tried.firsts.iter().filter(stands).count().max(1) as f64;
    let candidate = |hypothesis: &Hypothesis| {
        let after = held_out_rms_rad(bench, hypothesis);
        let found = found(bench, hypothesis, 0);
        RobotCandidate {
            probability: if stands(&hypothesis) { probability / among } else { 0.0 },
            after,
            closed: closed(gap.before, after, gap.floor),
            behind: hypothesis.loss() - best,
            found,
        }
    };
    tried.firsts.par_iter().map(candidate).collect()
}

fn traces(bench: &Bench<'_>, decision: &Decision<'_>, phases: &[Vec<Vec<GaitPhase>>]) -> Vec<JointTrace> {
    let model = bench.case.model();
    let torques: Vec<Vec<Vec<f64>>> = match bench.case.is_clamped() {
        true => (0..bench.case.logs.len()).map(|index| residual_torque_nm(bench, index)).collect(),
        false => Vec::new(),
    };
    let less = |left: &[f64]| bench.measured.iter().zip(left).map(|(measured, left)| measured - left).collect();
    let changes = changes(bench, decision);
    let repaired = || bench.simulate(&Scatter::none(model), &changes, followed_s(bench.steps.fine, &changes), None);
    let after: Vec<f64> = match bench.case.is_clamped() {
        true => repaired().unwrap_or_else(|| less(&decision.answer.attained.residual)),
        false => less(&decision.answer.residual),
    };
    let trace = |(joint, row): (usize, &super::layout::Row)| {
        let log = &bench.case.logs[row.log];
        let id = model.joint_ids().nth(joint);
        let is_off = |t: f64| log.release.is_some_and(|(released, at_s)| released == joint && t >= at_s);
        let setpoint = |t: &f64| {
            let asked = id.filter(|_| !is_off(*t)).and_then(|id| log.scene.setpoints.at(id, *t));
            asked.unwrap_or(f64::NAN)
        };
        JointTrace {
            file: log.file.clone(),
            joint: bench.case.names[joint].clone(),
            t_s: log.log.t_s.clone(),
            measured_rad: bench.measured[row.range.clone()].to_vec(),
            setpoint_rad: log.log.t_s.iter().map(setpoint).collect(),
            before_rad: bench.stated[row.range.clone()].to_vec(),
            after_rad: after[row.range.clone()].to_vec(),
            residual_torque_nm: torques.get(row.log).map_or_else(Vec::new, |of| of[joint].clone()),
            phase: phases[row.log][joint].clone(),
            held: bench.layout.held[row.range.clone()].to_vec(),
        }
    };
    bench.layout.joints().map(trace).collect()
}

/// A trunk that begins on the floor and far behind: one whose log has z up, most likely.
const ON_THE_FLOOR_M: f64 = 0.02;
const FAR_BEHIND_M: f64 = 0.1;

/// A question where the trunk's columns seem to have other axes than ours.
fn other_axes(log: &RobotLog) -> Option<String> {
    let base = log.base.as_ref()?;
    let first = |column: &Option<Vec<f64>>| column.as_ref()?.first().copied();
    let (up_m, rear_m) = (first(&base.y_m)?, first(&base.z_m)?);
    (up_m.abs() < ON_THE_FLOOR_M && rear_m > FAR_BEHIND_M).then(|| {
        format!(
            "{}: base.y begins at {up_m:.3} m and base.z at {rear_m:.3} m. Is z the height there? Here y points up and z to the \
             rear, with roll, pitch and yaw about them.",
            log.file.display()
        )
    })
}

fn notes(bench: &Bench<'_>, decision: &Decision<'_>, gap: &RobotGap) -> Vec<String> {
    let mut notes: Vec<String> = bench.case.logs.iter().filter_map(|log| other_axes(&log.log)).collect();
    let mrad = |rad: f64| format!("{:.2} mrad", 1e3 * rad);
    if decision.verdict == Verdict::Effect && gap.after > NOT_ALL * gap.floor {
        notes.push(format!(
            "More than noise is left ({} against {}): the answer closes most of the gap and not all of it.",
            mrad(gap.after),
            mrad(gap.floor)
        ));
    }
    let structure_is_right =
        matches!(decision.verdict, Verdict::None | Verdict::Calibration) && gap.after > NOT_ALL * gap.floor;
    if structure_is_right && may_be_noise(bench, &decision.answer.attained.residual) {
        notes.push(format!(
            "What is left ({}, the sensor itself makes {}) is less than one step of the encoder in every joint and does not come \
             back with the motion: it is taken for noise.",
            mrad(gap.after),
            mrad(gap.floor)
        ));
    }
    if !bench.case.is_clamped() {
        let study = &bench.case.study;
        let off = match study.described {
            Some(_) => {
                let floor = 100.0 * study.uncertain.floor.all;
                format!("masses and friction are off by some percent, and whose floor is off by {floor:.0} %")
            }
            None => "masses, friction and floor are off by some percent".to_owned(),
        };
        notes.push(format!(
            "On the floor a foot lands a little earlier or later with anything that changes, and all joints feel it: \
             causes are weighed against robots whose {off}."
        ));
    }
    if bench.case.study.described.is_some() {
        let whose = "Answers like this one were counted on robots and floors of this program's own making: on a robot \
                     and a floor that are neither, take the probability as a guide.";
        notes.push(whose.to_owned());
    }
    for displacement in &gap.displacement {
        let cm = |m: f64| format!("{:.1} cm", 100.0 * m);
        notes.push(format!(
            "{}: the trunk went {} forward; as given {}, with the answer {}.",
            displacement.file,
            cm(displacement.measured),
            cm(displacement.before),
            cm(displacement.after)
        ));
    }
    let logs = bench.case.logs.iter().map(|log| &log.log);
    notes.extend(logs.clone().filter_map(RobotLog::remark));
    let mut unused: Vec<&str> = Vec::new();
    for name in logs.flat_map(|log| &log.ignored_columns) {
        if !unused.contains(&name.as_str()) {
            unused.push(name);
        }
    }
    if !unused.is_empty() {
        notes.push(format!("Columns that are not used: {}.", unused.join(", ")));
    }
    notes
}
