//! Files of every kind that the program reads, as they are and spoilt: each reader accepts or refuses, soon and without a panic.
//!
//! `AIBO_FIT_SPOILT=100000 cargo test --release --test corpus` spoils so many instead of a few hundred for each reader.

#[path = "support/readers.rs"]
mod readers;

use rand::seq::IndexedRandom;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use readers::{READERS, Reader};
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// What a reader may take for an input of a few kilobytes; it needs thousandths of it.
const LONGEST: Duration = Duration::from_secs(10);

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Files of the repository that a reader accepts, beside what is kept.
fn seeds(reader: &Reader) -> Vec<PathBuf> {
    let list = fs::read_to_string(root().join("tests/corpus/seeds.txt")).unwrap();
    let of = |line: &str| line.split_once(' ').filter(|(of, _)| *of == reader.name).map(|(_, seed)| root().join(seed));
    list.lines().filter_map(of).collect()
}

/// All files that there are for a reader, in a fixed order.
fn inputs(reader: &Reader) -> Vec<PathBuf> {
    let folder = root().join("tests/corpus").join(reader.name);
    let kept = fs::read_dir(folder).into_iter().flatten().map(|entry| entry.expect("a file").path());
    let mut inputs: Vec<PathBuf> = seeds(reader).into_iter().chain(kept).collect();
    inputs.sort();
    inputs.dedup();
    inputs
}

/// Words that a reader may trip over.
const WORDS: [&str; 16] = [
    "nan",
    "inf",
    "-1",
    "1e308",
    "-1e-320",
    "0",
    "18446744073709551616",
    "\u{0}",
    "[",
    "{",
    "\"",
    "<",
    "..",
    "\n",
    ",",
    "\u{feff}",
];

/// A file with a few things wrong.
fn spoil(mut bytes: Vec<u8>, other: &[u8], random: &mut ChaCha8Rng) -> Vec<u8> {
    for _ in 0..random.random_range(1..6) {
        let at = random.random_range(0..=bytes.len());
        let end = (at + random.random_range(1..64)).min(bytes.len());
        match random.random_range(0..8) {
            0 => bytes.truncate(at),
            1 => drop(bytes.drain(at..end)),
            2 => {
                let word = WORDS.choose(random).expect("there are some").bytes();
                drop(bytes.splice(at..at, word));
            }
            3 => {
                let word = WORDS.choose(random).expect("there are some").bytes();
                drop(bytes.splice(at..end, word));
            }
            4 => {
                let again = bytes[at..end].repeat(random.random_range(1..40));
                drop(bytes.splice(at..at, again));
            }
            5 if !other.is_empty() => {
                let from = random.random_range(0..other.len());
                let to = (from + random.random_range(1..512)).min(other.len());
                drop(bytes.splice(at..end, other[from..to].iter().copied()));
            }
            6 => bytes[at..end.min(at + 8)].fill(if random.random() { 0xff } else { 0 }),
            _ => {
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << random.random_range(0..8);
                }
            }
        }
    }
    bytes
}

#[test]
fn a_spoilt_file_is_read_or_refused_in_time() {
    let dir = tempfile::tempdir().unwrap();
    let goes = std::env::var("AIBO_FIT_SPOILT").map_or(300, |goes| goes.parse().expect("a number"));
    for reader in &READERS {
        let files: Vec<Vec<u8>> = inputs(reader).iter().map(|input| fs::read(input).unwrap()).collect();
        let file = dir.path().join(reader.file);
        let mut random = ChaCha8Rng::seed_from_u64(7);
        for go in 0..goes {
            let (one, other) = (files.choose(&mut random).expect("some"), files.choose(&mut random).expect("some"));
            let spoilt = spoil(one.clone(), other, &mut random);
            fs::write(&file, &spoilt).unwrap();
            let began = Instant::now();
            let ended = catch_unwind(AssertUnwindSafe(|| (reader.read)(&file)));
            if ended.is_err() || began.elapsed() > LONGEST {
                let kept = std::env::temp_dir().join(format!("aibo-fit-spoilt-{}-{go}", reader.name));
                fs::write(&kept, &spoilt).unwrap();
                panic!("{} at {go}: {:?}, see {}", reader.name, began.elapsed(), kept.display());
            }
        }
    }
}

#[test]
fn every_kept_input_is_read_or_refused_in_time() {
    let dir = tempfile::tempdir().unwrap();
    for reader in &READERS {
        let inputs = inputs(reader);
        assert!(!inputs.is_empty(), "there is nothing for {}", reader.name);
        let file = dir.path().join(reader.file);
        for input in inputs {
            fs::write(&file, fs::read(&input).unwrap()).unwrap();
            let began = Instant::now();
            (reader.read)(&file);
            assert!(began.elapsed() < LONGEST, "{}: {:?}", input.display(), began.elapsed());
        }
    }
}

#[test]
fn every_reader_accepts_what_it_begins_with() {
    let dir = tempfile::tempdir().unwrap();
    for reader in &READERS {
        for seed in seeds(reader) {
            let file = dir.path().join(reader.file);
            fs::write(&file, fs::read(&seed).unwrap()).unwrap();
            assert!((reader.read)(&file), "{} refuses {}", reader.name, seed.display());
        }
    }
}
