//! What robot engines read and the XML standard refuses, made harmless without moving a line.
//!
//! Comments with `--` in them, an XML declaration behind a blank line or a comment, a document type that declares nothing,
//! an `&` of its own, and prefixes that nothing declares (`<drake:joint>`) stand in robot files that are in use.

use std::borrow::Cow;

/// Prefixes that may be declared for a file.
const MOST_PREFIXES: usize = 16;

/// The text with comments and the declaration blanked out, lone `&` escaped, and prefixes declared.
pub(super) fn tolerant(text: &str) -> Cow<'_, str> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let text = declaration_blanked(comments_blanked(Cow::Borrowed(text)));
    prefixes_declared(escaped(doctype_blanked(text)))
}

/// As many line breaks and blanks as a text has bytes.
fn blanks(of: &str) -> String {
    of.bytes().map(|byte| if byte == b'\n' { '\n' } else { ' ' }).collect()
}

fn comments_blanked(text: Cow<'_, str>) -> Cow<'_, str> {
    if !text.contains("<!--") {
        return text;
    }
    let (mut rest, mut out) = (text.as_ref(), String::with_capacity(text.len()));
    while let Some(open) = rest.find("<!") {
        let (before, from) = rest.split_at(open);
        out.push_str(before);
        // Nothing is a comment inside of CDATA; an end that is missing is the parser's to name.
        let (end, is_comment) = match () {
            () if from.starts_with("<!--") => (from[4..].find("-->").map(|at| at + 7), true),
            () if from.starts_with("<![CDATA[") => (from.find("]]>").map(|at| at + 3), false),
            () => (Some(2), false),
        };
        let Some(end) = end else {
            rest = from;
            break;
        };
        let (part, after) = from.split_at(end);
        if is_comment {
            out.push_str(&blanks(part))
        } else {
            out.push_str(part)
        }
        rest = after;
    }
    out.push_str(rest);
    Cow::Owned(out)
}

fn declaration_blanked(text: Cow<'_, str>) -> Cow<'_, str> {
    let start = text.len() - text.trim_start().len();
    let declared = text[start..].starts_with("<?xml ").then(|| text[start..].find("?>")).flatten();
    match declared {
        Some(length) => {
            let end = start + length + 2;
            Cow::Owned(format!("{}{}{}", &text[..start], blanks(&text[start..end]), &text[end..]))
        }
        None => text,
    }
}

/// A document type without declarations of its own says nothing; one with them is the parser's to refuse.
fn doctype_blanked(text: Cow<'_, str>) -> Cow<'_, str> {
    let start = text.len() - text.trim_start().len();
    let end = text[start..].starts_with("<!DOCTYPE").then(|| text[start..].find('>')).flatten();
    match end.map(|length| start + length + 1).filter(|end| !text[start..*end].contains('[')) {
        Some(end) => Cow::Owned(format!("{}{}{}", &text[..start], blanks(&text[start..end]), &text[end..])),
        None => text,
    }
}

/// An `&` that begins no reference becomes one to itself.
fn escaped(text: Cow<'_, str>) -> Cow<'_, str> {
    const KNOWN: &[&str] = &["amp", "lt", "gt", "quot", "apos"];
    if !text.contains('&') || text.contains("<![CDATA[") || text.contains("<!DOCTYPE") {
        return text;
    }
    let mut parts = text.split('&');
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let name = part.split_once(';').map_or("", |(name, _)| name);
        let is_reference = name.starts_with('#') || KNOWN.contains(&name);
        out.push_str(if is_reference { "&" } else { "&amp;" });
        out.push_str(part);
    }
    Cow::Owned(out)
}

fn prefixes_declared(mut text: Cow<'_, str>) -> Cow<'_, str> {
    for _ in 0..MOST_PREFIXES {
        let parsed = roxmltree::Document::parse(&text);
        let Err(roxmltree::Error::UnknownNamespace(prefix, _)) = parsed else { break };
        let Some(end) = root_tag_end(&text) else { break };
        text = Cow::Owned(format!("{} xmlns:{prefix}=\"undeclared:{prefix}\"{}", &text[..end], &text[end..]));
    }
    text
}

/// Where the name of the root element ends.
fn root_tag_end(text: &str) -> Option<usize> {
    let is_name = |at: &usize| text.as_bytes().get(at + 1).is_some_and(|byte| byte.is_ascii_alphabetic());
    let start = text.match_indices('<').map(|(at, _)| at).find(is_name)?;
    let length = text[start + 1..].find(|c: char| c.is_whitespace() || c == '>' || c == '/')?;
    Some(start + 1 + length)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_engines_read_becomes_xml_on_the_same_lines() {
        let text = "\n<!-- made -- by\n hand --->\n<?xml version=\"1.0\"?>\n<robot><drake:x/>\n<b t='1'><![CDATA[<!-- kept -->]]></b></robot>";
        let made = tolerant(text);
        let document = roxmltree::Document::parse(&made).unwrap();
        let b = document.descendants().find(|node| node.has_tag_name("b")).unwrap();
        assert_eq!(document.text_pos_at(b.range().start).row, 6);
        assert_eq!(b.text(), Some("<!-- kept -->"));
    }

    #[test]
    fn a_bare_document_type_and_a_lone_ampersand_do_no_harm() {
        let made = tolerant("<!DOCTYPE robot>\n<a t='b && c &lt; d'/>");
        let document = roxmltree::Document::parse(&made).unwrap();
        assert_eq!(document.root_element().attribute("t"), Some("b && c < d"));
    }

    #[test]
    fn a_comment_that_never_ends_stays_for_the_parser() {
        assert!(roxmltree::Document::parse(&tolerant("<a><!-- x")).is_err());
    }
}
