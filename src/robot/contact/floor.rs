//! The floor under a robot.

use super::Resting;
use super::law::Contact;
use crate::number::math;
use crate::robot::{BodyId, BodyMotion, ContactDamping, Force, Model, RobotError, Touch};
use nalgebra::{Unit, Vector3};

/// A slope beyond this is a wall \[rad\].
pub(crate) const STEEPEST_RAD: f64 = 1.2;

/// Parameters of the floor (eqs 2.3-2.6); the keys of a study's `[floor]` stand behind the dashes.
///
/// The default is the floor of the reference walk: the thesis shows its own only in figures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FloorParameters {
    /// `K_p` - `stiffness` \[N/m^n\].
    pub stiffness_n_m: f64,
    /// `K_d` - `damping` \[N s/m^(n+1)\].
    pub damping_n_s_m2: f64,
    /// `n` - `exponent`, 1 or above: below 1 the force would set in with an infinite slope.
    pub exponent: f64,
    /// `mu_st` - `static`; 0: no Stribeck part.
    pub static_friction: f64,
    /// `mu_c` - `coulomb`.
    pub coulomb: f64,
    /// `mu_v` - `viscous` \[s/m\].
    pub viscous_s_m: f64,
    /// `s` - `steepness` \[s/m\].
    pub steepness_s_m: f64,
    /// `v_st` - `stribeck_speed` \[m/s\]; 0: no Stribeck part.
    pub stribeck_speed_m_s: f64,
    /// Radius at which torsional friction (2.6) acts \[m\]; 0: none.
    pub torsion_radius_m: f64,
    /// A point that has slid slower than `1 / steepness` for so long rests: friction holds it until it would have to bear
    /// more than `mu_st F_n` - `dwell` \[s\]; infinite: (2.4) alone, which creeps under any load.
    pub dwell_s: f64,
    /// Upward normal of the floor, world axes; need not have length 1.
    pub normal: Vector3<f64>,
    /// A point of the floor's plane, in the world \[m\].
    pub through_m: Vector3<f64>,
}

impl Default for FloorParameters {
    fn default() -> Self {
        Self {
            stiffness_n_m: 2e4,
            damping_n_s_m2: 4e5,
            exponent: 1.0,
            static_friction: 0.7,
            coulomb: 0.6,
            viscous_s_m: 0.0,
            steepness_s_m: 300.0,
            stribeck_speed_m_s: 0.05,
            torsion_radius_m: 0.0,
            dwell_s: 1.0,
            normal: Vector3::y(),
            through_m: Vector3::zeros(),
        }
    }
}

impl FloorParameters {
    /// The same floor tilted: it rises by `forward_rad` towards the front (-z) and by `right_rad` towards the right.
    #[must_use]
    pub fn sloped(self, forward_rad: f64, right_rad: f64) -> Self {
        Self { normal: Vector3::new(-math::tan(right_rad), 1.0, math::tan(forward_rad)), ..self }
    }

    /// Every number in its range; the first that is not is named.
    fn check(&self) -> Result<(), RobotError> {
        let not_negative = "a number not below 0";
        let rows = [
            ("stiffness", self.stiffness_n_m, self.stiffness_n_m > 0.0, "a number above 0 N/m"),
            ("damping", self.damping_n_s_m2, self.damping_n_s_m2 >= 0.0, not_negative),
            ("exponent", self.exponent, (1.0..=5.0).contains(&self.exponent), "a number from 1 to 5"),
            ("static", self.static_friction, self.static_friction >= 0.0, not_negative),
            ("coulomb", self.coulomb, self.coulomb >= 0.0, not_negative),
            ("viscous", self.viscous_s_m, self.viscous_s_m >= 0.0, not_negative),
            ("steepness", self.steepness_s_m, self.steepness_s_m > 0.0, "a number above 0 s/m"),
            ("stribeck_speed", self.stribeck_speed_m_s, self.stribeck_speed_m_s >= 0.0, not_negative),
            ("torsion_radius", self.torsion_radius_m, self.torsion_radius_m >= 0.0, not_negative),
            (
                "dwell",
                if self.dwell_s == f64::INFINITY { 0.0 } else { self.dwell_s },
                self.dwell_s >= 0.0,
                not_negative,
            ),
        ];
        for (what, value, is_right, allowed) in rows {
            if !(value.is_finite() && is_right) {
                return Err(RobotError::Floor { what, value, allowed });
            }
        }
        let tilt_rad = self.normal.angle(&Vector3::y());
        let is_plane = self.normal.iter().all(|x| x.is_finite()) && self.normal.norm() > 0.0;
        if !(is_plane && tilt_rad <= STEEPEST_RAD) {
            let allowed = "a normal within 1.2 rad of the vertical";
            return Err(RobotError::Floor { what: "slope", value: tilt_rad, allowed });
        }
        match self.through_m.iter().find(|x| !x.is_finite()) {
            Some(&value) => Err(RobotError::Floor { what: "place", value, allowed: "finite numbers" }),
            None => Ok(()),
        }
    }
}

/// Which parts of a robot touch the floor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Touching {
    /// Feet: of the ERS-7 the lower legs, as in the reference walk.
    Marked,
    /// Whatever has a shape and a mass, too: a robot that falls lies on its trunk.
    All,
}

/// A part that may touch.
#[derive(Clone, Copy, Debug)]
struct Part {
    body: BodyId,
    touch: Touch,
}

/// A floor under a robot.
///
/// ```
/// use aibo_fit::robot::{Dynamics, Floor, FloorParameters, Model, Resting, State, Touching};
/// let robot = Model::ers7();
/// let floor = Floor::new(FloorParameters::default(), robot, Touching::Marked)?;
/// let mut dynamics = Dynamics::new(robot);
/// let mut state = State::at_rest(robot);
/// state.base_position_m.y = floor.height_on_m(&mut dynamics, &state) - 2e-4;
/// let (mut forces, mut damping) = (Vec::with_capacity(floor.parts()), Vec::with_capacity(floor.parts()));
/// floor.forces(dynamics.motions(&state), &Resting::none(), &mut forces, &mut damping);
/// assert!(!forces.is_empty() && forces.iter().all(|force| force.force_n.y > 0.0));
/// # Ok::<(), aibo_fit::robot::RobotError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Floor {
    parameters: FloorParameters,
    normal: Unit<Vector3<f64>>,
    parts: Vec<Part>,
}

impl Floor {
    /// A floor under a robot.
    ///
    /// # Errors
    /// [`RobotError::Floor`] names the parameter that no floor has; [`RobotError::NotSimulated`] where nothing would touch it.
    pub fn new(parameters: FloorParameters, model: &Model, touching: Touching) -> Result<Self, RobotError> {
        parameters.check()?;
        let of_body = |body: BodyId| {
            let part = &model.bodies()[body.index()];
            let may_lie = touching == Touching::All && part.mass_kg > 0.0;
            let touches = part.touches.iter().filter(move |touch| touch.is_foot || may_lie);
            touches.map(move |touch| Part { body, touch: *touch })
        };
        let parts: Vec<Part> = model.body_ids().flat_map(of_body).collect();
        if parts.is_empty() {
            let what = "nothing of it touches a floor: no contact_mm in a file of our own, and no sphere, capsule, cylinder, \
                        ellipsoid or box that collides at the end of a chain (meshes are not read); of a URDF or MJCF say \
                        which links are its feet, with their radius";
            return Err(RobotError::NotSimulated { robot: model.name().to_owned(), what: what.to_owned() });
        }
        Ok(Self { normal: Unit::new_normalize(parameters.normal), parameters, parts })
    }

    /// Its parameters.
    pub fn parameters(&self) -> &FloorParameters {
        &self.parameters
    }

    /// Its upward normal, world axes.
    pub fn normal(&self) -> Unit<Vector3<f64>> {
        self.normal
    }

    /// How many parts may touch: what the lists of [`Floor::forces`] have to hold.
    pub fn parts(&self) -> usize {
        self.parts.len()
    }

    /// The parts that may touch.
    pub fn bodies(&self) -> impl Iterator<Item = BodyId> + '_ {
        self.parts.iter().map(|part| part.body)
    }

    /// Depth of a point below the floor's plane \[m\]; negative above it.
    pub fn depth_m(&self, point_m: &Vector3<f64>) -> f64 {
        (self.parameters.through_m - point_m).dot(&self.normal)
    }

    /// Lowest point of every part that may touch, in the world \[m\], with its part.
    pub fn lowest_points<'a>(&'a self, motions: &'a [BodyMotion]) -> impl Iterator<Item = (BodyId, Vector3<f64>)> + 'a {
        self.parts.iter().map(move |part| {
            let motion = &motions[part.body.index()];
            (part.body, motion.position_m + self.to_lowest(part, motion))
        })
    }

    /// Every contact, with its part, its point in the world \[m\] and the velocity of the body there \[m/s\].
    pub fn contacts<'a>(
        &'a self,
        motions: &'a [BodyMotion],
        resting: &'a Resting,
    ) -> impl Iterator<Item = (BodyId, Vector3<f64>, Vector3<f64>, Contact)> + 'a {
        let held = move |(k, part): (usize, &'a Part)| {
            let (at, velocity, contact) = self.contact_of(part, motions, resting.is_held(k))?;
            Some((part.body, at, velocity, contact))
        };
        self.parts.iter().enumerate().filter_map(held)
    }

    /// Point, its velocity and contact of a part, where it touches.
    fn contact_of(
        &self,
        part: &Part,
        motions: &[BodyMotion],
        is_held: bool,
    ) -> Option<(Vector3<f64>, Vector3<f64>, Contact)> {
        let motion = &motions[part.body.index()];
        let arm = self.to_lowest(part, motion);
        let (at, velocity) = (motion.position_m + arm, motion.velocity_m_s + motion.rate_rad_s.cross(&arm));
        let depth_m = self.depth_m(&at);
        let contact = self.parameters.contact_of(depth_m, &self.normal, &velocity, &motion.rate_rad_s, is_held)?;
        Some((at, velocity, contact))
    }

    /// Takes notice of which points rest, at the begin of a step; `resting` is the run's.
    pub fn notice(&self, t_s: f64, motions: &[BodyMotion], resting: &mut Resting) {
        let p = &self.parameters;
        for (k, part) in self.parts.iter().enumerate() {
            let contact = self.contact_of(part, motions, resting.is_held(k));
            let Some((_, velocity, contact)) = contact.filter(|(_, _, contact)| contact.normal_n > 0.0) else {
                resting.lift(k);
                continue;
            };
            let borne_n = (contact.force_n - self.normal.into_inner() * contact.normal_n).norm();
            let bears = borne_n <= p.breakaway() * contact.normal_n && p.breakaway() > 0.0;
            let speed_m_s = (velocity - self.normal.into_inner() * velocity.dot(&self.normal)).norm();
            resting.touch(k, t_s, bears && speed_m_s * p.steepness_s_m < 1.0, p.dwell_s);
        }
    }

    /// Forces of the floor on the robot, and what an implicit step needs of them; both lists are emptied first and
    /// grow to [`Floor::parts`] at most. Friction is (2.4) wherever no point rests.
    ///
    /// # Panics
    /// Where `motions` are not those of the model.
    pub fn forces(
        &self,
        motions: &[BodyMotion],
        resting: &Resting,
        forces: &mut Vec<Force>,
        damping: &mut Vec<ContactDamping>,
    ) {
        forces.clear();
        damping.clear();
        for (body, at_m, velocity_m_s, contact) in self.contacts(motions, resting) {
            forces.push(Force { body, at_m, force_n: contact.force_n, moment_nm: contact.moment_nm });
            damping.push(ContactDamping {
                body,
                at_m,
                velocity_m_s,
                damping_n_s_m: contact.implicit_damping_n_s_m,
                stiffness_n_m: contact.implicit_stiffness_n_m,
                spin_damping_nm_s_rad: contact.spin_damping_nm_s_rad,
            });
        }
    }

    /// Height of the base's centre (y) at which the lowest point just touches, all else as in the state \[m\].
    ///
    /// # Panics
    /// Where the state is not the model's.
    pub fn height_on_m(&self, dynamics: &mut crate::robot::Dynamics<'_>, state: &crate::robot::State) -> f64 {
        let motions = dynamics.motions(state);
        let deepest = self.lowest_points(motions).map(|(_, point)| self.depth_m(&point));
        let depth_m = deepest.fold(f64::NEG_INFINITY, f64::max);
        state.base_position_m.y + if depth_m.is_finite() { depth_m / self.normal.y } else { 0.0 }
    }

    /// From a body's origin to the lowest point of what it touches with, world axes \[m\].
    fn to_lowest(&self, part: &Part, motion: &BodyMotion) -> Vector3<f64> {
        motion.rotation * part.touch.lowest_m(&motion.rotation.tr_mul(&self.normal))
    }
}
