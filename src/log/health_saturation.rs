//! A drive at its limit: a torque that stands at its largest value, a reading that stays where it is while the setpoint
//! goes on.

use super::health_stamps::still_stretches;
use crate::number::extent;

/// A plateau lasts at least so many samples.
const RUN: usize = 3;
/// A plateau holds this share of the samples at least.
const SHARE: f64 = 0.01;
/// Values that are nearer to the largest one than this share of it are at it.
const NEAR: f64 = 1e-3;
/// A signal with fewer levels than this is switched, not limited.
const LEVELS: usize = 20;
/// A reading stands still at an end for at least this long \[s\].
const STANDS_S: f64 = 0.1;
/// Setpoints have to go beyond it by so many bands.
const BEYOND: f64 = 10.0;
/// Beyond so many bands a reading is at another place.
const LEFT: f64 = 3.0;
/// A joint sticks if its setpoint comes back past it by more than this share of how far it went beyond.
const STAYS: f64 = 0.3;

/// A reading that stands at its end while the setpoint goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stuck {
    /// Where it stands \[rad\].
    pub at_rad: f64,
    /// How long in all \[s\].
    pub lasts_s: f64,
    /// How far the setpoint goes beyond it \[rad\].
    pub beyond_rad: f64,
    /// How far the setpoint comes back on the near side before the reading follows it, at the most \[rad\].
    pub back_rad: f64,
    /// How often it comes to stand there.
    pub visits: usize,
    /// At how many other places it stands while the setpoint moves.
    pub elsewhere: usize,
}

/// What holds a joint while its setpoint goes on, as far as its log can tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Holds {
    /// The setpoint comes back past the reading, which stays all the same, or the joint stands at other places too: it
    /// sticks, and the drive is too weak for its friction.
    Friction,
    /// It stands at the same place each time, and leaves it as the setpoint comes back: something is in the way, or the
    /// drive can no more.
    EndOrLimit,
    /// It stood once.
    Unknown,
}

impl Stuck {
    /// What holds the joint.
    pub fn holds(&self) -> Holds {
        match self {
            Self { elsewhere: 2.., .. } => Holds::Friction,
            _ if self.back_rad > STAYS * self.beyond_rad => Holds::Friction,
            Self { elsewhere: 0, visits: 2.., .. } => Holds::EndOrLimit,
            _ => Holds::Unknown,
        }
    }

    /// What is to be said of it.
    pub(super) fn words(&self) -> String {
        let Self { at_rad, lasts_s, beyond_rad, back_rad, visits, elsewhere } = self;
        let stands = format!(
            "readings stand at {at_rad:.3} rad for {lasts_s:.2} s while the setpoint goes {beyond_rad:.3} rad beyond"
        );
        match self.holds() {
            Holds::Friction if *elsewhere > 1 => {
                format!(
                    "{stands}, and at {elsewhere} other places: the joint sticks, its drive is weak for its friction"
                )
            }
            Holds::Friction => format!(
                "{stands}, and until it has come {back_rad:.3} rad back: the joint sticks, its drive is weak for its friction"
            ),
            Holds::EndOrLimit => format!("{stands}, there each of {visits} times: a stop, or a drive at its limit"),
            Holds::Unknown => format!("{stands}: a stop, a drive at its limit, or friction that it does not overcome"),
        }
    }
}

/// The largest torque \[N m\] and the share of the samples at it, where it stands there; `None`: it is not limited.
pub(super) fn torque_plateau(tau_nm: &[f64]) -> Option<(f64, f64)> {
    let largest = tau_nm.iter().fold(0.0, |most: f64, tau| most.max(tau.abs()));
    let mut levels: Vec<f64> = tau_nm.iter().step_by(tau_nm.len().div_ceil(2000).max(1)).copied().collect();
    levels.sort_unstable_by(f64::total_cmp);
    levels.dedup();
    if levels.len() < LEVELS || largest == 0.0 {
        return None;
    }
    let is_at = |tau: &f64| tau.abs() >= (1.0 - NEAR) * largest;
    let runs = tau_nm.chunk_by(|a, b| is_at(a) && is_at(b)).filter(|run| run.len() >= RUN && is_at(&run[0]));
    let share = runs.map(<[f64]>::len).sum::<usize>() as f64 / tau_nm.len() as f64;
    (share >= SHARE).then_some((largest, share))
}

/// Where a reading stands at its largest or smallest value, within a band, while the setpoint goes beyond it and moves.
pub(super) fn stuck(t_s: &[f64], q_rad: &[f64], q_ref_rad: &[f64], band_rad: f64) -> Option<Stuck> {
    let [low, high] = extent(q_rad.iter().copied());
    let samples = q_rad.len().min(q_ref_rad.len());
    let (t_s, q_rad, q_ref_rad) = (&t_s[..samples], &q_rad[..samples], &q_ref_rad[..samples]);
    let found = [(high, 1.0), (low, -1.0)].map(|(end, sign)| at_end(t_s, q_rad, q_ref_rad, (end, sign), band_rad));
    let found = found.into_iter().flatten().max_by(|a, b| a.lasts_s.total_cmp(&b.lasts_s))?;
    Some(Stuck { elsewhere: elsewhere(t_s, q_rad, q_ref_rad, [low, high], band_rad), ..found })
}

/// The same at one end; `sign` points outwards.
fn at_end(t_s: &[f64], q_rad: &[f64], q_ref_rad: &[f64], (end, sign): (f64, f64), band_rad: f64) -> Option<Stuck> {
    let beyond = BEYOND * band_rad;
    let (mut lasts_s, mut least, mut most, mut back) = (0.0, f64::INFINITY, 0.0_f64, 0.0_f64);
    // Visits in which the setpoint went beyond, whether this is one, and the sample before if that was so already.
    let (mut visits, mut is_counted, mut from) = (0, false, None);
    for k in 0..q_rad.len() {
        let ahead = (q_ref_rad[k] - end) * sign;
        if (end - q_rad[k]) * sign > band_rad {
            // A reading that flickers about the band's edge has not left.
            is_counted &= (end - q_rad[k]) * sign <= LEFT * band_rad;
            from = None;
            continue;
        }
        if ahead > beyond {
            (least, most) = (least.min(ahead), most.max(ahead));
            lasts_s += from.map_or(0.0, |before: usize| t_s[k] - t_s[before]);
            visits += usize::from(!is_counted);
            (is_counted, from) = (true, Some(k));
        } else {
            from = None;
            if is_counted {
                back = back.max(-ahead);
            }
        }
    }
    // A setpoint that stays where it is may be a rest that gravity or friction causes.
    let stands = lasts_s >= STANDS_S && most - least > beyond;
    stands.then_some(Stuck { at_rad: end, lasts_s, beyond_rad: most, back_rad: back, visits, elsewhere: 0 })
}

/// Places away from both ends at which the reading stands while the setpoint moves.
fn elsewhere(t_s: &[f64], q_rad: &[f64], q_ref_rad: &[f64], ends: [f64; 2], band_rad: f64) -> usize {
    let mut places: Vec<f64> = Vec::new();
    for stand in still_stretches(t_s, q_rad, band_rad, STANDS_S) {
        let at = q_rad[stand.start];
        let asked = &q_ref_rad[stand];
        let [low, high] = extent(asked.iter().copied());
        let is_near = |other: &f64| (other - at).abs() <= LEFT * band_rad;
        if high - low > BEYOND * band_rad && !ends.iter().any(is_near) && !places.iter().any(is_near) {
            places.push(at);
        }
    }
    places.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(limit: f64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        lasting(1000, limit)
    }

    fn lasting(samples: u32, limit: f64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let t: Vec<f64> = (0..samples).map(|k| 0.01 * f64::from(k)).collect();
        let asked: Vec<f64> = t.iter().map(|t| t.sin()).collect();
        let kept = asked.iter().map(|q| q.clamp(-limit, 2.0)).collect();
        (t, asked, kept)
    }

    #[test]
    fn a_torque_that_stands_at_its_largest_value_is_limited() {
        let (_, asked, kept) = wave(0.7);
        assert_eq!(
            torque_plateau(&asked.iter().map(|tau| tau * 0.9).collect::<Vec<f64>>()).filter(|(_, s)| *s > 0.1),
            None
        );
        let both: Vec<f64> = kept.iter().map(|tau| tau.min(0.7)).collect();
        let (at, share) = torque_plateau(&both).unwrap();
        assert!((at - 0.7).abs() < 1e-12 && (0.4..0.6).contains(&share), "{at} {share}");
        // A bang-bang torque is at its largest by design, and one of nothing is none.
        assert_eq!(torque_plateau(&[1.0, -1.0].repeat(100)), None);
        assert_eq!(torque_plateau(&[]), None);
    }

    #[test]
    fn a_reading_that_stays_while_the_setpoint_goes_on_is_stuck() {
        let (t, asked, kept) = wave(0.7);
        let found = stuck(&t, &kept, &asked, 0.002).unwrap();
        assert!((found.at_rad + 0.7).abs() < 1e-9 && (found.beyond_rad - 0.3).abs() < 1e-3, "{found:?}");
        assert!((1.4..1.7).contains(&found.lasts_s), "{found:?}");
        assert_eq!((found.visits, found.elsewhere, found.holds()), (1, 0, Holds::Unknown), "{found:?}");
        assert_eq!(stuck(&t, &asked, &asked, 0.002), None);
        // A droop at a setpoint that rests is no limit.
        assert_eq!(stuck(&t, &[0.5; 1000], &[0.6; 1000], 0.002), None);
    }

    /// A joint without inertia that follows as far as its friction lets it: `gap` behind its setpoint.
    fn dragged(asked: &[f64], gap: f64) -> Vec<f64> {
        let follow = |q: &mut f64, asked: &f64| {
            *q = q.clamp(asked - gap, asked + gap);
            Some(*q)
        };
        asked.iter().scan(0.0, follow).collect()
    }

    #[test]
    fn a_joint_that_only_sticks_is_not_said_to_be_at_a_stop() {
        let (t, asked, _) = wave(2.0);
        let found = stuck(&t, &dragged(&asked, 0.3), &asked, 0.002).unwrap();
        assert_eq!(found.holds(), Holds::Friction, "{found:?}");
        assert!((found.back_rad / found.beyond_rad - 1.0).abs() < 0.1, "{found:?}");
        // Stands of another size at each turn, as those of a setpoint that grows.
        let growing: Vec<f64> = t.iter().map(|t| 0.1 * t * t.sin()).collect();
        let found = stuck(&t, &dragged(&growing, 0.1), &growing, 0.002).unwrap();
        assert_eq!(found.holds(), Holds::Friction, "{found:?}");
        assert!(found.words().contains("sticks") && !found.words().contains("stop"), "{}", found.words());
    }

    #[test]
    fn a_stop_is_one_with_friction_too_and_one_visit_says_neither() {
        let (t, asked, _) = lasting(2000, 2.0);
        let stopped: Vec<f64> = dragged(&asked, 0.02).iter().map(|q| q.max(-0.6)).collect();
        let found = stuck(&t, &stopped, &asked, 0.002).unwrap();
        assert_eq!((found.visits, found.elsewhere, found.holds()), (3, 0, Holds::EndOrLimit), "{found:?}");
        let once = t.iter().take_while(|t| **t < 8.0).count();
        let found = stuck(&t[..once], &stopped[..once], &asked[..once], 0.002).unwrap();
        assert_eq!((found.visits, found.holds()), (1, Holds::Unknown), "{found:?}");
    }
}
