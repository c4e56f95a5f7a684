//! Figure 3.6: the drop about q1 repeated with the values that were chosen.

use super::swings::JointSwings;
use super::{Row, TablesError};
use crate::identify::{ExtensiveModel, JointModel, Scale, predict};

/// A measured drop and the model's.
#[derive(Clone, Debug)]
pub struct Drop {
    /// The log.
    pub file: String,
    /// Times \[s\].
    pub t_s: Vec<f64>,
    /// Readings \[rad\].
    pub measured_rad: Vec<f64>,
    /// The model's angle \[rad\].
    pub model_rad: Vec<f64>,
    /// RMS of the difference \[rad\].
    pub rms_rad: f64,
    /// Where log and model end \[rad\].
    pub ends_rad: [f64; 2],
}

/// The drop of the first swing that the thesis would take, with masses and frictions as chosen, predicted from its start.
///
/// The pendulum stands for the robot here; the full robot's drop replaces the body of this function.
pub(super) fn drop(
    swings: &JointSwings,
    masses: &[(String, f64)],
    friction: &[Row],
) -> Result<Option<Drop>, TablesError> {
    let Some(e) = swings.thesis_choice().and_then(|load| load.moving.first()) else { return Ok(None) };
    let leg = swings.leg()?;
    let nominal = swings.case.joint.nominal.as_ref();
    let one = std::slice::from_ref(e);
    let model = ExtensiveModel::bodies(&Scale::of(one, nominal, None), one, &leg.masses()?, true, nominal, false);
    let chosen = |name: &str| friction.iter().find(|row| row.quantity == name).and_then(|row| row.ours);
    let values: Vec<f64> = model
        .parameters()
        .iter()
        .map(|p| {
            let mass = masses.iter().find(|(name, _)| *name == p.name).map(|(_, value)| *value);
            mass.or_else(|| chosen(&p.name)).or(p.nominal).unwrap_or(p.start)
        })
        .collect();
    let Some(prediction) = predict(&model, one, &values)?.into_iter().next() else { return Ok(None) };
    let last = |angles: &[f64]| angles.last().copied().unwrap_or(f64::NAN);
    let tail = &e.measured_rad[e.measured_rad.len() - e.measured_rad.len().div_ceil(10)..];
    Ok(Some(Drop {
        file: e.file.clone(),
        t_s: e.t_s.clone(),
        measured_rad: e.measured_rad.clone(),
        ends_rad: [tail.iter().sum::<f64>() / tail.len() as f64, last(&prediction.angle_rad)],
        model_rad: prediction.angle_rad,
        rms_rad: prediction.rms_rad,
    }))
}
