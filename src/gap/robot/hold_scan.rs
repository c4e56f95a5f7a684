//! Which holds of the setpoints are worth a simulation, on a clamped robot.
//!
//! What a hold changes is a narrow dip in its time, which no fixed grid meets. So many times are tried, joint by joint
//! through the linear response of joint and controller; see [`crate::gap::held_response`].

use super::bench::Bench;
use super::layout::{Channel, Row};
use super::noise::{Noise, Weighed};
use crate::gap::search::held_response::{
    HeldJoint, HeldResponse, LANES, WORTH, best_apart, finer_holds_s, tried_holds_s,
};
use crate::joint::Driven;
use crate::log::{Derivative, Hold};
use rayon::prelude::*;

/// The shortest hold, in sampling periods: setpoints that are read as a line may be held for less than one.
const FROM: f64 = 0.6;
/// Times that a set of joints may propose.
const OF_A_PLACE: usize = 6;

/// A joint in a log.
struct Held<'a> {
    row: &'a Row,
    response: HeldResponse<'a>,
    /// Columns of the noise that are not 0 there.
    uncertain: Vec<usize>,
}

/// A time, what it gains, and on which joint; `None`: on all.
type Tried = (f64, f64, Option<usize>);

/// Times \[s\] with which holds explain most of a residual on a joint, or on all, the most promising first; none where no
/// setpoint was logged with the readings.
pub(super) fn hold_scan(bench: &Bench<'_>, residual: &[f64]) -> Vec<f64> {
    let noise = bench.noise.stiffer(bench.noise.temper(residual));
    let residual = noise.weigh(residual.to_vec());
    let joints: Vec<(usize, Vec<Held<'_>>)> = bench
        .layout
        .moving()
        .into_iter()
        .map(|joint| (joint, responses(bench, joint)))
        .filter(|(_, responses)| !responses.is_empty())
        .collect();
    let ends_s = joints.iter().flat_map(|(_, responses)| responses.iter().map(|held| held.response.end_s()));
    let end_s = ends_s.fold(0.0, f64::max);
    let periods_s = joints.iter().filter_map(|(joint, _)| bench.reach[*joint].driven.map(|driven| driven.period_s));
    let period_s = periods_s.fold(f64::INFINITY, f64::min);
    if !(end_s > 0.0 && period_s.is_finite()) {
        return Vec::new();
    }
    let scanned = |holds_s: Vec<f64>| -> Vec<Tried> {
        holds_s.par_chunks(LANES).flat_map_iter(|own| gains(&noise, &residual, &joints, own)).collect()
    };
    let mut tried = scanned(tried_holds_s(end_s, period_s, FROM).collect());
    sort(&mut tried);
    let best: Vec<f64> = best_of_each(&tried, WORTH).collect();
    tried.extend(scanned(finer_holds_s(end_s, best.into_iter()).collect()));
    sort(&mut tried);
    best_apart(best_of_each(&tried, OF_A_PLACE)).collect()
}

fn sort(tried: &mut [Tried]) {
    tried.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
}

/// Times in their order, of each set of joints the first few.
fn best_of_each(tried: &[Tried], most: usize) -> impl Iterator<Item = f64> {
    let mut counts = std::collections::BTreeMap::new();
    tried.iter().filter_map(move |(_, hold_s, joint)| {
        let count = counts.entry(*joint).or_insert(0);
        *count += 1;
        (*count <= most).then_some(*hold_s)
    })
}

/// Linear response of a joint in every log that fits see in which it moves and is driven.
fn responses<'a>(bench: &'a Bench<'_>, joint: usize) -> Vec<Held<'a>> {
    let Some(id) = bench.case.model().joint_ids().nth(joint) else { return Vec::new() };
    let chain = &bench.case.nominal.joints.drive(id).chain;
    let Some(motor) = &chain.motor else { return Vec::new() };
    let (kp_nm_rad, kd_nm_s_rad) = motor.stiffness_and_damping(Driven::ByLaw);
    let of = |row: &'a Row| {
        let log = &bench.case.logs[row.log];
        let setpoints = &log.scene.setpoints;
        let column = setpoints.columns[joint].as_ref().filter(|_| setpoints.t_s == log.log.t_s)?;
        let asks_for_rate = bench.case.study.control.derivative == Derivative::Error && setpoints.hold == Hold::Linear;
        let response = HeldResponse::of(HeldJoint {
            t_s: &setpoints.t_s,
            setpoint_rad: &column.angle_rad,
            hold: setpoints.hold,
            kp_nm_rad,
            of_rate_nm_s_rad: if asks_for_rate { kd_nm_s_rad } else { 0.0 },
            inertia_kg_m2: chain.inertia_kg_m2(),
            stiffness_nm_rad: kp_nm_rad,
            damping_nm_s_rad: kd_nm_s_rad + chain.friction.viscous_nm_s_rad,
        });
        Some(Held { row, response, uncertain: bench.noise.columns_of(row.range.clone()) })
    };
    let rows = bench.layout.rows.iter().filter(|row| row.channel == Channel::Joint(joint) && bench.fits_see(row));
    rows.filter_map(of).collect()
}

/// What holds gain on each joint, and on all of them.
fn gains(noise: &Noise, residual: &Weighed, joints: &[(usize, Vec<Held<'_>>)], holds_s: &[f64]) -> Vec<Tried> {
    let mut all = vec![noise.nothing(); holds_s.len()];
    let mut gains = Vec::with_capacity((joints.len() + 1) * holds_s.len());
    for (joint, responses) in joints {
        let mut own = vec![noise.nothing(); holds_s.len()];
        for Held { row, response, uncertain } in responses {
            let moved = response.to_holds(holds_s);
            let mut piece = vec![0.0; moved.len()];
            for (lane, own) in own.iter_mut().enumerate() {
                piece.iter_mut().zip(&moved).for_each(|(piece, moved)| *piece = moved[lane]);
                noise.add(own, residual, (row.range.start, uncertain), &piece);
            }
        }
        for ((own, all), hold_s) in own.into_iter().zip(&mut all).zip(holds_s) {
            gains.push((noise.gain(&own, residual), *hold_s, Some(*joint)));
            *all += own;
        }
    }
    gains.extend(all.iter().zip(holds_s).map(|(all, hold_s)| (noise.gain(all, residual), *hold_s, None)));
    gains.retain(|(gain, ..)| gain.is_finite());
    gains
}
