//! Why are two masses of Table 3.1 negative, and why is Coulomb friction small without and large with extra mass?
//!
//! Both tests of each joint are repeated with the joint chain and everything that may have been otherwise, and the
//! simple model is fitted to them as the thesis did, `g/L` set. Each [`Candidate`] is scanned over its range, alone and
//! together with larger Coulomb friction or with friction that grows with the load; the nearest approach to the printed
//! ratios is kept. Where it comes near about q1, the extensive model is fitted to the same swings: does it see the two
//! Coulomb frictions of section 3.3.2?
//!
//! No logs are needed but for the places of the extra masses and the release angles.

mod bench;
mod candidate;
mod coulomb;

pub use bench::Setting;
pub use candidate::Candidate;
pub use coulomb::CoulombSeen;

use super::swings::JointSwings;
use super::{Printed, TablesError};
use crate::geometry::LegJoint;
use crate::number::math;
use crate::pendulum::{RatioTest, mass_from_ratios};
use bench::Bench;
use candidate::{COULOMB, LOAD, OTHERS};
use rayon::prelude::*;

/// What was scanned, and what came of it.
#[derive(Clone, Debug)]
pub struct Puzzle {
    /// By joint.
    pub joints: Vec<JointPuzzle>,
}

/// The puzzle about one joint.
#[derive(Clone, Debug)]
pub struct JointPuzzle {
    /// The joint.
    pub joint: LegJoint,
    /// Both printed ratios \[1/s\].
    pub printed_1_s: [f64; 2],
    /// Release angle from where the leg hangs, where it is not scanned \[rad\].
    pub release_rad: f64,
    /// With the friction of Table 3.3 and nothing else.
    pub as_printed: Option<Approach>,
    /// Each candidate alone.
    pub alone: Vec<Scan>,
    /// Pairs, the nearest first.
    pub pairs: Vec<Approach>,
    /// With the Coulomb friction that section 3.3.2 has with extra mass, in both tests: viscous friction alone, then with
    /// each of the others, the nearest first. Only about q1 and q2, of which that section speaks.
    pub with_load: Vec<Approach>,
}

/// One candidate alone.
#[derive(Clone, Debug)]
pub struct Scan {
    /// Which.
    pub candidate: Candidate,
    /// Size and both ratios \[1/s\].
    pub curve: Vec<(f64, [f64; 2])>,
    /// Where it comes nearest to the printed ratios.
    pub nearest: Approach,
}

/// A point of a scan.
#[derive(Clone, Debug)]
pub struct Approach {
    /// Candidates and their sizes.
    pub what: Vec<(Candidate, f64)>,
    /// Both ratios \[1/s\].
    pub ratios_1_s: [f64; 2],
    /// Mass by (3.5) \[kg\].
    pub mass_kg: f64,
    /// The larger of the two deviations from the printed ratios, as a logarithm.
    pub misfit: f64,
    /// What the extensive model sees of Coulomb friction in the same swings, where that was asked.
    pub coulomb: Option<CoulombSeen>,
}

/// Sizes of a candidate alone, and of each of a pair.
const ALONE: usize = 25;
const EACH: usize = 9;
/// Rounds in which the steps around the nearest point are divided by [`FINER`].
const ROUNDS: usize = 2;
const FINER: f64 = 4.0;
/// Steps of Newton's method before, and the share of a range over which a slope is taken.
const NEWTON: usize = 6;
const SLOPE: f64 = 0.04;
/// Pairs this near the printed ratios count as explaining them.
pub const NEAR: f64 = 0.02;

/// Scans everything.
pub(super) fn scan(swings: &[JointSwings], progress: &(dyn Fn(&str) + Sync)) -> Result<Puzzle, TablesError> {
    let mut joints = Vec::new();
    for swings in swings {
        progress(&format!("scanning what may be behind Table 3.1, {}", swings.joint));
        let Some(bench) = Bench::new(swings)? else { continue };
        let Some(printed) = Printed::embedded().ratios(swings.joint) else { continue };
        let scan = JointScan { bench: &bench, printed_1_s: printed.b_over_ml2_1_s, extra_kg: printed.extra_mass_kg };
        let singles: Vec<Candidate> = [COULOMB, LOAD].into_iter().chain(OTHERS).collect();
        let alone: Vec<Scan> = singles.par_iter().filter_map(|candidate| scan.alone(candidate)).collect();
        let mut combinations: Vec<[Candidate; 2]> = vec![[COULOMB, LOAD]];
        combinations.extend(OTHERS.into_iter().flat_map(|other| [[COULOMB, other], [LOAD, other]]));
        let mut pairs: Vec<Approach> = combinations.par_iter().filter_map(|pair| scan.pair(pair)).collect();
        pairs.sort_by(|a, b| a.misfit.total_cmp(&b.misfit));
        if swings.joint == LegJoint::Q1 {
            pairs.par_iter_mut().filter(|pair| pair.misfit < NEAR).for_each(|pair| {
                pair.coulomb = Some(coulomb::seen(&bench, swings, &scan.setting(&pair.what)));
            });
        }
        let with_load = if swings.joint == LegJoint::Q3 { Vec::new() } else { scan.with_load() };
        joints.push(JointPuzzle {
            with_load,
            joint: swings.joint,
            printed_1_s: scan.printed_1_s,
            release_rad: bench.thesis.release_rad[0],
            as_printed: scan.approach(&[]),
            alone,
            pairs,
        });
    }
    Ok(Puzzle { joints })
}

struct JointScan<'a> {
    bench: &'a Bench,
    printed_1_s: [f64; 2],
    extra_kg: [f64; 2],
}

impl JointScan<'_> {
    fn setting(&self, what: &[(Candidate, f64)]) -> Setting {
        what.iter().fold(self.bench.thesis.clone(), |setting, (candidate, size)| candidate.at(&setting, *size))
    }

    /// Ratios and mass with some candidates at some sizes; `None` where the leg does not swing.
    fn approach(&self, what: &[(Candidate, f64)]) -> Option<Approach> {
        let ratios_1_s = self.bench.ratios(&self.setting(what))?;
        let test = |k: usize| RatioTest {
            extra_mass_kg: self.extra_kg[k],
            damping_per_s: ratios_1_s[k],
            stiffness_per_s2: self.bench.thesis.g_over_l_1_s2[k],
        };
        let off = |k: usize| math::ln(ratios_1_s[k] / self.printed_1_s[k]).abs();
        Some(Approach {
            what: what.to_vec(),
            ratios_1_s,
            mass_kg: mass_from_ratios(&test(0), &test(1)).ok()?,
            misfit: off(0).max(off(1)),
            coulomb: None,
        })
    }

    fn alone(&self, candidate: &Candidate) -> Option<Scan> {
        let points: Vec<Approach> =
            candidate.sizes(ALONE).filter_map(|size| self.approach(&[(*candidate, size)])).collect();
        let curve = points.iter().map(|point| (point.what[0].1, point.ratios_1_s)).collect();
        let nearest = points.into_iter().min_by(|a, b| a.misfit.total_cmp(&b.misfit))?;
        Some(Scan { candidate: *candidate, curve, nearest: self.refined(nearest, ALONE) })
    }

    fn pair(&self, [first, second]: &[Candidate; 2]) -> Option<Approach> {
        let points = first.sizes(EACH).flat_map(|a| second.sizes(EACH).map(move |b| [(*first, a), (*second, b)]));
        let nearest = points.filter_map(|what| self.approach(&what)).min_by(|a, b| a.misfit.total_cmp(&b.misfit))?;
        Some(self.refined(nearest, EACH))
    }

    /// Coulomb friction as section 3.3.2 has it with extra mass, viscous friction scanned, alone and with the others.
    fn with_load(&self) -> Vec<Approach> {
        let coulomb_nm = Printed::embedded().section_3_3_2.coulomb_loaded_nm;
        let (viscous, others) = OTHERS.split_first().map_or((COULOMB, &[][..]), |(first, others)| (*first, others));
        let points: Vec<Approach> =
            viscous.sizes(ALONE).filter_map(|size| self.approach(&[(COULOMB, coulomb_nm), (viscous, size)])).collect();
        let nearest = points.into_iter().min_by(|a, b| a.misfit.total_cmp(&b.misfit));
        let with = |other: &Candidate| {
            let points = viscous.sizes(EACH).flat_map(|a| other.sizes(EACH).map(move |b| [(viscous, a), (*other, b)]));
            let points = points.filter_map(|[a, b]| self.approach(&[(COULOMB, coulomb_nm), a, b]));
            let nearest = points.min_by(|a, b| a.misfit.total_cmp(&b.misfit))?;
            Some(self.refined(nearest, EACH))
        };
        let mut with_others: Vec<Approach> = others.par_iter().filter_map(with).collect();
        with_others.sort_by(|a, b| a.misfit.total_cmp(&b.misfit));
        nearest.map(|nearest| self.refined(nearest, ALONE)).into_iter().chain(with_others).collect()
    }

    /// Two sizes for two ratios: Newton's method from a point, as far as it comes nearer.
    fn newton(&self, mut nearest: Approach, held: usize) -> Approach {
        let off = |point: &Approach| [0, 1].map(|k: usize| math::ln(point.ratios_1_s[k] / self.printed_1_s[k]));
        for _ in 0..NEWTON {
            let at = off(&nearest);
            let slope = |k: usize| -> Option<[f64; 2]> {
                let mut what = nearest.what.clone();
                // Away from the nearer end of the range.
                let [from, to] = what[k].0.range;
                let share = if what[k].1 > 0.5 * (from + to) { -SLOPE } else { SLOPE };
                what[k] = moved(what[k], share);
                let there = off(&self.approach(&what)?);
                Some([(there[0] - at[0]) / share, (there[1] - at[1]) / share])
            };
            let (Some(a), Some(b)) = (slope(held), slope(held + 1)) else { break };
            let determinant = a[0] * b[1] - a[1] * b[0];
            let step = [(b[0] * at[1] - b[1] * at[0]) / determinant, (a[1] * at[0] - a[0] * at[1]) / determinant];
            if !step.iter().all(|share| share.is_finite()) {
                break;
            }
            let better = [1.0, 0.4].into_iter().find_map(|part| {
                let mut what = nearest.what.clone();
                for k in 0..2 {
                    what[held + k] = moved(what[held + k], part * step[k].clamp(-1.0, 1.0));
                }
                self.approach(&what).filter(|point| point.misfit < nearest.misfit)
            });
            let Some(better) = better else { break };
            nearest = better;
        }
        nearest
    }

    /// The nearest point with finer and finer steps around it, within the ranges; the last two candidates move, and one
    /// that stands before them stays.
    fn refined(&self, mut nearest: Approach, count: usize) -> Approach {
        let held = nearest.what.len().saturating_sub(2).max(usize::from(nearest.what.len() == 2 && count == ALONE));
        if nearest.what.len() == held + 2 {
            nearest = self.newton(nearest, held);
        }
        let mut share = 1.0 / (count - 1) as f64;
        for _ in 0..ROUNDS {
            share /= FINER;
            let middle = nearest.what.clone();
            let steps: &[f64] = &[-2.0, -1.0, 0.0, 1.0, 2.0];
            for &a in steps {
                for &b in if middle.len() > held + 1 { steps } else { &[0.0] } {
                    let mut what = middle[..held].to_vec();
                    what.push(moved(middle[held], a * share));
                    if middle.len() > held + 1 {
                        what.push(moved(middle[held + 1], b * share));
                    }
                    if let Some(point) = self.approach(&what).filter(|point| point.misfit < nearest.misfit) {
                        nearest = point;
                    }
                }
            }
        }
        nearest
    }
}

/// A size moved by a share of its range, kept within it.
fn moved((candidate, size): (Candidate, f64), share: f64) -> (Candidate, f64) {
    let [from, to] = candidate.range;
    (candidate, (size + share * (to - from)).clamp(from, to))
}

/// Bare Coulomb friction up to this many times the thesis's counts as its own, and loaded within this factor of it.
pub const BARE_FACTOR: f64 = 3.0;
/// See [`BARE_FACTOR`].
pub const LOADED_FACTOR: f64 = 1.6;

impl Approach {
    /// Names of the candidates.
    pub fn names(&self) -> String {
        self.what.iter().map(|(candidate, _)| candidate.name).collect::<Vec<_>>().join(" + ")
    }

    /// Whether the extensive model sees both Coulomb frictions of section 3.3.2 in these swings: little without, much
    /// with either extra mass.
    pub fn shows_both_frictions(&self) -> bool {
        let Some(CoulombSeen { bare_nm: Some(bare), loaded_nm: [Some(a), Some(b)] }) = self.coulomb else {
            return false;
        };
        let printed = Printed::embedded().section_3_3_2;
        let near = |loaded: f64| math::ln(loaded / printed.coulomb_loaded_nm).abs() < math::ln(LOADED_FACTOR);
        bare <= BARE_FACTOR * printed.coulomb_bare_nm && near(a) && near(b)
    }
}

impl Puzzle {
    /// Pairs that come near the printed ratios of every joint, each joint with sizes of its own.
    pub fn near_everywhere(&self) -> Vec<String> {
        let Some((first, others)) = self.joints.split_first() else { return Vec::new() };
        let near = |joint: &JointPuzzle, names: &str| {
            joint.pairs.iter().any(|pair| pair.misfit < NEAR && pair.names() == names)
        };
        let names = first.pairs.iter().filter(|pair| pair.misfit < NEAR).map(Approach::names);
        names.filter(|names| others.iter().all(|joint| near(joint, names))).collect()
    }

    /// The ranges that were scanned.
    pub fn candidates(&self) -> Vec<Candidate> {
        [COULOMB, LOAD].into_iter().chain(OTHERS).collect()
    }
}
