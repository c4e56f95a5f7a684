//! The thesis's two tests repeated with a friction of our choice: swings by the joint chain, ratios by the simple model.

use crate::identify::{Experiment, ExtensiveModel, JointModel, Scale};
use crate::joint::{Chain, EffectId, Link};
use crate::number::math;
use crate::pendulum::{Input, SimplePendulum, Start, rollout};
use crate::thesis::swings::JointSwings;
use crate::thesis::{Printed, TablesError};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

/// Sampling period and length of the swings \[s\].
const PERIOD_S: f64 = 0.012;
const LENGTH_S: f64 = 5.6;
/// Ratios that are tried \[1/s\]: from, to, how many. A parabola finds the minimum between them.
const RATIOS: (f64, f64, usize) = (0.1, 40.0, 110);

/// How two tests are made and read.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// Coulomb friction \[N m\].
    pub coulomb_nm: f64,
    /// Viscous friction \[N m s/rad\].
    pub viscous_nm_s_rad: f64,
    /// Effects of the catalogue, as they are searched.
    pub effects: Vec<(EffectId, Vec<f64>)>,
    /// Angle from where the leg hangs at which each test is let go \[rad\].
    pub release_rad: [f64; 2],
    /// What really hangs on the leg in the second test, over what is written down.
    pub second_mass: f64,
    /// Where it really hangs, over what is written down.
    pub second_distance: f64,
    /// `g/L` that the simple model is given \[1/s^2\].
    pub g_over_l_1_s2: [f64; 2],
}

/// Swings of simple pendulums, one for each ratio of the grid, by the bits of release angle and `g/L`.
type Library = BTreeMap<[u64; 2], Arc<Vec<Vec<f64>>>>;

/// The leg of one joint on the bench.
pub(super) struct Bench {
    model: ExtensiveModel,
    /// Masses by the tables; frictions and zero follow.
    values: Vec<f64>,
    /// One with each of the two extra masses.
    pub tests: [Experiment; 2],
    /// One without.
    pub bare: Option<Experiment>,
    t_s: Vec<f64>,
    /// Swings of simple pendulums by release angle and `g/L`.
    library: Mutex<Library>,
    /// As the swings were made, with Table 3.3's friction.
    pub thesis: Setting,
}

impl Bench {
    /// The bench for the swings of a joint; `None` where the thesis has no row for it.
    pub fn new(swings: &JointSwings) -> Result<Option<Self>, TablesError> {
        let printed = Printed::embedded();
        let (Some(ratios), Some(friction)) = (printed.ratios(swings.joint), printed.estimated(swings.joint)) else {
            return Ok(None);
        };
        let loaded: Vec<&Experiment> = swings.loaded().take(2).filter_map(|load| load.moving.first()).collect();
        let [first, second] = loaded[..] else { return Ok(None) };
        let tests = [first.clone(), second.clone()];
        let bare = swings.bare().and_then(|load| load.moving.first()).cloned();
        let nominal = swings.case.joint.nominal.as_ref();
        let masses = swings.leg()?.masses()?;
        let model = ExtensiveModel::bodies(&Scale::of(&tests, nominal, None), &tests, &masses, true, nominal, false);
        let mut values: Vec<f64> = masses.iter().map(|m| m.nominal_kg).collect();
        values.extend([0.0, 0.0, 0.0]);
        let steps = (LENGTH_S / PERIOD_S) as usize;
        let mut bench = Self {
            model,
            values,
            tests,
            bare,
            t_s: (0..=steps).map(|k| k as f64 * PERIOD_S).collect(),
            library: Mutex::new(BTreeMap::new()),
            thesis: Setting {
                coulomb_nm: friction.coulomb_nm,
                viscous_nm_s_rad: friction.viscous_nm_s_rad,
                effects: Vec::new(),
                release_rad: [0.0; 2],
                second_mass: 1.0,
                second_distance: 1.0,
                g_over_l_1_s2: ratios.g_over_l_1_s2,
            },
        };
        let moving: Vec<&Experiment> = swings.loaded().flat_map(|load| &load.moving).collect();
        let from_hanging = |e: &Experiment| {
            let hanging = bench.chain(e, &bench.thesis, [1.0, 1.0]).link.hanging_rad();
            (e.start.angle_rad - hanging).abs()
        };
        let mean = moving.iter().map(|e| from_hanging(e)).sum::<f64>() / moving.len().max(1) as f64;
        // To the hundredth, so that the number can be written down.
        bench.thesis.release_rad = [(mean * 100.0).round() / 100.0; 2];
        Ok(Some(bench))
    }

    /// The joint of one test; the load's mass and distance are scaled.
    fn chain(&self, e: &Experiment, setting: &Setting, [mass, distance]: [f64; 2]) -> Chain<f64> {
        let mut values = self.values.clone();
        let n = values.len();
        (values[n - 3], values[n - 2]) = (setting.coulomb_nm, setting.viscous_nm_s_rad);
        let mut scaled;
        let e = match e.load {
            Some(mut load) if mass != 1.0 || distance != 1.0 => {
                load.inertia_kg_m2 *= mass * distance * distance;
                load.moment_kg_m *= mass * distance;
                scaled = e.clone();
                scaled.load = Some(load);
                &scaled
            }
            _ => e,
        };
        let mut chain = self.model.chain(&values, e);
        let bare: Link<f64> = self.model.bare_link(&values, e);
        for (effect, values) in &setting.effects {
            effect.apply(values, bare.inertia_kg_m2, &mut chain);
        }
        chain
    }

    /// Readings of a swing from a release angle, counted from where the leg hangs by the tables.
    fn swing(
        &self,
        e: &Experiment,
        setting: &Setting,
        scale: [f64; 2],
        release_rad: f64,
        t_s: &[f64],
    ) -> Option<Vec<f64>> {
        let hanging = self.chain(e, &self.thesis, [1.0, 1.0]).link.hanging_rad();
        let chain = self.chain(e, setting, scale);
        let gain = chain.sensor_gain;
        let start = Start { angle_rad: (hanging + release_rad) / gain, rate_rad_s: 0.0, release_s: None };
        let mut angle = Vec::with_capacity(t_s.len());
        rollout(&chain, Input::Off, t_s, start, |_, s| angle.push(s.angle_rad * gain - hanging)).ok()?;
        Some(angle)
    }

    /// The bare leg's swing and those with both masses, as experiments that a model may be fitted to.
    pub fn experiments(&self, setting: &Setting) -> Vec<Option<Experiment>> {
        let scales = [[1.0, 1.0], [1.0, 1.0], [setting.second_mass, setting.second_distance]];
        let releases = [setting.release_rad[0], setting.release_rad[0], setting.release_rad[1]];
        let all = [self.bare.as_ref(), Some(&self.tests[0]), Some(&self.tests[1])];
        let make = |((e, scale), release): ((Option<&Experiment>, [f64; 2]), f64)| {
            let e = e?;
            let swing = self.swing(e, setting, scale, release, &self.t_s)?;
            let hanging = self.chain(e, &self.thesis, [1.0, 1.0]).link.hanging_rad();
            let measured_rad: Vec<f64> = swing.iter().map(|a| a + hanging).collect();
            Some(Experiment {
                start: Start { angle_rad: measured_rad[0], rate_rad_s: 0.0, release_s: None },
                t_s: self.t_s.clone(),
                weights_s: vec![PERIOD_S; self.t_s.len()],
                measured_rad,
                uncompared: 0,
                first_sample: 0,
                release_window_s: None,
                runs: Vec::new(),
                ..e.clone()
            })
        };
        all.into_iter().zip(scales).zip(releases).map(make).collect()
    }

    /// Both ratios `B/ML^2` that the simple model finds \[1/s\]; `None` where the leg does not swing.
    pub fn ratios(&self, setting: &Setting) -> Option<[f64; 2]> {
        let one = |k: usize| {
            let scale = if k == 1 { [setting.second_mass, setting.second_distance] } else { [1.0, 1.0] };
            let swing = self.swing(&self.tests[k], setting, scale, setting.release_rad[k], &self.t_s)?;
            self.ratio_of(&swing, setting.release_rad[k], setting.g_over_l_1_s2[k])
        };
        Some([one(0)?, one(1)?])
    }

    /// The ratio at which the simple pendulum (3.2), `g/L` given, comes nearest to a swing by (3.7).
    fn ratio_of(&self, swing: &[f64], release_rad: f64, g_over_l_1_s2: f64) -> Option<f64> {
        let library = self.simple_swings(release_rad, g_over_l_1_s2);
        let criterion = |s: &Vec<f64>| s.iter().zip(swing).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        let all: Vec<f64> = library.iter().map(criterion).collect();
        let best = (0..all.len()).min_by(|&a, &b| all[a].total_cmp(&all[b]))?;
        if best == 0 || best + 1 >= all.len() {
            return None;
        }
        let [low, middle, high] = [all[best - 1], all[best], all[best + 1]];
        let bend = low - 2.0 * middle + high;
        let shift = if bend > 0.0 { 0.5 * (low - high) / bend } else { 0.0 };
        Some(ratio_at(best as f64 + shift))
    }

    /// Swings of the simple pendulum from an angle, one for each ratio of the grid; made once.
    fn simple_swings(&self, release_rad: f64, g_over_l_1_s2: f64) -> Arc<Vec<Vec<f64>>> {
        let key = [release_rad.to_bits(), g_over_l_1_s2.to_bits()];
        let kept = |library: &Library| library.get(&key).cloned();
        // Whoever holds the lock only reads or inserts: what a panic left behind is whole.
        let lock = || self.library.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some(found) = kept(&lock()) {
            return found;
        }
        let swing = |k: usize| {
            let pendulum =
                SimplePendulum { ml2_kg_m2: 1.0, b_over_ml2_1_s: ratio_at(k as f64), g_over_l_1_s2, rest_rad: 0.0 };
            let start = Start { angle_rad: release_rad, rate_rad_s: 0.0, release_s: None };
            let mut angle = Vec::with_capacity(self.t_s.len());
            // A swing that ran away would lack samples and compare as if it had ended: none does within these ratios.
            let _ = rollout(&pendulum.chain(None), Input::Off, &self.t_s, start, |_, s| angle.push(s.angle_rad));
            angle
        };
        let made = Arc::new((0..RATIOS.2).map(swing).collect::<Vec<_>>());
        lock().insert(key, made.clone());
        made
    }
}

/// The ratio at a place of the grid \[1/s\].
fn ratio_at(k: f64) -> f64 {
    let (from, to, count) = RATIOS;
    from * math::powf(to / from, k / (count - 1) as f64)
}
