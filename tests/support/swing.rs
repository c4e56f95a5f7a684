//! Free swings of a joint, made by steps so small that no integrator matters.

use std::fs;

/// A swing with friction, of a joint with I = 9e-4 kg m^2, M = 5e-3 kg m, by steps of 10 us, read in steps of 1 mrad.
/// `friction` gives Coulomb [N m] and viscous friction [N m s/rad].
pub fn swing(from_rad: f64, samples: u32, friction: [f64; 2]) -> String {
    swing_against(f64::INFINITY, from_rad, samples, friction)
}

/// The same with a stop, of 2 N m/rad and 0.004 N m s/rad, above an angle.
pub fn swing_against(stop_rad: f64, from_rad: f64, samples: u32, friction: [f64; 2]) -> String {
    let stop = |q: f64, w: f64| if q > stop_rad { -(2.0 * (q - stop_rad) + 0.004 * w).max(0.0) } else { 0.0 };
    swing_under(&stop, from_rad, samples, friction)
}

/// The same with a further torque \[N m\], a function of angle \[rad\] and rate \[rad/s\].
pub fn swing_under(further: &dyn Fn(f64, f64) -> f64, from_rad: f64, samples: u32, friction: [f64; 2]) -> String {
    const STEP_S: f64 = 1e-5;
    let [coulomb, viscous] = friction.map(|f| f / 9.0e-4);
    let (mut q, mut w, mut text) = (from_rad, 0.0_f64, String::from("t,q\n"));
    for k in 0..samples {
        text += &format!("{:.3},{:.3}\n", f64::from(k) * 0.008, q);
        for _ in 0..800 {
            let pull = -9.81 * 5.0e-3 / 9.0e-4 * q.sin() - viscous * w + further(q, w) / 9.0e-4;
            if w == 0.0 && pull.abs() <= coulomb {
                continue;
            }
            let along = if w == 0.0 { pull.signum() } else { w.signum() };
            let next = w + STEP_S * (pull - coulomb * along);
            w = if w * next < 0.0 { 0.0 } else { next };
            q += STEP_S * w;
        }
    }
    text
}

/// A study of free swings of that joint, with the nominal model given as inertia, moment, Coulomb, viscous.
pub fn swings(logs: &[(&str, String)], nominal: [&str; 4]) -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    let [inertia, moment, coulomb, viscous] = nominal;
    let mut study = format!(
        "schema = 1\n[joint]\nname = \"j\"\ninertia = {inertia}\nmoment = {moment}\ncoulomb = {coulomb}\n\
         viscous = {viscous}\nrest = 0.0\n[sensor]\nresolution = 0.001\nperiod = 0.008\n"
    );
    for (i, (role, text)) in logs.iter().enumerate() {
        fs::write(dir.path().join(format!("{i}.csv")), text).unwrap();
        study += &format!("[[log]]\nfile = \"{i}.csv\"\nrole = \"{role}\"\ndrive = \"off\"\n");
    }
    fs::write(dir.path().join("study.toml"), study).unwrap();
    dir
}
