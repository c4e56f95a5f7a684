//! Damaged files of every format: one clear error that names the file, bounded memory, and never more than that.

use aibo_fit::log::{LogError, Source, read_source};
use proptest::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};

/// Files of every format, by their names under `tests/logs`.
const FILES: [&str; 16] = [
    "arm.mcap",
    "arm-json.mcap",
    "bag/bag.db3",
    "lerobot-v3/data/chunk-000/file-000.parquet",
    "arm.npz",
    "bam.json",
    "plotjuggler.csv",
    "echo.csv",
    "long.csv",
    "frame.csv",
    "bag-messages/bag-messages.db3",
    "bag-files/bag-files.db3.zstd",
    "ros1.bag",
    "ros1-bz2.bag",
    "ros1-lz4.bag",
    "fields.npy",
];

fn good(name: &str) -> Vec<u8> {
    fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/logs").join(name)).unwrap()
}

fn read(name: &str, bytes: &[u8]) -> Result<Source, LogError> {
    let dir = tempfile::tempdir().unwrap();
    let path: PathBuf = dir.path().join(Path::new(name).file_name().unwrap());
    fs::write(&path, bytes).unwrap();
    read_source(&path, &Default::default())
}

#[test]
fn files_that_are_cut_short_are_refused_whole() {
    for name in FILES {
        let bytes = good(name);
        // A table that is cut at the end of a row is a shorter table.
        let is_table = name.ends_with(".csv");
        for share in [0.02, 0.3, 0.7, 0.98] {
            let cut = (bytes.len() as f64 * share) as usize;
            match read(name, &bytes[..cut]) {
                Ok(_) => assert!(is_table, "{name} at {share} is read"),
                Err(error) => {
                    let message = error.to_string();
                    assert!(message.contains(Path::new(name).file_name().unwrap().to_str().unwrap()), "{message}");
                    assert!(!error.is_io(), "{message}");
                }
            }
        }
    }
}

#[test]
fn what_a_header_announces_is_never_believed() {
    let huge = u64::MAX.to_le_bytes();
    // The length of the first chunk of an MCAP file.
    let mut mcap = good("arm.mcap");
    let chunk = mcap.windows(4).position(|bytes| bytes == b"zstd").unwrap() - 4 - 4 - 8 - 16;
    for (at, what) in [(chunk - 8, "announced"), (chunk + 16, "announced")] {
        let mut lying = mcap.clone();
        lying[at..at + 8].copy_from_slice(&huge);
        let message = read("arm.mcap", &lying).unwrap_err().to_string();
        assert!(message.contains(what), "{message}");
    }
    // A chunk that says less than it holds.
    mcap[chunk + 16..chunk + 24].copy_from_slice(&200_u64.to_le_bytes());
    assert!(read("arm.mcap", &mcap).is_err());
    // The page count of an SQLite file.
    let mut bag = good("bag/bag.db3");
    bag[28..32].copy_from_slice(&u32::MAX.to_be_bytes());
    let message = read("bag.db3", &bag).unwrap_err().to_string();
    assert!(message.contains("cut short"), "{message}");
}

#[test]
fn a_packed_file_that_is_no_bag_or_unpacks_to_more_than_it_announces_is_refused() {
    // A gigabyte of nothing in 130 kB: blocks that repeat one byte, as zstd's format has them.
    let mut bomb = vec![0x28, 0xb5, 0x2f, 0xfd, 0x00, 0x58];
    (0..8192).for_each(|_| bomb.extend([0x02, 0x00, 0x10, 0x00]));
    let message = read("bag.db3.zstd", &bomb).unwrap_err().to_string();
    assert!(message.contains("no bag in it"), "{message}");
    // The same after the header of a bag of 16 pages.
    let head = &good("bag/bag.db3")[..100];
    let mut lying = bomb[..6].to_vec();
    // A block as it is, of 100 bytes.
    lying.extend(&(100_u32 << 3).to_le_bytes()[..3]);
    lying.extend(head);
    lying.extend(&bomb[6..]);
    let message = read("bag.db3.zstd", &lying).unwrap_err().to_string();
    assert!(message.contains("unpacks to more than it announces"), "{message}");
    // A bag of ROS 1 that says more chunks than it has.
    let mut bag = good("ros1.bag");
    let count = bag.windows(12).position(|bytes| bytes == b"chunk_count=").unwrap() + 12;
    bag[count] += 1;
    let message = read("ros1.bag", &bag).unwrap_err().to_string();
    assert!(message.contains("2 chunks are announced, 1 are there; 180 messages"), "{message}");
    // One that was never closed.
    let at = bag.windows(10).position(|bytes| bytes == b"index_pos=").unwrap() + 10;
    bag[at..at + 8].fill(0);
    assert!(read("ros1.bag", &bag).unwrap_err().to_string().contains("rosbag reindex"));
}

#[test]
fn other_files_under_these_names_are_told_apart() {
    for (name, bytes, part) in [
        ("a.mcap", &b"not a recording of any kind"[..], "does not begin as an MCAP file does"),
        ("a.db3", b"text", "does not begin as an SQLite file does"),
        ("a.parquet", b"text", "does not begin as a Parquet file does"),
        ("a.npz", b"text", "does not begin as a zip file does"),
        ("a.npy", b"\x93NUMPY\x01\x00", "cut short"),
        ("a.bag", b"#ROSBAG V2.0\n", "ROS 1"),
        ("a.json", b"{\"a\": 1}", "missing field `entries`"),
        ("a.db3", b"SQLite format 3\0", "shorter than its header"),
        ("a.mcap", b"\x89MCAP0\r\n", "no end of data"),
        ("a.parquet", b"PAR1PAR1", "damaged"),
    ] {
        let message = read(name, bytes).unwrap_err().to_string();
        assert!(message.contains(part) && message.contains(name), "{name}: {message}");
    }
}

/// A zip file with one stored entry of these bytes, as large as the directory says.
fn zip(name: &str, bytes: &[u8], announced: u32) -> Vec<u8> {
    let (name, size) = (name.as_bytes(), announced.to_le_bytes());
    let head = |start: &[u8], skip: usize| {
        let mut out = start.to_vec();
        out.resize(out.len() + skip, 0);
        out.extend((bytes.len() as u32).to_le_bytes());
        out.extend(size);
        out.extend((name.len() as u16).to_le_bytes());
        out
    };
    let mut out = head(b"PK\x03\x04", 14);
    out.extend([0, 0]);
    out.extend(name);
    out.extend(bytes);
    let start = out.len();
    let mut entry = head(b"PK\x01\x02", 16);
    entry.resize(46, 0);
    entry.extend(name);
    out.extend(&entry);
    out.extend(b"PK\x05\x06");
    out.extend([0, 0, 0, 0, 1, 0, 1, 0]);
    out.extend((entry.len() as u32).to_le_bytes());
    out.extend((start as u32).to_le_bytes());
    out.extend([0, 0]);
    out
}

#[test]
fn arrays_of_more_than_is_there_are_refused_before_they_are_held() {
    let array = |shape: &str| {
        let text = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}\n");
        let mut out = b"\x93NUMPY\x01\x00".to_vec();
        out.extend((text.len() as u16).to_le_bytes());
        out.extend(text.as_bytes());
        out
    };
    for (shape, announced) in [("(99999999999,)", u32::MAX - 1), ("(4000000000, 500)", u32::MAX - 1), ("(1000,)", 200)]
    {
        let message = read("a.npz", &zip("t.npy", &array(shape), announced)).unwrap_err().to_string();
        assert!(message.contains("array `t`") && message.contains("announced"), "{shape}: {message}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]
    #[test]
    fn bytes_that_are_wrong_are_an_error_or_another_log(
        which in 0..FILES.len(),
        flips in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in prop::option::of(any::<prop::sample::Index>()),
        head in any::<bool>(),
    ) {
        let name = FILES[which];
        let mut bytes = good(name);
        if let Some(cut) = cut {
            let length = cut.index(bytes.len());
            bytes.truncate(length);
        }
        for (at, to) in flips {
            // Heads and tails are where lengths stand.
            let span = if head { bytes.len().min(400) } else { bytes.len() };
            if span > 0 {
                let at = at.index(span);
                bytes[at] = to;
            }
        }
        if let Err(error) = read(name, &bytes) {
            prop_assert!(!error.to_string().is_empty());
        }
    }
}
