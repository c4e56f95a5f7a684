//! A servo: everything at once that servos have, each of a size that is drawn.

use super::{Mechanism, Scene, effect};
use crate::blind::dice::Dice;
use crate::blind::truth::TrueNumber;
use crate::joint::{EffectId, Stage};
use crate::number::math;

/// One part of a servo.
pub(in crate::blind) struct Part {
    pub id: &'static str,
    /// The effect by which the catalogue knows it.
    pub effect: Option<EffectId>,
    pub stage: Stage,
    pub mechanism: Mechanism,
}

impl Part {
    pub(in crate::blind) fn of(id: EffectId, scene: &Scene<'_>, dice: &mut Dice) -> Self {
        let mechanism = effect(id, scene, dice);
        Self { id: id.id(), effect: Some(id), stage: id.stage(), mechanism }
    }
}

/// The parts of a servo whose motor brakes so much by its voltage \[N m s/rad\].
///
/// A motor fed by voltage gives `torque = kt (duty supply - kt q') / R` with a duty that ends at some share: a torque that
/// ends on the line from stall to no load, and a braking by `kt^2 / R` that adds to `kd`.
pub(in crate::blind) fn parts(scene: &Scene<'_>, back_emf_nm_s_rad: f64, dice: &mut Dice) -> Vec<Part> {
    let mut parts = vec![Part {
        id: EffectId::SpeedLimit.id(),
        effect: Some(EffectId::SpeedLimit),
        stage: EffectId::SpeedLimit.stage(),
        mechanism: duty_limit(scene, back_emf_nm_s_rad),
    }];
    parts.extend(
        [EffectId::DeadBand, EffectId::LoadFriction, EffectId::Stribeck, EffectId::Delay]
            .map(|id| Part::of(id, scene, dice)),
    );
    parts
}

/// Size: how many times the largest torque that is often commanded exceeds that of the largest duty, as a logarithm.
fn duty_limit(scene: &Scene<'_>, back_emf_nm_s_rad: f64) -> Mechanism {
    let peak_nm = 1.3 * scene.typical.torque_nm;
    // the link can still be lifted
    let least_nm = (1.1 * (0.7 * scene.peak_nm() + scene.joint.coulomb_nm)).min(0.7 * peak_nm);
    Mechanism::new([0.02, math::ln(peak_nm / least_nm)], move |size, machine| {
        let stall_nm = peak_nm * math::exp(-size);
        machine.drive.limit_nm = stall_nm;
        let no_load = stall_nm / back_emf_nm_s_rad;
        vec![TrueNumber::new("w_max", "rad/s", no_load), TrueNumber::new("tau_stall", "N m", stall_nm)]
    })
}
