//! What a robot file may not be, and that the embedded one is as printed.

use super::*;

const ERS7: &str = include_str!("../../../data/ers7.toml");

fn ers7() -> RobotTables {
    RobotTables::from_toml(Path::new("ers7.toml"), ERS7).unwrap()
}

/// Each row: what is replaced (first occurrence), by what, the key that the error names, what else it says.
const WRONG: &[(&str, &str, &str, &str)] = &[
    ("schema = 1", "schema = 2", "`schema`", "found 2, expected 1"),
    ("root = \"trunk\"", "root = \"torso\"", "`root`", "the name of a [[part]]"),
    ("base = \"floating\"", "base = \"flying\"", "`base`", "\"floating\" or \"clamped\""),
    ("-9.81, 0.0]", "-9810.0, 0.0]", "`gravity_m_s2`", "within 1e3 m/s^2"),
    ("mass_kg = 0.9132", "mass_kg = -1.0", "`[[part]] trunk mass_kg`", "found -1, expected a number not below 0"),
    ("mass_kg = 0.9132", "mass_kg = nan", "`[[part]] trunk mass_kg`", "found NaN"),
    ("mass_kg = 0.02", "mass_kg = 0.0", "`[[part]] mouth mass_kg`", "nothing hangs on this part"),
    (
        "[0.0993, 0.1141, 0.226]",
        "[0.0993, 0.0, 0.226]",
        "`[[part]] trunk diameter_m`",
        "found 0, expected a number above",
    ),
    (
        "[2.93e-3, 2.78e-3, 1.04e-3]",
        "[2.93e-3, 1.0e-3, 1.04e-3]",
        "`[[part]] trunk inertia_kg_m2`",
        "none exceeds the sum",
    ),
    ("name = \"neck\"", "name = \"trunk\"", "`[[part]] name`", "a name that no other has"),
    ("name = \"lf2\"", "name = \"lf1\"", "`[[joint]] name`", "found \"lf1\", expected a name that no other has"),
    (
        "parent = \"head\"",
        "parent = \"hat\"",
        "`[[joint]] mouth parent`",
        "found \"hat\", expected the name of a [[part]]",
    ),
    ("child = \"lf_upper\"", "child = \"lf_uper\"", "`[[joint]] lf2 child`", "the name of a [[part]]"),
    ("parent = \"lf_shoulder\"", "parent = \"head\"", "`[[joint]] lf2 parent`", "put this joint after neck_tilt2"),
    (
        "parent = \"lf_shoulder\"",
        "parent = \"lf_lower\"",
        "`[[joint]] lf2 parent`",
        "lf_lower on lf_upper on lf_lower is a loop",
    ),
    ("parent = \"lf_shoulder\"", "parent = \"lf_upper\"", "`[[joint]] lf2 child`", "another part than the parent"),
    (
        "child = \"rf_upper\"",
        "child = \"lf_lower\"",
        "`[[joint]] rf2 child`",
        "lf3 moves it already: this closes a loop",
    ),
    ("child = \"mouth\"", "child = \"trunk\"", "`[[joint]] mouth child`", "closes a loop"),
    (
        "axis = \"x\"",
        "axis = \"w\"",
        "`[[joint]] lf1 axis`",
        "found \"w\", expected \"x\", \"y\", \"z\" or a vector of length 1",
    ),
    ("axis = \"x\"", "axis = [1.0, 1.0, 0.0]", "`[[joint]] lf1 axis`", "of length 1.4142"),
    ("axis = \"x\"", "axis = 3", "", "a unit vector such as [0.6, 0.0, 0.8]"),
    ("sign = 1", "sign = 0", "`[[joint]] lf1 sign`", "found 0, expected 1 or -1"),
    ("phi_deg = [0.0, 0.0, 0.0]", "phi_deg = [400.0, 0.0, 0.0]", "`[[joint]] lf1 phi_deg`", "within 360 degrees"),
    ("[-2.0944, 2.3562]", "[2.3562, -2.0944]", "`[[joint]] lf1 hardware_rad`", "the least below the greatest"),
    ("[-2.0944, 2.3562]", "[-120.0, 135.0]", "`[[joint]] lf1 hardware_rad`", "looks like degrees"),
    ("[-2.0071, 2.2689]", "[-2.7053, 2.2689]", "`[[joint]] lf1 software_rad`", "within hardware_rad"),
    ("speed_rad_s = 4.865", "speed_rad_s = 0", "`[[joint]] lf1 speed_rad_s`", "a number above 0"),
    (
        "stiffness_nm_rad = 0.01",
        "stiffness_nm_rad = -1.0",
        "`[[joint]] ear_l_tilt spring.stiffness_nm_rad`",
        "not below 0",
    ),
    (
        "joints = [\"q1\", \"q2\", \"q3\"]",
        "joints = [\"q1\", \"q2\", \"q4\"]",
        "`[friction.estimated] joints`",
        "found \"q4\"",
    ),
    (
        "coulomb_nm = [0.001, 0.007, 0.020]",
        "coulomb_nm = [0.001]",
        "`[friction.estimated] coulomb_nm`",
        "1 values, expected 3",
    ),
    (
        "viscous_nm_s_rad = [0.017",
        "viscous_nm_s_rad = [-0.017",
        "`[friction.estimated] viscous_nm_s_rad`",
        "not below 0",
    ),
    ("shift = [14, 2, 15]", "shift = [14, 2, 17]", "`[gains.printed] shift`", "three shifts s from 0 to 16"),
    ("q1 = [20, 4, 1]", "q1 = [-20, 4, 1]", "`[gains.printed.g] q1`", "three integers g from 0 to 65535"),
    ("q1 = [20, 4, 1]", "q1 = [2.5, 4, 1]", "", "floating point"),
    ("q1 = [20, 4, 1]", "hip = [20, 4, 1]", "`[gains.printed.g] hip`", "the name or kind of a [[joint]]"),
    (
        "name = \"ers7\"",
        "name = \"ers7\"\nfloor_slope_rad = [9.0, 0.0]",
        "`floor_slope_rad`",
        "an angle within 1.2 rad",
    ),
    (
        "[encoder]",
        "[[attached]]\npart = \"hat\"\nmass_kg = 0.1\nat_m = [0.0, 0.0, 0.0]\n[encoder]",
        "`[[attached]] part`",
        "the name of a [[part]]",
    ),
    (
        "[encoder]",
        "[[effect]]\nid = \"delay\"\njoints = [\"q9\"]\nparameters = { T = 0.01 }\n[encoder]",
        "`[[effect]] delay joints`",
        "the name or kind of a [[joint]]",
    ),
    ("[encoder]", "[floor]\nstiffness = -1.0\n[encoder]", "`[floor] stiffness`", "above 0"),
    ("[encoder]", "[gains.printed.si]\nq1 = [-1.0, 0.0, 0.0]\n[encoder]", "`[gains.printed.si] q1`", "not below 0"),
    ("period_s = 0.008", "period_s = 0.0", "`[encoder] period_s`", "above 0"),
    ("range = [0.05, 0.5]", "range = [0.5, 0.05]", "`[[sensor]] head_ir_near range`", "the least below the greatest"),
    ("mass_kg = 0.9132", "mass_kg = 0.9132\ncolour = 1", "", "unknown field `colour`"),
    ("mass_kg = 0.9132", "", "", "missing field `mass_kg`"),
];

#[test]
fn a_wrong_robot_file_names_file_line_key_and_what_was_expected() {
    for (from, to, key, says) in WRONG {
        let at = ERS7.find(from).unwrap_or_else(|| panic!("{from} is in the file"));
        let text = ERS7.replacen(from, to, 1);
        let message = RobotTables::from_toml(Path::new("mine.toml"), &text).unwrap_err().to_string();
        assert!(message.starts_with("mine.toml"), "{from} -> {to}: {message}");
        assert!(message.contains(key) && message.contains(says), "{from} -> {to}: {message}");
        assert!(message.contains("line "), "{from} -> {to}: {message}");
        if !message.contains("missing field") && !says.contains("name that no other") && !says.contains("after neck") {
            let line = ERS7[..at].matches('\n').count() + 1;
            let near = (line..line + 6).any(|line| message.contains(&format!("line {line}")));
            assert!(near, "{from} -> {to} is at line {line}: {message}");
        }
    }
}

#[test]
fn table_a_3_as_printed_but_for_the_misprint() {
    let joints = ers7().joints;
    let named = |name: &str| joints.iter().find(|joint| joint.name == name).unwrap();
    assert_eq!(named("lf1").hardware_rad, Some([-2.0944, 2.3562]));
    assert_eq!(named("rr1").software_rad, Some([-2.2689, 2.0071]));
    assert_eq!(named("rf1").software_rad, named("lf1").software_rad);
    assert_eq!(named("neck_pan").speed_rad_s, Some(10.057));
    assert_eq!(named("mouth").hardware_rad, named("mouth").software_rad);
    assert_eq!((named("ear_l_pan").software_rad, named("ear_l_pan").speed_rad_s), (None, None));
    assert!(joints.iter().all(|joint| joint.spring.is_some() == joint.name.starts_with("ear")));
}

#[test]
fn table_b_1_and_the_position_sensor() {
    let tables = ers7();
    assert_eq!(tables.sensors.len(), 11);
    assert_eq!(tables.sensors[0].range, Some([50_000e-6, 500_000e-6]));
    let encoder = tables.encoder.unwrap();
    assert_eq!((encoder.resolution_rad, encoder.variation_rad, encoder.period_s), (0.006, 0.012, 0.008));
}
