//! A leg of the ERS-7 as the link of an experiment: bodies with known places, an extra mass with a direction of its own.

use super::experiment::{Body, Load};
use super::model::BodyMass;
use crate::geometry::{
    BodyLump, Ers7Tables, GeometryError, Leg, LegJoint, LegPose, LinkBody, LumpedLink, Mounted, level_gravity, lump,
};
use crate::log::{ExtraMass, Nominal, Pose};
use crate::number::math;
use nalgebra::Vector3;

/// Which joint swings, and how the rest of the leg is held.
#[derive(Clone, Debug, PartialEq)]
pub struct LegCase {
    /// The leg that swings.
    pub leg: Leg,
    /// The joint that is let go.
    pub joint: LegJoint,
    /// Angles of the leg's other joints.
    pub held: LegPose,
    /// Gravity in trunk axes \[m/s^2\].
    pub gravity_trunk_m_s2: Vector3<f64>,
    /// Knee axis to the extra mass's centre \[m\], where the pose states it.
    pub mount_m: Option<f64>,
    /// False where no pose is known and the leg is taken to be straight under a level trunk.
    pub pose_known: bool,
}

impl LegCase {
    /// The case for a joint, with the pose that stands beside the log where there is one.
    ///
    /// # Errors
    /// [`GeometryError::NotALeg`] for a leg that the robot does not have.
    pub fn new(joint: LegJoint, pose: Option<&Pose>, gravity_m_s2: f64) -> Result<Self, GeometryError> {
        let Some(pose) = pose else {
            return Ok(Self {
                leg: Leg::RF,
                joint,
                held: LegPose::STRAIGHT,
                gravity_trunk_m_s2: level_gravity(gravity_m_s2),
                mount_m: None,
                pose_known: false,
            });
        };
        let leg: Leg = pose.leg.parse()?;
        let mut held = LegPose::STRAIGHT;
        for other in LegJoint::ALL {
            if let Some(&angle_rad) = pose.held_rad.get(&crate::geometry::joint_name(leg, other)) {
                held = held.with(other, angle_rad);
            }
        }
        let gravity_trunk_m_s2 = Vector3::from(pose.gravity_m_s2);
        Ok(Self { leg, joint, held, gravity_trunk_m_s2, mount_m: pose.mount_m, pose_known: true })
    }

    /// The bare leg about the joint, by the thesis's tables.
    ///
    /// # Errors
    /// As [`lump()`].
    pub fn bare(&self) -> Result<LumpedLink, GeometryError> {
        lump(Ers7Tables::embedded(), self.leg, self.joint, &self.held, self.gravity_trunk_m_s2, None)
    }

    /// The nominal model of the bare leg: Tables A.1, A.2 and 3.3.
    ///
    /// # Errors
    /// As [`lump()`].
    pub fn nominal(&self) -> Result<Nominal, GeometryError> {
        let bare = self.bare()?;
        let (coulomb_nm, viscous_nm_s_rad) = Ers7Tables::embedded().friction.estimated.of(self.joint);
        Ok(Nominal { inertia_kg_m2: bare.inertia_kg_m2, moment_kg_m: bare.moment_kg_m, coulomb_nm, viscous_nm_s_rad })
    }

    /// The bodies that swing, per kilogram.
    ///
    /// # Errors
    /// As [`lump()`].
    pub fn bodies(&self) -> Result<Vec<Body>, GeometryError> {
        Ok(self.bare()?.bodies.iter().map(body).collect())
    }

    /// The bodies' masses as parameters: the thesis frees one for each joint (3.3.1), the first of those that swing.
    ///
    /// # Errors
    /// As [`lump()`].
    pub fn masses(&self) -> Result<Vec<BodyMass>, GeometryError> {
        let parameter = |(i, b): (usize, &BodyLump)| BodyMass {
            body: b.body,
            symbol: symbol(b.body).into(),
            nominal_kg: b.mass_kg,
            free: i == 0,
        };
        Ok(self.bare()?.bodies.iter().enumerate().map(parameter).collect())
    }

    /// Where on the lower leg an extra mass sits.
    ///
    /// # Errors
    /// As [`LegCase::load`].
    pub fn mounted(&self, extra: &ExtraMass) -> Result<Mounted, GeometryError> {
        let mut mounted = Mounted::at_distance(Ers7Tables::embedded(), self.leg, self.joint, &self.held, extra)?;
        // Of two statements of one length the pose's is the direct one; a sidecar's distance is rounded.
        if let Some(mount_m) = self.mount_m.filter(|m| (m - mounted.mount_m).abs() < SAME_PLACE_M) {
            mounted.mount_m = mount_m;
        }
        Ok(mounted)
    }

    /// An extra mass on the lower leg, at its distance from the joint's axis.
    ///
    /// # Errors
    /// [`GeometryError::DistanceOutOfReach`] where no point of the lower leg's line has that distance; as [`lump()`].
    pub fn load(&self, extra: &ExtraMass) -> Result<Load, GeometryError> {
        let robot = Ers7Tables::embedded();
        let mounted = self.mounted(extra)?;
        let loaded = lump(robot, self.leg, self.joint, &self.held, self.gravity_trunk_m_s2, Some(mounted))?;
        let bare = self.bare()?;
        let on_the_link = Load::on_the_link(extra);
        let Some(e) = loaded.body(LinkBody::Extra) else { return Ok(on_the_link) };
        let hanging_rad = hanging(e);
        Ok(Load {
            inertia_kg_m2: e.mass_kg * e.inertia_per_kg_m2,
            moment_kg_m: e.mass_kg * e.distance_m(),
            angle_rad: hanging_rad - bare.rest_rad,
            hanging_rad,
        })
    }
}

/// Two statements of the extra mass's place closer than this are one \[m\].
const SAME_PLACE_M: f64 = 2e-4;

fn hanging(body: &BodyLump) -> f64 {
    -math::atan2(body.lever_normal_m, body.lever_down_m)
}

fn body(lump: &BodyLump) -> Body {
    Body {
        body: lump.body,
        inertia_per_kg_m2: lump.inertia_per_kg_m2,
        lever_m: lump.distance_m(),
        hanging_rad: hanging(lump),
    }
}

fn symbol(body: LinkBody) -> &'static str {
    match body {
        LinkBody::Shoulder => "M_S",
        LinkBody::UpperLeg => "M_U",
        LinkBody::LowerLeg => "M_L",
        LinkBody::Extra => "M_E",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::read_pose_for;
    use approx::assert_relative_eq;

    #[test]
    fn the_loaded_q1_hangs_where_pose_toml_says() {
        let log = "data/thesis-robot/q1-402g-0.csv".as_ref();
        let pose = read_pose_for(log, "q1").expect("readable").expect("present");
        let case = LegCase::new(LegJoint::Q1, Some(&pose), 9.81).expect("a leg");
        let extra = ExtraMass { mass_kg: 0.402, distance_m: 0.1705, radius_m: 0.018, length_m: 0.038 };
        let load = case.load(&extra).expect("in reach");
        let bare = case.bare().expect("swings");
        let (x, y) = [(bare.moment_kg_m, bare.rest_rad), (load.moment_kg_m, load.hanging_rad)]
            .iter()
            .fold((0.0, 0.0), |(x, y), (m, a)| (x + m * a.cos(), y + m * a.sin()));
        assert_relative_eq!(y.atan2(x), pose.hanging_rad["402g"], epsilon = 1e-4);
        assert_relative_eq!(bare.rest_rad, pose.hanging_rad["bare"], epsilon = 1e-4);
        assert_relative_eq!(load.moment_kg_m, 0.402 * 0.1705, max_relative = 3e-4);
    }

    #[test]
    fn bodies_and_masses_add_up_to_the_lump() {
        let case = LegCase::new(LegJoint::Q2, None, 9.81).expect("a leg");
        let (bare, bodies, masses) = (case.bare().unwrap(), case.bodies().unwrap(), case.masses().unwrap());
        let inertia: f64 = bodies.iter().zip(&masses).map(|(b, m)| m.nominal_kg * b.inertia_per_kg_m2).sum();
        assert_relative_eq!(inertia, bare.inertia_kg_m2, max_relative = 1e-12);
        assert_eq!((masses.len(), masses[0].body, masses[0].free), (2, LinkBody::UpperLeg, true));
        assert_eq!(case.nominal().unwrap().coulomb_nm, 0.007);
    }
}
