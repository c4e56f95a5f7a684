//! From the logged setpoint to the torque on the made joints.

use crate::blind::dice::Dice;

/// Everything between setpoint and torque; the default is a perfect drive of no stiffness.
#[derive(Clone, Debug)]
pub(in crate::blind) struct Drive {
    /// \[N m/rad\]
    pub kp: f64,
    /// \[N m s/rad\]
    pub kd: f64,
    /// The setpoint acts late \[s\] ...
    pub delay_s: f64,
    /// ... each change by so much of it earlier or later.
    pub delay_jitter: f64,
    /// The setpoint is taken over only every so often \[s\]; 0: always ...
    pub hold_s: f64,
    /// ... each time by so much of it earlier or later.
    pub hold_jitter: f64,
    /// Seed of both jitters.
    pub jitter_seed: u64,
    /// Delivered over commanded torque.
    pub gain: f64,
    /// Share of the torque that is gone at the end of a log.
    pub sag: f64,
    /// \[N m\]
    pub limit_nm: f64,
    /// Roundness of the limit: `tau / (1 + |tau/limit|^p)^(1/p)`; 0: sharp.
    pub limit_power: f64,
    /// No-load speed and stall torque \[rad/s, N m\].
    pub speed: Option<[f64; 2]>,
    /// Errors below this are ignored \[rad\].
    pub dead_zone_rad: f64,
    /// Fastest motion of the setpoint \[rad/s\].
    pub slew_rad_s: f64,
}

impl Default for Drive {
    fn default() -> Self {
        Self {
            kp: 0.0,
            kd: 0.0,
            delay_s: 0.0,
            delay_jitter: 0.0,
            hold_s: 0.0,
            hold_jitter: 0.0,
            jitter_seed: 0,
            gain: 1.0,
            sag: 0.0,
            limit_nm: f64::INFINITY,
            limit_power: 0.0,
            speed: None,
            dead_zone_rad: 0.0,
            slew_rad_s: f64::INFINITY,
        }
    }
}

impl Drive {
    /// When which setpoint reaches the controller: instants \[s\] rising, and values \[rad\].
    pub(in crate::blind) fn arrivals(&self, changes: &[(f64, f64)], until_s: f64, log: usize) -> Vec<(f64, f64)> {
        let mut dice = Dice::new(self.jitter_seed, log as u64);
        let mut taken = changes.to_vec();
        if self.hold_s > 0.0 {
            taken.clear();
            let (mut k, mut next) = (0_u32, 0);
            loop {
                let wobble = self.hold_jitter * if k > 0 { dice.uniform(-0.5, 0.5) } else { 0.0 };
                let at = (f64::from(k) + wobble) * self.hold_s;
                while changes.get(next + 1).is_some_and(|(t, _)| *t <= at + 1e-9) {
                    next += 1;
                }
                match changes.get(next) {
                    Some((_, value)) if at < until_s => taken.push((at, *value)),
                    _ => break,
                }
                k += 1;
            }
        }
        if self.delay_s > 0.0 {
            let mut last = 0.0_f64;
            for (i, (t, _)) in taken.iter_mut().enumerate() {
                let late = self.delay_s * (1.0 + self.delay_jitter * dice.uniform(-1.0, 1.0));
                // the first setpoint has been there before the log began
                last = if i == 0 { 0.0 } else { last.max(*t + late) };
                *t = last;
            }
        }
        taken
    }

    /// Torque that the controller commands \[N m\].
    pub(in crate::blind) fn commanded_nm(&self, setpoint_rad: f64, read_rad: f64, read_rad_s: f64) -> f64 {
        let mut error = setpoint_rad - read_rad;
        if self.dead_zone_rad > 0.0 {
            error = (error.abs() - self.dead_zone_rad).max(0.0).copysign(error);
        }
        self.kp * error - self.kd * read_rad_s
    }

    /// Torque that arrives \[N m\]; `share` is how much of the log is over \[0 to 1\].
    pub(in crate::blind) fn delivered_nm(&self, commanded_nm: f64, v_rad_s: f64, share: f64) -> f64 {
        let mut torque = commanded_nm * self.gain * (1.0 - self.sag * share);
        if let Some([no_load, stall]) = self.speed {
            let driving = v_rad_s * torque.signum();
            let most = if driving > 0.0 { stall * (1.0 - driving / no_load).max(0.0) } else { stall };
            torque = torque.clamp(-most, most);
        }
        if self.limit_nm.is_finite() {
            torque = if self.limit_power > 0.0 {
                torque / (1.0 + (torque / self.limit_nm).abs().powf(self.limit_power)).powf(1.0 / self.limit_power)
            } else {
                torque.clamp(-self.limit_nm, self.limit_nm)
            };
        }
        torque
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> Vec<(f64, f64)> {
        (0..100).map(|k| (0.01 * f64::from(k), f64::from(k))).collect()
    }

    #[test]
    fn a_delay_shifts_and_a_hold_thins() {
        let late = Drive { delay_s: 0.02, ..Drive::default() }.arrivals(&ramp(), 1.0, 0);
        assert_eq!((late[0].0, late.len()), (0.0, 100));
        assert!((late[10].0 - 0.12).abs() < 1e-12 && late[10].1 == 10.0);
        let held = Drive { hold_s: 0.1, ..Drive::default() }.arrivals(&ramp(), 1.0, 0);
        assert_eq!(held.len(), 10);
        assert_eq!(held[3].1, 30.0);
        let wild = Drive { delay_s: 0.02, delay_jitter: 0.9, ..Drive::default() }.arrivals(&ramp(), 1.0, 0);
        assert!(wild.is_sorted_by(|a, b| a.0 <= b.0));
    }

    #[test]
    fn limits_clip_when_driving() {
        let drive = Drive { speed: Some([10.0, 2.0]), ..Drive::default() };
        assert_eq!(drive.delivered_nm(5.0, 5.0, 0.0), 1.0);
        assert_eq!(drive.delivered_nm(-5.0, 5.0, 0.0), -2.0);
        assert_eq!(drive.delivered_nm(5.0, 20.0, 0.0), 0.0);
        let round = Drive { limit_nm: 1.0, limit_power: 4.0, ..Drive::default() };
        assert!((0.8..1.0).contains(&round.delivered_nm(1.0, 0.0, 0.0)));
        assert!((0.99..1.0).contains(&round.delivered_nm(9.0, 0.0, 0.0)));
    }
}
