//! Controller and motor: from a setpoint to the torque on the joint.

use super::Real;
use crate::log::{Derivative, MotorModel, MotorSpec, VoltageMotor};

/// A setpoint at one instant.
#[derive(Clone, Copy, Debug)]
pub struct Setpoint<T> {
    /// \[rad\]
    pub angle_rad: T,
    /// Its slope \[rad/s\]: zero while a step is held.
    pub rate_rad_s: T,
}

/// Linear torque-speed curve: the torque that is left falls from stall to zero at the no-load speed.
#[derive(Clone, Copy, Debug)]
pub struct SpeedLine<T> {
    /// At standstill \[N m\].
    pub stall_nm: T,
    /// Speed at which nothing is left \[rad/s\].
    pub no_load_rad_s: T,
    /// What it may do when it brakes.
    pub braking: Braking,
}

impl<T: Real> SpeedLine<T> {
    /// Torque that the back voltage takes \[N m\].
    #[inline]
    fn back_nm(&self, rate_rad_s: T) -> T {
        self.stall_nm * rate_rad_s / self.no_load_rad_s
    }
}

/// The largest torque of a motor that brakes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Braking {
    /// That at standstill: the current is limited too.
    #[default]
    Capped,
    /// The line goes on: the back voltage adds to the supply's. It then acts beyond a dead band too.
    Line,
    /// As `Line`, of a motor whose law gives a duty: what is asked for is the torque at standstill, less the back voltage's at
    /// any speed.
    Voltage,
}

/// What moves the joint at an instant, as far as the choice of the step is concerned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Driven {
    /// The motor is off, and its circuit open.
    Off,
    /// It holds a torque or a duty that it was told.
    Held,
    /// By a law that acts continuously.
    ByLaw,
}

/// A motor's largest torque.
#[derive(Clone, Copy, Debug)]
pub struct TorqueLimit<T> {
    /// \[N m\]
    pub most_nm: T,
    /// How it is reached.
    pub knee: Knee,
}

/// How a torque comes to its limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Knee {
    /// It is cut off there.
    #[default]
    Hard,
    /// By a hyperbolic tangent, as iron saturates.
    Soft,
}

impl<T: Real> TorqueLimit<T> {
    #[inline]
    fn of(&self, torque_nm: T) -> T {
        let ratio = torque_nm / self.most_nm;
        match self.knee {
            // Further out the tangent is 1, and its derivative would overflow.
            Knee::Soft if ratio.re().abs() < 18.0 => self.most_nm * ratio.tanh(),
            _ => saturated(torque_nm, self.most_nm),
        }
    }
}

/// Small torques that do not arrive.
#[derive(Clone, Copy, Debug)]
pub struct DeadBand<T> {
    /// \[N m\]
    pub band_nm: T,
    /// What arrives of a larger one.
    pub beyond: Beyond,
}

/// What arrives of a torque beyond a dead band.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Beyond {
    /// What it is larger.
    #[default]
    Rest,
    /// All of it: within a tenth of the band it comes up from nothing.
    Whole,
}

/// Half the width of a jump at the end of a dead band, as a share of the band: no log could tell it from a sharper one, and
/// an integrator can follow it.
const JUMP: f64 = 0.1;

impl<T: Real> DeadBand<T> {
    #[inline]
    fn of(&self, torque_nm: T) -> T {
        let sign = if torque_nm.re() < 0.0 { -1.0 } else { 1.0 };
        let begins_nm = match self.beyond {
            Beyond::Rest => self.band_nm,
            Beyond::Whole => self.band_nm * (1.0 - JUMP),
        };
        let beyond_nm = torque_nm * sign - begins_nm;
        if beyond_nm.re() <= 0.0 {
            return T::nought();
        }
        let width_nm = self.band_nm * (2.0 * JUMP);
        match self.beyond {
            Beyond::Rest => beyond_nm * sign,
            Beyond::Whole if beyond_nm.re() < width_nm.re() => torque_nm * beyond_nm / width_nm,
            Beyond::Whole => torque_nm,
        }
    }
}

/// The controller with its motor: `a = kp (q_ref - q) + ki integral - kd dq`, then what the motor makes of it.
///
/// The answer `a` of the law is a torque, or the duty of a motor fed by voltage: `kt (a supply - kt q') / resistance` with
/// `a` within the duty limit, which brakes by its back-EMF whenever it is on. Gain and limits act on that.
#[derive(Clone, Copy, Debug)]
pub struct Motor<T> {
    /// The control law; `None` where the log gives the commanded torque itself.
    law: Option<MotorSpec>,
    /// Delivered torque per commanded torque, before any limit; 1 for a perfect motor.
    pub gain: T,
    /// Its derivative gain per stated one.
    pub derivative_share: T,
    /// Its integral gain per stated one.
    pub integral_share: T,
    /// Torques that do not arrive.
    pub dead_band: Option<DeadBand<T>>,
    /// A limit beside that of the control law, or in its place: [`Motor::limit_to`].
    pub torque_limit: Option<TorqueLimit<T>>,
    /// A torque-speed curve beyond that of the control law; it limits a motor that drives, not one that brakes.
    pub speed_line: Option<SpeedLine<T>>,
}

impl<T: Real> Motor<T> {
    /// The motor of a log that is driven by position, perfect but for the limits that the engineer models.
    pub fn new(spec: MotorSpec) -> Self {
        Self { law: Some(spec), ..Self::direct() }
    }

    /// A perfect motor whose commanded torque is in the log.
    pub fn direct() -> Self {
        let as_stated = T::constant(1.0);
        Self {
            law: None,
            gain: as_stated,
            derivative_share: as_stated,
            integral_share: as_stated,
            dead_band: None,
            torque_limit: None,
            speed_line: None,
        }
    }

    /// Period at which the law is evaluated \[s\]; `None`: continuously.
    pub fn sample_period_s(&self) -> Option<f64> {
        self.law.and_then(|law| law.sample_period_s)
    }

    /// A limit in the place of the one that the control law has, be it lower or higher; one that goes with a torque-speed curve
    /// stays beside it.
    pub fn limit_to(&mut self, limit: TorqueLimit<T>) {
        if let Some(law) = self.law.as_mut().filter(|law| law.speed_limit_rad_s.is_none()) {
            law.torque_limit_nm = None;
        }
        self.torque_limit = Some(limit);
    }

    /// The limit that the control law has, where none is in its place \[N m\].
    pub(crate) fn stated_limit_nm(&self) -> Option<f64> {
        self.law?.torque_limit_nm
    }

    /// True where a joint that stands still feels a torque that changes by itself.
    pub(crate) fn winds_up(&self) -> bool {
        self.law.is_some_and(|law| law.ki_nm_rad_s != 0.0)
    }

    /// The answer of the control law, a torque \[N m\] or a duty; angle and rate as the controller sees them,
    /// `integral_rad_s` is the integral of the angle error.
    #[inline(always)]
    pub fn command(&self, setpoint: Setpoint<T>, angle_rad: T, rate_rad_s: T, integral_rad_s: T) -> T {
        let Some(s) = &self.law else { return T::nought() };
        let mut torque = (setpoint.angle_rad - angle_rad) * s.kp_nm_rad;
        if s.ki_nm_rad_s != 0.0 {
            torque += integral_rad_s * self.integral_share * s.ki_nm_rad_s;
        }
        if s.kd_nm_s_rad != 0.0 {
            let too_fast = match s.derivative {
                Derivative::Error => rate_rad_s - setpoint.rate_rad_s,
                Derivative::Measurement => rate_rad_s,
            };
            torque -= too_fast * self.derivative_share * s.kd_nm_s_rad;
        }
        torque
    }

    /// The torque that arrives of what the law asks for \[N m\], for an encoder without gain.
    #[inline]
    pub fn torque_nm(&self, setpoint: Setpoint<T>, angle_rad: T, rate_rad_s: T, integral_rad_s: T) -> T {
        self.delivered_nm(self.command(setpoint, angle_rad, rate_rad_s, integral_rad_s), rate_rad_s)
    }

    /// What would arrive of an answer of the law \[N m\] if nothing were limited.
    #[inline(always)]
    pub(crate) fn unlimited_nm(&self, command: T, rate_rad_s: T) -> T {
        let voltage = self.voltage();
        let mut torque_nm = voltage.map_or(command, |motor| command * motor.stall_nm());
        if let Some(band) = self.dead_band {
            torque_nm = match (&self.speed_line, voltage) {
                // The supply's share of the torque is dead where it is small, not the torque.
                (Some(line), None) if line.braking == Braking::Line => {
                    let back_nm = line.back_nm(rate_rad_s);
                    band.of(torque_nm + back_nm) - back_nm
                }
                _ => band.of(torque_nm),
            };
        }
        if let Some(motor) = voltage {
            torque_nm -= rate_rad_s * motor.braking_nm_s_rad();
        }
        torque_nm *= self.gain;
        match self.speed_line {
            Some(line) if line.braking == Braking::Voltage => torque_nm - line.back_nm(rate_rad_s),
            _ => torque_nm,
        }
    }

    /// What arrives of an answer of the law \[N m\], at the true rate of the motor: dead band, gain, limits.
    #[inline(always)]
    pub fn delivered_nm(&self, command: T, rate_rad_s: T) -> T {
        let command = self.voltage().map_or(command, |motor| saturated(command, T::constant(motor.duty_limit)));
        let mut torque_nm = self.unlimited_nm(command, rate_rad_s);
        if let Some(law) = &self.law
            && let Some(stall_nm) = law.torque_limit_nm
        {
            let stall_nm = T::constant(stall_nm);
            torque_nm = match law.speed_limit_rad_s {
                Some(w_max) => {
                    let no_load_rad_s = T::constant(w_max);
                    on_line(torque_nm, rate_rad_s, SpeedLine { stall_nm, no_load_rad_s, braking: Braking::Capped })
                }
                None => saturated(torque_nm, stall_nm),
            };
        }
        if let Some(limit) = &self.torque_limit {
            torque_nm = limit.of(torque_nm);
        }
        match self.speed_line {
            Some(line) => on_line(torque_nm, rate_rad_s, line),
            None => torque_nm,
        }
    }

    /// Whether its torque is limited.
    fn is_limited(&self) -> bool {
        let by_law = self.law.is_some_and(|law| law.torque_limit_nm.is_some());
        by_law || self.voltage().is_some() || self.torque_limit.is_some() || self.speed_line.is_some()
    }

    /// Whether less may arrive of an answer of the law than its gain makes of it.
    pub(crate) fn bends(&self) -> bool {
        self.dead_band.is_some() || self.is_limited()
    }

    /// How much less the law answers per angle and per rate.
    pub(crate) fn answer_slopes(&self) -> (f64, f64) {
        self.law.map_or((0.0, 0.0), |law| (law.kp_nm_rad, law.kd_nm_s_rad * self.derivative_share.re()))
    }

    /// Stiffness and damping that the law adds to the joint \[N m/rad, N m s/rad\], for the choice of the step.
    pub(crate) fn stiffness_and_damping(&self, driven: Driven) -> (f64, f64) {
        let Some(law) = &self.law else { return (0.0, 0.0) };
        let gain = self.gain.re().abs();
        let by_line = self.speed_line.as_ref().filter(|line| line.braking == Braking::Voltage);
        let by_line = by_line.map_or(0.0, |line| line.back_nm(T::constant(1.0)).re());
        let braking = gain * self.voltage().map_or(0.0, VoltageMotor::braking_nm_s_rad) + by_line;
        match driven {
            Driven::Off => (0.0, 0.0),
            Driven::Held => (0.0, braking),
            Driven::ByLaw => {
                let per_answer = gain * law.nm_per_answer();
                let (kp, kd) = self.answer_slopes();
                (per_answer * kp, per_answer * kd + braking)
            }
        }
    }

    #[inline]
    fn voltage(&self) -> Option<&VoltageMotor> {
        match &self.law {
            Some(MotorSpec { model: MotorModel::Voltage(motor), .. }) => Some(motor),
            _ => None,
        }
    }
}

#[inline]
fn saturated<T: Real>(torque_nm: T, limit_nm: T) -> T {
    let sign = if torque_nm.re() < 0.0 { -1.0 } else { 1.0 };
    if torque_nm.re() * sign > limit_nm.re() { limit_nm * sign } else { torque_nm }
}

/// A torque under a torque-speed line.
#[inline]
fn on_line<T: Real>(torque_nm: T, rate_rad_s: T, line: SpeedLine<T>) -> T {
    if line.braking == Braking::Voltage {
        let back_nm = line.back_nm(rate_rad_s);
        let [most, least] = [line.stall_nm - back_nm, -line.stall_nm - back_nm];
        return match torque_nm.re() {
            above if above > most.re() => most,
            below if below < least.re() => least,
            _ => torque_nm,
        };
    }
    let sign = if torque_nm.re() < 0.0 { -1.0 } else { 1.0 };
    let driving_speed = rate_rad_s * sign;
    let mut limit = line.stall_nm;
    if driving_speed.re() > 0.0 || line.braking == Braking::Line {
        limit = line.stall_nm - line.stall_nm * driving_speed / line.no_load_rad_s;
        if limit.re() < 0.0 {
            limit = T::nought();
        }
    }
    if torque_nm.re() * sign > limit.re() { limit * sign } else { torque_nm }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Hold;
    use approx::assert_relative_eq;

    fn spec() -> MotorSpec {
        MotorSpec::pd(5.0, 0.05)
    }

    fn ask(spec: MotorSpec, error: f64, rate: f64) -> f64 {
        Motor::new(spec).torque_nm(Setpoint { angle_rad: error, rate_rad_s: 2.0 }, 0.0, rate, 0.3)
    }

    #[test]
    fn law_is_proportional_integral_and_derivative_on_the_measurement() {
        assert_relative_eq!(ask(spec(), 0.1, 2.0), 0.4, epsilon = 1e-15);
        assert_relative_eq!(ask(MotorSpec { ki_nm_rad_s: 2.0, ..spec() }, 0.1, 2.0), 1.0, epsilon = 1e-15);
    }

    #[test]
    fn derivative_on_the_error_feeds_the_setpoint_rate_forward() {
        let s = MotorSpec { derivative: Derivative::Error, hold: Hold::Linear, ..spec() };
        assert_relative_eq!(ask(s, 0.1, 2.0), 0.5, epsilon = 1e-15);
    }

    #[test]
    fn beyond_a_dead_band_arrives_the_rest_or_the_whole() {
        let arrives = |beyond, torque_nm: f64| DeadBand { band_nm: 0.1, beyond }.of(torque_nm);
        for sign in [-1.0, 1.0] {
            assert_eq!(arrives(Beyond::Rest, 0.099 * sign), 0.0);
            assert_relative_eq!(arrives(Beyond::Rest, 0.3 * sign), 0.2 * sign, epsilon = 1e-15);
            assert_eq!(arrives(Beyond::Whole, 0.089 * sign), 0.0);
            assert_relative_eq!(arrives(Beyond::Whole, 0.1 * sign), 0.05 * sign, epsilon = 1e-15);
            assert_eq!(arrives(Beyond::Whole, 0.111 * sign), 0.111 * sign);
        }
    }

    #[test]
    fn shares_scale_the_derivative_and_the_integral_gain_alone() {
        let law = MotorSpec { ki_nm_rad_s: 2.0, ..spec() };
        let motor = Motor { derivative_share: 2.0, integral_share: 0.5, ..Motor::new(law) };
        // 5 0.1 - 2 0.05 2 + 0.5 2 0.3
        let torque_nm = motor.torque_nm(Setpoint { angle_rad: 0.1, rate_rad_s: 2.0 }, 0.0, 2.0, 0.3);
        assert_relative_eq!(torque_nm, 0.6, epsilon = 1e-15);
        let (stiffness, damping) = motor.stiffness_and_damping(Driven::ByLaw);
        assert_relative_eq!(stiffness, 5.0, epsilon = 1e-15);
        assert_relative_eq!(damping, 0.1, epsilon = 1e-15);
    }

    fn by_voltage() -> MotorSpec {
        let model =
            MotorModel::Voltage(VoltageMotor { kt_nm_a: 1.5, resistance_ohm: 3.0, supply_v: 12.0, duty_limit: 0.9 });
        MotorSpec { model, ..spec() }
    }

    #[test]
    fn a_motor_fed_by_voltage_turns_duty_into_torque_and_brakes_by_its_back_emf() {
        // Duty 5 0.1 - 0.05 2 = 0.4; 1.5 (0.4 12 - 1.5 2) / 3 = 0.9 N m.
        assert_relative_eq!(ask(by_voltage(), 0.1, 2.0), 0.9, epsilon = 1e-15);
        // The duty ends at 0.9, whatever is asked for: 1.5 (10.8 - 3) / 3.
        assert_relative_eq!(ask(by_voltage(), 3.0, 2.0), 3.9, epsilon = 1e-14);
        let mut motor = Motor::new(MotorSpec { torque_limit_nm: Some(1.0), ..by_voltage() });
        motor.gain = 2.0;
        // Gain and limits act on what arrives.
        assert_relative_eq!(motor.delivered_nm(0.2, 2.0), -0.6, epsilon = 1e-15);
        assert_eq!(motor.delivered_nm(0.9, 2.0), 1.0);
    }

    #[test]
    fn a_torque_speed_line_ends_at_standstill_or_goes_on_and_brakes_within_a_dead_band() {
        let fed = |braking, band_nm: f64| {
            let mut motor = Motor::new(spec());
            motor.speed_line = Some(SpeedLine { stall_nm: 2.0, no_load_rad_s: 10.0, braking });
            motor.dead_band = (band_nm > 0.0).then_some(DeadBand { band_nm, beyond: Beyond::Rest });
            move |torque_nm: f64, rate_rad_s: f64| motor.delivered_nm(torque_nm, rate_rad_s)
        };
        for (braking, most_nm) in [(Braking::Capped, 2.0), (Braking::Line, 3.0)] {
            // At half the speed a half is left to drive with.
            assert_relative_eq!(fed(braking, 0.0)(9.0, 5.0), 1.0, epsilon = 1e-15);
            assert_relative_eq!(fed(braking, 0.0)(-9.0, 5.0), -most_nm, epsilon = 1e-15);
            assert_relative_eq!(fed(braking, 0.0)(9.0, -5.0), most_nm, epsilon = 1e-15);
        }
        // A duty of a half, and of all, less the back voltage's at any speed.
        let by_duty = fed(Braking::Voltage, 0.0);
        assert_eq!([1.0, 9.0, -1.0, -9.0].map(|asked_nm| by_duty(asked_nm, 5.0)), [0.0, 1.0, -2.0, -3.0]);
        assert_eq!(fed(Braking::Voltage, 0.3)(0.2, 5.0), -1.0);
        // At 5 rad/s the back voltage takes 1 N m: asked for -1.1 the supply adds 0.1, which is dead.
        assert_relative_eq!(fed(Braking::Line, 0.3)(-1.1, 5.0), -1.0, epsilon = 1e-15);
        assert_relative_eq!(fed(Braking::Line, 0.3)(-1.5, 5.0), -1.2, epsilon = 1e-15);
        assert_relative_eq!(fed(Braking::Capped, 0.3)(-1.1, 5.0), -0.8, epsilon = 1e-15);
    }

    #[test]
    fn stiffness_and_damping_are_slopes_of_the_delivered_torque() {
        for spec in [spec(), by_voltage()] {
            let motor = Motor { gain: 1.1, ..Motor::new(spec) };
            let (stiffness, damping) = motor.stiffness_and_damping(Driven::ByLaw);
            let at = |q, v| motor.torque_nm(Setpoint { angle_rad: 0.1, rate_rad_s: 0.0 }, q, v, 0.0);
            assert_relative_eq!((at(0.0, 0.2) - at(0.01, 0.2)) / 0.01, stiffness, max_relative = 1e-10);
            assert_relative_eq!((at(0.0, 0.2) - at(0.0, 0.3)) / 0.1, damping, max_relative = 1e-10);
            let (_, held) = motor.stiffness_and_damping(Driven::Held);
            let slope = motor.delivered_nm(0.1, 0.2) - motor.delivered_nm(0.1, 1.2);
            assert_relative_eq!(slope, held, epsilon = 1e-12);
            let line = SpeedLine { stall_nm: 9.0, no_load_rad_s: 20.0, braking: Braking::Voltage };
            let by_duty = Motor { speed_line: Some(line), ..motor };
            let (_, held) = by_duty.stiffness_and_damping(Driven::Held);
            let slope = by_duty.delivered_nm(0.1, 0.2) - by_duty.delivered_nm(0.1, 1.2);
            assert_relative_eq!(slope, held, epsilon = 1e-12);
        }
    }

    #[test]
    fn a_limit_that_is_found_takes_the_place_of_the_stated_one() {
        let stated = MotorSpec { torque_limit_nm: Some(0.5), ..spec() };
        let asked = |motor: Motor<f64>| motor.torque_nm(Setpoint { angle_rad: 9.0, rate_rad_s: 0.0 }, 0.0, 0.0, 0.0);
        assert_eq!(asked(Motor::new(stated)), 0.5);
        for most_nm in [0.3, 0.8] {
            let mut motor = Motor::new(stated);
            motor.limit_to(TorqueLimit { most_nm, knee: Knee::Hard });
            assert_eq!(asked(motor), most_nm);
        }
    }

    #[test]
    fn limits_bite_when_driving_and_not_when_braking() {
        let s = MotorSpec { torque_limit_nm: Some(0.5), speed_limit_rad_s: Some(5.0), ..spec() };
        assert_eq!(ask(s, 1.0, 0.0), 0.5);
        assert_relative_eq!(ask(s, 1.0, 2.5), 0.25, epsilon = 1e-15);
        assert_eq!(ask(s, 1.0, 9.0), 0.0);
        assert_eq!(ask(s, -1.0, 2.5), -0.5);
    }
}
