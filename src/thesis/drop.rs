//! Figure 3.6: the drop about q1 repeated with the values that were chosen.

use super::swings::JointSwings;
use super::{Row, TablesError};
use crate::geometry::LinkBody;
use crate::identify::Named;
use crate::robot::Model;
use crate::robot::bench::{BenchDrop, Held, bench_drop};
use crate::robot::simulate::Method;

/// A measured drop and the model's.
#[derive(Clone, Debug)]
pub struct Drop {
    /// The log.
    pub file: String,
    /// Times \[s\].
    pub t_s: Vec<f64>,
    /// Readings \[rad\].
    pub measured_rad: Vec<f64>,
    /// Where the log ends \[rad\].
    pub end_rad: f64,
    /// The robot with the other joints rigid.
    pub rigid: Compared,
    /// With the other joints held by their PID.
    pub controlled: Compared,
}

/// The robot's drop beside the measured one.
#[derive(Clone, Debug)]
pub struct Compared {
    /// What its encoder reads \[rad\].
    pub model_rad: Vec<f64>,
    /// RMS of the difference \[rad\].
    pub rms_rad: f64,
    /// Where it ends \[rad\].
    pub end_rad: f64,
}

/// The drop of the first swing that the thesis would take, in the whole robot with masses and friction as chosen, from the
/// angle at which it was held.
pub(super) fn drop(
    swings: &JointSwings,
    masses_kg: Vec<(LinkBody, f64)>,
    friction: &[Row],
) -> Result<Option<Drop>, TablesError> {
    let Some(e) = swings.thesis_choice().and_then(|load| load.moving.first()) else { return Ok(None) };
    let Some([_, release_s]) = e.release_window_s else { return Ok(None) };
    let chosen = |named: Named| friction.iter().find(|row| row.quantity == named.name()).and_then(|row| row.ours);
    let extra = swings.case.items.iter().find(|item| item.entry.file == e.file).and_then(|item| item.entry.extra);
    let bench = BenchDrop {
        leg: swings.leg()?,
        extra,
        masses_kg,
        coulomb_nm: chosen(Named::Coulomb).unwrap_or(0.0),
        viscous_nm_s_rad: chosen(Named::Viscous).unwrap_or(0.0),
        stribeck: None,
        effects: Vec::new(),
        others: Vec::new(),
        zero_rad: 0.0,
        angle_rad: e.start.angle_rad,
        rate_rad_s: 0.0,
        release_s,
        held: Held::Rigid,
    };
    let compared = |held: Held| -> Result<Compared, TablesError> {
        let model_rad =
            bench_drop(Model::ers7(), &BenchDrop { held, ..bench.clone() }, &e.t_s, Method::default())?.reading_rad;
        let squares = model_rad.iter().zip(&e.measured_rad).skip(e.uncompared).map(|(a, b)| (a - b).powi(2));
        let rms_rad = (squares.sum::<f64>() / e.compared().max(1) as f64).sqrt();
        Ok(Compared { rms_rad, end_rad: model_rad.last().copied().unwrap_or(f64::NAN), model_rad })
    };
    let tail = &e.measured_rad[e.measured_rad.len() - e.measured_rad.len().div_ceil(10)..];
    Ok(Some(Drop {
        file: e.file.clone(),
        t_s: e.t_s.clone(),
        measured_rad: e.measured_rad.clone(),
        end_rad: tail.iter().sum::<f64>() / tail.len() as f64,
        rigid: compared(Held::Rigid)?,
        controlled: compared(Held::ByController)?,
    }))
}
