//! Mechanisms between setpoint and motor that the catalogue does not have.

use super::{Mechanism, Scene};
use crate::blind::truth::TrueNumber;

/// Size: the share of the torque that is gone at the end of a log.
pub(super) fn sag() -> Mechanism {
    Mechanism::new([0.03, 0.8], move |share, machine| {
        machine.drive.sag = share;
        vec![TrueNumber::new("share", "", share)]
    })
}

/// Size: the error below which the controller does nothing.
pub(super) fn dead_zone() -> Mechanism {
    Mechanism::new([0.002, 0.2], move |zone_rad, machine| {
        machine.drive.dead_zone_rad = zone_rad;
        vec![TrueNumber::new("zone", "rad", zone_rad)]
    })
}

/// Size: how many times six times the typical speed exceeds the setpoint's fastest motion, as a logarithm.
pub(super) fn slew(scene: &Scene<'_>) -> Mechanism {
    let fast = 6.0 * scene.typical.driven_speed_rad_s;
    Mechanism::new([0.05, 3.0], move |size, machine| {
        let rate = fast * (-size).exp();
        machine.drive.slew_rad_s = rate;
        vec![TrueNumber::new("rate", "rad/s", rate)]
    })
}
