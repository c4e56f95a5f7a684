//! What acts on the link of the made joints besides friction.

use crate::number::math;

/// A stop on one side.
#[derive(Clone, Copy, Debug)]
pub(in crate::blind) struct Stop {
    /// Where it begins \[rad\].
    pub at_rad: f64,
    /// `1`: it bounds the angle above, `-1`: below.
    pub side: f64,
    /// \[N m/rad\]
    pub stiffness: f64,
    /// \[N m s/rad\]
    pub damping: f64,
    /// Force `k x^1.5 (1 + c x')` with `k` chosen to match at this depth \[rad\]; 0: a linear spring and damper.
    pub hertz_depth_rad: f64,
}

/// A torque impulse: a bump of a raised cosine.
#[derive(Clone, Copy, Debug)]
pub(in crate::blind) struct Knock {
    pub log: usize,
    pub from_s: f64,
    pub lasts_s: f64,
    /// Its share of the size, with sign.
    pub share: f64,
}

/// All there is about the link besides gravity; the default is nothing.
#[derive(Clone, Debug, Default)]
pub(in crate::blind) struct Link {
    /// Gravity acts as `sin(q + d)` \[rad\].
    pub offset_rad: f64,
    /// Parallel spring \[N m/rad\] ...
    pub spring_nm_rad: f64,
    /// ... slack at this angle \[rad\] ...
    pub spring_at_rad: f64,
    /// ... hardening as `x + h x^3` \[1/rad^2\].
    pub spring_hardens: f64,
    pub stop: Option<Stop>,
    /// `a sin(n q + phi)`: a \[N m\], n, phi \[rad\].
    pub cogging: Option<[f64; 3]>,
    /// A magnet's pull `-a x/w exp((1 - (x/w)^2)/2)`: a \[N m\], place and width \[rad\].
    pub detent: Option<[f64; 3]>,
    /// Tilt of the base `a sin(w t + phi)`: a \[rad\], w \[rad/s\].
    pub sway: Option<[f64; 2]>,
    /// Its phase by log \[rad\].
    pub sway_phase_rad: Vec<f64>,
    /// A cable that springs and slips: torque at which it slips \[N m\], travel until then \[rad\].
    pub cable: Option<[f64; 2]>,
    /// Largest torque of a knock \[N m\].
    pub knock_nm: f64,
    pub knocks: Vec<Knock>,
}

/// Where the link is.
#[derive(Clone, Copy, Debug)]
pub(in crate::blind) struct Pose {
    pub t_s: f64,
    pub q_rad: f64,
    pub v_rad_s: f64,
    /// Index of the log.
    pub log: usize,
}

impl Link {
    /// Gravity torque for a peak `g M*` \[N m\].
    pub(in crate::blind) fn gravity_nm(&self, at: &Pose, peak_nm: f64) -> f64 {
        let mut angle = at.q_rad + self.offset_rad;
        if let Some([a, w]) = self.sway {
            let phase = self.sway_phase_rad.get(at.log).copied().unwrap_or(0.0);
            angle += a * math::sin(w * at.t_s + phase);
        }
        -peak_nm * math::sin(angle)
    }

    /// Everything else that depends on where the link is \[N m\].
    pub(in crate::blind) fn other_nm(&self, at: &Pose) -> f64 {
        let mut torque = 0.0;
        if self.spring_nm_rad != 0.0 {
            let x = at.q_rad - self.spring_at_rad;
            torque -= self.spring_nm_rad * x * (1.0 + self.spring_hardens * x * x);
        }
        if let Some(stop) = &self.stop {
            torque += stop.torque_nm(at.q_rad, at.v_rad_s);
        }
        if let Some([a, n, phi]) = self.cogging {
            torque += a * math::sin(n * at.q_rad + phi);
        }
        if let Some([a, place, width]) = self.detent {
            let x = (at.q_rad - place) / width;
            torque -= a * x * math::exp(0.5 * (1.0 - x * x));
        }
        if self.knock_nm != 0.0 {
            for knock in self.knocks.iter().filter(|knock| knock.log == at.log) {
                let phase = (at.t_s - knock.from_s) / knock.lasts_s;
                if (0.0..1.0).contains(&phase) {
                    torque += self.knock_nm * knock.share * 0.5 * (1.0 - math::cos(std::f64::consts::TAU * phase));
                }
            }
        }
        torque
    }

    /// Moves the cable along and gives its torque \[N m\].
    pub(in crate::blind) fn cable_nm(&self, deflection: &mut f64, step_rad: f64) -> f64 {
        let Some([slips_nm, travel_rad]) = self.cable else { return 0.0 };
        let x = step_rad / travel_rad;
        *deflection = (*deflection + x) / (1.0 + x.abs());
        -slips_nm * *deflection
    }
}

impl Stop {
    fn torque_nm(&self, q_rad: f64, v_rad_s: f64) -> f64 {
        let (depth, rate) = (self.side * (q_rad - self.at_rad), self.side * v_rad_s);
        if depth <= 0.0 {
            return 0.0;
        }
        let push = if self.hertz_depth_rad > 0.0 {
            let stiff = self.stiffness / self.hertz_depth_rad.sqrt();
            stiff * math::powf(depth, 1.5) * (1.0 + self.damping / (self.stiffness * self.hertz_depth_rad) * rate)
        } else {
            self.stiffness * depth + self.damping * rate
        };
        -self.side * push.max(0.0)
    }
}
