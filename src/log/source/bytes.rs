//! Reading records of announced lengths from a stream, however it ends.

use std::fs::File;
use std::io::{ErrorKind, Read, Seek, SeekFrom};

/// The first bytes of an SQLite file.
pub(super) const SQLITE_MAGIC: &[u8] = b"SQLite format 3\0";
/// The first bytes of an MCAP file, and its last.
pub(super) const MCAP_MAGIC: &[u8] = b"\x89MCAP0\r\n";
/// The first bytes of a bag of ROS 1.
pub(super) const ROS1_MAGIC: &[u8] = b"#ROSBAG V";
/// The first bytes of a file or message that zstd packed.
pub(super) const ZSTD_MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

/// What an error of reading says of the file.
pub(super) fn cut(error: std::io::Error) -> String {
    match error.kind() {
        ErrorKind::UnexpectedEof => "cut short within a record".to_owned(),
        _ => format!("damaged: {error}"),
    }
}

/// As many bytes as there are, up to the whole.
pub(super) fn read_up_to(input: &mut dyn Read, into: &mut [u8]) -> Result<usize, String> {
    let mut have = 0;
    while have < into.len() {
        match input.read(&mut into[have..]) {
            Ok(0) => break,
            Ok(count) => have += count,
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(cut(error)),
        }
    }
    Ok(have)
}

/// Passes over so many bytes.
pub(super) fn skip(input: &mut dyn Read, length: u64) -> Result<(), String> {
    let skipped = std::io::copy(&mut input.take(length), &mut std::io::sink()).map_err(cut)?;
    if skipped == length { Ok(()) } else { Err("cut short within a record".to_owned()) }
}

/// The file's size, where it can be told.
pub(super) fn size(file: &mut File) -> Result<u64, String> {
    file.seek(SeekFrom::End(0)).map_err(|error| error.to_string())
}
