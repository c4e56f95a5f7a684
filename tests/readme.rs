//! Every command that the README shows runs as shown, but the test command itself.

mod support;

use assert_cmd::Command;
use support::root;

/// Commands in the README's `sh` blocks, without comments.
fn commands() -> Vec<String> {
    let text = std::fs::read_to_string(root().join("README.md")).expect("the README is there");
    let mut inside = false;
    let mut commands = Vec::new();
    for line in text.lines() {
        if line.starts_with("```") {
            inside = line == "```sh";
        } else if inside {
            commands.push(line.to_owned());
        }
    }
    commands
}

#[test]
fn commands_of_the_readme_run() {
    let folder = tempfile::tempdir().expect("a folder for the output");
    let fits = folder.path().join("fits");
    let shared = std::env::var("AIBO_FIT_SHARED").ok();
    let mut ran = 0;
    for command in commands() {
        let Some(words) = command.strip_prefix("cargo run --release -- ") else {
            assert_eq!(command, "cargo test --release", "a command that this test does not know");
            continue;
        };
        let words = match (&shared, words.contains("$AIBO_FIT_SHARED")) {
            (Some(shared), true) => words.replace("$AIBO_FIT_SHARED", shared),
            (None, true) => {
                println!("skipped: `{command}`: AIBO_FIT_SHARED is not set");
                continue;
            }
            (_, false) => words.to_owned(),
        };
        // Output goes to a folder of the test's own; what one command writes the next may read.
        let words = words.replace(" fits/", &format!(" {}/", fits.display()));
        // What a command leaves in a folder of its own the next one reads there.
        let of_spec = command.split_once("synth data/examples/synth/").and_then(|(_, spec)| spec.strip_suffix(".toml"));
        let of_study = command.split_once("gap fits/").and_then(|(_, study)| study.strip_suffix("/study.toml"));
        let name = match of_spec.or(of_study) {
            Some(name) => name,
            None if words.contains("ak80") => "ak80-simple-pendulum",
            None => "q",
        };
        let mut words: Vec<String> = words.split_whitespace().map(str::to_owned).collect();
        words.extend(["--out".to_owned(), fits.join(name).display().to_string()]);
        let expected = i32::from(command.contains("q3-bare"));
        Command::cargo_bin("aibo-fit").expect("built").current_dir(root()).args(&words).assert().code(expected);
        ran += 1;
    }
    assert!(ran >= 2, "the README shows at least two commands that need no shared data");
}
