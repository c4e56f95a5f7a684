//! Numbers and sizes that several joints have in common, as one number with one interval.
//!
//! Near its answer every joint's logs say of a number what its interval says; together they say the weighed mean, and whether
//! one number for all is no worse than one for each.

use super::answer::{JointAnswer, found_of};
use crate::gap::verdict::sentence::number_words;
use crate::gap::{Diagnosis, Number};
use crate::number::chance::{HALF_95, sd_of};
use crate::number::{math, quantity};
use serde::Serialize;
use std::collections::BTreeMap;

/// Joints of one make are never alike to more than this share.
const SCATTER: f64 = 0.05;
/// A ratio that stands out of one by so many standard deviations is said.
const STANDS_OUT: f64 = 3.0;
/// The group of all joints.
const ALL: &str = "all";

/// One number of several joints, told as a multiple of what each of them is believed to have.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PooledNumber {
    /// `coulomb` for instance.
    pub number: &'static str,
    /// `all`, a group of the study, or joints that are alike.
    pub group: String,
    /// Those that have it.
    pub joints: Vec<String>,
    /// Found per believed.
    pub ratio: f64,
    /// 95 % interval of it.
    pub interval: [f64; 2],
}

impl PooledNumber {
    /// `Coulomb friction of all joints is 1.82 [1.75, 1.89] times what is believed`
    pub fn words(&self) -> String {
        let ratio = quantity(self.ratio, Some(self.interval), "");
        let group = if self.group == ALL { "all joints" } else { &self.group };
        format!("{} of {group} is {} times what is believed", number_words(self.number), ratio.trim_end())
    }
}

/// A weighed mean with its standard deviation; `None` where the values do not agree on one number.
fn agreed(values: &[(f64, f64)]) -> Option<(f64, f64)> {
    let weight: f64 = values.iter().map(|(_, sd)| sd.powi(-2)).sum();
    let mean = values.iter().map(|(value, sd)| value / (sd * sd)).sum::<f64>() / weight;
    let apart: f64 = values.iter().map(|(value, sd)| ((value - mean) / sd).powi(2)).sum();
    let freedoms = values.len() as f64 - 1.0;
    let agrees = values.len() > 1 && mean.is_finite() && apart < freedoms + 2.0 * (2.0 * freedoms).sqrt();
    agrees.then_some((mean, math::powf(weight, -0.5)))
}

/// Numbers that whole groups of joints have elsewhere alike, the largest groups first.
pub(super) fn pooled(groups: &BTreeMap<String, Vec<String>>, joints: &[JointAnswer]) -> Vec<PooledNumber> {
    let found: Vec<&Diagnosis> = found_of(joints).collect();
    let all: Vec<String> = found.iter().map(|d| d.joint.clone()).collect();
    let mut tried: Vec<(String, Vec<String>)> = vec![(ALL.to_owned(), all)];
    tried.extend(groups.iter().map(|(name, joints)| (name.clone(), joints.clone())));
    tried.sort_by_key(|(_, joints)| std::cmp::Reverse(joints.len()));
    let mut pooled: Vec<PooledNumber> = Vec::new();
    for number in ["coulomb", "viscous", "gain", "moment", "inertia", "armature"] {
        for (group, joints) in &tried {
            let is_said =
                |known: &PooledNumber| known.number == number && joints.iter().all(|j| known.joints.contains(j));
            if joints.len() < 2 || pooled.iter().any(is_said) {
                continue;
            }
            let ratio = |name: &String| {
                let own = found.iter().find(|d| d.joint == *name)?.parameters.iter().find(|p| p.name == number)?;
                let (nominal, interval) = (own.nominal.filter(|nominal| *nominal > 0.0)?, own.interval?);
                let ratio = own.value / nominal;
                Some((ratio, math::hypot(sd_of(own.value, interval) / nominal, SCATTER * ratio)))
            };
            let Some(ratios) = joints.iter().map(ratio).collect::<Option<Vec<_>>>() else { continue };
            let Some((ratio, sd)) = agreed(&ratios) else { continue };
            let same_way = ratios.iter().all(|(own, _)| (own - 1.0) * (ratio - 1.0) > 0.0);
            if same_way && (ratio - 1.0).abs() > STANDS_OUT * sd {
                let interval = [ratio - HALF_95 * sd, ratio + HALF_95 * sd];
                pooled.push(PooledNumber { number, group: group.clone(), joints: joints.clone(), ratio, interval });
            }
        }
    }
    pooled
}

/// The sizes of one cause on several joints as one, where they agree.
pub(super) fn one_size(sizes: &[&Number]) -> Option<Number> {
    let own = |number: &&Number| {
        Some((number.value, math::hypot(sd_of(number.value, number.interval?), SCATTER * number.value)))
    };
    let values = sizes.iter().map(own).collect::<Option<Vec<_>>>()?;
    let (value, sd) = agreed(&values)?;
    let interval = Some([value - HALF_95 * sd, value + HALF_95 * sd]);
    let first = sizes.first()?;
    Some(Number { name: first.name.clone(), value, unit: first.unit.clone(), interval, interval_naive: interval })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_that_agree_are_one_and_others_are_not() {
        let (mean, sd) = agreed(&[(1.8, 0.1), (1.9, 0.1), (1.85, 0.05)]).unwrap();
        assert!((mean - 1.85).abs() < 1e-9 && sd < 0.05);
        assert!(agreed(&[(1.0, 0.05), (1.5, 0.05)]).is_none());
        assert!(agreed(&[(1.0, 0.05)]).is_none());
    }
}
