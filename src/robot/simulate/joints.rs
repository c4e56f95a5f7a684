//! The joint chain on every joint of the tree.

use super::SimulateError;
use crate::geometry::JointSpring;
use crate::geometry::robot_file::{FRICTION_SET, GAIN_SET};
use crate::joint::{
    Chain, Contact, EffectForm, EffectId, EndStop, Friction, Knee, Link, Motor, Push, Stribeck, StribeckCurve,
    TorqueLimit,
};
use crate::log::{Derivative, Hold, MotorSpec};
use crate::pendulum::ROTOR_AT_MOST;
use crate::robot::model::BASE_FREEDOMS;
use crate::robot::{Dynamics, JointId, Model, PidGains, State};
use nalgebra::DMatrix;

/// A joint of the tree: everything but inertia and gravity, which are the tree's.
pub struct JointDrive {
    /// The stages; its link has the inertia about the axis with all joints at 0, and no gravity.
    pub chain: Chain<f64>,
    /// The encoder reads this much less than the angle \[rad\], and so does the controller.
    pub zero_rad: f64,
    /// What holds a joint without a controller.
    pub spring: Option<JointSpring>,
    /// Mechanical end stops; none unless they were asked for.
    pub stops: Vec<EndStop<f64>>,
    /// Held where it is, whatever acts.
    pub is_rigid: bool,
    /// Inertia about its axis that is left where all other joints and the base give way \[kg m^2\].
    pub(super) loose_kg_m2: f64,
}

impl JointDrive {
    fn new(inertia_kg_m2: f64, loose_kg_m2: f64, spring: Option<JointSpring>) -> Self {
        let link = Link::new(inertia_kg_m2, 0.0, 0.0, 0.0);
        let chain = Chain::new(link, Friction::coulomb_viscous(0.0, 0.0), None);
        Self { chain, zero_rad: 0.0, spring, stops: Vec::new(), is_rigid: false, loose_kg_m2 }
    }

    /// What the encoder makes of a true angle, before noise and steps \[rad\]; on a tree none changes with time.
    #[inline]
    pub fn reading_rad(&self, angle_rad: f64) -> f64 {
        self.chain.reading_rad(0.0, angle_rad - self.zero_rad)
    }

    /// The true angle at which the encoder reads an angle \[rad\].
    pub fn true_rad(&self, reading_rad: f64) -> f64 {
        self.chain.read_back(0.0, reading_rad, 0.0)[0] + self.zero_rad
    }

    /// Gives it a controller, whose torque may be limited \[N m\].
    pub fn set_control(&mut self, gains: PidGains, control: Control, most_nm: Option<f64>) {
        let mut motor = Motor::new(MotorSpec {
            ki_nm_rad_s: gains.ki_nm_rad_s,
            hold: control.hold,
            derivative: control.derivative,
            sample_period_s: control.sample_period_s,
            ..MotorSpec::pd(gains.kp_nm_rad, gains.kd_nm_s_rad)
        });
        motor.torque_limit = most_nm.map(|most_nm| TorqueLimit { most_nm, knee: Knee::Hard });
        self.chain.motor = Some(motor);
    }

    /// Torque of springs and stops \[N m\].
    #[inline]
    pub fn elastic_nm(&self, angle_rad: f64, rate_rad_s: f64) -> f64 {
        // The link has no gravity: a chain without spring and stop does nothing.
        let is_elastic = self.chain.spring.is_some() || self.chain.stop.is_some() || self.chain.has_laws();
        let mut torque_nm = if is_elastic { self.chain.passive_nm(angle_rad, rate_rad_s) } else { 0.0 };
        if let Some(s) = &self.spring {
            torque_nm += s.stiffness_nm_rad * (s.rest_rad - angle_rad) - s.damping_nm_s_rad * rate_rad_s;
        }
        torque_nm + self.stops.iter().map(|stop| stop.torque_nm(angle_rad, rate_rad_s)).sum::<f64>()
    }

    /// Friction that resists at a place of the joint's motion \[N m\], zero or above.
    #[inline]
    pub fn resistance_nm(&self, at: &Contact<f64>) -> f64 {
        self.chain.friction.resistance_nm(at)
    }

    /// Whether it can stick.
    pub(super) fn has_dry_friction(&self) -> bool {
        let f = &self.chain.friction;
        f.coulomb_nm > 0.0 || f.stribeck.is_some() || !f.terms.is_empty()
    }

    /// Whether its friction asks for gravity's load.
    pub(super) fn has_friction_terms(&self) -> bool {
        !self.chain.friction.terms.is_empty()
    }
}

/// How joints are controlled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control {
    /// What the derivative acts on; the error by default, as Figure C.2 needs it.
    pub derivative: Derivative,
    /// How setpoints are read between samples; the derivative of the error needs [`Hold::Linear`].
    pub hold: Hold,
    /// The law is evaluated every so often and its torque held \[s\]; `None`: continuously.
    pub sample_period_s: Option<f64>,
}

impl Default for Control {
    fn default() -> Self {
        Self { derivative: Derivative::Error, hold: Hold::Linear, sample_period_s: None }
    }
}

/// All joints of a robot, in the model's order.
pub struct Joints {
    drives: Vec<JointDrive>,
}

impl Joints {
    /// Joints without friction and control; only the springs of the robot's file act.
    pub fn passive(model: &Model) -> Self {
        let n = BASE_FREEDOMS + model.joints().len();
        let mut mass = DMatrix::zeros(n, n);
        Dynamics::new(model).mass_matrix(&State::at_rest(model), &mut mass);
        // With the base free: what a joint moves at the least.
        let inverse = mass.clone().try_inverse();
        let drive = |(j, joint): (usize, &crate::geometry::Joint)| {
            let k = BASE_FREEDOMS + j;
            let loose = inverse.as_ref().map_or(mass[(k, k)], |inverse| 1.0 / inverse[(k, k)]);
            JointDrive::new(mass[(k, k)], loose, joint.spring)
        };
        Self { drives: model.joints().iter().enumerate().map(drive).collect() }
    }

    /// The joints of the thesis: friction of Table 3.4 (`chosen`), gains of Table B.2 (`printed`), a continuous law with
    /// the derivative on the error.
    ///
    /// # Errors
    /// [`SimulateError::NoSet`] where the robot's file does not have these sets.
    pub fn of_thesis(model: &Model) -> Result<Self, SimulateError> {
        let mut joints = Self::passive(model);
        joints.set_friction(model, FRICTION_SET)?;
        joints.set_control(model, GAIN_SET, Control::default())?;
        joints.add_effects_of_file(model)?;
        Ok(joints)
    }

    /// Friction of a named set of the robot's file.
    ///
    /// # Errors
    /// [`SimulateError::NoSet`].
    pub fn set_friction(&mut self, model: &Model, set: &str) -> Result<(), SimulateError> {
        for (id, drive) in model.joint_ids().zip(&mut self.drives) {
            let friction = model.friction(set, id).ok_or_else(|| no_set(model, "friction", set))?;
            let law = &mut drive.chain.friction;
            (law.coulomb_nm, law.viscous_nm_s_rad) = (friction.coulomb_nm, friction.viscous_nm_s_rad);
            let (static_nm, speed_rad_s) = (friction.static_nm, friction.stribeck_rad_s);
            law.stribeck = (static_nm > 0.0 && speed_rad_s > 0.0).then_some(Stribeck {
                static_nm,
                speed_rad_s,
                curve: StribeckCurve::Gaussian,
            });
        }
        // A pair that moves together has one friction, felt at the leader.
        for one in model.following() {
            let none = Friction::coulomb_viscous(0.0, 0.0);
            let law = std::mem::replace(&mut self.drives[one.follower].chain.friction, none);
            let (share, felt) = (one.multiplier.abs(), &mut self.drives[one.leader].chain.friction);
            felt.coulomb_nm += share * law.coulomb_nm;
            felt.viscous_nm_s_rad += share * share * law.viscous_nm_s_rad;
        }
        Ok(())
    }

    /// Controllers with a named set of gains; joints that the set does not have stay without.
    ///
    /// # Errors
    /// [`SimulateError::NoSet`] where no joint has a gain in it.
    pub fn set_control(&mut self, model: &Model, set: &str, control: Control) -> Result<(), SimulateError> {
        let mut found = false;
        for (id, drive) in model.joint_ids().zip(&mut self.drives) {
            let Some(gains) = model.gains(set, id) else { continue };
            found = true;
            drive.set_control(gains, control, model.torque_limit_nm(id));
        }
        if found { Ok(()) } else { Err(no_set(model, "gains", set)) }
    }

    /// Soft mechanical stops at the hardware limits (2.3.2); the thesis left them out.
    pub fn set_stops(&mut self, model: &Model, stiffness_nm_rad: f64, damping_nm_s_rad: f64) {
        for (joint, drive) in model.joints().iter().zip(&mut self.drives) {
            let Some([low, high]) = joint.hardware_rad else { continue };
            drive.stops = [(low, -1.0), (high, 1.0)]
                .map(|(angle_rad, side)| EndStop {
                    angle_rad,
                    side,
                    stiffness_nm_rad,
                    damping_nm_s_rad,
                    push: Push::Linear,
                })
                .to_vec();
        }
    }

    /// Puts an effect of the catalogue on a joint in one of its forms (an id alone: the default one), its values under the
    /// catalogue's names and in their order.
    ///
    /// # Errors
    /// [`SimulateError::Effect`] for values out of bounds, or too few of them; [`SimulateError::UnknownToRobots`] for a spring
    /// before the link or a late reading, which the trees do not have.
    pub fn add_effect(
        &mut self,
        model: &Model,
        joint: JointId,
        effect: impl Into<EffectForm>,
        named: &[f64],
    ) -> Result<(), SimulateError> {
        let form: EffectForm = effect.into();
        let effect = form.id;
        if !effect.is_known_to_robots() {
            let joint = model.joints()[joint.index()].name.clone();
            return Err(SimulateError::UnknownToRobots { joint, effect: effect.id() });
        }
        let parameters = form.named_parameters();
        let wrong = |parameter: &'static str, value: f64, allowed: String| SimulateError::Effect {
            joint: model.joints()[joint.index()].name.clone(),
            effect: effect.id(),
            parameter,
            value,
            allowed,
        };
        if named.len() != parameters.len() {
            return Err(wrong("the number of values", named.len() as f64, parameters.len().to_string()));
        }
        for (parameter, value) in parameters.iter().zip(named) {
            if !parameter.bounds.admit(*value) {
                return Err(wrong(parameter.name, *value, format!("{} {}", parameter.bounds, parameter.unit)));
            }
        }
        let drive = &mut self.drives[joint.index()];
        if effect == EffectId::AngleOffset {
            // On the tree gravity knows the true angle; it is encoder and controller that are off.
            drive.zero_rad = named[0];
            return Ok(());
        }
        let searched = form.searched(named, drive.chain.friction.coulomb_nm);
        form.apply(&searched, drive.chain.link.inertia_kg_m2, &mut drive.chain);
        if let Some(play) = &mut drive.chain.play {
            // The rotor's inertia is taken from the link's, which must be left with some even where others give way.
            play.motor_side_kg_m2 = play.motor_side_kg_m2.min(ROTOR_AT_MOST * drive.loose_kg_m2);
        }
        Ok(())
    }

    /// Puts the effects of the robot's file on its joints; friction and control come first, for effects build on them.
    ///
    /// # Errors
    /// As [`Joints::add_effect`]; [`SimulateError::Robot`] where the catalogue does not have such an effect.
    pub fn add_effects_of_file(&mut self, model: &Model) -> Result<(), SimulateError> {
        for (effect, joint, named) in model.effects()? {
            self.add_effect(model, joint, effect, &named)?;
        }
        Ok(())
    }

    /// A joint.
    pub fn drive(&self, joint: JointId) -> &JointDrive {
        &self.drives[joint.index()]
    }

    /// A joint, to be changed.
    pub fn drive_mut(&mut self, joint: JointId) -> &mut JointDrive {
        &mut self.drives[joint.index()]
    }

    /// Some of them, by rising places, as the joints of a model that has these alone.
    #[must_use]
    pub fn only(self, kept: &[JointId]) -> Self {
        let drives = self.drives.into_iter().enumerate();
        Self {
            drives: drives.filter(|(k, _)| kept.iter().any(|id| id.index() == *k)).map(|(_, drive)| drive).collect(),
        }
    }

    /// All joints in the model's order.
    pub fn drives(&self) -> &[JointDrive] {
        &self.drives
    }
}

fn no_set(model: &Model, kind: &'static str, name: &str) -> SimulateError {
    SimulateError::NoSet { robot: model.name().to_owned(), kind, name: name.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn soft_stops_push_back_beyond_the_hardware_limits_only() {
        let model = Model::ers7();
        let (bare, mut joints) = (Joints::passive(model), Joints::passive(model));
        joints.set_stops(model, 5.0, 0.02);
        assert!(joints.drives().iter().any(|drive| drive.stops.len() == 2));
        for id in model.joint_ids() {
            let Some([low, high]) = model.joints()[id.index()].hardware_rad else {
                assert!(joints.drive(id).stops.is_empty());
                continue;
            };
            let added_nm = |angle_rad: f64, rate_rad_s: f64| {
                joints.drive(id).elastic_nm(angle_rad, rate_rad_s) - bare.drive(id).elastic_nm(angle_rad, rate_rad_s)
            };
            assert_eq!([added_nm(low, -1.0), added_nm(high, 1.0)], [0.0, 0.0]);
            // 0.1 rad deep at 1 rad/s: 5 N m/rad and 0.02 N m s/rad.
            assert_abs_diff_eq!(added_nm(low - 0.1, -1.0), 0.52, epsilon = 1e-9);
            assert_abs_diff_eq!(added_nm(high + 0.1, 1.0), -0.52, epsilon = 1e-9);
        }
    }
}
