//! What a description is made of: links, joints, couplings, actuators.

use super::error::At;
use super::inertia::RigidInertia;
use super::shape::Shape;
use nalgebra::{Isometry3, Unit, Vector3};

/// A link of a [`Description`](super::Description), by its place among the links.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct LinkId(pub usize);

/// A joint of a [`Description`](super::Description), by its place among the joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct MoverId(pub usize);

/// A rigid body with its frame.
#[derive(Clone, Debug)]
pub struct Link {
    /// Its name, invented where the file gives none.
    pub name: String,
    /// Whether the file gives the name.
    pub is_named: bool,
    /// What carries it; `None`: the world.
    pub parent: Option<LinkId>,
    /// Its frame in the parent's, as drawn.
    pub pose: Isometry3<f64>,
    /// What moves it, in this order, each joint about its own place in the link's frame; none: fixed to the parent.
    pub joints: Vec<MoverId>,
    /// In its frame.
    pub inertia: RigidInertia,
    /// What of it collides, as far as its shape is read: meshes are not.
    pub colliders: Vec<Collider>,
}

/// A shape of a link that collides with a floor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collider {
    /// About its centre.
    pub shape: Shape,
    /// In the link's frame.
    pub pose: Isometry3<f64>,
    /// Coefficient of sliding friction; a URDF has none.
    pub friction: Option<f64>,
}

/// How a joint moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointKind {
    /// Turns.
    Revolute,
    /// Turns without end.
    Continuous,
    /// Slides.
    Prismatic,
}

impl JointKind {
    /// The word that URDF has for it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Revolute => "revolute",
            Self::Continuous => "continuous",
            Self::Prismatic => "prismatic",
        }
    }
}

/// A joint with one freedom; units are those of turning joints, sliding ones have m and N for rad and N m.
#[derive(Clone, Debug)]
pub struct Mover {
    /// Its name, invented where the file gives none.
    pub name: String,
    /// How it moves.
    pub kind: JointKind,
    /// What it moves.
    pub link: LinkId,
    /// In the link's frame.
    pub axis: Unit<Vector3<f64>>,
    /// A point of the axis in the link's frame \[m\].
    pub place_m: Vector3<f64>,
    /// Its position in the pose as drawn \[rad\].
    pub drawn_rad: f64,
    /// Least and greatest position \[rad\].
    pub limit_rad: Option<[f64; 2]>,
    /// Greatest torque of its motor, as URDF's `effort` \[N m\].
    pub effort_nm: Option<f64>,
    /// Greatest rate, as URDF's `velocity` \[rad/s\].
    pub rate_limit_rad_s: Option<f64>,
    /// What the sum of its actuators' torques is clamped to \[N m\].
    pub actuator_range_nm: Option<[f64; 2]>,
    /// Added to the inertia about the axis: the rotor behind its gear \[kg m^2\].
    pub armature_kg_m2: f64,
    /// Viscous friction \[N m s/rad\], then what goes with the square and the cube of the rate.
    pub damping: [f64; 3],
    /// Coulomb friction \[N m\].
    pub friction_nm: f64,
    /// Spring \[N m/rad\], then what goes with the square and the cube of the deflection.
    pub stiffness: [f64; 3],
    /// Where the spring is at rest \[rad\].
    pub spring_rest_rad: f64,
    /// Where the file has it.
    pub at: At,
}

impl Mover {
    /// That something goes from the first to the second position, by more than `slack` beyond where the description lets the
    /// joint go, in words; `None` where it does not.
    pub(crate) fn beyond_limits(&self, what: &str, [from, to]: [f64; 2], slack: f64) -> Option<String> {
        let [low, high] = self.limit_rad?;
        let unit = if self.kind == JointKind::Prismatic { "m" } else { "rad" };
        (from < low - slack || to > high + slack).then(|| {
            let (name, limits) = (&self.name, format!("but the description lets it go from {low:.2} to {high:.2}"));
            format!("{name}: {what} from {from:.2} to {to:.2} {unit}, {limits}")
        })
    }
}

/// A joint that follows another: its position is `offset + multiplier * leader`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupling {
    /// The joint that follows.
    pub follower: MoverId,
    /// The joint that it follows; may follow another itself.
    pub leader: MoverId,
    /// \[rad/rad\]
    pub multiplier: f64,
    /// \[rad\]
    pub offset_rad: f64,
}

/// What an actuator of MuJoCo is declared as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ActuatorKind {
    /// `motor`: a torque.
    Motor,
    /// `position`: a servo.
    Position,
    /// `velocity`: a servo.
    Velocity,
    /// `general`: gain and bias as written.
    General,
}

/// A motor on a joint: torque = gear clamp(gain ctrl + b0 + b1 gear q + b2 gear q', force range).
#[derive(Clone, Debug)]
pub struct Actuator {
    /// Its name, empty where the file gives none.
    pub name: String,
    /// As it is declared.
    pub kind: ActuatorKind,
    /// What it drives.
    pub joint: MoverId,
    /// May be negative.
    pub gear: f64,
    /// On the control value.
    pub gain: f64,
    /// Constant, on the position, on the rate.
    pub bias: [f64; 3],
    /// The rate's bias as a share of critical damping, which takes the place of the number above; see
    /// [`Tree::servos`](crate::robot::tree::Tree::servos).
    pub damping_ratio: Option<f64>,
    /// What clamps the control value.
    pub control_range: Option<[f64; 2]>,
    /// What clamps the force before the gear \[N m\].
    pub force_range_nm: Option<[f64; 2]>,
    /// Whether a filter or another state lies between control and force, by MuJoCo's word for it.
    pub activation: Option<String>,
}

impl Actuator {
    /// The same as a position servo on the joint itself, `torque = kp (ctrl - q) - kd q'`, its controls the joint's positions;
    /// `None` where it holds no position.
    pub fn as_servo(&self) -> Option<Self> {
        let holds = match self.kind {
            ActuatorKind::Position => true,
            ActuatorKind::General => self.activation.is_none() && self.gain != 0.0 && self.bias[1] < 0.0,
            ActuatorKind::Motor | ActuatorKind::Velocity => false,
        };
        if !holds {
            return None;
        }
        let (gear, [constant, position, rate]) = (self.gear, self.bias);
        let kp = -gear * gear * position;
        let held = |control: f64| (self.gain / -position * control + constant / -position) / gear;
        Some(Self {
            kind: ActuatorKind::Position,
            gear: 1.0,
            gain: kp,
            bias: [0.0, -kp, gear * gear * rate],
            // A servo without gain holds nothing that could be limited.
            control_range: self.control_range.filter(|_| kp > 0.0).map(|ends| sorted(ends.map(held))),
            force_range_nm: self.force_range_nm.map(|ends| sorted(ends.map(|end| gear * end))),
            ..self.clone()
        })
    }

    /// What its torque is limited to at the joint \[N m\], by its force's range or, where it is no servo, its control's.
    pub(super) fn torque_range_nm(&self) -> Option<[f64; 2]> {
        let is_torque = self.bias == [0.0; 3] && self.activation.is_none();
        let of_control = self.control_range.filter(|_| is_torque).map(|ends| ends.map(|end| self.gain * end));
        let at_joint = |ends: [f64; 2]| sorted(ends.map(|end| self.gear * end));
        let ranges = [of_control, self.force_range_nm].into_iter().flatten().map(at_joint);
        ranges.reduce(|[low, high], [other_low, other_high]| [low.max(other_low), high.min(other_high)])
    }
}

/// The smaller end first.
fn sorted([a, b]: [f64; 2]) -> [f64; 2] {
    [a.min(b), a.max(b)]
}

/// A free joint that the file itself has.
#[derive(Clone, Debug)]
pub struct FreeJoint {
    /// Its name, empty where the file gives none.
    pub name: String,
    /// What it sets free.
    pub link: LinkId,
    /// Added to all six freedoms \[kg, kg m^2\].
    pub armature: f64,
}
