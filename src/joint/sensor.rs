//! The encoder: what becomes of the true angle on its way into the log (Appendix B.1).

use super::Real;
use rand::Rng;

/// A reading that is off once per turn: `q + e sin(q - phi)`.
#[derive(Clone, Copy, Debug)]
pub struct Eccentric<T> {
    /// `e cos(phi)` \[rad\]
    pub cosine_rad: T,
    /// `e sin(phi)` \[rad\]
    pub sine_rad: T,
}

/// Steps of Newton's method that find the angle of a reading; each doubles the digits.
const INVERSIONS: usize = 8;

impl<T: Real> Eccentric<T> {
    /// Reading of a true angle \[rad\], and how fast it changes with the angle.
    #[inline]
    pub fn read(&self, angle_rad: T) -> [T; 2] {
        let (sin, cos) = angle_rad.sin_cos();
        [angle_rad + self.cosine_rad * sin - self.sine_rad * cos, self.cosine_rad * cos + self.sine_rad * sin + 1.0]
    }

    /// The true angle of a reading \[rad\].
    pub fn read_back(&self, reading_rad: T) -> T {
        let mut angle_rad = reading_rad;
        for _ in 0..INVERSIONS {
            let [reading, slope] = self.read(angle_rad);
            angle_rad -= (reading - reading_rad) / slope;
        }
        angle_rad
    }
}

/// Position sensor with read noise and quantisation.
///
/// The ERS-7's has a step of 0.006 rad and a variation of 0.012 rad: uniform noise of half a step either way, then
/// rounding.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Encoder {
    /// Quantisation step \[rad\]; 0: continuous.
    pub resolution_rad: f64,
    /// Half-width of the uniform read noise before rounding \[rad\].
    pub noise_rad: f64,
}

impl Encoder {
    /// The reading of a true angle \[rad\].
    pub fn read(&self, angle_rad: f64, rng: &mut impl Rng) -> f64 {
        let noisy = angle_rad + if self.noise_rad > 0.0 { rng.random_range(-1.0..=1.0) * self.noise_rad } else { 0.0 };
        if self.resolution_rad > 0.0 { (noisy / self.resolution_rad).round() * self.resolution_rad } else { noisy }
    }

    /// Standard deviation of a reading about a true angle that moves through many steps \[rad\].
    pub fn sigma_rad(&self) -> f64 {
        (self.resolution_rad.powi(2) / 12.0 + self.noise_rad.powi(2) / 3.0).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;

    #[test]
    fn readings_of_the_ers7_lie_on_steps_and_within_one_step() {
        let encoder = Encoder { resolution_rad: 0.006, noise_rad: 0.003 };
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let n = 4000;
        let mut sum_of_squares = 0.0;
        for i in 0..n {
            let angle = i as f64 * 1.37e-4;
            let reading = encoder.read(angle, &mut rng);
            assert!((reading / 0.006 - (reading / 0.006).round()).abs() < 1e-9);
            assert!((reading - angle).abs() <= 0.006 + 1e-12);
            sum_of_squares += (reading - angle).powi(2);
        }
        // The swings' README states 0.00245 rad for this sensor.
        assert!(((sum_of_squares / n as f64).sqrt() - 0.00245).abs() < 1e-4);
        assert!((encoder.sigma_rad() - 0.00245).abs() < 1e-5);
    }
}
