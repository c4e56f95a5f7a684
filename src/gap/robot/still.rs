//! Readings of a joint that stands still: rounding makes no noise there as it does of a joint that moves.

/// From so many equal readings on more of them say nothing new.
const REPEATED: usize = 16;
/// Samples to either side over which a reading flickers between two steps.
const NEAR: usize = 16;

/// Which readings only repeat the ones before.
pub(super) fn repeats(readings: &[f64]) -> Vec<bool> {
    let mut equal = 0;
    let repeats = |k: usize| {
        equal = if k > 0 && readings[k] == readings[k - 1] { equal + 1 } else { 0 };
        equal >= REPEATED
    };
    (0..readings.len()).map(repeats).collect()
}

/// Which readings flicker between two steps of the sensor: the joint stands between them, and each is wrong by half a step.
pub(super) fn flickers(readings: &[f64], resolution_rad: f64) -> Vec<bool> {
    let flickers = |k: usize| {
        let near = &readings[k.saturating_sub(NEAR)..(k + NEAR + 1).min(readings.len())];
        let (least, most) = near.iter().fold((f64::MAX, f64::MIN), |(least, most), q| (least.min(*q), most.max(*q)));
        most > least && most - least < 1.5 * resolution_rad
    };
    (0..readings.len()).map(flickers).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reading_that_stands_is_told_from_one_that_flickers_and_one_that_moves() {
        let standing = vec![0.1; 60];
        let told = repeats(&standing);
        assert!(!told[15] && told[16] && told[59]);
        assert!(flickers(&standing, 0.006).iter().all(|flickers| !flickers));
        let flickering: Vec<f64> = (0..60).map(|k| if k % 3 == 0 { 0.102 } else { 0.096 }).collect();
        assert!(repeats(&flickering).iter().all(|repeats| !repeats));
        assert!(flickers(&flickering, 0.006).iter().all(|flickers| *flickers));
        let moving: Vec<f64> = (0..60).map(|k| 0.006 * f64::from(k / 4)).collect();
        assert!(flickers(&moving, 0.006).iter().all(|flickers| !flickers));
    }
}
