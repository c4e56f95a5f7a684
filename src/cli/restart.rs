//! How this program is started again, for processes that do a part of its work.

use super::CliError;
use std::ffi::OsString;
use std::sync::OnceLock;

/// The beginning of a command line that starts this program.
static PROGRAM: OnceLock<Vec<OsString>> = OnceLock::new();

/// Remembers it, where the running file is not the program: an interpreter that has loaded it.
pub(super) fn remember(program: Vec<OsString>) {
    let _ = PROGRAM.set(program);
}

/// What was remembered, else the running file.
///
/// # Errors
/// [`CliError::Threads`] where the running file is not known.
pub(super) fn program() -> Result<Vec<OsString>, CliError> {
    if let Some(program) = PROGRAM.get() {
        return Ok(program.clone());
    }
    let own = std::env::current_exe().map_err(|error| CliError::Threads(format!("the own program: {error}")))?;
    Ok(vec![own.into_os_string()])
}
