//! The logs that are refitted, and the drops that repeat them.

use super::measure::mean;
use super::values::Values;
use crate::geometry::{Ers7Tables, LegJoint, LinkBody, joint_name};
use crate::identify::{Case, Experiment, LegCase};
use crate::joint::EffectId;
use crate::log::ExtraMass;
use crate::robot::Model;
use crate::robot::bench::{BenchDrop, Held, bench_drop};
use crate::robot::simulate::{Method, SimulateError};

/// Swings of one joint of a leg.
pub struct BenchLogs<'a> {
    leg: &'a LegCase,
    pub(super) logs: Vec<BenchLog<'a>>,
    pub(super) nominal: Values,
    limb: Model,
}

/// One of them.
pub(super) struct BenchLog<'a> {
    pub e: &'a Experiment,
    pub extra: Option<ExtraMass>,
    /// Samples that are compared and before: the swing, and a little rest.
    pub samples: usize,
    pub release_s: f64,
}

/// Within this of its last angle a joint rests \[rad\]; so many samples of rest are compared.
const RESTS_RAD: f64 = 0.015;
const REST_SAMPLES: usize = 60;
/// The angle of rest is the mean of so many samples.
pub(super) const END_SAMPLES: usize = 40;
/// Steps \[s\]: within 0.01 mrad of steps a quarter as long, in the air.
const METHOD: Method = Method::Stiff { step_s: 4e-3 };

impl<'a> BenchLogs<'a> {
    /// Free swings of a case that begin held, up to `of_each_load` with each extra mass (more say the same again); `None` where there are none or the case is
    /// of no leg in a known pose.
    ///
    /// # Errors
    /// [`SimulateError`] where the robot has no such leg.
    pub fn of(case: &'a Case, of_each_load: usize) -> Result<Option<Self>, SimulateError> {
        let Some(leg) = case.leg.as_ref().filter(|leg| leg.pose_known) else { return Ok(None) };
        let mut logs: Vec<BenchLog<'a>> = Vec::new();
        for (item, e) in case.items.iter().flat_map(|item| item.experiments.iter().map(move |e| (item, e))) {
            if e.is_driven() {
                continue;
            }
            let Some([_, release_s]) = e.release_window_s else { continue };
            let mass = |extra: &Option<ExtraMass>| extra.map_or(0.0, |extra| extra.mass_kg);
            let same = |log: &&BenchLog<'_>| mass(&log.extra) == mass(&item.entry.extra);
            let end = e.measured_rad.len();
            if logs.iter().filter(same).count() >= of_each_load || end < 2 * END_SAMPLES {
                continue;
            }
            let rest_rad = mean(&e.measured_rad[end - END_SAMPLES..]);
            let last = e.measured_rad.iter().rposition(|q| (q - rest_rad).abs() > RESTS_RAD).unwrap_or(0);
            let samples = (last + REST_SAMPLES).min(end);
            logs.push(BenchLog { e, extra: item.entry.extra, samples, release_s });
        }
        if logs.is_empty() {
            return Ok(None);
        }
        let lower = leg.bare()?.body(LinkBody::LowerLeg).map_or(f64::NAN, |body| body.mass_kg);
        let (coulomb_nm, viscous_nm_s_rad) = Ers7Tables::embedded().friction.estimated.of(leg.joint);
        let nominal =
            Values { mass_kg: lower, coulomb_nm, viscous_nm_s_rad, zero_rad: 0.0, mu_l: 0.0, delta_nm: 0.0, none: 0.0 };
        let robot = Model::ers7();
        let limb = robot.limb(robot.joint(&joint_name(leg.leg, leg.joint))?)?;
        Ok(Some(Self { leg, logs, nominal, limb }))
    }

    /// The joint that swings.
    pub fn joint(&self) -> LegJoint {
        self.leg.joint
    }

    /// Names of the logs that are fitted.
    pub fn files(&self) -> Vec<String> {
        self.logs.iter().map(|log| log.e.file.clone()).collect()
    }

    fn drop(&self, log: &BenchLog<'_>, held: Held, values: &Values) -> BenchDrop<'a> {
        let mut effects = Vec::new();
        if values.mu_l != 0.0 {
            effects.push((EffectId::LoadFriction, vec![values.mu_l]));
        }
        if values.delta_nm != 0.0 {
            effects.push((EffectId::AsymmetricFriction, vec![values.delta_nm]));
        }
        BenchDrop {
            leg: self.leg,
            extra: log.extra,
            masses_kg: vec![(LinkBody::LowerLeg, values.mass_kg)],
            coulomb_nm: values.coulomb_nm,
            viscous_nm_s_rad: values.viscous_nm_s_rad,
            stribeck: None,
            effects,
            others: Vec::new(),
            zero_rad: values.zero_rad,
            angle_rad: log.e.start.angle_rad,
            rate_rad_s: 0.0,
            release_s: log.release_s,
            held,
        }
    }

    /// What the encoder reads at the samples of a log that are compared, and before.
    pub(super) fn readings(&self, log: &BenchLog<'_>, held: Held, values: &Values) -> Result<Vec<f64>, SimulateError> {
        let times_s = &log.e.t_s[..log.samples];
        Ok(bench_drop(&self.limb, &self.drop(log, held, values), times_s, METHOD)?.reading_rad)
    }
}
