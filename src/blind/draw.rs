//! Draws causes, and says which effects can be there at once.

use super::cause::{Cause, CauseFilter, OutsideId};
use super::dice::Dice;
use crate::joint::EffectId;

/// Of a hundred studies so many have nothing but numbers that are off as the study says, wrong numbers, one, two, three,
/// four effects, and a servo with all that servos have; in the others is something outside the catalogue.
const SHARES: [f64; 7] = [13.0, 12.0, 30.0, 15.0, 8.0, 4.0, 7.0];

/// Draws a cause of a kind.
pub(super) fn draw_cause(filter: &CauseFilter, dice: &mut Dice) -> Cause {
    match filter {
        CauseFilter::Only(cause) => cause.clone(),
        CauseFilter::AnyOutside => Cause::Outside(dice.pick(OutsideId::ALL)),
        CauseFilter::Effects(count) => Cause::Effects(draw_effects(*count, dice)),
        CauseFilter::Any => {
            let (mut left, mut kind) = (dice.uniform(0.0, 100.0), 0);
            while SHARES.get(kind).is_some_and(|share| left >= *share) {
                left -= SHARES[kind];
                kind += 1;
            }
            match kind {
                0 => Cause::Nothing,
                1 => Cause::Calibration,
                count @ 2..=5 => Cause::Effects(draw_effects(count - 1, dice)),
                6 => Cause::Servo,
                _ => Cause::Outside(dice.pick(OutsideId::ALL)),
            }
        }
    }
}

fn draw_effects(count: usize, dice: &mut Dice) -> Vec<EffectId> {
    let mut effects: Vec<EffectId> = Vec::with_capacity(count);
    while effects.len() < count {
        let others: Vec<EffectId> = EffectId::ALL.iter().copied().filter(|other| can_join(&effects, *other)).collect();
        if others.is_empty() {
            break;
        }
        effects.push(dice.pick(&others));
    }
    effects
}

/// Effects that are there at once are of different kinds, but for friction, of which there may be two; and not one
/// effect by another name: a spring with a constant torque is a spring that is slack elsewhere.
fn can_join(effects: &[EffectId], other: EffectId) -> bool {
    use EffectId::{AsymmetricFriction, JointSpring};
    let of_kind = effects.iter().filter(|effect| kind(**effect) == kind(other)).count();
    let most = if kind(other) == Kind::Friction { 2 } else { 1 };
    let one_spring = |a, b| other == a && effects.contains(&b);
    !effects.contains(&other)
        && of_kind < most
        && !one_spring(JointSpring, AsymmetricFriction)
        && !one_spring(AsymmetricFriction, JointSpring)
}

/// Effects of one kind do much the same.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Friction,
    Transmission,
    Reading,
    Setpoint,
    Profile,
    Command,
    Motor,
}

fn kind(effect: EffectId) -> Kind {
    use EffectId::*;
    match effect {
        Stribeck | LoadFriction | GearFriction | QuadraticDrag | AsymmetricFriction | PositionFriction
        | FrictionDrift => Kind::Friction,
        Backlash | EndStop | Compliance => Kind::Transmission,
        JointSpring | AngleOffset | SensorGain => Kind::Reading,
        Delay | SensorDelay | SetpointHold => Kind::Setpoint,
        SetpointProfile => Kind::Profile,
        DeadBand => Kind::Command,
        TorqueLimit | SpeedLimit | MotorGain => Kind::Motor,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn effects_at_once_are_not_one_by_another_name() {
        use EffectId::*;
        assert!(can_join(&[Delay], Stribeck) && !can_join(&[Delay], SetpointHold) && !can_join(&[Delay], Delay));
        assert!(!can_join(&[JointSpring], AsymmetricFriction) && !can_join(&[AsymmetricFriction], JointSpring));
        assert!(can_join(&[Stribeck], LoadFriction) && !can_join(&[Stribeck, LoadFriction], GearFriction));
        let mut dice = Dice::new(3, 3);
        assert!((0..200).all(|_| draw_effects(4, &mut dice).len() == 4));
    }

    #[test]
    fn kinds_are_drawn_in_their_shares() {
        let mut dice = Dice::new(3, 4);
        let mut counts = [0_usize; 8];
        for _ in 0..4000 {
            counts[match draw_cause(&CauseFilter::Any, &mut dice) {
                Cause::Nothing => 0,
                Cause::Calibration => 1,
                Cause::Effects(effects) => 1 + effects.len(),
                Cause::Servo => 6,
                Cause::Outside(_) => 7,
            }] += 1;
        }
        let all: Vec<f64> = SHARES.iter().copied().chain([100.0 - SHARES.iter().sum::<f64>()]).collect();
        for (count, share) in counts.iter().zip(all) {
            assert!((*count as f64 / 40.0 - share).abs() < 2.5, "{counts:?}");
        }
    }
}
