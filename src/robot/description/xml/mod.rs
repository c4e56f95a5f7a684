//! XML as the readers of descriptions need it: elements that own their words and know their lines, so that the elements of
//! included files stand beside the others.
//!
//! `roxmltree` parses; document types are refused, so no entity can grow. What engines accept and the XML standard does not
//! is made harmless first, see [`tolerant`].

mod tolerant;
mod value;

use super::error::{At, DescriptionError};
use std::path::Path;
use std::sync::Arc;

/// Elements within elements beyond which a file is refused: every level takes stack in the readers.
const DEEPEST: usize = 400;
/// Elements and attributes beyond which a file is refused.
const LARGEST: u32 = 4_000_000;

/// An element with all that is in it.
#[derive(Clone, Debug)]
pub(super) struct Element {
    /// Its name without a prefix.
    pub tag: String,
    /// The namespace that it is in, where that is not the root's: such an element is somebody else's.
    pub foreign: Option<String>,
    /// In the file's order, those without a prefix.
    pub attributes: Vec<Attribute>,
    /// In the file's order, without texts and comments.
    pub children: Vec<Element>,
    /// Where it begins.
    pub at: At,
}

/// An attribute of an element.
#[derive(Clone, Debug)]
pub(super) struct Attribute {
    /// Its name.
    pub name: String,
    /// As it is written.
    pub value: String,
}

/// The root element of a text.
pub(super) fn parse(file: &Arc<Path>, text: &str) -> Result<Element, DescriptionError> {
    let text = tolerant::tolerant(text);
    let options = roxmltree::ParsingOptions { allow_dtd: false, nodes_limit: LARGEST, ..Default::default() };
    let document = roxmltree::Document::parse_with_options(&text, options).map_err(|error| DescriptionError::Xml {
        at: At { file: file.clone(), line: error.pos().row },
        what: error.to_string(),
    })?;
    let lines = Lines::of(&text);
    let at = |node: roxmltree::Node<'_, '_>| At { file: file.clone(), line: lines.of_byte(node.range().start) };
    if let Some(deep) = too_deep(&document) {
        return Err(DescriptionError::Xml {
            at: at(deep),
            what: format!("elements within elements, more than {DEEPEST} deep"),
        });
    }
    let root = document.root_element();
    Ok(owned(root, root.tag_name().namespace(), &at))
}

/// An element that has too many around it.
fn too_deep<'a, 'input>(document: &'a roxmltree::Document<'input>) -> Option<roxmltree::Node<'a, 'input>> {
    let mut open = vec![(document.root_element(), 1)];
    while let Some((node, depth)) = open.pop() {
        if depth > DEEPEST {
            return Some(node);
        }
        open.extend(node.children().filter(roxmltree::Node::is_element).map(|child| (child, depth + 1)));
    }
    None
}

fn owned(node: roxmltree::Node<'_, '_>, home: Option<&str>, at: &impl Fn(roxmltree::Node<'_, '_>) -> At) -> Element {
    let attribute = |of: roxmltree::Attribute<'_, '_>| Attribute { name: of.name().into(), value: of.value().into() };
    Element {
        tag: node.tag_name().name().into(),
        foreign: node.tag_name().namespace().filter(|of| Some(*of) != home).map(Into::into),
        attributes: node.attributes().filter(|of| of.namespace().is_none()).map(attribute).collect(),
        children: node.children().filter(roxmltree::Node::is_element).map(|child| owned(child, home, at)).collect(),
        at: at(node),
    }
}

/// Where the lines of a text begin.
struct Lines(Vec<usize>);

impl Lines {
    fn of(text: &str) -> Self {
        Self(std::iter::once(0).chain(text.match_indices('\n').map(|(at, _)| at + 1)).collect())
    }

    fn of_byte(&self, byte: usize) -> u32 {
        u32::try_from(self.0.partition_point(|start| *start <= byte)).unwrap_or(u32::MAX)
    }
}

impl Element {
    /// The children with a tag, none of somebody else's.
    pub fn all<'a>(&'a self, tag: &'a str) -> impl Iterator<Item = &'a Element> {
        self.children.iter().filter(move |child| child.tag == tag && child.foreign.is_none())
    }

    /// The first of them.
    pub fn first<'a>(&'a self, tag: &'a str) -> Option<&'a Element> {
        self.all(tag).next()
    }

    /// An attribute as it is written.
    pub fn text(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|attribute| attribute.name == name).map(|attribute| attribute.value.as_str())
    }

    /// The element as messages call it: `<joint name="elbow">`.
    pub fn label(&self) -> String {
        match self.text("name") {
            Some(name) => format!("<{} name=\"{}\">", self.tag, cut(name)),
            None => format!("<{}>", self.tag),
        }
    }

    /// That something about the element is not supported.
    pub fn unsupported(&self, feature: impl Into<String>, hint: impl Into<String>) -> DescriptionError {
        DescriptionError::Unsupported {
            at: self.at.clone(),
            element: self.label(),
            feature: feature.into(),
            hint: hint.into(),
        }
    }

    /// That the element cannot be so.
    pub fn wrong(&self, what: impl Into<String>) -> DescriptionError {
        DescriptionError::Wrong { at: self.at.clone(), element: self.label(), what: what.into() }
    }

    /// That an attribute cannot be so.
    pub fn bad(&self, attribute: &str, expected: impl Into<String>) -> DescriptionError {
        DescriptionError::Value {
            at: self.at.clone(),
            element: self.label(),
            attribute: attribute.to_owned(),
            found: self.text(attribute).map_or_else(|| "nothing".to_owned(), |text| format!("\"{}\"", cut(text))),
            expected: expected.into(),
        }
    }

    /// Warns of attributes that the format does not have here: most are misspelt.
    pub fn expect_attributes(&self, known: &[&str], warnings: &mut Vec<String>) {
        for attribute in self.attributes.iter().filter(|attribute| !known.contains(&attribute.name.as_str())) {
            warnings.push(self.say(format!("unknown attribute `{}`, ignored", attribute.name)));
        }
    }

    /// A sentence for a warning, with file, line and element before it.
    pub fn say(&self, what: impl std::fmt::Display) -> String {
        format!("{}: {}: {what}", self.at, self.label())
    }
}

/// A text that fits into a message.
fn cut(text: &str) -> String {
    const LONGEST: usize = 60;
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

/// A text as an attribute has it.
pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Element, DescriptionError> {
        parse(&Arc::from(Path::new("a.xml")), text)
    }

    #[test]
    fn elements_know_their_lines() {
        let root = read("<a>\n <b x='1'/>\n\n <c name='n'/></a>").unwrap();
        assert_eq!((root.children[0].at.line, root.children[1].at.line), (2, 4));
        assert_eq!(root.children[1].label(), "<c name=\"n\">");
        assert_eq!(root.children[1].say("odd"), "a.xml: line 4: <c name=\"n\">: odd");
    }

    #[test]
    fn an_attribute_without_quotes_is_named_by_its_line() {
        let error = read("<a>\n <b x=1/></a>").unwrap_err().to_string();
        assert!(error.starts_with("a.xml: line 2: not well-formed XML"), "{error}");
    }

    #[test]
    fn entities_and_depth_are_bounded() {
        let laughs = "<!DOCTYPE a [<!ENTITY l \"ha\"><!ENTITY m \"&l;&l;\">]><a x='&m;'/>";
        assert!(read(laughs).unwrap_err().to_string().contains("DTD"));
        let deep = "<a>".repeat(100_000) + &"</a>".repeat(100_000);
        assert!(read(&deep).unwrap_err().to_string().contains("more than 400 deep"));
    }
}
