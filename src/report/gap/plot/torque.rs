//! The torque that the model lacks, against what it depends on.

use plotters::style::{Color, RGBColor};

use crate::gap::{Diagnosis, Variable};
use crate::report::ReportError;
use crate::report::gap::words;
use crate::report::plot::axis::{Axis, drawable};
use crate::report::plot::canvas::{
    AFTER, BAND_OPACITY, INK, POSITIVE, SHADE, Sign, band, band_name, block, chart, dots, filled, legend, line, notice,
    px, sketch, stroke, width,
};
use crate::report::rows::typeset_unit;

const HEIGHT: f64 = 400.0;
/// Dots of the shape's figure: enough to see it, few enough to open quickly.
const MOST_DOTS: usize = 4000;

/// Draws the binned torque against the variable that explains most of it, with the range where most of the gap lies.
pub(super) fn profile(diagnosis: &Diagnosis, variable: Variable) -> Result<String, ReportError> {
    let bins = &diagnosis.location.profile;
    let is_direction = variable == Variable::Direction;
    let torques = bins.iter().flat_map(|bin| [bin.torque_nm, bin.band_nm[0], bin.band_nm[1], 0.0]);
    let torque = Axis::over(torques, 0.06);
    let at = Axis::over(bins.iter().map(|bin| bin.at), if is_direction { 0.5 } else { 0.04 });
    let range = diagnosis.location.range.filter(|ends| !is_direction && ends.iter().all(|end| drawable(*end)));

    let limits: Vec<_> = bins.iter().map(|bin| (bin.at, bin.band_nm[0], bin.band_nm[1])).collect();
    let band_words = band_name(&limits, &torque, HEIGHT - 120.0, "N m");
    sketch(&format!("{}: missing torque against the {}", diagnosis.joint, words::variable(variable)), HEIGHT, |root| {
        let mut names = vec![
            (Sign::Dot, AFTER.to_rgba(), "mean of a bin".to_owned()),
            (Sign::Box, AFTER.mix(BAND_OPACITY), band_words),
        ];
        if range.is_some() {
            names.push((Sign::Box, SHADE.mix(0.3), "where most of the gap lies".to_owned()));
        }
        let top = legend(root, &names)?;
        let unit = typeset_unit(variable.unit());
        let label = match is_direction {
            true => "direction of motion".to_owned(),
            false => format!("{} [{unit}]", words::variable(variable)),
        };
        let mut chart = chart(root, (top, HEIGHT - 4.0), (&at, &torque), (&label, "missing torque [N m]"))?;
        if let Some([low, high]) = range {
            let on_axis = |end: f64| end.clamp(at.low(), at.high());
            block(&mut chart, [(on_axis(low), torque.low()), (on_axis(high), torque.high())], filled(SHADE, 0.18))?;
        }
        line(&mut chart, &[(at.low(), 0.0), (at.high(), 0.0)], stroke(INK, 0.5))?;
        if is_direction {
            for bin in bins {
                let [low, high] = bin.band_nm;
                line(&mut chart, &[(bin.at, low), (bin.at, high)], stroke(AFTER.mix(2.0 * BAND_OPACITY), 6.0))?;
            }
        } else {
            band(&mut chart, &limits, filled(AFTER, BAND_OPACITY))?;
        }
        let means: Vec<_> = bins.iter().map(|bin| (bin.at, bin.torque_nm)).collect();
        if !is_direction {
            line(&mut chart, &means, stroke(AFTER, 1.25))?;
        }
        dots(&mut chart, &means, 3.0, filled(AFTER, 1.0))
    })
}

/// A sample of the residual torque.
struct Sample {
    rate: f64,
    angle: f64,
    torque: f64,
}

/// Draws the shape of what no effect explains: the torque against speed and against angle, by direction of motion.
pub(super) fn shape(diagnosis: &Diagnosis) -> Result<String, ReportError> {
    let samples = samples(diagnosis);
    let torque = central(&samples);
    let rate = Axis::over(samples.iter().map(|sample| sample.rate), 0.04);
    let angle = Axis::over(samples.iter().map(|sample| sample.angle), 0.04);
    let title = format!("{}: the torque that no effect explains", diagnosis.joint);

    sketch(&title, HEIGHT, |root| {
        let mut names = vec![
            (Sign::Dot, FORWARD.to_rgba(), "while the angle grows".to_owned()),
            (Sign::Dot, BACKWARD.to_rgba(), "while it falls".to_owned()),
        ];
        let outside = samples.iter().filter(|s| !(torque.low()..=torque.high()).contains(&s.torque)).count();
        if outside > 0 {
            let words = format!("{outside} of {} samples lie outside", samples.len());
            names.push((Sign::Box, SHADE.mix(0.3), words));
        }
        let top = legend(root, &names)?;
        if samples.is_empty() {
            return notice(root, "no torque could be reconstructed from these logs");
        }
        let [left, right] = root.halves(px(width() / 2.0));
        let place = |sample: &Sample, along: bool| (if along { sample.rate } else { sample.angle }, sample.torque);
        for (half, axis, label, along) in
            [(&left, &rate, "speed [rad/s]", true), (&right, &angle, "angle [rad]", false)]
        {
            let mut chart = chart(half, (top, HEIGHT - 4.0), (axis, &torque), (label, "missing torque [N m]"))?;
            line(&mut chart, &[(axis.low(), 0.0), (axis.high(), 0.0)], stroke(INK, 0.5))?;
            for (colour, forward) in [(BACKWARD, false), (FORWARD, true)] {
                let seen = samples.iter().filter(|sample| {
                    (sample.rate > 0.0) == forward && (torque.low()..=torque.high()).contains(&sample.torque)
                });
                let points: Vec<_> = seen.map(|sample| place(sample, along)).collect();
                dots(&mut chart, &points, 1.5, filled(colour, 0.5))?;
            }
        }
        Ok(())
    })
}

const FORWARD: RGBColor = POSITIVE;
const BACKWARD: RGBColor = AFTER;

/// Samples of all logs with a torque, evenly chosen where there are many.
fn samples(diagnosis: &Diagnosis) -> Vec<Sample> {
    let all: Vec<Sample> = diagnosis
        .traces
        .iter()
        .flat_map(|log| {
            let found = &log.residual_torque;
            let states = found.rate_rad_s.iter().zip(&found.angle_rad).zip(&found.torque_nm);
            states.map(|((rate, angle), torque)| Sample { rate: *rate, angle: *angle, torque: *torque })
        })
        .filter(|sample| [sample.rate, sample.angle, sample.torque].iter().all(|value| drawable(*value)))
        .collect();
    let step = all.len().div_ceil(MOST_DOTS).max(1);
    all.into_iter().step_by(step).collect()
}

/// An axis over the torques without the outermost hundredth on either side, and with room for most of it.
fn central(samples: &[Sample]) -> Axis {
    let mut torques: Vec<f64> = samples.iter().map(|sample| sample.torque).collect();
    torques.sort_by(f64::total_cmp);
    let out = torques.len() / 100;
    Axis::over(torques[out..torques.len() - out].iter().copied().chain([0.0]), 0.15)
}
