//! XML with the line of every element: its references, indices and numbers.
//!
//! Elements are known by their name in any namespace. An entity that the file declares is an error,
//! because its copies can make a small file large.

use std::borrow::Cow;
use std::collections::HashMap;

use roxmltree::{Document, Node, ParsingOptions};

use crate::error::Fault;
use crate::text;

/// An element of a file.
pub(crate) type Element<'a> = Node<'a, 'a>;

/// Most declarations of a prefix of names, and most quotes behind one tag. The time of the XML
/// parser grows with the cube of the first and the square of the second.
const PREFIXES: usize = 200;
const QUOTES: usize = 10_000;

/// Most letters of a value that an error shows.
const SHOWN: usize = 32;

/// Most letters of a message of the XML parser that an error shows.
const MESSAGE: usize = 80;

/// The text of a file with LF at the end of every line, as XML 1.0, section 2.11, wants it.
pub(crate) struct Text {
    text: String,
    /// White space in front of the document, which XML does not allow.
    start: usize,
}

impl Text {
    pub(crate) fn new(bytes: &[u8]) -> Self {
        let mut text = text::decode(bytes);
        if text.contains('\r') {
            text = text.replace("\r\n", "\n").replace('\r', "\n");
        }
        let text = without_comments(text);
        let start = text.len() - text.trim_start().len();
        Self { text, start }
    }

    /// Returns the elements of the text.
    pub(crate) fn parse(&self) -> Result<Document<'_>, Fault> {
        let text = &self.text[self.start..];
        let first_line = line_feeds(&self.text[..self.start]);
        if let Some(at) = text.find("<!ENTITY") {
            let line = first_line + line_feeds(&text[..at]) + 1;
            return Err(Fault::unsupported(line, "the declaration of an entity"));
        }
        let is_quote = |b: &u8| matches!(b, b'"' | b'\'');
        let has_many_quotes = |tag: &str| tag.bytes().filter(|b| is_quote(b)).count() > QUOTES;
        if text.matches("xmlns:").nth(PREFIXES).is_some() || text.split('<').any(has_many_quotes) {
            return Err(Fault::unsupported(None, "XML with that many prefixes or attributes"));
        }
        let options = ParsingOptions {
            allow_dtd: true,
            // A node has at least one byte of the file.
            nodes_limit: u32::try_from(text.len()).unwrap_or(u32::MAX).max(16),
            ..ParsingOptions::default()
        };
        Document::parse_with_options(text, options).map_err(|e| {
            let message: String = e.to_string().chars().take(MESSAGE).collect();
            Fault::malformed(first_line + e.pos().row as usize, format!("malformed XML: {message}"))
        })
    }
}

/// Blanks the comments but for their lines: writers put `--` into them, which XML does not allow.
fn without_comments(text: String) -> String {
    let mut bytes = text.clone().into_bytes();
    let mut at = 0;
    while let Some(found) = text[at..].find("<!") {
        let start = at + found;
        let tag = &text[start..];
        let behind = |mark: &str, end: &str| {
            let inside = tag.strip_prefix(mark)?;
            Some(start + mark.len() + inside.find(end)?)
        };
        if let Some(end) = behind("<!--", "-->") {
            let inside = bytes[start + 4..end].iter_mut();
            inside.filter(|byte| **byte != b'\n').for_each(|byte| *byte = b' ');
            at = end;
        } else {
            at = behind("<![CDATA[", "]]>").unwrap_or(start + 2);
        }
    }
    // Whole letters were replaced.
    String::from_utf8(bytes).unwrap_or(text)
}

fn line_feeds(text: &str) -> usize {
    text.bytes().filter(|&b| b == b'\n').count()
}

/// A file, and its elements by name and id.
pub(crate) struct Xml<'a> {
    pub(crate) document: &'a Document<'a>,
    /// The position behind each line feed.
    lines: Vec<usize>,
    /// Lines in front of the document.
    first_line: usize,
    /// The element of a name and an id; `None` if several have both.
    ids: HashMap<(&'a str, &'a str), Option<Element<'a>>>,
}

impl<'a> Xml<'a> {
    pub(crate) fn new(document: &'a Document<'a>, text: &Text) -> Self {
        let bytes = document.input_text().bytes().enumerate();
        let mut ids = HashMap::new();
        for node in document.descendants() {
            if let Some(id) = node.attribute("id") {
                let several = |known: &mut Option<_>| *known = None;
                ids.entry((name(node), id)).and_modify(several).or_insert(Some(node));
            }
        }
        Self {
            document,
            lines: bytes.filter(|(_, b)| *b == b'\n').map(|(k, _)| k + 1).collect(),
            first_line: line_feeds(&text.text[..text.start]),
            ids,
        }
    }

    /// Returns the line of an element.
    pub(crate) fn line(&self, node: Element) -> usize {
        self.line_at(node.range().start)
    }

    fn line_at(&self, position: usize) -> usize {
        self.first_line + self.lines.partition_point(|&start| start <= position) + 1
    }

    /// Returns the error of an element that does not have the format.
    pub(crate) fn malformed(&self, node: Element, why: impl AsRef<str>) -> Fault {
        Fault::malformed(self.line(node), format!("{} {}", name(node), why.as_ref()))
    }

    /// Returns the error of an element that is geometry, but not read.
    pub(crate) fn unsupported(&self, node: Element, what: impl Into<String>) -> Fault {
        Fault::unsupported(self.line(node), what)
    }

    /// Returns the error of an element that its parent does not have in any version.
    pub(crate) fn unknown(&self, node: Element) -> Fault {
        let parent = node.parent_element().map_or("", |parent| name(parent));
        self.unsupported(node, format!("the element {} of {parent}", shown(name(node))))
    }

    /// Returns the element that an attribute refers to, of one of the given names.
    pub(crate) fn named(&self, node: Element<'a>, attribute: &str, names: &[&str]) -> Result<Element<'a>, Fault> {
        let Some(reference) = node.attribute(attribute) else {
            return Err(self.malformed(node, format!("has no attribute {attribute}")));
        };
        let reference = reference.trim();
        let id = reference.strip_prefix('#').unwrap_or(reference);
        let mut found = names.iter().filter_map(|&name| self.ids.get(&(name, id)));
        match (found.next(), found.next()) {
            (Some(Some(found)), None) => Ok(*found),
            (Some(_), _) => Err(self.malformed(node, format!("several elements have the id {}", shown(id)))),
            (None, _) if reference.starts_with('#') => {
                let kind = names.join(" or ");
                Err(self.malformed(node, format!("no element {kind} has the id {}", shown(id))))
            }
            (None, _) => Err(self.unsupported(node, format!("a reference to another file: {}", shown(reference)))),
        }
    }

    /// Returns an attribute that is a number of things; `None` if the element does not have it.
    pub(crate) fn count(&self, node: Element, attribute: &str) -> Result<Option<usize>, Fault> {
        let Some(text) = node.attribute(attribute) else {
            return Ok(None);
        };
        let invalid = || {
            let value = shown(text);
            self.malformed(
                node,
                format!("has an invalid {attribute}: {value} (expected a whole number)"),
            )
        };
        text.trim().parse().map(Some).map_err(|_| invalid())
    }

    /// Returns an error if an attribute states another number than the given one.
    pub(crate) fn check_count(&self, node: Element, found: usize, what: &str) -> Result<(), Fault> {
        match self.count(node, "count")? {
            Some(stated) if stated != found => {
                let why = format!("has a wrong count of {what}: {stated} (expected {found}, as the file has)");
                Err(self.malformed(node, why))
            }
            _ => Ok(()),
        }
    }

    /// Returns the whole numbers of an element.
    pub(crate) fn indices(&self, node: Element) -> Result<Vec<usize>, Fault> {
        self.list(node, "index", |word| word.parse().ok())
    }

    /// Returns the numbers of an element, which may be infinite or no number.
    pub(crate) fn numbers(&self, node: Element) -> Result<Vec<f64>, Fault> {
        // Some C libraries write `-nan(ind)`, `1.#QNAN` and `1.#INF`.
        let is_nan = |word: &str| word.contains(".#") || word.to_ascii_lowercase().contains("nan(");
        let parse = |word: &str| word.parse().ok().or_else(|| is_nan(word).then_some(f64::NAN));
        self.list(node, "number", parse)
    }

    fn list<T>(&self, node: Element, what: &str, parse: impl Fn(&str) -> Option<T>) -> Result<Vec<T>, Fault> {
        if let Some(child) = elements(node).next() {
            return Err(self.unknown(child));
        }
        let text = text_of(node);
        let mut values = Vec::new();
        for word in text.split_ascii_whitespace() {
            let Some(value) = parse(word) else {
                let why = format!("{} has an invalid {what}: {}", name(node), shown(word));
                return Err(Fault::malformed(self.line_of_word(node, values.len()), why));
            };
            values.push(value);
        }
        Ok(values)
    }

    /// Returns the line of a word of the text of an element.
    pub(crate) fn line_of_word(&self, node: Element, index: usize) -> usize {
        let mut texts = node.children().filter(|child| child.is_text());
        let (Some(text), None) = (texts.next(), texts.next()) else {
            return self.line(node);
        };
        let range = text.range();
        let text = &self.document.input_text()[range.clone()];
        let word = text.split_ascii_whitespace().nth(index).unwrap_or(text);
        // The word is a part of the text.
        self.line_at(range.start + (word.as_ptr() as usize - text.as_ptr() as usize))
    }
}

/// Returns the name of an element, in any namespace.
pub(crate) fn name<'a>(node: Element<'a>) -> &'a str {
    node.tag_name().name()
}

/// Returns the elements directly below an element.
pub(crate) fn elements<'a>(node: Element<'a>) -> impl Iterator<Item = Element<'a>> {
    node.children().filter(Node::is_element)
}

/// Returns the elements of a name directly below an element.
pub(crate) fn children<'a>(node: Element<'a>, named: &'static str) -> impl Iterator<Item = Element<'a>> {
    elements(node).filter(move |&child| name(child) == named)
}

/// Returns the text of an element, whose comments end no word.
fn text_of<'a>(node: Element<'a>) -> Cow<'a, str> {
    let mut texts = node.children().filter(|child| child.is_text()).filter_map(|t| t.text());
    let first = texts.next().unwrap_or_default();
    match texts.next() {
        None => Cow::Borrowed(first),
        Some(second) => Cow::Owned([first, second].into_iter().chain(texts).collect()),
    }
}

/// Returns a value of a file in quotes, as long as an error may show it.
pub(crate) fn shown(text: &str) -> String {
    let mut letters = text.escape_debug();
    let start: String = letters.by_ref().take(SHOWN).collect();
    let rest = if letters.next().is_some() { ".." } else { "" };
    format!("\"{start}{rest}\"")
}
