//! One joint put together from its stages.

use super::motor::Driven;
use super::{
    Carriage, Compliance, Contact, Eccentric, EndStop, Friction, Law, Link, Motor, Play, Real, Setpoint, SetpointPath,
    Spring, SpringCurve,
};
use crate::log::{EncoderSide, MotorSpec};

/// The joint of one log: what the setpoint passes through, motor, link, friction, and what the encoder makes of it.
///
/// [`Chain::new`] makes a perfect one; effects put their terms on its stages.
pub struct Chain<T: Real> {
    /// When and how often setpoints reach the controller.
    pub setpoint: SetpointPath<T>,
    /// `None` where nothing drives the joint.
    pub motor: Option<Motor<T>>,
    /// Free play between motor side and link.
    pub play: Option<Play<T>>,
    /// A spring between motor side and link.
    pub compliance: Option<Compliance<T>>,
    /// Inertia of rotor and gears as the joint feels it, whether the motor is on or off \[kg m^2\]; on the motor side of
    /// a play.
    pub armature_kg_m2: T,
    /// Inertia and gravity; nominal ones, where time changes them.
    pub link: Link<T>,
    /// How time changes them, because other joints of a robot move.
    pub carriage: Option<Carriage>,
    /// What resists.
    pub friction: Friction<T>,
    /// A spring in parallel to the joint.
    pub spring: Option<Spring<T>>,
    /// A stop at one end of the range.
    pub stop: Option<EndStop<T>>,
    /// The side of the gearing that encoder and controller see; one as good as the other where nothing gives.
    pub encoder: EncoderSide,
    /// Reading per true angle; 1 for a perfect encoder. The controller sees the reading.
    pub sensor_gain: T,
    /// What the encoder adds once per turn, after the gain.
    pub eccentric: Option<Eccentric<T>>,
    /// The reading is this old \[s\]; the controller sees it so.
    pub sensor_delay_s: Option<T>,
    /// Laws without a formula, those of friction included, which act as its terms: [`Chain::add_law`].
    pub(crate) laws: Vec<Law<T>>,
}

/// A spring between motor side and link is rigid where the two would swing faster than this against each other
/// \[rad/s\]: no log shows it.
const RIGID_RAD_S: f64 = 3e3;

/// Motor side and link apart.
#[derive(Clone, Copy)]
pub(crate) struct TwoSides<T> {
    /// Free play between them \[rad\].
    pub width_rad: Option<T>,
    /// A spring between them.
    pub compliance: Option<Compliance<T>>,
    /// Inertia of the motor side \[kg m^2\].
    pub motor_side_kg_m2: T,
}

impl<T: Real> Chain<T> {
    /// A joint that is perfect but for its friction.
    pub fn new(link: Link<T>, friction: Friction<T>, motor: Option<Motor<T>>) -> Self {
        Self {
            setpoint: SetpointPath::default(),
            motor,
            play: None,
            compliance: None,
            armature_kg_m2: T::nought(),
            link,
            carriage: None,
            friction,
            spring: None,
            stop: None,
            encoder: EncoderSide::default(),
            sensor_gain: T::constant(1.0),
            eccentric: None,
            sensor_delay_s: None,
            laws: Vec::new(),
        }
    }

    /// The same joint with the gears of a motor: their inertia, and the side on which the encoder sits.
    pub fn geared(self, spec: Option<&MotorSpec>) -> Self {
        match spec {
            Some(spec) => Self { armature_kg_m2: T::constant(spec.armature_kg_m2), encoder: spec.encoder, ..self },
            None => self,
        }
    }

    /// Inertia of all that turns with the joint \[kg m^2\].
    #[inline]
    pub fn inertia_kg_m2(&self) -> T {
        self.link.inertia_kg_m2 + self.armature_kg_m2
    }

    /// The link at an instant, and what the motion of other joints pushes \[N m\].
    #[inline]
    pub fn link_at(&self, t_s: T) -> (Link<T>, T) {
        match &self.carriage {
            None => (self.link, T::nought()),
            // What is not fitted does not carry its derivatives along.
            Some(carriage) if t_s.is_constant() => {
                let now = carriage.at(t_s.re());
                (self.link.carrying(&now), self.link.inertia_kg_m2 * now.pushed_rad_s2)
            }
            Some(carriage) => {
                let now = carriage.at(t_s);
                (self.link.carrying(&now), self.link.inertia_kg_m2 * now.pushed_rad_s2)
            }
        }
    }

    /// What a function makes of the link at an instant, and of what the motion of other joints pushes \[N m\].
    #[inline(always)]
    fn with_link<R>(&self, t_s: T, f: impl FnOnce(&Link<T>, Option<T>) -> R) -> R {
        if self.carriage.is_none() {
            return f(&self.link, None);
        }
        let (link, pushed_nm) = self.link_at(t_s);
        f(&link, Some(pushed_nm))
    }

    /// Inertia of all that turns with the joint at an instant \[kg m^2\].
    #[inline]
    pub fn inertia_at_kg_m2(&self, t_s: T) -> T {
        self.link_at(t_s).0.inertia_kg_m2 + self.armature_kg_m2
    }

    /// Motor side and link, where something gives between them.
    pub(crate) fn two_sides(&self) -> Option<TwoSides<T>> {
        let of_play = self.play.as_ref().map(|play| play.motor_side_kg_m2);
        let of_spring = self.compliance.as_ref().map(|spring| spring.motor_side_kg_m2);
        let motor_side_kg_m2 = of_play.or(of_spring)? + self.armature_kg_m2;
        let whole = self.inertia_kg_m2().re();
        let least = motor_side_kg_m2.re() * (whole - motor_side_kg_m2.re()) / whole;
        let gives = |spring: &Compliance<T>| !(spring.stiffness_nm_rad.re() > RIGID_RAD_S.powi(2) * least);
        let compliance = self.compliance.filter(gives);
        let width_rad = self.play.as_ref().map(|play| play.width_rad);
        (width_rad.is_some() || compliance.is_some()).then_some(TwoSides { width_rad, compliance, motor_side_kg_m2 })
    }

    /// Torque of spring, stop and laws \[N m\], that of time aside, beside a gravity torque.
    #[inline]
    fn elastic_nm(&self, angle_rad: T, rate_rad_s: T, gravity_nm: T) -> T {
        let mut torque_nm = T::nought();
        if let Some(spring) = &self.spring {
            torque_nm += spring.torque_nm(angle_rad);
        }
        if let Some(stop) = &self.stop {
            torque_nm += stop.torque_nm(angle_rad, rate_rad_s);
        }
        if self.has_laws() {
            self.add_laws_of_state(angle_rad, rate_rad_s, gravity_nm, &mut torque_nm);
        }
        torque_nm
    }

    /// Torque of nominal gravity, spring, stop and laws \[N m\], that of time aside.
    #[inline]
    pub fn passive_nm(&self, angle_rad: T, rate_rad_s: T) -> T {
        let gravity_nm = self.link.gravity_nm(angle_rad);
        gravity_nm + self.elastic_nm(angle_rad, rate_rad_s, gravity_nm)
    }

    /// Torque of all that acts on the link beside motor and friction \[N m\].
    #[inline]
    pub fn acting_nm(&self, t_s: T, angle_rad: T, rate_rad_s: T) -> T {
        self.with_link(t_s, |link, pushed_nm| self.beside_drive_nm(link, pushed_nm, [t_s, angle_rad, rate_rad_s]).0)
    }

    /// The same of a link that is pushed, at an instant, angle and rate; and gravity's share.
    #[inline(always)]
    fn beside_drive_nm(&self, link: &Link<T>, pushed_nm: Option<T>, at: [T; 3]) -> (T, T) {
        let [t_s, angle_rad, rate_rad_s] = at;
        let gravity_nm = link.gravity_nm(angle_rad);
        let mut torque_nm = gravity_nm;
        if let Some(pushed_nm) = pushed_nm {
            torque_nm += pushed_nm;
        }
        if let Some(spring_nm) = self.carriage.as_ref().and_then(|carriage| carriage.spring_nm(angle_rad)) {
            torque_nm += spring_nm;
        }
        if self.is_elastic() {
            torque_nm += self.elastic_nm(angle_rad, rate_rad_s, gravity_nm);
        }
        if self.has_laws() {
            self.add_laws_of_time(t_s, &mut torque_nm);
        }
        (torque_nm, gravity_nm)
    }

    /// Whether anything but gravity and friction acts on the link by its state.
    #[inline(always)]
    fn is_elastic(&self) -> bool {
        self.spring.is_some() || self.stop.is_some() || self.has_laws()
    }

    /// Torque of all that acts on a resting link beside motor and friction, and gravity's share \[N m\].
    #[inline]
    pub(crate) fn acting_at_rest_nm(&self, t_s: T, angle_rad: T) -> [T; 2] {
        let at = [t_s, angle_rad, T::nought()];
        let (acting_nm, gravity_nm) = self.with_link(t_s, |link, pushed_nm| self.beside_drive_nm(link, pushed_nm, at));
        [acting_nm, gravity_nm]
    }

    /// Net torque on a resting joint without friction \[N m\] at an angle, for a motor torque.
    #[inline]
    pub fn drive_nm(&self, t_s: T, angle_rad: T, motor_nm: T) -> T {
        motor_nm + self.acting_nm(t_s, angle_rad, T::nought())
    }

    /// Torque that resists motion in `direction` \[N m\].
    #[inline]
    pub fn resistance_nm(&self, t_s: T, angle_rad: T, speed_rad_s: T, direction: f64, motor_nm: T) -> T {
        let gravity_nm = self.with_link(t_s, |link, _| link.gravity_nm(angle_rad));
        self.friction.resistance_nm(&Contact { t_s, angle_rad, speed_rad_s, direction, gravity_nm, motor_nm })
    }

    /// Angular acceleration \[rad/s^2\] of a joint that slips in `direction` (3.12).
    #[inline(always)]
    pub fn slip_rate_rad_s2(&self, t_s: T, angle_rad: T, rate_rad_s: T, direction: f64, motor_nm: T) -> T {
        self.with_link(t_s, |link, pushed_nm| {
            let (passive_nm, gravity_nm) = self.beside_drive_nm(link, pushed_nm, [t_s, angle_rad, rate_rad_s]);
            let speed_rad_s = rate_rad_s * direction;
            let at = Contact { t_s, angle_rad, speed_rad_s, direction, gravity_nm, motor_nm };
            (motor_nm + passive_nm - self.friction.resistance_nm(&at) * direction)
                / (link.inertia_kg_m2 + self.armature_kg_m2)
        })
    }

    /// What the encoder makes of a true angle and rate on its side of the gearing, at an instant \[s\].
    #[inline(always)]
    pub fn reading(&self, t_s: T, angle_rad: T, rate_rad_s: T) -> [T; 2] {
        let [angle_rad, rate_rad_s] = [angle_rad * self.sensor_gain, rate_rad_s * self.sensor_gain];
        let reading = match &self.eccentric {
            None => [angle_rad, rate_rad_s],
            Some(eccentric) => {
                let [reading_rad, slope] = eccentric.read(angle_rad);
                [reading_rad, rate_rad_s * slope]
            }
        };
        if self.has_laws() { self.with_laws_of_reading(t_s, reading) } else { reading }
    }

    /// What the encoder makes of a true angle at an instant.
    #[inline]
    pub fn reading_rad(&self, t_s: T, angle_rad: T) -> T {
        let reading_rad = match &self.eccentric {
            None => angle_rad * self.sensor_gain,
            Some(eccentric) => eccentric.read(angle_rad * self.sensor_gain)[0],
        };
        if self.has_laws() { self.with_laws_of_reading(t_s, [reading_rad, T::nought()])[0] } else { reading_rad }
    }

    /// The true angle and rate at which the encoder reads these at an instant, its delay aside.
    pub fn read_back(&self, t_s: T, reading_rad: T, reading_rad_s: T) -> [T; 2] {
        let mut reading = [reading_rad, reading_rad_s];
        if self.has_laws() {
            reading = self.without_laws_of_reading(t_s, reading);
        }
        let [reading_rad, reading_rad_s] = reading;
        let [angle_rad, rate_rad_s] = match &self.eccentric {
            None => [reading_rad, reading_rad_s],
            Some(eccentric) => {
                let angle_rad = eccentric.read_back(reading_rad);
                [angle_rad, reading_rad_s / eccentric.read(angle_rad)[1]]
            }
        };
        [angle_rad / self.sensor_gain, rate_rad_s / self.sensor_gain]
    }

    /// Whether encoder and controller see the true angle at once.
    pub fn reads_true(&self) -> bool {
        let at_once = self.sensor_delay_s.is_none();
        at_once && self.sensor_gain.re() == 1.0 && self.eccentric.is_none() && !self.has_laws_of_reading()
    }

    /// The torque that the motor's law asks of it and that arrives \[N m\], at an instant, a true angle and rate.
    #[inline]
    pub fn motor_nm(&self, t_s: T, setpoint: Setpoint<T>, [angle_rad, rate_rad_s]: [T; 2], integral_rad_s: T) -> T {
        self.turning_motor_nm(t_s, setpoint, [angle_rad, rate_rad_s, integral_rad_s], rate_rad_s)
    }

    /// The same, where the motor turns at another rate than the side of the gearing that the controller sees; `seen` is
    /// true angle and rate there, and the integral of the angle error.
    #[inline(always)]
    pub(crate) fn turning_motor_nm(&self, t_s: T, setpoint: Setpoint<T>, seen: [T; 3], motor_rad_s: T) -> T {
        let Some(motor) = &self.motor else { return T::nought() };
        let [angle_rad, rate_rad_s, integral_rad_s] = seen;
        let [reading_rad, reading_rad_s] = self.reading(t_s, angle_rad, rate_rad_s);
        motor.delivered_nm(motor.command(setpoint, reading_rad, reading_rad_s, integral_rad_s), motor_rad_s)
    }

    /// The torque that arrives of one that a log commands, or of an answer of the law that is held \[N m\].
    #[inline(always)]
    pub fn delivered_nm(&self, command: T, rate_rad_s: T) -> T {
        self.motor.as_ref().map_or(command, |motor| motor.delivered_nm(command, rate_rad_s))
    }

    /// Torque that it takes to move a joint at rest in `direction` \[N m\].
    pub fn breakaway_nm(&self, t_s: T, angle_rad: T, direction: f64, motor_nm: T) -> T {
        self.resistance_nm(t_s, angle_rad, T::nought(), direction, motor_nm)
    }

    /// Frequency \[rad/s\] of the fastest oscillation: gravity's, with the controller's stiffness where its law acts.
    pub(crate) fn fastest_rad_s(&self, driven: Driven) -> f64 {
        let (kp, _) = self.stiffness_and_damping(driven);
        let spring = self.spring.as_ref().map_or(0.0, |spring| spring.stiffness_nm_rad.re().abs());
        let described = self.carriage.as_ref().map_or(0.0, Carriage::stiffness_nm_rad);
        let [by_laws, _] = self.stiffness_and_damping_of_laws(driven, 0.0);
        ((self.link.peak_gravity_nm() + kp + spring + described + by_laws) / self.inertia_kg_m2().re()).sqrt()
    }

    /// What of a slipping joint's acceleration is linear in its angle and rate at an instant, friction's curves and gravity
    /// aside: stiffness \[1/s^2\] and decay \[1/s\], neither below zero.
    pub(crate) fn stiffness_and_decay(&self, t_s: f64, driven: Driven) -> [f64; 2] {
        let carried = self.carriage.as_ref().map_or(1.0, |carriage| carriage.at(t_s).inertia);
        let inertia = self.link.inertia_kg_m2.re() * carried + self.armature_kg_m2.re();
        let (kp, kd) = self.stiffness_and_damping(driven);
        let gain = self.sensor_gain.re();
        let described = self.carriage.as_ref().map_or(0.0, Carriage::stiffness_nm_rad);
        let spring = self.spring.as_ref().map_or(0.0, |spring| spring.stiffness_nm_rad.re());
        let damping = kd * gain + self.friction.viscous_nm_s_rad.re();
        [kp * gain + described + spring, damping].map(|slope| slope.max(0.0) / inertia)
    }

    /// The step \[s\] that keeps the fourth-order Runge-Kutta error far below a sensor step.
    ///
    /// A tenth of a radian of the fastest oscillation ([`Chain::fastest_rad_s`], which is the same all along a motion),
    /// or a quarter of the fastest decay: the phase error is then 1e-7 rad per step. Near a stop its stiffness counts, and no
    /// knot of a law may be stepped over.
    pub(crate) fn longest_step_s(
        &self,
        t_s: f64,
        fastest_rad_s: f64,
        angle_rad: f64,
        rate_rad_s: f64,
        driven: Driven,
    ) -> f64 {
        let (kp, kd) = self.stiffness_and_damping(driven);
        let speed_rad_s = rate_rad_s.abs();
        let inertia = self.inertia_kg_m2().re();
        let decay_1_s = (self.friction.slope_nm_s_rad(speed_rad_s, t_s) + kd) / inertia;
        let mut fastest_rad_s = fastest_rad_s;
        if let Some(spring @ Spring { curve: SpringCurve::Stiffening(_), .. }) = &self.spring {
            let stiffness = self.link.peak_gravity_nm() + kp + spring.slope_nm_rad(angle_rad);
            fastest_rad_s = fastest_rad_s.max((stiffness / inertia).sqrt());
        }
        let rate_1_s = (10.0 * fastest_rad_s).max(4.0 * decay_1_s).max(2.0 * speed_rad_s).max(1.0);
        let step_s = match self.has_laws() {
            true => 1.0 / rate_1_s.max(self.steps_for_laws_1_s(4.0 * decay_1_s, speed_rad_s, driven)),
            false => 1.0 / rate_1_s,
        };
        match &self.stop {
            Some(stop) => {
                let contact_s = stop.longest_step_s(inertia);
                // Away from the stop a step may not run into it by more than a contact's step would.
                let distance_s = stop.distance_rad(angle_rad) / speed_rad_s.max(1e-9);
                if distance_s <= 0.0 { step_s.min(contact_s) } else { step_s.min(distance_s.max(contact_s)) }
            }
            None => step_s,
        }
    }

    /// The step \[s\] over which what other joints do is known.
    pub(crate) fn longest_step_of_load_s(&self) -> f64 {
        self.carriage.as_ref().map_or(f64::INFINITY, Carriage::longest_step_s)
    }

    pub(super) fn stiffness_and_damping(&self, driven: Driven) -> (f64, f64) {
        self.motor.as_ref().map_or((0.0, 0.0), |motor| motor.stiffness_and_damping(driven))
    }
}
