//! One reader, chosen by the environment variable `READER`, under libFuzzer, with its file in `FOLDER`; `fuzz/run` starts it.
#![no_main]

#[path = "../../tests/support/readers.rs"]
mod readers;

use libfuzzer_sys::fuzz_target;
use readers::{READERS, Reader};
use std::env;
use std::fs;
use std::path::PathBuf;
use std::sync::LazyLock;

/// The reader under test, and the file that it is given.
static UNDER_TEST: LazyLock<(&Reader, PathBuf)> = LazyLock::new(|| {
    let name = env::var("READER").unwrap_or_default();
    let named = READERS.iter().find(|reader| reader.name == name);
    let reader = named.unwrap_or_else(|| panic!("READER is {name:?}; readers are those of tests/support/readers.rs"));
    let folder = env::var_os("FOLDER").map(PathBuf::from).expect("FOLDER is where the file is written");
    (reader, folder.join(reader.file))
});

fuzz_target!(|bytes: &[u8]| {
    let (reader, file) = &*UNDER_TEST;
    fs::write(file, bytes).expect("the file is written");
    (reader.read)(file);
});
