//! What each effect does to one made joint: how it looks, what refitted numbers take of it up, and what looks alike.

use aibo_fit::joint::{Chain, DrivenReach, EffectForm, EffectId, Friction, Link, Motor, Reach};
use aibo_fit::log::{Hold, MotorSpec};
use aibo_fit::pendulum::{Input, Start, readings};
use std::fmt::Write as _;

const SAMPLES: u32 = 800;
const PERIOD_S: f64 = 0.005;
/// Change of the angle that a picture shows, and that is small enough to be taken to first order \[rad\].
const SHOWN_RAD: f64 = 0.06;
const SMALL_RAD: f64 = 0.008;

/// Numbers of the joint, and how each of its two motions begins.
const NUMBERS: usize = 10;
/// Inertia, moment, Coulomb, viscous, kp, kd; angle and speed at the start of the swing and of the driven motion.
const JOINT: [f64; NUMBERS] = [0.011, 0.05, 0.02, 0.004, 5.0, 0.1, 0.9, 0.0, 0.0, 0.0];
const NUDGES: [f64; NUMBERS] = [1e-4, 5e-4, 5e-4, 1e-4, 0.05, 1e-3, 1e-3, 5e-3, 1e-3, 5e-3];

fn reach() -> Reach {
    Reach {
        torque_nm: 0.5,
        coulomb_nm: 0.02,
        inertia_kg_m2: 0.011,
        speed_rad_s: 6.0,
        angle_rad: [-0.8, 0.9],
        duration_s: f64::from(SAMPLES) * PERIOD_S,
        resolution_rad: 0.0015,
        driven: Some(DrivenReach {
            command_nm: 2.0,
            speed_rad_s: 5.0,
            period_s: PERIOD_S,
            by_setpoint: true,
            by_derivative: true,
            by_integral: false,
        }),
    }
}

fn times() -> Vec<f64> {
    (0..SAMPLES).map(|k| f64::from(k) * PERIOD_S).collect()
}

/// A slow and a faster sine, and a step.
fn setpoint(t_s: f64) -> f64 {
    let step = if (1.5..3.0).contains(&t_s) { 0.3 } else { 0.0 };
    0.4 * (4.0 * t_s).sin() + 0.15 * (11.0 * t_s).sin() + step
}

/// Angles of the swing or of the driven motion; `None` where it runs away.
fn motion(joint: &[f64; NUMBERS], effect: Option<(EffectForm, &[f64])>, driven: bool) -> Option<Vec<f64>> {
    let t = times();
    let asked: Vec<f64> = t.iter().copied().map(setpoint).collect();
    let link = Link::new(joint[0], joint[1], 0.0, 9.81);
    let motor = driven.then(|| Motor::new(MotorSpec::pd(joint[4], joint[5])));
    let mut chain = Chain::new(link, Friction::coulomb_viscous(joint[2], joint[3]), motor);
    if let Some((form, values)) = effect {
        form.apply(values, joint[0], &mut chain);
    }
    let input = match driven {
        true => Input::Position { setpoint_rad: &asked, hold: Hold::Step, on: None },
        false => Input::Off,
    };
    let [angle_rad, rate_rad_s] = if driven { [joint[8], joint[9]] } else { [joint[6], joint[7]] };
    let mut angles = Vec::with_capacity(t.len());
    let start = Start { angle_rad, rate_rad_s, release_s: None };
    readings(&chain, input, &t, start, 1.0, |_, state| angles.push(state.angle_rad)).ok()?;
    Some(angles)
}

/// Both motions, one after the other.
fn both(joint: &[f64; NUMBERS], effect: Option<(EffectForm, &[f64])>) -> Option<Vec<f64>> {
    let mut all = motion(joint, effect, false)?;
    all.extend(motion(joint, effect, true)?);
    Some(all)
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn rms(a: &[f64]) -> f64 {
    (dot(a, a) / a.len() as f64).sqrt()
}

/// An effect at a size.
struct Sized {
    values: Vec<f64>,
    /// Of the angle \[rad\].
    change_rad: f64,
}

/// The searches' starting points as they change one motion.
fn sizes(effect: EffectId, driven: bool) -> Vec<Sized> {
    let plain = motion(&JOINT, None, driven).expect("the joint moves");
    let sized = |values: Vec<f64>| {
        let angles = motion(&JOINT, Some((effect.into(), &values)), driven)?;
        let change_rad = rms(&difference(&angles, &plain));
        (change_rad > 1e-6).then_some(Sized { values, change_rad })
    };
    effect.starts(&reach()).into_iter().filter_map(sized).collect()
}

fn nearest(sizes: Vec<Sized>, to_rad: f64) -> Option<Sized> {
    let far = |sized: &Sized| (sized.change_rad / to_rad).ln().abs();
    sizes.into_iter().min_by(|a, b| far(a).total_cmp(&far(b)))
}

/// A picture of an effect: the motion without and with it, and the difference below.
pub struct Picture {
    pub svg: String,
    /// Whether the motion is driven.
    pub driven: bool,
    /// The parameters at which it is drawn.
    pub values: Vec<f64>,
}

/// Draws an effect on the motion that shows it.
pub fn picture(effect: EffectId) -> Picture {
    let driven = effect.is_driven_only();
    let sized = nearest(sizes(effect, driven), SHOWN_RAD).expect("the motions show every effect");
    let without = motion(&JOINT, None, driven).expect("the joint moves");
    let with = motion(&JOINT, Some((effect.into(), &sized.values)), driven).expect("it moved before");
    let values = effect.named(&sized.values, JOINT[2]);
    Picture { svg: svg(effect, &without, &with), driven, values }
}

const WIDTH: f64 = 420.0;
const LEFT: f64 = 74.0;

fn svg(effect: EffectId, without: &[f64], with: &[f64]) -> String {
    let change: Vec<f64> = difference(with, without).iter().map(|rad| 1e3 * rad).collect();
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} 230\" width=\"{WIDTH}\" height=\"230\" \
         font-family=\"sans-serif\" font-size=\"11\" fill=\"#808080\" role=\"img\">\n<title>{effect}</title>\n"
    );
    panel(&mut svg, [10.0, 130.0], "rad", &[(without, "#909090", 1.0), (with, "#1f77b4", 1.5)]);
    panel(&mut svg, [150.0, 205.0], "mrad", &[(&change, "#d95f02", 1.2)]);
    let end_s = f64::from(SAMPLES) * PERIOD_S;
    let _ = writeln!(svg, "<text x=\"{LEFT}\" y=\"222\">0 s</text>");
    let _ = writeln!(svg, "<text x=\"{}\" y=\"222\" text-anchor=\"end\">{end_s} s</text>", WIDTH - 8.0);
    svg + "</svg>\n"
}

/// Two digits after the point where it is small.
fn short(value: f64) -> String {
    if value.abs() < 10.0 { format!("{value:.2}") } else { format!("{value:.0}") }
}

fn panel(svg: &mut String, [top, bottom]: [f64; 2], unit: &str, curves: &[(&[f64], &str, f64)]) {
    let all = || curves.iter().flat_map(|(values, ..)| values.iter().copied());
    let (low, high) = (all().fold(0.0, f64::min), all().fold(0.0, f64::max));
    let y = |value: f64| bottom - (value - low) / (high - low).max(1e-12) * (bottom - top);
    let right = WIDTH - 8.0;
    let _ = writeln!(svg, "<path d=\"M{LEFT} {:.1}H{right}\" stroke=\"#b0b0b0\" stroke-width=\"0.6\"/>", y(0.0));
    for (value, name) in [(high, format!("{} {unit}", short(high))), (low, short(low))] {
        let _ =
            writeln!(svg, "<text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{name}</text>", LEFT - 4.0, y(value) + 4.0);
    }
    for (values, colour, width) in curves {
        let x = |k: usize| LEFT + (right - LEFT) * k as f64 / (values.len() - 1) as f64;
        let points = values.iter().enumerate().step_by(4);
        let points: Vec<String> = points.map(|(k, value)| format!("{:.1},{:.1}", x(k), y(*value))).collect();
        let points = points.join(" ");
        let _ =
            writeln!(svg, "<polyline points=\"{points}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\"/>");
    }
}

/// What an effect is confused with on the swing and the driven motion together.
pub struct Alike {
    /// Share of its squares that other numbers and starts take up.
    pub by_numbers: f64,
    /// Other effects, the most alike first: share of what is left that they take up, too.
    pub effects: Vec<(EffectId, f64)>,
}

/// What every effect is confused with.
pub fn alike() -> Vec<(EffectId, Alike)> {
    let plain = both(&JOINT, None).expect("the joint moves");
    let mut basis: Vec<Vec<f64>> = Vec::new();
    for k in 0..NUMBERS {
        let nudged = |by: f64| {
            let mut joint = JOINT;
            joint[k] += by * NUDGES[k];
            both(&joint, None).expect("the joint moves")
        };
        let slope = without(&difference(&nudged(1.0), &nudged(-1.0)), &basis);
        let length = dot(&slope, &slope).sqrt();
        basis.push(slope.iter().map(|x| x / length).collect());
    }
    let change = |effect: EffectId, values: &[f64]| {
        Some(difference(&both(&JOINT, Some((effect.into(), values)))?, &plain)).filter(|change| rms(change) > 1e-6)
    };
    // An effect of several parameters has several ways to look.
    let ways = |effect: EffectId| {
        let starts = effect.starts(&reach()).into_iter();
        starts.filter_map(|values| change(effect, &values)).collect::<Vec<Vec<f64>>>()
    };
    let all: Vec<(EffectId, Vec<Vec<f64>>)> = EffectId::ALL.iter().map(|&effect| (effect, ways(effect))).collect();
    let left_of = |ways: &[Vec<f64>]| ways.iter().map(|way| without(way, &basis)).collect::<Vec<Vec<f64>>>();
    let left: Vec<(EffectId, Vec<Vec<f64>>)> = all.iter().map(|(effect, ways)| (*effect, left_of(ways))).collect();
    let small = |ways: &[Vec<f64>]| {
        let far = |way: &Vec<f64>| (rms(way) / SMALL_RAD).ln().abs();
        (0..ways.len()).min_by(|&a, &b| far(&ways[a]).total_cmp(&far(&ways[b]))).expect("the motions show every effect")
    };
    let of = |at: usize| {
        let k = small(&all[at].1);
        let (whole, rest) = (&all[at].1[k], &left[at].1[k]);
        let taken = |other: &Vec<f64>| dot(rest, other).powi(2) / (dot(rest, rest) * dot(other, other)).max(1e-300);
        let others = left.iter().filter(|(effect, _)| *effect != all[at].0);
        let best = |ways: &[Vec<f64>]| ways.iter().map(taken).fold(0.0, f64::max);
        let mut effects: Vec<(EffectId, f64)> = others.map(|(effect, ways)| (*effect, best(ways))).collect();
        effects.sort_by(|a, b| b.1.total_cmp(&a.1));
        (all[at].0, Alike { by_numbers: 1.0 - dot(rest, rest) / dot(whole, whole), effects })
    };
    (0..all.len()).map(of).collect()
}

/// What of a change no direction of the orthonormal basis takes up.
fn without(change: &[f64], basis: &[Vec<f64>]) -> Vec<f64> {
    let mut left = change.to_vec();
    // Twice, because one pass leaves rounding errors of what it takes away.
    for direction in basis.iter().chain(basis) {
        let part = dot(&left, direction);
        for (x, d) in left.iter_mut().zip(direction) {
            *x -= part * d;
        }
    }
    left
}
