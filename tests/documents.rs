//! Every command that README and docs show runs as shown and prints what is shown.
//!
//! `AIBO_FIT_REWRITE=1 cargo test --release --test documents` writes what the commands print now into the documents; with
//! `-- --include-ignored` also for those that take longer. A diff reviews it. How blocks are marked: `support/console.rs`.

mod support;

use std::path::{Path, PathBuf};
use support::console::{self, Kind};
use support::{everything_in, root};

/// README and all pages of the docs, by their paths in the repository.
fn documents() -> Vec<PathBuf> {
    let docs = everything_in(&root().join("docs"));
    let pages = docs.into_iter().filter(|path| path.extension().is_some_and(|ending| ending == "md"));
    std::iter::once(root().join("README.md")).chain(pages).collect()
}

/// Runs the blocks of some documents; answers with how many commands were run.
fn run(documents: &[PathBuf], slow: bool) -> usize {
    let rewrites = std::env::var_os("AIBO_FIT_REWRITE").is_some();
    let (mut wrong, mut ran) = (Vec::new(), 0);
    for path in documents {
        let text = std::fs::read_to_string(path).expect("a document can be read");
        let name = path.strip_prefix(root()).unwrap_or(path).display().to_string();
        let outcome = console::run(root(), &name, &text, slow);
        if rewrites && outcome.text != text {
            std::fs::write(path, &outcome.text).expect("a document can be written");
        }
        wrong.extend(outcome.wrong);
        ran += outcome.ran;
    }
    assert!(wrong.is_empty(), "{}\n\nAIBO_FIT_REWRITE=1 writes the documents anew", wrong.join("\n\n"));
    ran
}

fn is_slow(path: &Path) -> bool {
    let text = std::fs::read_to_string(path).expect("a document can be read");
    console::blocks(&path.display().to_string(), &text).iter().any(|block| block.kind == Kind::Slow)
}

#[test]
fn commands_of_the_readme_print_what_it_shows() {
    let ran = run(&documents()[..1], false);
    assert!(ran >= 4, "of the commands of the README {ran} were run: four need no shared data");
}

#[test]
fn commands_of_the_docs_print_what_they_show() {
    let ran = run(&documents()[1..], false);
    assert!(ran >= 20, "{ran} commands of the docs were run");
}

#[test]
#[ignore = "slow: diagnoses of minutes; cargo test --release --test documents -- --ignored"]
fn slow_commands_of_the_documents_print_what_they_show() {
    let slow: Vec<PathBuf> = documents().into_iter().filter(|path| is_slow(path)).collect();
    run(&slow, true);
}
