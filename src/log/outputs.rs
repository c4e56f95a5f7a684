//! Files that are written together.

use super::error::LogError;
use super::manifest::{MANIFEST_FILE, files_of, replace};
use super::write::{
    alone_in, folder_of, is_special, make_folders, remove_abandoned, temporary_beside, write_atomically,
};
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Files that belong together and are written all or none.
///
/// Every file is first written beside its place under a temporary name; only when all of them are there do they take
/// their names, and no other run into the same folder meanwhile. Where one cannot be written, no file has changed and no new
/// folder stays.
///
/// Where they are a report, with a page that ties them together, what an earlier run left of the same report goes once
/// all of them are written, so that no figure of another run stays beside the page ([`MANIFEST_FILE`]).
#[derive(Debug, Default)]
pub struct Outputs {
    files: Vec<Output>,
    /// The page that ties the files of its folder together.
    page: Option<PathBuf>,
    inputs: Vec<PathBuf>,
}

/// A path and what is to take its place.
type Staged<'a> = (&'a Path, NamedTempFile);

#[derive(Debug)]
struct Output {
    path: PathBuf,
    content: Vec<u8>,
    /// Asked for by its path: no part of a report.
    is_apart: bool,
}

impl Outputs {
    /// Adds a file; of two with one path the later counts.
    pub fn add(&mut self, path: impl Into<PathBuf>, content: impl Into<Vec<u8>>) {
        self.files.push(Output { path: path.into(), content: content.into(), is_apart: false });
    }

    /// Adds a file that the user named: it stays until it is named again.
    pub fn add_apart(&mut self, path: impl Into<PathBuf>, content: impl Into<Vec<u8>>) {
        self.files.push(Output { path: path.into(), content: content.into(), is_apart: true });
    }

    /// Adds the page that the other files in its folder belong to.
    pub fn add_page(&mut self, path: impl Into<PathBuf>, content: impl Into<Vec<u8>>) {
        let path = path.into();
        self.page = Some(path.clone());
        self.add(path, content);
    }

    /// Files that were read: they are never removed.
    pub fn keep(&mut self, inputs: &[PathBuf]) {
        self.inputs.extend_from_slice(inputs);
    }

    /// Paths of the files, in the order in which they were added.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        self.files.iter().map(|file| file.path.as_path())
    }

    /// Writes all files.
    ///
    /// # Errors
    /// [`LogError::Write`] with the path that cannot be written, or removed.
    pub fn write(self) -> Result<(), LogError> {
        let mut made = Vec::new();
        let written = self.stage(&mut made);
        if written.is_err() {
            // Innermost first; one that is not empty is somebody else's by now.
            for folder in made.iter().rev() {
                let _ = fs::remove_dir(folder);
            }
        }
        let staged = written?;
        let folder = self.page.as_deref().or_else(|| self.paths().next()).map(folder_of);
        let _alone = folder.and_then(alone_in);
        self.name(staged)?;
        self.replace_earlier()
    }

    fn replace_earlier(&self) -> Result<(), LogError> {
        let Some(page) = &self.page else { return Ok(()) };
        let own = self.files.iter().filter(|file| !file.is_apart);
        let files = files_of(page, own.map(|file| (file.path.as_path(), &file.content)));
        let kept = self.paths().chain(self.inputs.iter().map(PathBuf::as_path));
        let list = replace(page, files, kept).map_err(|(file, source)| LogError::Write { file, source })?;
        write_atomically(&folder_of(page).join(MANIFEST_FILE), |out| out.write_all(list.as_bytes()))
    }

    /// Writes all files under temporary names; new folders are added to `made`.
    fn stage(&self, made: &mut Vec<PathBuf>) -> Result<Vec<Staged<'_>>, LogError> {
        let mut staged = Vec::with_capacity(self.files.len());
        let mut tidied: Vec<&Path> = Vec::new();
        for Output { path, content, .. } in &self.files {
            let failed = |source| LogError::Write { file: path.clone(), source };
            if path.is_dir() {
                return Err(failed(io::ErrorKind::IsADirectory.into()));
            }
            if is_special(path) {
                continue;
            }
            make_folders(folder_of(path), made).map_err(failed)?;
            if !tidied.contains(&folder_of(path)) {
                remove_abandoned(folder_of(path));
                tidied.push(folder_of(path));
            }
            let mut file = temporary_beside(path).map_err(failed)?;
            file.write_all(content).map_err(failed)?;
            staged.push((path.as_path(), file));
        }
        // What is no file has no earlier content to keep.
        for Output { path, content, .. } in self.files.iter().filter(|file| is_special(&file.path)) {
            write_atomically(path, |out| out.write_all(content))?;
        }
        Ok(staged)
    }

    /// Gives what was written its names.
    fn name(&self, staged: Vec<Staged<'_>>) -> Result<(), LogError> {
        for (path, file) in staged {
            file.persist(path).map_err(|error| LogError::Write { file: path.to_path_buf(), source: error.error })?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outputs_are_written_all_or_none_and_leave_no_folder() {
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join("old"), "old").unwrap();
        fs::create_dir(dir.path().join("folder")).unwrap();
        let mut outputs = Outputs::default();
        outputs.add(dir.path().join("old"), "new");
        outputs.add(dir.path().join("a/b/one"), "1");
        outputs.add(dir.path().join("folder"), "2");
        let error = outputs.write().unwrap_err().to_string();
        assert!(error.contains("folder: could not be written") && error.contains("name of a file"), "{error}");
        assert_eq!(fs::read_to_string(dir.path().join("old")).unwrap(), "old");
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 2);

        let mut outputs = Outputs::default();
        outputs.add(dir.path().join("old"), "new");
        outputs.add(dir.path().join("a/b/one"), "1");
        outputs.write().unwrap();
        assert_eq!(fs::read_to_string(dir.path().join("old")).unwrap(), "new");
        assert_eq!(fs::read_to_string(dir.path().join("a/b/one")).unwrap(), "1");
        assert_eq!(fs::read_dir(dir.path().join("a/b")).unwrap().count(), 1);
    }

    fn report(folder: &Path, page: &str, figures: &[&str]) -> Outputs {
        let mut outputs = Outputs::default();
        for name in figures {
            outputs.add(folder.join(name), *name);
        }
        outputs.add_page(folder.join(page), format!("page of {figures:?}"));
        outputs
    }

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> =
            fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.retain(|name| name != MANIFEST_FILE);
        names.sort();
        names
    }

    #[test]
    fn a_report_takes_the_place_of_the_last_one_and_of_nothing_else() {
        let dir = tempfile::tempdir().unwrap();
        let out = dir.path();
        fs::write(out.join("mine.svg"), "mine").unwrap();
        let mut first =
            report(out, "report.html", &["a.svg", "b.svg", "edited.svg", "read.svg", "deep/er/c.svg", "own/c.svg"]);
        first.add_apart(out.join("asked.json"), "asked");
        first.write().unwrap();
        report(out, "study.toml", &["log.csv"]).write().unwrap();
        fs::write(out.join("edited.svg"), "edited by hand").unwrap();
        fs::write(out.join("own/mine"), "mine").unwrap();
        let mut second = report(out, "report.html", &["a.svg", "d.svg"]);
        second.keep(&[out.join("read.svg")]);
        second.write().unwrap();
        let there = ["a.svg", "asked.json", "d.svg", "edited.svg", "log.csv", "mine.svg", "own", "read.svg"];
        assert_eq!(names(out), [&there[..], &["report.html", "study.toml"]].concat());
        assert_eq!(names(&out.join("own")), ["mine"]);
    }

    #[test]
    fn a_report_that_cannot_be_written_leaves_the_last_one_whole() {
        let dir = tempfile::tempdir().unwrap();
        report(dir.path(), "report.html", &["a.svg", "b.svg"]).write().unwrap();
        fs::create_dir(dir.path().join("c.svg")).unwrap();
        report(dir.path(), "report.html", &["c.svg"]).write().unwrap_err();
        assert_eq!(names(dir.path()), ["a.svg", "b.svg", "c.svg", "report.html"]);
    }

    #[test]
    fn a_list_that_leads_out_of_the_folder_or_is_none_removes_nothing() {
        let dir = tempfile::tempdir().unwrap();
        let out = dir.path().join("out");
        report(&out, "report.html", &["a.svg"]).write().unwrap();
        fs::write(dir.path().join("outside"), "a.svg").unwrap();
        let list = fs::read_to_string(out.join(MANIFEST_FILE)).unwrap();
        assert!(list.contains("\"a.svg\" = "), "{list}");
        let absolute = dir.path().join("outside").display().to_string();
        for other in ["../outside", absolute.as_str(), "./../outside"] {
            fs::write(out.join(MANIFEST_FILE), list.replace("a.svg", other)).unwrap();
            report(&out, "report.html", &["b.svg"]).write().unwrap();
            assert!(dir.path().join("outside").is_file(), "{other}");
        }
        report(&out, "report.html", &["c.svg"]).write().unwrap();
        assert_eq!(names(&out), ["a.svg", "c.svg", "report.html"]);
        fs::write(out.join(MANIFEST_FILE), "no = list").unwrap();
        report(&out, "report.html", &["d.svg"]).write().unwrap();
        assert_eq!(names(&out), ["a.svg", "c.svg", "d.svg", "report.html"]);
    }

    #[cfg(unix)]
    #[test]
    fn a_folder_that_is_a_link_to_elsewhere_is_left_alone() {
        let dir = tempfile::tempdir().unwrap();
        let out = dir.path().join("out");
        report(&out, "report.html", &["deep/a.svg"]).write().unwrap();
        fs::rename(out.join("deep"), dir.path().join("elsewhere")).unwrap();
        std::os::unix::fs::symlink(dir.path().join("elsewhere"), out.join("deep")).unwrap();
        report(&out, "report.html", &[]).write().unwrap();
        assert!(dir.path().join("elsewhere/a.svg").is_file());
    }
}
