//! What `aibo-fit simulate` promises: a prediction per log, with given or with fitted parameters.

mod support;

use aibo_fit::blind::Cause;
use aibo_fit::joint::{Bounds, EffectId};
use std::fs;
use std::path::Path;
use support::*;

const LOGS: [&str; 2] = ["q1-402g-0.csv", "q1-402g-1.csv"];

/// A study of two swings of the reference robot, the second held back, with its true friction or another.
fn bench(viscous: f64) -> tempfile::TempDir {
    let dir = tempfile::tempdir().unwrap();
    let mut text = format!(
        "schema = 1\n[joint]\nname = \"hip\"\ninertia = 5.974e-4\nmoment = 5.972e-3\ncoulomb = 0.001\nviscous = {viscous}\n\
         [sensor]\nresolution = 0.006\nperiod = 0.008\n"
    );
    for (log, role) in LOGS.iter().zip(["fit", "validate"]) {
        fs::copy(root().join("data/thesis-robot").join(log), dir.path().join(log)).unwrap();
        text += &format!(
            "[[log]]\nfile = \"{log}\"\nrole = \"{role}\"\ndrive = \"off\"\n\
             [log.extra]\nmass = 0.402\ndistance = 0.1705\nradius = 0.018\nlength = 0.038\n"
        );
    }
    fs::write(dir.path().join("study.toml"), text).unwrap();
    dir
}

fn rms_of(folder: &Path, words: &[&str]) -> Vec<(String, String, f64)> {
    let all: Vec<&str> =
        ["simulate", "study.toml", "--json", "found.json"].into_iter().chain(words.iter().copied()).collect();
    expect_code(folder, &all, 0);
    let found = json(&folder.join("found.json"));
    assert_eq!(found["schema"], 1);
    let text = |v: &serde_json::Value| v.as_str().unwrap().to_owned();
    let logs = found["logs"].as_array().unwrap();
    logs.iter().map(|log| (text(&log["file"]), text(&log["role"]), log["rms"].as_f64().unwrap())).collect()
}

#[test]
fn every_log_gets_its_prediction_and_its_rms() {
    let dir = bench(0.017);
    let found = rms_of(dir.path(), &["--out", "out"]);
    let files: Vec<(&str, &str)> = found.iter().map(|(file, role, _)| (file.as_str(), role.as_str())).collect();
    assert_eq!(files, [(LOGS[0], "fit"), (LOGS[1], "validate")]);
    for (file, _, rms) in &found {
        let csv = fs::read_to_string(dir.path().join("out").join(file.replace(".csv", ".predicted.csv"))).unwrap();
        assert!(csv.starts_with("t,q,dq,q_measured\n"));
        let errors: Vec<f64> = csv
            .lines()
            .skip(1)
            .map(|line| {
                let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
                cells[1] - cells[3]
            })
            .collect();
        let written = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
        assert!((written - rms).abs() < 1e-6, "{file}: {written} in the file, {rms} reported");
        // The reference robot's own numbers, up to where the bare link hangs: near the sensor's noise of 2.45 mrad.
        assert!((0.002..0.004).contains(rms), "{file}: {rms}");
    }
}

#[test]
fn nominal_parameters_are_used_without_a_fit_and_fitted_ones_with_it() {
    let dir = bench(0.034);
    let nominal = rms_of(dir.path(), &["--out", "a"]);
    assert!(nominal.iter().all(|(_, _, rms)| *rms > 0.02), "twice the friction shows: {nominal:?}");
    expect_code(dir.path(), &["drop", "--study", "study.toml", "--out", "fit", "--quiet"], 0);
    let fitted = rms_of(dir.path(), &["--fit", "fit/fit.json", "--out", "b"]);
    // The second swing was not fitted.
    assert!(fitted.iter().all(|(_, _, rms)| *rms < 0.004), "{fitted:?}");
}

#[test]
fn another_log_is_predicted_as_the_study_says_of_its_first() {
    let dir = bench(0.017);
    fs::create_dir(dir.path().join("other")).unwrap();
    fs::copy(root().join("data/thesis-robot/q1-402g-3.csv"), dir.path().join("other/new.csv")).unwrap();
    let found = rms_of(dir.path(), &["--log", "other/new.csv", "--out", "out"]);
    assert_eq!((found.len(), found[0].0.as_str(), found[0].1.as_str()), (1, "other/new.csv", "validate"));
    assert!(found[0].2 < 0.004, "{found:?}");
    assert!(dir.path().join("out/new.predicted.csv").is_file());
}

#[test]
fn logs_of_one_name_do_not_overwrite_each_other() {
    let dir = bench(0.017);
    for (folder, log) in ["a", "b"].iter().zip(LOGS) {
        fs::create_dir(dir.path().join(folder)).unwrap();
        fs::rename(dir.path().join(log), dir.path().join(folder).join("swing.csv")).unwrap();
    }
    let text = fs::read_to_string(dir.path().join("study.toml")).unwrap();
    let text = text.replace(LOGS[0], "a/swing.csv").replace(LOGS[1], "b/swing.csv");
    fs::write(dir.path().join("study.toml"), text).unwrap();
    rms_of(dir.path(), &["--out", "out"]);
    let [first, second] =
        ["swing", "swing-2"].map(|n| fs::read(dir.path().join("out").join(format!("{n}.predicted.csv"))).unwrap());
    assert_ne!(first, second);
}

#[test]
fn quiet_says_nothing_and_the_table_names_the_parameters() {
    let dir = bench(0.017);
    let text = expect_code(dir.path(), &["simulate", "study.toml", "--out", "out"], 0);
    assert!(text.contains("parameters from study.toml, as given") && text.contains("RMS [mrad]"), "{text}");
    let text = expect_code(dir.path(), &["simulate", "study.toml", "--out", "out", "--quiet"], 0);
    assert!(text.is_empty(), "{text}");
}

/// Diagnoses a study and predicts its logs by the fit that the diagnosis leaves; the prediction has the residual that
/// the diagnosis reported.
fn simulated_as_diagnosed(study: &Path) {
    let out = tempfile::tempdir().unwrap();
    let (folder, study) = (out.path(), study.to_string_lossy());
    expect_code(folder, &["gap", &study, "--out", "gap", "--json", "gap.json", "--quiet"], 0);
    let words = ["simulate", &study, "--fit", "gap/fit.json", "--out", "out", "--json", "found.json"];
    expect_code(folder, &words, 0);
    let (gap, found) = (json(&folder.join("gap.json")), json(&folder.join("found.json")));
    let simulated = found["logs"].as_array().unwrap();
    let held = gap["gap"]["per_log"].as_array().unwrap();
    assert!(!held.is_empty());
    for log in held {
        let same = simulated.iter().find(|s| s["file"] == log["file"]).unwrap();
        assert_eq!(same["role"], "validate");
        let (was, is) = (log["after"].as_f64().unwrap(), same["rms"].as_f64().unwrap());
        let answer = (&gap["effect"], &gap["second"]);
        // simulate seeks each log's start from more guesses, so it may come nearer to a driven log than the diagnosis did.
        assert!(
            (0.9..1.01).contains(&(is / was)),
            "{study} {answer:?}, {}: {was} diagnosed, {is} simulated",
            log["file"]
        );
    }
}

#[test]
fn a_diagnosis_is_simulated_with_the_residual_that_it_reported() {
    // Seeds whose studies are diagnosed in seconds.
    for (effect, seed) in [(EffectId::AngleOffset, 3), (EffectId::TorqueLimit, 2)] {
        let dir = tempfile::tempdir().unwrap();
        write_made(dir.path(), seed, Cause::Effects(vec![effect]));
        simulated_as_diagnosed(&dir.path().join("study.toml"));
    }
}

#[test]
fn diagnosed_samples_are_simulated_with_the_residual_that_was_reported() {
    let Some(samples) = shared("samples") else { return };
    for sample in ["backlash", "stribeck", "torque_limit"] {
        simulated_as_diagnosed(&samples.join(sample).join("study.toml"));
    }
}

/// A fit with one effect.
fn fit_with(effect: &str, parameters: &[(&str, f64)]) -> String {
    let parameters: Vec<String> =
        parameters.iter().map(|(name, value)| format!("\"{name}\": {{\"value\": {value:?}}}")).collect();
    let text = format!("\"effects\": [{{\"id\": \"{effect}\", \"parameters\": {{{}}}}}]", parameters.join(", "));
    FIT.replacen("\"effects\": []", &text, 1)
}

#[test]
fn every_effect_of_the_catalogue_can_be_simulated_and_acts_where_it_can() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("study.toml"), STUDY).unwrap();
    fs::write(dir.path().join("good.csv"), good_log()).unwrap();
    let rms = |fit: &str| {
        fs::write(dir.path().join("fit.json"), fit).unwrap();
        rms_of(dir.path(), &["--fit", "fit.json", "--out", "out"])[0].2
    };
    let plain = rms(FIT);
    for &effect in EffectId::ALL {
        // Sizes that show in a swing of half a radian.
        let size = |name: &str| match name {
            "mu_st" | "delta" => 0.004,
            "rotor" | "a" => 0.4,
            "side" => 1.0,
            "stiffness" => 5.0,
            "damping" | "c2" => 1e-3,
            "r" => 0.5,
            "b" => 0.05,
            _ => 0.2,
        };
        let values: Vec<_> = effect.named_parameters().iter().map(|p| (p.name, size(p.name))).collect();
        let with = rms(&fit_with(effect.id(), &values));
        // The log is a free one, and this joint has no Coulomb friction that could vary over a turn.
        let shows = !effect.is_driven_only() && effect != EffectId::PositionFriction;
        assert_eq!((with / plain - 1.0).abs() > 1e-6, shows, "{effect}: {with} with it, {plain} without");
    }
}

#[test]
fn the_gain_of_the_drive_is_that_of_the_fit() {
    let study = root().join("data/examples/delay/study.toml").to_string_lossy().into_owned();
    let dir = tempfile::tempdir().unwrap();
    let rms = |gain: &str| {
        fs::write(dir.path().join("fit.json"), FIT.replacen("\"joint\": {", &format!("\"joint\": {{{gain}"), 1))
            .unwrap();
        let words = ["simulate", &study, "--fit", "fit.json", "--out", "out", "--json", "found.json"];
        expect_code(dir.path(), &words, 0);
        json(&dir.path().join("found.json"))["logs"][0]["rms"].as_f64().unwrap()
    };
    let without = rms("");
    assert_eq!(rms("\"gain\": {\"value\": 1.0}, "), without);
    assert!((rms("\"gain\": {\"value\": 0.5}, ") / without - 1.0).abs() > 1e-3);
    fs::write(
        dir.path().join("fit.json"),
        FIT.replacen("\"joint\": {", "\"joint\": {\"gain\": {\"value\": -1.0}, ", 1),
    )
    .unwrap();
    let output = run_in(dir.path(), &["simulate", &study, "--fit", "fit.json", "--out", "out"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(stderr(&output).contains("joint.gain.value is -1.0"), "{}", stderr(&output));
}

#[test]
fn the_armature_of_a_fit_stands_for_that_of_the_study() {
    let example = root().join("data/examples/delay");
    let dir = tempfile::tempdir().unwrap();
    fs::copy(example.join("chirp-0.csv"), dir.path().join("chirp-0.csv")).unwrap();
    let study = fs::read_to_string(example.join("study.toml")).unwrap();
    let rms = |stated: f64, found: &str| {
        let study = study.replacen("[motor]\n", &format!("[motor]\narmature = {stated}\n"), 1);
        fs::write(dir.path().join("study.toml"), study).unwrap();
        let fit = FIT.replacen("\"joint\": {", &format!("\"joint\": {{{found}"), 1);
        fs::write(dir.path().join("fit.json"), fit).unwrap();
        rms_of(dir.path(), &["--fit", "fit.json", "--out", "out"])[0].2
    };
    let found = rms(0.02, "\"armature\": {\"value\": 0.005}, ");
    let (same, stated) = (rms(0.005, ""), rms(0.02, ""));
    // The same numbers by another way: rounding alone.
    assert!((found / same - 1.0).abs() < 1e-9, "{found} and {same}");
    assert!((stated / found - 1.0).abs() > 1e-3, "{stated} and {found}");
}

#[test]
fn effects_that_cannot_be_are_refused_by_name() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("study.toml"), STUDY).unwrap();
    fs::write(dir.path().join("good.csv"), good_log()).unwrap();
    let twice = fit_with("delay", &[("T", 0.1)]).replacen(
        "\"effects\": [",
        "\"effects\": [{\"id\": \"delay\", \"parameters\": {\"T\": {\"value\": 0.1}}}, ",
        1,
    );
    let less = fit_with("stribeck", &[("mu_st", 0.01), ("v_st", 0.1)]).replacen(
        "\"coulomb\": {\"value\": 0.0}",
        "\"coulomb\": {\"value\": 0.02}",
        1,
    );
    let cases: Vec<(String, &[&str])> = vec![
        (fit_with("dealy", &[("T", 0.1)]), &["`dealy` is not an effect", "delay, setpoint_hold"]),
        (fit_with("delay", &[]), &["delay lacks T"]),
        (fit_with("delay", &[("T", 0.1), ("t", 0.1)]), &["delay has no parameter `t`; it has T"]),
        (fit_with("backlash", &[("b", 0.01)]), &["backlash lacks rotor"]),
        (fit_with("backlash", &[("b", -0.01), ("rotor", 0.2)]), &["backlash b.value is -0.01 rad", "above zero"]),
        (fit_with("backlash", &[("b", 0.01), ("rotor", 1.0)]), &["backlash rotor.value is 1.0", "0.001 to 0.999"]),
        (fit_with("torque_limit", &[("tau_max", 0.0)]), &["tau_max.value is 0.0 N m", "above zero"]),
        (fit_with("torque_limit", &[("tau_max", 1e300)]), &["tau_max.value is 1e300 N m", "up to 1e9 N m"]),
        (fit_with("angle_offset", &[("d", 45.0)]), &["angle_offset d.value is 45.0 rad", "-6.283 to 6.283 rad"]),
        (
            fit_with("end_stop", &[("q_e", 0.3), ("side", 0.5), ("stiffness", 5.0), ("damping", 0.0)]),
            &["end_stop side.value is 0.5", "-1 or 1"],
        ),
        (fit_with("sensor_gain", &[("e", 0.1)]).replace("0.1", "1e999"), &["out of range", "expected a fit.json"]),
        (fit_with("sensor_gain", &[("e", 0.1)]).replace("0.1", "null"), &["sensor_gain e.value is null"]),
        (twice, &["delay stands there twice"]),
        (less, &["stribeck mu_st.value is 0.01, below the Coulomb friction 0.02"]),
    ];
    for (text, parts) in cases {
        fs::write(dir.path().join("fit.json"), &text).unwrap();
        let output = run_in(dir.path(), &["simulate", "study.toml", "--fit", "fit.json", "--out", "out"]);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(3), "{text}\n{said}");
        for part in std::iter::once(&"fit.json").chain(parts) {
            assert!(said.contains(part), "`{part}` is not in: {said}");
        }
    }
    assert!(!dir.path().join("out").exists());
}

#[test]
fn values_at_the_edge_of_what_is_possible_end_in_a_prediction_or_in_an_error() {
    let dir = tempfile::tempdir().unwrap();
    let free = log_of("t,q", 100, 0.008, |t| format!("{t:.3},{:.5}", decaying(t)));
    let driven =
        log_of("t,q,q_ref", 100, 0.008, |t| format!("{t:.3},{:.5},{:.5}", 0.3 * (4.0 * t).sin(), (4.0 * t).sin()));
    fs::write(dir.path().join("good.csv"), free).unwrap();
    fs::write(dir.path().join("driven.csv"), driven).unwrap();
    let motor = "[motor]\nkp = 0.5\nkd = 0.005\n[[log]]\nfile = \"driven.csv\"\nrole = \"fit\"\ndrive = \"position\"\n";
    fs::write(dir.path().join("study.toml"), format!("{STUDY}{motor}")).unwrap();
    for &effect in EffectId::ALL {
        for end in [0, 1] {
            let known = effect.named_parameters().iter();
            let values: Vec<_> = known
                .map(|p| match p.bounds {
                    Bounds::Within(ends) | Bounds::Either(ends) => (p.name, ends[end]),
                })
                .collect();
            fs::write(dir.path().join("fit.json"), fit_with(effect.id(), &values)).unwrap();
            let began = std::time::Instant::now();
            let output = run_in(dir.path(), &["simulate", "study.toml", "--fit", "fit.json", "--out", "out"]);
            let code = output.status.code();
            assert!(code == Some(0) || code == Some(4), "{effect}, {values:?}: {code:?} {}", stderr(&output));
            assert!(began.elapsed().as_secs() < 30, "{effect}, {values:?}: {:?}", began.elapsed());
        }
    }
}

/// A fit with a law.
fn fit_with_law(law: &str) -> String {
    FIT.replacen("\"effects\": []", &format!("\"effects\": [], \"law\": {law}"), 1)
}

#[test]
fn a_law_of_a_fit_acts_as_the_effect_that_it_imitates() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("study.toml"), STUDY).unwrap();
    fs::write(dir.path().join("good.csv"), good_log()).unwrap();
    let rms = |fit: &str| {
        fs::write(dir.path().join("fit.json"), fit).unwrap();
        rms_of(dir.path(), &["--fit", "fit.json", "--out", "out"])[0].2
    };
    let law = |variable: &str, acts: &str, table: &str| {
        fit_with_law(&format!("{{\"variables\": [\"{variable}\"], \"acts\": \"{acts}\", \"table\": {{{table}}}}}"))
    };
    let plain = rms(FIT);
    let nothing = rms(&law("angle", "torque", "\"x\": [-1, 0, 1], \"y\": [0, 0, 0], \"unit\": \"N m\""));
    assert!((nothing / plain - 1.0).abs() < 1e-9, "{nothing} {plain}");
    let spring = rms(&fit_with("joint_spring", &[("k", 0.02), ("q_s", 0.2)]));
    let like_it = rms(&law("angle", "torque", "\"x\": [-2, 0.2, 2], \"y\": [0.044, 0, -0.036], \"unit\": \"N m\""));
    assert!((like_it / spring - 1.0).abs() < 1e-4 && (spring / plain - 1.0).abs() > 1e-2, "{like_it} {spring} {plain}");
    let drag = rms(&fit_with("quadratic_drag", &[("c2", 0.001)]));
    let curve: Vec<f64> = (0..30).map(|k| 0.4 * f64::from(k)).collect();
    let squares: Vec<f64> = curve.iter().map(|w| 0.001 * w * w).collect();
    let like_it = rms(&law("speed", "friction", &format!("\"x\": {curve:?}, \"y\": {squares:?}")));
    assert!((like_it / drag - 1.0).abs() < 1e-4 && (drag / plain - 1.0).abs() > 1e-3, "{like_it} {drag} {plain}");
    let offset = rms(&law("angle", "reading", "\"x\": [0, 1], \"y\": [-0.2, -0.2], \"unit\": \"rad\""));
    let like_it = rms(&fit_with("angle_offset", &[("d", 0.2)]));
    assert!((like_it / offset - 1.0).abs() < 1e-3 && (offset / plain - 1.0).abs() > 1e-2, "{like_it} {offset} {plain}");
    let said = expect_code(dir.path(), &["simulate", "study.toml", "--fit", "fit.json", "--out", "out"], 0);
    assert!(!said.contains("law"), "{said}");
    fs::write(dir.path().join("fit.json"), law("speed", "friction", "\"x\": [0, 1], \"y\": [0, 1]")).unwrap();
    let said = expect_code(dir.path(), &["simulate", "study.toml", "--fit", "fit.json", "--out", "out"], 0);
    assert!(said.contains("fit.json, with a law of the friction by speed"), "{said}");
}

#[test]
fn laws_that_cannot_be_are_refused_by_name() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("study.toml"), STUDY).unwrap();
    fs::write(dir.path().join("good.csv"), good_log()).unwrap();
    let of = |head: &str, x: &str, y: &str| format!("{{{head}, \"table\": {{\"x\": [{x}], \"y\": [{y}]}}}}");
    let cases: Vec<(String, &[&str])> = vec![
        (of("\"variables\": [\"angel\"]", "0, 1", "0, 1"), &["unknown variable", "angel", "setpoint_rate"]),
        (of("\"variables\": [\"angle\"], \"acts\": \"push\"", "0, 1", "0, 1"), &["push", "torque, friction, reading"]),
        (of("\"variables\": []", "0, 1", "0, 1"), &["law: a law of 0 variables", "exactly one"]),
        (of("\"variables\": [\"angle\"]", "0, 1, 0.5", "0, 1, 1"), &["law: x[2] = 0.5 does not follow x[1] = 1"]),
        (of("\"variables\": [\"angle\"]", "0, 1", "0"), &["law: 2 values in x and 1 in y"]),
        (of("\"variables\": [\"angle\"]", "0", "0"), &["law: 1 knot(s)"]),
        (of("\"variables\": [\"angle\"]", "0, 1", "0, null"), &["null", "line"]),
        (of("\"variables\": [\"angle\"]", "0, 1", "0, NaN"), &["line", "expected a fit.json"]),
        (of("\"variables\": [\"angle\"]", "0, 1", "0, 1e999"), &["out of range"]),
        (of("\"variables\": [\"speed\"], \"acts\": \"reading\"", "0, 1", "0, 1"), &["law: ", "an encoder errs"]),
        ("{\"variables\": [\"angle\"]}".into(), &["table"]),
    ];
    for (law, parts) in cases {
        fs::write(dir.path().join("fit.json"), fit_with_law(&law)).unwrap();
        let output = run_in(dir.path(), &["simulate", "study.toml", "--fit", "fit.json", "--out", "out"]);
        let said = stderr(&output);
        assert_eq!(output.status.code(), Some(3), "{law}\n{said}");
        for part in std::iter::once(&"fit.json").chain(parts) {
            assert!(said.contains(part), "`{part}` is not in: {said}");
        }
    }
    assert!(!dir.path().join("out").exists());
}
