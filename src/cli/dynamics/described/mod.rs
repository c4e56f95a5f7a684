//! `aibo-fit dynamics --robot` on a URDF or MJCF.

mod answer;
mod read;

use super::answer::Timing;
use super::{DynamicsArgs, HeldBase, write};
use crate::cli::CliError;
use crate::cli::common::{print, warn};
use crate::cli::progress::Progress;
use crate::cli::provenance::provenance;
use crate::robot::description::Description;
use crate::robot::tree::{Tree, TreeBase, TreeDynamics};
use answer::{Answers, StateAnswer, answer};
use read::Question;
use std::fmt::Write as _;
use std::hint::black_box;
use std::path::{Path, PathBuf};

/// Answers for a described robot.
pub(super) fn run(args: &DynamicsArgs, robot: &Path) -> Result<u8, CliError> {
    let progress = Progress::new(args.common.quiet);
    progress.say("reading");
    let description = Description::read(robot)?;
    let mut warnings: Vec<String> = description.warnings.iter().chain(&description.left_out).cloned().collect();
    let question = Question::open(&args.states)?;
    let asked_base = args.base.map(|base| if base == HeldBase::Free { TreeBase::Free } else { TreeBase::Fixed });
    let base = asked_base.or(question.base).unwrap_or_else(|| Tree::base_of(&description));
    let mut tree = Tree::new(&description, base)?;
    if let Some(gravity) = question.gravity_m_s2 {
        tree = tree.with_gravity(gravity);
    }
    let (asked, odd) = question.states(&args.states, &description, &tree)?;
    warnings.extend(odd);
    progress.say("evaluating");
    let mut dynamics = TreeDynamics::new(&tree);
    let mut states = Vec::with_capacity(asked.len());
    for (index, one) in asked.iter().enumerate() {
        let not_finite = || CliError::NotFinite { file: args.states.clone(), what: format!("states[{index}]") };
        let (found, singular) = answer(&mut dynamics, &description, one).ok_or_else(not_finite)?;
        warnings.extend(singular.map(|singular| format!("states[{index}]: no qacc: {singular}")));
        states.push(found);
    }
    let n = tree.freedoms();
    let (mut force, mut acceleration) = (vec![0.0; n], vec![0.0; n]);
    let timing = args.repeat.map(|goes| {
        Timing::of(goes, &asked, |one| {
            dynamics.forces_of(black_box(&one.torque), &mut force);
            // A singular matrix takes its time as well.
            let _ = dynamics.forward(black_box(&one.state), &force, &mut acceleration);
            black_box(&acceleration);
        })
    });
    let inputs: Vec<PathBuf> = std::iter::once(&args.states).chain(&description.files).cloned().collect();
    let from = provenance(inputs.iter().cloned())?;
    let answers = Answers::new(&description, &tree, warnings, states, timing, &from);
    write(args, &answers, &inputs)?;
    drop(progress);
    answers.warnings.iter().for_each(|warning| warn(warning));
    if !args.common.quiet {
        if args.common.json.is_none() {
            print(&table(&description, &tree, &answers.states));
        }
        answers.timing.iter().for_each(Timing::print);
    }
    Ok(0)
}

/// One row for each state.
fn table(description: &Description, tree: &Tree, states: &[StateAnswer]) -> String {
    let (links, joints) = (description.links.len(), tree.joints().len());
    let mut text = format!("{}: {links} links, {joints} joints\n\n", description.name);
    let _ = writeln!(
        text,
        "{:>5} {:>32} {:>13} {:>13}  largest joint acceleration",
        "state", "centre of mass [m]", "kinetic [J]", "potential [J]"
    );
    for (index, state) in states.iter().enumerate() {
        let out = &state.out;
        let joints = out.qacc.iter().flat_map(|qacc| &qacc[tree.base_freedoms()..]).zip(tree.joint_names());
        let largest = joints.max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()));
        let largest = largest.map_or_else(|| "none".to_owned(), |(x, joint)| format!("{joint} {x:.4e} /s^2"));
        let [x, y, z] = out.com;
        let _ = writeln!(
            text,
            "{index:>5} {x:>10.5} {y:>10.5} {z:>10.5} {:>13.6} {:>13.6}  {largest}",
            out.kinetic_energy, out.potential_energy
        );
    }
    text
}
