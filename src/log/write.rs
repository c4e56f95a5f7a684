//! Writes files whole or not at all.

use std::fs::{self, File, TryLockError};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use super::error::LogError;
use super::types::Log;

/// Writes a file so that a reader sees the old content or all of the new, never a part.
///
/// The content goes to a temporary file in the same folder, which then takes the name; folders are created as needed.
/// A device or a pipe (`/dev/stdout`) is written to directly.
///
/// # Errors
/// [`LogError::Write`] with the path, also where `content` fails; the old file is then untouched.
pub fn write_atomically(path: &Path, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), LogError> {
    write_or_leave(path, content).map_err(|source| LogError::Write { file: path.to_path_buf(), source })
}

fn write_or_leave(path: &Path, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    if is_special(path) {
        let mut out = BufWriter::new(File::options().write(true).open(path)?);
        content(&mut out)?;
        return out.flush();
    }
    fs::create_dir_all(folder_of(path))?;
    remove_abandoned(folder_of(path));
    let mut out = BufWriter::new(temporary_beside(path)?);
    content(&mut out)?;
    let file = out.into_inner().map_err(io::IntoInnerError::into_error)?;
    file.persist(path).map_err(|error| error.error)?;
    Ok(())
}

/// A device or a pipe.
pub(super) fn is_special(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|meta| !meta.is_file() && !meta.is_dir())
}

pub(super) fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Begin of the names of files, and of folders, that are being written.
pub(super) const TEMPORARY: &str = ".aibo-fit-";
/// Goes at a temporary file that another run takes for abandoned between its making and its locking.
const GOES: usize = 100;

/// A file to write to, locked for as long as it is open: see [`remove_abandoned`].
pub(super) fn temporary_beside(path: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(TEMPORARY);
    #[cfg(unix)]
    {
        // a temporary file is private by default; a result gets what any new file gets
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    for _ in 0..GOES {
        let file = builder.tempfile_in(folder_of(path))?;
        let is_taken = matches!(file.as_file().try_lock(), Err(TryLockError::WouldBlock));
        if !is_taken && file.path().exists() {
            return Ok(file);
        }
    }
    Err(io::ErrorKind::ResourceBusy.into())
}

/// Removes what runs that were killed left half-written in a folder: files and folders of ours that nobody holds locked.
/// Where the file system has no locks nothing is removed.
pub(super) fn remove_abandoned(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if !entry.file_name().to_string_lossy().starts_with(TEMPORARY) {
            continue;
        }
        let path = entry.path();
        if File::open(&path).is_ok_and(|file| file.try_lock().is_ok()) {
            let is_folder = entry.file_type().is_ok_and(|kind| kind.is_dir());
            // what stays is no fault of this run
            let _ = if is_folder { fs::remove_dir_all(&path) } else { fs::remove_file(&path) };
        }
    }
}

/// Makes a folder and those above it, and adds to `made` what was not there before.
pub(super) fn make_folders(folder: &Path, made: &mut Vec<PathBuf>) -> io::Result<()> {
    let missing: Vec<&Path> =
        folder.ancestors().take_while(|f| !f.as_os_str().is_empty() && fs::symlink_metadata(f).is_err()).collect();
    for folder in missing.into_iter().rev() {
        match fs::create_dir(folder) {
            Ok(()) => made.push(folder.to_path_buf()),
            // Another run was faster.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
    // A file in the way of the folder is found here.
    fs::create_dir_all(folder)
}

/// Held while files take their names, so that of two runs into one folder the later one has all of them.
///
/// `None` where folders cannot be locked.
pub(super) fn alone_in(folder: &Path) -> Option<File> {
    let folder = File::open(folder).ok()?;
    folder.lock().ok()?;
    Some(folder)
}

/// Writes a log as CSV, in the format that [`read_log`](super::read_log) reads; numbers keep every digit.
///
/// Ignored columns are gone, they were never read.
///
/// # Errors
/// [`LogError::Ragged`] if the columns differ in length, [`LogError::Write`] as [`write_atomically`].
pub fn write_log(path: &Path, log: &Log) -> Result<(), LogError> {
    let mut columns: Vec<(&'static str, &[f64])> = vec![("t", &log.t_s), ("q", &log.q_rad)];
    let optional = [("dq", &log.dq_rad_s), ("tau", &log.tau_nm), ("q_ref", &log.q_ref_rad)];
    columns.extend(optional.into_iter().filter_map(|(name, column)| Some((name, column.as_deref()?))));
    let lengths = columns.iter().map(|(name, column)| (*name, column.len()));
    let expected = log.len();
    for (column, found) in lengths.chain(log.drive.iter().map(|drive| ("drive", drive.len()))) {
        if found != expected {
            return Err(LogError::Ragged { file: path.to_path_buf(), column, found, expected });
        }
    }
    write_atomically(path, |out| {
        let names: Vec<&str> = columns.iter().map(|(name, _)| *name).collect();
        out.write_all(names.join(",").as_bytes())?;
        out.write_all(if log.drive.is_some() { b",drive\n" } else { b"\n" })?;
        for i in 0..expected {
            for (k, (_, column)) in columns.iter().enumerate() {
                write!(out, "{}{}", if k == 0 { "" } else { "," }, column[i])?;
            }
            if let Some(drive) = &log.drive {
                write!(out, ",{}", u8::from(drive[i]))?;
            }
            out.write_all(b"\n")?;
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::log::{read_joint_log, read_log, read_study};
    use proptest::prelude::*;

    #[test]
    fn folders_are_made_and_the_old_file_survives_a_failure() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a/b/out.txt");
        write_atomically(&path, |w| w.write_all(b"old")).unwrap();
        let error = write_atomically(&path, |w| {
            w.write_all(b"half")?;
            Err(io::Error::other("disk full"))
        })
        .unwrap_err();
        assert!(error.is_io());
        assert!(error.to_string().contains("out.txt") && error.to_string().contains("disk full"), "{error}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 1);
    }

    #[test]
    fn runs_that_make_the_same_folders_at_once_all_have_them_and_each_is_made_by_one() {
        let dir = tempfile::tempdir().unwrap();
        for round in 0..50 {
            let folder = dir.path().join(format!("{round}/fits/run"));
            let make = || {
                let mut made = Vec::new();
                make_folders(&folder, &mut made).map(|()| made.len())
            };
            let made: Vec<io::Result<usize>> = std::thread::scope(|scope| {
                let runs: Vec<_> = (0..4).map(|_| scope.spawn(make)).collect();
                runs.into_iter().map(|run| run.join().unwrap()).collect()
            });
            assert_eq!(made.into_iter().map(Result::unwrap).sum::<usize>(), 3);
        }
    }

    #[test]
    fn what_a_killed_run_left_is_removed_and_what_is_being_written_is_not() {
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join(".aibo-fit-killed"), "half").unwrap();
        fs::write(dir.path().join("mine"), "mine").unwrap();
        let being_written = temporary_beside(&dir.path().join("other")).unwrap();
        write_atomically(&dir.path().join("out"), |w| w.write_all(b"new")).unwrap();
        assert!(being_written.path().exists() && dir.path().join("mine").exists());
        drop(being_written);
        assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 2);
    }

    #[test]
    fn a_folder_in_the_way_is_an_error_that_names_it() {
        let dir = tempfile::tempdir().unwrap();
        let error = write_atomically(dir.path(), |w| w.write_all(b"x")).unwrap_err();
        assert!(error.to_string().contains(&*dir.path().to_string_lossy()));
    }

    #[cfg(unix)]
    #[test]
    fn a_device_is_written_to_and_stays_a_device() {
        write_atomically(Path::new("/dev/null"), |w| w.write_all(b"x")).unwrap();
        assert!(!fs::metadata("/dev/null").unwrap().is_file());
    }

    #[test]
    fn ragged_columns_are_refused() {
        let log = Log {
            file: "x".into(),
            t_s: vec![0.0, 0.1],
            q_rad: vec![0.0],
            dq_rad_s: None,
            tau_nm: None,
            q_ref_rad: None,
            setpoints: None,
            drive: None,
            ignored_columns: vec![],
            notes: vec![],
        };
        assert!(matches!(write_log(Path::new("x.csv"), &log), Err(LogError::Ragged { column: "q", .. })));
    }

    fn logs() -> impl Strategy<Value = Log> {
        let rows = prop::collection::vec((1e-4..0.1_f64, -20.0..20.0_f64, -5.0..5.0_f64, any::<bool>()), 1..60);
        (rows, -3.0..3.0_f64, prop_oneof![Just(0.0), Just(1.7e9)], any::<[bool; 4]>()).prop_map(
            |(rows, q0, t0, has)| {
                let (mut t_s, mut q_rad) = (vec![t0], vec![q0]);
                let (mut other, mut drive) = (vec![0.1], vec![true]);
                let (mut t, mut q) = (t0, q0);
                for (dt, speed, value, on) in rows {
                    t += dt;
                    q = (q + speed * dt).clamp(-6.0, 6.0);
                    t_s.push(t);
                    q_rad.push(q);
                    other.push(value);
                    drive.push(on);
                }
                Log {
                    file: "x".into(),
                    dq_rad_s: has[0].then(|| other.clone()),
                    tau_nm: has[1].then(|| other.iter().map(|x| x * 1e-7).collect()),
                    q_ref_rad: has[2].then(|| q_rad.clone()),
                    setpoints: None,
                    drive: has[3].then_some(drive),
                    t_s,
                    q_rad,
                    ignored_columns: vec![],
                    notes: vec![],
                }
            },
        )
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        #[test]
        fn what_is_written_is_read_back_bit_for_bit(mut log in logs()) {
            let dir = tempfile::tempdir().unwrap();
            log.file = dir.path().join("log.csv");
            write_log(&log.file, &log).unwrap();
            prop_assert_eq!(read_log(&log.file).unwrap(), log);
        }

        #[test]
        fn no_bytes_make_a_reader_panic(
            head in prop::sample::select(vec!["", "t,q\n", "\u{feff}t,a.q,drive\r\n", "schema = 1\n[joint]\n"]),
            bytes in prop_oneof![
                prop::collection::vec(any::<u8>(), 0..200),
                "[0-9.,;\\-\"\n\r\te a-z=\\[\\]{}']{0,200}".prop_map(String::into_bytes),
            ],
        ) {
            let dir = tempfile::tempdir().unwrap();
            let path = dir.path().join("any");
            fs::write(&path, [head.as_bytes(), &bytes].concat()).unwrap();
            for error in [read_log(&path).err(), read_joint_log(&path, Some("a")).err(), read_study(&path).err()] {
                prop_assert!(error.is_none_or(|error| error.to_string().contains("any")));
            }
        }
    }
}
