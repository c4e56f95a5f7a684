//! No evaluation of the robot's dynamics allocates memory, and no step of a simulation does.

use aibo_fit::robot::simulate::{Joints, Method, Scenario, Setpoints, Surroundings, run};
use aibo_fit::robot::study::{lift, standing};
use aibo_fit::robot::{Dynamics, Floor, FloorParameters, Force, Gait, Input, Model, State, Touching};
use nalgebra::{DMatrix, Vector3};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: everything is handed to the system's allocator; counting allocates nothing.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.with(|count| count.set(count.get() + 1));
        // SAFETY: the caller's promise.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

#[test]
fn no_evaluation_allocates() {
    let model = Model::ers7();
    let state = State::at_rest(model);
    let mut dynamics = Dynamics::new(model);
    let (torque, diagonal) = ([0.1; 22], [1e-4; 22]);
    let feet = model.body_ids().filter(|body| model.bodies()[body.index()].touches_floor());
    let forces: Vec<Force> = feet.map(|foot| Force::at(foot, Vector3::zeros(), Vector3::y())).collect();
    assert_eq!(forces.len(), 4);
    let (mut out, mut matrix) = (vec![0.0; 28], DMatrix::zeros(28, 28));
    let before = ALLOCATIONS.with(Cell::get);
    let input = Input { torque_nm: &torque, diagonal_kg_m2: &diagonal, forces: &forces };
    dynamics.forward(&state, &input, &mut out);
    dynamics.bias(&state, &mut out);
    dynamics.mass_matrix(&state, &mut matrix);
    let sums =
        [dynamics.energy(&state).total_j(), dynamics.momentum(&state).mass_kg, dynamics.motions(&state).len() as f64];
    let made = ALLOCATIONS.with(Cell::get) - before;
    assert_eq!(made, 0, "{sums:?}");
}

/// Allocations of a walk of so many seconds with 21 samples, whatever its length.
fn allocations_of_a_walk(duration_s: f64) -> usize {
    let model = Model::ers7();
    let joints = Joints::of_thesis(model).expect("the thesis's sets");
    let trot = Gait::built_in("trot", model).expect("built in");
    let setpoints = Setpoints::sampled(&trot, model, duration_s, 0.008).expect("a table");
    let floor = Floor::new(FloorParameters::default(), model, Touching::Marked).expect("a floor");
    let mut start = standing(model, &joints, &setpoints);
    lift(&floor, model, &mut start, 0.02);
    let (setpoints, start, surroundings) = (&setpoints, &start, Some(&floor as &dyn Surroundings));
    let scenario = Scenario { model, joints: &joints, setpoints, start, surroundings, period_s: duration_s / 20.0 };
    let before = ALLOCATIONS.with(Cell::get);
    let answer = run(&scenario, Method::Stiff { step_s: 5e-4 }).expect("a run");
    let made = ALLOCATIONS.with(Cell::get) - before;
    assert!(answer.diverged.is_none() && answer.t_s.len() == 21);
    made
}

#[test]
fn no_step_of_a_walk_allocates() {
    // Touch-down and standing are in both, 4000 steps of walking in the second only.
    assert_eq!(allocations_of_a_walk(2.0), allocations_of_a_walk(4.0));
}
