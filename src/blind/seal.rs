//! The seal: the answers as one text, and its hash.

use crate::log::sha256;
use serde::Serialize;

/// Name of the file with the answers, once they are open.
pub const TRUTHS_FILE: &str = "truths.json";

/// Sealed answers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sealed {
    /// The answers as JSON without spaces, keys in a fixed order, one line.
    pub text: String,
    /// SHA-256 of that text, in hexadecimal digits.
    pub sha256: String,
}

impl Sealed {
    /// Seals answers.
    ///
    /// # Errors
    /// Where an answer cannot be written as JSON.
    pub fn new(truths: &[impl Serialize]) -> Result<Self, serde_json::Error> {
        let text = serde_json::to_string(truths)? + "\n";
        let sha256 = sha256(text.as_bytes());
        Ok(Self { text, sha256 })
    }

    /// The line for a file that `sha256sum --check` reads.
    pub fn line(&self) -> String {
        format!("{}  {TRUTHS_FILE}\n", self.sha256)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seal_is_what_the_usual_tools_say() {
        let sealed = Sealed::new(&[(); 0]).unwrap();
        assert_eq!(sealed.text, "[]\n");
        // echo '[]' | sha256sum
        assert_eq!(sealed.line(), "37517e5f3dc66819f61f5a7bb8ace1921282415f10551d2defa5c3eb0985b570  truths.json\n");
    }
}
