//! The text of an XML file as its parser wants it, where tinyxml takes more than XML allows.
//!
//! Simulators read their files by tinyxml. What it takes and XML does not is replaced by blanks of
//! the same length, or declared at the root element, so that lines stay; each is noted:
//!
//! * `--` in a comment, or `-` at its end;
//! * an XML declaration that is not at the start of the file;
//! * text around the root element;
//! * a prefix that is not declared.

use std::collections::BTreeSet;
use std::ops::Range;

/// The namespace of a prefix that the file does not declare, before the prefix.
pub(crate) const UNDECLARED: &str = "undeclared:";

/// A text, and what in it is no XML.
pub(crate) struct XmlText {
    /// Without a byte order mark, which the parser skips, but counts in positions.
    pub(crate) text: String,
    /// Positions in the text, and what was replaced there.
    pub(crate) notes: Vec<(usize, String)>,
    /// The declarations that were inserted into the root element.
    inserted: Range<usize>,
}

impl XmlText {
    pub(crate) fn new(text: &str) -> Self {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut scan = Scan {
            bytes: text.as_bytes().to_vec(),
            notes: Vec::new(),
            used: BTreeSet::new(),
            declared: BTreeSet::new(),
            root: None,
        };
        scan.whole(text);
        let missing = scan.used.difference(&scan.declared);
        let declarations: String = missing
            .map(|prefix| format!(" xmlns:{prefix}=\"{UNDECLARED}{prefix}\""))
            .collect();
        let mut text = String::from_utf8_lossy(&scan.bytes).into_owned();
        let root = scan.root.unwrap_or_default();
        text.insert_str(root, &declarations);
        let behind = scan.notes.iter_mut().filter(|(at, _)| *at >= root);
        behind.for_each(|(at, _)| *at += declarations.len());
        Self {
            text,
            notes: scan.notes,
            inserted: root..root + declarations.len(),
        }
    }

    /// Returns the range in the file of a range in the text.
    pub(crate) fn in_file(&self, range: Range<usize>) -> Range<usize> {
        let moved = |at: usize| {
            if at < self.inserted.end {
                at
            } else {
                at - self.inserted.len()
            }
        };
        moved(range.start)..moved(range.end)
    }
}

struct Scan {
    bytes: Vec<u8>,
    notes: Vec<(usize, String)>,
    /// The prefixes that elements and attributes have, and those that the root element declares.
    used: BTreeSet<String>,
    declared: BTreeSet<String>,
    /// The position behind the name of the root element.
    root: Option<usize>,
}

impl Scan {
    /// Scans a text up to its end, or up to what the parser will refuse.
    fn whole(&mut self, text: &str) {
        let (mut at, mut depth) = (0, 0usize);
        while let Some(found) = text[at..].find('<') {
            let start = at + found;
            if depth == 0 {
                self.around_root(text, at..start);
            }
            let tag = &text[start..];
            let behind = |mark: &str, end: &str| {
                let length = tag.get(mark.len()..)?.find(end)?;
                Some(start + mark.len() + length + end.len())
            };
            let end = if tag.starts_with("<!--") {
                let end = behind("<!--", "-->");
                self.comment(text, start + 4..end.map_or(start + 4, |end| end - 3));
                end
            } else if tag.starts_with("<![CDATA[") {
                let end = behind("<![CDATA[", "]]>");
                if depth == 0 {
                    self.around_root(text, start..end.unwrap_or(start));
                }
                end
            } else if tag.starts_with("<?") {
                let end = behind("<?", "?>");
                let is_declaration = tag.starts_with("<?xml") && tag[5..].starts_with(char::is_whitespace);
                if is_declaration && start > 0 && self.root.is_none() {
                    self.blank(start..end.unwrap_or(start));
                    let what = "XML declaration behind other text (expected at the start of the file)";
                    self.notes.push((start, what.into()));
                }
                end
            } else if tag.starts_with("<!") {
                document_type(tag).map(|length| start + length)
            } else {
                let end = self.tag(tag, start, &mut depth);
                end.map(|length| start + length)
            };
            let Some(end) = end else {
                return;
            };
            at = end;
        }
        if depth == 0 && self.root.is_some() {
            self.around_root(text, at..text.len());
        }
    }

    /// Scans the tag of an element, and returns its length.
    fn tag(&mut self, tag: &str, start: usize, depth: &mut usize) -> Option<usize> {
        // The names are outside of the quotes.
        let (mut names, mut rest) = (Vec::new(), tag.get(1..)?);
        let length = loop {
            let at = rest.find(['"', '\'', '>'])?;
            let is_separator = |c: char| c.is_whitespace() || matches!(c, '=' | '/');
            names.extend(rest[..at].split(is_separator).filter(|name| !name.is_empty()));
            let (mark, behind) = (&rest[at..=at], &rest[at + 1..]);
            if mark == ">" {
                break tag.len() - behind.len();
            }
            rest = behind.split_once(mark)?.1;
        };
        if tag.starts_with("</") {
            *depth = depth.saturating_sub(1);
            return Some(length);
        }
        let is_root = self.root.is_none();
        if is_root && let Some(name) = names.first() {
            self.root = Some(start + tag.find(name)? + name.len());
        }
        let is_letter = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-' | '.');
        for name in names {
            match name.split_once(':') {
                Some(("xmlns", prefix)) if is_root => drop(self.declared.insert(prefix.into())),
                // The parser names what helps.
                None | Some(("" | "xml" | "xmlns" | "xacro", _)) => {}
                Some((prefix, _)) if self.used.contains(prefix) || !prefix.chars().all(is_letter) => {}
                Some((prefix, _)) => drop(self.used.insert(prefix.into())),
            }
        }
        if !tag[..length].ends_with("/>") {
            *depth += 1;
        }
        Some(length)
    }

    /// Notes text that is above or below the root element.
    fn around_root(&mut self, text: &str, range: Range<usize>) {
        let found = text[range.clone()].trim();
        if !found.is_empty() {
            let shown: String = found.chars().take(40).collect();
            let start = range.start + text[range.clone()].find(found).unwrap_or_default();
            self.notes.push((
                start,
                format!("text outside of the root element ({shown:?}) is not supported"),
            ));
            self.blank(range);
        }
    }

    fn comment(&mut self, text: &str, range: Range<usize>) {
        let inside = &text[range.clone()];
        if inside.contains("--") || inside.ends_with('-') {
            self.notes
                .push((range.start, "\"--\" in a comment (expected none)".into()));
            self.blank(range);
        }
    }

    /// Replaces all but the ends of lines.
    fn blank(&mut self, range: Range<usize>) {
        let bytes = self.bytes[range].iter_mut();
        bytes
            .filter(|byte| !matches!(byte, b'\n' | b'\r'))
            .for_each(|byte| *byte = b' ');
    }
}

/// Returns the length of a document type, which has declarations in brackets.
fn document_type(tag: &str) -> Option<usize> {
    let (mut quote, mut is_inside, mut behind) = (None, false, 0);
    for (k, byte) in tag.bytes().enumerate() {
        if k < behind {
            continue;
        }
        match (quote, byte) {
            (None, b'<') if tag[k..].starts_with("<!--") => behind = k + tag[k..].find("-->")?,
            (None, b'"' | b'\'') => quote = Some(byte),
            (Some(open), _) if open == byte => quote = None,
            (None, b'[') => is_inside = true,
            (None, b']') => is_inside = false,
            (None, b'>') if !is_inside => return Some(k + 1),
            _ => {}
        }
    }
    None
}
