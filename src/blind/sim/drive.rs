//! From the logged setpoint to the torque on the made joints.

use crate::blind::dice::Dice;
use crate::number::math;

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
    /// Commands below this deliver nothing \[N m\] ...
    pub dead_band_nm: f64,
    /// ... and those above it so much less, as a share of it.
    pub dead_band_takes: f64,
    /// Torque against the motion of a motor that is fed by voltage, over the speed \[N m s/rad\].
    pub back_emf_nm_s_rad: f64,
    /// The torque swings as `1 + a sin(n q + phi)`: a, n, phi \[rad\].
    pub ripple: Option<[f64; 3]>,
    /// Integral gain over the proportional one, that the study does not know of \[1/s\].
    pub integral_1_s: f64,
    /// The proportional gain grows as `1 + p e^2` \[1/rad^2\].
    pub progressive_1_rad2: f64,
    /// Errors below this are ignored \[rad\].
    pub dead_zone_rad: f64,
    /// Fastest motion of the setpoint \[rad/s\] ...
    pub slew_rad_s: f64,
    /// ... and how fast that speed may change \[rad/s^2\].
    pub slew_rad_s2: f64,
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
            dead_band_nm: 0.0,
            dead_band_takes: 0.0,
            back_emf_nm_s_rad: 0.0,
            ripple: None,
            integral_1_s: 0.0,
            progressive_1_rad2: 0.0,
            dead_zone_rad: 0.0,
            slew_rad_s: f64::INFINITY,
            slew_rad_s2: f64::INFINITY,
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

    /// Moves a setpoint and its speed towards where it is wanted, within the limits, for a step.
    pub(in crate::blind) fn moved(&self, (at_rad, v_rad_s): (f64, f64), wanted_rad: f64, step_s: f64) -> (f64, f64) {
        let away = wanted_rad - at_rad;
        if self.slew_rad_s2.is_infinite() {
            return (at_rad + away.clamp(-self.slew_rad_s * step_s, self.slew_rad_s * step_s), 0.0);
        }
        let change = self.slew_rad_s2 * step_s;
        if away.abs() <= change * step_s && v_rad_s.abs() <= 2.0 * change {
            return (wanted_rad, 0.0);
        }
        // the speed from which it can still stop there; half a step is gone before the speed has changed
        let braking = (2.0 * self.slew_rad_s2 * away.abs() + 0.25 * change * change).sqrt() - 0.5 * change;
        let best = self.slew_rad_s.min(braking).copysign(away);
        let v = v_rad_s + (best - v_rad_s).clamp(-change, change);
        (at_rad + v * step_s, v)
    }

    /// Torque that the controller commands \[N m\], for an integral of the error \[rad s\].
    pub(in crate::blind) fn commanded_nm(
        &self,
        setpoint_rad: f64,
        (read_rad, read_rad_s): (f64, f64),
        integral_rad_s: f64,
    ) -> f64 {
        let mut error = setpoint_rad - read_rad;
        if self.dead_zone_rad > 0.0 {
            error = (error.abs() - self.dead_zone_rad).max(0.0).copysign(error);
        }
        let error = error * (1.0 + self.progressive_1_rad2 * error * error) + self.integral_1_s * integral_rad_s;
        self.kp * error - self.kd * read_rad_s
    }

    /// Torque that arrives on a joint \[N m\]; `share` is how much of the log is over \[0 to 1\].
    pub(in crate::blind) fn delivered_nm(&self, commanded_nm: f64, q_rad: f64, v_rad_s: f64, share: f64) -> f64 {
        let mut torque = commanded_nm;
        if self.dead_band_nm > 0.0 {
            let lost = self.dead_band_takes * self.dead_band_nm;
            torque = if torque.abs() < self.dead_band_nm { 0.0 } else { (torque.abs() - lost).copysign(torque) };
        }
        torque *= self.gain * (1.0 - self.sag * share);
        if let Some([a, n, phi]) = self.ripple {
            torque *= 1.0 + a * math::sin(n * q_rad + phi);
        }
        if let Some([no_load, stall]) = self.speed {
            let driving = v_rad_s * torque.signum();
            let most = if driving > 0.0 { stall * (1.0 - driving / no_load).max(0.0) } else { stall };
            torque = torque.clamp(-most, most);
        }
        if self.limit_nm.is_finite() {
            torque = if self.limit_power > 0.0 {
                torque
                    / math::powf(
                        1.0 + math::powf((torque / self.limit_nm).abs(), self.limit_power),
                        1.0 / self.limit_power,
                    )
            } else {
                torque.clamp(-self.limit_nm, self.limit_nm)
            };
        }
        torque - self.back_emf_nm_s_rad * v_rad_s
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
        assert_eq!(drive.delivered_nm(5.0, 0.0, 5.0, 0.0), 1.0);
        assert_eq!(drive.delivered_nm(-5.0, 0.0, 5.0, 0.0), -2.0);
        assert_eq!(drive.delivered_nm(5.0, 0.0, 20.0, 0.0), 0.0);
        let round = Drive { limit_nm: 1.0, limit_power: 4.0, ..Drive::default() };
        assert!((0.8..1.0).contains(&round.delivered_nm(1.0, 0.0, 0.0, 0.0)));
        assert!((0.99..1.0).contains(&round.delivered_nm(9.0, 0.0, 0.0, 0.0)));
    }

    #[test]
    fn small_commands_are_lost_and_a_voltage_brakes() {
        let all = Drive { dead_band_nm: 1.0, ..Drive::default() };
        let rest = Drive { dead_band_takes: 1.0, ..all.clone() };
        assert_eq!([0.9, -1.5].map(|tau| all.delivered_nm(tau, 0.0, 0.0, 0.0)), [0.0, -1.5]);
        assert_eq!([0.9, -1.5].map(|tau| rest.delivered_nm(tau, 0.0, 0.0, 0.0)), [0.0, -0.5]);
        // the voltage that is left over the speed: the line of a motor from stall to no load
        let fed = Drive { limit_nm: 2.0, back_emf_nm_s_rad: 0.2, ..Drive::default() };
        assert_eq!([0.0, 5.0, 10.0].map(|v| fed.delivered_nm(9.0, 0.0, v, 0.0)), [2.0, 1.0, 0.0]);
    }

    #[test]
    fn a_setpoint_goes_to_its_end_in_the_time_of_the_textbook() {
        let drive = Drive { slew_rad_s: 2.0, slew_rad_s2: 10.0, ..Drive::default() };
        let (mut at, mut steps) = ((0.0, 0.0), 0);
        while at != (1.0, 0.0) && steps < 100_000 {
            let next = drive.moved(at, 1.0, 1e-4);
            assert!(next.1 <= 2.0 + 1e-12 && (next.1 - at.1).abs() <= 2e-3 && next.0 < 1.001);
            (at, steps) = (next, steps + 1);
        }
        // v/a to speed up and to slow down, and the rest at v
        assert!((f64::from(steps) * 1e-4 - 0.7).abs() < 0.01, "{steps}");
    }
}
