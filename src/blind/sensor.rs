//! What encoder and logger make of an angle: noise, rounding, stamps that jitter, samples that are lost.

use super::dice::Dice;
use crate::number::math;
use serde::Serialize;

/// Noise of a reading besides its rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Noise {
    /// None: the reading is the nearest step.
    Rounding,
    /// Of one reading independent of the next, before rounding.
    White,
    /// A step up or down now and then.
    Flicker,
    /// Of neighbouring readings alike, smaller than half a step.
    Correlated,
}

/// How the logger stamps a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stamps {
    /// On time.
    Regular,
    /// Samples come early or late, and are stamped when they come.
    Jittered,
    /// Samples come on time, and are stamped early or late.
    Lying,
}

impl Noise {
    /// The words in reports.
    pub fn name(self) -> &'static str {
        match self {
            Noise::Rounding => "rounding only",
            Noise::White => "white noise",
            Noise::Flicker => "steps that flicker",
            Noise::Correlated => "correlated noise",
        }
    }
}

impl Stamps {
    /// The words in reports.
    pub fn name(self) -> &'static str {
        match self {
            Stamps::Regular => "regular stamps",
            Stamps::Jittered => "stamps that jitter",
            Stamps::Lying => "stamps that are wrong",
        }
    }
}

/// How the encoder disturbs the angle, and the logger the time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sensor {
    /// Quantisation step \[rad\].
    pub resolution_rad: f64,
    /// \[s\]
    pub period_s: f64,
    pub noise: Noise,
    /// White: uniform, plus or minus this. Correlated: the standard deviation \[rad\].
    pub size_rad: f64,
    /// Correlated: the time after which a 1/e of it is left \[s\].
    pub memory_s: f64,
    /// Flicker: the probability of a step up or down.
    pub flicker: f64,
    pub stamps: Stamps,
    /// A sample is early or late by at most this \[s\].
    pub jitter_s: f64,
    /// Share of samples that are lost one by one.
    pub lost: f64,
    /// Stretches of 4 to 30 periods without samples, in the whole study.
    pub holes: usize,
}

/// Probabilities of noise that is white, that flickers, and that is correlated.
const NOISES: [f64; 3] = [0.22, 0.18, 0.30];

impl Sensor {
    /// Draws everything but step and period.
    pub(super) fn draw(resolution_rad: f64, period_s: f64, dice: &mut Dice) -> Self {
        let kind = dice.uniform(0.0, 1.0);
        let noise = match kind {
            x if x < NOISES[0] => Noise::White,
            x if x < NOISES[0] + NOISES[1] => Noise::Flicker,
            x if x < NOISES[0] + NOISES[1] + NOISES[2] => Noise::Correlated,
            _ => Noise::Rounding,
        };
        let (white, correlated) = (dice.uniform(0.3, 1.0), dice.uniform(0.08, 0.45));
        let (memory_s, flicker) = (dice.log_uniform(0.002, 0.02), dice.uniform(0.1, 0.5));
        let stamps = match dice.uniform(0.0, 1.0) {
            x if x < 0.6 => Stamps::Regular,
            x if x < 0.8 => Stamps::Jittered,
            _ => Stamps::Lying,
        };
        let jitter_s = period_s * dice.uniform(0.02, 0.2);
        Self {
            resolution_rad,
            period_s,
            noise,
            size_rad: resolution_rad
                * match noise {
                    Noise::White => white,
                    Noise::Correlated => correlated,
                    Noise::Rounding | Noise::Flicker => 0.0,
                },
            memory_s,
            flicker: if noise == Noise::Flicker { flicker } else { 0.0 },
            stamps,
            jitter_s: if stamps == Stamps::Regular { 0.0 } else { jitter_s },
            lost: if dice.chance(0.25) { dice.uniform(0.003, 0.03) } else { 0.0 },
            holes: if dice.chance(0.15) { dice.whole(1, 3) } else { 0 },
        }
    }

    /// Standard deviation of a reading at rest \[rad\].
    pub(super) fn noise_rad(&self) -> f64 {
        let step_2 = self.resolution_rad.powi(2);
        let before_2 = match self.noise {
            Noise::White => self.size_rad.powi(2) / 3.0,
            Noise::Correlated => self.size_rad.powi(2),
            Noise::Rounding | Noise::Flicker => 0.0,
        };
        (step_2 / 12.0 + before_2 + self.flicker * step_2).sqrt()
    }

    /// The same while the joint moves at a speed: wrong stamps are an error of the angle too \[rad\].
    pub(super) fn noise_at_rad(&self, speed_rad_s: f64) -> f64 {
        let late_s = if self.stamps == Stamps::Lying { self.jitter_s / 3.0_f64.sqrt() } else { 0.0 };
        math::hypot(self.noise_rad(), late_s * speed_rad_s)
    }

    /// When a sample that is due comes \[s\]; the first is on time.
    pub(super) fn comes_s(&self, due_s: f64, dice: &mut Dice) -> f64 {
        self.shifted(Stamps::Jittered, due_s, dice)
    }

    /// The stamp of a sample that comes at an instant \[s\].
    pub(super) fn stamp_s(&self, comes_s: f64, dice: &mut Dice) -> f64 {
        self.shifted(Stamps::Lying, comes_s, dice)
    }

    fn shifted(&self, stamps: Stamps, t_s: f64, dice: &mut Dice) -> f64 {
        if self.stamps != stamps || t_s == 0.0 {
            return t_s;
        }
        // microseconds, as loggers write them
        ((t_s + self.jitter_s * dice.uniform(-1.0, 1.0)) * 1e6).round() * 1e-6
    }
}

/// An encoder that is read sample by sample.
pub(super) struct Reader<'a> {
    sensor: &'a Sensor,
    /// The last reading's noise, as a multiple of its standard deviation, and when it was read \[s\].
    last: Option<(f64, f64)>,
}

impl<'a> Reader<'a> {
    pub(super) fn new(sensor: &'a Sensor) -> Self {
        Self { sensor, last: None }
    }

    /// What the encoder says of an angle at an instant: noise, rounding, flicker.
    pub(super) fn read(&mut self, t_s: f64, q_rad: f64, dice: &mut Dice) -> f64 {
        let sensor = self.sensor;
        let before_rad = match sensor.noise {
            Noise::White => sensor.size_rad * dice.uniform(-1.0, 1.0),
            Noise::Correlated => sensor.size_rad * self.correlated(t_s, dice),
            Noise::Rounding | Noise::Flicker => 0.0,
        };
        let mut steps = ((q_rad + before_rad) / sensor.resolution_rad).round();
        if sensor.flicker > 0.0 && dice.chance(sensor.flicker) {
            steps += dice.sign();
        }
        // no minus zero
        steps * sensor.resolution_rad + 0.0
    }

    fn correlated(&mut self, t_s: f64, dice: &mut Dice) -> f64 {
        let kept = self.last.map_or(0.0, |(_, at_s)| math::exp(-(t_s - at_s) / self.sensor.memory_s));
        let before = self.last.map_or(0.0, |(value, _)| value);
        let value = kept * before + (1.0 - kept * kept).sqrt() * dice.normal();
        self.last = Some((value, t_s));
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn sensor(noise: Noise, size_rad: f64) -> Sensor {
        Sensor {
            resolution_rad: 1e-3,
            period_s: 0.005,
            noise,
            size_rad,
            memory_s: 0.01,
            flicker: if noise == Noise::Flicker { 0.2 } else { 0.0 },
            stamps: Stamps::Regular,
            jitter_s: 0.0,
            lost: 0.0,
            holes: 0,
        }
    }

    #[test]
    fn readings_scatter_as_stated() {
        for (noise, size_rad) in
            [(Noise::Rounding, 0.0), (Noise::White, 8e-4), (Noise::Flicker, 0.0), (Noise::Correlated, 4e-4)]
        {
            let (sensor, mut dice) = (sensor(noise, size_rad), Dice::new(5, 5));
            let mut reader = Reader::new(&sensor);
            let errors: Vec<f64> = (0..20_000)
                .map(|k| {
                    let q_rad = 0.1 + 1.234567e-5 * f64::from(k);
                    reader.read(0.005 * f64::from(k), q_rad, &mut dice) - q_rad
                })
                .collect();
            let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
            assert_relative_eq!(rms, sensor.noise_rad(), max_relative = 0.05);
        }
    }

    #[test]
    fn correlated_noise_fades_with_its_time() {
        let (sensor, mut dice) = (sensor(Noise::Correlated, 4e-4), Dice::new(5, 6));
        let mut reader = Reader::new(&sensor);
        let values: Vec<f64> = (0..40_000).map(|k| reader.correlated(0.005 * f64::from(k), &mut dice)).collect();
        let alike = values.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / values.len() as f64;
        assert_relative_eq!(alike, (-0.5_f64).exp(), epsilon = 0.03);
    }

    #[test]
    fn stamps_stay_in_order_and_only_wrong_ones_are_noise() {
        let mut dice = Dice::new(5, 7);
        let lying = Sensor { stamps: Stamps::Lying, jitter_s: 1e-3, ..sensor(Noise::Rounding, 0.0) };
        let stamps: Vec<f64> = (0..500).map(|k| lying.stamp_s(0.005 * f64::from(k), &mut dice)).collect();
        assert!(stamps.is_sorted_by(|a, b| a < b) && stamps[0] == 0.0 && stamps[7] != 0.035);
        assert_eq!(lying.comes_s(0.035, &mut dice), 0.035);
        assert_relative_eq!(lying.noise_at_rad(3.0), (1e-6_f64 / 12.0 + 3e-6).sqrt(), epsilon = 1e-12);
        let jittered = Sensor { stamps: Stamps::Jittered, ..lying };
        assert_eq!(jittered.noise_at_rad(3.0), jittered.noise_rad());
    }
}
