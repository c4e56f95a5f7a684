//! What may be behind Table 3.1: effects of the catalogue, and what a bench may have done.

use super::bench::Setting;
use crate::joint::EffectId;

/// One thing that may have been otherwise.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    /// Its name; of an effect its id.
    pub name: &'static str,
    /// What its size is.
    pub size: &'static str,
    /// Unit of the size.
    pub unit: &'static str,
    /// From and to, as scanned.
    pub range: [f64; 2],
    apply: fn(&mut Setting, f64),
}

impl Candidate {
    /// The setting with this candidate at a size.
    pub fn at(&self, setting: &Setting, size: f64) -> Setting {
        let mut setting = setting.clone();
        (self.apply)(&mut setting, size);
        setting
    }

    /// Sizes that are scanned.
    pub(super) fn sizes(&self, count: usize) -> impl Iterator<Item = f64> + use<> {
        let [from, to] = self.range;
        (0..count).map(move |k| from + (to - from) * k as f64 / (count - 1) as f64)
    }
}

const fn candidate(
    name: &'static str,
    size: &'static str,
    unit: &'static str,
    range: [f64; 2],
    apply: fn(&mut Setting, f64),
) -> Candidate {
    Candidate { name, size, unit, range, apply }
}

/// A release angle in whole steps of 0.02 rad, so that few simple swings need to be made.
fn whole_steps(angle_rad: f64) -> f64 {
    (50.0 * angle_rad).round() / 50.0
}

/// Larger Coulomb friction, in the place of Table 3.3's.
pub(super) const COULOMB: Candidate = candidate("coulomb", "mu_c", "N m", [0.0, 0.08], |s, size| s.coulomb_nm = size);

/// Friction that grows with the gravity torque.
pub(super) const LOAD: Candidate = candidate("load_friction", "mu_l", "", [0.0, 0.4], |s, size| {
    s.effects.push((EffectId::LoadFriction, vec![size]));
});

/// Everything else that is scanned.
pub(super) const OTHERS: [Candidate; 14] = [
    candidate("viscous", "mu_v", "N m s/rad", [0.0, 0.05], |s, size| s.viscous_nm_s_rad = size),
    candidate("quadratic_drag", "c2", "N m s^2/rad^2", [0.0, 0.02], |s, size| {
        s.effects.push((EffectId::QuadraticDrag, vec![size]));
    }),
    candidate("stribeck", "mu_st - mu_c", "N m", [0.0, 0.06], |s, size| {
        // At a fifth of a radian per second the excess has fallen to a third.
        s.effects.push((EffectId::Stribeck, vec![size, 0.2]));
    }),
    candidate("asymmetric_friction", "delta", "N m", [-0.03, 0.03], |s, size| {
        s.effects.push((EffectId::AsymmetricFriction, vec![size]));
    }),
    candidate("position_friction", "a", "", [-1.0, 1.0], |s, size| {
        s.effects.push((EffectId::PositionFriction, vec![size, 0.0]));
    }),
    candidate("friction_drift", "r", "1/s", [-0.15, 0.5], |s, size| {
        s.effects.push((EffectId::FrictionDrift, vec![size]));
    }),
    candidate("joint_spring", "k", "N m/rad", [0.0, 0.2], |s, size| {
        s.effects.push((EffectId::JointSpring, vec![size, 0.0]));
    }),
    candidate("angle_offset", "d", "rad", [-0.1, 0.1], |s, size| {
        s.effects.push((EffectId::AngleOffset, vec![size]));
    }),
    candidate("sensor_gain", "e", "", [-0.2, 0.2], |s, size| {
        s.effects.push((EffectId::SensorGain, vec![size]));
    }),
    candidate("release of both tests", "angle", "rad", [0.15, 1.2], |s, size| s.release_rad = [whole_steps(size); 2]),
    candidate("release of the second test", "angle over the first's", "", [0.5, 2.0], |s, size| {
        s.release_rad[1] = whole_steps(s.release_rad[1] * size);
    }),
    candidate("mass of the second test", "true over written", "", [0.7, 1.4], |s, size| s.second_mass = size),
    candidate("distance in the second test", "true over written", "", [0.8, 1.25], |s, size| s.second_distance = size),
    candidate("g/L as set", "set over printed", "", [0.9, 1.1], |s, size| {
        s.g_over_l_1_s2 = s.g_over_l_1_s2.map(|g| g * (100.0 * size).round() / 100.0);
    }),
];
