//! What the study states: numbers that are exact, off by what it says, or off by up to 40 %.

use super::dice::{Dice, significant};
use super::joint::DIGITS;
use super::truth::{Believed, FourNumbers, Gains};

/// What the study states about a joint.
#[derive(Clone, Debug)]
pub(super) struct Belief {
    pub nominal: FourNumbers,
    pub gains: Gains,
    pub believed: Believed,
}

/// What a reader takes for granted where the study has no table `[uncertain]`.
const DEFAULTS: Believed = Believed { inertia: 0.10, moment: 0.05, friction: 0.5, gain: 0.10, written: false };
/// Standard deviations that engineers write, from and to.
const WRITTEN: [[f64; 2]; 4] = [[0.02, 0.2], [0.01, 0.1], [0.1, 0.5], [0.02, 0.15]];
/// A true number is not further than this below the stated one, as a share of that.
const LEAST_SHARE: f64 = -0.6;
/// From so many standard deviations on a number is wrong.
pub(super) const WRONG_SD: f64 = 3.0;

/// How the numbers of a study are off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Errors {
    /// Not at all, or by what the study says.
    Within,
    /// Each by chance: not at all, by what the study says, or by up to 40 %.
    Mixed,
    /// One or more by so much that the study is wrong about them.
    Wrong,
}

impl Belief {
    /// Draws what the study says of numbers and gains that are truly so.
    pub(super) fn draw(numbers: &FourNumbers, gains: Gains, driven: bool, errors: Errors, dice: &mut Dice) -> Self {
        let written = dice.chance(0.5);
        let scatter = if written {
            let [inertia, moment, friction, gain] = WRITTEN.map(|[low, high]| dice.log_uniform(low, high));
            Believed { inertia, moment, friction, gain, written }
        } else {
            DEFAULTS
        };
        // some are surer of themselves than they have reason to be
        let too_sure = if written && dice.chance(0.3) { dice.uniform(1.2, 2.0) } else { 1.0 };
        let believed = scatter.divided(too_sure);
        let [inertia, moment, coulomb, viscous] = numbers.list();
        let truth = [inertia, moment, coulomb, viscous, gains.kp, gains.kd];
        let count = if driven { 6 } else { 4 };
        let exact = errors != Errors::Wrong && dice.chance(0.35);
        let mut shares = [0.0; 6];
        let mut far_gain = false;
        for (k, share) in shares.iter_mut().enumerate().take(count) {
            let sd = scatter.of(k);
            // a number cannot be less than nothing
            let within = (sd * dice.normal().clamp(-2.0, 2.0)).max(LEAST_SHARE);
            let far = dice.sign() * dice.uniform(0.03, 0.4);
            *share = match dice.uniform(0.0, 1.0) {
                _ if exact => 0.0,
                x if x < 0.3 => 0.0,
                // gains that are both far off are a motor's gain
                x if x > 0.75 && errors == Errors::Mixed && !(k > 3 && far_gain) => {
                    far_gain |= k > 3;
                    far
                }
                _ => within,
            };
        }
        if errors == Errors::Wrong {
            let wrong = dice.whole(1, 3);
            for k in dice.some_of(wrong, count) {
                if k > 3 && std::mem::replace(&mut far_gain, true) {
                    continue;
                }
                let least = 1.15 * WRONG_SD * believed.of(k);
                let share = dice.uniform(least.max(0.08), (1.5 * least).max(0.4));
                shares[k] = if share < -LEAST_SHARE { dice.sign() * share } else { share };
            }
        }
        let mut stated = [0.0; 6];
        for (k, value) in stated.iter_mut().enumerate() {
            // the share is of what is stated, as its standard deviation is
            *value = if shares[k] == 0.0 { truth[k] } else { significant(truth[k] / (1.0 + shares[k]), DIGITS) };
        }
        let [inertia, moment, coulomb, viscous, kp, kd] = stated;
        Self { nominal: FourNumbers { inertia, moment, coulomb, viscous }, gains: Gains { kp, kd }, believed }
    }

    /// Names of the numbers that are off, each with how far, in standard deviations as stated.
    pub(super) fn off_sd(&self, numbers: &FourNumbers, gains: Gains) -> Vec<(&'static str, f64)> {
        let names = FourNumbers::NAMES.into_iter().chain(Gains::NAMES).enumerate();
        let truth = numbers.list().into_iter().chain(gains.list());
        let stated = self.nominal.list().into_iter().chain(self.gains.list());
        let pairs = truth.zip(stated);
        let off = names.zip(pairs).map(|((k, name), (t, s))| (name, (t / s - 1.0).abs() / self.believed.of(k)));
        off.filter(|(_, sd)| *sd > 0.0).collect()
    }
}

impl Believed {
    /// Of inertia, moment, coulomb, viscous, kp, kd.
    fn of(&self, k: usize) -> f64 {
        [self.inertia, self.moment, self.friction, self.friction, self.gain, self.gain][k]
    }

    fn divided(self, by: f64) -> Self {
        let [inertia, moment, friction, gain] =
            [self.inertia, self.moment, self.friction, self.gain].map(|sd| significant(sd / by, 2));
        Self { inertia, moment, friction, gain, written: self.written }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_off_as_asked() {
        let numbers = FourNumbers { inertia: 0.01, moment: 0.05, coulomb: 0.02, viscous: 0.01 };
        let gains = Gains { kp: 5.0, kd: 0.2 };
        let mut dice = Dice::new(8, 8);
        let (mut exact, mut far, mut written) = (0, 0, 0);
        for _ in 0..400 {
            let sure = Belief::draw(&numbers, gains, true, Errors::Within, &mut dice);
            let off = sure.off_sd(&numbers, gains);
            exact += usize::from(off.is_empty());
            written += usize::from(sure.believed.written);
            // twice their scatter, of which the study states no less than half
            assert!(off.iter().all(|(_, sd)| *sd < 4.6), "{off:?}");
            assert!(sure.nominal.list().iter().all(|value| value.is_finite() && *value > 0.0), "{sure:?}");
            let mixed = Belief::draw(&numbers, gains, false, Errors::Mixed, &mut dice);
            assert_eq!(mixed.gains, gains, "no gain is stated where nothing drives");
            far += usize::from((mixed.nominal.inertia / numbers.inertia - 1.0).abs() > 0.2);
            let wrong = Belief::draw(&numbers, gains, true, Errors::Wrong, &mut dice);
            assert!(wrong.off_sd(&numbers, gains).iter().any(|(_, sd)| *sd > WRONG_SD), "{wrong:?}");
        }
        assert!((100..300).contains(&exact) && far > 20 && (160..240).contains(&written), "{exact} {far} {written}");
    }
}
