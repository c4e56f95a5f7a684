//! What is asked of the true robot in each log.

use super::error::{Blame, SynthError};
use super::joint;
use super::spec::{Believed, ExtraSpec, LogSpec, Spec};
use crate::log::{BaseColumns, ExtraMass, JointColumns, RobotLog, RobotRelease, RobotScenario, RobotStudyLog, Role};
use crate::robot::simulate::{BaseSample, Column, Setpoints};
use crate::robot::{Gait, Model, Motion};
use nalgebra::{UnitQuaternion, Vector3};
use std::collections::BTreeMap;
use std::path::Path;

/// One log to make: the entry of the study, and what the robot is asked, as a log without readings.
pub(super) struct Plan {
    pub entry: RobotStudyLog,
    pub asked: RobotLog,
    /// Times between which the trunk's displacement is measured \[s\].
    pub forward_s: Option<[f64; 2]>,
}

const DROP_S: f64 = 4.0;
const RELEASE_S: f64 = 0.5;
const FASTEST_HZ: f64 = 50.0;

/// Plans every log.
pub(super) fn plans(spec: &Spec, model: &Model, period_s: f64) -> Result<Vec<Plan>, SynthError> {
    let blame = Blame { file: &spec.file };
    if spec.logs.is_empty() {
        return Err(blame.value("[[log]]", "no log", "at least one"));
    }
    let mut plans: Vec<Plan> = Vec::with_capacity(spec.logs.len());
    for (k, log) in spec.logs.iter().enumerate() {
        let of = Of { blame: &blame, table: format!("[[log]] {}", k + 1), log, model, period_s };
        let file = of.file(plans.iter().map(|plan| plan.entry.file.as_str()))?;
        let role = of.role()?;
        of.refuse([("session", log.session.is_some())], "any scenario but \"fixed\"")?;
        plans.push(match &spec.believed {
            Believed::Robot(study) if study.scenario == RobotScenario::Drop => {
                let released = log.released.clone();
                let released = released.ok_or_else(|| of.wrong("released", "nothing", "the joint that is let go"))?;
                of.refuse([("angle", log.angle.is_some())], "scenario = \"drop\", which has `angles`")?;
                of.drop(file, role, &released, &log.angles, log.gravity)?
            }
            Believed::Robot(study) => of.driven(&spec.file, file, role, study.scenario)?,
            Believed::Joint(_, bench) => {
                let keys = [
                    ("released", log.released.is_some()),
                    ("angles", !log.angles.is_empty()),
                    ("gravity", log.gravity.is_some()),
                ];
                of.refuse(keys, "[joint], which states it for all logs")?;
                let angles = joint::angles(&blame, bench, log.angle, &of.table)?;
                of.drop(file, role, &bench.name, &angles, bench.gravity)?
            }
        });
    }
    if plans.iter().all(|plan| plan.entry.role == Role::Validate) {
        return Err(blame.value("[[log]] role", "\"validate\" only", "at least one log with role = \"fit\""));
    }
    Ok(plans)
}

pub(super) struct Of<'a> {
    pub blame: &'a Blame<'a>,
    pub table: String,
    pub log: &'a LogSpec,
    pub model: &'a Model,
    pub period_s: f64,
}

impl Of<'_> {
    pub(super) fn key(&self, name: &str) -> String {
        format!("{} {name}", self.table)
    }

    pub(super) fn wrong(&self, name: &str, found: impl ToString, expected: impl ToString) -> SynthError {
        self.blame.value(&self.key(name), found, expected)
    }

    /// Keys that do not belong here.
    pub(super) fn refuse<'k>(
        &self,
        keys: impl IntoIterator<Item = (&'k str, bool)>,
        place: &str,
    ) -> Result<(), SynthError> {
        match keys.into_iter().find(|(_, stated)| *stated) {
            Some((name, _)) => Err(self.wrong(name, "it", format!("nothing: it does not go with {place}"))),
            None => Ok(()),
        }
    }

    pub(super) fn role(&self) -> Result<Role, SynthError> {
        match self.log.role.as_deref() {
            None | Some("fit") => Ok(Role::Fit),
            Some("validate") => Ok(Role::Validate),
            Some(other) => Err(self.wrong("role", format!("\"{other}\""), "\"fit\" or \"validate\"")),
        }
    }

    pub(super) fn file<'b>(&self, mut others: impl Iterator<Item = &'b str>) -> Result<String, SynthError> {
        let file = &self.log.file;
        let is_name = Path::new(file).file_name().is_some_and(|name| name == file.as_str())
            && file.ends_with(".csv")
            && !file.contains(['"', '\\', '/', '\n']);
        if !is_name || others.any(|other| other == file) {
            return Err(self.wrong(
                "file",
                format!("\"{file}\""),
                "a name such as \"log-00.csv\" that no other log has",
            ));
        }
        Ok(file.clone())
    }

    /// A gait or a table of setpoints, in the air or on the floor.
    fn driven(&self, spec: &Path, file: String, role: Role, scenario: RobotScenario) -> Result<Plan, SynthError> {
        let log = self.log;
        self.refuse(log.of_a_drop(), &format!("scenario = \"{}\"", scenario.word()))?;
        let setpoints = self.setpoints(spec.parent().unwrap_or(Path::new("")), scenario)?;
        let end_s = setpoints.t_s.last().copied().unwrap_or(0.0);
        if let Some([from_s, to_s]) = log.forward {
            if scenario != RobotScenario::Floor {
                return Err(self.wrong("forward", "it", "it with scenario = \"floor\" only"));
            }
            if !(setpoints.t_s[0] <= from_s && from_s < to_s && to_s <= end_s) {
                let expected = format!("two rising times from {} to {end_s} s", setpoints.t_s[0]);
                return Err(self.wrong("forward", format!("[{from_s}, {to_s}]"), expected));
            }
        }
        let entry = self.entry(file, role, None);
        Ok(Plan { asked: self.asked(&setpoints, None), entry, forward_s: log.forward })
    }

    pub(super) fn setpoints(&self, folder: &Path, scenario: RobotScenario) -> Result<Setpoints, SynthError> {
        let (log, model) = (self.log, self.model);
        let refused = |name: &'static str| move |error| self.blame.refused(&self.key(name), error);
        let duration = |own: f64| {
            let right = |x: f64| x >= 2.0 * self.period_s && x <= 3600.0;
            self.blame.number(&self.key("duration"), log.duration.unwrap_or(own), right, "from two periods to 3600 s")
        };
        let table = match (&log.setpoints, &log.gait) {
            (Some(_), Some(_)) => return Err(self.wrong("setpoints", "it beside gait", "one of the two")),
            (Some(table), None) => {
                self.refuse(
                    [("amplitude", log.amplitude.is_some()), ("frequency", log.frequency.is_some())],
                    "setpoints",
                )?;
                let rest: Vec<f64> = model.joints().iter().map(crate::geometry::Joint::resting_rad).collect();
                let table = Setpoints::read(model, &folder.join(table), &rest);
                let table = table.map_err(|error| self.blame.refused(&self.key("setpoints"), error))?;
                let end_s = table.t_s[0] + duration(table.t_s[table.t_s.len() - 1] - table.t_s[0])?;
                return Ok(self.resampled(&table, end_s));
            }
            (None, gait) => gait.as_deref().unwrap_or("trot"),
        };
        let path = folder.join(table);
        if table.ends_with(".mot") {
            let motion = Motion::read(&path, model).map_err(refused("gait"))?;
            let sampled = Setpoints::sampled(&motion, model, duration(motion.end_s())?, self.period_s);
            return sampled.map_err(|error| self.blame.refused(&self.key("duration"), error));
        }
        let read =
            if table.contains(['.', '/', '\\']) { Gait::read(&path, model) } else { Gait::built_in(table, model) };
        let mut gait = read.map_err(refused("gait"))?;
        let in_air = scenario == RobotScenario::Air && gait.amplitudes().iter().any(|set| set == "air");
        if let Some(set) = log.amplitude.as_deref().or(in_air.then_some("air")) {
            gait = gait.with_amplitude(set).map_err(refused("amplitude"))?;
        }
        if let Some(hz) = log.frequency {
            let expected = "above 0, at most 50 1/s";
            gait = gait.at_frequency(self.blame.number(
                &self.key("frequency"),
                hz,
                |hz| hz > 0.0 && hz <= FASTEST_HZ,
                expected,
            )?);
        }
        let sampled = Setpoints::sampled(&gait, model, duration(gait.stand_s() + gait.walk_s())?, self.period_s);
        sampled.map_err(|error| self.blame.refused(&self.key("duration"), error))
    }

    /// A table at the log's own samples.
    fn resampled(&self, table: &Setpoints, end_s: f64) -> Setpoints {
        let t_s = times(table.t_s[0], end_s, self.period_s);
        let column = |id| {
            let angle_rad = t_s.iter().map(|t| table.at(id, *t).unwrap_or(0.0)).collect();
            Some(Column { angle_rad, on: None })
        };
        Setpoints { columns: self.model.joint_ids().map(column).collect(), hold: table.hold, t_s }
    }

    /// A joint that is let go.
    fn drop(
        &self,
        file: String,
        role: Role,
        released: &str,
        angles: &BTreeMap<String, f64>,
        gravity: Option<[f64; 3]>,
    ) -> Result<Plan, SynthError> {
        let (log, model) = (self.log, self.model);
        let keys = [
            ("gait", log.gait.is_some()),
            ("setpoints", log.setpoints.is_some()),
            ("amplitude", log.amplitude.is_some()),
            ("frequency", log.frequency.is_some()),
            ("forward", log.forward.is_some()),
        ];
        self.refuse(keys, "a drop")?;
        let refused = |name: &'static str| move |error| self.blame.refused(&self.key(name), error);
        model.joint(released).map_err(refused("released"))?;
        let number = |name: &str, value: f64, right: &dyn Fn(f64) -> bool, expected: &str| {
            self.blame.number(&self.key(name), value, right, expected)
        };
        let end_s = number(
            "duration",
            log.duration.unwrap_or(DROP_S),
            &|x| x >= 4.0 * self.period_s && x <= 3600.0,
            "from four periods to 3600 s",
        )?;
        let expected = format!("a time from 0 to before the end at {end_s} s");
        let release_s =
            number("release_time", log.release_time.unwrap_or(RELEASE_S), &|x| x >= 0.0 && x < end_s, &expected)?;
        for (name, angle) in angles {
            let id = model.joint(name).map_err(refused("angles"))?;
            let [low, high] =
                model.joints()[id.index()].software_rad.unwrap_or([-std::f64::consts::TAU, std::f64::consts::TAU]);
            let expected = format!("an angle from {low} to {high} rad, the software's limits");
            number(&format!("angles.{name}"), *angle, &|x| low <= x && x <= high, &expected)?;
        }
        let t_s = times(0.0, end_s, self.period_s);
        let column = |joint: &crate::geometry::Joint| {
            let angle = angles.get(&joint.name).copied().unwrap_or(joint.resting_rad());
            Some(Column { angle_rad: vec![angle; t_s.len()], on: None })
        };
        let columns = model.joints().iter().map(column).collect();
        let setpoints = Setpoints { columns, hold: crate::log::Hold::Linear, t_s };
        let attitude = gravity.map(|gravity| self.attitude(gravity)).transpose()?;
        let release = RobotRelease { joint: released.to_owned(), time_s: release_s };
        Ok(Plan {
            asked: self.asked(&setpoints, attitude),
            entry: self.entry(file, role, Some(release)),
            forward_s: None,
        })
    }

    /// Roll, pitch and yaw at which gravity has a direction in trunk axes \[rad\].
    fn attitude(&self, gravity: [f64; 3]) -> Result<[f64; 3], SynthError> {
        let (in_trunk, in_world) = (Vector3::from(gravity), self.model.gravity_m_s2());
        let expected = format!("a vector of {:.3} m/s^2 in trunk axes, the robot's gravity", in_world.norm());
        if !((in_trunk.norm() - in_world.norm()).abs() <= 0.005 * in_world.norm()) {
            return Err(self.wrong("gravity", format!("{gravity:?}"), expected));
        }
        let turned = UnitQuaternion::rotation_between(&in_trunk, &in_world)
            .unwrap_or_else(|| UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI));
        let base = BaseSample { position_m: Vector3::zeros(), orientation: turned, felt_m_s2: Vector3::zeros() };
        Ok(base.roll_pitch_yaw_rad())
    }

    pub(super) fn entry(&self, file: String, role: Role, release: Option<RobotRelease>) -> RobotStudyLog {
        let extra = |e: ExtraSpec| ExtraMass {
            mass_kg: e.mass,
            distance_m: e.distance,
            radius_m: e.radius,
            length_m: e.length,
        };
        RobotStudyLog { path: (&file).into(), file, role, release, extra: self.log.extra.map(extra), forward: None }
    }

    pub(super) fn asked(&self, setpoints: &Setpoints, attitude: Option<[f64; 3]>) -> RobotLog {
        let joint = |(joint, column): (&crate::geometry::Joint, &Option<Column>)| {
            let q_ref = column.as_ref().map(|column| column.angle_rad.clone()).unwrap_or_default();
            JointColumns {
                name: joint.name.clone(),
                q_rad: q_ref.clone(),
                q_ref_rad: Some(q_ref),
                setpoints: None,
                ..JointColumns::default()
            }
        };
        let n = setpoints.t_s.len();
        let base = attitude.map(|[roll, pitch, yaw]| BaseColumns {
            roll_rad: Some(vec![roll; n]),
            pitch_rad: Some(vec![pitch; n]),
            yaw_rad: Some(vec![yaw; n]),
            ..BaseColumns::default()
        });
        RobotLog {
            file: (&self.log.file).into(),
            t_s: setpoints.t_s.clone(),
            joints: self.model.joints().iter().zip(&setpoints.columns).map(joint).collect(),
            base,
            acceleration_m_s2: None,
            ignored_columns: Vec::new(),
            notes: Vec::new(),
        }
    }
}

pub(super) fn times(from_s: f64, to_s: f64, period_s: f64) -> Vec<f64> {
    let n = ((to_s - from_s) / period_s + 1e-6).floor() as usize;
    (0..=n).map(|k| from_s + k as f64 * period_s).collect()
}
