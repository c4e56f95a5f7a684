//! The report of a simulated walk.

use super::WalkArgs;
use super::plan::Plan;
use crate::integrate;
use crate::report::{FollowRow, JointCurves, LegCurves, Provenance, Runaway, SpeedRow, WalkReport};
use crate::robot::simulate::{
    Footfalls, Method, PositionSensor, Recording, Scenario, TrunkCurves, Walked, follow, readings,
};
use crate::robot::{Floor, JointId};

/// A gait grows in so long before joints are compared with their setpoints [s].
const RAMP_S: f64 = 0.5;

/// What was asked for.
pub(super) struct Asked<'a> {
    pub args: &'a WalkArgs,
    pub scenario: &'a Scenario<'a>,
    pub method: Method,
    pub sensor: PositionSensor,
    /// Joints whose setpoints were beyond their limits.
    pub clipped: &'a [JointId],
    pub plan: &'a Plan,
    /// None in the air.
    pub floor: Option<&'a Floor>,
    /// What the simulation took [s].
    pub wall_s: f64,
}

/// Puts the report together.
pub(super) fn report(asked: &Asked<'_>, recording: &Recording, provenance: Provenance) -> WalkReport {
    let Asked { args, scenario, .. } = *asked;
    let model = scenario.model;
    let name = |joint: usize| model.joints()[joint].name.clone();
    let readings = readings(scenario.joints, recording, asked.sensor, args.seed);
    let duration_s = recording.t_s.last().zip(recording.t_s.first()).map_or(0.0, |(last, first)| last - first);
    let joints: Vec<FollowRow> = follow(recording, &readings, asked.plan.frequency_hz, asked.plan.stand_s + RAMP_S)
        .into_iter()
        .map(|f| FollowRow {
            joint: name(f.joint),
            amplitude_rad: f.amplitude_rad,
            amplitude_ratio: f.ratio,
            delay_s: f.delay_s,
            rms_rad: f.rms_rad,
            worst_rad: f.worst_rad,
            peak_rad_s: recording.rate_rad_s[f.joint].iter().fold(0.0, |most, w| most.max(w.abs())),
        })
        .collect();
    let speed_warnings: Vec<SpeedRow> = recording
        .warnings
        .iter()
        .map(|w| SpeedRow {
            joint: name(w.joint.index()),
            from_s: w.from_s,
            samples: w.samples,
            peak_rad_s: w.peak_rad_s,
            limit_rad_s: w.limit_rad_s,
        })
        .collect();
    let mut notes = Vec::new();
    let of_table = if asked.args.robot.is_none() { " (Table A.3)" } else { "" };
    for row in &speed_warnings {
        notes.push(format!(
            "{}: {:.2} rad/s, beyond its limit of {:.3} rad/s{of_table} in {} samples from t = {:.3} s on.",
            row.joint, row.peak_rad_s, row.limit_rad_s, row.samples, row.from_s
        ));
    }
    if !asked.clipped.is_empty() {
        let names: Vec<String> = asked.clipped.iter().map(|id| name(id.index())).collect();
        notes.push(format!("Setpoints beyond the software's limits{of_table} were clipped: {}.", names.join(", ")));
    }
    if asked.args.robot.is_some() && asked.floor.is_some() {
        let feet = model.bodies().iter().filter(|body| body.touches_floor());
        let feet: Vec<&str> = feet.map(|body| body.name.as_str()).collect();
        notes.push(format!("It stands on its {}.", feet.join(", ")));
    }
    let ground = asked.floor.and_then(|floor| Walked::of(floor, model, recording, asked.plan.stand_s));
    WalkReport {
        schema: 1,
        gait: asked.plan.name.clone(),
        robot: model.name().to_owned(),
        scenario: if asked.floor.is_some() { "floor" } else { "air" }.to_owned(),
        sentence: sentence(recording, &joints, ground.as_ref()),
        notes,
        method: in_words(asked.method),
        duration_s,
        ground,
        realtime_factor: duration_s / asked.wall_s,
        evaluations: recording.counts.evaluations,
        integration_steps: recording.counts.steps,
        diverged: recording.diverged.as_ref().map(|d| Runaway {
            at_s: d.at_s,
            joint: d.joint_name.clone(),
            why: d.why.clone(),
        }),
        joints,
        speed_warnings,
        legs: legs(asked, recording, &readings),
        trunk: asked.floor.and_then(|floor| TrunkCurves::of(floor, recording)),
        footfalls: asked.floor.map(|floor| Footfalls::of(floor, model, recording)),
        cycle: None,
        cycle_s: 1.0 / asked.plan.frequency_hz,
        provenance,
    }
}

/// What a trunk moves by less than this is no way \[m\].
const NO_WAY_M: f64 = 5e-4;

fn sentence(recording: &Recording, joints: &[FollowRow], ground: Option<&Walked>) -> String {
    if let Some(diverged) = &recording.diverged {
        let kept = recording.t_s.last().copied().unwrap_or(0.0);
        return format!("{diverged}. What was computed until t = {kept:.3} s is kept.");
    }
    if let Some(g) = ground {
        let side = if g.drift_m < 0.0 { "left" } else { "right" };
        let way = if g.displacement_m < -NO_WAY_M { "back" } else { "forward" };
        return format!(
            "From t = {} s to the end the trunk goes {:.3} m {way} ({:.3} m/s) and {:.3} m to the {side}, and bobs by \
             {:.1} mm.",
            g.from_s,
            g.displacement_m.abs(),
            g.speed_m_s.abs(),
            g.drift_m.abs(),
            1e3 * g.bob_m
        );
    }
    if joints.is_empty() {
        return "No joint was moved at the gait's frequency.".to_owned();
    }
    let worst = |of: fn(&FollowRow) -> f64| joints.iter().fold(0.0f64, |most, row| most.max(of(row).abs()));
    let amplitude = 100.0 * worst(|row| row.amplitude_ratio - 1.0);
    let (delay_ms, rms) = (1e3 * worst(|row| row.delay_s), 1e3 * worst(|row| row.rms_rad));
    format!(
        "In the air {} joints follow their setpoints to within {amplitude:.1} % of amplitude and {delay_ms:.1} ms; the largest \
         RMS error is {rms:.1} mrad.",
        joints.len()
    )
}

/// A method with its step or tolerance.
pub(super) fn in_words(method: Method) -> String {
    use integrate::Method as Smooth;
    let of = match method {
        Method::Stiff { step_s } => return format!("Stiff method, steps of {step_s:e} s"),
        Method::Smooth(of) => of,
        Method::Explicit(of) => return format!("{}, explicit throughout", in_words(Method::Smooth(of))),
    };
    match of {
        Smooth::Rk2 { step_s } => format!("Runge-Kutta 2, steps of {step_s:e} s"),
        Smooth::Rk4 { step_s } => format!("Runge-Kutta 4, steps of {step_s:e} s"),
        Smooth::DormandPrince(of) => format!("Dormand-Prince 5(4), tolerance {:e}", of.relative),
        Smooth::Adams(of) => format!("Adams, tolerance {:e}", of.relative),
        Smooth::Bdf(of) => format!("Backward differentiation, tolerance {:e}", of.relative),
    }
}

/// Curves of the legs that the robot has.
fn legs(asked: &Asked<'_>, recording: &Recording, readings: &[Vec<f64>]) -> Vec<LegCurves> {
    let model = asked.scenario.model;
    let legs = [("lf", "left front"), ("rf", "right front"), ("lr", "left rear"), ("rr", "right rear")];
    let curves = |(letters, words): (&str, &str)| {
        let joints: Vec<JointCurves> = (1..=3)
            .filter_map(|k| model.joint(&format!("{letters}{k}")).ok())
            .map(|id| JointCurves {
                name: model.joints()[id.index()].name.clone(),
                setpoint_rad: recording.setpoint_rad[id.index()].clone(),
                reading_rad: readings[id.index()].clone(),
            })
            .collect();
        (!joints.is_empty()).then(|| LegCurves { name: words.to_owned(), t_s: recording.t_s.clone(), joints })
    };
    legs.into_iter().filter_map(curves).collect()
}
