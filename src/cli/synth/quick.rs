//! `synth --robot`: a spec from the command line.

use super::super::CliError;
use super::super::servo::{numbers, servo};
use crate::joint::EffectForm;
use crate::synth::AnySpec;
use clap::Args;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// What `synth --robot` makes logs of.
#[derive(Args, Debug)]
pub(super) struct DescribedArgs {
    /// A robot's description (URDF, MJCF or our own), its base clamped, in the place of SPEC.toml
    #[arg(long, value_name = "FILE", conflicts_with = "spec")]
    robot: Option<PathBuf>,
    /// JOINT.EFFECT=VALUE[,VALUE..]: an effect of the catalogue with its parameters in order, `coulomb`, `viscous` or `gain`
    /// (the true number, and torque per stated gain); LINK.payload=KG, LINK.mass=FACTOR; may be repeated
    #[arg(long, value_name = "WHAT", requires = "robot", conflicts_with = "spec")]
    effect: Vec<String>,
    /// Gain of all servos and its damping, where the description has no position actuators [N m/rad, N m s/rad]
    #[arg(long, value_name = "KP[,KD]", requires = "robot", conflicts_with = "spec")]
    servo: Option<String>,
    /// Logs to make; the last two fifths are held out
    #[arg(long, value_name = "N", default_value_t = 5, requires = "robot", conflicts_with = "spec",
        value_parser = clap::value_parser!(u16).range(2..=99))]
    logs: u16,
    /// Length of a log [s]
    #[arg(long, value_name = "S", default_value_t = 20.0, requires = "robot", conflicts_with = "spec")]
    seconds: f64,
}

/// Sampling of the logs \[s\], their encoders' step (twelve bits a turn) and noise \[rad\].
const PERIOD_S: f64 = 0.02;
const STEP_RAD: f64 = std::f64::consts::TAU / 4096.0;
const NOISE_RAD: f64 = 5e-4;

impl DescribedArgs {
    /// The spec that the options make, and the files that it names.
    pub fn spec(&self) -> Result<(AnySpec, Vec<PathBuf>), CliError> {
        let robot = self.robot.clone().ok_or_else(|| CliError::Usage("add SPEC.toml or --robot FILE".to_owned()))?;
        let mut root = Table::new();
        root.insert("schema".into(), Value::Integer(1));
        let word = |text: &str| Value::String(text.to_owned());
        root.insert(
            "robot".into(),
            table([("model", word(&robot.display().to_string())), ("scenario", word("fixed"))]),
        );
        if let Some(servo) = &self.servo {
            let (kp, kd) = self::servo(servo)?;
            let keys = std::iter::once(("kp", kp)).chain(kd.map(|kd| ("kd", kd)));
            let all = Value::Table(keys.map(|(key, value)| (key.to_owned(), Value::Float(value))).collect());
            root.insert("joints".into(), table([("default", all)]));
        }
        let sensor = [("resolution", Value::Float(STEP_RAD)), ("period", Value::Float(PERIOD_S))];
        root.insert("sensor".into(), table(sensor));
        let mut truth = Table::from_iter([("noise".to_owned(), Value::Float(NOISE_RAD))]);
        let mut effects = Vec::new();
        for what in &self.effect {
            self.put(what, &mut truth, &mut effects)?;
        }
        root.insert("truth".into(), Value::Table(truth));
        root.insert("effect".into(), Value::Array(effects));
        let held_out = usize::from(self.logs) * 2 / 5;
        let log = |k: usize| {
            let (gait, role) =
                (if k.is_multiple_of(2) { "sines" } else { "steps" }, k + held_out >= usize::from(self.logs));
            table([
                ("file", word(&format!("log-{k:02}.csv"))),
                ("gait", word(gait)),
                ("role", word(if role { "validate" } else { "fit" })),
                ("duration", Value::Float(self.seconds)),
            ])
        };
        root.insert("log".into(), Value::Array((0..usize::from(self.logs)).map(log).collect()));
        let text = toml::to_string(&root).map_err(|error| CliError::Encode(error.to_string()))?;
        Ok((AnySpec::from_toml(Path::new("--robot"), &text)?, vec![robot]))
    }

    /// One `--effect`, put where a spec has it.
    fn put(&self, what: &str, truth: &mut Table, effects: &mut Vec<Value>) -> Result<(), CliError> {
        let wrong = |why: String| CliError::Usage(format!("--effect {what}: {why}"));
        let parts = what.split_once('=').and_then(|(left, values)| Some((left.rsplit_once('.')?, values)));
        let ((place, id), values) =
            parts.ok_or_else(|| wrong("expected JOINT.EFFECT=VALUE, as elbow.delay=0.02".to_owned()))?;
        let values = numbers(&format!("--effect {what}"), values)?;
        let one = || match values[..] {
            [value] => Ok(Value::Float(value)),
            _ => Err(wrong(format!("{} values, expected one", values.len()))),
        };
        match id {
            "coulomb" | "viscous" => {
                let of_all = truth.entry("friction").or_insert_with(|| Value::Table(Table::new()));
                let own =
                    of_all.as_table_mut().map(|all| all.entry(place).or_insert_with(|| Value::Table(Table::new())));
                if let Some(own) = own.and_then(Value::as_table_mut) {
                    own.insert(id.to_owned(), one()?);
                }
            }
            "gain" | "mass" => {
                let key = if id == "gain" { "gain" } else { "mass_scale" };
                let of_all = truth.entry(key).or_insert_with(|| Value::Table(Table::new()));
                if let Some(of_all) = of_all.as_table_mut() {
                    of_all.insert(place.to_owned(), one()?);
                }
            }
            "payload" => {
                let at = Value::Array(vec![Value::Float(0.0); 3]);
                let payload = table([("body", Value::String(place.to_owned())), ("mass", one()?), ("at", at)]);
                let of_all = truth.entry("payload").or_insert_with(|| Value::Array(Vec::new()));
                if let Some(of_all) = of_all.as_array_mut() {
                    of_all.push(payload);
                }
            }
            _ => {
                let form: EffectForm = id.parse().map_err(|unknown| {
                    wrong(format!("{unknown}; beside them coulomb, viscous, gain, payload, mass"))
                })?;
                let known = form.named_parameters();
                if known.len() != values.len() {
                    let names: Vec<String> = known.iter().map(|p| format!("{} [{}]", p.name, p.unit)).collect();
                    let (found, expected) = (values.len(), known.len());
                    return Err(wrong(format!("{found} values, expected {expected}: {}", names.join(", "))));
                }
                let mut effect = Table::new();
                effect.insert("id".into(), Value::String(id.to_owned()));
                effect.insert("joints".into(), Value::String(place.to_owned()));
                effect.extend(known.iter().zip(values).map(|(p, value)| (p.name.to_owned(), Value::Float(value))));
                effects.push(Value::Table(effect));
            }
        }
        Ok(())
    }
}

fn table<const N: usize>(rows: [(&str, Value); N]) -> Value {
    Value::Table(rows.into_iter().map(|(key, value)| (key.to_owned(), value)).collect())
}
