//! The joint as two bodies: motor side and link side, with free play or a spring between them.
//!
//! Stiff inelastic flanks: while a flank is pressed both bodies move as one; they part when the flank would have to
//! pull, each then obeys its own torques, and when the play is used up they go on together with their common momentum.
//! The play begins on the flank that gravity loads.
//!
//! On a spring the two are always apart, and it pulls on both; it begins as far as gravity bends it.

use super::events::halved;
use super::history::History;
use super::rollout::{Diverged, Mechanism, Start, State};
use super::schedule::Command;
use crate::integrate::rk4;
use crate::joint::{Chain, Compliance, Driven, Real, TwoSides};
use crate::log::EncoderSide;

/// Halvings that separate the events of a step.
const HALVINGS: i32 = 16;
/// A margin (rad, rad/s or N m) that falls by less in a step passes zero at no instant that derivatives would know.
const BARELY: f64 = 1e-13;
/// Share that a rotor has at the most of what a joint carries, or is left with, as other joints move.
pub(crate) const ROTOR_AT_MOST: f64 = 0.8;
/// Share of the friction that acts on the link side, in its bearing; the gears have the rest.
pub(crate) const LINK_SHARE: f64 = 0.03;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Motion {
    Rest,
    Slip(f64),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Mode {
    /// Held by the experimenter.
    Clamped,
    /// Both bodies as one, on the flank on which the link is ahead (+1) or behind (-1).
    Engaged(f64, Motion),
    /// Link, then motor side.
    Apart(Motion, Motion),
}

/// What may end a step early; each is a function that falls through zero.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Event {
    LinkStops,
    MotorStops,
    LinkMoves,
    MotorMoves,
    /// The play is used up on this flank.
    Meets(f64),
    Parts,
}

pub(super) struct TwoBodies<'a, T: Real> {
    chain: &'a Chain<T>,
    width_rad: T,
    spring: Option<Compliance<T>>,
    /// What the motor side has at every instant: the armature \[kg m^2\].
    armature_kg_m2: T,
    /// What it has of the joint's nominal inertia besides \[kg m^2\].
    rotor_kg_m2: T,
    /// Where a late encoder still sees its side.
    history: Option<History<T>>,
    t_s: T,
    /// Angle and rate of the link, the same of the motor side, integral of the angle error.
    y: [T; 5],
    /// Whether that integral acts.
    winds_up: bool,
    flank: f64,
    mode: Mode,
    steps_left: usize,
    fastest_rad_s: f64,
    refinement: f64,
}

impl<'a, T: Real> TwoBodies<'a, T> {
    pub(super) fn new(
        chain: &'a Chain<T>,
        sides: TwoSides<T>,
        t_s: &[f64],
        start: Start<T>,
        refinement: f64,
        steps: usize,
    ) -> Self {
        let rate = start.rate_rad_s;
        let from_s = T::constant(t_s.first().copied().unwrap_or(0.0));
        let late = |delay_s: T| History::begin(delay_s, from_s, [start.angle_rad, rate]);
        let (history, angle) = chain.sensor_delay_s.map(late).unzip();
        let angle = angle.unwrap_or(start.angle_rad);
        let width_rad = sides.width_rad.unwrap_or(T::nought());
        let passive_nm = chain.acting_nm(from_s, angle, T::nought());
        let flank = if passive_nm.re() < 0.0 { -1.0 } else { 1.0 };
        // The start is where the encoder sits.
        let bent = sides.compliance.map_or(T::nought(), |spring| passive_nm / spring.stiffness_nm_rad);
        let ahead = width_rad * (0.5 * flank) + bent;
        let on_motor = if chain.encoder == EncoderSide::Motor { 1.0 } else { 0.0 };
        let mode = match (start.release_s, rate.re()) {
            (Some(_), _) => Mode::Clamped,
            (None, rate) if sides.compliance.is_some() => {
                let motion = if rate == 0.0 { Motion::Rest } else { Motion::Slip(rate.signum()) };
                Mode::Apart(motion, motion)
            }
            (None, rate) if rate != 0.0 => Mode::Engaged(flank, Motion::Slip(rate.signum())),
            (None, _) => Mode::Engaged(flank, Motion::Rest),
        };
        Self {
            chain,
            width_rad,
            spring: sides.compliance,
            armature_kg_m2: chain.armature_kg_m2,
            rotor_kg_m2: sides.motor_side_kg_m2 - chain.armature_kg_m2,
            history,
            t_s: from_s,
            y: [angle + ahead * on_motor, rate, angle - ahead * (1.0 - on_motor), rate, T::nought()],
            winds_up: chain.motor.as_ref().is_some_and(|motor| motor.winds_up()),
            flank,
            mode,
            steps_left: steps,
            fastest_rad_s: chain.fastest_rad_s(Driven::ByLaw),
            refinement,
        }
    }
}

impl<T: Real> Mechanism<T> for TwoBodies<'_, T> {
    fn chain(&self) -> &Chain<T> {
        self.chain
    }

    fn now_s(&self) -> T {
        self.t_s
    }

    fn clock_mut(&mut self) -> &mut T {
        &mut self.t_s
    }

    fn let_go(&mut self) {
        self.mode = match self.spring {
            None => Mode::Engaged(self.flank, Motion::Rest),
            Some(_) => Mode::Apart(Motion::Rest, Motion::Rest),
        };
    }

    fn state(&self) -> State<T> {
        State { angle_rad: self.y[0], rate_rad_s: self.y[1] }
    }

    fn seen(&self) -> State<T> {
        let [angle_rad, rate_rad_s] = self.seen_in(self.t_s, &self.y);
        State { angle_rad, rate_rad_s }
    }

    fn integral_mut(&mut self) -> &mut T {
        &mut self.y[4]
    }

    fn advance(&mut self, until: T, command: &Command<T>) -> Result<(), Diverged> {
        while self.t_s.re() < until.re() {
            if self.steps_left == 0 {
                return Err(Diverged { at_s: self.t_s.re() });
            }
            self.steps_left -= 1;
            self.settle(command);
            match self.mode {
                Mode::Clamped => self.t_s = until,
                _ => self.step(until, command)?,
            }
            let side = self.side(&self.y);
            if let Some(history) = &mut self.history {
                history.push(self.t_s, side);
            }
        }
        Ok(())
    }

    fn nudge(&mut self, until: T, command: &Command<T>) {
        let rate = self.rate(command, self.mode, self.t_s, &self.y);
        let step = until - self.t_s;
        self.y = std::array::from_fn(|i| self.y[i] + rate[i] * step);
        self.t_s = until;
    }
}

impl<T: Real> TwoBodies<'_, T> {
    /// Inertias of link and motor side at an instant \[kg m^2\]. Where other joints change what is carried the link must
    /// be left with some of it.
    #[inline]
    fn sides_kg_m2(&self, t_s: T) -> [T; 2] {
        let carried_kg_m2 = self.chain.link_at(t_s).0.inertia_kg_m2;
        let most_kg_m2 = carried_kg_m2 * ROTOR_AT_MOST;
        let is_too_much = self.chain.carriage.is_some() && most_kg_m2.re() < self.rotor_kg_m2.re();
        let rotor_kg_m2 = if is_too_much { most_kg_m2 } else { self.rotor_kg_m2 };
        [carried_kg_m2 - rotor_kg_m2, rotor_kg_m2 + self.armature_kg_m2]
    }

    /// Angle and rate of the side on which the encoder sits.
    #[inline]
    fn side(&self, y: &[T; 5]) -> [T; 2] {
        match self.chain.encoder {
            EncoderSide::Link => [y[0], y[1]],
            EncoderSide::Motor => [y[2], y[3]],
        }
    }

    /// What the encoder shows of it, before its gain.
    #[inline]
    fn seen_in(&self, t_s: T, y: &[T; 5]) -> [T; 2] {
        let side = self.side(y);
        self.history.as_ref().map_or(side, |history| history.at(t_s, side))
    }

    /// Torque of the spring on the link \[N m\].
    #[inline]
    fn spring_nm(&self, y: &[T; 5]) -> T {
        match &self.spring {
            None => T::nought(),
            Some(spring) => {
                let width_rad = self.chain.play.as_ref().map(|_| self.width_rad);
                spring.torque_nm(y[2] - y[0], y[3] - y[1], width_rad)
            }
        }
    }

    /// Torque on the link alone, without friction \[N m\].
    #[inline]
    fn on_link_nm(&self, t_s: T, y: &[T; 5]) -> T {
        self.chain.acting_nm(t_s, y[0], y[1]) + self.spring_nm(y)
    }

    fn motor_nm(&self, command: &Command<T>, t_s: T, y: &[T; 5]) -> T {
        let [angle, rate] = self.seen_in(t_s, y);
        command.turning_motor_nm(self.chain, t_s, &[angle, rate, y[4]], y[3])
    }

    /// Friction of the whole joint at a speed and direction \[N m\].
    fn resistance_nm(&self, t_s: T, angle_rad: T, speed: T, direction: f64, motor_nm: T) -> T {
        self.chain.resistance_nm(t_s, angle_rad, speed, direction, motor_nm)
    }

    /// Torque on a resting body beyond its breakaway \[N m\], and its direction; `share` of the friction holds it.
    fn beyond(&self, net_nm: T, share: f64, t_s: T, angle_rad: T, motor_nm: T) -> (T, f64) {
        let direction = if net_nm.re() < 0.0 { -1.0 } else { 1.0 };
        let held_nm = self.resistance_nm(t_s, angle_rad, T::nought(), direction, motor_nm) * share;
        (net_nm * direction - held_nm, direction)
    }

    fn motion_of(&self, (beyond, direction): (T, f64)) -> Motion {
        if beyond.re() > 0.0 { Motion::Slip(direction) } else { Motion::Rest }
    }

    /// Decides what resting bodies do, and whether pressed flanks stay pressed, at the present instant.
    fn settle(&mut self, command: &Command<T>) {
        let (t_s, y) = (self.t_s, self.y);
        let motor_nm = || self.motor_nm(command, t_s, &y);
        let link_alone = || self.beyond(self.on_link_nm(t_s, &y), LINK_SHARE, t_s, y[0], motor_nm());
        let motor_alone = || {
            let motor_nm = motor_nm();
            self.beyond(motor_nm - self.spring_nm(&y), 1.0 - LINK_SHARE, t_s, y[0], motor_nm)
        };
        let mut mode = self.mode;
        if let Mode::Engaged(flank, Motion::Rest) = mode {
            let link_alone = link_alone();
            let falls_away = link_alone.0.re() > 0.0 && link_alone.1 != flank;
            mode = if falls_away {
                Mode::Apart(Motion::Rest, Motion::Rest)
            } else {
                let (passive_nm, motor_nm) = (self.chain.acting_nm(t_s, y[0], y[1]), motor_nm());
                Mode::Engaged(flank, self.motion_of(self.beyond(passive_nm + motor_nm, 1.0, t_s, y[0], motor_nm)))
            };
        }
        if let Mode::Engaged(flank, Motion::Slip(direction)) = mode
            && self.pressing_nm(command, flank, direction, t_s, &y).re() < 0.0
        {
            let going = |rate: T| if rate.re() == 0.0 { Motion::Rest } else { Motion::Slip(rate.re().signum()) };
            mode = Mode::Apart(going(y[1]), going(y[3]));
        }
        if let Mode::Apart(link, motor) = mode {
            let link = if link == Motion::Rest { self.motion_of(link_alone()) } else { link };
            let motor = if motor == Motion::Rest { self.motion_of(motor_alone()) } else { motor };
            mode = Mode::Apart(link, motor);
        }
        self.mode = mode;
    }

    /// Acceleration of both bodies as one.
    fn together(&self, motor_nm: T, direction: f64, t_s: T, y: &[T; 5]) -> T {
        self.chain.slip_rate_rad_s2(t_s, y[0], y[1], direction, motor_nm)
    }

    /// Torque with which the flanks press \[N m\]; negative where they would have to pull.
    fn pressing_nm(&self, command: &Command<T>, flank: f64, direction: f64, t_s: T, y: &[T; 5]) -> T {
        let motor_nm = self.motor_nm(command, t_s, y);
        let own_nm = self.resistance_nm(t_s, y[0], y[1] * direction, direction, motor_nm) * (LINK_SHARE * direction);
        let on_link_nm = self.sides_kg_m2(t_s)[0] * self.together(motor_nm, direction, t_s, y)
            - self.chain.acting_nm(t_s, y[0], y[1])
            + own_nm;
        on_link_nm * -flank
    }

    fn rate(&self, command: &Command<T>, mode: Mode, t_s: T, y: &[T; 5]) -> [T; 5] {
        let nought = T::nought();
        let error = match self.winds_up {
            true => command.error_rad(self.chain, t_s, self.seen_in(t_s, y)[0]),
            false => nought,
        };
        match mode {
            Mode::Clamped | Mode::Engaged(_, Motion::Rest) => [nought, nought, nought, nought, error],
            Mode::Engaged(_, Motion::Slip(direction)) => {
                let a = self.together(self.motor_nm(command, t_s, y), direction, t_s, y);
                [y[1], a, y[1], a, error]
            }
            Mode::Apart(link, motor) => {
                let motor_nm = self.motor_nm(command, t_s, y);
                let friction = |rate: T, direction: f64, share: f64| {
                    self.resistance_nm(t_s, y[0], rate * direction, direction, motor_nm) * (share * direction)
                };
                let [link_kg_m2, motor_kg_m2] = self.sides_kg_m2(t_s);
                let a_link = match link {
                    Motion::Rest => nought,
                    Motion::Slip(d) => (self.on_link_nm(t_s, y) - friction(y[1], d, LINK_SHARE)) / link_kg_m2,
                };
                let a_motor = match motor {
                    Motion::Rest => nought,
                    Motion::Slip(d) => {
                        (motor_nm - self.spring_nm(y) - friction(y[3], d, 1.0 - LINK_SHARE)) / motor_kg_m2
                    }
                };
                [y[1], a_link, y[3], a_motor, error]
            }
        }
    }

    /// What may happen in a mode.
    fn possible(&self) -> [Option<Event>; 4] {
        match self.mode {
            Mode::Clamped => [None; 4],
            Mode::Engaged(_, Motion::Rest) => [Some(Event::LinkMoves), None, None, None],
            Mode::Engaged(_, Motion::Slip(_)) => [Some(Event::LinkStops), Some(Event::Parts), None, None],
            Mode::Apart(link, motor) => {
                let link = if link == Motion::Rest { Event::LinkMoves } else { Event::LinkStops };
                let motor = if motor == Motion::Rest { Event::MotorMoves } else { Event::MotorStops };
                match self.spring {
                    None => [link, motor, Event::Meets(1.0), Event::Meets(-1.0)].map(Some),
                    Some(_) => [Some(link), Some(motor), None, None],
                }
            }
        }
    }

    /// A function that is positive until the event.
    fn margin(&self, event: Event, command: &Command<T>, t_s: T, y: &[T; 5]) -> T {
        let motor_nm = || self.motor_nm(command, t_s, y);
        let direction = |motion: Motion| if let Motion::Slip(d) = motion { d } else { 0.0 };
        match (event, self.mode) {
            (Event::LinkStops, Mode::Engaged(_, motion) | Mode::Apart(motion, _)) => y[1] * direction(motion),
            (Event::MotorStops, Mode::Apart(_, motion)) => y[3] * direction(motion),
            (Event::LinkMoves, Mode::Engaged(..)) => {
                let motor_nm = motor_nm();
                let net_nm = self.chain.acting_nm(t_s, y[0], y[1]) + motor_nm;
                -self.beyond(net_nm, 1.0, t_s, y[0], motor_nm).0
            }
            (Event::LinkMoves, _) => -self.beyond(self.on_link_nm(t_s, y), LINK_SHARE, t_s, y[0], motor_nm()).0,
            (Event::MotorMoves, _) => {
                let motor_nm = motor_nm();
                -self.beyond(motor_nm - self.spring_nm(y), 1.0 - LINK_SHARE, t_s, y[0], motor_nm).0
            }
            (Event::Meets(flank), _) => self.width_rad * 0.5 - (y[0] - y[2]) * flank,
            (Event::Parts, Mode::Engaged(flank, Motion::Slip(d))) => self.pressing_nm(command, flank, d, t_s, y),
            _ => T::constant(1.0),
        }
    }

    /// One step, cut short at the first event in it.
    fn step(&mut self, until: T, command: &Command<T>) -> Result<(), Diverged> {
        let whole = until - self.t_s;
        let [angle, rate, _, motor_rate, _] = self.y;
        let fastest = rate.re().abs().max(motor_rate.re().abs());
        let mut longest_s =
            self.chain.longest_step_s(self.t_s.re(), self.fastest_rad_s, angle.re(), fastest, command.driven());
        let [link_kg_m2, motor_kg_m2] = self.sides_kg_m2(self.t_s).map(|side| side.re());
        if let Mode::Apart(..) = self.mode {
            // The lighter side alone is the faster.
            let share = motor_kg_m2.min(link_kg_m2) / self.chain.inertia_kg_m2().re();
            longest_s *= share.clamp(1e-3, 1.0).sqrt();
        }
        if let Some(spring) = &self.spring {
            let per_inertia = 1.0 / motor_kg_m2 + 1.0 / link_kg_m2;
            let swing_rad_s = (spring.stiffness_nm_rad.re() * per_inertia).sqrt();
            longest_s = longest_s.min(1.0 / (4.0 * swing_rad_s).max(3.0 * spring.damping_nm_s_rad.re() * per_inertia));
        }
        let of_load = whole.re() / self.chain.longest_step_of_load_s();
        let parts = (whole.re() * self.refinement / longest_s).max(of_load).ceil().max(1.0);
        if !(parts <= self.steps_left as f64) {
            return Err(Diverged { at_s: self.t_s.re() });
        }
        let step = if parts > 1.0 { whole * (1.0 / parts) } else { whole };
        let mode = self.mode;
        let (t_s, y) = (self.t_s, self.y);
        let rates = |t: T, y: &[T; 5]| self.rate(command, mode, t, y);
        let first = rates(t_s, &y);
        let after_plain = |dt: f64| rk4(rates, t_s, &y, &first, dt);
        let after = |dt: T| if dt.is_constant() { after_plain(dt.re()) } else { rk4(rates, t_s, &y, &first, dt) };
        let end = after(step);
        let margin = |event: Event, t_s: T, y: &[T; 5]| self.margin(event, command, t_s, y);
        let happening = self.possible().map(|event| event.filter(|&event| margin(event, t_s + step, &end).re() < 0.0));
        if happening.iter().all(Option::is_none) {
            self.y = end;
            self.t_s = if parts > 1.0 { t_s + step } else { until };
            return Ok(());
        }
        // Halving finds the earliest of them, and which it is; the rest is left to a faster method.
        let at = |event: Event, dt: f64| margin(event, t_s + dt, &after_plain(dt)).re();
        let mut events = happening.iter().flatten();
        let [low, high] = match (events.next(), events.next()) {
            (Some(&only), None) => {
                let ends = [margin(only, t_s, &y), margin(only, t_s + step, &end)].map(|margin| -margin.re());
                halved(|dt| -at(only, dt), ends, step.re(), HALVINGS)
            }
            _ => {
                let (mut low, mut high) = (0.0, step.re());
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (low + high);
                    let there = after_plain(middle);
                    let happened = |event: &Event| margin(*event, t_s + middle, &there).re() < 0.0;
                    if happening.iter().flatten().any(happened) { high = middle } else { low = middle }
                }
                [low, high]
            }
        };
        let lowest = |a: &&Event, b: &&Event| at(**a, high).total_cmp(&at(**b, high));
        let Some(&event) = happening.iter().flatten().min_by(lowest) else { return Ok(()) };
        let instant = falls_through_zero(|dt| at(event, dt), low, high);
        // One Newton step in T gives the instant its derivatives.
        let here = margin(event, t_s + instant, &after_plain(instant));
        let slope = (here.re() - at(event, instant * 0.999)) / (instant * 0.001);
        let dt = T::constant(instant);
        let dt = if slope * step.re() < -BARELY { dt - (here - here.re()) / slope } else { dt };
        self.y = after(dt);
        self.t_s = t_s + dt;
        self.happen(event);
        Ok(())
    }

    fn happen(&mut self, event: Event) {
        match (event, self.mode) {
            (Event::LinkStops, Mode::Engaged(flank, _)) => {
                (self.y[1], self.y[3]) = (T::nought(), T::nought());
                self.mode = Mode::Engaged(flank, Motion::Rest);
            }
            (Event::LinkStops, Mode::Apart(_, motor)) => {
                self.y[1] = T::nought();
                self.mode = Mode::Apart(Motion::Rest, motor);
            }
            (Event::MotorStops, Mode::Apart(link, _)) => {
                self.y[3] = T::nought();
                self.mode = Mode::Apart(link, Motion::Rest);
            }
            (Event::Parts, Mode::Engaged(_, Motion::Slip(d))) => {
                self.mode = Mode::Apart(Motion::Slip(d), Motion::Slip(d));
            }
            (Event::Meets(flank), _) => {
                let [link_kg_m2, motor_kg_m2] = self.sides_kg_m2(self.t_s);
                let momentum = link_kg_m2 * self.y[1] + motor_kg_m2 * self.y[3];
                let rate = momentum / (link_kg_m2 + motor_kg_m2);
                (self.y[1], self.y[3]) = (rate, rate);
                self.y[2] = self.y[0] - self.width_rad * (0.5 * flank);
                let motion = if rate.re() == 0.0 { Motion::Rest } else { Motion::Slip(rate.re().signum()) };
                self.mode = Mode::Engaged(flank, motion);
            }
            // A resting body that moves is settled at the next step.
            _ => {}
        }
    }
}

/// The instant between `low` and `high`, to within a millionth of their distance, at which a margin that is negative at
/// `high` falls through zero (Illinois method); `high` where it is negative at `low` too, or a motion that runs away has none.
fn falls_through_zero(margin: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let precise = 1e-6 * (high - low);
    let (mut f_low, mut f_high) = (margin(low), margin(high));
    if !(f_low > 0.0 && f_high < 0.0) {
        return high;
    }
    let mut last = 0;
    for _ in 0..30 {
        if high - low <= precise {
            break;
        }
        let between = (low * f_high - high * f_low) / (f_high - f_low);
        let middle = if between.is_finite() { between.clamp(low, high) } else { 0.5 * (low + high) };
        let f = margin(middle);
        if f == 0.0 || f.is_nan() {
            return middle;
        }
        if f > 0.0 {
            (low, f_low) = (middle, f);
            f_high *= if last == 1 { 0.5 } else { 1.0 };
            last = 1;
        } else {
            (high, f_high) = (middle, f);
            f_low *= if last == -1 { 0.5 } else { 1.0 };
            last = -1;
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::falls_through_zero;
    use approx::assert_relative_eq;

    #[test]
    fn a_margin_that_becomes_no_number_ends_the_search_within_its_bounds() {
        assert_relative_eq!(falls_through_zero(|x| 2.0 - x * x, 0.0, 2.0), 2f64.sqrt(), max_relative = 1e-5);
        assert_eq!(falls_through_zero(|x| if x < 1.0 { 1.0 } else { f64::NAN }, 0.0, 2.0), 2.0);
        let lost_inside = |x: f64| if (0.5..1.5).contains(&x) { f64::NAN } else { 1.0 - x };
        let end = falls_through_zero(lost_inside, 0.0, 2.0);
        assert!((0.0..=2.0).contains(&end), "{end}");
        let huge = |x: f64| 1e308 * (1.0 - x);
        assert_relative_eq!(falls_through_zero(huge, 0.0, 9.0), 1.0, max_relative = 1e-5);
    }
}
