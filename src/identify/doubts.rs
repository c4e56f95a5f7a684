//! Numbers of a study that no joint has which moves like its logs: questions, not errors.
//!
//! A unit that is wrong by a factor of a thousand is the commonest slip. What is stated is held against what the logs show by
//! energy and torque alone, without simulating anything, and with so much room that no honest guess is questioned.

use super::case::{Case, Item};
use crate::geometry::inertia::hollow_cylinder_across;
use crate::log::{Derivative, DriveMode, MotorModel, MotorSpec, Nominal};
use std::f64::consts::PI;

/// No link is longer than this \[m\].
const LONGEST_M: f64 = 10.0;
/// By so much the energy of a link may exceed what gravity and drive can give it over its travel.
const ENERGY: f64 = 30.0;
/// By so much a torque may exceed what acts in the logs.
const TORQUE: f64 = 10.0;
/// By so much Coulomb friction may: by more the joint would not move at all.
const HOLD: f64 = 3.0;
/// By so much a free swing may be slower or faster than stated.
const FREQUENCY: f64 = 10.0;
/// What is said of a servo on a joint that nothing slows down.
const UNDAMPED: &str = "Nothing damps this joint as stated: kd, coulomb and viscous are 0, so the model as given rings about its \
     setpoints without end. State kd or a friction, even as a guess.";

/// What is said of a servo that pulls at nothing.
const UNMOVED: &str = "kp is 0 in a log whose drive is \"position\": no setpoint moves the joint as stated. State kp in N m/rad, or \
     drive = \"off\" where the motor was off.";

/// From so many reversals on a swing has a frequency.
const SWINGS: usize = 2;

impl Case {
    /// Logs whose columns do not belong together as the study says, and numbers of it that are far from any joint that moves like
    /// its logs, in sentences; empty where all may be.
    pub fn doubts(&self) -> Vec<String> {
        let crossed = self.crossed();
        // Columns that are wrong make every number look wrong.
        if crossed.is_empty() {
            self.far_off().into_iter().chain(self.undamped()).chain(self.unmoved()).collect()
        } else {
            crossed
        }
    }

    /// Whether columns do not belong together as the study says: whatever is made of them looks wrong.
    pub(crate) fn has_crossed_columns(&self) -> bool {
        !self.crossed().is_empty()
    }

    /// Whether the link is computed from a robot's description, and not stated.
    pub(crate) fn is_described(&self) -> bool {
        self.items.iter().flat_map(|item| &item.experiments).any(|e| e.carriage.is_some())
    }

    /// A servo on a joint that nothing slows down: a model with a number left out, not a machine.
    fn undamped(&self) -> Option<String> {
        self.joint.nominal.filter(|n| n.coulomb_nm == 0.0 && n.viscous_nm_s_rad == 0.0)?;
        let is_bare =
            |motor: &MotorSpec| motor.model == MotorModel::Torque && motor.kd_nm_s_rad == 0.0 && motor.kp_nm_rad > 0.0;
        let has =
            |item: &Item| item.entry.drive == DriveMode::Position && item.entry.motor.as_ref().is_some_and(is_bare);
        self.items.iter().any(has).then(|| UNDAMPED.to_owned())
    }

    /// A servo whose setpoints move nothing.
    fn unmoved(&self) -> Option<String> {
        let pulls = |motor: &MotorSpec| motor.kp_nm_rad > 0.0 || motor.ki_nm_rad_s > 0.0;
        let is_limp = |item: &Item| {
            item.entry.drive == DriveMode::Position && item.entry.motor.as_ref().is_some_and(|motor| !pulls(motor))
        };
        self.items.iter().any(is_limp).then(|| UNMOVED.to_owned())
    }

    fn far_off(&self) -> Vec<String> {
        // A robot's link may well hang on an axis that stands upright.
        let Some(nominal) = self.joint.nominal.filter(|_| !self.is_described()) else { return Vec::new() };
        let mut doubts: Vec<String> = long_lever(&nominal).into_iter().collect();
        let moved = || self.items.iter().filter(|item| item.health.moved);
        let acting = |item: &Item| Acting::of(item, &nominal, self.joint.gravity_m_s2);
        let first = |doubt: &dyn Fn(&Item, &Acting) -> Option<String>| {
            moved().find_map(|item| doubt(item, &acting(item)).map(|words| format!("{words} ({})", item.entry.file)))
        };
        doubts.extend(first(&|item, acting| too_heavy(item, acting, &nominal)).filter(|_| doubts.is_empty()));
        doubts.extend(first(&|item, acting| too_rough(item, acting, &nominal)));
        doubts.extend(first(&|item, acting| too_much_gravity(item, acting)));
        doubts.extend(first(&held_back));
        doubts.extend(first(&|item, acting| other_swing(item, acting)).filter(|_| doubts.is_empty()));
        doubts
    }
}

/// What acts on a joint in a log, at the most.
struct Acting {
    /// Of gravity, extra mass included \[N m\].
    gravity_nm: f64,
    /// Of the drive \[N m\]; infinite where it is not known.
    drive_nm: f64,
    /// Of link, extra mass and armature \[kg m^2\].
    inertia_kg_m2: f64,
}

impl Acting {
    fn of(item: &Item, nominal: &Nominal, gravity_m_s2: f64) -> Self {
        let of_extra = item.entry.extra.map_or([0.0; 2], |extra| {
            let across_kg_m2 = hollow_cylinder_across(extra.mass_kg, extra.radius_m, extra.length_m);
            let moment_kg_m = extra.mass_kg * extra.distance_m;
            [moment_kg_m, across_kg_m2 + moment_kg_m * extra.distance_m]
        });
        let drive_nm = match item.entry.drive {
            DriveMode::Off => 0.0,
            DriveMode::Torque => largest(item.log.tau_nm.iter().flatten().copied()),
            DriveMode::Position => item.entry.motor.as_ref().map_or(f64::INFINITY, |motor| asked_nm(item, motor)),
        };
        let armature_kg_m2 = item.entry.motor.as_ref().map_or(0.0, |motor| motor.armature_kg_m2);
        Self {
            gravity_nm: gravity_m_s2 * (nominal.moment_kg_m + of_extra[0]),
            drive_nm,
            inertia_kg_m2: nominal.inertia_kg_m2 + of_extra[1] + armature_kg_m2,
        }
    }

    fn all_nm(&self) -> f64 {
        self.gravity_nm + self.drive_nm
    }
}

/// What a servo gives at the most, by its law and its limits \[N m\].
fn asked_nm(item: &Item, motor: &MotorSpec) -> f64 {
    let law = motor.kp_nm_rad * largest_error_rad(item) + motor.kd_nm_s_rad * item.health.top_speed_rad_s;
    match motor.model {
        MotorModel::Torque if motor.ki_nm_rad_s == 0.0 => motor.torque_limit_nm.map_or(law, |limit| law.min(limit)),
        _ => motor.torque_limit_nm.unwrap_or(f64::INFINITY),
    }
}

/// How far readings are from their setpoints at the most; infinite where there are none.
fn largest_error_rad(item: &Item) -> f64 {
    let log = &item.log;
    match (&log.q_ref_rad, &log.setpoints) {
        (Some(q_ref), _) => largest(q_ref.iter().zip(&log.q_rad).map(|(asked, read)| asked - read)),
        // Their stamps are not those of the readings; the widest that they can be apart will do.
        (None, Some(own)) => largest(own.values.iter().copied()) + largest(log.q_rad.iter().copied()),
        (None, None) => f64::INFINITY,
    }
}

fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).filter(|value| value.is_finite()).fold(0.0, f64::max)
}

/// What a link's inertia would say of its length, where no link is that long.
fn long_lever(nominal: &Nominal) -> Option<String> {
    let length_m = nominal.inertia_kg_m2 / nominal.moment_kg_m;
    (length_m.is_finite() && length_m > LONGEST_M).then(|| {
        format!(
            "The stated inertia and moment are those of a pendulum of {length_m:.0} m (inertia / moment): is the inertia in \
             kg m^2 and the moment in kg m, or is a geared rotor in it (`armature` in [motor])?"
        )
    })
}

fn too_heavy(item: &Item, acting: &Acting, nominal: &Nominal) -> Option<String> {
    let speed_rad_s = item.health.top_speed_rad_s;
    let carried_j = 0.5 * acting.inertia_kg_m2 * speed_rad_s * speed_rad_s;
    let given_j = acting.all_nm() * item.health.travel_rad;
    (carried_j > ENERGY * given_j).then(|| {
        format!(
            "The stated inertia, {} kg m^2, would carry {carried_j:.2} J at the log's {speed_rad_s:.1} rad/s, and gravity and \
             drive as stated give {given_j:.3} J over its travel: is it in kg m^2?",
            nominal.inertia_kg_m2
        )
    })
}

fn too_rough(item: &Item, acting: &Acting, nominal: &Nominal) -> Option<String> {
    let (all_nm, speed_rad_s) = (acting.all_nm(), item.health.top_speed_rad_s);
    if nominal.coulomb_nm > HOLD * all_nm {
        return Some(format!(
            "The stated Coulomb friction, {} N m, would hold the joint against all that gravity and drive as stated give \
             ({all_nm:.3} N m), and it moved: is it in N m?",
            nominal.coulomb_nm
        ));
    }
    let viscous_nm = nominal.viscous_nm_s_rad * speed_rad_s;
    (viscous_nm > TORQUE * all_nm).then(|| {
        format!(
            "The stated viscous friction, {} N m s/rad, would take {viscous_nm:.2} N m at the log's {speed_rad_s:.1} rad/s, and \
             gravity and drive as stated give {all_nm:.3} N m: is it in N m s/rad?",
            nominal.viscous_nm_s_rad
        )
    })
}

fn too_much_gravity(item: &Item, acting: &Acting) -> Option<String> {
    let asked_nm = acting.gravity_nm * item.health.travel_rad.min(1.0);
    let is_driven = item.entry.drive == DriveMode::Position;
    (is_driven && asked_nm > TORQUE * acting.drive_nm).then(|| {
        format!(
            "Gravity as stated asks for {asked_nm:.2} N m over the log's travel, and the drive as stated gives {:.3} N m at the \
             most: is the moment in kg m, and kp in N m/rad?",
            acting.drive_nm
        )
    })
}

/// A servo whose own damping would not let its joint move as fast as it did.
fn held_back(item: &Item, acting: &Acting) -> Option<String> {
    let motor = item.entry.motor.as_ref().filter(|_| item.entry.drive == DriveMode::Position)?;
    let is_plain = motor.model == MotorModel::Torque && motor.ki_nm_rad_s == 0.0;
    let (kp, kd) = (motor.kp_nm_rad, motor.kd_nm_s_rad);
    let (pull_nm, speed_rad_s) = (acting.gravity_nm + kp * largest_error_rad(item), item.health.top_speed_rad_s);
    let holds = is_plain && motor.derivative == Derivative::Measurement && kd * speed_rad_s > TORQUE * pull_nm;
    holds.then(|| {
        format!(
            "The stated kd, {kd} N m s/rad, would brake with {:.2} N m at the log's {speed_rad_s:.1} rad/s, and gravity and kp as \
             stated pull with {pull_nm:.3} N m: is it in N m s/rad?",
            kd * speed_rad_s
        )
    })
}

fn other_swing(item: &Item, acting: &Acting) -> Option<String> {
    let health = &item.health;
    if item.entry.drive != DriveMode::Off || health.reversals < SWINGS {
        return None;
    }
    // What rests at the end swings no more.
    let swings_s = health.rest_from_s.map_or(health.duration_s, |rest_s| rest_s - item.log.t_s[0]);
    let seen_hz = health.reversals as f64 / (2.0 * swings_s);
    let stated_hz = (acting.gravity_nm / acting.inertia_kg_m2).sqrt() / (2.0 * PI);
    let ratio = stated_hz / seen_hz;
    (ratio.is_finite() && !(FREQUENCY.recip()..FREQUENCY).contains(&ratio)).then(|| {
        format!(
            "With the stated inertia and moment it would swing {stated_hz:.2} times a second, and it swings {seen_hz:.2} times: \
             are they in kg m^2 and kg m?"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// The demonstration's doubts with other numbers.
    fn with(study: &str, change: impl Fn(&mut Nominal)) -> Vec<String> {
        let mut case = Case::of_study(Path::new(study)).unwrap();
        change(case.joint.nominal.as_mut().unwrap());
        case.doubts()
    }

    const DRIVEN: &str = "data/examples/delay/study.toml";
    const FREE: &str = "data/examples/ambiguous/study.toml";

    #[test]
    fn honest_numbers_are_not_questioned() {
        for study in [DRIVEN, FREE] {
            assert_eq!(with(study, |_| {}), [""; 0], "{study}");
            let guess = |n: &mut Nominal| {
                (n.inertia_kg_m2, n.coulomb_nm, n.viscous_nm_s_rad) =
                    (3.0 * n.inertia_kg_m2, 3.0 * n.coulomb_nm, n.viscous_nm_s_rad / 3.0);
            };
            assert_eq!(with(study, guess), [""; 0], "{study}");
        }
    }

    #[test]
    fn a_servo_without_any_damping_is_questioned() {
        let undamped = |kd_nm_s_rad: f64| {
            let mut case = Case::of_study(Path::new(DRIVEN)).unwrap();
            let nominal = case.joint.nominal.as_mut().unwrap();
            (nominal.coulomb_nm, nominal.viscous_nm_s_rad) = (0.0, 0.0);
            case.items.iter_mut().for_each(|item| item.entry.motor.as_mut().unwrap().kd_nm_s_rad = kd_nm_s_rad);
            case.doubts()
        };
        assert_eq!(undamped(0.0), [UNDAMPED]);
        assert_eq!(undamped(0.1), [""; 0]);
    }

    #[test]
    fn a_servo_that_pulls_at_nothing_is_questioned() {
        let mut case = Case::of_study(Path::new(DRIVEN)).unwrap();
        case.items[0].entry.motor.as_mut().unwrap().kp_nm_rad = 0.0;
        assert_eq!(case.doubts(), [UNMOVED]);
    }

    #[test]
    fn a_servo_that_would_hold_its_own_joint_back_is_questioned() {
        let damped = |kd_nm_s_rad: f64| {
            let mut case = Case::of_study(Path::new(DRIVEN)).unwrap();
            case.items.iter_mut().for_each(|item| item.entry.motor.as_mut().unwrap().kd_nm_s_rad = kd_nm_s_rad);
            case.doubts()
        };
        assert!(damped(150.0).iter().any(|doubt| doubt.starts_with("The stated kd, 150 N m s/rad")));
        assert_eq!(damped(0.6), [""; 0]);
    }

    #[test]
    fn a_number_a_thousand_times_off_is_questioned_with_its_size() {
        type Change = fn(&mut Nominal);
        let cases: [(&str, Change, &str); 6] = [
            (DRIVEN, |n| n.inertia_kg_m2 = 19.0, "pendulum of 380 m"),
            (DRIVEN, |n| (n.inertia_kg_m2, n.moment_kg_m) = (11.0, 0.0), "stated inertia, 11 kg m^2"),
            (DRIVEN, |n| n.coulomb_nm = 200.0, "Coulomb friction, 200 N m"),
            (DRIVEN, |n| n.viscous_nm_s_rad = 300.0, "viscous friction, 300 N m s/rad"),
            (DRIVEN, |n| n.moment_kg_m = 500.0, "Gravity as stated asks for"),
            (FREE, |n| n.inertia_kg_m2 /= 1000.0, "times a second"),
        ];
        for (study, change, words) in cases {
            let doubts = with(study, change).join("\n");
            assert!(doubts.contains(words), "{words}: {doubts}");
        }
    }
}
