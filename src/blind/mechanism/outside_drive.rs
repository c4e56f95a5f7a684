//! Mechanisms between setpoint and motor that the catalogue does not have.

use super::{Mechanism, Scene};
use crate::blind::dice::Dice;
use crate::blind::truth::TrueNumber;
use std::f64::consts::TAU;

/// Size: the share of the torque that is gone at the end of a log.
pub(super) fn sag() -> Mechanism {
    Mechanism::new([0.03, 0.8], move |share, machine| {
        machine.drive.sag = share;
        vec![TrueNumber::new("share", "", share)]
    })
}

/// Size: the share of the torque that swings.
pub(super) fn ripple(dice: &mut Dice) -> Mechanism {
    let (n, phi) = (dice.whole(6, 24) as f64, dice.uniform(0.0, TAU));
    Mechanism::new([0.02, 0.9], move |share, machine| {
        machine.drive.ripple = Some([share, n, phi]);
        vec![TrueNumber::new("share", "", share), TrueNumber::new("periods", "", n)]
    })
}

/// Size: by how much the gain has grown at the error that the typical torque needs.
pub(super) fn progressive(scene: &Scene<'_>) -> Mechanism {
    let typical_rad = scene.typical.torque_nm / scene.joint.kp;
    Mechanism::new([0.05, 3.0], move |growth, machine| {
        machine.drive.progressive_1_rad2 = growth / (typical_rad * typical_rad);
        vec![TrueNumber::new("growth", "", growth)]
    })
}

/// Size: the integral gain over the proportional one.
pub(super) fn integral() -> Mechanism {
    Mechanism::new([0.02, 2.0], move |rate_1_s, machine| {
        machine.drive.integral_1_s = rate_1_s;
        vec![TrueNumber::new("rate", "1/s", rate_1_s)]
    })
}
