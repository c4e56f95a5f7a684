//! Which Coulomb friction about q3 agrees with the thesis's own observation that the bare lower leg does not move?

use super::swings::JointSwings;
use super::{Printed, TablesError};
use crate::identify::{ExtensiveModel, JointModel, Scale};
use crate::pendulum::{Input, Start, rollout};

/// The bare lower leg let go level, by either table.
#[derive(Clone, Debug)]
pub struct Knee {
    /// Gravity torque on the level bare lower leg \[N m\].
    pub gravity_nm: f64,
    /// Coulomb friction by Tables 3.3 and 3.4 \[N m\].
    pub coulomb_nm: [f64; 2],
    /// How far it moves by either \[rad\].
    pub moves_rad: [f64; 2],
    /// Coulomb friction that the swings with extra mass show, with its interval \[N m\].
    pub found: Option<(f64, [f64; 2])>,
    /// Times \[s\] and angles from hanging by either \[rad\].
    pub t_s: Vec<f64>,
    /// By Table 3.3, by Table 3.4.
    pub angle_rad: [Vec<f64>; 2],
    /// Bare swings in the folder that did not move, and all of them.
    pub still: [usize; 2],
}

/// Lets the bare lower leg go from level; `None` where the thesis has no rows for it.
pub(super) fn knee(swings: &JointSwings, found: Option<(f64, [f64; 2])>) -> Result<Option<Knee>, TablesError> {
    let printed = Printed::embedded();
    let (Some(estimated), Some(chosen)) = (printed.estimated(swings.joint), printed.chosen(swings.joint)) else {
        return Ok(None);
    };
    let leg = swings.leg()?;
    let (masses, moving) = (leg.masses()?, swings.moving());
    let Some(e) = moving.first() else { return Ok(None) };
    let mut bare = e.clone();
    bare.load = None;
    let nominal = swings.case.joint.nominal.as_ref();
    let one = std::slice::from_ref(&bare);
    let model = ExtensiveModel::bodies(&Scale::of(one, nominal, None), one, &masses, true, nominal, false);
    let t_s: Vec<f64> = (0..=500).map(|k| f64::from(k) * 0.01).collect();
    let mut gravity_nm = 0.0;
    let mut swing = |coulomb_nm: f64, viscous_nm_s_rad: f64| -> Result<Vec<f64>, TablesError> {
        let mut values: Vec<f64> = masses.iter().map(|m| m.nominal_kg).collect();
        values.extend([coulomb_nm, viscous_nm_s_rad, 0.0]);
        let chain = model.chain(&values, &bare);
        gravity_nm = chain.link.peak_gravity_nm();
        let hanging = chain.link.hanging_rad();
        let level = hanging + std::f64::consts::FRAC_PI_2;
        let start = Start { angle_rad: level, rate_rad_s: 0.0, release_s: None };
        let mut angle = Vec::with_capacity(t_s.len());
        rollout(&chain, Input::Off, &t_s, start, |_, s| angle.push(s.angle_rad - hanging))?;
        Ok(angle)
    };
    let angle_rad =
        [swing(estimated.coulomb_nm, estimated.viscous_nm_s_rad)?, swing(chosen.coulomb_nm, chosen.viscous_nm_s_rad)?];
    let moves_rad = [0, 1].map(|k: usize| {
        let angle = &angle_rad[k];
        angle.iter().map(|a| (a - angle[0]).abs()).fold(0.0, f64::max)
    });
    let still = swings.bare().map_or([0, 0], |load| [load.still.len(), load.still.len() + load.moving.len()]);
    Ok(Some(Knee {
        gravity_nm,
        coulomb_nm: [estimated.coulomb_nm, chosen.coulomb_nm],
        moves_rad,
        found,
        t_s,
        angle_rad,
        still,
    }))
}
