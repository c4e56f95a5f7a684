//! The robot as an immutable problem.

mod body;
mod frame;
mod of_description;
mod of_file;
mod plan;
mod schedule;
mod standing;
#[cfg(test)]
mod tests;
mod touch;

pub use body::{Attached, Body};
pub(super) use frame::Turning;
pub(super) use plan::{BasePlan, Group, Parent, Plan, Shape};
pub use touch::Touch;

use super::description::{Description, Format};
use super::{Dynamics, RobotError, State};
use crate::geometry::Joint;
use crate::geometry::robot_file::{Base, ERS7_TOML, EncoderData, JointFriction, RobotTables, SensorRange, row_of};
use crate::joint::gain;
use crate::log::Derivative;
use nalgebra::Vector3;
use std::path::Path;
use std::sync::OnceLock;

/// A joint of a [`Model`], by its place in the joint order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct JointId(usize);

impl JointId {
    pub(super) fn of(index: usize) -> Self {
        Self(index)
    }

    /// Place in the joint order, in `angle_rad` and the like.
    pub fn index(self) -> usize {
        self.0
    }

    /// The body that it moves.
    pub fn child(self) -> BodyId {
        BodyId(self.0 + 1)
    }
}

/// A body of a [`Model`]: 0 is the base, then the joints' children in joint order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BodyId(usize);

impl BodyId {
    /// The base.
    pub const BASE: BodyId = BodyId(0);

    /// Place in the body order.
    pub fn index(self) -> usize {
        self.0
    }

    /// The joint that moves it; `None` for the base.
    pub fn joint(self) -> Option<JointId> {
        self.0.checked_sub(1).map(JointId)
    }
}

/// Entries of the generalised velocity that belong to the base.
pub(super) const BASE_FREEDOMS: usize = 6;

/// Gains of a controller, P, I and D \[N m/rad, N m/(rad s), N m s/rad\], from (2.7).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PidGains {
    /// \[N m/rad\]
    pub kp_nm_rad: f64,
    /// \[N m/(rad s)\]
    pub ki_nm_rad_s: f64,
    /// \[N m s/rad\]
    pub kd_nm_s_rad: f64,
}

/// A robot: a tree of rigid bodies on revolute joints, with what its makers or its measurements say of it.
///
/// ```
/// use aibo_fit::robot::Model;
/// let robot = Model::ers7();
/// assert_eq!((robot.bodies().len(), robot.joints().len()), (23, 22)); // 19 parts and 4 massless ghosts
/// ```
#[derive(Clone, Debug)]
pub struct Model {
    tables: RobotTables,
    bodies: Vec<Body>,
    /// Body that carries each joint.
    carrier: Vec<BodyId>,
    /// Of the joints' rotors behind their gears, about the joints' axes \[kg m^2\].
    armature_kg_m2: Vec<f64>,
    turning: Vec<Turning>,
    plan: Plan,
    /// What the derivative of its controllers acts on.
    derivative: Derivative,
    /// Of the joints' motors, where the file has them \[N m\].
    torque_limit_nm: Vec<Option<f64>>,
    /// Joints that follow others.
    following: Vec<Following>,
}

/// A joint that follows another rigidly, by places in the model's order: its angle is `offset_rad + multiplier * leader`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Following {
    /// The joint that follows.
    pub follower: usize,
    /// The joint that it follows, which follows none itself.
    pub leader: usize,
    /// \[rad/rad\]
    pub multiplier: f64,
    /// \[rad\]
    pub offset_rad: f64,
}

impl Model {
    /// The ERS-7 of the thesis's tables, embedded from `data/ers7.toml`.
    pub fn ers7() -> &'static Model {
        static MODEL: OnceLock<Model> = OnceLock::new();
        MODEL.get_or_init(|| {
            Model::from_toml(Path::new("data/ers7.toml"), ERS7_TOML).expect("data/ers7.toml is compiled in and tested")
        })
    }

    /// Reads a robot file: the format of `data/ers7.toml`, or URDF or MJCF, told by its content.
    ///
    /// # Errors
    /// [`RobotError::File`] with file, line and key; [`RobotError::NoInertia`]; as [`Model::of_description`].
    pub fn read(file: &Path) -> Result<Self, RobotError> {
        match Format::of_file(file)? {
            Format::Toml => Self::new(RobotTables::read(file)?),
            Format::Urdf | Format::Mjcf => Self::of_description(&Description::read(file)?),
        }
    }

    /// Reads a robot file that is at hand; `file` is its name in errors.
    ///
    /// # Errors
    /// As [`Model::read`].
    pub fn from_toml(file: &Path, text: &str) -> Result<Self, RobotError> {
        Self::new(RobotTables::from_toml(file, text)?)
    }

    /// The model of checked tables.
    ///
    /// # Errors
    /// [`RobotError::NoInertia`]; [`RobotError::NoBody`] and [`RobotError::Order`] where tables that were not read from a
    /// file are no tree.
    pub fn new(tables: RobotTables) -> Result<Self, RobotError> {
        let names: Vec<&String> = std::iter::once(&tables.root).chain(tables.joints.iter().map(|j| &j.child)).collect();
        let place = |name: &String| {
            names.iter().position(|other| *other == name).ok_or_else(|| RobotError::NoBody {
                robot: tables.name.clone(),
                name: name.clone(),
                bodies: names.iter().map(|&name| name.clone()).collect(),
            })
        };
        let carrier: Vec<BodyId> =
            tables.joints.iter().map(|j| place(&j.parent).map(BodyId)).collect::<Result<_, _>>()?;
        for (j, (joint, above)) in tables.joints.iter().zip(&carrier).enumerate() {
            if *above > BodyId(j) {
                return Err(RobotError::Order { joint: joint.name.clone(), parent: joint.parent.clone() });
            }
        }
        let mut bodies = Vec::with_capacity(names.len());
        for &name in &names {
            let part = tables.parts.iter().find(|part| part.name == *name);
            let part = part.ok_or_else(|| RobotError::NoBody {
                robot: tables.name.clone(),
                name: name.clone(),
                bodies: tables.parts.iter().map(|part| part.name.clone()).collect(),
            })?;
            let mut body = Body::of_part(part);
            for extra in tables.attached.iter().filter(|extra| extra.part == *name) {
                body.attach(Attached::point(extra.mass_kg, extra.at_m))?;
            }
            bodies.push(body);
        }
        let armature = vec![0.0; tables.joints.len()];
        let model = Self::assemble(tables, bodies, carrier, armature)?;
        model.effects()?;
        Ok(model)
    }

    fn assemble(
        tables: RobotTables,
        bodies: Vec<Body>,
        carrier: Vec<BodyId>,
        armature_kg_m2: Vec<f64>,
    ) -> Result<Self, RobotError> {
        let turning = tables.joints.iter().map(Turning::of).collect();
        let plan = Plan::of(&tables.joints, &carrier, &bodies, &armature_kg_m2);
        let torque_limit_nm = vec![None; tables.joints.len()];
        let derivative = Derivative::Error;
        let following = Vec::new();
        let model =
            Self { tables, bodies, carrier, armature_kg_m2, turning, plan, derivative, torque_limit_nm, following };
        model.check_inertia()?;
        Ok(model)
    }

    /// The same robot with other bodies.
    fn remade(&self, bodies: Vec<Body>) -> Result<Self, RobotError> {
        let made = Self::assemble(self.tables.clone(), bodies, self.carrier.clone(), self.armature_kg_m2.clone())?;
        let (torque_limit_nm, following) = (self.torque_limit_nm.clone(), self.following.clone());
        Ok(Self { derivative: self.derivative, torque_limit_nm, following, ..made })
    }

    /// Every joint has to move something.
    fn check_inertia(&self) -> Result<(), RobotError> {
        let n = BASE_FREEDOMS + self.joints().len();
        let mut matrix = nalgebra::DMatrix::zeros(n, n);
        Dynamics::new(self).mass_matrix(&State::at_rest(self), &mut matrix);
        for (k, joint) in self.joints().iter().enumerate() {
            let inertia_kg_m2 = matrix[(BASE_FREEDOMS + k, BASE_FREEDOMS + k)];
            if !(inertia_kg_m2 > f64::MIN_POSITIVE) {
                return Err(RobotError::NoInertia { joint: joint.name.clone(), inertia_kg_m2 });
            }
        }
        Ok(())
    }

    /// The same robot with another mass of one part; its inertia grows with its mass.
    ///
    /// What is fixed to the body stays as it is.
    ///
    /// # Errors
    /// [`RobotError::Value`] for a mass below 0, [`RobotError::NoInertia`].
    pub fn with_mass(&self, body: BodyId, mass_kg: f64) -> Result<Self, RobotError> {
        let mut bodies = self.bodies.clone();
        bodies[body.0].set_mass(mass_kg)?;
        self.remade(bodies)
    }

    /// The same robot with something fixed to a body.
    ///
    /// # Errors
    /// [`RobotError::Value`] for a mass below 0 or an inertia that nothing has.
    pub fn with_attached(&self, body: BodyId, extra: Attached) -> Result<Self, RobotError> {
        let mut bodies = self.bodies.clone();
        bodies[body.0].attach(extra)?;
        self.remade(bodies)
    }

    /// The same robot with a point mass on a body, at a place in the body's frame.
    ///
    /// # Errors
    /// As [`Model::with_attached`].
    pub fn with_point_mass(&self, body: BodyId, mass_kg: f64, at_m: Vector3<f64>) -> Result<Self, RobotError> {
        self.with_attached(body, Attached::point(mass_kg, at_m))
    }

    /// The same robot held in another way.
    #[must_use]
    pub fn with_base(&self, base: Base) -> Self {
        let mut model = self.clone();
        model.tables.base = base;
        model
    }

    /// The same robot under another gravity, in world axes.
    #[must_use]
    pub fn with_gravity(&self, gravity_m_s2: Vector3<f64>) -> Self {
        let mut model = self.clone();
        model.tables.gravity_m_s2 = gravity_m_s2;
        model
    }

    /// The base with the limb that a joint is on, and nothing else: on a clamped base it moves as on the whole robot, and
    /// is computed several times as fast.
    ///
    /// # Errors
    /// None for a model that was made; those of [`Model::new`] otherwise.
    pub fn limb(&self, joint: JointId) -> Result<Self, RobotError> {
        self.limbs(&[joint]).map(|(limb, _)| limb)
    }

    /// The same with the limbs of several joints, and which of the robot's joints these have, rising.
    ///
    /// # Errors
    /// As [`Model::limb`].
    pub fn limbs(&self, joints: &[JointId]) -> Result<(Self, Vec<JointId>), RobotError> {
        let first = |mut id: usize| {
            while let Some(above) = self.carrier[id].joint() {
                id = above.index();
            }
            id
        };
        let limbs: Vec<usize> = joints.iter().map(|joint| first(joint.0)).collect();
        let kept: Vec<usize> = (0..self.tables.joints.len()).filter(|id| limbs.contains(&first(*id))).collect();
        let place =
            |body: BodyId| body.joint().and_then(|above| kept.binary_search(&above.0).ok()).map_or(0, |k| k + 1);
        let mut tables = self.tables.clone();
        tables.joints = kept.iter().map(|id| self.tables.joints[*id].clone()).collect();
        let bodies =
            std::iter::once(0).chain(kept.iter().map(|id| id + 1)).map(|body| self.bodies[body].clone()).collect();
        let carrier = kept.iter().map(|id| BodyId(place(self.carrier[*id]))).collect();
        let armature = kept.iter().map(|id| self.armature_kg_m2[*id]).collect();
        let torque_limit_nm = kept.iter().map(|id| self.torque_limit_nm[*id]).collect();
        let made = Self::assemble(tables, bodies, carrier, armature)?;
        let at = |joint: usize| kept.binary_search(&joint).ok();
        let among = |one: &Following| Some(Following { follower: at(one.follower)?, leader: at(one.leader)?, ..*one });
        let following = self.following.iter().filter_map(among).collect();
        let made = Self { derivative: self.derivative, torque_limit_nm, following, ..made };
        Ok((made, kept.into_iter().map(JointId).collect()))
    }

    /// Joints that follow others rigidly.
    pub fn following(&self) -> &[Following] {
        &self.following
    }

    /// Puts joints that follow others where they have to be.
    pub fn follow(&self, state: &mut State) {
        for one in &self.following {
            state.angle_rad[one.follower] = one.offset_rad + one.multiplier * state.angle_rad[one.leader];
            state.rate_rad_s[one.follower] = one.multiplier * state.rate_rad_s[one.leader];
        }
    }

    /// The robot's name.
    pub fn name(&self) -> &str {
        &self.tables.name
    }

    /// How its base is held.
    pub fn base(&self) -> Base {
        self.tables.base
    }

    /// Gravity in world axes \[m/s^2\].
    pub fn gravity_m_s2(&self) -> Vector3<f64> {
        self.tables.gravity_m_s2
    }

    /// Inertia of the joints' rotors behind their gears, about the axes, in joint order \[kg m^2\]; our own format has
    /// none.
    pub fn armature_kg_m2(&self) -> &[f64] {
        &self.armature_kg_m2
    }

    /// Bodies: the base, then the joints' children in joint order.
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// Joints in the file's order: places, axes, limits, springs (Tables A.1, A.3).
    pub fn joints(&self) -> &[Joint] {
        &self.tables.joints
    }

    /// The bodies' ids.
    pub fn body_ids(&self) -> impl Iterator<Item = BodyId> + use<> {
        (0..self.bodies.len()).map(BodyId)
    }

    /// The joints' ids.
    pub fn joint_ids(&self) -> impl Iterator<Item = JointId> + use<> {
        (0..self.tables.joints.len()).map(JointId)
    }

    /// A body by name.
    ///
    /// # Errors
    /// [`RobotError::NoBody`] with the names that there are.
    pub fn body(&self, name: &str) -> Result<BodyId, RobotError> {
        let found = self.bodies.iter().position(|body| body.name == name);
        found.map(BodyId).ok_or_else(|| RobotError::NoBody {
            robot: self.name().to_owned(),
            name: name.to_owned(),
            bodies: self.bodies.iter().map(|body| body.name.clone()).collect(),
        })
    }

    /// A joint by name.
    ///
    /// # Errors
    /// [`RobotError::NoJoint`] with the names that there are.
    pub fn joint(&self, name: &str) -> Result<JointId, RobotError> {
        let found = self.joints().iter().position(|joint| joint.name == name);
        found.map(JointId).ok_or_else(|| RobotError::NoJoint {
            robot: self.name().to_owned(),
            name: name.to_owned(),
            joints: self.joints().iter().map(|joint| joint.name.clone()).collect(),
        })
    }

    /// The body that carries a joint.
    pub fn carrier(&self, joint: JointId) -> BodyId {
        self.carrier[joint.0]
    }

    /// Mass of everything \[kg\].
    pub fn total_mass_kg(&self) -> f64 {
        self.bodies.iter().map(|body| body.mass_kg).sum()
    }

    /// Friction of a joint in a named set (Tables 3.3, 3.4); `None` where there is no such set, no friction where the
    /// set does not have the joint.
    pub fn friction(&self, set: &str, joint: JointId) -> Option<JointFriction> {
        let set = self.tables.friction_set(set)?;
        Some(row_of(&set.by_joint, &self.joints()[joint.0]).copied().unwrap_or_default())
    }

    /// Gains of a joint in a named set (Table B.2, eq. 2.7); `None` where there is no such set or the joint has no
    /// controller.
    pub fn gains(&self, set: &str, joint: JointId) -> Option<PidGains> {
        let set = self.tables.gains.iter().find(|other| other.name == set)?;
        if let Some(&[kp_nm_rad, ki_nm_rad_s, kd_nm_s_rad]) = row_of(&set.si, &self.joints()[joint.0]) {
            return Some(PidGains { kp_nm_rad, ki_nm_rad_s, kd_nm_s_rad });
        }
        let g = row_of(&set.by_joint, &self.joints()[joint.0])?;
        let [kp_nm_rad, ki_nm_rad_s, kd_nm_s_rad] = [0, 1, 2].map(|k| gain(g[k], set.shift[k]));
        Some(PidGains { kp_nm_rad, ki_nm_rad_s, kd_nm_s_rad })
    }

    /// What the derivative of its controllers acts on: the error in our own format (2.7), the rate in others.
    pub fn derivative(&self) -> Derivative {
        self.derivative
    }

    /// Largest torque of a joint's motor \[N m\]; our own format has none.
    pub fn torque_limit_nm(&self, joint: JointId) -> Option<f64> {
        self.torque_limit_nm[joint.0]
    }

    /// The position sensors (section B.1).
    pub fn encoder(&self) -> Option<EncoderData> {
        self.tables.encoder
    }

    /// Other sensors (Table B.1).
    pub fn sensors(&self) -> &[SensorRange] {
        &self.tables.sensors
    }

    pub(super) fn turning(&self) -> &[Turning] {
        &self.turning
    }

    pub(super) fn plan(&self) -> &Plan {
        &self.plan
    }
}
