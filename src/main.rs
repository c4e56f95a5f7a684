//! The program: see [`aibo_fit::cli`].

use std::process::ExitCode;

fn main() -> ExitCode {
    aibo_fit::cli::run()
}
