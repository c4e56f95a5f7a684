//! Setpoints and readings that do not belong together as a study says: columns that are swapped, a sign that is turned, zeros
//! that differ, a driven log that is called a free swing.
//!
//! Each would be explained by some cause that is not there. What is held against the log is how its two columns hang together,
//! with so much room that no honest servo is questioned.

use super::case::{Case, Item};
use crate::log::{DriveMode, MotorModel};

/// From this correlation with its setpoint on a joint follows it.
const FOLLOWS: f64 = 0.5;
/// Below this correlation it moves against it.
const AGAINST: f64 = -0.8;
/// From this correlation on two columns are one motion at two times.
const ALIKE: f64 = 0.9;
/// Readings may be ahead of their setpoints by so many samples, by how stamps are taken.
const STAMPS: usize = 2;
/// No setpoint is looked for farther away \[s\].
const FARTHEST_S: f64 = 0.25;
/// A zero that differs by less shows in the answer as what it is \[rad\].
const ZERO_RAD: f64 = 0.1;
/// Its spread is at most this share of it.
const STEADY: f64 = 0.3;
/// By so much its torque exceeds what gravity and friction can hold.
const TORQUE: f64 = 10.0;

impl Case {
    /// Logs whose setpoints and readings do not belong together as the study says, in sentences.
    pub(super) fn crossed(&self) -> Vec<String> {
        let is_driven = |item: &Item| item.entry.drive == DriveMode::Position;
        self.first_of(&[called_free, turned, swapped, beside], is_driven)
    }

    /// The same of logs of which nothing is stated: the joint is driven where there is a setpoint.
    pub fn doubts_of_columns(&self) -> Vec<String> {
        self.first_of(&[turned, swapped], |_| true)
    }

    fn first_of(&self, kinds: &[Kind], is_driven: impl Fn(&Item) -> bool) -> Vec<String> {
        let columns: Vec<Columns<'_>> =
            self.items.iter().filter_map(|item| Columns::of(item, is_driven(item))).collect();
        let first = |kind: &Kind| {
            columns.iter().find_map(|own| kind(self, own).map(|words| format!("{words} ({})", own.item.entry.file)))
        };
        kinds.iter().filter_map(first).collect()
    }
}

/// A way in which columns do not belong together, in a sentence.
type Kind = fn(&Case, &Columns<'_>) -> Option<String>;

/// What was asked and what was read, at the readings.
struct Columns<'a> {
    item: &'a Item,
    /// Whether the setpoint moves the joint.
    is_driven: bool,
    asked_rad: &'a [f64],
    read_rad: &'a [f64],
    /// Correlation of both.
    together: f64,
}

impl<'a> Columns<'a> {
    fn of(item: &'a Item, is_driven: bool) -> Option<Self> {
        let (asked_rad, read_rad) = (item.log.q_ref_rad.as_deref()?, item.log.q_rad.as_slice());
        let together = correlation(asked_rad, read_rad).filter(|_| item.health.moved)?;
        Some(Self { item, is_driven, asked_rad, read_rad, together })
    }

    /// The best correlation with one column `by` samples behind the other, and how many these are.
    fn best(&self, [ahead, behind]: [&[f64]; 2], by: std::ops::RangeInclusive<usize>) -> (f64, usize) {
        let of = |k| Some((correlation(ahead.get(..ahead.len().checked_sub(k)?)?, behind.get(k..)?)?, k));
        by.filter_map(of).fold((f64::MIN, 0), |best, one| if one.0 > best.0 { one } else { best })
    }
}

/// Pearson's correlation; `None` where one of both stands.
fn correlation(a: &[f64], b: &[f64]) -> Option<f64> {
    let n = a.len().min(b.len()) as f64;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / n;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let [mut aa, mut bb, mut ab] = [0.0; 3];
    for (a, b) in a.iter().zip(b) {
        let (a, b) = (a - mean_a, b - mean_b);
        (aa, bb, ab) = (aa + a * a, bb + b * b, ab + a * b);
    }
    let all = ab / (aa * bb).sqrt();
    all.is_finite().then_some(all)
}

fn called_free(_: &Case, own: &Columns<'_>) -> Option<String> {
    let is_free = own.item.entry.drive == DriveMode::Off && own.item.log.drive.is_none();
    (is_free && own.together > FOLLOWS).then(|| {
        "drive = \"off\" says that the motor is off, and the joint follows its setpoint: is it drive = \"position\"?".to_owned()
    })
}

fn turned(_: &Case, own: &Columns<'_>) -> Option<String> {
    (own.is_driven && own.together < AGAINST).then(|| {
        "The joint turns against its setpoint: has q or q_ref the other sign? sign = -1 under [columns] turns it"
            .to_owned()
    })
}

fn swapped(_: &Case, own: &Columns<'_>) -> Option<String> {
    let period_s = own.item.health.period_s;
    let farthest = (FARTHEST_S / period_s).min(own.read_rad.len() as f64 / 4.0) as usize;
    if !own.is_driven || farthest <= STAMPS {
        return None;
    }
    let (late, _) = own.best([own.asked_rad, own.read_rad], 0..=farthest);
    let (ahead, by) = own.best([own.read_rad, own.asked_rad], STAMPS + 1..=farthest);
    (ahead > ALIKE && 2.0 * (1.0 - ahead) < 1.0 - late).then(|| {
        format!(
            "The readings are {:.0} ms ahead of their setpoints: are q and q_ref swapped, or do their clocks differ?",
            1e3 * period_s * by as f64
        )
    })
}

fn beside(case: &Case, own: &Columns<'_>) -> Option<String> {
    let motor = own.item.entry.motor.as_ref().filter(|_| own.is_driven)?;
    let nominal = case.joint.nominal.filter(|_| own.item.experiments.iter().all(|e| e.carriage.is_none()))?;
    if motor.ki_nm_rad_s != 0.0 || motor.model != MotorModel::Torque || own.together < FOLLOWS {
        return None;
    }
    let apart: Vec<f64> = own.asked_rad.iter().zip(own.read_rad).map(|(asked, read)| asked - read).collect();
    let n = apart.len() as f64;
    let mean = apart.iter().sum::<f64>() / n;
    let spread = (apart.iter().map(|rad| (rad - mean).powi(2)).sum::<f64>() / n).sqrt();
    let (asks_nm, holds_nm) =
        (motor.kp_nm_rad * mean.abs(), case.joint.gravity_m_s2 * nominal.moment_kg_m + nominal.coulomb_nm);
    (mean.abs() > ZERO_RAD && spread < STEADY * mean.abs() && asks_nm > TORQUE * holds_nm).then(|| {
        format!(
            "The joint stays {:.2} rad beside its setpoint, which the stated kp answers with {asks_nm:.1} N m, and gravity and \
             friction as stated hold {holds_nm:.2} N m: have q and q_ref the same zero? zero = ... under [columns] moves it",
            mean.abs()
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::{ArrayLog, JointSpec, Log, SensorSpec, Uncertain};
    use std::path::Path;

    /// The demonstration's doubts with another log.
    fn with(change: impl Fn(&mut Item)) -> String {
        let mut case = Case::of_study(Path::new("data/examples/delay/study.toml")).unwrap();
        case.items.iter_mut().for_each(change);
        case.crossed().join("\n")
    }

    #[test]
    fn a_sound_log_is_not_questioned() {
        for study in ["delay", "ambiguous", "resolved"] {
            let case = Case::of_study(Path::new(&format!("data/examples/{study}/study.toml"))).unwrap();
            assert_eq!(case.crossed(), [""; 0], "{study}");
        }
    }

    #[test]
    fn a_log_of_which_nothing_is_stated_is_questioned_too() {
        let log = |change: fn(&mut ArrayLog)| {
            let case = Case::of_study(Path::new("data/examples/delay/study.toml")).unwrap();
            let Log { t_s, q_rad, q_ref_rad, .. } = case.items[0].log.clone();
            let mut array = ArrayLog { q_ref_rad, ..ArrayLog::new("log", t_s, q_rad) };
            change(&mut array);
            let joint = JointSpec { nominal: None, ..case.joint };
            let case = Case::of_arrays(joint, SensorSpec::default(), None, Uncertain::default(), vec![array]).unwrap();
            case.doubts_of_columns().join("\n")
        };
        assert_eq!(log(|_| {}), "");
        let turned = log(|array| array.q_rad.iter_mut().for_each(|q| *q = -*q));
        assert!(turned.contains("turns against its setpoint"), "{turned}");
        let swapped = log(|array| std::mem::swap(array.q_ref_rad.as_mut().unwrap(), &mut array.q_rad));
        assert!(swapped.contains("are q and q_ref swapped"), "{swapped}");
        let free = log(|array| array.q_ref_rad = None);
        assert_eq!(free, "");
    }

    #[test]
    fn what_does_not_belong_together_is_questioned() {
        let free = with(|item| item.entry.drive = DriveMode::Off);
        assert!(free.contains("drive = \"position\"?"), "{free}");
        let turned = with(|item| item.log.q_rad.iter_mut().for_each(|q| *q = -*q));
        assert!(turned.contains("turns against its setpoint"), "{turned}");
        let swapped = with(|item| {
            let asked = item.log.q_ref_rad.replace(item.log.q_rad.clone());
            item.log.q_rad = asked.unwrap();
        });
        assert!(swapped.contains("are q and q_ref swapped"), "{swapped}");
        let beside = with(|item| item.log.q_rad.iter_mut().for_each(|q| *q += 1.57));
        assert!(beside.contains("1.57 rad beside its setpoint"), "{beside}");
    }
}
