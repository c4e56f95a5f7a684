//! How long ten simulated seconds of the reference walk take. `cargo bench --bench walk [NAME]`; figures are in
//! `benches/README.md`. Beside the times it prints, once for each step, how many times faster than real time that is (best
//! of five) and how far the robot went, so that a step too long to be right is seen as such.

use aibo_fit::integrate;
use aibo_fit::robot::simulate::{Joints, Method, Recording, Scenario, Setpoints, run};
use aibo_fit::robot::{Dynamics, Floor, FloorParameters, Gait, Model, State, Touching};
use divan::{Bencher, black_box};
use std::time::Instant;

/// Simulated time [s]: two standing, eight walking.
const DURATION_S: f64 = 10.0;
/// Steps of the stiff method [s]; the last is what the others are held against.
const STEPS_S: [f64; 5] = [1e-3, 8e-4, 5e-4, 1e-4, 2e-5];

fn main() {
    ratios();
    divan::main();
}

/// The reference walk, ready to go.
struct Walk {
    joints: Joints,
    setpoints: Setpoints,
    start: State,
    floor: Floor,
}

impl Walk {
    fn new() -> Self {
        let model = Model::ers7();
        let joints = Joints::of_thesis(model).expect("the sets of the thesis");
        let gait = Gait::built_in("trot", model).expect("a built-in gait");
        let (setpoints, _) =
            Setpoints::sampled(&gait, model, DURATION_S, 0.008).expect("a table of ten seconds").clipped(model);
        let mut start = State::at_rest(model);
        for id in model.joint_ids().filter(|id| joints.drive(*id).chain.motor.is_some()) {
            start.angle_rad[id.index()] = setpoints.at(id, 0.0).unwrap_or(0.0);
        }
        let floor = Floor::new(FloorParameters::default(), model, Touching::Marked).expect("the reference floor");
        start.base_position_m.y = floor.height_on_m(&mut Dynamics::new(model), &start) + 0.02;
        Self { joints, setpoints, start, floor }
    }

    fn go(&self, method: Method) -> Recording {
        let scenario = Scenario {
            model: Model::ers7(),
            joints: &self.joints,
            setpoints: &self.setpoints,
            start: &self.start,
            surroundings: Some(&self.floor),
            period_s: 0.008,
        };
        run(black_box(&scenario), method).expect("a scenario")
    }
}

/// Forward from two seconds on [m].
fn displacement_m(recording: &Recording) -> f64 {
    let first = recording.t_s.partition_point(|t| *t < 2.0 - 1e-6);
    recording.base[first].position_m.z - recording.base[recording.base.len() - 1].position_m.z
}

fn ratios() {
    let walk = Walk::new();
    println!("step [s]  displacement [m]  evaluations  times real time  per evaluation [us]");
    for step_s in STEPS_S {
        let goes = if step_s < 1e-4 { 1 } else { 5 };
        let mut best_s = f64::INFINITY;
        let mut last = None;
        for _ in 0..goes {
            let clock = Instant::now();
            last = Some(walk.go(Method::Stiff { step_s }));
            best_s = best_s.min(clock.elapsed().as_secs_f64());
        }
        let Some(recording) = last else { continue };
        let evaluations = recording.counts.evaluations;
        println!(
            "{step_s:<8e}  {:>16.4}  {evaluations:>11}  {:>15.1}  {:>19.2}",
            displacement_m(&recording),
            DURATION_S / best_s,
            1e6 * best_s / evaluations as f64
        );
    }
    println!();
}

/// Ten seconds by the stiff method.
#[divan::bench(args = [1e-3, 8e-4, 5e-4, 1e-4], sample_count = 20, sample_size = 1)]
fn stiff(bencher: Bencher<'_, '_>, step_s: f64) {
    let walk = Walk::new();
    bencher.bench_local(|| walk.go(Method::Stiff { step_s }).counts);
}

/// Ten seconds by Runge-Kutta 4, the thesis's choice.
#[divan::bench(sample_count = 2, sample_size = 1)]
fn rk4_1e_4(bencher: Bencher<'_, '_>) {
    let walk = Walk::new();
    bencher.bench_local(|| walk.go(Method::Smooth(integrate::Method::Rk4 { step_s: 1e-4 })).counts);
}
