//! How long a fit takes, and its parts. `cargo bench --bench fit [NAME]`; figures are in `benches/README.md`.
//!
//! Everything but `conclude_on_threads/2` runs on one thread. With
//! `--estimate LOG.csv INERTIA MOMENT COULOMB VISCOUS` (SI units) it prints, as one line of JSON, the time of an
//! estimate of that log from that start; `scipy_fit.py --ratio` reads it.

use aibo_fit::fit::{Budget, Method, Residuals, Solution, Uncertainty, solve, uncertainty};
use aibo_fit::identify::{Experiment, ExtensiveModel, JointModel, Problem, Scale, conclude, prediction, search};
use aibo_fit::joint::{Dual, Real};
use aibo_fit::log::{Log, Nominal, Study, health, read_log, read_sidecar_for, write_log};
use aibo_fit::pendulum::{Input, Start, rollout};
use divan::{Bencher, black_box};
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde_json::{Map, Value, json};
use std::path::Path;
use std::time::Instant;

/// Tables 3.2, 3.3 and A.2: the right front q1 of the ERS-7.
const Q1: Nominal =
    Nominal { inertia_kg_m2: 5.974e-4, moment_kg_m: 5.972e-3, coulomb_nm: 0.001, viscous_nm_s_rad: 0.017 };

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    match arguments.iter().position(|a| a == "--estimate") {
        Some(at) => print_estimate(&arguments[at + 1..]),
        None => divan::main(),
    }
}

/// A log with what is known of it, in memory.
struct Case {
    log: Log,
    study: Study,
    nominal: Nominal,
}

impl Case {
    /// A log with its sidecar.
    fn read(log: &Path, nominal: Nominal) -> Self {
        let study = read_sidecar_for(log).expect("the sidecar is readable").expect("the log has a sidecar");
        Self { log: read_log(log).expect("the log is readable"), study, nominal }
    }

    /// The swing that the repository brings: 5.6 s at 8 ms, 0.402 kg on the leg.
    fn q1() -> Self {
        Self::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("data/q1.csv"), Q1)
    }

    /// Release and health of the log, and the samples that count.
    fn experiment(&self) -> Experiment {
        let (sensor, entry) = (&self.study.sensor, &self.study.logs[0]);
        let found = health(&self.log, sensor, entry.drive);
        let resolution_rad = sensor.resolution_rad.or(found.step_rad).unwrap_or(0.0);
        Experiment::new(&self.log, entry, &found, resolution_rad, self.study.joint.gravity_m_s2)
            .expect("enough samples are free")
    }

    /// The extensive model. A free swing shows ratios only, so its moment is held at the nominal value.
    fn model(&self, experiments: &[Experiment]) -> ExtensiveModel {
        let mut model =
            ExtensiveModel::lumped(&Scale::of(experiments, Some(&self.nominal), None), Some(&self.nominal), false);
        model.parameters[1].fixed = !experiments[0].is_driven();
        model
    }
}

/// What an estimate gives.
struct Estimate {
    solution: Solution,
    values: Vec<f64>,
    uncertainty: Uncertainty,
}

/// From a log in memory to parameters with their intervals: health, samples, search from the nominal values, intervals.
fn estimate(case: &Case, method: Method) -> Estimate {
    let experiments = [case.experiment()];
    let model = case.model(&experiments);
    let problem = Problem::new(&model, &experiments);
    let solution = solve(&problem, &nominal_point(&problem), method, Budget::default());
    with_intervals(&problem, solution)
}

/// The same with the search that the library offers: nominal values, equation error, short parts, and changes of them.
fn searched(case: &Case, method: Method) -> Estimate {
    let experiments = [case.experiment()];
    let model = case.model(&experiments);
    let found = search(&model, &experiments, method, Budget::default()).expect("the log has a motion");
    with_intervals(&Problem::new(&model, &experiments), found.solution)
}

fn with_intervals(problem: &Problem<'_, ExtensiveModel>, solution: Solution) -> Estimate {
    let blocks = problem.linearise(&solution.x).expect("the solution has a motion");
    let uncertainty = uncertainty(problem, &blocks).expect("the log determines the parameters");
    Estimate { values: problem.values(&solution.x), solution, uncertainty }
}

fn nominal_point(problem: &Problem<'_, ExtensiveModel>) -> Vec<f64> {
    let values: Vec<f64> = problem.model.parameters().iter().map(|p| p.start).collect();
    problem.coordinates_of(&values)
}

/// A pool in which parallel work runs on so many threads.
fn pool(threads: usize) -> ThreadPool {
    ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be had")
}

// ------------------------------------------------------------------ parts

/// Five seconds of free swing, samples so many milliseconds apart: angles only.
#[divan::bench(args = [8, 1])]
fn rollout_5s(bencher: Bencher<'_, '_>, period_ms: u32) {
    swing::<f64>(bencher, period_ms, |values| values.to_vec());
}

/// The same with its derivatives to three parameters, rest angle and start.
#[divan::bench(args = [8, 1])]
fn rollout_5s_with_six_derivatives(bencher: Bencher<'_, '_>, period_ms: u32) {
    swing::<Dual<6>>(bencher, period_ms, |values| {
        let variable = |(i, &value): (usize, &f64)| Dual::variable(value, i.min(5));
        values.iter().enumerate().map(variable).collect()
    });
}

fn swing<T: Real>(bencher: Bencher<'_, '_>, period_ms: u32, values: impl Fn(&[f64]) -> Vec<T>) {
    let experiment = Case::q1().experiment();
    let model = Case::q1().model(std::slice::from_ref(&experiment));
    let chain = model
        .chain(&values(&[Q1.inertia_kg_m2, Q1.moment_kg_m, Q1.coulomb_nm, Q1.viscous_nm_s_rad, -0.1]), &experiment);
    let t_s: Vec<f64> = (0..=5000 / period_ms).map(|k| 1e-3 * f64::from(k * period_ms)).collect();
    let start = Start { angle_rad: T::constant(0.95), rate_rad_s: T::nought(), release_s: None };
    bencher.bench_local(|| {
        let mut last = T::nought();
        rollout(&chain, Input::Off, &t_s, start, |_, s| last = s.angle_rad).expect("it swings");
        last
    });
}

/// Residuals and Jacobian of the log at the nominal values.
#[divan::bench]
fn linearise(bencher: Bencher<'_, '_>) {
    let case = Case::q1();
    let experiments = [case.experiment()];
    let model = case.model(&experiments);
    let problem = Problem::new(&model, &experiments);
    let x = nominal_point(&problem);
    bencher.bench_local(|| problem.linearise(black_box(&x)).expect("it swings"));
}

/// Health, release and samples of a log in memory.
#[divan::bench]
fn prepare_log(bencher: Bencher<'_, '_>) {
    let case = Case::q1();
    bencher.bench_local(|| case.experiment());
}

/// A log of a million rows, from a file.
#[divan::bench(sample_count = 5, sample_size = 1)]
fn read_million_rows(bencher: Bencher<'_, '_>) {
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    let path = folder.path().join("long.csv");
    let t_s: Vec<f64> = (0..1_000_000).map(|k| 1e-3 * f64::from(k)).collect();
    let q_rad = t_s.iter().map(|t| (0.5 * (8.0 * t).sin() / 0.006).round() * 0.006).collect();
    let short = read_log(&Path::new(env!("CARGO_MANIFEST_DIR")).join("data/q1.csv")).expect("the log is readable");
    write_log(&path, &Log { t_s, q_rad, drive: None, ..short }).expect("the temporary folder can be written");
    bencher.bench_local(|| read_log(&path).expect("the log is readable").len());
}

// ------------------------------------------------------------------ fits

/// The search alone, from the nominal values.
#[divan::bench(args = [Method::Lm, Method::Bfgs, Method::Dfp])]
fn search_from_nominal(bencher: Bencher<'_, '_>, method: Method) {
    let case = Case::q1();
    let experiments = [case.experiment()];
    let model = case.model(&experiments);
    let problem = Problem::new(&model, &experiments);
    let x = nominal_point(&problem);
    bencher.bench_local(|| solve(&problem, &x, method, Budget::default()).criterion);
}

/// From the log in memory to parameters with naive and robust intervals, from the nominal values.
#[divan::bench(args = [Method::Lm])]
fn estimate_from_nominal(bencher: Bencher<'_, '_>, method: Method) {
    let case = Case::q1();
    bencher.bench_local(|| estimate(&case, method).uncertainty.half_width_naive(0));
}

/// The same from the search's own candidates.
#[divan::bench(args = [Method::Lm, Method::Bfgs, Method::Dfp], sample_count = 10)]
fn estimate_from_candidates(bencher: Bencher<'_, '_>, method: Method) {
    let case = Case::q1();
    let one_thread = pool(1);
    bencher.bench_local(|| one_thread.install(|| searched(&case, method).uncertainty.half_width_naive(0)));
}

/// Everything: the moment free too, then held because one load does not show it, and the fit run again.
#[divan::bench(args = [1, 2], sample_count = 10)]
fn conclude_on_threads(bencher: Bencher<'_, '_>, threads: usize) {
    let case = Case::q1();
    let pool = pool(threads);
    bencher.bench_local(|| {
        pool.install(|| {
            let experiments = [case.experiment()];
            let model = ExtensiveModel::lumped(&Scale::of(&experiments, Some(&Q1), None), Some(&Q1), false);
            conclude(&model, &experiments, Method::Lm, Budget::default()).expect("it swings").estimates.len()
        })
    });
}

// ------------------------------------------------------------------ for scipy_fit.py

/// Prints how long an estimate of a log takes on one thread, and what it found.
fn print_estimate(arguments: &[String]) {
    let [log, numbers @ ..] = arguments else { panic!("usage: --estimate LOG.csv INERTIA MOMENT COULOMB VISCOUS") };
    let numbers: Vec<f64> = numbers.iter().filter_map(|n| n.parse().ok()).collect();
    let [inertia_kg_m2, moment_kg_m, coulomb_nm, viscous_nm_s_rad] = numbers[..] else {
        panic!("four numbers are needed after the log: inertia, moment, coulomb, viscous")
    };
    let case = Case::read(Path::new(log), Nominal { inertia_kg_m2, moment_kg_m, coulomb_nm, viscous_nm_s_rad });
    let experiments = [case.experiment()];
    let model = case.model(&experiments);
    let problem = Problem::new(&model, &experiments);
    let line = pool(1).install(|| {
        let (found, best) = (estimate(&case, Method::Lm), searched(&case, Method::Lm));
        let rms_rad = |e: &Estimate| prediction(&problem, &e.solution.x, 0).expect("the solution has a motion").rms_rad;
        let parameters: Map<String, Value> =
            model.parameters.iter().zip(&found.values).map(|(p, &value)| (p.name.clone(), value.into())).collect();
        json!({
            "estimate_ms": median_ms(|| drop(estimate(&case, Method::Lm))),
            "search_ms": median_ms(|| drop(searched(&case, Method::Lm))),
            "rms_rad": rms_rad(&found),
            "search_rms_rad": rms_rad(&best),
            "evaluations": found.solution.evaluations,
            "stop": found.solution.stop.words(),
            "parameters": parameters,
        })
    });
    println!("{line}");
}

/// Median time of `f` over 21 runs \[ms\].
fn median_ms(mut f: impl FnMut()) -> f64 {
    let mut times_ms: [f64; 21] = std::array::from_fn(|_| {
        let began = Instant::now();
        f();
        began.elapsed().as_secs_f64() * 1e3
    });
    times_ms.sort_by(f64::total_cmp);
    times_ms[10]
}
