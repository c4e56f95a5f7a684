//! How long a diagnosis takes. `cargo bench --bench gap [NAME]`; figures are in `benches/README.md`.
//!
//! The six samples of `AIBO_FIT_SHARED/samples` where they are there, and studies of `aibo_fit::blind`. On all cores.
//! `cargo bench --bench gap -- --once STUDY.toml` diagnoses one study once, for a look at its memory from outside.

use aibo_fit::blind::{Cause, make_with};
use aibo_fit::gap::{GapOptions, Verdict, diagnose};
use aibo_fit::identify::{Case, Item};
use aibo_fit::joint::EffectId;
use aibo_fit::log::{DriveMode, Role};
use aibo_fit::progress::Silent;
use divan::Bencher;
use std::path::{Path, PathBuf};

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    match arguments.iter().position(|a| a == "--once") {
        Some(at) => {
            let study = arguments.get(at + 1).expect("--once needs a study");
            println!("{:?}", diagnosis(&read(Path::new(study)), &GapOptions::default()));
        }
        None => divan::main(),
    }
}

fn read(study: &Path) -> Case {
    Case::of_study(study).expect("the study is readable")
}

fn diagnosis(case: &Case, options: &GapOptions) -> Verdict {
    diagnose(case, options, &Silent).expect("the study can be diagnosed").answer.verdict
}

/// The shared samples, in order of their names; none, with a word, where they are not there.
fn samples() -> Vec<String> {
    let folder = std::env::var_os("AIBO_FIT_SHARED").map(|shared| PathBuf::from(shared).join("samples"));
    let Some(entries) = folder.and_then(|folder| folder.read_dir().ok()) else {
        eprintln!("samples skipped: AIBO_FIT_SHARED names no folder that holds them");
        return Vec::new();
    };
    let studies = entries.filter_map(|entry| Some(entry.ok()?.path().join("study.toml"))).filter(|path| path.is_file());
    let mut names: Vec<String> = studies.map(|path| path.to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// A made study with a given cause.
fn made(cause: Cause) -> Case {
    let folder = tempfile::tempdir().expect("a folder can be made");
    for (name, content) in make_with(1, 0, cause).study {
        std::fs::write(folder.path().join(name), content).expect("a file can be written");
    }
    read(&folder.path().join("study.toml"))
}

/// Each sample against the whole catalogue.
#[divan::bench(args = samples(), sample_count = 3, sample_size = 1)]
fn samples_whole_catalogue(bencher: Bencher<'_, '_>, study: &String) {
    let case = read(Path::new(study));
    bencher.bench_local(|| diagnosis(&case, &GapOptions::default()));
}

/// A made study against the whole catalogue.
#[divan::bench(args = ["none", "stribeck", "torque_limit"], sample_count = 3, sample_size = 1)]
fn made_whole_catalogue(bencher: Bencher<'_, '_>, cause: &str) {
    let case = made(cause.parse().map_or(Cause::Nothing, |effect| Cause::Effects(vec![effect])));
    bencher.bench_local(|| diagnosis(&case, &GapOptions::default()));
}

/// So many copies of two fit logs of the same study, one free and one driven where there is one.
#[divan::bench(args = [2, 4, 8], sample_count = 3, sample_size = 1)]
fn by_logs(bencher: Bencher<'_, '_>, logs: usize) {
    let mut case = made(Cause::Effects(vec![EffectId::Stribeck]));
    case.items.retain(|item| item.entry.role == Role::Fit && !item.experiments.is_empty());
    let free = case.items.iter().position(|item| item.entry.drive == DriveMode::Off);
    let driven = case.items.iter().position(|item| item.entry.drive != DriveMode::Off);
    let both: Vec<Item> = free.into_iter().chain(driven).map(|at| case.items[at].clone()).collect();
    case.items = both.iter().cycle().take(logs).cloned().collect();
    bencher.bench_local(|| diagnosis(&case, &GapOptions::default()));
}

/// The same study against so many effects.
#[divan::bench(args = [4, 8, 17], sample_count = 3, sample_size = 1)]
fn by_effects(bencher: Bencher<'_, '_>, effects: usize) {
    let case = made(Cause::Effects(vec![EffectId::Stribeck]));
    let only = EffectId::ALL.iter().copied().take(effects).collect();
    let options = GapOptions { only, ..GapOptions::default() };
    bencher.bench_local(|| diagnosis(&case, &options));
}
