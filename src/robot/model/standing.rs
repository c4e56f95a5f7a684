//! A described robot that may stand on a floor: free of the world, in the axes of the thesis, with its feet.

use super::Model;
use super::of_description::{Matter, simulated};
use super::touch::{Touch, is_ball};
use crate::log::FloorSpec;
use crate::robot::RobotError;
use crate::robot::description::{Collider, Description, LinkId};
use crate::robot::tree::{Jointed, Tree, TreeBase};
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};
use std::collections::BTreeMap;

/// The axis that points up has to have so much of gravity.
const UPRIGHT: f64 = 1.0 - 1e-6;

impl Model {
    /// A described robot as one that may stand: its base is free, the world has this program's axes (y up, -z forward, x to the
    /// right), and where all is as drawn the base has them, too. Of a description with z up, x is forward.
    ///
    /// Feet are the balls that collide of bodies that carry no other, or where such a body has none all of its shapes; or, where
    /// `feet_m` names links, balls of such radii \[m\] about these links' origins, and nothing else. Their friction is the largest
    /// that the description gives them.
    ///
    /// # Errors
    /// As [`Model::of_description`]; [`RobotError::NoBody`] for feet that are no links; [`RobotError::NotSimulated`] where
    /// neither z nor y is up.
    pub fn standing(description: &Description, feet_m: &BTreeMap<String, f64>) -> Result<Self, RobotError> {
        let tree = simulated(description, TreeBase::Free)?;
        let no = |what: &str| RobotError::NotSimulated { robot: description.name.clone(), what: what.to_owned() };
        let upright = upright(&description.gravity_m_s2).ok_or_else(|| no("neither its z nor its y axis points up"))?;
        let drawn = tree.base_pose().map_or_else(Rotation3::identity, |pose| pose.rotation.to_rotation_matrix());
        let turn = upright * drawn;
        let (base, bodies) = tree.jointed();
        let (touches, friction) = touches(description, &tree, &bodies, feet_m, &turn)?;
        let floor =
            friction.map(|mu| FloorSpec { static_friction: Some(mu), coulomb: Some(mu), ..FloorSpec::default() });
        let matter = Matter {
            base: base.moved(turn.matrix(), &Vector3::zeros()),
            bodies: bodies.into_iter().map(|body| body.turned(&turn)).collect(),
            touches,
            gravity_m_s2: upright * description.gravity_m_s2,
            floor,
        };
        Self::of_matter(description, &tree, matter)
    }
}

/// From the axes of a description under a gravity to this program's; `None` where neither z nor y is up.
fn upright(gravity_m_s2: &Vector3<f64>) -> Option<Rotation3<f64>> {
    let up = Unit::try_new(-gravity_m_s2, f64::MIN_POSITIVE)?;
    // In the columns what x, y and z become.
    let z_up = Matrix3::from_columns(&[-Vector3::z(), -Vector3::x(), Vector3::y()]);
    match (up.z > UPRIGHT, up.y > UPRIGHT) {
        (true, _) => Some(Rotation3::from_matrix_unchecked(z_up)),
        (_, true) => Some(Rotation3::identity()),
        _ => None,
    }
}

/// What base and bodies may touch a floor with, and the friction of feet.
fn touches(
    description: &Description,
    tree: &Tree,
    bodies: &[Jointed],
    feet_m: &BTreeMap<String, f64>,
    turn: &Rotation3<f64>,
) -> Result<(Vec<Vec<Touch>>, Option<f64>), RobotError> {
    let turn = Isometry3::from_parts(Translation3::identity(), UnitQuaternion::from_rotation_matrix(turn));
    let places: Vec<_> = tree.carried().into_iter().map(|(body, pose)| (body, turn * pose)).collect();
    let mut all: Vec<Vec<Touch>> = vec![Vec::new(); bodies.len() + 1];
    let mut friction: Option<f64> = None;
    let is_end = |body: usize| body > 0 && bodies.iter().all(|other| other.carrier != body);
    let stands_on = |body: usize, collider: &Collider| {
        let of_body = || description.links.iter().zip(&places).filter(|(_, place)| place.0 == Some(body));
        let has_ball = || of_body().any(|(link, _)| link.colliders.iter().any(is_ball));
        feet_m.is_empty() && is_end(body) && (is_ball(collider) || !has_ball())
    };
    for (link, (body, place)) in description.links.iter().zip(&places) {
        let Some(body) = *body else { continue };
        for collider in &link.colliders {
            let is_foot = stands_on(body, collider);
            if is_foot || feet_m.contains_key(&link.name) {
                friction = collider.friction.map(|mu| friction.map_or(mu, |other| other.max(mu))).or(friction);
            }
            all[body].extend(Touch::of_collider(collider, place).into_iter().map(|touch| Touch { is_foot, ..touch }));
        }
    }
    for (name, radius_m) in feet_m {
        let LinkId(link) = description.link(name).ok_or_else(|| RobotError::NoBody {
            robot: description.name.clone(),
            name: name.clone(),
            bodies: description.links.iter().map(|link| link.name.clone()).collect(),
        })?;
        let (body, place) = &places[link];
        let Some(body) = *body else { continue };
        all[body].push(Touch::ball(place.translation.vector, *radius_m));
    }
    Ok((all, friction))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{Dynamics, Floor, FloorParameters, State, Touching};

    /// A trunk that is drawn turned to its left, with two legs, one of which has a foot on a link of its own.
    const DOG: &str = r#"<mujoco model="dog"><compiler angle="radian"/><worldbody><geom type="plane" size="1 1 1"/>
        <body name="trunk" pos="0 0 1" euler="0 0 1.5707963267948966"><freejoint/><geom type="box" size=".2 .1 .05" mass="5"/>
        <body name="left" pos=".2 .1 0"><joint name="l" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0 0 -.2" size=".02" mass=".3"/>
            <body name="foot" pos="0 0 -.2"><geom size=".03" mass=".1" friction=".6"/></body></body>
        <body name="right" pos=".2 -.1 0"><joint name="r" axis="0 1 0"/>
            <geom type="capsule" fromto="0 0 0 0 0 -.2" size=".03" mass=".4" friction=".5"/></body></body></worldbody></mujoco>"#;

    fn read(text: &str) -> Description {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("dog.xml");
        std::fs::write(&file, text).unwrap();
        Description::read(&file).unwrap()
    }

    #[test]
    fn a_dog_stands_upright_on_its_feet_however_it_is_drawn() {
        let model = Model::standing(&read(DOG), &BTreeMap::new()).unwrap();
        assert!((model.gravity_m_s2() - Vector3::new(0.0, -9.81, 0.0)).norm() < 1e-9);
        // Forward as drawn is the world's y, which is our left.
        let at = |name: &str| model.joints()[model.joint(name).unwrap().index()].in_parent_m;
        assert!((at("l") - Vector3::new(-0.2, 0.0, 0.1)).norm() < 1e-9, "{}", at("l"));
        let feet = |name: &str| {
            let body = &model.bodies()[model.body(name).unwrap().index()];
            body.touches.iter().filter(|touch| touch.is_foot).count()
        };
        assert_eq!((feet("trunk"), feet("left"), feet("right")), (0, 1, 2));
        assert_eq!(model.floor().0.map(|floor| floor.coulomb), Some(Some(0.6)));

        let floor = Floor::new(FloorParameters::default(), &model, Touching::Marked).unwrap();
        let mut dynamics = Dynamics::new(&model);
        let height_m = floor.height_on_m(&mut dynamics, &State::at_rest(&model));
        assert!((height_m - 0.23).abs() < 1e-9, "{height_m}");
        let all = Floor::new(FloorParameters::default(), &model, Touching::All).unwrap();
        assert_eq!((floor.parts(), all.parts()), (3, 8 + 3 + 2));
    }

    #[test]
    fn feet_may_be_named() {
        let feet = BTreeMap::from([("foot".to_owned(), 0.05)]);
        let model = Model::standing(&read(DOG), &feet).unwrap();
        let touches = |name: &str| model.bodies()[model.body(name).unwrap().index()].touches.clone();
        let [ball] = touches("left").into_iter().filter(|touch| touch.is_foot).collect::<Vec<_>>()[..] else {
            panic!("one foot");
        };
        assert!((ball.lowest_m(&Vector3::y()) - Vector3::new(0.0, -0.25, 0.0)).norm() < 1e-9);
        assert!(touches("right").iter().all(|touch| !touch.is_foot));
        let error = Model::standing(&read(DOG), &BTreeMap::from([("paw".to_owned(), 0.05)])).unwrap_err().to_string();
        assert!(error.contains("no body paw; it has trunk, left, foot, right"), "{error}");
    }

    #[test]
    fn what_has_no_up_does_not_stand() {
        let tilted = DOG.replace("<worldbody>", "<option gravity=\"5 0 -8\"/><worldbody>");
        let error = Model::standing(&read(&tilted), &BTreeMap::new()).unwrap_err().to_string();
        assert!(error.contains("neither its z nor its y axis points up"), "{error}");
    }
}
