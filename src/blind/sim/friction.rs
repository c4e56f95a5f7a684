//! Friction of the made joints.

use crate::number::math;

/// How friction falls from static to Coulomb's with speed.
#[derive(Clone, Copy, Debug)]
pub(in crate::blind) enum Curve {
    /// `exp(-(v/v_st)^2)`
    Gaussian,
    /// `exp(-|v|/v_st)`
    Exponential,
    /// `1 / (1 + (v/v_st)^2)`
    Rational,
}

/// Static friction above Coulomb's.
#[derive(Clone, Copy, Debug)]
pub(in crate::blind) struct Stribeck {
    /// `mu_st - mu_c` \[N m\].
    pub excess_nm: f64,
    /// `v_st` \[rad/s\].
    pub speed_rad_s: f64,
    pub curve: Curve,
}

/// Coulomb friction over the angle: `mu_c (1 + a shape(q - phi))`.
#[derive(Clone, Copy, Debug)]
pub(in crate::blind) struct OverAngle {
    pub a: f64,
    pub phi_rad: f64,
    /// A narrow bump `2 exp(1.5 (cos x - 1)) - 1` instead of `cos x`.
    pub narrow: bool,
}

/// All there is about friction; the default is none.
#[derive(Clone, Debug, Default)]
pub(in crate::blind) struct Friction {
    /// \[N m\]
    pub coulomb_nm: f64,
    /// \[N m s/rad\]
    pub viscous_nm_s_rad: f64,
    pub stribeck: Option<Stribeck>,
    /// Share of the gravity torque on the bearing.
    pub load: f64,
    /// How much of the gravity force along the link presses too.
    pub load_along: f64,
    /// Share of the motor torque.
    pub gear: f64,
    /// Motor torque at which the gears' loss has come to half its slope \[N m\].
    pub gear_knee_nm: f64,
    /// `c |v|^p`: coefficient.
    pub drag: f64,
    /// `c |v|^p`: power.
    pub drag_power: f64,
    /// Half the difference of the two directions \[N m\].
    pub asymmetry_nm: f64,
    /// The difference is a third less at speeds far below this \[rad/s\].
    pub asymmetry_fade_rad_s: f64,
    pub over_angle: Option<OverAngle>,
    /// Viscous friction times `1 + a cos(n (q - phi))`: a, n, phi.
    pub viscous_over_angle: Option<[f64; 3]>,
    /// Coulomb and viscous scale as `1 + r t` \[1/s\].
    pub drift_1_s: f64,
    /// The drift comes to rest with this time constant \[s\]; 0: never.
    pub drift_settles_s: f64,
    /// Coulomb friction takes this factor ...
    pub jump: f64,
    /// ... from these instants on, by log \[s\].
    pub jump_at_s: Vec<f64>,
    /// Displacement over which dry friction builds up \[rad\]; 0: rigid.
    pub bristle_rad: f64,
    /// Damping of that displacement, as its torque over that of its stiffness \[s\].
    pub bristle_damping_s: f64,
    /// Time constant with which the dry friction follows the speed \[s\]; 0: at once.
    pub memory_s: f64,
}

/// The conditions under which friction acts.
#[derive(Clone, Copy, Debug)]
pub(in crate::blind) struct Contact {
    pub t_s: f64,
    pub q_rad: f64,
    pub v_rad_s: f64,
    /// Speed that the dry friction sees, without sign \[rad/s\].
    pub dry_speed_rad_s: f64,
    /// Gravity torque of link and extra mass \[N m\].
    pub gravity_nm: f64,
    /// Its largest value over a turn \[N m\].
    pub peak_gravity_nm: f64,
    pub motor_nm: f64,
    /// Index of the log.
    pub log: usize,
}

impl Friction {
    fn drift(&self, t_s: f64) -> f64 {
        if self.drift_1_s == 0.0 {
            return 1.0;
        }
        let t_s = if self.drift_settles_s > 0.0 {
            self.drift_settles_s * (1.0 - math::exp(-t_s / self.drift_settles_s))
        } else {
            t_s
        };
        (1.0 + self.drift_1_s * t_s).max(0.0)
    }

    /// Dry friction torque against motion upwards and downwards \[N m\], neither below zero.
    pub(in crate::blind) fn dry_nm(&self, at: &Contact) -> (f64, f64) {
        let mut level = self.coulomb_nm;
        if let Some(over) = &self.over_angle {
            let cos = math::cos(at.q_rad - over.phi_rad);
            let shape = if over.narrow { 2.0 * math::exp(1.5 * (cos - 1.0)) - 1.0 } else { cos };
            level *= (1.0 + over.a * shape).max(0.0);
        }
        if self.jump != 0.0 && self.jump_at_s.get(at.log).is_some_and(|jump| at.t_s >= *jump) {
            level *= self.jump;
        }
        level *= self.drift(at.t_s);
        if let Some(s) = &self.stribeck {
            let x = at.dry_speed_rad_s / s.speed_rad_s;
            level += s.excess_nm
                * match s.curve {
                    Curve::Gaussian => math::exp(-x * x),
                    Curve::Exponential => math::exp(-x),
                    Curve::Rational => 1.0 / (1.0 + x * x),
                };
        }
        if self.load != 0.0 {
            let along_2 = (at.peak_gravity_nm.powi(2) - at.gravity_nm.powi(2)).max(0.0);
            level += self.load * (at.gravity_nm.powi(2) + self.load_along.powi(2) * along_2).sqrt();
        }
        if self.gear != 0.0 {
            let torque = at.motor_nm.abs();
            let knee = if self.gear_knee_nm > 0.0 { torque / (torque + self.gear_knee_nm) } else { 1.0 };
            level += self.gear * torque * knee;
        }
        if self.asymmetry_nm == 0.0 {
            return (level.max(0.0), level.max(0.0));
        }
        let fade = if self.asymmetry_fade_rad_s > 0.0 {
            1.0 - math::exp(-at.dry_speed_rad_s / self.asymmetry_fade_rad_s) / 3.0
        } else {
            1.0
        };
        let delta = self.asymmetry_nm * fade;
        ((level + delta).max(0.0), (level - delta).max(0.0))
    }

    /// Viscous friction and drag as a signed torque \[N m\].
    pub(in crate::blind) fn wet_nm(&self, at: &Contact) -> f64 {
        let mut viscous = self.viscous_nm_s_rad * self.drift(at.t_s);
        if let Some([a, n, phi]) = self.viscous_over_angle {
            viscous *= (1.0 + a * math::cos(n * (at.q_rad - phi))).max(0.0);
        }
        let mut torque = -viscous * at.v_rad_s;
        if self.drag != 0.0 {
            torque -= self.drag * math::powf(at.v_rad_s.abs(), self.drag_power).copysign(at.v_rad_s);
        }
        torque
    }

    /// Lets dry friction build up over a displacement instead of at once.
    ///
    /// Damped a little (a ratio of 0.15), so that a joint that its friction has caught comes to rest.
    pub(in crate::blind) fn soften(&mut self, bristle_rad: f64, inertia_kg_m2: f64) {
        self.bristle_rad = bristle_rad;
        let rate_1_s = (self.coulomb_nm / (bristle_rad * inertia_kg_m2)).sqrt();
        self.bristle_damping_s = 0.3 / rate_1_s.max(1.0);
    }

    /// Moves the bristle along and gives its torque \[N m\].
    ///
    /// Dahl's model, with the deflection as a share of its end, and a damping of the deflection as LuGre has it.
    pub(in crate::blind) fn bristle_nm(&self, bristle: &mut f64, v_rad_s: f64, step_s: f64, dry_nm: (f64, f64)) -> f64 {
        let before = *bristle;
        let x = v_rad_s * step_s / self.bristle_rad;
        *bristle = (before + x) / (1.0 + x.abs());
        let rate_1_s = (*bristle - before) / step_s;
        let level_nm = if *bristle > 0.0 { dry_nm.0 } else { dry_nm.1 };
        -level_nm * (*bristle + self.bristle_damping_s * rate_1_s)
    }
}

/// Speed after a step of dry friction: set-valued, so a body that friction can stop within the step stands.
///
/// `free` is the speed without dry friction, `up` and `down` what friction takes away at the most in the step, all
/// \[rad/s\].
pub(in crate::blind) fn stopped(free: f64, up: f64, down: f64) -> f64 {
    if free > up {
        free - up
    } else if free < -down {
        free + down
    } else {
        0.0
    }
}
