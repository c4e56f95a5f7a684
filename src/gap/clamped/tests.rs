use super::along::Along;
use super::answer::JointAnswer;
use super::diagnose::concluded;
use crate::gap::{Answer, Diagnosis, Gap, Number, Verdict};
use crate::identify::Directives;
use crate::joint::EffectId;
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
    let mut description = Description::read(&file).unwrap();
    // A spring on the elbow, which the tree does not have.
    let [stiffness_nm_rad, rest_rad] = [0.8, 0.25];
    let elbow = description.joints.iter_mut().find(|joint| joint.name == "elbow").unwrap();
    (elbow.stiffness[0], elbow.spring_rest_rad) = (stiffness_nm_rad, rest_rad);
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
            needed[1] += stiffness_nm_rad * (q[1] - rest_rad);
            let made = chain.inertia_at_kg_m2(t) * ddq[j] - chain.acting_nm(t, q[j], dq[j]);
            assert_relative_eq!(made, needed[j], epsilon = 0.02);
        }
    }
}

/// A joint whose answer is the gain of its drive, as a number.
pub fn of_another_gain(joint: &str) -> Diagnosis {
    let gain = Number {
        name: "gain".to_owned(),
        value: 1.3,
        unit: String::new(),
        interval: Some([1.2, 1.4]),
        interval_naive: None,
    };
    Diagnosis {
        joint: joint.to_owned(),
        answer: Answer {
            verdict: Verdict::Effect,
            effect: Some("motor_gain".to_owned()),
            second: None,
            equivalent: vec![EffectId::MotorGain],
            probability: None,
            probability_source: String::new(),
            standing: String::new(),
            sentence: String::new(),
            partial: None,
            intervals_trusted: true,
        },
        gap: Gap {
            unit: "rad",
            before: 0.05,
            calibrated: 0.001,
            after_first: 0.001,
            after: 0.001,
            floor: 0.001,
            closed: Some(1.0),
            closed_interval: None,
            outer: true,
            held_out: String::new(),
            per_log: Vec::new(),
        },
        effect_parameters: vec![(EffectId::MotorGain, vec![gain])],
        location: Default::default(),
        ranking: Vec::new(),
        detectable: Vec::new(),
        parameters: Vec::new(),
        causes: Vec::new(),
        beliefs: Vec::new(),
        law: None,
        differs: Vec::new(),
        undetermined: Vec::new(),
        next: None,
        confusion: None,
        traces: Vec::new(),
        doubts: Vec::new(),
        notes: Vec::new(),
        withheld: Vec::new(),
        demands: Directives::default(),
        budget: None,
    }
}

#[test]
fn a_gain_that_a_joint_has_as_a_number_is_the_robots_cause() {
    let joint = |name: &str| JointAnswer { joint: name.to_owned(), diagnosis: Some(of_another_gain(name)) };
    let joints = ["shoulder", "elbow"].map(joint).to_vec();
    let found = concluded("arm", &Default::default(), joints, Vec::new(), None, Vec::new());
    assert_eq!((found.answer.verdict, found.answer.effect), (Verdict::Effect, Some("motor_gain")));
    let cause = &found.causes[0];
    assert_eq!((cause.joints.join(" "), cause.share), ("shoulder elbow".to_owned(), 0.0));
    assert_eq!(cause.size.as_ref().map(|size| size.name.as_str()), Some("gain"));
    let said = &found.answer.sentence;
    assert!(said.contains("delivers more or less") && !said.contains("no cause"), "{said}");
    // It is a number of the servo already.
    assert!(crate::gap::whole::placed_causes(&found).is_empty());
}

#[test]
fn figures_of_logs_that_chose_masses_or_bodies_are_not_called_outer() {
    let joint = JointAnswer { joint: "elbow".to_owned(), diagnosis: Some(of_another_gain("elbow")) };
    let found = concluded("arm", &Default::default(), vec![joint], Vec::new(), None, Vec::new());
    assert!(found.gap.outer && found.notes.is_empty());
    let found = found.chosen_by_held_out("Bodies have other masses.").chosen_by_held_out("A body is another.");
    let own = found.found().next().unwrap();
    assert!(!found.gap.outer && !own.gap.outer);
    for notes in [&found.notes, &own.notes] {
        assert!(notes.len() == 1 && notes[0].contains("had a say"), "{notes:?}");
    }
}

#[test]
fn joints_that_rest_in_held_out_logs_are_said_to_have_figures_of_other_logs() {
    let joint = |(name, how): (&str, &str)| {
        let mut own = of_another_gain(name);
        (own.gap.outer, own.gap.held_out) = (false, how.to_owned());
        JointAnswer { joint: name.to_owned(), diagnosis: Some(own) }
    };
    let joints = [("wrist", crate::gap::LOGS_IN_TURN), ("elbow", "as the study says")].map(joint).to_vec();
    let notes = concluded("arm", &Default::default(), joints, Vec::new(), None, Vec::new()).notes;
    assert!(notes.len() == 2 && notes[0].starts_with("wrist: no log") && notes[1].starts_with("elbow: "), "{notes:?}");
}
