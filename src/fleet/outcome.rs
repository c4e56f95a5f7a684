//! What comes of a study.

use serde_json::Value;

/// What came of a study.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// What `gap --json` says.
    Answer(Box<Value>),
    /// The program says why it has no answer; it would say so again.
    None(String),
    /// Whoever was to answer it has gone, in these words; another run tries again.
    Lost(String),
}

impl Outcome {
    /// Of the text of a document.
    pub fn of_text(text: &str) -> Self {
        match serde_json::from_str::<Value>(text) {
            Ok(document) if document["moved"] == false => {
                Self::None(document["sentence"].as_str().unwrap_or("nothing moves").to_owned())
            }
            Ok(document) if document["gap"].is_object() => Self::Answer(Box::new(document)),
            Ok(_) => Self::Lost("the worker left something that is no diagnosis".to_owned()),
            Err(error) => Self::Lost(format!("the worker left a damaged answer: {error}")),
        }
    }
}
