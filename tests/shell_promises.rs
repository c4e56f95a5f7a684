//! What a shell, a pager and a manual reader get.

mod support;

use std::io::Read;
use std::process::{Command, Stdio};
use support::{expect_code, root, run_in, stderr, stdout};

const COMMANDS: [&str; 6] = ["check", "drop", "gap", "init", "synth", "walk"];

#[test]
fn completions_of_every_shell_know_the_commands_and_their_options() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = expect_code(root(), &["completions", shell], 0);
        for word in COMMANDS.iter().chain(&["without", "max-gap", "threads"]) {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
    let refused = run_in(root(), &["completions", "tcsh"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("bash"), "{}", stderr(&refused));
}

#[test]
fn bash_can_read_its_completions() {
    let script = expect_code(root(), &["completions", "bash"], 0);
    let asked = format!(
        "{script}\nasked=$(complete -p aibo-fit | sed 's/.*-F \\([^ ]*\\).*/\\1/')\nCOMP_WORDS=(aibo-fit ga); COMP_CWORD=1\n$asked aibo-fit ga aibo-fit; echo \"${{COMPREPLY[@]}}\""
    );
    let output = Command::new("bash").args(["-c", &asked]).output().expect("bash can be started");
    assert_eq!(stdout(&output).trim(), "gap gate", "{}", stderr(&output));
}

#[test]
fn the_manual_has_a_page_for_the_program_and_for_every_command() {
    let program = expect_code(root(), &["man"], 0);
    assert!(program.contains(".TH aibo\\-fit 1") || program.contains(".TH aibo-fit 1"), "{program}");
    let gap = expect_code(root(), &["man", "gap"], 0);
    assert!(gap.contains("without") && gap.contains("\\-\\-json"), "{gap}");
    let folder = tempfile::tempdir().unwrap();
    let pages = folder.path().join("man1");
    expect_code(root(), &["man", "--out", pages.to_str().unwrap()], 0);
    for command in COMMANDS {
        let page = std::fs::read_to_string(pages.join(format!("aibo-fit-{command}.1"))).unwrap();
        assert!(page.contains("SYNOPSIS"), "{page}");
    }
    assert!(pages.join("aibo-fit.1").is_file());
    let refused = run_in(root(), &["man", "dance"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("`dance` is no command"), "{}", stderr(&refused));
}

#[test]
fn the_version_tells_what_the_program_can_read() {
    let long = expect_code(root(), &["--version"], 0);
    assert!(long.starts_with(&format!("aibo-fit {}\nfeatures: ", env!("CARGO_PKG_VERSION"))), "{long}");
    assert_eq!(long.contains("without parquet"), !cfg!(feature = "parquet"), "{long}");
    assert_eq!(expect_code(root(), &["-V"], 0), format!("aibo-fit {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn no_color_is_obeyed_and_pipes_get_none() {
    for (variables, coloured) in [
        (&[("CLICOLOR_FORCE", "1")][..], true),
        (&[("CLICOLOR_FORCE", "1"), ("NO_COLOR", "1")][..], false),
        (&[], false),
    ] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_aibo-fit"));
        command.arg("--no-such").env_remove("NO_COLOR").env_remove("CLICOLOR_FORCE").env_remove("CLICOLOR");
        let output = command.envs(variables.iter().copied()).output().unwrap();
        assert_eq!(stderr(&output).contains('\u{1b}'), coloured, "{variables:?}: {}", stderr(&output));
    }
    let output = run_in(root(), &["check", "data/examples/delay/study.toml"]);
    assert!(!stdout(&output).contains('\u{1b}') && stderr(&output).is_empty(), "{}", stderr(&output));
}

/// `aibo-fit ... | head -1`: the reader goes away before everything is printed.
#[test]
fn a_reader_that_goes_away_is_no_panic() {
    for words in
        [&["walk", "--help"][..], &["completions", "zsh"], &["man", "walk"], &["dynamics", "data/examples/states.json"]]
    {
        let mut command = Command::new(env!("CARGO_BIN_EXE_aibo-fit"));
        command.current_dir(root()).args(words).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        drop(child.stdout.take());
        let mut told = String::new();
        child.stderr.take().unwrap().read_to_string(&mut told).unwrap();
        assert_eq!((child.wait().unwrap().code(), told.as_str()), (Some(0), ""), "{words:?}");
    }
    // Nobody listens to an error either.
    let mut command = Command::new(env!("CARGO_BIN_EXE_aibo-fit"));
    let mut child = command.args(["gap", "none.toml"]).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(5));
}

/// In a terminal of 80 columns; `None` where no pseudo-terminal can be had.
#[cfg(unix)]
fn in_a_terminal(command: &str) -> Option<String> {
    let script = format!("stty cols 80 rows 40; {} {command}", env!("CARGO_BIN_EXE_aibo-fit"));
    let mut terminal = Command::new("script");
    terminal.current_dir(root()).args(["-qec", &script, "/dev/null"]).stdin(Stdio::null());
    match terminal.output() {
        Ok(output) => Some(stdout(&output).replace('\r', "")),
        Err(error) => {
            println!("skipped: `script` cannot be run: {error}");
            None
        }
    }
}

#[cfg(unix)]
#[test]
fn text_keeps_to_the_columns_of_a_terminal() {
    let out = tempfile::tempdir().unwrap();
    let out = out.path().display();
    for command in [
        "check data/examples/delay/study.toml".to_owned(),
        format!("gap data/examples/ambiguous/study.toml --out {out}"),
        format!("drop data/thesis-robot/q1-220g-0.csv --out {out}"),
        format!("sensor-test --out {out}"),
    ] {
        let Some(text) = in_a_terminal(&command) else { return };
        // Progress goes to the same terminal, and is overwritten; paths are not broken.
        let lines = text.lines().filter(|line| !line.contains('\u{1b}') && !line.starts_with("report: "));
        let lines: Vec<&str> = lines.collect();
        assert!(lines.len() > 10, "{command}:\n{text}");
        let wide: Vec<&&str> = lines.iter().filter(|line| line.chars().count() > 80).collect();
        assert!(wide.is_empty(), "{command}: {wide:#?}");
    }
}

#[test]
fn numbers_that_no_joint_has_and_surprising_logs_are_told_first() {
    let folder = tempfile::tempdir().unwrap();
    let study = std::fs::read_to_string(root().join("data/examples/delay/study.toml")).unwrap();
    let log = root().join("data/examples/delay/chirp-0.csv");
    let study = study.replace("file = \"chirp-0.csv\"", &format!("file = \"{}\"", log.display()));
    let heavy = study.replace("inertia = 0.011", "inertia = 11.0");
    assert_ne!(heavy, study);
    std::fs::write(folder.path().join("heavy.toml"), heavy).unwrap();
    std::fs::write(folder.path().join("study.toml"), study).unwrap();
    let check = expect_code(folder.path(), &["check", "heavy.toml"], 0);
    assert!(check.starts_with("The stated inertia and moment are those of a pendulum of 220 m"), "{check}");
    let gap = run_in(folder.path(), &["gap", "heavy.toml", "--json", "gap.json"]);
    assert!(stderr(&gap).starts_with("warning: The stated inertia and moment"), "{}", stderr(&gap));
    assert!(support::json(&folder.path().join("gap.json"))["doubts"][0].as_str().unwrap().contains("220 m"));
    let drop = run_in(folder.path(), &["drop", "--study", "study.toml"]);
    assert!(stderr(&drop).contains("chirp-0.csv: driven by setpoints"), "{}", stderr(&drop));
    assert!(stdout(&drop).contains("driven by setpoints"), "{}", stdout(&drop));
}

#[test]
fn runs_of_different_robots_do_not_share_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    let robot = root().join("data/ers7.toml");
    let own = folder.path().join("mine.toml");
    std::fs::copy(robot, &own).unwrap();
    expect_code(folder.path(), &["walk", "--air", "--duration", "0.5", "-q"], 0);
    expect_code(folder.path(), &["walk", "--air", "--duration", "0.5", "-q", "--robot", own.to_str().unwrap()], 0);
    for name in ["walk-air", "walk-air-mine"] {
        assert!(folder.path().join("fits").join(name).join("report.html").is_file(), "{name}");
    }
}
