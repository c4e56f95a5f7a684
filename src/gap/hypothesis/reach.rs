//! How far a study's logs reach, which gives every effect its typical sizes.

use crate::identify::{Experiment, Signal};
use crate::joint::{DrivenReach, Reach};
use crate::log::Nominal;
use crate::number::{extent, math};

/// Angles that travel less do not move \[rad\].
const MOVES_RAD: f64 = 0.01;

/// The reach of all experiments together.
pub(crate) fn reach_of(experiments: &[Experiment], nominal: &Nominal) -> Reach {
    let most = |f: &dyn Fn(&Experiment) -> f64| experiments.iter().map(f).fold(0.0, f64::max);
    let gravity_nm = most(&|e| {
        let load = e.load.map_or(0.0, |l| l.moment_kg_m);
        let widest = e.measured_rad.iter().map(|q| math::sin(*q).abs()).fold(0.0, f64::max);
        (nominal.moment_kg_m + load) * e.gravity_m_s2 * widest.max(0.3)
    });
    let speed = |e: &Experiment| largest_speed(&e.t_s, &e.measured_rad);
    let angle_rad = extent(experiments.iter().flat_map(|e| &e.measured_rad).copied());
    let driven = || experiments.iter().filter(|e| e.is_driven());
    let by_law = || driven().filter(|e| matches!(e.signal, Signal::Position { .. })).filter_map(|e| e.motor);
    let command_nm = driven().map(Experiment::largest_command_nm).fold(0.0, f64::max);
    let speed_rad_s = most(&speed).max(0.1);
    Reach {
        torque_nm: if gravity_nm > 0.0 { gravity_nm } else { command_nm.max(1e-6) },
        coulomb_nm: nominal.coulomb_nm,
        inertia_kg_m2: nominal.inertia_kg_m2,
        speed_rad_s,
        angle_rad,
        duration_s: most(&|e| e.t_s.last().copied().unwrap_or(0.0)).max(0.1),
        resolution_rad: most(&|e| e.resolution_rad),
        driven: (driven().count() > 0 && command_nm > 0.0).then(|| DrivenReach {
            command_nm,
            speed_rad_s: driven().map(speed).fold(0.0, f64::max).max(0.1),
            period_s: driven().map(|e| mean_period_s(&e.t_s)).fold(f64::INFINITY, f64::min),
            by_setpoint: driven().any(|e| matches!(e.signal, Signal::Position { .. })),
            by_derivative: by_law().any(|law| law.kd_nm_s_rad != 0.0),
            by_integral: by_law().any(|law| law.ki_nm_rad_s != 0.0),
        }),
    }
}

/// What samples are apart on average \[s\], so that the last one ends a whole number of them.
pub(in crate::gap) fn mean_period_s(t_s: &[f64]) -> f64 {
    (t_s[t_s.len() - 1] - t_s[0]) / (t_s.len() - 1) as f64
}

/// Whether a joint along its angles, or what is asked of one, goes anywhere.
pub(in crate::gap) fn travels(angle_rad: &[f64]) -> bool {
    let [low, high] = extent(angle_rad.iter().copied());
    high - low > MOVES_RAD
}

/// Largest speed over stretches of about 50 ms, which quantisation does not inflate much \[rad/s\].
fn largest_speed(t_s: &[f64], q_rad: &[f64]) -> f64 {
    let stride = ((0.05 * t_s.len() as f64 / (t_s[t_s.len() - 1] - t_s[0])) as usize).clamp(1, t_s.len() - 1);
    (stride..t_s.len()).map(|k| ((q_rad[k] - q_rad[k - stride]) / (t_s[k] - t_s[k - stride])).abs()).fold(0.0, f64::max)
}
