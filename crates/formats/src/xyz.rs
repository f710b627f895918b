//! Text with a point per line: `.xyz`, `.txt`, `.csv`, `.asc`, `.pts`.
//!
//! There is no standard. A line has at least three numbers, all lines equally many, between white
//! space, commas or semicolons. `#` and `//` start a comment. The first line may be the number of
//! points, or name the columns; a comment in front of the first point may name them, too. Without
//! names the first three columns are x, y and z.

use crate::error::Fault;
use crate::points::PointList;
use crate::text;

/// What is between two numbers.
#[derive(Clone, Copy, PartialEq)]
enum Separator {
    Blank,
    Comma,
    Semicolon,
}

impl Separator {
    fn of(line: &str) -> Self {
        if line.contains(';') {
            Self::Semicolon
        } else if line.contains(',') {
            Self::Comma
        } else {
            Self::Blank
        }
    }

    /// Calls a function for each word and its number.
    fn words<'a>(
        self,
        line: &'a str,
        mut each: impl FnMut(usize, &'a str) -> Result<(), Fault>,
    ) -> Result<usize, Fault> {
        let mut count = 0;
        let mut each = |word: &'a str| {
            count += 1;
            each(count - 1, word.trim())
        };
        match self {
            Self::Blank => line.split_whitespace().try_for_each(&mut each),
            Self::Comma => line.split(',').try_for_each(&mut each),
            Self::Semicolon => line.split(';').try_for_each(&mut each),
        }?;
        Ok(count)
    }

    /// Returns the words in lower case, without quotation marks.
    fn names(self, line: &str) -> Vec<String> {
        let mut names = Vec::new();
        let added = self.words(line, |_, word| {
            names.push(word.trim_matches('"').to_ascii_lowercase());
            Ok(())
        });
        debug_assert!(added.is_ok());
        names
    }
}

/// The columns of a file.
struct Layout {
    separator: Separator,
    count: usize,
    axes: [usize; 3],
    radius: Option<usize>,
}

/// Returns the columns of x, y and z, and of a radius, if names have each of x, y and z once.
fn columns(names: &[String]) -> Option<([usize; 3], Option<usize>)> {
    let once = |name: &str| {
        let mut found = (0..names.len()).filter(|&k| names[k] == name);
        found.next().filter(|_| found.next().is_none())
    };
    Some(([once("x")?, once("y")?, once("z")?], once("radius")))
}

/// Reads a text of points.
pub(crate) fn read(bytes: &[u8], list: &mut PointList) -> Result<(), Fault> {
    let text = text::decode(bytes);
    let lines = text::lines(&text).map(|(k, line)| (k, line.trim()));
    let (mut layout, mut comment, mut header) = (None, None, None);
    // The number of points that the first line states, and its line.
    let mut stated: Option<(usize, u64)> = None;
    let mut rows = 0;
    for (at, line) in lines.filter(|(_, line)| !line.is_empty()) {
        if let Some(text) = line.strip_prefix('#').or_else(|| line.strip_prefix("//")) {
            comment = Some((at, text.trim_start_matches(['#', '/'])));
            continue;
        }
        let layout = match &layout {
            Some(layout) => layout,
            None => {
                let separator = Separator::of(line);
                let names = separator.names(line);
                let is_first = stated.is_none() && header.is_none();
                if is_first
                    && let [count] = &names[..]
                    && let Ok(count) = count.parse()
                {
                    stated = Some((at, count));
                    continue;
                }
                let is_name =
                    |name: &String| text::measured(name).is_none() && !name.starts_with(|c: char| c.is_ascii_digit());
                if header.is_none() && names.iter().all(is_name) {
                    if columns(&names).is_none() {
                        let why = "line is neither numbers nor a header with x, y and z";
                        return Err(Fault::malformed(at, format!("{why}: {}", text::quoted(line))));
                    }
                    header = Some((at, names));
                    continue;
                }
                layout.insert(Layout::new(at, separator, names.len(), header.take(), comment, list)?)
            }
        };
        let malformed = |why: String| Fault::malformed(at, format!("point {rows} {why}"));
        if layout.separator == Separator::Comma && is_decimal_comma(line) {
            return Err(malformed(
                "has commas with and without a blank behind (expected decimal points)".into(),
            ));
        }
        let (mut point, mut radius) = ([0.0; 3], None);
        let count = layout.separator.words(line, |k, word| {
            let number = || {
                let number = text::measured(word);
                number.ok_or_else(|| malformed(format!("has an invalid number: {}", text::quoted(word))))
            };
            for (axis, x) in layout.axes.iter().zip(&mut point) {
                if *axis == k {
                    *x = number()?;
                }
            }
            if layout.radius == Some(k) {
                radius = Some(number()?);
            }
            Ok(())
        })?;
        if count != layout.count {
            return Err(malformed(format!(
                "has {count} numbers (expected {} as above)",
                layout.count
            )));
        }
        list.push(point, radius, Some(at))?;
        rows += 1;
    }
    match stated {
        Some((line, count)) if count != rows => {
            let why = format!("{rows} points follow (expected {count}, as the line states)");
            Err(Fault::malformed(line, why))
        }
        _ => Ok(()),
    }
}

/// Returns whether some commas of a line have a blank behind and others do not: `1,5, 2,5, 3,5`.
fn is_decimal_comma(line: &str) -> bool {
    let mut pieces = line.split(',').skip(1).map(|piece| piece.starts_with([' ', '\t']));
    pieces.next().is_some_and(|first| pieces.any(|next| next != first))
}

impl Layout {
    /// Returns the columns of the first line with a point.
    fn new(
        line: usize,
        separator: Separator,
        count: usize,
        header: Option<(usize, Vec<String>)>,
        comment: Option<(usize, &str)>,
        list: &mut PointList,
    ) -> Result<Self, Fault> {
        if count < 3 {
            let why = format!("line has {count} numbers (expected at least 3)");
            return Err(Fault::malformed(line, why));
        }
        if let Some((at, names)) = header.as_ref().filter(|(_, names)| names.len() != count) {
            let why = format!("header has {} names (expected {count}, one per column)", names.len());
            return Err(Fault::malformed(*at, why));
        }
        // A comment may be prose.
        let comment = comment.map(|(at, text)| (at, Separator::of(text).names(text)));
        let names = header.or(comment.filter(|(_, names)| names.len() == count));
        let named = names.and_then(|(at, names)| Some((at, columns(&names)?, names)));
        let (axes, radius) = match &named {
            Some((at, (axes, radius), names)) => {
                for (k, name) in names.iter().enumerate() {
                    if !axes.contains(&k) && *radius != Some(k) {
                        list.skip(*at, name);
                    }
                }
                (*axes, *radius)
            }
            None => {
                match count {
                    3 => {}
                    4 => list.note(line, "column 4"),
                    _ => list.note(line, &format!("columns 4 to {count}")),
                }
                ([0, 1, 2], None)
            }
        };
        list.begin(false, radius.is_some(), 0);
        Ok(Self {
            separator,
            count,
            axes,
            radius,
        })
    }
}
