//! What an answer depends on: the study and the files behind it, by their content.

use crate::log::log_files;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io;
use std::path::Path;

/// Files with the SHA-256 of their content; `None`: it cannot be read.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Inputs(BTreeMap<String, Option<String>>);

impl Inputs {
    /// The study, and whatever it names that is a file: logs, folders of logs, descriptions.
    ///
    /// A study that is no TOML names nothing.
    pub fn named_by(study: &Path) -> Self {
        let folder = study.parent().unwrap_or(Path::new(""));
        let text = fs::read_to_string(study).unwrap_or_default();
        let mut files = vec![study.to_path_buf()];
        if let Ok(table) = toml::from_str::<toml::Table>(&text) {
            let mut texts = Vec::new();
            texts_of(&toml::Value::Table(table), &mut texts);
            let named = texts.iter().filter(|text| !text.is_empty()).map(|text| folder.join(text));
            for path in named.filter(|path| path.exists()) {
                files.extend(log_files(&path).unwrap_or_default());
            }
        }
        Self(files.into_iter().map(|file| (file.display().to_string(), hash(&file))).collect())
    }

    /// These, and those that a document says were read.
    pub fn with_read(&self, document: &serde_json::Value) -> Self {
        let mut all = self.0.clone();
        for input in document["inputs"].as_array().into_iter().flatten() {
            if let (Some(file), Some(hash)) = (input["file"].as_str(), input["sha256"].as_str()) {
                // What was there before is older than what was read, and the study may have changed in between.
                all.entry(file.to_owned()).or_insert_with(|| Some(hash.to_owned()));
            }
        }
        Self(all)
    }

    /// Whether all of them are as they were, and nothing has come.
    pub fn hold(&self, now: &Self) -> bool {
        let is_as_it_was = |(file, before): (&String, &Option<String>)| match now.0.get(file) {
            Some(now) => now == before,
            None => hash(Path::new(file)) == *before,
        };
        self.0.iter().all(is_as_it_was) && now.0.keys().all(|file| self.0.contains_key(file))
    }

    /// Everything in one number.
    pub fn digest(&self) -> String {
        let mut all = Sha256::new();
        for (file, content) in &self.0 {
            all.update(format!("{file}\0{}\n", content.as_deref().unwrap_or("none")));
        }
        hex(all)
    }
}

fn texts_of(value: &toml::Value, texts: &mut Vec<String>) {
    match value {
        toml::Value::String(text) => texts.push(text.clone()),
        toml::Value::Array(values) => values.iter().for_each(|value| texts_of(value, texts)),
        toml::Value::Table(table) => table.values().for_each(|value| texts_of(value, texts)),
        _ => {}
    }
}

fn hash(file: &Path) -> Option<String> {
    let mut hash = Sha256::new();
    io::copy(&mut File::open(file).ok()?, &mut hash).ok()?;
    Some(hex(hash))
}

fn hex(hash: Sha256) -> String {
    hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}
