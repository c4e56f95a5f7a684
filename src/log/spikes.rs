//! Single readings that jump and come back: a bus or an encoder does that, no joint.

use super::health::quantisation;
use super::health_noise::reading_floor_rad;
use super::robot_log::RobotLog;

/// A reading that jumps and comes back is so many times as far off as noise would have it, and what lies before it, behind it and
/// on both sides of it differs by no more than this share of that.
const BEYOND_NOISE: f64 = 20.0;
const AROUND: f64 = 0.2;

/// Single readings that stand far off both of their neighbours: no joint jumps and is back by the next sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spikes {
    /// How many.
    pub count: usize,
    /// When the first one is read \[s\].
    pub first_s: f64,
    /// How far that stands off \[rad\].
    pub off_rad: f64,
}

impl Spikes {
    /// Puts each of them between its neighbours, and tells of them; `None` where there are none.
    pub(crate) fn mended(t_s: &[f64], q_rad: &mut [f64]) -> Option<Self> {
        let floor_rad = reading_floor_rad(q_rad, quantisation(q_rad).unwrap_or(0.0));
        let off = |(before, q): (usize, &[f64])| {
            let (there, back) = (q[2] - q[1], q[2] - q[3]);
            let off_rad = there.abs().min(back.abs());
            let around = [q[1] - q[0], q[3] - q[1], q[4] - q[3]];
            let is_calm = around.iter().all(|step| step.abs() < AROUND * off_rad);
            (there * back > 0.0 && is_calm && off_rad > BEYOND_NOISE * floor_rad).then_some((before + 2, off_rad))
        };
        let those: Vec<(usize, f64)> = q_rad.windows(5).enumerate().filter_map(off).collect();
        let (first, off_rad) = *those.first()?;
        those.iter().for_each(|(k, _)| q_rad[*k] = 0.5 * (q_rad[k - 1] + q_rad[k + 1]));
        Some(Self { count: those.len(), first_s: t_s[first], off_rad })
    }

    /// `1 reading jumps and is back at the next sample, by 3.000 rad at 4.120 s: ...`
    pub(super) fn words(&self) -> String {
        let Self { count, first_s, off_rad } = self;
        let (first, jump, it_is) = match count {
            1 => ("", "reading jumps and is", "it is"),
            _ => ("the first ", "readings jump and are", "they are"),
        };
        format!(
            "{count} {jump} back at the next sample, {first}by {off_rad:.3} rad at {first_s:.3} s: no joint does; {it_is} taken to \
             lie between the readings around"
        )
    }
}

impl RobotLog {
    /// The same with such readings of every joint between their neighbours, which its notes say.
    #[must_use]
    pub(crate) fn without_spikes(mut self) -> Self {
        for joint in &mut self.joints {
            let spikes = Spikes::mended(&self.t_s, &mut joint.q_rad);
            self.notes.extend(spikes.map(|spikes| format!("{}: {}", joint.name, spikes.words())));
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reading_that_jumps_and_comes_back_is_told_from_motion_and_noise() {
        let t_s: Vec<f64> = (0..400).map(|k| 0.02 * k as f64).collect();
        let noise = |k: usize| 5e-4 * (0.1 * (k * k % 97) as f64).sin();
        let sound: Vec<f64> = t_s.iter().enumerate().map(|(k, t)| (3.0 * t).sin() + noise(k)).collect();
        let mended = |q: &[f64]| {
            let mut q = q.to_vec();
            (Spikes::mended(&t_s, &mut q), q)
        };
        assert_eq!(mended(&sound), (None, sound.clone()));
        let mut spiked = sound.clone();
        spiked[200] += 3.0;
        spiked[300] -= 2.0;
        let (found, q_rad) = mended(&spiked);
        let found = found.unwrap();
        assert_eq!((found.count, found.first_s), (2, 4.0));
        assert!((found.off_rad - 3.0).abs() < 0.1, "{found:?}");
        assert!(found.words().contains("2 readings jump and are back"), "{}", found.words());
        assert!(q_rad.iter().zip(&sound).all(|(mended, sound)| (mended - sound).abs() < 3e-3));
        // What steps from place to place, or swings faster than it is sampled, does not jump.
        let steps: Vec<f64> = (0..400).map(|k| if k / 50 % 2 == 0 { 0.0 } else { 1.0 }).collect();
        let fast: Vec<f64> = (0..400).map(|k| (2.9 * k as f64).sin()).collect();
        assert_eq!([mended(&steps).0, mended(&fast).0], [None; 2]);
    }
}
