//! Orders of the methods, and what their tolerances are worth.

use super::{Method, Ode, Solver, Tolerance};

/// A pendulum with large swings; its energy tells the error.
struct Pendulum;

impl Ode for Pendulum {
    fn len(&self) -> usize {
        2
    }
    fn rate(&mut self, _t_s: f64, y: &[f64], rate: &mut [f64]) {
        (rate[0], rate[1]) = (y[1], -y[0].sin());
    }
}

/// Prothero and Robinson's problem: `y = cos t` with a decay of 1e6 1/s towards it.
struct Stiff;

impl Ode for Stiff {
    fn len(&self) -> usize {
        1
    }
    fn rate(&mut self, t_s: f64, y: &[f64], rate: &mut [f64]) {
        rate[0] = -1e6 * (y[0] - t_s.cos()) - t_s.sin();
    }
}

fn swing(method: Method) -> ([f64; 2], u64) {
    let (mut t_s, mut y) = (0.0, [2.0, 0.0]);
    let mut solver = Solver::new(method, 2);
    // In pieces, as a log's samples cut it.
    for k in 1..=4 {
        solver.advance(&mut Pendulum, &mut t_s, &mut y, 2.5 * f64::from(k)).unwrap();
    }
    assert!((t_s - 10.0).abs() < 1e-12);
    (y, solver.counts().evaluations)
}

fn error(method: Method) -> f64 {
    let exact = swing(Method::Rk4 { step_s: 2e-4 }).0;
    let y = swing(method).0;
    (y[0] - exact[0]).hypot(y[1] - exact[1])
}

#[test]
fn halving_the_step_divides_the_error_by_four_and_by_sixteen() {
    let second = error(Method::Rk2 { step_s: 0.02 }) / error(Method::Rk2 { step_s: 0.01 });
    assert!((3.5..4.6).contains(&second), "{second}");
    let fourth = error(Method::Rk4 { step_s: 0.04 }) / error(Method::Rk4 { step_s: 0.02 });
    assert!((12.0..18.0).contains(&fourth), "{fourth}");
}

#[test]
fn a_tighter_tolerance_costs_more_and_gives_less_error() {
    for method in [Method::DormandPrince, Method::Adams, Method::Bdf] {
        let mut last = (f64::INFINITY, 0);
        for tolerance in [1e-4, 1e-6, 1e-8, 1e-10] {
            let of = method(Tolerance::of(tolerance));
            let (found, evaluations) = (error(of), swing(of).1);
            assert!(found < 3e3 * tolerance && found < last.0, "{of:?}: {found:e} after {:e}", last.0);
            assert!(evaluations > last.1, "{of:?}");
            last = (found, evaluations);
        }
    }
    // High orders pay: Adams needs far fewer evaluations than a fixed step of the same error.
    assert!(swing(Method::Adams(Tolerance::of(1e-8))).1 < 6000);
}

#[test]
fn backward_differentiation_takes_long_steps_through_a_stiff_problem() {
    let (mut t_s, mut y) = (0.0, [1.5]);
    let mut solver = Solver::new(Method::Bdf(Tolerance::of(1e-6)), 1);
    solver.advance(&mut Stiff, &mut t_s, &mut y, 2.0).unwrap();
    assert!((y[0] - 2.0f64.cos()).abs() < 1e-5 && solver.counts().steps < 300, "{y:?} {:?}", solver.counts());
}

#[test]
fn an_explicit_method_says_when_it_runs_away() {
    struct Away;
    impl Ode for Away {
        fn len(&self) -> usize {
            1
        }
        fn rate(&mut self, _t_s: f64, y: &[f64], rate: &mut [f64]) {
            rate[0] = y[0] * y[0];
        }
    }
    for method in [Method::Rk4 { step_s: 0.01 }, Method::DormandPrince(Tolerance::of(1e-6))] {
        let (mut t_s, mut y) = (0.0, [1.0]);
        let stalled = Solver::new(method, 1).advance(&mut Away, &mut t_s, &mut y, 3.0).unwrap_err();
        assert!(stalled.at_s >= 0.9 && y[0].is_finite(), "{stalled}");
    }
}

/// A setpoint that jumps between two calls.
#[test]
fn a_system_that_changes_between_calls_leaves_nothing_of_its_former_rate() {
    struct Straight(f64);
    impl Ode for Straight {
        fn len(&self) -> usize {
            1
        }
        fn rate(&mut self, _t_s: f64, _y: &[f64], rate: &mut [f64]) {
            rate[0] = self.0;
        }
    }
    for method in [Method::Rk4 { step_s: 0.01 }, Method::DormandPrince(Tolerance::of(1e-3))] {
        let (mut t_s, mut y) = (0.0, [0.0]);
        let mut solver = Solver::new(method, 1);
        for (slope, until_s) in [(1.0, 1.0), (-1.0, 2.0)] {
            solver.advance(&mut Straight(slope), &mut t_s, &mut y, until_s).unwrap();
        }
        assert!(y[0].abs() < 1e-12, "{method:?}: {y:?}");
    }
}
