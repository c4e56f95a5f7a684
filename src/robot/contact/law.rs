//! One contact: forces and their derivatives (eqs 2.3-2.6).

use super::FloorParameters;
use super::exp::{exp, tanh};
use crate::number::math;
use nalgebra::{Matrix3, Vector3};

/// A point that friction holds creeps so slowly per newton \[N s/m\]: 6 micrometres in a minute under 1 N.
const HOLDING_N_S_M: f64 = 1e7;

/// Below this sliding speed friction is its slope at rest times the speed \[m/s\]; the tanh is straight there to 1e-12.
const STRAIGHT_M_S: f64 = 1e-9;

/// What the floor does at one point, world axes, and how that changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Normal force (2.3) \[N\].
    pub normal_n: f64,
    /// Normal force and friction (2.5) \[N\].
    pub force_n: Vector3<f64>,
    /// Torsion about the normal (2.6) \[N m\].
    pub moment_nm: Vector3<f64>,
    /// `-dF/du` by the velocity of the point \[N s/m\]; not symmetric: sliding does not change the normal force, sinking
    /// changes the friction.
    pub damping_n_s_m: Matrix3<f64>,
    /// `-dF/dx` by a shift of the point \[N/m\]; not symmetric for the same reason.
    pub stiffness_n_m: Matrix3<f64>,
    /// The part of the damping that an implicit step takes along: symmetric, no eigenvalue below 0 \[N s/m\].
    ///
    /// Left out are the friction's dependence on the normal force, and the falling branch of the Stribeck curve, which
    /// feeds energy into oscillations and would have to be resolved by the step anyway.
    pub implicit_damping_n_s_m: Matrix3<f64>,
    /// The same of the stiffness: normal to the floor \[N/m\].
    pub implicit_stiffness_n_m: Matrix3<f64>,
    /// Minus the slope of the torsion against the angular velocity, where it is not below 0 \[N m s/rad\].
    pub spin_damping_nm_s_rad: Matrix3<f64>,
}

/// Friction per normal force at a sliding speed: its value over the speed, and its slope.
#[derive(Clone, Copy)]
pub(super) struct Sliding {
    /// Friction coefficient.
    pub coefficient: f64,
    /// Coefficient over speed \[s/m\].
    pub over_speed_s_m: f64,
    /// Derivative of the coefficient by the speed \[s/m\].
    pub slope_s_m: f64,
}

impl FloorParameters {
    /// Friction coefficient (2.4) at a sliding speed, with all four parts:
    /// `mu_c + (mu_st tanh(s v) - mu_c) exp(-(v/v_st)^2) + mu_v v`.
    ///
    /// Without a Stribeck speed or without static friction that part is absent: `mu_c tanh(s v) + mu_v v`.
    pub fn friction_coefficient(&self, speed_m_s: f64) -> f64 {
        self.sliding(speed_m_s.abs()).coefficient
    }

    pub(super) fn sliding(&self, speed_m_s: f64) -> Sliding {
        let (mu_c, mu_st, mu_v) = (self.coulomb, self.static_friction, self.viscous_s_m);
        let (s, v_st, v) = (self.steepness_s_m, self.stribeck_speed_m_s, speed_m_s);
        let is_stribeck = v_st > 0.0 && mu_st > 0.0;
        if v < STRAIGHT_M_S {
            let slope = s * if is_stribeck { mu_st } else { mu_c } + mu_v;
            return Sliding { coefficient: slope * v, over_speed_s_m: slope, slope_s_m: slope };
        }
        let tanh = tanh(s * v);
        let tanh_slope = s * (1.0 - tanh * tanh);
        let (coefficient, slope_s_m) = if is_stribeck {
            let part = exp(-(v / v_st) * (v / v_st));
            let part_slope = -2.0 * v / (v_st * v_st) * part;
            let over = mu_st * tanh - mu_c;
            (mu_c + over * part + mu_v * v, mu_st * tanh_slope * part + over * part_slope + mu_v)
        } else {
            (mu_c * tanh + mu_v * v, mu_c * tanh_slope + mu_v)
        };
        Sliding { coefficient, over_speed_s_m: coefficient / v, slope_s_m }
    }

    /// What friction holds at the most, per normal force: the top of (2.4) near rest.
    pub fn breakaway(&self) -> f64 {
        let is_stribeck = self.stribeck_speed_m_s > 0.0 && self.static_friction > 0.0;
        if is_stribeck { self.static_friction } else { self.coulomb }
    }

    /// The contact of a point that has sunk in by a depth; `None` where it hangs above the floor.
    ///
    /// `normal` is the floor's, upwards; velocity and angular velocity are the body's, at the point.
    pub fn contact(
        &self,
        depth_m: f64,
        normal: &Vector3<f64>,
        velocity_m_s: &Vector3<f64>,
        rate_rad_s: &Vector3<f64>,
    ) -> Option<Contact> {
        self.contact_of(depth_m, normal, velocity_m_s, rate_rad_s, false)
    }

    /// The same of a point that friction may hold ([`super::Resting`]): a damper so stiff that it hardly creeps.
    pub(super) fn contact_of(
        &self,
        depth_m: f64,
        normal: &Vector3<f64>,
        velocity_m_s: &Vector3<f64>,
        rate_rad_s: &Vector3<f64>,
        is_held: bool,
    ) -> Option<Contact> {
        if !(depth_m > 0.0) {
            return None;
        }
        let (k_p, k_d) = (self.stiffness_n_m, self.damping_n_s_m2);
        let along = normal * normal.transpose();
        let sinking_m_s = -velocity_m_s.dot(normal);
        let power = if self.exponent == 1.0 { depth_m } else { math::powf(depth_m, self.exponent) };
        let steep = k_p + k_d * sinking_m_s;
        // A foot drawn out faster than the floor follows: no force, and none until it sinks again.
        if !(steep > 0.0) {
            return Some(Contact::nothing());
        }
        let normal_n = steep * power;
        let normal_slope_n_s_m = k_d * power;
        let normal_slope_n_m = steep * self.exponent * power / depth_m;
        let across_m_s = velocity_m_s + normal * sinking_m_s;
        let speed_m_s = across_m_s.norm();
        let direction = if speed_m_s < STRAIGHT_M_S { Vector3::zeros() } else { across_m_s / speed_m_s };
        let sliding = match is_held && normal_n > 0.0 {
            true => {
                let slope = HOLDING_N_S_M / normal_n;
                Sliding { coefficient: 0.0, over_speed_s_m: slope, slope_s_m: slope }
            }
            false => self.sliding(speed_m_s),
        };
        let spread = Matrix3::identity() - along;
        let sideways = |slope_s_m: f64| {
            (direction * direction.transpose()) * (slope_s_m - sliding.over_speed_s_m) + spread * sliding.over_speed_s_m
        };
        // What a change of the normal force by 1 does.
        let pushed = (normal - direction * sliding.coefficient) * normal.transpose();
        let spin = self.spin(normal_n, rate_rad_s.dot(normal));
        Some(Contact {
            normal_n,
            force_n: normal * normal_n - across_m_s * (normal_n * sliding.over_speed_s_m),
            moment_nm: -normal * spin.0,
            damping_n_s_m: pushed * normal_slope_n_s_m + sideways(sliding.slope_s_m) * normal_n,
            stiffness_n_m: pushed * normal_slope_n_m,
            implicit_damping_n_s_m: along * normal_slope_n_s_m + sideways(sliding.slope_s_m.max(0.0)) * normal_n,
            implicit_stiffness_n_m: along * normal_slope_n_m,
            spin_damping_nm_s_rad: along * spin.1.max(0.0),
        })
    }

    /// Torsional friction (2.6) against a spin and its slope: the law of (2.4) for the speed at the contact radius.
    fn spin(&self, normal_n: f64, spin_rad_s: f64) -> (f64, f64) {
        let radius_m = self.torsion_radius_m;
        if radius_m == 0.0 {
            return (0.0, 0.0);
        }
        let sliding = self.sliding((radius_m * spin_rad_s).abs());
        let scale = normal_n * radius_m * radius_m;
        (scale * sliding.over_speed_s_m * spin_rad_s, scale * sliding.slope_s_m)
    }
}

impl Contact {
    fn nothing() -> Self {
        let zero = Matrix3::zeros();
        Self {
            normal_n: 0.0,
            force_n: Vector3::zeros(),
            moment_nm: Vector3::zeros(),
            damping_n_s_m: zero,
            stiffness_n_m: zero,
            implicit_damping_n_s_m: zero,
            implicit_stiffness_n_m: zero,
            spin_damping_nm_s_rad: zero,
        }
    }
}
