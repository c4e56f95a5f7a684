//! What a joint carries in a robot: an inertia and a load that change with time, because other joints move.
//!
//! Along the measured motion of all joints, joint j of a robot with a clamped base obeys `M_jj q'' = tau - F - b`, with
//! `M_jj` and `b` by inverse dynamics. About a turning joint neither its inertia nor what the others push depends on its
//! own angle, and gravity depends on it as that of a pendulum: `-g M* sin(q - rest)`, whose `M*` and rest angle the other
//! joints set. So a joint of a robot is the bench pendulum with a link that time changes, exactly, as long as the other
//! joints are where they were measured.

use super::{Link, Real};
use std::ops::Mul;
use std::sync::Arc;

/// What a joint carries at one instant, relative to its nominal link.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carried {
    /// `M_jj`, as a share of the nominal inertia.
    pub inertia: f64,
    /// Gravity as a vector, as a share of the nominal largest torque: `cos` and `sin` of the angle at which the joint
    /// would hang, times that share.
    pub gravity: [f64; 2],
    /// What the other joints' motion pushes, per nominal inertia \[rad/s^2\].
    pub pushed_rad_s2: f64,
}

impl Carried {
    /// Of a joint that carries its nominal link.
    pub const NOMINAL: Self = Self { inertia: 1.0, gravity: [1.0, 0.0], pushed_rad_s2: 0.0 };

    fn between<T: Real>(&self, next: &Self, share: T) -> CarriedNow<T> {
        let at = |a: f64, b: f64| share * (b - a) + a;
        CarriedNow {
            inertia: at(self.inertia, next.inertia),
            gravity: [at(self.gravity[0], next.gravity[0]), at(self.gravity[1], next.gravity[1])],
            pushed_rad_s2: at(self.pushed_rad_s2, next.pushed_rad_s2),
        }
    }
}

/// [`Carried`] at an instant that may depend on what is fitted.
#[derive(Clone, Copy)]
pub(super) struct CarriedNow<T> {
    pub inertia: T,
    pub gravity: [T; 2],
    pub pushed_rad_s2: T,
}

/// What a joint carries along a log, linear between its samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Carriage {
    t_s: Arc<[f64]>,
    carried: Arc<[Carried]>,
    /// Samples per second, on average.
    rate_1_s: f64,
    /// The longest step that follows what is known of the load.
    longest_step_s: f64,
    /// Stiffness \[N m/rad\] and rest angle \[rad\] of a spring on the joint, which is known.
    spring: Option<[f64; 2]>,
}

impl Carriage {
    /// What is carried at instants \[s\]; `None` where these do not increase, are not as many, or something is not finite.
    pub fn new(t_s: &[f64], carried: &[Carried]) -> Option<Self> {
        let finite =
            |c: &Carried| [c.inertia, c.gravity[0], c.gravity[1], c.pushed_rad_s2].iter().all(|x| x.is_finite());
        let sound = !t_s.is_empty()
            && t_s.len() == carried.len()
            && t_s.windows(2).all(|pair| pair[1] > pair[0])
            && carried.iter().all(|c| finite(c) && c.inertia > 0.0);
        let span_s = t_s.last().zip(t_s.first()).map_or(0.0, |(last, first)| last - first);
        let rate_1_s = if span_s > 0.0 { (t_s.len() - 1) as f64 / span_s } else { 0.0 };
        let longest_step_s = f64::INFINITY;
        sound.then(|| Self { t_s: t_s.into(), carried: carried.into(), rate_1_s, longest_step_s, spring: None })
    }

    /// The same known at every one of its instants, not as smoothed readings tell: no step may pass over two of them, so that
    /// Runge and Kutta's stages are at them.
    pub(crate) fn known_throughout(self) -> Self {
        Self { longest_step_s: 2.0 / self.rate_1_s, ..self }
    }

    /// The same with a spring on the joint as a description has it.
    pub(crate) fn with_spring(self, stiffness_nm_rad: f64, rest_rad: f64) -> Self {
        Self { spring: (stiffness_nm_rad != 0.0).then_some([stiffness_nm_rad, rest_rad]), ..self }
    }

    /// Torque of that spring \[N m\] at an angle; `None` without one.
    #[inline]
    pub(super) fn spring_nm<T: Real>(&self, angle_rad: T) -> Option<T> {
        self.spring.map(|[stiffness_nm_rad, rest_rad]| (angle_rad - rest_rad) * -stiffness_nm_rad)
    }

    /// Stiffness of that spring \[N m/rad\]; 0 without one.
    pub(super) fn stiffness_nm_rad(&self) -> f64 {
        self.spring.map_or(0.0, |[stiffness_nm_rad, _]| stiffness_nm_rad.abs())
    }

    /// The longest step that follows what is known of the load \[s\].
    pub(super) fn longest_step_s(&self) -> f64 {
        self.longest_step_s
    }

    /// The first sample after an instant. Where samples come evenly it is looked for only beside where it should be.
    #[inline]
    fn first_after(&self, t_s: f64) -> usize {
        let all = &*self.t_s;
        let near = (((t_s - all[0]) * self.rate_1_s) as usize).min(all.len() - 1);
        let is_first = |k: usize| (k == 0 || all[k - 1] <= t_s) && (k == all.len() || all[k] > t_s);
        match [near + 1, near, near + 2].into_iter().find(|k| *k <= all.len() && is_first(*k)) {
            Some(found) => found,
            None => all.partition_point(|t| *t <= t_s),
        }
    }

    /// What is carried at an instant.
    #[inline(never)]
    pub(super) fn at<T: Real>(&self, t_s: T) -> CarriedNow<T> {
        let after = self.first_after(t_s.re());
        let (from, to) = (after.saturating_sub(1), after.min(self.t_s.len() - 1));
        let span_s = self.t_s[to] - self.t_s[from];
        let inside = span_s > 0.0 && t_s.re() >= self.t_s[from];
        let share = if inside { (t_s - self.t_s[from]) / span_s } else { T::nought() };
        self.carried[from].between(&self.carried[to], share)
    }
}

impl<T: Real> Link<T> {
    /// The link with what is carried at an instant, which may be a plain number where the instant is one.
    #[inline(always)]
    pub(super) fn carrying<S>(self, now: &CarriedNow<S>) -> Self
    where
        T: Mul<S, Output = T>,
        S: Copy,
    {
        self.scaled(now.inertia, now.gravity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_load_is_linear_between_samples_and_holds_beyond_them() {
        let later = Carried { inertia: 3.0, gravity: [0.0, 2.0], pushed_rad_s2: 4.0 };
        let carriage = Carriage::new(&[0.0, 0.1], &[Carried::NOMINAL, later]).unwrap();
        let link = Link::new(2e-3, 5e-3, 0.0, 9.81);
        let middle = carriage.at(0.05);
        assert_relative_eq!(link.carrying(&middle).inertia_kg_m2, 4e-3, max_relative = 1e-14);
        assert_relative_eq!(middle.pushed_rad_s2, 2.0, max_relative = 1e-14);
        // Half of each vector: as much down as to the side.
        assert_relative_eq!(link.carrying(&middle).hanging_rad(), 2f64.atan2(1.0), max_relative = 1e-14);
        assert_eq!((carriage.at(-1.0).inertia, carriage.at(9.0).inertia), (1.0, 3.0));
    }

    #[test]
    fn what_makes_no_sense_is_refused() {
        assert!(Carriage::new(&[0.0, 0.0], &[Carried::NOMINAL; 2]).is_none());
        assert!(Carriage::new(&[0.0], &[Carried { inertia: f64::NAN, ..Carried::NOMINAL }]).is_none());
        assert!(Carriage::new(&[], &[]).is_none());
    }
}
