//! The channels of a file of any format that is read.

use std::fs;
use std::path::Path;

use super::assemble::no_angle;
use super::channel::Source;
use super::defects::Defects;
use super::joint_tables::read_joint_table;
use super::kind::{Kind, kind_of};
use super::mend::{tried, untried};
use super::table::read_table;
use super::want::Want;
use super::{bags, bam, npz, sage};
use crate::log::column::Column;
use crate::log::columns::Columns;
use crate::log::error::LogError;
use crate::log::header::none_there;
use crate::log::place::Place;

/// Reads all that a file or folder of any known format holds, by what `[columns]` says of it.
///
/// ```
/// use aibo_fit::log::{Columns, read_source};
/// let source = read_source("data/examples/arm/log0.csv".as_ref(), &Columns::default())?;
/// assert_eq!(source.joints(), [Some("arm/shoulder"), Some("arm/elbow")]);
/// # Ok::<(), aibo_fit::log::LogError>(())
/// ```
///
/// # Errors
/// [`LogError`] where it cannot be read, is damaged, or is of no format that is known.
pub fn read_source(path: &Path, columns: &Columns) -> Result<Source, LogError> {
    read_wanted(path, Want::Any, columns)
}

/// What is wanted of a file or folder. Where other names or units would read it, the error has them.
///
/// # Errors
/// As [`read_source`].
pub(in crate::log) fn read_wanted(path: &Path, want: Want<'_>, columns: &Columns) -> Result<Source, LogError> {
    // The log of a robot needs names of joints; of any other a study takes whatever there is.
    let whole = if matches!(want, Want::Robot) { Want::Robot } else { Want::Any };
    read_once(path, want, columns).map_err(|error| match fs::metadata(path) {
        Ok(about) if about.is_file() || about.is_dir() => tried(error, columns, |lines| read_once(path, whole, lines)),
        _ => untried(error),
    })
}

fn read_once(path: &Path, want: Want<'_>, columns: &Columns) -> Result<Source, LogError> {
    let source = match kind_of(path, columns)? {
        Kind::Table => return read_table(path, want, columns),
        Kind::JointTable(layout) => read_joint_table(path, layout)?,
        Kind::Sage(folder) => sage::read_sage(&folder)?,
        Kind::Bags(files) => bags::read_bags(path, &files)?,
        Kind::LeRobot => lerobot(path)?,
        Kind::Npz => npz::read_npz(path, columns)?,
        Kind::Npy => npz::read_npy(path, columns)?,
        Kind::Bam => bam::read_bam(path)?,
    };
    let mut source = checked(source, want, columns)?;
    if source.joints().is_empty() {
        return Err(no_angle(&source));
    }
    source.notes.insert(0, format!("read as {}", source.format));
    Ok(source)
}

/// A source by what `[columns]` says of it, its stamps and numbers checked.
///
/// # Errors
/// [`LogError`] with all defects.
pub(in crate::log) fn checked(source: Source, want: Want<'_>, columns: &Columns) -> Result<Source, LogError> {
    let source = mapped(source, columns)?;
    check(&source, want)?;
    Ok(source)
}

#[cfg(feature = "parquet")]
fn lerobot(path: &Path) -> Result<Source, LogError> {
    super::lerobot::read_lerobot(path)
}

#[cfg(not(feature = "parquet"))]
fn lerobot(path: &Path) -> Result<Source, LogError> {
    let what = "this build reads no Parquet; build with the feature `parquet`".to_owned();
    Err(LogError::Format { file: path.to_path_buf(), format: crate::log::format::Format::LeRobot, what })
}

/// Applies `[columns]`, and the units that the reader told.
fn mapped(mut source: Source, columns: &Columns) -> Result<Source, LogError> {
    for (ours, spec) in columns.0.iter().filter(|(ours, _)| *ours != Column::Time.name()) {
        let Some(at) = source.channels.iter().position(|channel| channel.theirs == spec.name) else {
            // Its own name does not stand in for the one that is said, whose unit and sign it may not have.
            let is_angle = ours.ends_with(Column::Angle.name()) && !ours.ends_with(Column::Speed.name());
            if source.ours(ours).is_none() && !is_angle {
                continue;
            }
            let found = source.channels.iter().map(|channel| channel.theirs.clone()).collect();
            let hint = Some(none_there(ours, spec));
            let at = Box::new(Place::in_file(&source.file));
            return Err(LogError::MissingColumn { at, column: spec.name.clone(), found, hint });
        };
        source.channels.iter_mut().filter(|c| c.ours.as_ref() == Some(ours)).for_each(|c| c.ours = None);
        let channel = &mut source.channels[at];
        let told = channel.spec.take().and_then(|spec| spec.unit);
        channel.ours = Some(ours.clone());
        if spec.unit.is_some() {
            source.stated.insert(ours.clone());
        }
        channel.spec = Some(crate::log::columns::ColumnSpec { unit: spec.unit.or(told), ..spec.clone() });
    }
    for channel in &mut source.channels {
        if let Some(spec) = channel.spec.take() {
            channel.values.iter_mut().for_each(|value| *value = spec.apply(*value));
        }
    }
    Ok(source)
}

/// What the checks of a table are to a table: stamps that rise, numbers, units.
fn check(source: &Source, want: Want<'_>) -> Result<(), LogError> {
    let mut defects = Defects::default();
    let wrong = |what: String| LogError::Format { file: source.file.clone(), format: source.format, what };
    for (clock, t_s) in source.clocks.iter().enumerate() {
        let name = source.channels.iter().find(|channel| channel.clock == clock).map_or("", |channel| &channel.theirs);
        if let Some(at) = t_s.windows(2).position(|pair| !(pair[1] > pair[0])) {
            defects.push(
                Some(clock),
                wrong(format!("stamps of {name} do not rise: {} s after {} s", t_s[at + 1], t_s[at])),
            );
        }
    }
    for channel in source.channels.iter().filter(|channel| channel.is_wanted(want)) {
        if let Some(at) = channel.values.iter().position(|value| !value.is_finite() || value.abs() > 1e9) {
            defects.push(
                None,
                wrong(format!("{}, sample {at}: {}, expected a number", channel.theirs, channel.values[at])),
            );
        }
    }
    if defects.is_empty() {
        source.unit_defects(want, &mut defects);
    }
    let mend = if defects.is_empty() { Columns::default() } else { source.mend(want) };
    defects.into_result(mend)
}
