//! Sine and cosine of several angles at once.

use super::Number;
use crate::number::{LARGEST_RAD, of_rest};

/// Sines and cosines \[-\] of angles \[rad\], of each the same bits as on its own.
#[inline(always)]
pub(in crate::robot) fn sin_cos<N: Number>(angle_rad: N) -> (N, N) {
    let each = angle_rad.each();
    if !each.as_ref().iter().all(|angle| angle.abs() < LARGEST_RAD) {
        let one = |lane: usize| crate::number::sin_cos(each.as_ref()[lane]);
        return (N::of(|lane| one(lane).0), N::of(|lane| one(lane).1));
    }
    let (sine, cosine, quarters) = of_rest(angle_rad);
    N::in_quadrant(sine, cosine, quarters)
}

#[cfg(test)]
mod tests {
    use super::super::Widest;
    use super::*;

    #[test]
    fn each_as_one() {
        fn of<N: Number>(angles: &[f64; 4]) {
            let (s, c) = sin_cos(N::of(|lane| angles[lane]));
            for (lane, &x) in angles.iter().enumerate().take(N::LANES) {
                let found = (s.each().as_ref()[lane].to_bits(), c.each().as_ref()[lane].to_bits());
                let (sine, cosine) = crate::number::sin_cos(x);
                assert_eq!(found, (sine.to_bits(), cosine.to_bits()), "{x}");
            }
        }
        let mut several = vec![[0.3, -70.2, 1.0, 2.0], [12.5, 0.0, -0.0, 1e300], [f64::NAN, 1.0, 9e5, -3.0]];
        several.extend((0..500_i32).map(|k| [0, 1, 2, 3].map(|lane| f64::from(lane + 4 * k - 900) * 0.37)));
        for angles in &several {
            of::<f64>(angles);
            of::<Widest>(angles);
            of::<super::super::Pair>(angles);
        }
    }
}
