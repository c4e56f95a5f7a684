//! Where a result comes from: version, command line, hashes of the inputs.

use crate::log::{LogError, log_files};
use crate::report::Provenance;
use sha2::{Digest, Sha256};
use std::fs::File;
use std::io;
use std::path::PathBuf;

/// Hashes the input files in their order.
///
/// # Errors
/// [`LogError::Read`] where a file has gone since it was read.
pub(super) fn provenance(inputs: impl IntoIterator<Item = PathBuf>) -> Result<Provenance, LogError> {
    let mut hashed: Vec<(String, String)> = Vec::new();
    let files: Vec<Vec<PathBuf>> = inputs.into_iter().map(|path| log_files(&path)).collect::<Result<_, _>>()?;
    for file in files.into_iter().flatten() {
        let name = file.display().to_string();
        if hashed.iter().any(|(known, _)| *known == name) {
            continue;
        }
        let mut hash = Sha256::new();
        File::open(&file)
            .and_then(|mut reader| io::copy(&mut reader, &mut hash))
            .map_err(|source| LogError::Read { file, source })?;
        hashed.push((name, hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()));
    }
    let words: Vec<String> = std::env::args().skip(1).collect();
    Ok(Provenance {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        command: format!("aibo-fit {}", words.join(" ")),
        inputs: hashed,
    })
}
