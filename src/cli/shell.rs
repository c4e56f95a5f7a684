//! `aibo-fit completions` and `aibo-fit man`: what a shell and a pager want to know of the program.

use super::common::{print, write_outputs};
use super::{CliError, program};
use crate::log::Outputs;
use clap::{Args, Command};
use clap_complete::Shell;
use std::path::PathBuf;

/// Print the completion script of a shell
///
/// bash: `aibo-fit completions bash > ~/.local/share/bash-completion/completions/aibo-fit`; zsh: into a file `_aibo-fit` in a
/// folder of `$fpath`; fish: `aibo-fit completions fish > ~/.config/fish/completions/aibo-fit.fish`.
#[derive(Args, Debug)]
#[command(after_help = "Example: aibo-fit completions bash")]
pub(super) struct CompletionsArgs {
    /// The shell
    #[arg(value_enum, value_name = "SHELL")]
    shell: Shell,
}

/// Print the manual page of the program or of a command
///
/// `aibo-fit man | man -l -` shows it; --out writes the pages of all commands.
#[derive(Args, Debug)]
#[command(after_help = "Examples: aibo-fit man gap | man -l -\n          aibo-fit man --out ~/.local/share/man/man1")]
pub(super) struct ManArgs {
    /// A command [default: the program]
    #[arg(value_name = "COMMAND", conflicts_with = "out")]
    command: Option<String>,
    /// Write the pages of the program and of every command into this folder
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Prints the script.
pub(super) fn completions(args: &CompletionsArgs) -> Result<u8, CliError> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut program(), "aibo-fit", &mut script);
    print(&String::from_utf8_lossy(&script));
    Ok(0)
}

/// Prints a page, or writes all of them.
pub(super) fn man(args: &ManArgs) -> Result<u8, CliError> {
    let mut program = program();
    // What every command has of the program (its version) comes with this.
    program.build();
    if let Some(folder) = &args.out {
        let mut outputs = Outputs::default();
        for command in std::iter::once(&program).chain(commands(&program)) {
            outputs.add(folder.join(format!("{}.1", page_name(command))), page(command)?);
        }
        write_outputs(outputs, &[])?;
        return Ok(0);
    }
    let command = match &args.command {
        None => &program,
        Some(name) => commands(&program).find(|command| command.get_name() == name).ok_or_else(|| {
            let names: Vec<&str> = commands(&program).map(Command::get_name).collect();
            CliError::Usage(format!("`{name}` is no command; there are {}", names.join(", ")))
        })?,
    };
    print(&page(command)?);
    Ok(0)
}

fn commands(program: &Command) -> impl Iterator<Item = &Command> {
    program.get_subcommands().filter(|command| command.get_name() != "help")
}

/// `aibo-fit-gap`, as its page is called.
fn page_name(command: &Command) -> String {
    match command.get_name() {
        "aibo-fit" => "aibo-fit".to_owned(),
        name => format!("aibo-fit-{name}"),
    }
}

fn page(command: &Command) -> Result<String, CliError> {
    let mut page = Vec::new();
    let named = command.clone().display_name(page_name(command));
    let written = clap_mangen::Man::new(named).render(&mut page);
    written.map_err(|error| CliError::Encode(error.to_string()))?;
    Ok(String::from_utf8_lossy(&page).into_owned())
}
