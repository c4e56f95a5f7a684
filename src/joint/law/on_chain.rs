//! Laws on a chain: where they come into the joint's equations, and how short steps must be for them.

use super::{Law, LawActs, LawVariable, NEAR};
use crate::joint::{Chain, Driven, Real};

/// Steps that this part of the distance between two knots takes, at least.
const STEPS_PER_KNOT: f64 = 2.0;

impl<T: Real> Chain<T> {
    /// Puts a law on the joint, beside those that it has.
    ///
    /// Torques of angle, speed, load and time act on the link; those of motor torque and setpoint rate at the motor, behind
    /// its limits, and friction that depends on the motor's torque sees them. The variable of a law of the motor's torque is
    /// what the motor alone delivers.
    pub fn add_law(&mut self, law: Law<T>) {
        if law.acts == LawActs::Friction {
            self.friction.terms.push(Box::new(law.clone()));
        }
        self.laws.push(law);
    }

    /// Adds the torques that the joint's angle, rate and load alone bring about \[N m\].
    #[inline(never)]
    pub(in crate::joint) fn add_laws_of_state(&self, angle_rad: T, rate_rad_s: T, gravity_nm: T, torque_nm: &mut T) {
        for law in self.torques() {
            *torque_nm += match law.variable {
                LawVariable::Angle => law.at(angle_rad),
                LawVariable::Speed => law.at(rate_rad_s),
                LawVariable::Load => law.at(gravity_nm),
                LawVariable::MotorTorque | LawVariable::Time | LawVariable::SetpointRate => continue,
            };
        }
    }

    /// Adds the torques that time brings about \[N m\].
    #[inline(never)]
    pub(in crate::joint) fn add_laws_of_time(&self, t_s: T, torque_nm: &mut T) {
        for law in self.torques().filter(|law| law.variable == LawVariable::Time) {
            *torque_nm += law.at(t_s);
        }
    }

    /// What arrives of a torque of the motor \[N m\], with the laws of it, of its share and of the setpoint's rate; at an
    /// angle and rate of the joint.
    #[inline(never)]
    pub(crate) fn with_laws_of_drive(
        &self,
        delivered_nm: T,
        t_s: T,
        [angle_rad, rate_rad_s]: [T; 2],
        setpoint_rad_s: impl Fn() -> T,
    ) -> T {
        let mut torque_nm = delivered_nm;
        for law in &self.laws {
            torque_nm += match (law.acts, law.variable) {
                (LawActs::Torque, LawVariable::MotorTorque) => law.at(delivered_nm),
                (LawActs::Torque, LawVariable::SetpointRate) => law.at(setpoint_rad_s()),
                (LawActs::Gain, LawVariable::Angle) => law.at(angle_rad) * delivered_nm,
                (LawActs::Gain, LawVariable::Speed) => law.at(rate_rad_s) * delivered_nm,
                (LawActs::Gain, LawVariable::Time) => law.at(t_s) * delivered_nm,
                _ => continue,
            };
        }
        torque_nm
    }

    /// What the encoder's own laws make of a reading and its rate at an instant.
    #[inline(never)]
    pub(in crate::joint) fn with_laws_of_reading(&self, t_s: T, [reading_rad, reading_rad_s]: [T; 2]) -> [T; 2] {
        let Shift { by_rad, slope, creep_rad_s } = self.shift_of_reading(t_s, reading_rad);
        [reading_rad + by_rad, reading_rad_s * slope + creep_rad_s]
    }

    /// The reading of which the encoder's own laws make this one at an instant, and its rate.
    pub(in crate::joint) fn without_laws_of_reading(&self, t_s: T, [shown_rad, shown_rad_s]: [T; 2]) -> [T; 2] {
        let mut reading_rad = shown_rad;
        for _ in 0..INVERSIONS {
            let Shift { by_rad, slope, .. } = self.shift_of_reading(t_s, reading_rad);
            reading_rad -= (reading_rad + by_rad - shown_rad) / slope;
        }
        let Shift { slope, creep_rad_s, .. } = self.shift_of_reading(t_s, reading_rad);
        [reading_rad, (shown_rad_s - creep_rad_s) / slope]
    }

    fn shift_of_reading(&self, t_s: T, reading_rad: T) -> Shift<T> {
        let mut shift = Shift { by_rad: T::nought(), slope: T::constant(1.0), creep_rad_s: T::nought() };
        for law in self.laws_of_reading() {
            let of_time = law.variable == LawVariable::Time;
            let [value, slope] = law.curve.value_and_slope(if of_time { t_s } else { reading_rad });
            shift.by_rad += value;
            *(if of_time { &mut shift.creep_rad_s } else { &mut shift.slope }) += slope;
        }
        shift
    }

    /// Whether a resting joint may be moved by time alone.
    pub(crate) fn changes_with_time(&self) -> bool {
        self.carriage.is_some()
            || self.friction.changes_with_time()
            || self.laws.iter().any(|law| law.acts != LawActs::Friction && law.variable == LawVariable::Time)
    }

    /// Whether there are any. What they do is kept out of line: most joints have none.
    #[inline]
    pub(crate) fn has_laws(&self) -> bool {
        !self.laws.is_empty()
    }

    /// Whether the encoder has laws of its own.
    pub(in crate::joint) fn has_laws_of_reading(&self) -> bool {
        self.laws_of_reading().next().is_some()
    }

    /// What laws add to stiffness at the most, and to damping near a speed \[N m/rad, N m s/rad\], for the choice of the
    /// step.
    pub(in crate::joint) fn stiffness_and_damping_of_laws(&self, driven: Driven, speed_rad_s: f64) -> [f64; 2] {
        if !self.has_laws() {
            return [0.0; 2];
        }
        let (kp, kd) = self.stiffness_and_damping(driven);
        let mut sum = [0.0; 2];
        for law in &self.laws {
            let steepest = law.curve.steepest(f64::NEG_INFINITY, f64::INFINITY);
            let [stiffness, damping] = match (law.acts, law.variable) {
                (LawActs::Reading, LawVariable::Angle) | (LawActs::Torque, LawVariable::MotorTorque) => {
                    [kp * steepest, kd * steepest]
                }
                (LawActs::Torque, LawVariable::Angle) => [steepest, 0.0],
                (LawActs::Torque, LawVariable::Load) => [steepest * self.link.peak_gravity_nm(), 0.0],
                (LawActs::Torque, LawVariable::Speed) => {
                    let [slow, fast] = [NEAR * speed_rad_s, speed_rad_s / NEAR];
                    [0.0, law.curve.steepest(slow, fast).max(law.curve.steepest(-fast, -slow))]
                }
                // The share itself, and what the angle changes of the torque for an error of a radian.
                (LawActs::Gain, LawVariable::Angle) => {
                    [kp * (law.curve.largest() + steepest), kd * law.curve.largest()]
                }
                (LawActs::Gain, _) => [kp, kd].map(|of| of * law.curve.largest()),
                (LawActs::Torque, LawVariable::Time | LawVariable::SetpointRate)
                | (LawActs::Reading | LawActs::Friction, _) => [0.0; 2],
            };
            sum = [sum[0] + stiffness, sum[1] + damping];
        }
        sum
    }

    /// Steps per second that it takes to see every knot of the laws at a speed, and to follow what they damp beside a decay
    /// that alone takes `decaying_1_s`.
    #[inline(never)]
    pub(in crate::joint) fn steps_for_laws_1_s(&self, decaying_1_s: f64, speed_rad_s: f64, driven: Driven) -> f64 {
        let [_, damping] = self.stiffness_and_damping_of_laws(driven, speed_rad_s);
        let decay_1_s = decaying_1_s + 4.0 * damping / self.inertia_kg_m2().re();
        let of = |law: &Law<T>| {
            let finest = law.curve.finest();
            STEPS_PER_KNOT
                * match law.variable {
                    LawVariable::Angle => speed_rad_s / finest,
                    LawVariable::Load => speed_rad_s * self.link.peak_gravity_nm() / finest,
                    LawVariable::Time => 1.0 / finest,
                    LawVariable::Speed | LawVariable::MotorTorque | LawVariable::SetpointRate => 0.0,
                }
        };
        self.laws.iter().map(of).fold(decay_1_s, f64::max)
    }

    fn torques(&self) -> impl Iterator<Item = &Law<T>> {
        self.laws.iter().filter(|law| law.acts == LawActs::Torque)
    }

    fn laws_of_reading(&self) -> impl Iterator<Item = &Law<T>> {
        self.laws.iter().filter(|law| law.acts == LawActs::Reading)
    }
}

/// What the encoder's laws add to a reading: a shift, the slope of the whole over the angle, and a rate at rest.
struct Shift<T> {
    by_rad: T,
    slope: T,
    creep_rad_s: T,
}

/// Steps of Newton's method that find the reading behind another; each doubles the digits.
const INVERSIONS: usize = 12;
