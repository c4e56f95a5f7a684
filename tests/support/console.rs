//! Blocks of commands and output in the documents: found, run, compared, and on demand written anew.
//!
//! A block that begins with ```` ```console ```` has lines that begin with `$ ` (commands, run by a shell in one folder for each
//! document, in which `data`, `examples` and `tests` are the
//! repository's) and below each what it prints, on both streams. A line `...` or `[...]` stands
//! for any number of lines. A comment in the line above the block says where that is not so:
//!
//! - `<!-- not run: your files -->`: the commands need files that only the reader has;
//! - `<!-- not run: installs -->`: they change the machine;
//! - `<!-- slow -->`: they take ten seconds or more, or need what such a one leaves, and are run by the ignored test.
//!
//! Blocks with `$AIBO_FIT_SHARED` are skipped where that is not set.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

const FENCE: &str = "```console";
const NOT_RUN: [&str; 2] = ["<!-- not run: your files -->", "<!-- not run: installs -->"];
const SLOW: &str = "<!-- slow -->";

/// What is to be done with a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Quick,
    Slow,
    NotRun,
}

/// A block of a document.
#[derive(Clone, Debug)]
pub struct Block {
    /// Its first line after the fence, and the line of the closing fence, from 0.
    lines: [usize; 2],
    pub kind: Kind,
    steps: Vec<Step>,
}

/// A command with what the document says that it prints.
#[derive(Clone, Debug)]
struct Step {
    shown: Vec<String>,
    command: String,
    output: Vec<String>,
}

/// The blocks of a document.
///
/// # Panics
/// Where a block is not written as the module says.
pub fn blocks(name: &str, text: &str) -> Vec<Block> {
    let lines: Vec<&str> = text.lines().collect();
    let mut blocks = Vec::new();
    let mut k = 0;
    while k < lines.len() {
        if !lines[k].starts_with("```") {
            k += 1;
            continue;
        }
        let end = (k + 1..lines.len()).find(|&i| lines[i] == "```");
        let end = end.unwrap_or_else(|| panic!("{name}:{}: a block without an end", k + 1));
        let fence = lines[k];
        let is_console = fence == FENCE;
        let other_shell = ["```sh", "```bash", "```shell"].contains(&fence);
        assert!(!other_shell, "{name}:{}: commands stand in `console` blocks, so that they are run", k + 1);
        let looks_like_one = lines[k + 1..end].iter().any(|line| line.starts_with("$ "));
        assert!(is_console || !looks_like_one, "{name}:{}: a command outside a `console` block", k + 1);
        if is_console {
            let above = k.checked_sub(1).map_or("", |above| lines[above]);
            let kind = match above {
                _ if NOT_RUN.contains(&above) => Kind::NotRun,
                SLOW => Kind::Slow,
                other => {
                    assert!(!other.starts_with("<!-- not run"), "{name}:{k}: `{other}` is no reason; see console.rs");
                    Kind::Quick
                }
            };
            let steps = steps(name, k, &lines[k + 1..end]);
            blocks.push(Block { lines: [k + 1, end], kind, steps });
        }
        k = end + 1;
    }
    blocks
}

fn steps(name: &str, line: usize, block: &[&str]) -> Vec<Step> {
    let mut steps: Vec<Step> = Vec::new();
    let mut goes_on = false;
    for text in block {
        match (text.strip_prefix("$ "), steps.last_mut()) {
            (Some(command), _) if !goes_on => {
                steps.push(Step { shown: vec![(*text).to_owned()], command: command.to_owned(), output: Vec::new() });
                goes_on = command.ends_with('\\');
            }
            (_, Some(step)) if goes_on => {
                step.shown.push((*text).to_owned());
                let _ = write!(step.command, "\n{text}");
                goes_on = text.ends_with('\\');
            }
            (_, Some(step)) => step.output.push(text.trim_end().to_owned()),
            (_, None) => panic!("{name}:{}: a `console` block begins with a command", line + 2),
        }
    }
    steps
}

/// A document whose blocks were run.
pub struct Outcome {
    /// With what the commands print now.
    pub text: String,
    /// What was not as shown.
    pub wrong: Vec<String>,
    /// Commands that were run.
    pub ran: usize,
}

/// Runs the blocks of a kind in a folder of their own. Quick ones are also run where slow ones are asked for: these may need
/// what those leave.
pub fn run(root: &Path, name: &str, text: &str, slow: bool) -> Outcome {
    let folder = tempfile::tempdir().expect("a folder for the output");
    #[cfg(unix)]
    for linked in ["data", "examples", "tests"] {
        std::os::unix::fs::symlink(root.join(linked), folder.path().join(linked)).expect("a link can be made");
    }
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let mut outcome = Outcome { text: String::new(), wrong: Vec::new(), ran: 0 };
    let has_shared = std::env::var_os("AIBO_FIT_SHARED").is_some();
    // From the back, so that lines in front keep their numbers when a block grows; run from the front.
    let mut replaced = Vec::new();
    for block in blocks(name, text) {
        if block.kind == Kind::NotRun || block.kind == Kind::Slow && !slow {
            continue;
        }
        if !has_shared && block.steps.iter().any(|step| step.command.contains("$AIBO_FIT_SHARED")) {
            println!("skipped: {name}:{}: AIBO_FIT_SHARED is not set", block.lines[0]);
            continue;
        }
        let mut new = Vec::new();
        for step in &block.steps {
            let (printed, code) = shell(folder.path(), &step.command);
            outcome.ran += 1;
            new.extend(step.shown.iter().cloned());
            let ended_well = matches!(code, Some(0 | 1));
            if ended_well && matches(&step.output, &printed) {
                new.extend(step.output.iter().cloned());
                continue;
            }
            let at = format!("{name}:{}: `{}`", block.lines[0], step.command);
            outcome.wrong.push(match ended_well {
                true => format!("{at} prints\n{}\nand not\n{}", printed.join("\n"), step.output.join("\n")),
                false => format!("{at} ends with {code:?}:\n{}", printed.join("\n")),
            });
            new.extend(realigned(&step.output, &printed).unwrap_or_else(|| step.output.clone()));
        }
        replaced.push((block.lines, new));
    }
    for ([from, to], new) in replaced.into_iter().rev() {
        lines.splice(from..to, new);
    }
    outcome.text = lines.join("\n") + "\n";
    outcome
}

fn shell(folder: &Path, command: &str) -> (Vec<String>, Option<i32>) {
    let program = Path::new(env!("CARGO_BIN_EXE_aibo-fit")).parent().expect("the program is in a folder");
    let path = std::env::var("PATH").unwrap_or_default();
    let output = Command::new("sh")
        .args(["-c", &format!("exec 2>&1\n{command}")])
        .current_dir(folder)
        .env("PATH", format!("{}:{path}", program.display()))
        .env_remove("NO_COLOR")
        .output()
        .expect("a shell can be started");
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let mut lines: Vec<String> = text.lines().map(|line| line.trim_end().to_owned()).collect();
    while lines.last().is_some_and(String::is_empty) {
        lines.pop();
    }
    (lines, output.status.code())
}

fn is_elision(line: &str) -> bool {
    line == "..." || line == "[...]"
}

/// Whether what is shown, with its elisions, is what was printed.
fn matches(shown: &[String], printed: &[String]) -> bool {
    if shown.is_empty() {
        return true;
    }
    let parts: Vec<&[String]> = shown.split(|line| is_elision(line)).collect();
    let mut at = 0;
    for (i, part) in parts.iter().enumerate() {
        let part = trimmed(part);
        let last_of_several = i > 0 && i + 1 == parts.len();
        let found = match (i, last_of_several) {
            (0, _) => printed.starts_with(part).then_some(0),
            (_, true) if part.is_empty() => Some(printed.len()),
            (_, true) => {
                (printed.len() >= at + part.len() && printed.ends_with(part)).then(|| printed.len() - part.len())
            }
            _ => (at..=printed.len().saturating_sub(part.len())).find(|&k| printed[k..].starts_with(part)),
        };
        let Some(found) = found else { return false };
        at = found + part.len();
    }
    parts.len() > 1 || at == printed.len()
}

/// Without blank lines at its ends: they stand for the reader beside an elision.
fn trimmed(part: &[String]) -> &[String] {
    let from = part.iter().position(|line| !line.is_empty()).unwrap_or(part.len());
    let to = part.iter().rposition(|line| !line.is_empty()).map_or(from, |last| last + 1);
    &part[from..to]
}

/// What was printed, with elisions where the document has them; `None` where their places are not found again.
fn realigned(shown: &[String], printed: &[String]) -> Option<Vec<String>> {
    let mut parts = shown.split(|line| is_elision(line)).enumerate().peekable();
    let mut elisions = shown.iter().filter(|line| is_elision(line));
    let (mut new, mut at) = (Vec::new(), 0);
    while let Some((i, part)) = parts.next() {
        let is_last = parts.peek().is_none();
        let core = trimmed(part);
        if let (Some(first), Some(last)) = (core.first(), core.last()) {
            let from = if i == 0 { 0 } else { like(printed, first, at)? };
            let to = match is_last {
                true => printed.len(),
                false => like(printed, last, from).unwrap_or_else(|| end_of_paragraph(printed, from)) + 1,
            };
            let (before, after) = (part.first() != core.first(), part.last() != core.last());
            new.extend(before.then(String::new));
            new.extend_from_slice(&printed[from..to]);
            new.extend(after.then(String::new));
            at = to;
        }
        new.extend(elisions.next().filter(|_| !is_last).cloned());
    }
    Some(new)
}

/// The first line from one on that begins like another, whatever its numbers are.
fn like(printed: &[String], line: &str, from: usize) -> Option<usize> {
    let plain = |line: &str| line.replace(|c: char| c.is_ascii_digit() || c == '.', "").trim().to_owned();
    let wanted = plain(line);
    [40, 24, 12, 6].into_iter().find_map(|length| {
        let beginning: String = wanted.chars().take(length).collect();
        (from..printed.len()).find(|&k| plain(&printed[k]).starts_with(&beginning))
    })
}

fn end_of_paragraph(printed: &[String], from: usize) -> usize {
    (from..printed.len()).take_while(|&k| !printed[k].is_empty()).last().unwrap_or(from)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &str) -> Vec<String> {
        text.split('|').map(str::to_owned).collect()
    }

    #[test]
    fn elisions_stand_for_any_number_of_lines_and_nothing_else_does() {
        let printed = lines("one|two|three|four");
        for shown in ["one|two|three|four", "one|...|four", "...|two|[...]", "one|...", "one|...||two|three|four"] {
            assert!(matches(&lines(shown), &printed), "{shown}");
        }
        for shown in ["one|two|three", "one|three|...", "...|three", "two|...", "one|...|five|...", "one|...|two"] {
            assert!(!matches(&lines(shown), &printed), "{shown}");
        }
    }

    #[test]
    fn what_is_printed_now_takes_the_place_of_what_was_with_its_elisions() {
        let shown = lines("gap 1.5|...|number 12 of 3||...|end 4");
        let printed = lines("gap 2.25|more|number 7 of 9|last|end 5|really");
        let expected = lines("gap 2.25|...|number 7 of 9||...|end 5|really");
        assert_eq!(realigned(&shown, &printed).unwrap(), expected);
    }

    #[test]
    fn blocks_are_commands_with_their_output() {
        let text = "a\n<!-- slow -->\n```console\n$ one \\\n  two\nout\n$ three\n```\n```text\nno\n```\n";
        let found = blocks("x.md", text);
        assert_eq!((found.len(), found[0].kind, found[0].steps.len()), (1, Kind::Slow, 2));
        assert_eq!(found[0].steps[0].command, "one \\\n  two");
        assert_eq!((found[0].steps[0].output.join(","), found[0].steps[1].output.len()), ("out".to_owned(), 0));
    }
}
