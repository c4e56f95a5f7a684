//! Points that stand still.
//!
//! The friction of (2.4) is zero at rest, so a point under any load creeps: a robot that stands slides apart at about
//! 1 mm/s until its legs have no tension left. Real dry friction holds a point that has stood for a while. So a point
//! that has crept for the dwell time (1 s) is held by a damper so stiff that it hardly creeps, until that damper would have to
//! bear more than `mu_st F_n`; then (2.4) takes over again. Either way the force opposes the velocity: neither adds
//! energy. In a trot no foot stands for a second, so the reference walk is (2.4) alone from its first steps on.

/// Which points of a run rest.
#[derive(Clone, Debug, Default)]
pub struct Resting {
    points: Vec<Point>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Point {
    /// It has been slow from then on \[s\].
    since_s: Option<f64>,
    is_held: bool,
}

impl Resting {
    /// Nothing rests, whatever happens.
    pub const fn none() -> Self {
        Self { points: Vec::new() }
    }

    /// For a number of points, none of which rests yet.
    pub fn of(points: usize) -> Self {
        Self { points: vec![Point::default(); points] }
    }

    /// Whether friction holds a point.
    pub fn is_held(&self, point: usize) -> bool {
        self.points.get(point).is_some_and(|point| point.is_held)
    }

    /// A point has left the floor.
    pub(super) fn lift(&mut self, point: usize) {
        if let Some(point) = self.points.get_mut(point) {
            *point = Point::default();
        }
    }

    /// A point touches the floor, slowly and bearing no more than friction can, or not.
    pub(super) fn touch(&mut self, point: usize, now_s: f64, is_slow: bool, dwell_s: f64) {
        let Some(point) = self.points.get_mut(point) else { return };
        let since_s = point.since_s.filter(|_| is_slow).unwrap_or(now_s);
        *point = Point { since_s: is_slow.then_some(since_s), is_held: is_slow && now_s - since_s >= dwell_s };
    }
}

#[cfg(test)]
mod tests {
    use super::Resting;

    #[test]
    fn a_point_is_held_after_its_dwell_and_until_it_is_not_slow() {
        let mut resting = Resting::of(2);
        for (t, slow, held) in [(0.0, true, false), (0.4, true, false), (0.5, true, true), (0.6, true, true)] {
            resting.touch(1, t, slow, 0.5);
            assert_eq!((resting.is_held(0), resting.is_held(1)), (false, held), "{t}");
        }
        resting.touch(1, 0.7, false, 0.5);
        assert!(!resting.is_held(1));
        resting.touch(1, 0.8, true, 0.5);
        resting.touch(1, 1.2, true, 0.5);
        assert!(!resting.is_held(1), "the dwell begins anew");
        resting.touch(1, 1.3, true, 0.5);
        assert!(resting.is_held(1));
        resting.lift(1);
        assert!(!resting.is_held(1));
        // A list without points, and a dwell that never ends.
        let mut none = Resting::none();
        none.touch(0, 9.0, true, 0.0);
        resting.touch(0, 0.0, true, f64::INFINITY);
        resting.touch(0, 1e9, true, f64::INFINITY);
        assert!(!none.is_held(0) && !resting.is_held(0));
    }
}
