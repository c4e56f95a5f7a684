//! A joint let go, driven or held: its motion from a start to the end of a log, with true sticking.
//!
//! Between events the joint obeys (3.12) with friction of one sign, which is smooth, and is integrated by Runge-Kutta 4, or
//! where a controller holds it in the leaps of an exponential method.
//! Events are located inside the step: a speed that passes through zero (the joint sticks or turns back), a sticking
//! joint that breaks away, the release of a held joint. Event times carry derivatives.

use super::one_body::OneBody;
use super::play::TwoBodies;
use super::schedule::{Command, Input, SAME_INSTANT_S, Schedule};
use crate::joint::{Chain, Real, Setpoint};

/// How a motion begins.
#[derive(Clone, Copy, Debug)]
pub struct Start<T> {
    /// Joint angle \[rad\].
    pub angle_rad: T,
    /// Joint speed \[rad/s\].
    pub rate_rad_s: T,
    /// The joint is held still until this instant \[s\]; `None`: it is free from the first sample on.
    pub release_s: Option<T>,
}

/// The joint at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<T> {
    /// Joint angle \[rad\].
    pub angle_rad: T,
    /// Joint speed \[rad/s\].
    pub rate_rad_s: T,
}

/// The motion left all bounds, or would take more steps than any log needs.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the motion diverged at t = {at_s} s")]
pub struct Diverged {
    /// When \[s\].
    pub at_s: f64,
}

/// Beyond this angle \[rad\] a motion counts as diverged.
const RUNAWAY_RAD: f64 = 1e4;
/// Integration steps per sample, on average, after which a motion counts as diverged: a decay that needs more is over
/// long before the next sample, so that no log could tell it from a faster one.
const STEPS_PER_SAMPLE: usize = 60;
/// The same where motor side and link swing against each other on a stiff spring.
const STEPS_PER_SAMPLE_ON_A_SPRING: usize = 120;

/// Integrates a joint through the sample times of a log and shows each sample's state to `visit`.
///
/// # Errors
/// [`Diverged`] where the angle runs away, is not finite, or the step budget is spent.
pub fn rollout<T: Real>(
    chain: &Chain<T>,
    input: Input<'_>,
    t_s: &[f64],
    start: Start<T>,
    visit: impl FnMut(usize, &State<T>),
) -> Result<(), Diverged> {
    rollout_refined(chain, input, t_s, start, 1.0, visit)
}

/// [`rollout`] with steps `refinement` times shorter than the rule asks for, to see what the steps cost in accuracy.
///
/// # Errors
/// As [`rollout`].
pub fn rollout_refined<T: Real>(
    chain: &Chain<T>,
    input: Input<'_>,
    t_s: &[f64],
    start: Start<T>,
    refinement: f64,
    mut visit: impl FnMut(usize, &State<T>),
) -> Result<(), Diverged> {
    watch(chain, input, t_s, start, (refinement, View::Link), &mut visit)
}

/// The motion of a joint as its encoder reads it: start and states are readings, not true angles.
///
/// # Errors
/// As [`rollout`].
pub fn readings<T: Real>(
    chain: &Chain<T>,
    input: Input<'_>,
    t_s: &[f64],
    start: Start<T>,
    refinement: f64,
    mut visit: impl FnMut(usize, &State<T>),
) -> Result<(), Diverged> {
    let from_s = T::constant(t_s.first().copied().unwrap_or(0.0));
    let [angle_rad, rate_rad_s] = chain.read_back(from_s, start.angle_rad, start.rate_rad_s);
    // What is held does not move, whatever its reading does.
    let rate_rad_s = if start.release_s.is_some() { T::nought() } else { rate_rad_s };
    let start = Start { angle_rad, rate_rad_s, ..start };
    watch(chain, input, t_s, start, (refinement, View::Reading), &mut visit)
}

/// What is shown of a motion.
#[derive(Clone, Copy)]
enum View {
    Link,
    Reading,
}

fn watch<T: Real>(
    chain: &Chain<T>,
    input: Input<'_>,
    t_s: &[f64],
    start: Start<T>,
    (refinement, view): (f64, View),
    visit: &mut dyn FnMut(usize, &State<T>),
) -> Result<(), Diverged> {
    let per_sample = if chain.compliance.is_some() { STEPS_PER_SAMPLE_ON_A_SPRING } else { STEPS_PER_SAMPLE };
    let steps = (refinement.max(1.0) as usize) * (per_sample * t_s.len() + 10_000);
    match chain.two_sides() {
        Some(sides) => {
            walk(TwoBodies::new(chain, sides, t_s, start, refinement, steps), input, t_s, start, view, visit)
        }
        None => walk(OneBody::new(chain, t_s, start, refinement, steps), input, t_s, start, view, visit),
    }
}

/// A mechanism that moves between the events that the input makes.
pub(super) trait Mechanism<T: Real> {
    fn chain(&self) -> &Chain<T>;
    /// Now \[s\].
    fn now_s(&self) -> T;
    /// The same, to be set.
    fn clock_mut(&mut self) -> &mut T;
    /// The held joint is let go.
    fn let_go(&mut self);
    /// The link.
    fn state(&self) -> State<T>;
    /// What the encoder reads, before its gain.
    fn seen(&self) -> State<T>;
    /// Integral of the angle error \[rad s\].
    fn integral_mut(&mut self) -> &mut T;
    /// Moves to `until`, through as many events as happen before it.
    fn advance(&mut self, until: T, command: &Command<T>) -> Result<(), Diverged>;
    /// Moves to `until`, which is now but for its derivatives.
    fn nudge(&mut self, until: T, command: &Command<T>);
}

/// The control law evaluated at one instant; its integral grows by one period.
fn sampled_command<T: Real>(body: &mut impl Mechanism<T>, setpoint: Setpoint<T>, period_s: f64) -> T {
    let State { angle_rad, rate_rad_s } = body.seen();
    let integral = *body.integral_mut();
    let chain = body.chain();
    let [angle_rad, rate_rad_s] = chain.reading(body.now_s(), angle_rad, rate_rad_s);
    let Some(motor) = &chain.motor else { return T::nought() };
    let command = motor.command(setpoint, angle_rad, rate_rad_s, integral);
    *body.integral_mut() += (setpoint.angle_rad - angle_rad) * period_s;
    command
}

fn walk<T: Real>(
    mut body: impl Mechanism<T>,
    input: Input<'_>,
    t_s: &[f64],
    start: Start<T>,
    view: View,
    visit: &mut dyn FnMut(usize, &State<T>),
) -> Result<(), Diverged> {
    let mut release_s = start.release_s;
    let sample_period_s = match input {
        Input::Position { .. } | Input::Messages { .. } => {
            body.chain().motor.as_ref().and_then(|m| m.sample_period_s())
        }
        _ => None,
    };
    let mut schedule = Schedule::new(input, t_s, body.chain().setpoint);
    let mut ticks = 0u64;
    let mut held = Command::Off;
    visit(0, &shown(&body, view));
    for k in 1..t_s.len() {
        let to = t_s[k];
        loop {
            let now = body.now_s();
            let mut until = T::constant(to);
            let mut event = Event::None;
            // A change that falls on a sample comes after it: the sample is a state at a constant instant.
            if let Some(at) = schedule.next_change()
                && at.re() < to
            {
                if at.re() <= now.re() {
                    // What a part of a log begins with was taken over before it.
                    if now.re() - at.re() <= SAME_INSTANT_S {
                        body.nudge(at, &schedule.command(k));
                    }
                    schedule.change();
                    continue;
                }
                (until, event) = (at, Event::Change);
            }
            if let Some(r) = release_s
                && r.re() <= until.re()
            {
                (until, event) = (r, Event::Release);
            }
            let mut command = schedule.command(k);
            if let (Some(period_s), Some(setpoint)) = (sample_period_s, command.setpoint(now)) {
                let next_tick = t_s[0] + ticks as f64 * period_s;
                // What a tick that falls on a sample sees must not hang on how their times are rounded.
                if next_tick <= now.re() + SAME_INSTANT_S {
                    held = command.held(sampled_command(&mut body, setpoint, period_s), now);
                    // Ticks that have passed while the motor was off are over.
                    ticks = ticks.max(((now.re() + SAME_INSTANT_S - t_s[0]) / period_s) as u64) + 1;
                    continue;
                }
                if next_tick < until.re() - SAME_INSTANT_S {
                    (until, event) = (T::constant(next_tick), Event::None);
                }
                command = held;
            }
            body.advance(until, &command)?;
            if body.now_s().re().is_nan() {
                // Torques beyond all numbers make an event at no instant, and time would never go on.
                return Err(Diverged { at_s: now.re() });
            }
            // An event that falls on a sample must still bear its derivative: the clock takes it over.
            if event != Event::None && until.re() >= body.now_s().re() {
                *body.clock_mut() = until;
            }
            match event {
                Event::Release => {
                    release_s = None;
                    body.let_go();
                }
                Event::Change => schedule.change(),
                Event::None => {}
            }
            if body.now_s().re() >= to {
                break;
            }
        }
        let state = body.state();
        if !(state.angle_rad.re().abs() < RUNAWAY_RAD && state.rate_rad_s.re().is_finite()) {
            return Err(Diverged { at_s: to });
        }
        visit(k, &shown(&body, view));
    }
    Ok(())
}

fn shown<T: Real>(body: &impl Mechanism<T>, view: View) -> State<T> {
    match view {
        View::Link => body.state(),
        View::Reading => {
            let seen = body.seen();
            let [angle_rad, rate_rad_s] = body.chain().reading(body.now_s(), seen.angle_rad, seen.rate_rad_s);
            State { angle_rad, rate_rad_s }
        }
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Event {
    None,
    Change,
    Release,
}

#[cfg(test)]
#[path = "rollout_tests.rs"]
mod tests;
