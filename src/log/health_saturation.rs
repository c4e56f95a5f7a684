//! A drive at its limit: a torque that stands at its largest value, a reading that stays where it is while the setpoint
//! goes on.

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

/// A reading that stands at its end while the setpoint goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stuck {
    /// Where it stands \[rad\].
    pub at_rad: f64,
    /// How long in all \[s\].
    pub lasts_s: f64,
    /// How far the setpoint goes beyond it \[rad\].
    pub beyond_rad: f64,
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
    let (low, high) = q_rad.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), q| (l.min(*q), h.max(*q)));
    let beyond = BEYOND * band_rad;
    let found = [(high, 1.0), (low, -1.0)].into_iter().filter_map(|(end, sign)| {
        let is_at = |k: usize| (end - q_rad[k]) * sign <= band_rad && (q_ref_rad[k] - end) * sign > beyond;
        let (mut lasts_s, mut least, mut most, mut from) = (0.0, f64::INFINITY, 0.0_f64, None);
        for k in 0..q_rad.len().min(q_ref_rad.len()) {
            if !is_at(k) {
                from = None;
                continue;
            }
            let ahead = (q_ref_rad[k] - end) * sign;
            (least, most) = (f64::min(least, ahead), most.max(ahead));
            lasts_s += from.map_or(0.0, |before: usize| t_s[k] - t_s[before]);
            from = Some(k);
        }
        // A setpoint that stays where it is may be a rest that gravity or friction causes.
        (lasts_s >= STANDS_S && most - least > beyond).then_some(Stuck { at_rad: end, lasts_s, beyond_rad: most })
    });
    found.max_by(|a, b| a.lasts_s.total_cmp(&b.lasts_s))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(limit: f64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let t: Vec<f64> = (0..1000).map(|k| 0.01 * f64::from(k)).collect();
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
        assert_eq!(stuck(&t, &asked, &asked, 0.002), None);
        // A droop at a setpoint that rests is no limit.
        assert_eq!(stuck(&t, &[0.5; 1000], &[0.6; 1000], 0.002), None);
    }
}
