//! The torque that a model lacks along a log, reconstructed as an input of the joint.
//!
//! Which torque would the chain have needed, beside its own, to move as the readings say? Differencing the readings
//! twice would answer with noise. Instead the torque is a state beside angle and speed: an integrated random walk with a
//! little of a plain one, through the chain's equation of motion (3.12), by an extended Kalman smoother. Its strength is
//! the log's own: the roughest that the readings do not hold against it. It may jump where the joint reverses, and where
//! a setpoint jumps; while the joint rests, readings say nothing about it within the breakaway torque.
//!
//! The band is the smoother's own: what noise leaves open about a torque that is as rough as this log's. It knows
//! nothing of spikes shorter than the smoother resolves (an impact, a delay after a step of the setpoint).

use super::along::{Along, Memory};
use super::phases::{Course, phases};
use super::rest::{Rest, rests, together};
use super::smoother::{Begin, Change, Prior, Reading, Smoothed, State, Step, likelihood, smooth};
use super::strength::roughest_that_readings_allow;
use crate::gap::diagnosis::{Phase, ResidualTorque};
use crate::identify::Experiment;
use crate::joint::{Chain, Driven};
use crate::number::math;
use crate::pendulum::Start;

/// What the encoder shows of the joint at an instant, which a late one shows later \[rad\].
fn angle_at(chain: &Chain<f64>, e: &Experiment, t_s: f64) -> f64 {
    let shown_s = t_s + chain.sensor_delay_s.unwrap_or(0.0);
    let last = e.t_s.len() - 1;
    let k = e.t_s.partition_point(|t| *t <= shown_s).clamp(1, last);
    let share = ((shown_s - e.t_s[k - 1]) / (e.t_s[k] - e.t_s[k - 1])).clamp(0.0, 1.0);
    let reading_rad = e.measured_rad[k - 1] + share * (e.measured_rad[k] - e.measured_rad[k - 1]);
    chain.read_back(shown_s, reading_rad, 0.0)[0]
}

/// Reconstructs the torque that `chain` lacks along `e`, from its start on.
///
/// Angles and rates are those of the joint, not of its encoder where the chain gives that a gain. A chain's play is not
/// followed: motor side and link move as one.
///
/// `chain` is the model as recalibrated for this log, `start` its start there, and `noise_rad` the standard deviation of
/// a reading, which is never below the encoder's rounding. The torque is NaN while the joint is held, and while it
/// sticks where the model would stick too: any torque within the breakaway is possible there. Where the joint rests
/// although the model would move, it is the least torque that holds it.
pub fn residual_torque(chain: &Chain<f64>, e: &Experiment, start: Start<f64>, noise_rad: f64) -> ResidualTorque {
    let gain = chain.sensor_gain;
    let true_angles;
    let (e, noise_rad) = if chain.reads_true() {
        (e, noise_rad)
    } else {
        let measured_rad = e.t_s.iter().map(|t_s| angle_at(chain, e, *t_s)).collect();
        true_angles = Experiment { measured_rad, resolution_rad: e.resolution_rad / gain, ..e.clone() };
        (&true_angles, noise_rad / gain)
    };
    let compared = e.t_s[e.uncompared..].to_vec();
    let Some(record) = Record::new(chain, e, start, noise_rad) else {
        let n = compared.len();
        return ResidualTorque {
            t_s: compared,
            torque_nm: vec![f64::NAN; n],
            sigma_nm: vec![f64::NAN; n],
            angle_rad: vec![start.angle_rad; n],
            rate_rad_s: vec![0.0; n],
            phase: vec![Phase::Hold; n],
        };
    };
    let rough = record.follow();
    let steps = record.steps(&rough, &record.directions(&rough));
    let (prior, scale) = record.strength(&steps);
    let path = smooth(&record.begin, &record.readings, prior, |k, _| steps[k]);
    record.answer(&path, scale)
}

/// Size of the first pass, whose path the others are linear about.
const LOOSE: f64 = 0.3;
/// What varies faster than this part of a half swing is not resolved: real encoders have errors of that kind, which are
/// no torque.
const RESOLVED: f64 = 1.0 / 40.0;
/// Slowest motion whose half swing sets the time over which the torque varies \[rad/s\].
const SLOWEST_RAD_S: f64 = 6.0;
/// The unknown may do no less than this share of what it may do where the joint is liveliest.
const CALM: f64 = 0.1;
/// A jump of the setpoint counts if it moves the motor's torque by this share of the torques that act.
const JOLT: f64 = 0.3;
/// Readings are not better than a log's decimals \[rad\].
const FINEST_RAD: f64 = 1e-6;
/// Variance of the speed of a joint that is known to rest \[rad^2/s^2\].
const AT_REST: f64 = 1e-12;

/// A log from its release on, made ready for the smoother.
struct Record<'a> {
    along: Along<'a>,
    chain: &'a Chain<f64>,
    e: &'a Experiment,
    start: Start<f64>,
    noise_rad: f64,
    /// The last sample before the release, or the first.
    first: usize,
    rests: Vec<Option<Rest>>,
    begin: Begin,
    readings: Vec<Reading>,
    /// Acceleration that the torques on the joint give \[rad/s^2\].
    scale_rad_s2: f64,
    /// Half a swing \[s\].
    span_s: f64,
}

impl<'a> Record<'a> {
    fn new(chain: &'a Chain<f64>, e: &'a Experiment, start: Start<f64>, noise_rad: f64) -> Option<Self> {
        let noise_rad = noise_rad.max(e.resolution_rad / 12f64.sqrt()).max(FINEST_RAD);
        let first = match start.release_s {
            Some(release_s) => e.t_s.iter().position(|t| *t > release_s)?.saturating_sub(1),
            None => e.uncompared,
        };
        if e.t_s.len() < first + 3 {
            return None;
        }
        let along = Along::new(chain, e.input(), &e.t_s);
        let rests = rests(chain, &along, e, first + 1, noise_rad);
        let variance = noise_rad * noise_rad;
        let frequency_rad_s = chain.fastest_rad_s(Driven::Off).max(SLOWEST_RAD_S);
        let span_s = std::f64::consts::PI / frequency_rad_s;
        let counts = together(e, &rests, RESOLVED * span_s);
        let readings = (first..e.t_s.len())
            .map(|k| Reading { value_rad: e.measured_rad[k], variance_rad2: variance * counts[k] })
            .collect();
        let begin = match start.release_s {
            Some(_) => Begin { mean: [start.angle_rad, 0.0], variance: [4.0 * variance, AT_REST] },
            None => Begin {
                mean: [start.angle_rad, start.rate_rad_s],
                variance: [25.0 * variance, 0.1 * (1.0 + start.rate_rad_s.powi(2))],
            },
        };
        let record = Self {
            scale_rad_s2: scale_rad_s2(chain, &along, e, frequency_rad_s),
            span_s,
            along,
            chain,
            e,
            start,
            noise_rad,
            first,
            rests,
            begin,
            readings,
        };
        (record.scale_rad_s2 > 0.0).then_some(record)
    }

    fn prior(&self, share: f64) -> Prior {
        Prior { size_rad_s2: share * self.scale_rad_s2, span_s: self.span_s }
    }

    fn rests_at(&self, k: usize) -> bool {
        self.rests[self.first + k].is_some()
    }

    /// From reading `k` to the next, linear about a state.
    fn step(&self, k: usize, x: &State, direction: f64, may_turn: bool, lively: f64, memory: &mut Memory) -> Step {
        let from = self.first + k;
        let from_s = self.e.t_s[from];
        let dt_s = self.e.t_s[from + 1] - from_s;
        let rested = self.rests_at(k);
        if self.rests_at(k + 1) {
            self.along.rest(from, x[0], memory);
            // A joint that was moving has come to rest at some instant in between.
            let half_s = if rested { 0.0 } else { 0.5 * dt_s };
            let loose = [(x[1] * half_s).powi(2) / 3.0, AT_REST];
            let upper = [[1.0, half_s, 0.0, 0.0], [0.0; 4]];
            return Step { upper, offset: [0.0; 2], dt_s, change: Change::Forgotten, lively, loose };
        }
        let release_s = self.start.release_s.filter(|r| k == 0 && *r > from_s);
        let p = self.along.pass(from, release_s.unwrap_or(from_s), x, direction, may_turn && !rested, memory);
        let offset = std::array::from_fn(|i| p.end[i] - (0..4).map(|j| p.upper[i][j] * x[j]).sum::<f64>());
        let jolted_rad_s2 = self.along.jolt_nm(from, x[0]).abs() / self.chain.inertia_at_kg_m2(from_s);
        let jumps = p.turned || jolted_rad_s2 > JOLT * self.scale_rad_s2;
        // A joint that was at rest has left at some instant in between.
        let leaves = rested || (k == 0 && self.start.release_s.is_some());
        let speed_rad_s = if leaves { 0.5 * p.end[1] } else { 0.0 };
        Step {
            upper: p.upper,
            offset,
            dt_s,
            change: if jumps { Change::Jump } else { Change::Smooth },
            lively,
            loose: [(0.5 * speed_rad_s * dt_s).powi(2), speed_rad_s.powi(2)],
        }
    }

    /// A first path: the filter goes along the log with a torque that may do much.
    fn follow(&self) -> Vec<Smoothed> {
        let mut memory = Memory::default();
        smooth(&self.begin, &self.readings, self.prior(LOOSE), |k, x| {
            let direction = if x[1] != 0.0 && !self.rests_at(k) { x[1] } else { self.pull_nm(k, x) };
            self.step(k, x, if direction < 0.0 { -1.0 } else { 1.0 }, true, 1.0, &mut memory)
        })
    }

    /// Torque on a joint that is about to move \[N m\].
    fn pull_nm(&self, k: usize, x: &State) -> f64 {
        let sample = self.first + k;
        let motor_nm = self.along.resting_nm(sample, x[0]);
        self.chain.drive_nm(self.e.t_s[sample], x[0], motor_nm) + x[2] * self.chain.inertia_at_kg_m2(self.e.t_s[sample])
    }

    /// The steps about a path that moves in these directions.
    fn steps(&self, path: &[Smoothed], directions: &[f64]) -> Vec<Step> {
        let mut memory = Memory::default();
        let lively = self.lively(path);
        (0..path.len().saturating_sub(1))
            .map(|k| {
                let turns = directions[k + 1] != directions[k];
                self.step(k, &path[k].mean, directions[k], turns, lively[k], &mut memory)
            })
            .collect()
    }

    /// Direction of motion at every reading; a speed that its uncertainty explains does not turn the joint, and a
    /// resting joint has the direction in which it leaves.
    fn directions(&self, path: &[Smoothed]) -> Vec<f64> {
        let n = path.len();
        let mut directions = vec![0.0; n];
        let mut direction = 0.0;
        let mut at = 0;
        while at < n {
            let sign = path[at].mean[1].signum();
            let len = path[at..].iter().take_while(|p| p.mean[1].signum() == sign).count().max(1);
            let moves = |p: &Smoothed| p.mean[1].powi(2) > p.variance[1];
            let clear = (at..at + len).any(|k| !self.held_at(k) && moves(&path[k]));
            if clear || direction == 0.0 {
                direction = sign;
            }
            directions[at..at + len].fill(direction);
            at += len;
        }
        for k in (0..n.saturating_sub(1)).rev() {
            if self.held_at(k) {
                directions[k] = directions[k + 1];
            }
        }
        directions
    }

    /// Held or at rest.
    fn held_at(&self, k: usize) -> bool {
        self.rests_at(k) || (k == 0 && self.start.release_s.is_some())
    }

    /// How fast the joint is about each reading, as a share of its top speed.
    fn lively(&self, path: &[Smoothed]) -> Vec<f64> {
        let mut speed: Vec<f64> = path.iter().map(|p| p.mean[1].abs()).collect();
        let top = speed.iter().fold(f64::MIN_POSITIVE, |top, v| v.max(top));
        let t_s = &self.e.t_s[self.first..];
        let fading = |from: usize, to: usize| math::exp(-(t_s[from] - t_s[to]).abs() / self.span_s);
        for k in 1..speed.len() {
            speed[k] = speed[k].max(speed[k - 1] * fading(k - 1, k));
        }
        for k in (1..speed.len()).rev() {
            speed[k - 1] = speed[k - 1].max(speed[k] * fading(k - 1, k));
        }
        speed.iter().map(|v| (v / top).max(CALM)).collect()
    }

    /// The strength that the readings ask for, and by how much they scatter more than they should (a variance ratio).
    ///
    /// It is no larger than what still averages over [`RESOLVED`]: a spline in time with this penalty on its fourth
    /// derivative has a kernel of width `(noise^2 dt / drive)^(1/8)`.
    fn strength(&self, steps: &[Step]) -> (Prior, f64) {
        let n = self.readings.len() as f64;
        let dt_s = (self.e.t_s[self.e.t_s.len() - 1] - self.e.t_s[self.first]) / n;
        let drive = self.noise_rad.powi(2) * dt_s / (RESOLVED * self.span_s).powi(8);
        let largest = (drive * self.span_s.powi(3) / 3.0).sqrt() / self.scale_rad_s2;
        let ask = |size: f64| likelihood(&self.begin, steps, &self.readings, self.prior(size));
        let (size, found) = roughest_that_readings_allow(ask, largest);
        (self.prior(size), found.scale)
    }

    fn answer(&self, path: &[Smoothed], scale: f64) -> ResidualTorque {
        let (e, chain) = (self.e, self.chain);
        let n = e.t_s.len();
        let mut out = ResidualTorque { t_s: e.t_s[e.uncompared..].to_vec(), ..ResidualTorque::default() };
        let released = |k: usize| k > self.first || self.start.release_s.is_none();
        for k in e.uncompared..n {
            let (torque_nm, sigma_nm, angle_rad, rate_rad_s) = match path.get(k.wrapping_sub(self.first)) {
                Some(s) if released(k) => {
                    let (torque_nm, sigma_nm) = match self.rests[k] {
                        Some(rest) => self.holding(&rest),
                        None => {
                            let doubt_nm = self.friction_doubt_nm(k, s);
                            let inertia = chain.inertia_at_kg_m2(e.t_s[k]);
                            let variance = scale * s.variance[2] * inertia * inertia;
                            (s.mean[2] * inertia, (variance + doubt_nm * doubt_nm).sqrt())
                        }
                    };
                    (torque_nm, sigma_nm, s.mean[0], s.mean[1])
                }
                _ => (f64::NAN, f64::NAN, self.start.angle_rad, 0.0),
            };
            out.torque_nm.push(torque_nm);
            out.sigma_nm.push(sigma_nm);
            out.angle_rad.push(angle_rad);
            out.rate_rad_s.push(rate_rad_s);
        }
        let directions = self.directions(path);
        let direction = (e.uncompared..n).map(|k| directions.get(k.wrapping_sub(self.first)).copied().unwrap_or(0.0));
        let rests: Vec<bool> = (e.uncompared..n).map(|k| self.rests[k].is_some()).collect();
        let held = (e.uncompared..n).map(|k| !released(k)).collect();
        out.phase = phases(&Course {
            chain,
            along: &self.along,
            e,
            torque: &out,
            direction: direction.collect(),
            rests,
            held,
            noise_rad: self.noise_rad,
        });
        out
    }

    /// The least torque that holds a joint that the model would move, and its uncertainty; NaN where it sticks by itself.
    fn holding(&self, rest: &Rest) -> (f64, f64) {
        if rest.beyond_nm == 0.0 {
            return (f64::NAN, f64::NAN);
        }
        let (kp, _) = self.chain.motor.as_ref().map_or((0.0, 0.0), |m| m.stiffness_and_damping(Driven::ByLaw));
        (-rest.beyond_nm, (self.chain.link.peak_gravity_nm() + kp) * self.noise_rad)
    }

    /// What it matters that the friction may point the other way, where the speed may be zero \[N m\].
    fn friction_doubt_nm(&self, k: usize, s: &Smoothed) -> f64 {
        let reversed = 0.5 * math::exp(-0.5 * s.mean[1].powi(2) / s.variance[1].max(AT_REST));
        let direction = if s.mean[1] < 0.0 { -1.0 } else { 1.0 };
        2.0 * self.chain.breakaway_nm(self.e.t_s[k], s.mean[0], direction, 0.0) * reversed.sqrt()
    }
}

/// Acceleration that the torques on a joint give: gravity or motor, and friction; or else what its motion needs.
fn scale_rad_s2(chain: &Chain<f64>, along: &Along<'_>, e: &Experiment, frequency_rad_s: f64) -> f64 {
    let n = e.t_s.len() as f64;
    let squares: f64 = e.measured_rad.iter().enumerate().map(|(k, q)| along.resting_nm(k, *q).powi(2)).sum();
    let breakaway_nm = chain.breakaway_nm(0.0, 0.0, 1.0, 0.0);
    let acting_nm = chain.link.peak_gravity_nm().max((squares / n).sqrt()) + breakaway_nm;
    let mean = e.measured_rad.iter().sum::<f64>() / n;
    let spread_rad = (e.measured_rad.iter().map(|q| (q - mean).powi(2)).sum::<f64>() / n).sqrt();
    (acting_nm / chain.inertia_kg_m2()).max(frequency_rad_s.powi(2) * spread_rad)
}

#[cfg(test)]
#[path = "residual_torque_tests.rs"]
mod tests;
