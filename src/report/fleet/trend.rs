//! Joints through time.

use super::rows::FleetRow;
use crate::log::Day;
use crate::report::measure::Measure;
use serde::Serialize;

/// A study's word on a joint.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrendPoint {
    /// Of the study's last log.
    pub day: Option<Day>,
    /// The study.
    pub study: String,
    /// RMS error of the model as given, over the study's logs \[rad or N m\].
    pub gap: f64,
    /// Whether the model as given is not enough.
    pub is_off: bool,
}

/// A joint of a robot through all studies that have it, or a body through all studies of the robot.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct JointTrend {
    /// The robot.
    pub robot: Option<String>,
    /// The joint.
    pub joint: String,
    /// Of the gaps: `rad` or `N m`.
    pub unit: String,
    /// Since when it parts from its model without a study between that says otherwise; `None`: it does not.
    pub since: Option<Day>,
    /// What the latest study says.
    pub latest: FleetRow,
    /// A point for each study, in the order of days.
    pub points: Vec<TrendPoint>,
}

impl JointTrend {
    /// Whether the latest study says that the model as given is not enough.
    pub fn is_off(&self) -> bool {
        self.latest.is_off()
    }

    /// The latest gap \[rad or N m\].
    pub fn gap(&self) -> f64 {
        self.points.last().map_or(f64::NAN, |point| point.gap)
    }

    /// The latest gap by the first, where there are several studies.
    pub fn growth(&self) -> Option<f64> {
        let first = self.points.first().filter(|first| self.points.len() > 1 && first.gap > 0.0)?;
        Some(self.gap() / first.gap)
    }

    pub(super) fn has(&self, row: &FleetRow) -> bool {
        row.joint.as_deref() == Some(&self.joint) && self.is_told_by(row)
    }

    /// Whether a row is of this robot, of joints or of bodies as this is, and of the same unit.
    fn is_told_by(&self, row: &FleetRow) -> bool {
        row.robot == self.robot && row.is_body == self.latest.is_body && row.unit.as_deref() == Some(&self.unit)
    }

    pub(super) fn measure(&self) -> Measure {
        Measure::of(&self.unit)
    }
}

/// Joints of all rows: those that part from their models first, in the order of their gaps.
///
/// A body has a row only in studies that name it; `other_bodies` has a row of each study for those that it does not name.
pub(super) fn joints(rows: &[FleetRow], other_bodies: &[FleetRow]) -> Vec<JointTrend> {
    let mut joints: Vec<JointTrend> = Vec::new();
    let of_joint = rows.iter().filter_map(|row| Some((row, row.joint.as_ref()?, row.unit.as_ref()?)));
    for (row, joint, unit) in of_joint {
        if joints.iter().any(|known| known.has(row)) {
            continue;
        }
        let mut trend = JointTrend {
            robot: row.robot.clone(),
            joint: joint.clone(),
            unit: unit.clone(),
            since: None,
            latest: row.clone(),
            points: Vec::new(),
        };
        let mut own: Vec<&FleetRow> = rows.iter().filter(|other| trend.has(other)).collect();
        let is_named = |study: &str| own.iter().any(|row| row.study == study);
        let unnamed = |other: &&FleetRow| trend.is_told_by(other) && !is_named(&other.study);
        let unnamed: Vec<&FleetRow> = other_bodies.iter().filter(unnamed).collect();
        own.extend(unnamed);
        trend.points = points(&own);
        trend.since = since(&trend.points);
        if let Some(last) = trend.points.last()
            && let Some(latest) = own.iter().rfind(|row| row.study == last.study)
        {
            trend.latest = FleetRow { joint: Some(joint.clone()), since: trend.since, ..(*latest).clone() };
        }
        joints.push(trend);
    }
    let order = |a: &JointTrend, b: &JointTrend| {
        let by_gap = a.unit.cmp(&b.unit).reverse().then(b.gap().total_cmp(&a.gap()));
        b.is_off().cmp(&a.is_off()).then(by_gap).then((&a.robot, &a.joint).cmp(&(&b.robot, &b.joint)))
    };
    joints.sort_by(order);
    joints
}

fn points(rows: &[&FleetRow]) -> Vec<TrendPoint> {
    let mut studies: Vec<&str> = rows.iter().map(|row| row.study.as_str()).collect();
    studies.dedup();
    let point = |study: &&str| {
        let own = || rows.iter().filter(|row| row.study == *study);
        let gaps: Vec<f64> = own().filter_map(|row| row.gap_before).collect();
        let mean = gaps.iter().map(|gap| gap * gap).sum::<f64>() / gaps.len() as f64;
        TrendPoint {
            day: own().filter_map(|row| row.day).max(),
            study: (*study).to_owned(),
            gap: mean.sqrt(),
            is_off: own().any(|row| row.is_off()),
        }
    };
    let mut points: Vec<TrendPoint> = studies.iter().map(point).collect();
    points.sort_by(|a, b| (a.day, &a.study).cmp(&(b.day, &b.study)));
    points
}

/// The first day of the last run of studies that say that the model is not enough.
fn since(points: &[TrendPoint]) -> Option<Day> {
    points.iter().rev().take_while(|point| point.is_off).last()?.day
}
