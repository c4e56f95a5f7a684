//! The reference pages of the docs against the program: commands, effects, JSON, words.
//!
//! `AIBO_FIT_REWRITE=1 cargo test --release --test reference` writes the page of the effects and its pictures anew.

mod support;

use aibo_fit::gap::BodyKind;
use aibo_fit::gap::robot::Cause;
use aibo_fit::joint::{EffectForm, EffectId, Named, Stage};
use serde_json::Value;
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use support::signature::{Alike, alike, picture};
use support::{everything_in, expect_code, json, root};

const EFFECTS: &str = "docs/reference/effects.md";
/// Another effect that takes up less than this share does not look alike.
const LOOKS_ALIKE: f64 = 0.5;

/// Compares a generated file with what is there, or writes it.
fn expect_file(path: &Path, generated: &str) {
    if std::env::var_os("AIBO_FIT_REWRITE").is_some() {
        fs::create_dir_all(path.parent().expect("a file is in a folder")).expect("a folder can be made");
        fs::write(path, generated).expect("a file can be written");
        return;
    }
    let there = fs::read_to_string(path).unwrap_or_default();
    let same = there == generated;
    assert!(same, "{} is not what the program says; AIBO_FIT_REWRITE=1 writes it anew", path.display());
}

/// The comment at the head of an effect's file: its physics, its formula, its forms, how it shows.
fn physics(effect: EffectId) -> String {
    let source = fs::read_to_string(root().join(format!("src/joint/effect/{effect}.rs"))).expect("an effect is a file");
    let lines = source.lines().map_while(|line| line.strip_prefix("//!"));
    lines.map(|line| line.strip_prefix(' ').unwrap_or(line)).collect::<Vec<_>>().join("\n")
}

fn percent(share: f64) -> String {
    format!("{:.0} %", 100.0 * share)
}

/// Three digits behind the point; what would vanish there in exponent form.
fn number(value: f64) -> String {
    if value != 0.0 && value.abs() < 0.001 { format!("{value:.1e}") } else { format!("{value:.3}") }
}

/// Parameters of all forms in the order in which they come up, each with the forms that have it, in brackets, unless all do.
fn parameters(effect: EffectId) -> Vec<(&'static Named, String)> {
    let forms: Vec<EffectForm> = effect.forms().collect();
    let mut all: Vec<&'static Named> = Vec::new();
    for named in forms.iter().flat_map(|form| form.named_parameters()) {
        if !all.contains(&named) {
            all.push(named);
        }
    }
    let with_forms = |named: &'static Named| {
        let having = forms.iter().filter(|form| form.named_parameters().contains(named));
        let names: Vec<&str> = having.map(|form| form.name()).collect();
        let in_brackets = format!(" ({})", names.join(", "));
        (named, if names.len() < forms.len() { in_brackets } else { String::new() })
    };
    all.into_iter().map(with_forms).collect()
}

fn section(effect: EffectId, alike: &Alike) -> String {
    let picture = picture(effect);
    let svg = root().join(format!("docs/reference/effects/{effect}.svg"));
    expect_file(&svg, &picture.svg);
    let mut text = format!("### {effect}\n{}\n\n", physics(effect));
    let forms: Vec<&str> = effect.forms().map(|form| form.name()).filter(|name| !name.is_empty()).collect();
    if !forms.is_empty() {
        let _ = writeln!(text, "Forms by name, the first by default: `{}`.\n", forms.join("`, `"));
    }
    text += "| parameter | unit | absent at | values |\n|---|---|---|---|\n";
    for (named, of_forms) in parameters(effect) {
        let unit = if named.unit.is_empty() { "-" } else { named.unit };
        let zero = if named.zero.is_finite() { named.zero.to_string() } else { "infinity".to_owned() };
        let _ = writeln!(text, "| `{}`{of_forms} | {unit} | {zero} | {} |", named.name, named.bounds);
    }
    let motion = if picture.driven { "a motion driven by setpoints" } else { "a free swing" };
    let sizes = effect.named_parameters().iter().zip(&picture.values);
    let sizes: Vec<String> =
        sizes.map(|(named, value)| format!("{} {} {}", named.name, number(*value), named.unit)).collect();
    let size = sizes.join(", ").replace(" ,", ",");
    let _ = write!(
        text,
        "\n![{effect} on {motion}](effects/{effect}.svg)\n\nAbove {motion} without it (grey) and with it ({}, blue), \
         below the difference. ",
        size.trim()
    );
    let others: Vec<String> = alike
        .effects
        .iter()
        .filter(|(_, share)| *share >= LOOKS_ALIKE)
        .take(3)
        .map(|(other, share)| format!("`{other}` ({})", percent(*share)))
        .collect();
    let looks = match others.len() {
        0 => "looks like nothing else in the list".to_owned(),
        _ => format!("looks like {}", others.join(", ")),
    };
    let _ = writeln!(text, "Refitted numbers take up {} of it; what they leave {looks}.\n", percent(alike.by_numbers));
    text
}

const OPENING: &str = "# Effects

What `gap` looks for: one thing that a stage of the chain from setpoint to log does and that the model leaves out. `--without` and
`--only` take these names. A parameter that only some forms of an effect have is followed by these forms. This page is written by the
program (`AIBO_FIT_REWRITE=1 cargo test --release --test reference`).

Pictures and the figures on what looks alike come from one made joint (inertia 0.011 kg m^2, moment 0.05 kg m, Coulomb friction 0.02 N m,
viscous friction 0.004 N m s/rad, a servo with kp 5 N m/rad and kd 0.1 N m s/rad) in a free swing and in a motion driven by setpoints, 4 s
each. They show what is easily confused, to first order and without noise; for logs of your own `gap` says what they cannot tell apart,
and `check` which sizes they would show.

";

const BESIDE_JOINTS: &str = "## Beside joints

What a robot may have beside effects of its joints, under names that `--without` and `--only` take too: of a whole robot other friction of a
joint than the study's, a payload, another floor; of an arm, whose base is clamped, a body that is other than described.

| id | where | values | what it is |
|---|---|---|---|
";

/// The comment on a variant of an enum, which stands on a line of its own.
fn comment(file: &str, variant: &str) -> String {
    let source = fs::read_to_string(root().join(file)).expect("a source can be read");
    let lines: Vec<&str> = source.lines().map(str::trim).collect();
    let end = lines.iter().position(|line| line.strip_suffix(',') == Some(variant)).expect("the enum has the variant");
    let begin = lines[..end].iter().rposition(|line| !line.starts_with("///")).map_or(0, |before| before + 1);
    let words: Vec<&str> = lines[begin..end].iter().map(|line| line.trim_start_matches('/').trim_start()).collect();
    assert!(!words.is_empty(), "{file}: {variant} has no comment");
    words.join(" ").replace('\\', "")
}

fn row(id: &str, place: &str, values: &[(&str, &str)], what: &str) -> String {
    let with_unit = |(name, unit): &(&str, &str)| {
        if unit.is_empty() { format!("`{name}`") } else { format!("`{name}` in {unit}") }
    };
    let values: Vec<String> = values.iter().map(with_unit).collect();
    format!("| `{id}` | {place} | {} | {what} |\n", values.join(", "))
}

/// The causes that are no effects of the catalogue.
fn beside_joints() -> String {
    let causes = [Cause::Coulomb, Cause::Viscous].into_iter().chain(Cause::OF_ROBOT);
    let of_robots = causes.map(|cause| {
        let what = comment("src/gap/robot/cause.rs", &format!("{cause:?}"));
        row(cause.id(), cause.stage().name(), &cause.named(), &what)
    });
    let (mass, place) = (("mass", "kg"), [("x", "m"), ("y", "m"), ("z", "m")]);
    let kinds = [
        (BodyKind::Payload, [&[mass][..], &place].concat()),
        (BodyKind::BodyMass, vec![mass]),
        (BodyKind::BodyCom, place.to_vec()),
    ];
    let of_arms = kinds.map(|(kind, values)| {
        let what = comment("src/gap/body_kind.rs", &format!("{kind:?}"));
        row(kind.id(), "a body of an arm", &values, &what)
    });
    BESIDE_JOINTS.to_owned() + &of_robots.chain(of_arms).collect::<String>()
}

#[test]
fn the_page_of_the_effects_is_what_the_catalogue_says() {
    let mut page = OPENING.to_owned();
    let alike = alike();
    for stage in Stage::ALL {
        let here: Vec<&(EffectId, Alike)> = alike.iter().filter(|(effect, _)| effect.stage() == stage).collect();
        if !here.is_empty() {
            let _ = writeln!(page, "## Stage `{}`\n", stage.name());
        }
        for (effect, alike) in here {
            page += &section(*effect, alike);
        }
    }
    page += &beside_joints();
    expect_file(&root().join(EFFECTS), &(page.trim_end().to_owned() + "\n"));
}

fn page(name: &str) -> String {
    fs::read_to_string(root().join("docs/reference").join(name)).expect("a page of the reference can be read")
}

#[test]
fn every_command_has_its_help_in_the_reference() {
    let help = expect_code(root(), &["--help"], 0);
    let listed = help.split_once("Commands:\n").expect("a list of commands").1;
    let listed = listed.lines().take_while(|line| !line.is_empty());
    let names = listed.filter_map(|line| line.strip_prefix("  ").filter(|rest| !rest.starts_with(' ')));
    let names: Vec<&str> =
        names.filter_map(|rest| rest.split_whitespace().next()).filter(|name| *name != "help").collect();
    assert!(names.len() >= 15, "{names:?}");
    let mut page = format!("{COMMANDS_OPENING}{}", block("--help"));
    for name in names {
        let _ = write!(page, "\n## {name}\n{}", block(&format!("{name} --help")));
    }
    expect_file(&root().join("docs/reference/commands.md"), &page);
}

const COMMANDS_OPENING: &str = "# Commands

What `aibo-fit COMMAND --help` prints. Exit codes: 0 done; 1 the answer is no (nothing moved, a gate failed); 2 usage; 3 bad data; 4 did not
converge or diverged; 5 could not read or write.

The same input gives the same bytes on any number of threads and on any x86-64 processor. A run that is broken off, a full disk or a folder
that cannot be written leave the old result as it was: see [what it withstands](robustness.md).

";

/// A block of a document with a command and what it prints.
fn block(words: &str) -> String {
    let printed = expect_code(root(), &words.split(' ').collect::<Vec<_>>(), 0);
    let lines = printed.trim_end().lines().map(|line| format!("{}\n", line.trim_end()));
    format!("```console\n$ aibo-fit {words}\n{}```\n", lines.collect::<String>())
}

/// Keys below these are names: of parameters, joints, effects, files.
const BY_NAME: [&str; 10] =
    ["parameters", "beliefs", "detectable", "masses", "values", "body_pos", "conventions", "versions", "fix", "bound"];

fn keys(value: &Value, by_name: bool, found: &mut BTreeSet<String>) {
    match value {
        Value::Object(object) => {
            for (key, value) in object {
                // Files with their hashes.
                if by_name || key.contains(['/', '.']) {
                    keys(value, false, found);
                } else {
                    found.insert(key.clone());
                    keys(value, BY_NAME.contains(&key.as_str()), found);
                }
            }
        }
        Value::Array(values) => values.iter().for_each(|value| keys(value, false, found)),
        _ => {}
    }
}

/// All keys of what commands write into `file`, and the code with which they end.
fn keys_of(commands: &[(&[&str], i32)], folder: &Path, file: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for (k, &(words, code)) in commands.iter().enumerate() {
        let out = folder.join(format!("out{k}")).display().to_string();
        let places = if ["gate", "dynamics"].contains(&words[0]) { &[][..] } else { &["--out", &out][..] };
        let quiet = if words[0] == "dynamics" { &[][..] } else { &["-q"][..] };
        expect_code(root(), &[words, places, quiet, &["--json", file]].concat(), code);
        keys(&json(Path::new(file)), false, &mut found);
    }
    found
}

/// Expects keys on the page of the JSON.
fn expect_keys(found: &BTreeSet<String>, at_least: usize) {
    let page = page("json.md");
    let missing: Vec<&String> = found.iter().filter(|key| !has_key(&page, key)).collect();
    assert!(
        found.len() > at_least && missing.is_empty(),
        "{} keys; not in docs/reference/json.md: {missing:?}",
        found.len()
    );
}

#[test]
fn every_key_of_the_json_is_in_the_reference() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("answer.json").display().to_string();
    let weak = folder.path().join("weak");
    let mut found = keys_of(&[(&["synth", "data/examples/synth/weak-shoulders.toml"], 0)], &weak, &file);
    let weak = weak.join("out0/study.toml").display().to_string();
    let commands: [(&[&str], i32); 10] = [
        (&["gap", "data/examples/delay/study.toml"], 0),
        (&["simulate", "data/examples/delay/study.toml"], 0),
        (&["gap", "data/examples/ambiguous/study.toml"], 0),
        (&["gap", &weak], 0),
        (&["check", "data/examples/delay/study.toml"], 0),
        (&["drop", "data/q1.csv"], 0),
        (&["gate", "data/examples/delay/study.toml", "--max-gap", "0.05"], 1),
        (&["walk"], 0),
        (&["sensor-test"], 0),
        (&["dynamics", "data/examples/states.json"], 0),
    ];
    found.extend(keys_of(&commands, folder.path(), &file));
    expect_keys(&found, 150);
}

#[test]
#[ignore = "half a minute: an arm is diagnosed"]
fn slow_every_key_of_an_arm_is_in_the_reference() {
    let folder = tempfile::tempdir().unwrap();
    let [file, answer] = ["answer.json", "gap.json"].map(|name| folder.path().join(name).display().to_string());
    let study = "data/examples/arm/study.toml";
    let mut found = keys_of(&[(&["gap", study], 0)], folder.path(), &answer);
    let commands: [(&[&str], i32); 5] = [
        (&["check", study], 0),
        (&["simulate", study], 0),
        (&["export", &answer, "--to", "mjcf"], 0),
        (&["export", &answer, "--to", "table"], 0),
        (&["fleet", "data/examples/delay/study.toml"], 0),
    ];
    found.extend(keys_of(&commands, folder.path(), &file));
    expect_keys(&found, 60);
}

/// Whether a page has a key in backticks, alone or at the end or in the middle of a path.
fn has_key(page: &str, key: &str) -> bool {
    let code = page.split('`').skip(1).step_by(2);
    code.into_iter().any(|code| code.split(['.', '[', ']', ' ', ',']).any(|word| word == key))
}

/// Words of the heads of all tables that the documents show.
fn heads() -> BTreeSet<String> {
    let docs = everything_in(&root().join("docs")).into_iter().chain([root().join("README.md")]);
    let mut words = BTreeSet::new();
    for path in docs.filter(|path| path.extension().is_some_and(|ending| ending == "md")) {
        let text = fs::read_to_string(&path).expect("a page can be read");
        let lines: Vec<&str> = text.lines().collect();
        for (k, _) in lines.iter().enumerate().filter(|(_, line)| line.len() > 20 && line.chars().all(|c| c == '-')) {
            // Up to three lines, down from the one that begins at the margin.
            let from = (k.saturating_sub(3)..k).rev().find(|&i| !lines[i].starts_with(' ')).unwrap_or(k);
            for line in &lines[from..k] {
                let plain = line.split('[').map(|part| part.split_once(']').map_or(part, |(_, after)| after));
                let plain: String = plain.collect::<Vec<_>>().join(" ");
                let tokens = plain.split(|c: char| !c.is_alphanumeric() && c != '_');
                words.extend(tokens.filter(|t| t.chars().any(char::is_alphabetic)).map(str::to_lowercase));
            }
        }
    }
    words
}

#[test]
fn every_word_of_the_output_is_in_the_glossary() {
    let page = page("glossary.md").to_lowercase();
    let there: BTreeSet<&str> = page.split(|c: char| !c.is_alphanumeric() && c != '_').collect();
    let heads = heads();
    assert!(heads.len() > 40, "{heads:?}");
    let fixed = "effect none calibration unexplained recalibrated equivalent held floor given naive determined payload body_mass \
                 body_com hold stick reversal run saturation stop stance swing touch_down speed direction angle load time \
                 setpoint_rate torque amplitude pooled law standing clear narrow plain finding power stage session";
    let causes = Cause::all().filter(|cause| !matches!(cause, Cause::Effect(_))).map(|cause| cause.id().to_owned());
    let stages = Stage::ALL.iter().map(|stage| stage.name().to_owned());
    let wanted = heads.into_iter().chain(fixed.split_whitespace().map(str::to_owned)).chain(causes).chain(stages);
    let missing: BTreeSet<String> = wanted.filter(|word| !there.contains(word.as_str())).collect();
    assert!(missing.is_empty(), "not in docs/reference/glossary.md: {missing:?}");
    let effects = fs::read_to_string(root().join(EFFECTS)).expect("the page of the effects can be read");
    for effect in EffectId::ALL {
        assert!(effects.contains(&format!("### {effect}\n")), "{effect}");
    }
}
