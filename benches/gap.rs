//! How long a diagnosis takes. `cargo bench --bench gap [NAME]`; figures are in `benches/README.md`.
//!
//! The six samples of `AIBO_FIT_SHARED/samples` where they are there, and studies of `aibo_fit::blind`. On all cores.
//! `cargo bench --bench gap -- --once STUDY.toml` diagnoses one study once, for a look at its memory from outside, and says
//! how long each stage took.

use aibo_fit::blind::{Cause, CauseFilter, make_filtered, make_with};
use aibo_fit::gap::{GapOptions, Verdict, diagnose};
use aibo_fit::identify::{Case, Item};
use aibo_fit::joint::EffectId;
use aibo_fit::log::{DriveMode, Role};
use aibo_fit::progress::{Progress, Silent, Step};
use divan::Bencher;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    match arguments.iter().position(|a| a == "--once") {
        Some(at) => {
            let study = arguments.get(at + 1).expect("--once needs a study");
            let clock = Clock::default();
            println!("{:?}", told(&read(Path::new(study)), &GapOptions::default(), &clock));
            clock.print();
        }
        None => divan::main(),
    }
}

fn read(study: &Path) -> Case {
    Case::of_study(study).expect("the study is readable")
}

fn diagnosis(case: &Case, options: &GapOptions) -> Verdict {
    told(case, options, &Silent)
}

fn told(case: &Case, options: &GapOptions, progress: &dyn Progress) -> Verdict {
    diagnose(case, options, progress).expect("the study can be diagnosed").answer.verdict
}

/// The time of each stage.
#[derive(Default)]
struct Clock(Mutex<Times>);

#[derive(Default)]
struct Times {
    /// In the order in which they were first reached.
    stages: Vec<(&'static str, Duration)>,
    present: Option<(usize, Instant)>,
}

impl Times {
    fn end(&mut self) {
        if let Some((at, since)) = self.present.take() {
            self.stages[at].1 += since.elapsed();
        }
    }
}

impl Progress for Clock {
    fn step(&self, step: Step) {
        let mut times = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        times.end();
        let known = times.stages.iter().position(|(stage, _)| *stage == step.stage);
        let at = known.unwrap_or_else(|| {
            times.stages.push((step.stage, Duration::ZERO));
            times.stages.len() - 1
        });
        times.present = Some((at, Instant::now()));
    }
}

impl Clock {
    fn print(&self) {
        let mut times = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        times.end();
        for (stage, time) in &times.stages {
            println!("{:8.3} s  {stage}", time.as_secs_f64());
        }
    }
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
    written(make_with(1, 0, cause).study)
}

/// A study as it is read from its files.
fn written(files: Vec<(String, String)>) -> Case {
    let folder = tempfile::tempdir().expect("a folder can be made");
    for (name, content) in files {
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

/// Made studies with three causes, drawn at random, against the whole catalogue.
#[divan::bench(args = 0..6, sample_count = 1, sample_size = 1)]
fn three_causes(bencher: Bencher<'_, '_>, trial: u64) {
    let case = written(make_filtered(1, trial, &CauseFilter::Effects(3)).study);
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
#[divan::bench(args = [4, 8, EffectId::ALL.len()], sample_count = 3, sample_size = 1)]
fn by_effects(bencher: Bencher<'_, '_>, effects: usize) {
    let case = made(Cause::Effects(vec![EffectId::Stribeck]));
    let only = EffectId::ALL.iter().copied().take(effects).collect();
    let options = GapOptions { only, ..GapOptions::default() };
    bencher.bench_local(|| diagnosis(&case, &options));
}
