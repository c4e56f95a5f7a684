//! The same bytes on another processor and on other threads: what is asked of the C library, and whole runs as an older
//! processor would do them.
#![cfg(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu"))]

mod support;

use object::Object;
use object::read::NameOrOrdinal;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;
use support::{root, stderr};

const PROGRAM: &str = env!("CARGO_BIN_EXE_aibo-fit");

/// Elementary functions that a C library has: it may choose among several by the processor.
const ELEMENTARY: [&str; 40] = [
    "acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "cbrt", "cos", "cosh", "erf", "erfc", "exp", "exp10",
    "exp2", "expm1", "hypot", "lgamma", "lgamma_r", "log", "log10", "log1p", "log2", "pow", "sin", "sincos", "sinh",
    "tan", "tanh", "tgamma", "cosf", "expf", "hypotf", "logf", "powf", "sincosf", "sinf", "tanf", "atan2f", "tanhf",
];

/// In the program only for what is never called: the writer of Parquet's Bloom filters and its decimals, powers in templates.
/// Our own code is kept from them by `clippy.toml`.
const UNUSED: [&str; 3] = ["log", "log10", "pow"];

/// Processors without fused multiplication and AVX, as the C library is told about them.
const OLDER: &str = "glibc.cpu.hwcaps=-AVX,-AVX2,-AVX512F,-AVX512VL,-FMA,-FMA4,-AVX_Fast_Unaligned_Load,-AVX2_Usable";

/// Commands that integrate and draw, a second at most, with what each is given.
const SHORT: [&[&str]; 2] =
    [&["dynamics", "data/examples/states.json"], &["simulate", "data/examples/resolved/study.toml"]];
/// Commands that search and decide by what comes out, and draw by chance besides.
const LONG: [&[&str]; 2] = [&["drop", "data/q1.csv"], &["gap", "data/examples/resolved/study.toml"]];

/// What a run printed and left, by file.
fn left_by(run: &mut Command, words: &[&str]) -> BTreeMap<String, Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    // the same names in both runs: a result says where its files are
    run.current_dir(folder.path()).arg(words[0]).arg(root().join(words[1])).args(&words[2..]);
    run.args(["--json", "out/all.json"]);
    if words[0] != "dynamics" {
        run.args(["--out", "out"]);
    }
    let output = run.output().expect("it can be started");
    assert_eq!(output.status.code(), Some(0), "{words:?}\n{}", stderr(&output));
    let out = folder.path().join("out");
    let mut left = BTreeMap::new();
    gather(&out, &out, &mut left);
    assert!(left.contains_key("all.json"), "{words:?} left {:?}", left.keys());
    left
}

fn gather(root: &Path, folder: &Path, into: &mut BTreeMap<String, Vec<u8>>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            gather(root, &path, into);
        } else {
            let name = path.strip_prefix(root).unwrap().to_string_lossy().into_owned();
            into.insert(name, fs::read(&path).unwrap());
        }
    }
}

/// Runs the commands here and elsewhere and compares every byte that they leave.
fn agree(commands: &[&[&str]], elsewhere: impl Fn() -> Command) {
    for words in commands {
        same(words, &left_by(&mut Command::new(PROGRAM), words), &left_by(&mut elsewhere(), words));
    }
}

fn same(words: &[&str], here: &BTreeMap<String, Vec<u8>>, there: &BTreeMap<String, Vec<u8>>) {
    assert!(here.keys().eq(there.keys()), "{words:?}: other files");
    for (name, content) in here {
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let first = text(content).lines().zip(text(&there[name]).lines()).find(|(a, b)| a != b).map(|(a, b)| {
            let cut = |line: &str| line.chars().take(200).collect::<String>();
            format!("\n{}\n{}", cut(a), cut(b))
        });
        assert!(content == &there[name], "{words:?}: {name} differs{}", first.unwrap_or_default());
    }
}

#[test]
fn the_same_bytes_on_one_two_and_eight_threads() {
    let looks: [&[&str]; 2] = [&["check", "data/q1.csv"], &["synth", "data/examples/synth/bench.toml", "--seed", "1"]];
    for words in [&looks[..], &SHORT, &LONG].concat() {
        let on = |threads| left_by(Command::new(PROGRAM).env("RAYON_NUM_THREADS", threads), words);
        let one = on("1");
        for threads in ["2", "8"] {
            same(words, &one, &on(threads));
        }
    }
}

#[test]
fn the_program_asks_the_c_library_for_no_elementary_function() {
    let bytes = fs::read(PROGRAM).unwrap();
    let program = object::File::parse(&*bytes).expect("a program");
    let imports = program.imports().expect("what it imports");
    let name = |import: object::Result<object::Import<'_>>| match import.expect("an import").name() {
        NameOrOrdinal::Name(name) => Some(String::from_utf8_lossy(name).into_owned()),
        NameOrOrdinal::Ordinal(_) => None,
    };
    let names: Vec<String> = imports.filter_map(name).collect();
    assert!(names.iter().any(|name| name == "malloc"), "imports are seen: {names:?}");
    let is_asked = |name: &&String| ELEMENTARY.contains(&name.as_str()) && !UNUSED.contains(&name.as_str());
    let asked: Vec<&String> = names.iter().filter(is_asked).collect();
    assert!(asked.is_empty(), "{asked:?}");
}

#[test]
fn the_same_bytes_with_the_functions_that_an_older_processor_gets() {
    agree(&[SHORT, LONG].concat(), || {
        let mut command = Command::new(PROGRAM);
        command.env("GLIBC_TUNABLES", OLDER);
        command
    });
}

/// Runs the commands on an emulated processor that has neither fused multiplication nor AVX.
fn agree_with_emulated(commands: &[&[&str]]) {
    const EMULATOR: &str = "qemu-x86_64";
    if Command::new(EMULATOR).arg("--version").output().is_err() {
        println!("skipped: {EMULATOR} is not installed (Debian's package qemu-user)");
        return;
    }
    agree(commands, || {
        let mut command = Command::new(EMULATOR);
        command.args(["-cpu", "Nehalem", PROGRAM]);
        command
    });
}

#[test]
fn the_same_bytes_on_an_emulated_processor() {
    agree_with_emulated(&SHORT);
}

#[test]
#[ignore = "an emulated diagnosis takes minutes"]
fn the_same_search_and_diagnosis_on_an_emulated_processor() {
    agree_with_emulated(&LONG);
}
