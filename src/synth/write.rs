//! Logs and studies as text. A study has what is believed, and nothing that the truth would show in.

use super::joint::Believed;
use super::plan::Plan;
use crate::geometry::robot_file::FRAME_S;
use crate::log::{
    Derivative, DescribedBeliefs, Hold, JointBeliefs, RobotScenario, RobotStudy, RobotStudyLog, Role, toml_key,
    toml_string,
};
use crate::robot::simulate::{Accelerometer, JointDrive, Joints, PositionSensor, Recording};
use crate::robot::{JointId, Model};
use rand::Rng;
use std::fmt::Write as _;

/// A log of all joints that have a controller. The motors' torques are not in it: no ERS-7 logs them, and a limit would
/// show in them.
pub(super) fn robot_log(
    model: &Model,
    joints: &Joints,
    recording: &Recording,
    plan: &Plan,
    has_base: bool,
    sensor: PositionSensor,
    rng: &mut impl Rng,
) -> String {
    let logged: Vec<JointId> = model.joint_ids().filter(|id| joints.drive(*id).chain.motor.is_some()).collect();
    let released =
        plan.entry.release.as_ref().and_then(|release| Some((model.joint(&release.joint).ok()?, release.time_s)));
    let mut text = String::from("t");
    for id in &logged {
        let name = &model.joints()[id.index()].name;
        let _ = write!(text, ",{name}.q,{name}.q_ref");
        if released.is_some_and(|(joint, _)| joint == *id) {
            let _ = write!(text, ",{name}.drive");
        }
    }
    let has_attitude = plan.asked.base.is_some();
    text.push_str(match (has_base, has_attitude) {
        (true, _) => ",base.x,base.y,base.z,base.roll,base.pitch,base.yaw,acc.x,acc.y,acc.z\n",
        (false, true) => ",base.roll,base.pitch,base.yaw\n",
        (false, false) => "\n",
    });
    let accelerometer = Accelerometer::default();
    for (k, t_s) in recording.t_s.iter().enumerate() {
        let _ = write!(text, "{t_s:.6}");
        for id in &logged {
            let j = id.index();
            let reading = sensor.read(joints.drive(*id).reading_rad(recording.angle_rad[j][k]), rng);
            let _ = write!(text, ",{:.7},{:.7}", reading + 0.0, recording.setpoint_rad[j][k]);
            if let Some((_, release_s)) = released.filter(|(joint, _)| joint == id) {
                let _ = write!(text, ",{}", u8::from(*t_s < release_s));
            }
        }
        let base = &recording.base[k];
        if has_base {
            let _ = base.position_m.iter().try_for_each(|x| write!(text, ",{x:.7}"));
        }
        if has_base || has_attitude {
            let _ = base.roll_pitch_yaw_rad().iter().try_for_each(|x| write!(text, ",{x:.9}"));
        }
        if has_base {
            let _ = accelerometer.read(&base.felt_m_s2).iter().try_for_each(|x| write!(text, ",{x:.7}"));
        }
        text.push('\n');
    }
    text
}

/// A log of the joint that is let go.
pub(super) fn joint_log(
    drive: &JointDrive,
    joint: JointId,
    recording: &Recording,
    plan: &Plan,
    sensor: PositionSensor,
    rng: &mut impl Rng,
) -> String {
    let release_s = plan.entry.release.as_ref().map_or(f64::INFINITY, |release| release.time_s);
    let mut text = String::from("t,q,drive\n");
    for (t_s, angle_rad) in recording.t_s.iter().zip(&recording.angle_rad[joint.index()]) {
        let reading = sensor.read(drive.reading_rad(*angle_rad), rng);
        let _ = writeln!(text, "{t_s:.6},{:.7},{}", reading + 0.0, u8::from(*t_s < release_s));
    }
    text
}

/// What a study says beyond a description.
fn described(text: &mut String, said: &DescribedBeliefs) {
    if !said.feet_m.is_empty() {
        text.push_str("[robot.feet]\n");
        for (link, radius_m) in &said.feet_m {
            let _ = writeln!(text, "{} = {radius_m:?}", toml_key(link));
        }
    }
    let all = std::iter::once(("default".to_owned(), &said.all));
    let own = said.by_joint.iter().map(|(name, beliefs)| (toml_key(name), beliefs));
    for (name, beliefs) in all.chain(own).filter(|(_, beliefs)| **beliefs != JointBeliefs::default()) {
        let _ = writeln!(text, "\n[joints.{name}]");
        let rows = [
            ("coulomb", beliefs.coulomb_nm),
            ("viscous", beliefs.viscous_nm_s_rad),
            ("armature", beliefs.armature_kg_m2),
            ("kp", beliefs.kp_nm_rad),
            ("kd", beliefs.kd_nm_s_rad),
            ("torque_limit", beliefs.torque_limit_nm),
        ];
        for (key, value) in rows {
            let _ = value.map(|value| writeln!(text, "{key} = {value:?}"));
        }
    }
}

/// The study of a robot; `model` stands in the place of the belief's own path.
pub(super) fn robot_study(study: &RobotStudy, model: &str, logs: &[RobotStudyLog]) -> String {
    let mut text = String::from("schema = 1\n\n[robot]\n");
    let _ = writeln!(text, "model = {}\nscenario = \"{}\"", toml_string(model), study.scenario.word());
    if study.scenario == RobotScenario::Floor {
        let _ = writeln!(text, "drop_height = {:?}", study.drop_height_m);
    }
    study.described.iter().for_each(|said| described(&mut text, said));
    let friction = [("coulomb", study.friction.coulomb_nm), ("viscous", study.friction.viscous_nm_s_rad)];
    if friction.iter().any(|(_, row)| row.is_some()) {
        text.push_str("\n[friction]\n");
        for (key, row) in friction {
            let _ = row.map(|row| writeln!(text, "{key} = {row:?}"));
        }
    }
    let control = &study.control;
    let hold = if control.hold == Hold::Step { "step" } else { "linear" };
    let derivative = if control.derivative == Derivative::Error { "error" } else { "measurement" };
    let _ = writeln!(text, "\n[control]\nhold = \"{hold}\"\nderivative = \"{derivative}\"");
    let _ = control.sample_period_s.map(|period_s| writeln!(text, "sample_period = {period_s:?}"));
    if !control.gains.is_empty() {
        text.push_str("[control.gains]\n");
        for (joint, row) in &control.gains {
            let _ = writeln!(text, "{} = {row:?}", toml_key(joint));
        }
    }
    if study.scenario == RobotScenario::Floor {
        text.push_str("\n[floor]\n");
        let (f, said) = (crate::robot::study::floor_of(&study.floor), &study.floor);
        for (key, value, said) in [
            ("stiffness", f.stiffness_n_m, said.stiffness_n_m),
            ("damping", f.damping_n_s_m2, said.damping_n_s_m2),
            ("exponent", f.exponent, said.exponent),
            ("static", f.static_friction, said.static_friction),
            ("coulomb", f.coulomb, said.coulomb),
            ("viscous", f.viscous_s_m, said.viscous_s_m),
            ("steepness", f.steepness_s_m, said.steepness_s_m),
            ("stribeck_speed", f.stribeck_speed_m_s, said.stribeck_speed_m_s),
            ("torsion_radius", f.torsion_radius_m, said.torsion_radius_m),
        ] {
            // What a study does not say of a described robot's floor, its description may.
            if said.is_some() || study.described.is_none() {
                let _ = writeln!(text, "{key} = {value:?}");
            }
        }
    }
    sensor(&mut text, study);
    let _ = study.sensor.noise_rad.map(|noise| writeln!(text, "noise = {noise:?}"));
    for log in logs {
        entry(&mut text, log);
        if let Some(release) = &log.release {
            let _ = writeln!(text, "released = {}\nrelease_time = {:?}", toml_string(&release.joint), release.time_s);
        }
        if let Some(f) = &log.forward {
            let _ = writeln!(
                text,
                "forward = {:.3}\nforward_from = {:?}\nforward_to = {:?}",
                f.distance_m, f.from_s, f.to_s
            );
        }
        extra(&mut text, log);
    }
    text
}

/// The study of a joint.
pub(super) fn joint_study(believed: &Believed, study: &RobotStudy, logs: &[RobotStudyLog]) -> String {
    let n = &believed.nominal;
    let mut text = format!("schema = 1\n\n[joint]\nname = {}\n", toml_string(&believed.kind));
    let _ = writeln!(text, "inertia = {:?}\nmoment = {:?}", n.inertia_kg_m2, n.moment_kg_m);
    let _ = writeln!(text, "coulomb = {:?}\nviscous = {:?}", n.coulomb_nm, n.viscous_nm_s_rad);
    let _ = writeln!(text, "gravity = {:?}\nrest = {:?}", believed.gravity_m_s2, believed.rest_rad);
    sensor(&mut text, study);
    for log in logs {
        entry(&mut text, log);
        text.push_str("drive = \"off\"\n");
        extra(&mut text, log);
    }
    text
}

fn sensor(text: &mut String, study: &RobotStudy) {
    text.push_str("\n[sensor]\n");
    let _ = study.sensor.resolution_rad.map(|step| writeln!(text, "resolution = {step:?}"));
    let _ = writeln!(text, "period = {:?}", study.sensor.period_s.unwrap_or(FRAME_S));
}

fn entry(text: &mut String, log: &RobotStudyLog) {
    let role = if log.role == Role::Fit { "fit" } else { "validate" };
    let _ = writeln!(text, "\n[[log]]\nfile = {}\nrole = \"{role}\"", toml_string(&log.file));
}

fn extra(text: &mut String, log: &RobotStudyLog) {
    let Some(e) = &log.extra else { return };
    let _ = writeln!(text, "[log.extra]\nmass = {:?}\ndistance = {:?}", e.mass_kg, e.distance_m);
    let _ = writeln!(text, "radius = {:?}\nlength = {:?}", e.radius_m, e.length_m);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::{ControlSpec, FloorSpec, LegFrictionSpec, Nominal, RobotRelease, RobotSensorSpec};

    #[test]
    fn a_name_with_quotes_and_backslashes_is_read_back() {
        let log = RobotStudyLog {
            file: r#"swing "one"\two.csv"#.into(),
            path: "swing.csv".into(),
            role: Role::Fit,
            release: Some(RobotRelease { joint: r#"l"f\2"#.into(), time_s: 0.5 }),
            extra: None,
            forward: None,
        };
        let mut text = String::new();
        entry(&mut text, &log);
        let read: toml::Table = toml::from_str(&text).expect("TOML");
        assert_eq!(read["log"][0]["file"].as_str(), Some(log.file.as_str()));
        let nominal = Nominal { inertia_kg_m2: 1e-3, moment_kg_m: 5e-3, coulomb_nm: 0.0, viscous_nm_s_rad: 0.0 };
        let believed = Believed { nominal, gravity_m_s2: 9.81, rest_rad: 0.0, kind: r#"q"2\"#.into() };
        let study = RobotStudy {
            uncertain: crate::log::Uncertain::default(),
            columns: crate::log::Columns::default(),
            file: "study.toml".into(),
            model: "ers7".into(),
            model_path: None,
            described: None,
            scenario: RobotScenario::Drop,
            drop_height_m: 0.0,
            friction: LegFrictionSpec::default(),
            control: ControlSpec {
                gains: [(r#"l"f\2"#.to_owned(), [1.0, 0.0, 0.1])].into(),
                hold: Hold::Step,
                sample_period_s: None,
                derivative: Derivative::Error,
            },
            floor: FloorSpec::default(),
            sensor: RobotSensorSpec::default(),
            logs: Vec::new(),
        };
        let text = joint_study(&believed, &study, &[]);
        assert_eq!(toml::from_str::<toml::Table>(&text).expect("TOML")["joint"]["name"].as_str(), Some(r#"q"2\"#));
        let text = robot_study(&study, r#"my "robot".toml"#, std::slice::from_ref(&log));
        let read: toml::Table = toml::from_str(&text).expect("TOML");
        assert_eq!(read["robot"]["model"].as_str(), Some(r#"my "robot".toml"#));
        assert_eq!(read["log"][0]["released"].as_str(), Some(r#"l"f\2"#));
        assert!(read["control"]["gains"].as_table().expect("gains").contains_key(r#"l"f\2"#), "{text}");
    }
}
