//! A described robot as one to simulate: revolute joints, friction and gains as the description has them.

use super::{Attached, Body, BodyId, Following, Model, Touch};
use crate::geometry::robot_file::{Base, FRICTION_SET, FrictionSet, GAIN_SET, GainSet, JointFriction, RobotTables};
use crate::geometry::{Joint, JointSpring, Part};
use crate::log::{Derivative, FloorSpec};
use crate::robot::RobotError;
use crate::robot::description::{Actuator, Coupling, Description, JointKind, Mover, MoverId, RigidInertia};
use crate::robot::tree::{Jointed, Tree, TreeBase, TreeError};
use nalgebra::Vector3;

/// Diameters of bodies that have no extent, for figures \[m\].
const THIN_M: f64 = 2e-3;

impl Model {
    /// A described robot in the file's own axes: joints in the tree's order, links that cannot move lumped, the base as the file holds it.
    ///
    /// Bodies' frames lie on their joints and have the base's axes where all joints are at 0. Damping and friction loss are
    /// the friction set `chosen`, position servos the gain set `printed`; their ranges of torque limit them.
    ///
    /// # Errors
    /// [`RobotError::NotSimulated`] for sliding joints, springs that are no straight lines, closed
    /// loops, tendons that act and several trees on the world; [`RobotError::NoInertia`], [`RobotError::Value`].
    pub fn of_description(description: &Description) -> Result<Self, RobotError> {
        let tree = simulated(description, Tree::base_of(description))?;
        let (base, bodies) = tree.jointed();
        let matter = Matter { base, bodies, touches: Vec::new(), gravity_m_s2: description.gravity_m_s2, floor: None };
        Self::of_matter(description, &tree, matter)
    }

    /// What a description is made of as a model.
    pub(super) fn of_matter(description: &Description, tree: &Tree, matter: Matter) -> Result<Self, RobotError> {
        let robot = &description.name;
        let no = |what: String| RobotError::NotSimulated { robot: robot.clone(), what };
        let (held, jointed) = (tree.base(), matter.bodies);
        if held == TreeBase::Free
            && jointed.iter().any(|body| body.carrier == 0 && tree.stands_on_the_world(body.joint))
        {
            return Err(no("several trees stand on the world beside the free one".to_owned()));
        }
        // The first link that stands still gives a fixed base its name.
        let still = || description.links.first().filter(|link| link.joints.is_empty());
        let root = tree.base_link().map(|link| &description.links[link.0]).or_else(still);
        let root = root.map_or_else(|| "world".to_owned(), |link| link.name.clone());
        let names = names(description, &jointed, &root);
        let joint = |(index, body): (usize, &Jointed)| joint(description, body, index, &names);
        let mut tables = RobotTables {
            name: robot.clone(),
            root,
            base: if held == TreeBase::Free { Base::Floating } else { Base::Clamped },
            gravity_m_s2: matter.gravity_m_s2,
            parts: Vec::new(),
            joints: jointed.iter().enumerate().map(joint).collect(),
            friction: vec![friction(description, &jointed)],
            gains: gains(description, tree).into_iter().collect(),
            encoder: None,
            sensors: Vec::new(),
            effects: Vec::new(),
            attached: Vec::new(),
            floor: matter.floor,
            floor_slope_rad: [0.0; 2],
        };
        let inertias = std::iter::once(&matter.base).chain(jointed.iter().map(|body| &body.inertia));
        let mut touches = matter.touches.into_iter();
        let mut bodies = Vec::with_capacity(names.len());
        for (name, inertia) in names.iter().zip(inertias) {
            let part = part(name, inertia);
            let (mass_kg, at_m, inertia_kg_m2) = (inertia.mass_kg, inertia.centre_m(), inertia.central_kg_m2());
            let own = Attached { mass_kg, at_m, inertia_kg_m2 };
            let touches = touches.next().unwrap_or_default();
            bodies.push(Body::described(name.clone(), part.diameters_m * 0.5, own, touches)?);
            tables.parts.push(part);
        }
        let carrier = jointed.iter().map(|body| BodyId(body.carrier)).collect();
        let armature = jointed.iter().map(|body| description.joints[body.joint.0].armature_kg_m2).collect();
        let limits = jointed.iter().map(|body| torque_limit(description, body.joint).map_err(no));
        let torque_limit_nm = limits.collect::<Result<_, _>>()?;
        let made = Self::assemble(tables, bodies, carrier, armature)?;
        let following = following(description, &jointed);
        Ok(Self { derivative: Derivative::Measurement, torque_limit_nm, following, ..made })
    }
}

/// What a model's bodies are made of.
pub(super) struct Matter {
    /// What the base carries.
    pub base: RigidInertia,
    /// Parents first.
    pub bodies: Vec<Jointed>,
    /// What base and bodies may touch a floor with; none: nothing of any.
    pub touches: Vec<Vec<Touch>>,
    /// In the world's axes \[m/s^2\].
    pub gravity_m_s2: Vector3<f64>,
    /// What the description says of floors.
    pub floor: Option<FloorSpec>,
}

/// The tree of a description that can be simulated.
pub(super) fn simulated(description: &Description, held: TreeBase) -> Result<Tree, RobotError> {
    let no = |what: String| RobotError::NotSimulated { robot: description.name.clone(), what };
    if let Some(first) = description.left_out.first() {
        return Err(no(first.clone()));
    }
    for Mover { name, kind, stiffness, damping, .. } in &description.joints {
        if *kind == JointKind::Prismatic {
            return Err(no(format!("joint {name} slides (prismatic)")));
        }
        if stiffness[1..].iter().chain(&damping[1..]).any(|number| *number != 0.0) {
            return Err(no(format!("joint {name} has a stiffness or damping of several numbers")));
        }
    }
    Tree::new(description, held).map_err(|TreeError::NoFreeBase { what, .. }| {
        no(format!("it stands on no floor: {what}; hold its base, by walk --air or by a study's scenario = \"fixed\""))
    })
}

/// Couplings by place, each to the joint at the end of its chain, which the readers see to that there is.
fn following(description: &Description, jointed: &[Jointed]) -> Vec<Following> {
    let place = |id: MoverId| jointed.iter().position(|body| body.joint == id);
    let of = |coupling: &Coupling| {
        let Coupling { follower, mut leader, mut multiplier, mut offset_rad } = *coupling;
        while let Some(above) = description.couplings.iter().find(|above| above.follower == leader) {
            offset_rad += multiplier * above.offset_rad;
            multiplier *= above.multiplier;
            leader = above.leader;
        }
        Some(Following { follower: place(follower)?, leader: place(leader)?, multiplier, offset_rad })
    };
    description.couplings.iter().filter_map(of).collect()
}

/// The base's name and those of the bodies; between two joints of one link lies a body without mass.
fn names(description: &Description, jointed: &[Jointed], root: &str) -> Vec<String> {
    let name = |body: &Jointed| {
        let mover = &description.joints[body.joint.0];
        let link = &description.links[mover.link.0];
        if link.joints.last() == Some(&body.joint) {
            link.name.clone()
        } else {
            format!("{}|{}", link.name, mover.name)
        }
    };
    std::iter::once(root.to_owned()).chain(jointed.iter().map(name)).collect()
}

/// A joint; its software holds setpoints where it may go, and where its servo's control may.
fn joint(description: &Description, body: &Jointed, index: usize, names: &[String]) -> Joint {
    let mover = &description.joints[body.joint.0];
    let servo = description.actuators.iter().filter(|servo| servo.joint == body.joint).find_map(Actuator::as_servo);
    let ranges = [mover.limit_rad, servo.and_then(|servo| servo.control_range)];
    let software_rad = ranges.into_iter().flatten().reduce(|a, b| [a[0].max(b[0]), a[1].min(b[1])]);
    let spring =
        JointSpring { stiffness_nm_rad: mover.stiffness[0], damping_nm_s_rad: 0.0, rest_rad: mover.spring_rest_rad };
    Joint {
        name: mover.name.clone(),
        kind: mover.name.clone(),
        parent: names[body.carrier].clone(),
        child: names[index + 1].clone(),
        axis: body.axis,
        sign: 1.0,
        in_parent_m: body.at_m,
        in_child_m: Vector3::zeros(),
        phi_rad: Vector3::zeros(),
        hardware_rad: mover.limit_rad,
        software_rad,
        speed_rad_s: mover.rate_limit_rad_s.filter(|rate| *rate > 0.0),
        spring: (spring.stiffness_nm_rad > 0.0).then_some(spring),
    }
}

/// An ellipsoid as large as the inertia asks for, to be drawn; the mass is fixed to it apart.
fn part(name: &str, inertia: &RigidInertia) -> Part {
    let moments = inertia.central_kg_m2().diagonal();
    let squared = |k: usize| (moments.sum() - 2.0 * moments[k]) * 2.5 / inertia.mass_kg.max(f64::MIN_POSITIVE);
    Part {
        name: name.to_owned(),
        diameters_m: Vector3::from_fn(|k, _| (2.0 * squared(k).max(0.0).sqrt()).clamp(THIN_M, 10.0)),
        mass_kg: 0.0,
        stated_inertia_kg_m2: Vector3::zeros(),
        contact_m: None,
    }
}

fn friction(description: &Description, jointed: &[Jointed]) -> FrictionSet {
    let row = |body: &Jointed| {
        let mover = &description.joints[body.joint.0];
        let friction =
            JointFriction { coulomb_nm: mover.friction_nm, viscous_nm_s_rad: mover.damping[0], ..Default::default() };
        (mover.name.clone(), friction)
    };
    FrictionSet { name: FRICTION_SET.to_owned(), by_joint: jointed.iter().map(row).collect() }
}

/// The largest torque of a joint's servo at the joint; the same both ways, as motors are limited here.
fn torque_limit(description: &Description, id: MoverId) -> Result<Option<f64>, String> {
    let mover = &description.joints[id.0];
    let mut servos = description.actuators.iter().filter(|servo| servo.joint == id);
    let Some(servo) = servos.next() else { return Ok(None) };
    if servos.next().is_some() {
        return Err(format!("joint {} has several actuators", mover.name));
    }
    if let Some(activation) = &servo.activation {
        return Err(format!("joint {} has an actuator with {activation}", mover.name));
    }
    let mut limit: Option<f64> = None;
    let behind = servo.force_range_nm.map(|range| range.map(|end| end * servo.gear.abs()));
    for [low, high] in behind.into_iter().chain(mover.actuator_range_nm) {
        if (low + high).abs() > 1e-9 * high.abs() {
            return Err(format!(
                "joint {} has a torque range of {low} to {high} N m, not the same both ways",
                mover.name
            ));
        }
        limit = Some(limit.map_or(high, |limit| limit.min(high)));
    }
    Ok(limit)
}

/// Position servos as `kp (q_ref - q) - kd q'` at the joint, behind their gears.
fn gains(description: &Description, tree: &Tree) -> Option<GainSet> {
    let servos = tree.servos(description);
    let gains = |servo: Actuator| (description.joints[servo.joint.0].name.clone(), [servo.gain, 0.0, -servo.bias[2]]);
    let si: Vec<(String, [f64; 3])> = servos.iter().filter_map(Actuator::as_servo).map(gains).collect();
    (!si.is_empty()).then(|| GainSet { name: GAIN_SET.to_owned(), shift: [0; 3], by_joint: Vec::new(), si })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::Hold;
    use crate::robot::simulate::{Joints, Method, Scenario, Setpoints, run};
    use crate::robot::tree::{TreeDynamics, TreeState};
    use crate::robot::{Dynamics, Input, State};
    use nalgebra::DMatrix;
    use std::fs;

    const ARM: &str = r#"<mujoco model="arm"><compiler angle="radian" eulerseq="zyx"/><option gravity="0 0 -9.81"/>
        <worldbody><body name="stand" pos="0 0 .2"><geom size=".05"/>
        <body name="upper" pos="0 .1 .3" euler=".3 1.5707963267948966 .2"><joint name="a" axis="1 2 -1" ref=".3" armature=".02" damping=".1"/>
            <joint name="b" axis="0 1 0" pos="0 .02 .1" frictionloss=".2" range="-2 2"/><geom type="capsule" fromto="0 0 0 .2 .1 0" size=".03"/>
            <body name="lower" pos=".2 .1 0" quat="1 2 0 1"><joint name="c" axis="0 0 3" stiffness="2" springref=".1"/>
                <geom type="box" size=".1 .02 .03" pos=".1 0 .02"/></body></body></body></worldbody>
        <actuator><position joint="c" kp="5" kv=".2" gear="-2" forcerange="-3 3"/></actuator></mujoco>"#;

    fn described(text: &str) -> Description {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("arm.xml");
        fs::write(&file, text).unwrap();
        Description::read(&file).unwrap()
    }

    #[test]
    fn setpoints_are_held_where_a_servos_control_may_go() {
        let range = |servo: &str| {
            let model = Model::of_description(&described(&ARM.replace(r#"<position joint="c""#, servo))).unwrap();
            model.joints()[model.joint("c").unwrap().index()].software_rad
        };
        assert_eq!(range(r#"<position joint="c""#), None);
        assert_eq!(range(r#"<position joint="c" ctrlrange="-.4 .8""#), Some([-0.4, 0.2]));
    }

    #[test]
    fn a_described_arm_moves_alike_in_both_recursions() {
        for text in [ARM.to_owned(), ARM.replace("<geom size=\".05\"/>", "<freejoint/><geom size=\".05\"/>")] {
            let description = described(&text);
            let model = Model::of_description(&description).unwrap();
            let tree = Tree::new(&description, Tree::base_of(&description)).unwrap();
            let mut general = TreeState::drawn(&tree);
            (general.position, general.rate) = (vec![0.4, -0.7, 1.1], vec![1.0, -2.0, 0.5]);
            let mut own = State::at_rest(&model);
            (own.angle_rad, own.rate_rad_s) = (general.position.clone(), general.rate.clone());
            if tree.base() == TreeBase::Free {
                (general.base_velocity_m_s, general.base_rate_rad_s) =
                    (Vector3::new(0.1, 0.2, -0.3), Vector3::new(1.0, 0.5, -0.4));
                (own.base_position_m, own.base_orientation) = (general.base_position_m, general.base_orientation);
                (own.base_velocity_m_s, own.base_rate_rad_s) = (general.base_velocity_m_s, general.base_rate_rad_s);
            }
            let (n, skip) = (tree.freedoms(), 6 - tree.base_freedoms());
            let (mut fast, mut slow) = (Dynamics::new(&model), TreeDynamics::new(&tree));
            let torque = [0.3, -0.1, 0.2];
            let (mut force, mut expected, mut found) = (vec![0.0; n], vec![0.0; n], vec![0.0; 9]);
            slow.forces_of(&torque, &mut force);
            slow.forward(&general, &force, &mut expected).unwrap();
            fast.forward(&own, &Input::torques(&torque), &mut found);
            for (found, expected) in found[skip..].iter().zip(&expected) {
                assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0), "{found} {expected}");
            }
            let (mut ours, mut theirs) = (DMatrix::zeros(n, n), DMatrix::zeros(9, 9));
            slow.mass_matrix(&general, &mut ours);
            fast.mass_matrix(&own, &mut theirs);
            assert!((ours - theirs.view((skip, skip), (n, n))).amax() < 1e-13);
            assert!((slow.energy(&general).kinetic_j - fast.energy(&own).kinetic_j).abs() < 1e-13);
            let mut needed = vec![0.0; 9];
            fast.inverse(&own, &found, &[], &mut needed);
            assert!(needed[6..].iter().zip(torque).all(|(a, b)| (a - b).abs() < 1e-10));
        }
    }

    #[test]
    fn friction_springs_limits_and_gains_are_the_description_s() {
        let model = Model::of_description(&described(ARM)).unwrap();
        let id = |name: &str| model.joint(name).unwrap();
        assert_eq!(model.armature_kg_m2(), [0.02, 0.0, 0.0]);
        assert_eq!(model.friction("chosen", id("a")).unwrap().viscous_nm_s_rad, 0.1);
        assert_eq!(model.friction("chosen", id("b")).unwrap().coulomb_nm, 0.2);
        assert_eq!(model.joints()[1].hardware_rad, Some([-2.0, 2.0]));
        assert_eq!(model.joints()[2].spring.unwrap().rest_rad, 0.1);
        let gains = model.gains("printed", id("c")).unwrap();
        assert_eq!((gains.kp_nm_rad, gains.kd_nm_s_rad), (20.0, 0.8));
        assert_eq!(model.gains("printed", id("a")), None);
        assert_eq!((model.torque_limit_nm(id("a")), model.torque_limit_nm(id("c"))), (None, Some(6.0)));
        assert_eq!(model.bodies()[1].name, "upper|a");
    }

    /// The arm without springs, friction and servo, its last joint held to the first one's angle.
    fn coupled(damping: &str) -> Description {
        let bare = ARM.replace(" stiffness=\"2\" springref=\".1\"", damping).replace(" frictionloss=\".2\"", "");
        let bare = bare.replace(" damping=\".1\"", "");
        let (arm, _) = bare.split_once("<actuator>").unwrap();
        let held = r#"<equality><joint joint1="c" joint2="a" polycoef=".1 -.5 0 0 0"/></equality></mujoco>"#;
        described(&format!("{arm}{held}")).with_equalities()
    }

    #[test]
    fn a_joint_that_follows_another_moves_with_it_as_the_tree_says() {
        let description = coupled("");
        let model = Model::of_description(&description).unwrap();
        let tree = Tree::new(&description, Tree::base_of(&description)).unwrap();
        assert_eq!((tree.freedoms(), model.following().len()), (2, 1));
        let mut dynamics = TreeDynamics::new(&tree);
        let mut state = TreeState::drawn(&tree);
        (state.position, state.rate) = (vec![0.4, -0.7], vec![1.0, -2.0]);
        let mut own = State::at_rest(&model);
        (own.angle_rad, own.rate_rad_s) = (vec![0.4, -0.7, 0.0], vec![1.0, -2.0, 0.0]);

        // The reduced tree by Runge and Kutta's midpoints.
        let (step_s, steps) = (1e-4, 4000);
        let mut acceleration = vec![0.0; 2];
        let mut middle = state.clone();
        for _ in 0..steps {
            dynamics.forward(&state, &[0.0; 2], &mut acceleration).unwrap();
            for (j, faster) in acceleration.iter().enumerate() {
                middle.position[j] = state.position[j] + 0.5 * step_s * state.rate[j];
                middle.rate[j] = state.rate[j] + 0.5 * step_s * faster;
            }
            dynamics.forward(&middle, &[0.0; 2], &mut acceleration).unwrap();
            for (j, faster) in acceleration.iter().enumerate() {
                state.position[j] += step_s * middle.rate[j];
                state.rate[j] += step_s * faster;
            }
        }
        let joints = Joints::passive(&model);
        let setpoints = Setpoints { t_s: vec![0.0, 0.4], columns: vec![None; 3], hold: Hold::Linear };
        let scenario = Scenario {
            model: &model,
            joints: &joints,
            setpoints: &setpoints,
            start: &own,
            surroundings: None,
            period_s: 0.1,
        };
        let end = run(&scenario, Method::Stiff { step_s: 1e-4 }).unwrap().end;
        for j in 0..2 {
            let (found, expected) = (end.angle_rad[j], state.position[j]);
            assert!((found - expected).abs() < 1e-5, "{found} {expected}");
        }
        let one = model.following()[0];
        assert!((end.angle_rad[2] - one.offset_rad - one.multiplier * end.angle_rad[0]).abs() < 1e-9);

        let smooth = Method::Smooth(crate::integrate::Method::Rk4 { step_s: 1e-4 });
        let error = run(&scenario, smooth).unwrap_err().to_string();
        assert!(error.contains("joint c follows another"), "{error}");
    }

    #[test]
    fn a_follower_s_friction_is_felt_at_its_leader() {
        let model = Model::of_description(&coupled(" damping=\".2\" frictionloss=\".3\"")).unwrap();
        let mut joints = Joints::passive(&model);
        joints.set_friction(&model, "chosen").unwrap();
        let law = |name: &str| &joints.drive(model.joint(name).unwrap()).chain.friction;
        assert!((law("a").coulomb_nm - 0.15).abs() < 1e-12 && (law("a").viscous_nm_s_rad - 0.05).abs() < 1e-12);
        assert_eq!((law("c").coulomb_nm, law("c").viscous_nm_s_rad), (0.0, 0.0));
    }

    #[test]
    fn what_is_not_simulated_is_named() {
        let cases = [
            ("<joint name=\"c\"", "<joint name=\"c\" type=\"slide\"", "joint c slides (prismatic)"),
            ("</actuator>", "</actuator><equality><weld body1=\"lower\"/></equality>", "equality weld closes a loop"),
            ("\"-3 3\"", "\"-3 4\"", "joint c has a torque range of -6 to 8 N m"),
            ("</actuator>", "<motor joint=\"c\"/></actuator>", "joint c has several actuators"),
            ("stiffness=\"2\"", "stiffness=\"2 1\"", "joint c has a stiffness"),
        ];
        for (from, to, expected) in cases {
            let error = Model::of_description(&described(&ARM.replacen(from, to, 1))).unwrap_err().to_string();
            assert!(error.contains(expected) && error.contains("`dynamics` answers"), "{error}");
        }
    }
}
