use super::along::Along;
use crate::log::{JointColumns, RobotLog};
use crate::robot::description::Description;
use crate::robot::tree::{Tree, TreeBase, TreeDynamics, TreeState};
use approx::assert_relative_eq;

/// Two links that turn about parallel horizontal axes, the second one's axis turned out of the first one's.
const ARM: &str = r#"<robot name="arm">
<link name="base"/>
<link name="upper"><inertial><origin xyz="0.02 0 -0.2"/><mass value="1.2"/>
  <inertia ixx="0.01" iyy="0.011" izz="0.002" ixy="0.0003" ixz="0" iyz="0"/></inertial></link>
<link name="lower"><inertial><origin xyz="0 0.01 -0.15"/><mass value="0.6"/>
  <inertia ixx="0.004" iyy="0.0041" izz="0.0005" ixy="0" ixz="0.0001" iyz="0"/></inertial></link>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
  <limit lower="-3" upper="3" effort="10" velocity="10"/></joint>
<joint name="elbow" type="revolute"><parent link="upper"/><child link="lower"/><origin xyz="0 0 -0.4" rpy="0 0 0.4"/>
  <axis xyz="0.3 1 0.1"/><limit lower="-3" upper="3" effort="10" velocity="10"/></joint>
</robot>"#;

/// Along a motion the carried pendulum has the torques of inverse dynamics, whatever the joint's own angle.
#[test]
fn a_joint_of_a_robot_is_a_pendulum_with_a_load_that_time_changes() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("arm.urdf");
    std::fs::write(&file, ARM).unwrap();
    let description = Description::read(&file).unwrap();
    let tree = Tree::new(&description, TreeBase::Fixed).unwrap();
    let t_s: Vec<f64> = (0..400).map(|k| 0.005 * f64::from(k)).collect();
    let at = |t: f64| {
        ([0.7 * (2.0 * t).sin(), 0.5 + 0.4 * (3.1 * t).cos()], [1.4 * (2.0 * t).cos(), -1.24 * (3.1 * t).sin()])
    };
    let joint = |k: usize, name: &str| JointColumns {
        name: name.to_owned(),
        q_rad: t_s.iter().map(|t| at(*t).0[k]).collect(),
        ..JointColumns::default()
    };
    let log = RobotLog {
        file: "made".into(),
        joints: vec![joint(0, "shoulder"), joint(1, "elbow")],
        t_s: t_s.clone(),
        base: None,
        acceleration_m_s2: None,
        ignored_columns: Vec::new(),
        notes: Vec::new(),
    };
    let links = Along::new(&description, &tree).links(std::slice::from_ref(&log), &[None]);
    let mut dynamics = TreeDynamics::new(&tree);
    for (j, link) in links.into_iter().enumerate() {
        let (nominal, carriages) = link.unwrap();
        let friction = crate::joint::Friction::coulomb_viscous(0.0, 0.0);
        let link = crate::joint::Link::new(nominal.inertia_kg_m2, nominal.moment_kg_m, 0.0, 9.81);
        let mut chain = crate::joint::Chain::new(link, friction, None);
        chain.carriage = Some(carriages[0].clone());
        for k in [60, 133, 250, 377] {
            let t = t_s[k];
            let (mut q, dq) = at(t);
            // Where the joint itself is elsewhere, its load is what gravity and the others make of it there.
            q[j] += 0.3;
            let own = if j == 0 { -2.8 * (2.0 * t).sin() } else { -3.844 * (3.1 * t).cos() };
            let mut ddq = [-2.8 * (2.0 * t).sin(), -3.844 * (3.1 * t).cos()];
            ddq[j] = own + 5.0;
            let mut state = TreeState::drawn(&tree);
            state.position.copy_from_slice(&q);
            let mut level = [0.0; 2];
            dynamics.bias(&state, &mut level);
            assert_relative_eq!(chain.link_at(t).0.gravity_nm(q[j]), -level[j], epsilon = 2e-3);
            // As measured, the rest of it too.
            q[j] -= 0.3;
            state.position.copy_from_slice(&q);
            state.rate.copy_from_slice(&dq);
            let mut needed = [0.0; 2];
            dynamics.inverse(&state, &ddq, &mut needed);
            let made = chain.inertia_at_kg_m2(t) * ddq[j] - chain.acting_nm(t, q[j], dq[j]);
            assert_relative_eq!(made, needed[j], epsilon = 0.02);
        }
    }
}
