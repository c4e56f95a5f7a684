//! Small files against what MuJoCo 4.0.0 makes of them.

use crate::robot::description::{Description, DescriptionError, Link, Mover, to_mjcf};
use crate::robot::tree::{Tree, TreeBase, TreeDynamics, TreeState};
use nalgebra::{DMatrix, Vector3};
use std::fs;

fn read(text: &str) -> Result<Description, DescriptionError> {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("m.xml"), text).unwrap();
    Description::read(&folder.path().join("m.xml"))
}

/// A robot of what stands before and in its world.
fn robot(before: &str, world: &str) -> Description {
    read(&format!("<mujoco>{before}<worldbody>{world}</worldbody></mujoco>")).unwrap()
}

fn joint<'d>(of: &'d Description, name: &str) -> &'d Mover {
    &of.joints[of.joint(name).unwrap().0]
}

fn link<'d>(of: &'d Description, name: &str) -> &'d Link {
    &of.links[of.link(name).unwrap().0]
}

#[track_caller]
fn near(found: impl IntoIterator<Item = f64>, expected: &[f64]) {
    let found: Vec<f64> = found.into_iter().collect();
    assert_eq!(found.len(), expected.len());
    assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}, expected {expected:?}");
}

#[test]
fn classes_copy_their_parent_when_they_are_declared_and_an_own_class_beats_childclass() {
    let before = r#"<default><default class="a"><geom size=".1"/></default><joint armature="1"/></default>
        <default><joint armature="2"/><default class="b"><geom size=".2"/></default></default>"#;
    let world = r#"<body childclass="a"><joint name="x"/><geom/><body childclass="b"><joint name="y"/><geom/>
        <body><joint name="z" class="main"/><geom/></body></body></body>"#;
    let made = robot(before, world);
    assert_eq!(made.joints.iter().map(|joint| joint.armature_kg_m2).collect::<Vec<_>>(), [1.0, 2.0, 2.0]);
    assert_eq!(made.links.iter().filter(|link| link.is_named).count(), 0);
    assert!(made.warnings[0].contains("3 bodies and 0 joints have no name"));
}

#[test]
fn inherited_values_go_number_by_number_and_orientations_as_one() {
    let before = r#"<default><geom type="box" size=".1 .2 .3" euler="90 0 0" mass="3"/></default>"#;
    let made = robot(before, r#"<body name="p"><joint/><geom quat="1 0 0 0" size=".5" density="1"/></body>"#);
    let inertia = link(&made, "p").inertia;
    // 3 kg in half-lengths 0.5, 0.2, 0.3, not turned: a class's mass beats an element's density.
    near(inertia.tensor_kg_m2.diagonal().iter().copied(), &[0.13, 0.34, 0.29]);
}

#[test]
fn degrees_are_for_hinges_only_and_a_range_limits_by_itself() {
    let world = r#"<body name="p"><joint name="h" range="-90 60" ref="30" springref="10" stiffness="1 2"/>
        <joint name="s" type="slide" range="-.1 .2" ref=".15"/><joint name="o" range="-1 1" limited="false"/>
        <joint name="b" range="1 0"/><geom size=".1"/></body>"#;
    let made = robot("", world);
    let hinge = joint(&made, "h");
    near(hinge.limit_rad.unwrap(), &[-90_f64.to_radians(), 60_f64.to_radians()]);
    near([hinge.drawn_rad, hinge.spring_rest_rad], &[30_f64.to_radians(), 10_f64.to_radians()]);
    assert_eq!(hinge.stiffness, [1.0, 2.0, 0.0]);
    near(joint(&made, "s").limit_rad.unwrap(), &[-0.1, 0.2]);
    assert_eq!((joint(&made, "o").limit_rad, joint(&made, "b").limit_rad), (None, None));
    let strict =
        r#"<mujoco><compiler autolimits="false"/><worldbody><body><joint range="0 1"/></body></worldbody></mujoco>"#;
    assert!(read(strict).unwrap_err().to_string().contains("limited=\"true\" or \"false\" beside it"));
}

#[test]
fn frames_turn_bodies_joints_and_geoms_and_hand_on_classes() {
    let before = r#"<default><default class="c"><joint armature="3" axis="0 1 0"/></default></default>"#;
    let world = r#"<frame pos="0 0 1" euler="0 0 90" childclass="c"><body name="p" pos="1 0 0">
        <frame pos=".5 0 0" euler="90 0 0"><joint name="j" pos="0 0 .1"/><geom size=".1" pos="1 0 0"/></frame></body></frame>"#;
    let made = robot(before, world);
    let (moved, joint) = (link(&made, "p"), joint(&made, "j"));
    near(moved.pose.translation.vector.iter().copied(), &[0.0, 1.0, 1.0]);
    near(joint.place_m.iter().copied(), &[0.5, -0.1, 0.0]);
    near(joint.axis.iter().copied(), &[0.0, 0.0, 1.0]);
    assert_eq!(joint.armature_kg_m2, 3.0);
    near(moved.inertia.centre_m().iter().copied(), &[1.5, 0.0, 0.0]);
}

#[test]
fn replicas_are_moved_turned_and_numbered() {
    let world = r#"<body name="r"><geom size=".1"/><replicate count="3" offset=".1 .2 0" euler="10 20 30" sep="_">
        <body name="p" pos="1 0 0"><joint name="j"/><geom size=".1"/></body></replicate></body>"#;
    let made = robot(r#"<compiler eulerseq="XYZ"/>"#, world);
    let last = link(&made, "p_2").pose;
    near(last.translation.vector.iter().copied(), &[0.47620806758845013, 1.0869114030601108, -0.6443544417857991]);
    let q = last.rotation;
    near([q.w, q.i, q.j, q.k], &[0.831129853283164, -0.02709756006084052, 0.37328617311959467, 0.41127402322294004]);
    let twelve =
        robot("", r#"<replicate count="12"><body name="p"><joint name="j"/><geom size=".1"/></body></replicate>"#);
    assert_eq!((twelve.joints[0].name.as_str(), twelve.joints[11].name.as_str()), ("j00", "j11"));
}

#[test]
fn masses_are_lifted_evened_fused_and_scaled_as_the_compiler_says() {
    let two =
        r#"<geom size="1"/><body name="s"><geom size=".1"/><body name="a"><joint/><geom size=".1"/></body></body>"#;
    let scaled = robot(r#"<compiler settotalmass="10"/>"#, two);
    near(scaled.links.iter().map(|link| link.inertia.mass_kg), &[5.0, 5.0]);
    near(link(&scaled, "a").inertia.tensor_kg_m2.diagonal().iter().copied(), &[0.02; 3]);
    let fused = robot(r#"<compiler fusestatic="true"/>"#, two);
    assert_eq!(link(&fused, "s").inertia.mass_kg, 0.0);
    let one = |moments: &str| {
        format!(r#"<body name="a"><joint/><inertial pos="1 0 0" mass=".5" diaginertia="{moments}"/></body>"#)
    };
    let lifted = link(&robot(r#"<compiler boundmass="1" boundinertia=".02"/>"#, &one(".03 .01 .029")), "a").inertia;
    near(lifted.central_kg_m2().diagonal().iter().copied(), &[0.03, 0.02, 0.029]);
    assert_eq!((lifted.mass_kg, lifted.centre_m()), (1.0, Vector3::x()));
    let evened = link(&robot(r#"<compiler balanceinertia="true"/>"#, &one(".06 .01 .02")), "a").inertia;
    near(evened.central_kg_m2().diagonal().iter().copied(), &[0.03; 3]);
}

#[test]
fn geoms_count_where_and_as_far_as_they_are_asked_for() {
    let body = r#"<body name="a"><joint/><inertial pos="0 0 0" mass="2" diaginertia="1 1 1"/><geom size=".1" mass="5" group="1"/></body>"#;
    let mass = |before: &str| link(&robot(before, body), "a").inertia.mass_kg;
    assert_eq!(mass(""), 2.0);
    assert_eq!(mass(r#"<compiler inertiafromgeom="true"/>"#), 5.0);
    // With no geom in the groups what is stated stays.
    assert_eq!(mass(r#"<compiler inertiafromgeom="true" inertiagrouprange="2 3"/>"#), 2.0);
    let weightless = r#"<body name="a"><joint/><geom size=".1" mass="1"/><geom size="9" mass="0"/><geom type="mesh" mesh="m" density="0"/></body>"#;
    assert_eq!(link(&robot("", weightless), "a").inertia.mass_kg, 1.0);
}

#[test]
fn includes_are_pasted_anywhere_and_their_compiler_holds_for_all() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("parts")).unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write(
        "m.xml",
        r#"<mujoco><include file="parts/set.xml"/><worldbody><body name="a"><include file="parts/arm.xml"/></body></worldbody></mujoco>"#,
    );
    write("parts/set.xml", r#"<mujocoinclude><compiler angle="radian"/></mujocoinclude>"#);
    // Beside the main file there is no joint.xml: the including file's folder is next.
    write("parts/arm.xml", r#"<mujoco><include file="joint.xml"/><geom size=".1"/></mujoco>"#);
    write("parts/joint.xml", r#"<x><joint name="j" range="-1 1"/></x>"#);
    let made = Description::read(&folder.path().join("m.xml")).unwrap();
    assert_eq!(joint(&made, "j").limit_rad, Some([-1.0, 1.0]));
    assert_eq!(made.files.len(), 4);
}

#[test]
fn gravity_can_be_switched_off() {
    let body = r#"<body><joint/><geom size=".1"/></body>"#;
    assert_eq!(robot(r#"<option gravity="0 -9 0"/>"#, body).gravity_m_s2, Vector3::new(0.0, -9.0, 0.0));
    let off = robot(r#"<option gravity="0 -9 0"><flag gravity="disable"/></option>"#, body);
    assert_eq!(off.gravity_m_s2, Vector3::zeros());
}

#[test]
fn actuators_have_gains_and_biases_of_their_kind() {
    let made = read(
        r#"<mujoco><compiler angle="radian"/>
        <default><default class="s"><position kp="20" dampratio=".7"/></default>
            <general biastype="affine" gainprm="7" biasprm="0 -9 -.4" gear="2 5"/></default>
        <worldbody><body name="a" pos="0 0 1"><joint name="j" axis="0 1 0" armature=".028" range="-1 3" actuatorfrcrange="-5 4"/>
            <geom type="box" size=".1 .02 .03" pos=".1 0 0" mass="2"/>
            <body name="b" pos=".2 0 0"><joint name="k" axis="0 1 0"/><geom type="box" size=".1 .02 .03" pos=".1 0 0" mass="1"/></body>
        </body></worldbody>
        <actuator><position name="p" class="s" joint="j" gear="-3" inheritrange=".5"/>
            <general name="g" joint="k" biasprm="0 -5"/><position name="q" joint="k"/>
            <motor name="m" joint="k" ctrlrange="-1 1"/><velocity name="v" joint="k" kv="4"/>
            <position name="t" joint="k" tendon="x" kp="1" timeconst=".1"/></actuator></mujoco>"#,
    )
    .unwrap();
    assert_eq!(joint(&made, "j").actuator_range_nm, Some([-5.0, 4.0]));
    let servos = Tree::new(&made, TreeBase::Fixed).unwrap().servos(&made);
    let gains: Vec<f64> = servos.iter().map(|servo| servo.gain).collect();
    assert_eq!(gains, [20.0, 7.0, 7.0, 1.0, 4.0, 1.0]);
    near(servos[0].bias, &[0.0, -20.0, -0.5358618275414515]);
    for (servo, bias) in servos[1..].iter().zip([[0.0, -5.0, -0.4], [0.0, -7.0, -0.4], [0.0; 3], [0.0, 0.0, -4.0]]) {
        assert_eq!(servo.bias, bias, "{}", servo.name);
    }
    assert_eq!(servos.iter().map(|servo| servo.gear).collect::<Vec<_>>(), [-3.0, 2.0, 2.0, 2.0, 2.0, 2.0]);
    assert_eq!((servos[0].control_range, servos[3].control_range), (Some([0.0, 2.0]), Some([-1.0, 1.0])));
    assert_eq!(servos[5].activation.as_deref(), Some("timeconst=\".1\""));
}

#[test]
fn what_moves_joints_and_is_not_read_is_said() {
    let made = read(
        r#"<mujoco><worldbody><body name="a" gravcomp="1"><joint name="j"/><geom size=".1"/><body gravcomp="0"/></body></worldbody>
        <tendon><fixed name="quiet"><joint joint="j" coef="1"/></fixed><fixed name="stiff" stiffness="2"><joint joint="j" coef="1"/></fixed>
            <spatial name="cord"/></tendon>
        <equality><weld body1="a"/><joint name="e" joint1="j"/></equality>
        <actuator><motor name="m" tendon="quiet"/><muscle name="u" joint="j"/></actuator></mujoco>"#,
    )
    .unwrap();
    let said = made.left_out.join("\n");
    for part in [
        "\"stiff\"",
        "with stiffness",
        "\"cord\"",
        "equality weld closes a loop",
        "equality joint",
        "on a tendon",
        "muscle",
        "gravcomp=\"1\"",
    ] {
        assert!(said.contains(part), "{part} not in {said}");
    }
    assert_eq!(said.matches("gravcomp").count(), 1, "{said}");
    assert!(!said.contains("<fixed name=\"quiet\">"));
}

#[test]
fn a_joint_equality_is_left_out_and_said_or_held() {
    let text = |polycoef: &str| {
        format!(
            r#"<mujoco><compiler angle="radian"/><worldbody><body><joint name="a" axis="0 1 0" ref=".1"/>
            <geom size=".1" pos=".2 0 0"/><body><joint name="b" axis="0 1 0"/><geom size=".1"/></body></body></worldbody>
            <equality><joint joint1="b" joint2="a" polycoef="{polycoef}"/></equality></mujoco>"#
        )
    };
    let made = read(&text("0.3 -2 0 0 0")).unwrap();
    assert!(made.couplings.is_empty() && made.left_out[0].contains("an equality joint"), "{:?}", made.left_out);
    let held = made.with_equalities();
    assert!(held.left_out.is_empty() && held.equalities.is_empty());
    assert_eq!(Tree::new(&held, TreeBase::Fixed).unwrap().freedoms(), 1);
    let only = held.couplings[0];
    assert_eq!((only.follower, only.leader), (held.joint("b").unwrap(), held.joint("a").unwrap()));
    near([only.multiplier, only.offset_rad], &[-2.0, 0.5]);
    // Written and read back it is the same.
    let back = read(&to_mjcf(&held, &[])).unwrap().with_equalities();
    near([back.couplings[0].multiplier, back.couplings[0].offset_rad], &[-2.0, 0.5]);
    let curve = read(&text("0 1 0.5 0 0")).unwrap().with_equalities();
    assert!(curve.couplings.is_empty() && curve.left_out.len() == 1);
}

/// The inertia about the only joint, at its zero [kg m^2].
fn about_joint(before: &str, world: &str, after: &str) -> f64 {
    let text = format!("<mujoco>{before}<worldbody>{world}</worldbody>{after}</mujoco>");
    let made = read(&text).unwrap();
    let tree = Tree::new(&made, TreeBase::Fixed).unwrap();
    assert_eq!(tree.joints().len(), 1, "{text}");
    let mut matrix = DMatrix::zeros(1, 1);
    TreeDynamics::new(&tree).mass_matrix(&TreeState::drawn(&tree), &mut matrix);
    matrix[(0, 0)]
}

const J: &str = r#"<joint name="j" axis="0 1 0"/>"#;
const G: &str = r#"<geom size=".1" pos=".1 0 0" mass="1"/>"#;

#[test]
fn the_rotor_of_an_actuator_is_felt_through_its_gear() {
    let body = format!(r#"<body name="a">{J}{G}</body>"#);
    for kind in ["motor", "cylinder"] {
        let after = format!(r#"<actuator><{kind} joint="j" gear="3" armature=".5"/></actuator>"#);
        near([about_joint("", &body, &after)], &[4.514]);
    }
    let tendon = format!(
        r#"<mujoco><worldbody>{body}</worldbody><tendon><fixed name="t"><joint joint="j" coef="1"/></fixed></tendon>
        <actuator><motor tendon="t" armature=".5"/></actuator></mujoco>"#
    );
    assert!(read(&tendon).is_err_and(|error| error.to_string().contains("armature of an actuator")));
}

#[test]
fn what_weighs_nothing_says_nothing() {
    let stated = format!(
        r#"<body name="a">{J}<inertial pos="1 0 0" mass="3" diaginertia=".1 .1 .1"/><geom size=".1" mass="0"/></body>"#
    );
    near([about_joint(r#"<compiler inertiafromgeom="true"/>"#, &stated, "")], &[3.1]);
    let bound = r#"<compiler boundmass=".5" boundinertia=".01"/>"#;
    let empty = format!(r#"<body name="a" pos=".5 0 1">{J}<geom size=".1" mass="0"/></body>"#);
    near([about_joint(bound, &empty, "")], &[0.635]);
    let massless = format!(r#"<body name="a">{J}<inertial pos="1 0 0" mass="0" diaginertia=".1 .1 .1"/></body>"#);
    near([about_joint(bound, &massless, "")], &[0.6]);
    let fused =
        format!(r#"<body name="a">{J}{G}<body><inertial pos="0 0 0" mass="0" diaginertia=".1 .1 .1"/></body></body>"#);
    near([about_joint(r#"<compiler fusestatic="true"/>"#, &fused, "")], &[0.014]);
}

#[test]
fn a_thin_disc_is_a_body_and_a_height_field_is_not_weighed() {
    let disc = format!(r#"<body name="a">{J}<inertial pos=".3 0 0" mass="1" diaginertia=".1 .2 .1"/></body>"#);
    near([about_joint(r#"<compiler balanceinertia="true"/>"#, &disc, "")], &[0.29]);
    let field = |joint: &str| {
        read(&format!(
            r#"<mujoco><asset><hfield name="h" nrow="3" ncol="3" size="1 2 3 4"/></asset><worldbody>
            <body name="a">{joint}<geom type="hfield" hfield="h" mass="3"/></body><body>{J}{G}</body></worldbody></mujoco>"#
        ))
    };
    assert!(field(r#"<joint name="i"/>"#).is_err());
    // What stands moves nothing with its weight.
    let standing = field("").unwrap();
    assert!(standing.left_out.iter().any(|what| what.contains("stands still")));
    assert!(Tree::new(&standing, TreeBase::Free).is_err_and(|error| error.to_string().contains("stands still")));
}

#[test]
fn what_fusing_does_to_others_is_refused() {
    let aligned = r#"<compiler fusestatic="true" alignfree="true"/>"#;
    let world = format!(r#"<body name="a"><freejoint/><geom size=".1"/><body pos=".1 0 0">{G}</body></body>"#);
    assert!(read(&format!("<mujoco>{aligned}<worldbody>{world}</worldbody></mujoco>")).is_err());
    let total = |other: &str| {
        let world = format!(r#"<body name="a">{J}{G}</body><body {other}><geom size=".1" mass="1"/></body>"#);
        read(&format!(
            r#"<mujoco><compiler fusestatic="true" settotalmass="5"/><worldbody>{world}</worldbody></mujoco>"#
        ))
    };
    near([link(&total(r#"mocap="true""#).unwrap(), "a").inertia.mass_kg], &[2.5]);
    near([link(&total("").unwrap(), "a").inertia.mass_kg], &[5.0]);
    let part = r#"<body><inertial pos="0 0 0" mass="2" diaginertia=".1 .1 .1"/></body>"#;
    let weighed = |from: &str| {
        let world = format!(r#"<body name="a">{J}{G}{part}</body>"#);
        read(&format!(
            r#"<mujoco><compiler fusestatic="true" inertiafromgeom="{from}"/><worldbody>{world}</worldbody></mujoco>"#
        ))
    };
    assert!(weighed("true").is_err() && weighed("auto").is_ok());
    let carrier = |from: &str| {
        let stated = r#"<inertial pos=".1 .2 .3" mass="1" diaginertia="1 2 2.5"/>"#;
        let world = format!(r#"<body name="a">{J}{stated}<body>{G}</body></body>"#);
        read(&format!(
            r#"<mujoco><compiler fusestatic="true" inertiafromgeom="{from}"/><worldbody>{world}</worldbody></mujoco>"#
        ))
    };
    assert!(carrier("true").is_err() && carrier("auto").is_ok());
}

/// Masses by MuJoCo 4.0.0.
#[test]
fn what_others_name_is_not_fused() {
    let masses = |own: &str, inside: &str, after: &str| {
        let stands = format!(r#"<body name="s" {own}><geom size=".1" mass="5"/><site name="t"/>{inside}</body>"#);
        let world = format!(r#"{stands}<body name="a">{J}{G}</body>"#);
        let text = format!(r#"<mujoco><compiler fusestatic="true"/><worldbody>{world}</worldbody>{after}</mujoco>"#);
        read(&text).unwrap().total_mass_kg()
    };
    let fused =
        ["", r#"<sensor><gyro site="t"/></sensor>"#, r#"<sensor><framepos objtype="site" objname="t"/></sensor>"#];
    fused.iter().for_each(|after| near([masses("", "", after)], &[1.0]));
    let apart = [
        r#"<contact><exclude body1="a" body2="s"/></contact>"#,
        r#"<sensor><framepos objtype="xbody" objname="s"/></sensor>"#,
        r#"<sensor><force site="t"/></sensor>"#,
        r#"<sensor><subtreecom body="s"/></sensor>"#,
    ];
    apart.iter().for_each(|after| near([masses("", "", after)], &[6.0]));
    near([masses(r#"fuse="false""#, "", "")], &[6.0]);
    // What is fused to it is not fused to the world.
    let inside = r#"<body name="u"><geom size=".1" mass="7"/></body>"#;
    near([masses("", inside, apart[0])], &[13.0]);
    near([masses("", inside, r#"<contact><exclude body1="a" body2="u"/></contact>"#)], &[8.0]);
    let tensor = r#"<body name="p"><inertial pos="0 0 0" mass="0" diaginertia="1 1 1"/></body>"#;
    let named = r#"<contact><exclude body1="a" body2="p"/></contact>"#;
    let world = format!(r#"<body name="a">{J}{G}{tensor}</body>"#);
    near([about_joint(r#"<compiler fusestatic="true"/>"#, &world, named)], &[1.014]);
}

#[test]
fn no_name_is_invented_that_the_file_has_further_on() {
    let made = robot(
        "",
        r#"<body><joint/><geom size=".1"/><body name="body_1"><joint/><geom size=".1"/>
        <body name="c"><joint name="body_1_joint"/><geom size=".1"/></body></body></body>"#,
    );
    let names: Vec<&str> = made.joints.iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(made.links[0].name, "body_1_2");
    assert_eq!(names, ["body_1_2_joint", "body_1_joint_2", "body_1_joint"]);
}

#[test]
fn an_infinite_limit_is_none() {
    let limit = |range: &str| {
        let body = format!(r#"<body><joint name="j" range="{range}"/><geom size=".1"/></body>"#);
        joint(&robot(r#"<compiler angle="radian"/>"#, &body), "j").limit_rad
    };
    assert_eq!(limit("-inf inf"), None);
    assert_eq!(limit("-1 inf"), Some([-1.0, 1e9]));
    let nan = r#"<body><joint range="-1 nan"/><geom size=".1"/></body>"#;
    assert!(read(&format!("<mujoco><worldbody>{nan}</worldbody></mujoco>")).is_err());
}

#[test]
fn empty_replicas_of_replicas_end() {
    let many =
        r#"<replicate count="1000"><replicate count="200000"/></replicate><body><joint/><geom size=".1"/></body>"#;
    assert_eq!(robot("", many).links.len(), 1);
}

#[test]
fn a_long_quaternion_turns_as_a_short_one() {
    let turned = |quat: &str| {
        let inner = format!(r#"<body quat="{quat}"><geom size=".1" pos="0 0 1" mass="1"/></body>"#);
        about_joint("", &format!(r#"<body name="a">{J}{G}{inner}</body>"#), "")
    };
    near([turned("1e160 1e160 0 0")], &[turned("1 1 0 0")]);
}

#[test]
fn gains_of_one_kind_of_servo_are_no_defaults_of_another() {
    let made = |defaults: &str, actuator: &str| {
        let text = format!(
            r#"<mujoco><default>{defaults}</default><worldbody><body name="a">{J}{G}</body></worldbody>
            <actuator>{actuator}</actuator></mujoco>"#
        );
        let made = read(&text).unwrap();
        (made.actuators[0].gain, made.actuators[0].bias)
    };
    let [velocity, position] = [r#"<velocity kv="3"/>"#, r#"<position kp="20" kv="2"/>"#];
    assert_eq!(made(velocity, r#"<position joint="j" kp="7"/>"#), (7.0, [0.0, -7.0, 0.0]));
    assert_eq!(made(position, r#"<velocity joint="j"/>"#), (1.0, [0.0, 0.0, -1.0]));
    assert_eq!(made(position, r#"<position joint="j"/>"#), (20.0, [0.0, -20.0, -2.0]));
}

#[test]
fn an_actuators_damping_is_felt_through_its_gear() {
    let world = r#"<body><joint name="j" damping="1"/><geom size=".1"/></body>"#;
    let text = format!(
        r#"<mujoco><worldbody>{world}</worldbody><actuator><motor joint="j" gear="-2" damping=".3 .1 .05"/></actuator></mujoco>"#
    );
    let made = read(&text).unwrap();
    // MuJoCo 4.0.0: at 2 rad/s a joint without damping of its own feels -5.6 N m of it.
    near(joint(&made, "j").damping, &[2.2, 0.4, 0.2]);
    assert!(
        made.warnings.iter().any(|warning| warning.contains("its damping, behind its gear")),
        "{:?}",
        made.warnings
    );
}

#[test]
fn what_is_misspelt_or_not_read_is_said_once_at_its_place() {
    let text = r#"<mujoco><option gravty="0 0 0" density="1000"><flag actuation="disable" gravity="enable"/></option>
        <default><joint dampng="1"/><position kpp="3"/></default>
        <worldbody><frame eular="1 0 0"><body><joint name="j"/><inertial pos="0 0 0" mass="1" diaginerta="1 1 1"
        diaginertia="1 1 1"/></body></frame><body><joint name="k"/><geom size=".1" contype="0"/></body></worldbody>
        <actuator><position joint="j" kp="3" delay="0.01"/><pid joint="k"/></actuator></mujoco>"#;
    let made = read(text).unwrap();
    for word in
        ["`gravty`", "density is not read", "actuation=\"disable\"", "`dampng`", "`kpp`", "`eular`", "`diaginerta`"]
    {
        assert_eq!(
            made.warnings.iter().filter(|warning| warning.contains(word)).count(),
            1,
            "{word}: {:?}",
            made.warnings
        );
    }
    assert!(made.warnings.iter().any(|warning| warning.contains("its delay is not read")));
    assert!(made.left_out.iter().any(|told| told.contains("kind pid")), "{:?}", made.left_out);
    let honest = robot("", r#"<body name="p"><joint name="j" damping="1"/><geom size=".1" rgba="1 1 1 1"/></body>"#);
    assert_eq!(honest.warnings, [""; 0]);
}
