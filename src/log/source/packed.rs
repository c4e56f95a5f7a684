//! Bags that were packed as a whole by zstd, as `ros2 bag record --compression-mode file` leaves them.

use std::fs::File;
use std::io::{BufReader, BufWriter, Read, Seek, SeekFrom, Write};

use super::bytes::{MCAP_MAGIC, SQLITE_MAGIC, ZSTD_MAGIC};
use super::sqlite;

/// Largest bag, unpacked \[bytes\]; one of SQLite says by itself how large it is.
const LARGEST: u64 = 8 << 30;
/// Of the start, what is looked at before any of it is stored \[bytes\].
const HEAD: usize = 100;

/// Whether a file begins as one that zstd packed; its place is as before.
///
/// # Errors
/// That of reading it.
pub(super) fn is_packed(file: &mut File) -> std::io::Result<bool> {
    let mut start = [0; 4];
    let is_packed = file.read_exact(&mut start).is_ok() && start == ZSTD_MAGIC;
    file.seek(SeekFrom::Start(0))?;
    Ok(is_packed)
}

/// The bag in a packed file, in a file without a name that goes when it is closed. Only what begins as a bag is unpacked,
/// and of one of SQLite no more than it announces.
///
/// # Errors
/// What is wrong with it, in words.
pub(super) fn unpack(file: File) -> Result<File, String> {
    let damaged = |error: &dyn std::fmt::Display| format!("cut short or damaged: its zstd: {error}");
    let mut input = BufReader::with_capacity(1 << 16, file);
    let mut out = BufWriter::with_capacity(1 << 16, tempfile::tempfile().map_err(|error| told(&error))?);
    let (mut left, mut is_first) = (LARGEST, true);
    // A file may hold several frames, one after the other.
    while !at_end(&mut input).map_err(|error| damaged(&error))? {
        let mut frame = ruzstd::decoding::StreamingDecoder::new(&mut input).map_err(|error| damaged(&error))?;
        if is_first {
            let mut head = Vec::with_capacity(HEAD);
            (&mut frame).take(HEAD as u64).read_to_end(&mut head).map_err(|error| damaged(&error))?;
            left = size_of(&head)?.saturating_sub(head.len() as u64);
            out.write_all(&head).map_err(|error| told(&error))?;
            is_first = false;
        }
        let mut piece = vec![0; 1 << 16];
        loop {
            let count = frame.read(&mut piece).map_err(|error| damaged(&error))?;
            if count == 0 {
                break;
            }
            left = left.checked_sub(count as u64).ok_or("it unpacks to more than it announces")?;
            out.write_all(&piece[..count]).map_err(|error| told(&error))?;
        }
    }
    let mut unpacked = out.into_inner().map_err(|error| told(error.error()))?;
    unpacked.seek(SeekFrom::Start(0)).map_err(|error| told(&error))?;
    Ok(unpacked)
}

fn told(error: &std::io::Error) -> String {
    format!("it could not be unpacked into the folder for temporary files: {error}")
}

fn at_end(input: &mut BufReader<File>) -> std::io::Result<bool> {
    Ok(std::io::BufRead::fill_buf(input)?.is_empty())
}

/// How large what begins like that may be \[bytes\].
fn size_of(head: &[u8]) -> Result<u64, String> {
    if head.starts_with(SQLITE_MAGIC) && head.len() == HEAD {
        return Ok(sqlite::announced(head).unwrap_or(LARGEST));
    }
    if head.starts_with(MCAP_MAGIC) {
        return Ok(LARGEST);
    }
    Err("packed by zstd, and no bag in it: it begins neither as SQLite nor as MCAP".to_owned())
}
