//! The answer as a sentence that a colleague would say.

use super::decide::Decision;
use super::diagnosis::{Gap, Number, Verdict};
use crate::joint::EffectId;

/// Words for an effect.
pub(super) fn words(effect: EffectId) -> &'static str {
    match effect {
        EffectId::Stribeck => "static friction above Coulomb's (Stribeck)",
        EffectId::LoadFriction => "friction that grows with the load",
        EffectId::GearFriction => "friction that grows with the motor torque",
        EffectId::QuadraticDrag => "drag that grows with the square of the speed",
        EffectId::AsymmetricFriction => "Coulomb friction that differs with the direction",
        EffectId::PositionFriction => "Coulomb friction that varies with the angle",
        EffectId::FrictionDrift => "friction that changes along a log",
        EffectId::Backlash => "free play between motor and link",
        EffectId::JointSpring => "a spring in parallel to the joint",
        EffectId::EndStop => "a stop inside the range of motion",
        EffectId::AngleOffset => "a wrong zero of the angle",
        EffectId::SensorGain => "a wrong gain of the encoder",
        EffectId::Compliance => "a spring between motor and link",
        EffectId::SensorDelay => "a reading that is late",
        EffectId::SetpointProfile => "a servo that limits speed and acceleration of its setpoint",
        EffectId::DeadBand => "small motor torques that do not arrive",
        EffectId::Delay => "a delay of the setpoint",
        EffectId::SetpointHold => "setpoints that get through only every so often",
        EffectId::TorqueLimit => "a motor torque that saturates",
        EffectId::SpeedLimit => "a motor torque that falls with speed",
        EffectId::MotorGain => "a motor that delivers more or less than commanded",
    }
}

fn mrad(rad: f64) -> String {
    if rad >= 0.0995 { format!("{:.0} mrad", 1e3 * rad) } else { format!("{:.2} mrad", 1e3 * rad) }
}

fn share(gap: &Gap) -> String {
    match (gap.closed, gap.closed_interval) {
        (Some(closed), Some([low, high])) => {
            format!("{:.0} % [{:.0}, {:.0}] of the gap", 100.0 * closed, 100.0 * low, 100.0 * high)
        }
        (Some(closed), None) => format!("{:.0} % of the gap", 100.0 * closed),
        _ => "the gap".into(),
    }
}

/// The sentence of a decision.
pub(super) fn sentence(
    joint: &str,
    decision: &Decision<'_>,
    gap: &Gap,
    parameter: Option<&str>,
    effects: &[(EffectId, Vec<Number>)],
) -> String {
    let size = |effect: EffectId| {
        let number = effects.iter().find(|(e, _)| *e == effect).and_then(|(_, numbers)| numbers.first());
        number.map_or(String::new(), |n| {
            let unit = if n.unit.is_empty() { String::new() } else { format!(" {}", n.unit) };
            format!(" ({} = {:.3e}{unit})", n.name, n.value)
        })
    };
    match (decision.verdict, decision.effect) {
        (Verdict::None, _) => format!(
            "{joint}: nothing is missing. The model as given explains the held-out logs to the sensor's noise ({} against {}).",
            mrad(gap.before),
            mrad(gap.floor)
        ),
        (Verdict::Calibration, _) => format!(
            "{joint}: the structure is right and the numbers are off, the {} most of all; refitting them closes {}, from {} to {}.",
            parameter.unwrap_or("inertia"),
            share(gap),
            mrad(gap.before),
            mrad(gap.after)
        ),
        (Verdict::Effect, Some(effect)) => {
            let mut text = format!("{joint}: the gap is {}{}", words(effect), size(effect));
            if let Some(second) = decision.second {
                text += &format!(", together with {}{}", words(second), size(second));
            }
            text += &format!("; adding it closes {}, from {} to {}.", share(gap), mrad(gap.before), mrad(gap.after));
            let others: Vec<&str> = decision.equivalent.iter().filter(|e| **e != effect).map(|e| words(*e)).collect();
            if !others.is_empty() {
                text += &format!(" These logs cannot tell it apart from {}.", others.join(", nor from "));
            }
            text
        }
        (_, partial) => {
            let nearest = partial.map_or(String::new(), |effect| {
                format!(
                    " The nearest is {}, which closes {} and leaves structure in the rest.",
                    words(effect),
                    share(gap)
                )
            });
            format!(
                "{joint}: none of the effects I know explains this gap; {} stay above the sensor's {}.{nearest}",
                mrad(gap.after),
                mrad(gap.floor)
            )
        }
    }
}
