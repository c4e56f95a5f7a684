//! A recording as a log of several joints.

use super::{Accelerometer, Joints, PositionSensor, Recording};
use crate::robot::Model;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use std::fmt::Write as _;

/// What the encoders say of every sample, by joint \[rad\]; the same seed gives the same noise.
pub fn readings(joints: &Joints, recording: &Recording, sensor: PositionSensor, seed: u64) -> Vec<Vec<f64>> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut read = |(drive, angles): (&super::JointDrive, &Vec<f64>)| {
        angles.iter().map(|angle| sensor.read(drive.reading_rad(*angle), &mut rng)).collect()
    };
    joints.drives().iter().zip(&recording.angle_rad).map(&mut read).collect()
}

/// Writes a recording in the log format: `t`, then `<joint>.q` (through encoder and sensor), `<joint>.q_ref` and
/// `<joint>.tau` (the motor's torque) of every joint, `base.x` to `base.yaw`, and the accelerometers.
pub fn log_csv(model: &Model, joints: &Joints, recording: &Recording, sensor: PositionSensor, seed: u64) -> String {
    let mut text = String::from("t");
    let driven: Vec<bool> =
        recording.setpoint_rad.iter().map(|column| column.first().is_some_and(|q| q.is_finite())).collect();
    for (joint, driven) in model.joints().iter().zip(&driven) {
        let _ = write!(text, ",{}.q", joint.name);
        if *driven {
            let _ = write!(text, ",{0}.q_ref,{0}.tau", joint.name);
        }
    }
    text.push_str(",base.x,base.y,base.z,base.roll,base.pitch,base.yaw,acc.x,acc.y,acc.z\n");
    let readings = readings(joints, recording, sensor, seed);
    let accelerometer = Accelerometer::default();
    for (k, t) in recording.t_s.iter().enumerate() {
        let _ = write!(text, "{t:.6}");
        for (j, driven) in driven.iter().enumerate() {
            let _ = write!(text, ",{:.7}", readings[j][k]);
            if *driven {
                let _ = write!(text, ",{:.7},{:.7}", recording.setpoint_rad[j][k], recording.motor_nm[j][k]);
            }
        }
        let base = &recording.base[k];
        let felt = accelerometer.read(&base.felt_m_s2);
        for number in base.position_m.iter().copied().chain(base.roll_pitch_yaw_rad()).chain(felt.iter().copied()) {
            let _ = write!(text, ",{number:.7}");
        }
        text.push('\n');
    }
    text
}
