//! A process that answers one study, so that nothing that happens to it happens to another.

use crate::cli::CliError;
use crate::cli::error::{IO, NO};
use crate::cli::restart::program;
use crate::fleet::{Fleet, Outcome};
use std::process::{self, Command, ExitStatus, Output, Stdio};
use std::{env, fs, io, thread};

/// Set for a worker.
const OF_FLEET: &str = "AIBO_FIT_WORKER_OF_FLEET";

/// Starts processes.
pub(super) struct Worker {
    program: Vec<std::ffi::OsString>,
    threads: usize,
}

impl Worker {
    /// Of this program, with so many threads each.
    pub fn new(threads: usize) -> Result<Self, CliError> {
        Ok(Self { program: program()?, threads: threads.max(1) })
    }

    /// What comes of a study; one whose process has crashed is tried once more.
    pub fn answer(&self, fleet: &Fleet, study: usize) -> Outcome {
        match self.once(fleet, study) {
            Outcome::Lost(_) => match self.once(fleet, study) {
                Outcome::Lost(why) => Outcome::Lost(format!("{why}, twice")),
                outcome => outcome,
            },
            outcome => outcome,
        }
    }

    fn once(&self, fleet: &Fleet, study: usize) -> Outcome {
        let working = fleet.working(study);
        let pages = if fleet.options().pages { fleet.pages_of(study) } else { working.clone() };
        let document = working.join("gap.json");
        // What an earlier process left is no answer of this one.
        let _ = fs::remove_file(&document);
        let mut command = Command::new(&self.program[0]);
        command.args(&self.program[1..]).arg("gap").arg(fleet.path(study)).args(fleet.options().words());
        command.args(["--threads".to_owned(), self.threads.to_string(), "--quiet".to_owned()]);
        command.arg("--json").arg(&document).arg("--out").arg(pages);
        command.env("RAYON_NUM_THREADS", self.threads.to_string());
        command.env(OF_FLEET, "").stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
        let outcome = match ended(&mut command) {
            Err(error) => Outcome::Lost(format!("its process cannot be started: {error}")),
            Ok(output) => match output.status.code().and_then(|code| u8::try_from(code).ok()) {
                Some(0 | NO) => match fs::read_to_string(&document) {
                    Ok(text) => Outcome::of_text(&text),
                    Err(error) => Outcome::Lost(format!("its process left no answer: {error}")),
                },
                Some(code) if code <= IO => {
                    let why = error_of(&String::from_utf8_lossy(&output.stderr));
                    // A disk that is full or away for now is none of the study's own faults.
                    if code == IO { Outcome::Lost(why) } else { Outcome::None(why) }
                }
                _ => Outcome::Lost(ended_by(output.status)),
            },
        };
        let _ = fs::remove_dir_all(&working);
        // The last one out leaves no empty folder.
        let _ = working.parent().map(fs::remove_dir);
        outcome
    }
}

/// Runs a worker to its end; it reads nothing, but sees by its input whether this process is still there.
fn ended(command: &mut Command) -> io::Result<Output> {
    let mut child = command.spawn()?;
    let _held = child.stdin.take();
    child.wait_with_output()
}

/// A worker ends with its fleet: one that is killed takes its workers along, which would otherwise write into the folder of
/// the fleet that comes after it.
pub(in crate::cli) fn end_with_fleet() {
    if env::var_os(OF_FLEET).is_some() {
        thread::spawn(|| {
            let _ = io::copy(&mut io::stdin(), &mut io::sink());
            process::exit(i32::from(IO));
        });
    }
}

/// `its process was ended by signal 9 (killed; out of memory ends so, too)`
fn ended_by(status: ExitStatus) -> String {
    #[cfg(unix)]
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        let meaning = match signal {
            9 => " (killed; out of memory ends so, too)",
            6 | 11 => " (crashed; please report this)",
            _ => "",
        };
        return format!("its process was ended by signal {signal}{meaning}");
    }
    format!("its process crashed ({status}; please report this)")
}

/// What the program says after `error:`, warnings before it left out.
fn error_of(told: &str) -> String {
    let from = if told.starts_with("error: ") { Some(0) } else { told.find("\nerror: ").map(|at| at + 1) };
    told[from.map_or(0, |at| at + "error: ".len())..].trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_told_without_the_warnings_before_it() {
        assert_eq!(error_of("error: a.toml: an error: it\n  | more\n"), "a.toml: an error: it\n  | more");
        assert_eq!(error_of("warning: no mass\nerror: b\n"), "b");
        assert_eq!(error_of("something\n"), "something");
    }
}
