//! Table 3.1: two ratios from swings with two extra masses, mass and friction from the ratios (3.2-3.6).

use super::swings::{JointSwings, Load};
use super::{Of, Printed, Row, TablesError};
use crate::identify::{Estimate, Fitted, Named, SimpleModel, Status};
use crate::pendulum::{RatioTest, SimpleEstimate};
use rayon::prelude::*;

/// Table 3.1 of one joint.
#[derive(Clone, Debug)]
pub struct RatioTable {
    /// Both ratios of both tests, mass and friction, `g/L` fitted.
    pub fitted: Vec<Row>,
    /// The same with `g/L` set to what the thesis prints in both tests.
    pub set: Vec<Row>,
    /// Mass and friction by (3.5) and (3.6) from the printed ratios, with the interval that their rounding leaves.
    pub arithmetic: Vec<Row>,
    /// The fits with `g/L` fitted, for Figure 3.2.
    pub fits: Vec<Fitted<SimpleModel>>,
}

/// Table 3.1 of one joint.
pub(super) fn table(swings: &JointSwings) -> Result<RatioTable, TablesError> {
    let printed = Printed::embedded().ratios(swings.joint);
    let tests: Vec<&Load> = swings.loaded().take(2).collect();
    let set = printed.map(|row| row.g_over_l_1_s2);
    let variants = [None, set];
    let mut fits: Vec<Vec<Fitted<SimpleModel>>> = variants
        .par_iter()
        .map(|set| {
            let fit = |(k, load): (usize, &&Load)| swings.simple(&load.moving, set.map(|set| set[k]));
            tests.par_iter().enumerate().map(fit).collect::<Result<_, _>>()
        })
        .collect::<Result<_, TablesError>>()?;
    let gravity_m_s2 = swings.case.joint.gravity_m_s2;
    let of = || Of::Joint(swings.joint.to_string());
    let rows = |fits: &[Fitted<SimpleModel>]| {
        let mut rows = Vec::new();
        for (k, (load, fit)) in tests.iter().zip(fits).enumerate() {
            for (named, unit, thesis) in [
                (Named::BOverMl2, "1/s", printed.map(|row| row.b_over_ml2_1_s[k])),
                (Named::GOverL, "1/s^2", printed.map(|row| row.g_over_l_1_s2[k])),
            ] {
                let row = Row::new(of(), named.name(), &load.name, unit, thesis);
                rows.push(fit.estimate(named).map_or(row.clone(), |e| with_estimate(row, e)));
            }
        }
        let [mass, friction] = solved(&tests, fits, gravity_m_s2);
        for (name, unit, thesis, found) in [
            ("mass", "kg", printed.map(|row| row.mass_kg), mass),
            ("friction", "N m s/rad", printed.map(|row| row.friction_nm_s_rad), friction),
        ] {
            let row = Row::new(of(), name, "both", unit, thesis);
            rows.push(match found {
                Some((ours, interval)) => row.estimated(ours, interval),
                None => Row { remark: "the ratios are not determined".into(), ..row },
            });
        }
        rows
    };
    let (fitted, set) = (rows(&fits[0]), rows(&fits[1]));
    let arithmetic = printed.map(|row| arithmetic(row, gravity_m_s2)).unwrap_or_default();
    Ok(RatioTable { fitted, set, arithmetic, fits: fits.swap_remove(0) })
}

fn with_estimate(row: Row, e: &Estimate) -> Row {
    match (e.status, e.interval) {
        (Status::Determined, Some(interval)) => row.estimated(e.value, interval),
        (Status::Held, _) => Row { ours: Some(e.value), remark: "set".into(), ..row },
        _ => Row { remark: "not determined".into(), ..row },
    }
}

/// An estimate with its interval.
type Found = Option<(f64, [f64; 2])>;

/// Mass and friction from two fits, with 95 % intervals by the delta method; `None` where a ratio is not determined.
fn solved(tests: &[&Load], fits: &[Fitted<SimpleModel>], gravity_m_s2: f64) -> [Found; 2] {
    let ratios = |k: usize| -> Option<[f64; 4]> {
        let (v, s) = (fits.get(k)?.estimate(Named::BOverMl2)?, fits[k].estimate(Named::GOverL)?);
        let half = |e: &Estimate| match e.status {
            Status::Determined => e.interval.map(|[low, high]| 0.5 * (high - low)),
            Status::Held => Some(0.0),
            Status::NotDetermined => None,
        };
        Some([v.value, s.value, half(v)?, half(s)?])
    };
    let (Some(first), Some(second)) = (ratios(0), ratios(1)) else { return [None, None] };
    let at = |x: [f64; 4]| {
        let test = |k: usize, v: f64, s: f64| RatioTest {
            extra_mass_kg: tests[k].extra_mass_kg,
            damping_per_s: v,
            stiffness_per_s2: s,
        };
        SimpleEstimate::from_tests(&test(0, x[0], x[1]), &test(1, x[2], x[3]), gravity_m_s2)
            .map(|e| [e.mass_kg, e.friction_nm_s_rad])
    };
    let middle = [first[0], first[1], second[0], second[1]];
    let halves = [first[2], first[3], second[2], second[3]];
    let Ok(value) = at(middle) else { return [None, None] };
    std::array::from_fn(|which| {
        let mut squares = 0.0;
        for (i, half) in halves.iter().enumerate() {
            let shifted = |share: f64| {
                let mut x = middle;
                x[i] += share * half;
                at(x).map(|values| values[which])
            };
            // A small share of the interval: (3.5) is steep, and the delta method is about its slope.
            let (Ok(up), Ok(down)) = (shifted(0.01), shifted(-0.01)) else { return None };
            squares += (50.0 * (up - down)).powi(2);
        }
        let half = f64::sqrt(squares);
        Some((value[which], [value[which] - half, value[which] + half]))
    })
}

/// (3.5) and (3.6) on the printed ratios; the interval is the range that their last digits leave open.
fn arithmetic(row: &super::printed::RatioRow, gravity_m_s2: f64) -> Vec<Row> {
    let rounding = Printed::embedded().rounding;
    let at = |v: [f64; 2], s: [f64; 2]| {
        let test =
            |k: usize| RatioTest { extra_mass_kg: row.extra_mass_kg[k], damping_per_s: v[k], stiffness_per_s2: s[k] };
        SimpleEstimate::from_tests(&test(0), &test(1), gravity_m_s2).map(|e| [e.mass_kg, e.friction_nm_s_rad])
    };
    let Ok(exact) = at(row.b_over_ml2_1_s, row.g_over_l_1_s2) else { return Vec::new() };
    // Mass and friction are monotonic in each ratio, so that their extremes lie at the corners.
    let mut range = [[exact[0]; 2], [exact[1]; 2]];
    for corner in 0..16u8 {
        let sign = |bit: u8| if corner >> bit & 1 == 1 { 1.0 } else { -1.0 };
        let v = [0, 1].map(|k| row.b_over_ml2_1_s[k] + sign(k as u8) * rounding.b_over_ml2_1_s);
        let s = [0, 1].map(|k| row.g_over_l_1_s2[k] + sign(k as u8 + 2) * rounding.g_over_l_1_s2);
        for (range, value) in range.iter_mut().zip(at(v, s).unwrap_or(exact)) {
            *range = [range[0].min(value), range[1].max(value)];
        }
    }
    let of = || Of::Joint(row.joint.to_string());
    let cells = [
        ("mass", "kg", row.mass_kg, rounding.mass_kg),
        ("friction", "N m s/rad", row.friction_nm_s_rad, rounding.friction_nm_s_rad),
    ];
    cells
        .into_iter()
        .enumerate()
        .map(|(i, (name, unit, printed, half_digit))| {
            let row = Row::new(of(), name, "printed ratios", unit, Some(printed)).estimated(exact[i], range[i]);
            let row = Row { half_digit, ..row };
            let follows = row.inside() == Some(true);
            let remark = if follows { "follows from the ratios" } else { "does not follow from its own ratios" };
            Row { remark: remark.into(), ..row }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_3_1_follows_from_its_ratios_but_for_the_mass_of_q1() {
        for printed in &Printed::embedded().table_3_1 {
            for row in arithmetic(printed, 9.81) {
                let exception = row.of.name() == "q1" && row.quantity == "mass";
                assert_eq!(row.remark == "follows from the ratios", !exception, "{row:?}");
            }
        }
    }
}
