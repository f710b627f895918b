//! PCD, the point clouds of the Point Cloud Library, versions 0.5 to 0.7: text, binary and
//! compressed binary, little endian.
//!
//! The size of the data must fit the header: a text has a line per point, and nothing follows the
//! last point, except zeros up to a page. PCL leaves them behind binary data. A field with `COUNT 0`
//! has no data. Bytes are read as `f32`, `f64` or integers as the header states.
//!
//! Source: The PCD (Point Cloud Data) file format, documentation of PCL; LibLZF by Marc Lehmann.

use crate::error::Fault;
use crate::number::{Order, Type};
use crate::points::{Column, PointList};
use crate::text;

/// Returns whether a text starts like a PCD.
pub(crate) fn is_start(text: &str) -> bool {
    let first = text::first_line(text);
    let comment = first.trim_start_matches(['#', ' ']).to_ascii_lowercase();
    (first.starts_with('#') && (comment.starts_with(".pcd") || comment.starts_with("pcd")))
        || ["VERSION ", "FIELDS "].iter().any(|word| first.starts_with(word))
}

/// A field of a point.
struct Field {
    /// The name in lower case; `_` for bytes without a meaning.
    name: String,
    /// The type, if it is known.
    of: Option<Type>,
    /// Number of bytes of a number.
    size: u64,
    /// Number of numbers.
    count: u64,
}

#[derive(Clone, Copy, PartialEq)]
enum Data {
    Text,
    Binary,
    Compressed,
}

/// Reads a PCD.
pub(crate) fn read(bytes: &[u8], list: &mut PointList) -> Result<(), Fault> {
    let bytes = text::without_mark(bytes);
    let bytes = &bytes[..];
    let header = Header::read(bytes)?;
    let rest = &bytes[header.length..];
    for name in &header.empty {
        list.skip(header.fields_line, name);
    }
    for (k, field) in header.fields.iter().enumerate() {
        let is_read = header.axes.contains(&k) || header.radius == Some(k);
        if !is_read && field.name != "_" {
            list.skip(header.fields_line, &field.name);
        }
    }
    if let Some((line, pose)) = &header.viewpoint {
        list.note(*line, &format!("VIEWPOINT {pose}"));
    }
    match header.data {
        Data::Text => header.text(rest, list),
        Data::Binary => {
            let size = header.size().map_or(u64::MAX, |(_, all)| all);
            header.binary(header.without_padding(rest, size, list), false, list)
        }
        Data::Compressed => {
            let bytes = header.uncompressed(rest, list)?;
            header.binary(&bytes, true, list)
        }
    }
}

const AXES: [&str; 3] = ["x", "y", "z"];
const RADIUS: &str = "radius";

/// Largest number of zeros behind the data: a page of any system.
const PAGE_MAX: usize = 1 << 16;

/// Smallest page.
const PAGE: usize = 1 << 12;

struct Header {
    /// The fields that have data, and the names of the others.
    fields: Vec<Field>,
    empty: Vec<String>,
    fields_line: usize,
    /// The line and the numbers of a pose of the sensor other than the identity.
    viewpoint: Option<(usize, String)>,
    points: u64,
    data: Data,
    /// Number of lines, and of bytes.
    lines: usize,
    length: usize,
    /// The fields of x, y and z, and of a radius.
    axes: [usize; 3],
    radius: Option<usize>,
}

/// The lines of a header: the line number, and the words behind the first.
#[derive(Default)]
struct Entries<'a> {
    fields: Option<(usize, Vec<&'a str>)>,
    size: Option<(usize, Vec<&'a str>)>,
    of: Option<(usize, Vec<&'a str>)>,
    count: Option<(usize, Vec<&'a str>)>,
    width: Option<(usize, Vec<&'a str>)>,
    height: Option<(usize, Vec<&'a str>)>,
    viewpoint: Option<(usize, Vec<&'a str>)>,
    points: Option<(usize, Vec<&'a str>)>,
    version: Option<(usize, Vec<&'a str>)>,
}

impl Header {
    fn read(bytes: &[u8]) -> Result<Self, Fault> {
        let (mut length, mut lines) = (0, 0);
        let mut texts = Vec::new();
        // Comments may have bytes of any encoding.
        loop {
            let rest = &bytes[length..];
            let Some(end) = rest.iter().position(|&byte| byte == b'\n') else {
                return Err(Fault::malformed(lines, "header is cut (expected a line DATA)"));
            };
            let text = String::from_utf8_lossy(&rest[..end]);
            length += end + 1;
            lines += 1;
            let is_last = text.split_whitespace().next() == Some("DATA");
            if !text.trim().is_empty() && !text.trim_start().starts_with('#') {
                texts.push((lines, text));
            }
            if is_last {
                break;
            }
        }
        let mut entries = Entries::default();
        let mut data = Data::Text;
        for (line, text) in &texts {
            let (line, mut words) = (*line, text.split_whitespace());
            let word = words.next().unwrap_or_default();
            let words: Vec<&str> = words.collect();
            let entry = match word {
                "VERSION" => &mut entries.version,
                "FIELDS" | "COLUMNS" => &mut entries.fields,
                "SIZE" => &mut entries.size,
                "TYPE" => &mut entries.of,
                "COUNT" => &mut entries.count,
                "WIDTH" => &mut entries.width,
                "HEIGHT" => &mut entries.height,
                "VIEWPOINT" => &mut entries.viewpoint,
                "POINTS" => &mut entries.points,
                "DATA" => {
                    data = match words[..] {
                        ["ascii"] => Data::Text,
                        ["binary"] => Data::Binary,
                        ["binary_compressed"] => Data::Compressed,
                        _ => {
                            let why = "(expected ascii, binary or binary_compressed)";
                            let word = text::quoted(&words.join(" "));
                            return Err(Fault::malformed(line, format!("unknown format of data: {word} {why}")));
                        }
                    };
                    continue;
                }
                _ => return Err(Fault::malformed(line, format!("unknown word: {}", text::quoted(word)))),
            };
            if entry.replace((line, words)).is_some() {
                return Err(Fault::malformed(
                    line,
                    format!("line is there twice: {}", text::quoted(word)),
                ));
            }
        }
        entries.header(data, lines, length)
    }

    /// Reads the rows of a text.
    fn text(&self, rest: &[u8], list: &mut PointList) -> Result<(), Fault> {
        if self.size().is_none() {
            let why = format!("header states more data than a file has: {} points", self.points);
            return Err(Fault::malformed(None, why));
        }
        let text = text::decode(rest);
        let lines = text::lines(&text).map(|(k, line)| (self.lines + k, line));
        let mut lines = lines.filter(|(_, line)| !line.trim().is_empty());
        // The first word of each field.
        let words = |fields: &[Field]| fields.iter().map(|field| field.count).sum::<u64>();
        let words_per_row = words(&self.fields);
        let wanted = self.axes.iter().copied().chain(self.radius).enumerate();
        let wanted: Vec<(u64, usize)> = wanted.map(|(k, field)| (words(&self.fields[..field]), k)).collect();
        list.begin(false, self.radius.is_some(), 0);
        let mut last = self.lines;
        for row in 0..self.points {
            let Some((line, text)) = lines.next() else {
                let why = format!("point {row} is missing at the end of the file");
                return Err(Fault::malformed(last, why));
            };
            last = line;
            let malformed = |why: String| Fault::malformed(line, format!("point {row} {why}"));
            let (mut numbers, mut count) = ([0.0; 4], 0);
            for word in text.split_whitespace() {
                for (_, k) in wanted.iter().filter(|(start, _)| *start == count) {
                    let number = text::measured(word);
                    numbers[*k] =
                        number.ok_or_else(|| malformed(format!("has an invalid number: {}", text::quoted(word))))?;
                }
                count += 1;
            }
            if count != words_per_row {
                return Err(malformed(format!("has {count} numbers (expected {words_per_row})")));
            }
            let [x, y, z, radius] = numbers;
            list.push([x, y, z], self.radius.map(|_| radius), Some(line))?;
        }
        match lines.next() {
            Some((line, text)) => {
                let text = text::quoted(text.trim());
                Err(Fault::malformed(line, format!("line follows the last point: {text}")))
            }
            None => Ok(()),
        }
    }

    /// Returns the number of bytes of a point, and of all.
    fn size(&self) -> Option<(u64, u64)> {
        let sizes = self.fields.iter().map(|field| field.size.checked_mul(field.count));
        let point = sizes.reduce(|sum, size| sum?.checked_add(size?))??;
        Some((point, point.checked_mul(self.points)?))
    }

    /// Reads binary data: point by point, or field by field.
    fn binary(&self, bytes: &[u8], is_by_field: bool, list: &mut PointList) -> Result<(), Fault> {
        let Some((point, _)) = self.size().filter(|(_, all)| *all == bytes.len() as u64) else {
            let why = match self.size() {
                Some((point, all)) => format!("expected {all}: {} points of {point} bytes", self.points),
                None => format!("expected {} points", self.points),
            };
            let why = format!(
                "{} bytes follow the header of {} bytes ({why})",
                bytes.len(),
                self.length
            );
            return Err(Fault::malformed(None, why));
        };
        let column = |field: usize| {
            let before: u64 = self.fields[..field].iter().map(|field| field.size * field.count).sum();
            let field = &self.fields[field];
            let of = field.of.ok_or_else(|| {
                let what = format!("the type of the field {}", field.name);
                Fault::unsupported(self.fields_line, what)
            })?;
            if is_by_field && of.is_integer() {
                let what = format!("compressed integers as the field {}", field.name);
                return Err(Fault::unsupported(self.fields_line, what));
            }
            // Within the bytes, because the size of all points is.
            let (start, stride) = if is_by_field {
                (before * self.points, field.size * field.count)
            } else {
                (before, point)
            };
            Ok(Column {
                of,
                order: Order::Little,
                start: start as usize,
                stride: stride as usize,
            })
        };
        let [x, y, z] = self.axes;
        let axes = [column(x)?, column(y)?, column(z)?];
        let radius = self.radius.map(column).transpose()?;
        list.read(bytes, self.points as usize, axes, radius, |k| k)
    }

    /// Returns binary data of a size without zeros behind it that end a page of the file, or a page
    /// with the header: PCL writes into a map of the file.
    fn without_padding<'a>(&self, rest: &'a [u8], size: u64, list: &mut PointList) -> &'a [u8] {
        let behind = usize::try_from(size).ok().and_then(|size| rest.split_at_checked(size));
        let Some((data, zeros)) = behind.filter(|(_, zeros)| zeros.len() < PAGE_MAX && zeros.iter().all(|b| *b == 0))
        else {
            return rest;
        };
        let ends_page = |length: usize| length.is_multiple_of(PAGE);
        let is_stated = self.data == Data::Compressed;
        if zeros.is_empty()
            || !(is_stated || ends_page(self.length + rest.len()) || ends_page(self.length + zeros.len()))
        {
            return rest;
        }
        list.note(None, "zeros behind the data");
        data
    }

    /// Returns the bytes that were compressed by LZF.
    fn uncompressed(&self, rest: &[u8], list: &mut PointList) -> Result<Vec<u8>, Fault> {
        let malformed = |why: String| Fault::malformed(None, why);
        let (Some((sizes, data)), Some((_, all))) = (rest.split_first_chunk::<8>(), self.size()) else {
            return Err(malformed("compressed data is cut (expected its two sizes)".into()));
        };
        let [a, b, c, d, e, f, g, h] = *sizes;
        let (packed, size) = (u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, h]));
        let data = self.without_padding(data, u64::from(packed), list);
        if u64::from(packed) != data.len() as u64 {
            let why = format!("{} bytes of compressed data (expected {packed})", data.len());
            return Err(malformed(why));
        }
        if u64::from(size) != all {
            let why = format!(
                "compressed data states {size} bytes (expected {all}: {} points)",
                self.points
            );
            return Err(malformed(why));
        }
        lzf(data, size as usize).map_err(|at| {
            let at = self.length + 8 + at;
            malformed(format!("compressed data is invalid at byte {at}"))
        })
    }
}

/// Longest output of LZF for each byte of its input: three bytes repeat up to 264.
const MOST: usize = 88;

/// Returns data of a size that LZF has compressed, or the byte at which it is invalid.
///
/// A byte below 32 precedes one more literal bytes than it says. Any other byte has a length in its
/// upper three bits, of which 7 adds the next byte, and the upper bits of a distance in its lower
/// five; a byte with the lower bits of the distance follows. Two bytes more than the length repeat,
/// from one more than the distance back.
fn lzf(data: &[u8], size: usize) -> Result<Vec<u8>, usize> {
    if size / MOST > data.len() {
        return Err(data.len());
    }
    let mut out = Vec::with_capacity(size);
    let mut at = 0;
    while let Some(&control) = data.get(at) {
        let start = at;
        at += 1;
        let control = usize::from(control);
        if control < 32 {
            let literal = data.get(at..at + control + 1).ok_or(start)?;
            at += literal.len();
            out.extend_from_slice(literal);
        } else {
            let mut next = || {
                let byte = data.get(at).copied().map(usize::from).ok_or(start);
                at += 1;
                byte
            };
            let length = (control >> 5) + 2 + if control >> 5 == 7 { next()? } else { 0 };
            let distance = ((control & 31) << 8) + next()? + 1;
            let from = out.len().checked_sub(distance).ok_or(start)?;
            if out.len() + length > size {
                return Err(start);
            }
            // The bytes may repeat themselves.
            for k in from..from + length {
                out.push(out[k]);
            }
        }
        if out.len() > size {
            return Err(start);
        }
    }
    if out.len() == size { Ok(out) } else { Err(data.len()) }
}

impl Entries<'_> {
    fn header(self, data: Data, lines: usize, length: usize) -> Result<Header, Fault> {
        let Some((fields_line, names)) = self.fields else {
            return Err(Fault::malformed(lines, "header has no line FIELDS"));
        };
        for (entry, what) in [(&self.size, "SIZE"), (&self.of, "TYPE"), (&self.count, "COUNT")] {
            if let Some((line, words)) = entry
                && words.len() != names.len()
            {
                let why = format!(
                    "{what} has {} entries (expected {}, one per field)",
                    words.len(),
                    names.len()
                );
                return Err(Fault::malformed(*line, why));
            }
        }
        let (sizes, types, counts) = (self.size, self.of, self.count);
        if data != Data::Text && (sizes.is_none() || types.is_none()) {
            return Err(Fault::malformed(lines, "header has no lines SIZE and TYPE"));
        }
        let number = |entry: &Option<(usize, Vec<&str>)>, k: usize, least: u64| {
            let Some((line, words)) = entry else { return Ok(1) };
            let number = words[k].parse().ok().filter(|number| *number >= least);
            let why = || format!("invalid number: {} (expected {least} or more)", text::quoted(words[k]));
            number.ok_or_else(|| Fault::malformed(*line, why()))
        };
        let (mut fields, mut empty) = (Vec::new(), Vec::new());
        for (k, name) in names.iter().enumerate() {
            let (size, count) = (number(&sizes, k, 1)?, number(&counts, k, 0)?);
            if count == 0 {
                empty.push((*name).to_owned());
                continue;
            }
            let of = match &types {
                Some((line, words)) => match words[k] {
                    "F" | "I" | "U" => Type::of(words[k].as_bytes()[0].to_ascii_lowercase(), size),
                    word => {
                        let why = format!("unknown type: {} (expected F, I or U)", text::quoted(word));
                        return Err(Fault::malformed(*line, why));
                    }
                },
                None => None,
            };
            let name = name.to_ascii_lowercase();
            fields.push(Field { name, of, size, count });
        }
        let mut axes = [0; 3];
        for (axis, name) in axes.iter_mut().zip(AXES) {
            let mut found = (0..fields.len()).filter(|&k| fields[k].name == name);
            *axis = match (found.next(), found.next()) {
                (Some(k), None) if fields[k].count == 1 => k,
                _ => {
                    let why = format!("invalid field {name} (expected one number, once)");
                    return Err(Fault::malformed(fields_line, why));
                }
            };
        }
        let mut found = (0..fields.len()).filter(|&k| fields[k].name == RADIUS);
        let radius = found.next().filter(|&k| fields[k].count == 1);
        if found.next().is_some() {
            return Err(Fault::malformed(fields_line, "field is there twice: \"radius\""));
        }
        let single = |entry: Option<(usize, Vec<&str>)>| {
            let Some((line, words)) = entry else { return Ok(None) };
            let number = match words[..] {
                [word] => word.parse::<u64>().ok(),
                _ => None,
            };
            let why = "invalid size (expected a whole number from 0)";
            number
                .map(|number| Some((line, number)))
                .ok_or_else(|| Fault::malformed(line, why))
        };
        let (width, height) = (single(self.width)?, single(self.height)?);
        let points = match (width, height.map_or(1, |(_, height)| height), single(self.points)?) {
            (None, 1, Some((_, points))) => points,
            (Some((_, width)), height, points) => {
                let (line, points) = points.unwrap_or((lines, width.saturating_mul(height)));
                if width.checked_mul(height) != Some(points) {
                    let why = format!("invalid number of points: {points} (expected {width} x {height})");
                    return Err(Fault::malformed(line, why));
                }
                points
            }
            _ => return Err(Fault::malformed(lines, "header has no line WIDTH")),
        };
        let viewpoint = match self.viewpoint {
            None => None,
            Some((line, words)) => {
                let numbers: Vec<f64> = words.iter().filter_map(|word| text::number(word)).collect();
                if numbers.len() != 7 || words.len() != 7 {
                    let why = "invalid VIEWPOINT (expected seven numbers: a point and a quaternion)";
                    return Err(Fault::malformed(line, why));
                }
                let texts: Vec<String> = numbers.iter().map(|x| format!("{x:?}")).collect();
                (numbers != [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]).then(|| (line, texts.join(" ")))
            }
        };
        Ok(Header {
            fields,
            empty,
            fields_line,
            viewpoint,
            points,
            data,
            lines,
            length,
            axes,
            radius,
        })
    }
}
