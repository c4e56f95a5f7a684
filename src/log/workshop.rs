//! A folder in which a long run works until its result is whole.

use super::error::LogError;
use super::write::{TEMPORARY, make_folders, remove_abandoned};
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Goes at a folder that another run takes for abandoned between its making and its locking.
const GOES: usize = 100;

/// A hidden folder inside a folder of results, which stays as it is meanwhile; it goes with this value.
///
/// One that a killed run left behind is removed by the next that writes there.
#[derive(Debug)]
pub struct Workshop {
    folder: TempDir,
    /// Inside it: who writes several files into a folder locks that, and this one is locked already.
    bench: PathBuf,
    /// Locked as long as the run goes on; `None` where folders cannot be locked.
    _held: Option<File>,
    /// Folders that were not there before, the outermost first.
    made: Vec<PathBuf>,
}

impl Workshop {
    /// Makes one inside `results`, and that folder where it is not there.
    ///
    /// # Errors
    /// [`LogError::Write`] with the folder in which none can be made.
    pub fn inside(results: &Path) -> Result<Self, LogError> {
        let failed = |source| LogError::Write { file: results.to_path_buf(), source };
        let mut made = Vec::new();
        make_folders(results, &mut made).map_err(failed)?;
        remove_abandoned(results);
        for _ in 0..GOES {
            let folder = tempfile::Builder::new().prefix(TEMPORARY).tempdir_in(results).map_err(failed)?;
            let opened = File::open(folder.path()).ok();
            let is_taken =
                opened.as_ref().is_some_and(|opened| matches!(opened.try_lock(), Err(TryLockError::WouldBlock)));
            if !is_taken && folder.path().is_dir() {
                let bench = folder.path().join("bench");
                fs::create_dir(&bench).map_err(failed)?;
                return Ok(Self { folder, bench, _held: opened, made });
            }
        }
        Err(failed(io::ErrorKind::ResourceBusy.into()))
    }

    /// Where to work.
    pub fn path(&self) -> &Path {
        &self.bench
    }
}

impl Drop for Workshop {
    fn drop(&mut self) {
        // A result is no worse for a hidden folder that stays; one that is not empty is somebody else's by now.
        let _ = fs::remove_dir_all(self.folder.path());
        for folder in self.made.iter().rev() {
            let _ = fs::remove_dir(folder);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_goes_with_the_run_and_with_the_folders_that_were_made_for_it() {
        let dir = tempfile::tempdir().unwrap();
        let results = dir.path().join("a/b");
        let workshop = Workshop::inside(&results).unwrap();
        fs::write(workshop.path().join("half"), "half").unwrap();
        assert!(workshop.path().starts_with(&results));
        drop(workshop);
        assert!(!dir.path().join("a").exists());
        let workshop = Workshop::inside(&results).unwrap();
        fs::write(results.join("whole"), "whole").unwrap();
        drop(workshop);
        assert_eq!(fs::read_dir(&results).unwrap().count(), 1);
    }

    #[test]
    fn several_files_at_once_are_written_there() {
        let dir = tempfile::tempdir().unwrap();
        let workshop = Workshop::inside(dir.path()).unwrap();
        assert!(super::super::write::alone_in(workshop.path()).is_some());
    }

    #[test]
    fn one_that_a_killed_run_left_is_removed_and_one_in_use_is_not() {
        let dir = tempfile::tempdir().unwrap();
        fs::create_dir(dir.path().join(".aibo-fit-killed")).unwrap();
        fs::write(dir.path().join(".aibo-fit-killed/half"), "half").unwrap();
        let first = Workshop::inside(dir.path()).unwrap();
        let second = Workshop::inside(dir.path()).unwrap();
        assert!(first.path().is_dir() && second.path().is_dir());
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 2);
    }
}
