//! Effects that are easily taken for one another, and how one of them is written as another.

use crate::gap::hypothesis::model::{DERIVATIVE, MOMENT, VISCOUS};
use crate::joint::{EffectForm, EffectId, Reach};

/// Effects that are easily taken for one another, whatever a look from afar says.
const KIN: [&[EffectId]; 3] = [
    &[EffectId::Delay, EffectId::SensorDelay, EffectId::SetpointHold, EffectId::SetpointProfile],
    &[EffectId::TorqueLimit, EffectId::SpeedLimit],
    // A constant torque, and that of a spring which is slack elsewhere.
    &[EffectId::AsymmetricFriction, EffectId::JointSpring],
];

/// A torque-speed line that ends at so many times the largest speed is hardly more than a torque limit.
const FAR: f64 = 4.0;

/// Whether one effect is easily taken for another.
pub(in crate::gap) fn is_kin(a: EffectId, b: EffectId) -> bool {
    KIN.iter().any(|kin| kin.contains(&a) && kin.contains(&b))
}

/// An effect with which a joint does nearly what it does with another one.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::gap) struct Written {
    pub form: EffectForm,
    /// Values of the effect.
    pub values: Vec<f64>,
    /// What is added to numbers of the joint, by their places.
    pub numbers: Vec<(usize, f64)>,
}

/// What a joint is like beside the effect that is written anew.
#[derive(Clone, Copy, Debug)]
pub(in crate::gap) struct Around<'a> {
    pub reach: &'a Reach,
    pub gravity_m_s2: f64,
    /// How much more viscous friction was found than is believed \[N m s/rad\].
    pub more_viscous_nm_s_rad: f64,
    /// Derivative gain that the study states \[N m s/rad\].
    pub kd_nm_s_rad: f64,
}

/// Ways to write an effect with its values as another one; none where that cannot be done.
pub(in crate::gap) fn written_as(member: EffectId, own: &[f64], other: EffectId, around: &Around<'_>) -> Vec<Written> {
    let [low, high] = around.reach.angle_rad;
    let middle = 0.5 * (low + high);
    let moment = |stiffness: f64| match around.gravity_m_s2 > 0.0 {
        true => vec![(MOMENT, -stiffness / around.gravity_m_s2)],
        false => Vec::new(),
    };
    let plain = |values: Vec<f64>, numbers| Written { form: other.into(), values, numbers };
    match (member, other) {
        (EffectId::TorqueLimit, EffectId::SpeedLimit) => {
            let Some(driven) = around.reach.driven else { return Vec::new() };
            let mut ways = vec![plain(vec![FAR * driven.speed_rad_s, own[0]], vec![])];
            // Viscous friction beyond belief may be the braking of the back voltage.
            let back = around.more_viscous_nm_s_rad;
            if back > 0.0 {
                let by = |name: &str, numbers| {
                    let form = other.forms().find(|form| form.name() == name)?;
                    Some(Written { form, values: vec![own[0] / back, own[0]], numbers })
                };
                ways.extend(by("voltage", vec![(VISCOUS, -back)]));
                if around.kd_nm_s_rad > 0.0 {
                    ways.extend(by("line", vec![(VISCOUS, -back), (DERIVATIVE, back / around.kd_nm_s_rad)]));
                }
            }
            ways
        }
        (EffectId::SpeedLimit, EffectId::TorqueLimit) => vec![plain(vec![own[1]], vec![])],
        (EffectId::AsymmetricFriction, EffectId::JointSpring) => {
            let slack_rad = if own[0] < 0.0 { high } else { low };
            let stiffness = -own[0] / (slack_rad - middle);
            vec![plain(vec![stiffness, slack_rad], moment(stiffness))]
        }
        (EffectId::JointSpring, EffectId::AsymmetricFriction) => {
            vec![plain(vec![own[0] * (middle - own[1])], moment(-own[0]))]
        }
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::joint::DrivenReach;
    use approx::assert_relative_eq;

    fn reach() -> Reach {
        let driven = DrivenReach {
            command_nm: 2.0,
            speed_rad_s: 3.0,
            period_s: 0.01,
            by_setpoint: true,
            by_derivative: true,
            by_integral: false,
        };
        Reach {
            torque_nm: 1.0,
            coulomb_nm: 0.1,
            inertia_kg_m2: 0.02,
            speed_rad_s: 3.0,
            angle_rad: [-1.0, 0.5],
            duration_s: 5.0,
            resolution_rad: 1e-3,
            driven: Some(driven),
        }
    }

    fn around(reach: &Reach, more_viscous_nm_s_rad: f64) -> Around<'_> {
        Around { reach, gravity_m_s2: 10.0, more_viscous_nm_s_rad, kd_nm_s_rad: 0.5 }
    }

    #[test]
    fn a_constant_torque_is_that_of_a_spring_in_the_middle_of_the_travel() {
        use EffectId::{AsymmetricFriction, JointSpring};
        let reach = reach();
        for delta_nm in [0.2, -0.2] {
            let ways = written_as(AsymmetricFriction, &[delta_nm], JointSpring, &around(&reach, 0.0));
            let [k, slack_rad] = ways[0].values[..] else { panic!("{ways:?}") };
            assert!(k > 0.0);
            assert_relative_eq!(k * (slack_rad + 0.25), -delta_nm, epsilon = 1e-15);
            // What the spring pulls back gravity does not.
            assert_eq!(ways[0].numbers, [(MOMENT, -k / 10.0)]);
            let back = written_as(JointSpring, &ways[0].values, AsymmetricFriction, &around(&reach, 0.0));
            assert_relative_eq!(back[0].values[0], delta_nm, epsilon = 1e-15);
            assert_eq!(back[0].numbers, [(MOMENT, k / 10.0)]);
        }
    }

    #[test]
    fn limits_stand_for_one_another_and_what_brakes_too_much_is_the_back_voltage() {
        use EffectId::{Delay, SensorDelay, SpeedLimit, Stribeck, TorqueLimit};
        let reach = reach();
        let limits = |more| written_as(TorqueLimit, &[0.6], SpeedLimit, &around(&reach, more));
        assert_eq!(limits(-0.1).len(), 1);
        assert_eq!(limits(0.0)[0].values, [12.0, 0.6]);
        let [_, voltage, line] = &limits(0.1)[..] else { panic!() };
        assert_eq!((voltage.form.name(), line.form.name()), ("voltage", "line"));
        assert_eq!([&voltage.values, &line.values], [&[0.6 / 0.1, 0.6]; 2]);
        assert_eq!(voltage.numbers, [(VISCOUS, -0.1)]);
        assert_eq!(line.numbers, [(VISCOUS, -0.1), (DERIVATIVE, 0.2)]);
        assert_eq!(written_as(SpeedLimit, &[12.0, 0.7], TorqueLimit, &around(&reach, 0.0))[0].values, [0.7]);
        assert!(written_as(Delay, &[0.01], Stribeck, &around(&reach, 0.0)).is_empty());
        assert!(is_kin(Delay, SensorDelay) && !is_kin(Delay, Stribeck));
    }
}
