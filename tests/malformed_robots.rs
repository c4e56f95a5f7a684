//! Broken descriptions: one clear error each, bounded time and memory, no panic.

use aibo_fit::robot::description::Description;
use aibo_fit::robot::tree::{Tree, TreeBase, TreeDynamics, TreeState};
use nalgebra::DMatrix;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::fs;
use std::path::Path;

const URDF: &str = r#"<robot name="p"><link name="base"/>
<link name="rod"><inertial><origin xyz="0 0 -.5" rpy="0 .1 0"/><mass value="2"/><inertia ixx=".1" iyy=".1" izz=".01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="revolute"><origin xyz="0 0 1"/><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<link name="tip"/><joint name="k" type="prismatic"><parent link="rod"/><child link="tip"/><axis xyz="0 0 2"/><limit lower="-1" upper="1"/><mimic joint="j" multiplier=".1"/></joint>
</robot>"#;

const MJCF: &str = r#"<mujoco model="m"><compiler angle="radian" eulerseq="zyx"/>
<default><joint armature=".1"/><default class="c"><geom type="capsule" size=".02" fromto="0 0 0 0 0 .3"/></default></default>
<worldbody><geom type="plane" size="1 1 1"/><body name="a" pos="0 0 1" euler=".1 0 .2"><freejoint/><geom size=".1" mass="2"/>
<frame pos="0 .1 0"><body name="b" childclass="c"><joint name="h" axis="0 1 0" range="-1 1"/><geom/>
<replicate count="2" offset="0 .1 0"><body name="r"><joint name="s" type="slide"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></replicate>
</body></frame></body></worldbody>
<actuator><position joint="h" kp="20" dampratio="1"/></actuator></mujoco>"#;

/// Reads a text as a file; what can be read is also evaluated.
fn read(folder: &Path, text: &[u8]) -> Result<Description, String> {
    let file = folder.join("robot.xml");
    fs::write(&file, text).unwrap();
    let description = Description::read(&file).map_err(|error| error.to_string())?;
    for base in [TreeBase::Fixed, TreeBase::Free] {
        let Ok(tree) = Tree::new(&description, base) else { continue };
        let (n, state) = (tree.freedoms(), TreeState::drawn(&tree));
        if n > 100 {
            continue;
        }
        let (mut dynamics, mut v_dot) = (TreeDynamics::new(&tree), vec![0.0; n]);
        dynamics.mass_matrix(&state, &mut DMatrix::zeros(n, n));
        let _ = dynamics.forward(&state, &vec![0.0; n], &mut v_dot);
        tree.servos(&description);
    }
    Ok(description)
}

fn refused(text: &str, parts: &[&str]) {
    let folder = tempfile::tempdir().unwrap();
    let error = read(folder.path(), text.as_bytes()).err().unwrap_or_else(|| panic!("accepted: {text}"));
    for part in [&["robot.xml"], parts].concat() {
        assert!(error.contains(part), "`{part}` not in: {error}");
    }
}

/// The file with one thing changed.
fn changed(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1)
}

#[test]
fn a_wrong_urdf_is_refused_with_line_and_name() {
    let cases: &[(&str, &str, &[&str])] = &[
        ("value=\"2\"", "value=\"two\"", &["line 2", "<mass>", "\"two\"", "finite numbers"]),
        ("value=\"2\"", "value=\"nan\"", &["line 2", "\"nan\""]),
        ("value=\"2\"", "value=\"1e999\"", &["line 2", "\"1e999\""]),
        ("value=\"2\"", "value=\"-2\"", &["line 2", "not below 0", "rod"]),
        ("value=\"2\"", "valu=\"2\"", &["line 2", "<mass>: value: found nothing"]),
        ("<mass value=\"2\"/>", "", &["line 2", "<mass> is missing", "rod"]),
        ("ixx=", "ixX=", &["line 2", "ixx: found nothing", "rod"]),
        ("0 0 -.5", "0 0", &["line 2", "xyz", "expected 3 numbers"]),
        ("0 0 -.5", "0,0,-.5", &["line 2", "blanks between"]),
        ("xyz=\"0 1 0\"", "xyz=\"0 0 0\"", &["line 3", "axis", "\"j\"", "not zero"]),
        ("\"revolute\"", "\"revolut\"", &["line 3", "\"revolut\"", "expected revolute"]),
        ("\"revolute\"", "\"floating\"", &["line 3", "a floating joint", "not supported"]),
        ("\"revolute\"", "\"planar\"", &["line 3", "a planar joint", "not supported"]),
        ("\"revolute\"", "\"spherical\"", &["a spherical joint", "not supported"]),
        ("child link=\"rod\"", "child link=\"rot\"", &["line 3", "the child link \"rot\" is not in the file"]),
        ("parent link=\"base\"", "parent link=\"tip\"", &["line 2", "\"rod\"", "the joints go round in a circle"]),
        ("<child link=\"rod\"/>", "", &["line 3", "<child link=\"...\"> is missing"]),
        ("<link name=\"tip\"/>", "", &["line 4", "\"tip\" is not in the file"]),
        ("<link name=\"tip\"/>", "<link name=\"tip\"/><link name=\"more\"/>", &["2 links have no parent (base, more)"]),
        ("<link name=\"tip\"/>", "<link name=\"tip\"/><link name=\"rod\"/>", &["a second link of this name"]),
        ("name=\"k\"", "name=\"j\"", &["line 4", "a second joint of this name"]),
        ("mimic joint=\"j\"", "mimic joint=\"x\"", &["line 4", "<mimic>: the joint \"x\" is not in the file"]),
        ("mimic joint=\"j\"", "mimic joint=\"k\"", &["line 4", "<mimic> goes round in a circle"]),
        ("value=\"2\"", "value=\"${m}\"", &["line 2", "xacro", "xacro FILE > robot.urdf"]),
        ("<link name=\"tip\"/>", "<xacro:tip/><link name=\"tip\"/>", &["line 4", "xacro:tip", "xacro FILE"]),
        ("<mass value=\"2\"/>", "<mass value=2/>", &["line 2", "not well-formed XML"]),
        ("<robot", "<!DOCTYPE r [<!ENTITY a \"aa\"><!ENTITY b \"&a;&a;\">]><robot", &["DTD"]),
    ];
    for (from, to, parts) in cases {
        refused(&changed(URDF, from, to), parts);
    }
    let circle = changed(URDF, "<parent link=\"base\"/>", "<parent link=\"tip\"/>");
    refused(&changed(&circle, "<link name=\"base\"/>", ""), &["joints go round in a circle"]);
    refused("<robot name=\"x\"/>", &["no <link>"]);
    refused("<sdf version=\"1.7\"/>", &["SDF"]);
    refused("<html/>", &["<html>", "expected <robot>"]);
    refused("<robot", &["robot.xml"]);
}

#[test]
fn a_wrong_mjcf_is_refused_with_line_and_name() {
    let cases: &[(&str, &str, &[&str])] = &[
        ("angle=\"radian\"", "angle=\"grad\"", &["line 1", "<compiler>: angle", "degree, radian"]),
        ("eulerseq=\"zyx\"", "eulerseq=\"zy\"", &["line 1", "eulerseq"]),
        ("angle=\"radian\"", "coordinate=\"global\"", &["coordinate=\"global\" is not supported"]),
        ("class=\"c\"", "", &["line 2", "`class` is missing"]),
        ("childclass=\"c\"", "childclass=\"d\"", &["line 4", "childclass: found \"d\"", "<default>"]),
        ("<freejoint/>", "<joint type=\"ball\"/>", &["line 3", "ball joint", "not supported"]),
        ("<freejoint/>", "<freejoint/><joint/>", &["line 3", "only joint of its body"]),
        ("<joint name=\"h\"", "<freejoint/><joint name=\"h\"", &["line 4", "nested"]),
        ("</worldbody>", "<body><freejoint/><geom size=\"1\"/></body></worldbody>", &["a second free body"]),
        ("<frame", "<composite/><frame", &["<composite>", "not supported"]),
        ("<frame", "<flexcomp/><frame", &["<flexcomp>", "not supported"]),
        ("<frame", "<attach/><frame", &["<attach>", "not supported"]),
        ("<frame", "<plugin/><frame", &["<plugin>", "not supported"]),
        ("<frame", "<bdy/><frame", &["<bdy>", "not supported"]),
        ("size=\".1\" mass=\"2\"", "type=\"mesh\" mesh=\"x\"", &["line 3", "<body name=\"a\">", "mesh", "<inertial>"]),
        ("size=\".1\" mass=\"2\"", "size=\"0\" mass=\"2\"", &["line 3", "size", "above 0"]),
        ("mass=\"2\"", "mass=\"-2\"", &["line 3", "mass", "not below 0"]),
        ("axis=\"0 1 0\"", "axis=\"0 0 0\"", &["line 4", "axis", "not zero"]),
        ("axis=\"0 1 0\"", "axis=\"0 1\"", &["line 4", "axis", "3 numbers"]),
        ("range=\"-1 1\"", "limited=\"true\"", &["line 4", "range", "limited=\"true\""]),
        ("euler=\".1 0 .2\"", "euler=\".1 0 .2\" quat=\"1 0 0 0\"", &["line 3", "one orientation, found quat, euler"]),
        ("euler=\".1 0 .2\"", "quat=\"0 0 0 0\"", &["line 3", "not zero"]),
        ("count=\"2\"", "count=\"-2\"", &["line 5", "count"]),
        ("count=\"2\"", "count=\"1.5\"", &["line 5", "count"]),
        ("joint=\"h\"", "joint=\"x\"", &["line 7", "\"x\"", "the name of a joint"]),
        ("pos=\"0 0 0\" mass=\"1\"", "mass=\"1\"", &["line 5", "<inertial>: pos"]),
        ("diaginertia=\"1 1 1\"", "fullinertia=\"1 1 1 0 0 0\" euler=\"0 0 1\"", &["fullinertia", "orientation"]),
        ("name=\"b\"", "name=\"a\"", &["line 4", "a second body of this name"]),
        ("<worldbody>", "<worldbody><joint/>", &["line 3", "the world does not move"]),
        ("<worldbody>", "<body/><worldbody>", &["line 3", "outside of <worldbody>"]),
        ("<actuator>", "<deformable><flex/></deformable><actuator>", &["<flex>", "not supported"]),
        ("<actuator>", "<tendon><fixed armature=\"1\"/></tendon><actuator>", &["tendon with armature"]),
        ("<compiler", "<include file=\"no.xml\"/><compiler", &["line 1", "no.xml", "could not be read"]),
        ("<compiler", "<include file=\"robot.xml\"/><compiler", &["line 1", "included twice, or includes itself"]),
    ];
    for (from, to, parts) in cases {
        refused(&changed(MJCF, from, to), parts);
    }
    refused("<mujoco/>", &["no <body>"]);
    refused("<mujocoinclude/>", &["give the file that does"]);
}

#[test]
fn both_files_are_good_as_they_are() {
    let folder = tempfile::tempdir().unwrap();
    for text in [URDF, MJCF] {
        let read = read(folder.path(), text.as_bytes()).unwrap();
        assert_eq!((read.warnings, read.left_out), (vec![], vec![]));
    }
}

#[test]
fn files_that_grow_are_bounded() {
    let bomb = "<replicate count=\"1000\">".repeat(5) + "<body/>" + &"</replicate>".repeat(5);
    refused(&changed(MJCF, "<frame", &format!("{bomb}<frame")), &["replicas make more than"]);
    let deep = "<body>".repeat(20_000) + &"</body>".repeat(20_000);
    refused(&format!("<mujoco><worldbody>{deep}</worldbody></mujoco>"), &["more than 400 deep"]);
    let links: String = (0..5000).map(|k| format!("<link name=\"l{k}\"/>")).collect();
    refused(&format!("<robot name=\"x\">{links}</robot>"), &["5000 links, expected at most 4000"]);
    let chain = |k: usize| {
        let above = k.saturating_sub(1);
        format!(
            "<link name=\"l{k}\"/><joint name=\"j{k}\" type=\"continuous\"><parent link=\"l{above}\"/><child link=\"l{k}\"/></joint>"
        )
    };
    let links: String = (1..1500).map(chain).collect();
    refused(&format!("<robot name=\"x\"><link name=\"l0\"/>{links}</robot>"), &["1499 joints, expected at most 1000"]);
    // Includes that include each other.
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.xml"), "<mujoco><include file=\"b.xml\"/></mujoco>").unwrap();
    fs::write(folder.path().join("b.xml"), "<mujoco><include file=\"a.xml\"/></mujoco>").unwrap();
    let error = read(folder.path(), b"<mujoco><include file=\"a.xml\"/></mujoco>").unwrap_err();
    assert!(error.contains("b.xml: line 1") && error.contains("includes itself"), "{error}");
}

#[test]
fn a_file_cut_anywhere_or_spoilt_is_refused_or_read_but_never_panics() {
    let folder = tempfile::tempdir().unwrap();
    for text in [URDF, MJCF] {
        for end in (0..text.len()).step_by(3) {
            assert!(read(folder.path(), &text.as_bytes()[..end]).is_err(), "cut at {end}");
        }
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        for _ in 0..2000 {
            let mut bytes = text.as_bytes().to_vec();
            for _ in 0..rng.random_range(1..4) {
                let at = rng.random_range(0..bytes.len());
                bytes[at] = *b"0123456789-.eE \"<>/=xZ\xff\0".get(rng.random_range(0..24)).unwrap_or(&b' ');
            }
            let _ = read(folder.path(), &bytes);
        }
    }
}
