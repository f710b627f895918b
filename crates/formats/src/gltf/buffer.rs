//! The bytes of a glTF: the chunks of a GLB, buffers, and accessors, which read numbers from them.

use std::borrow::Cow;
use std::collections::HashMap;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::json::Item;
use crate::error::Fault;
use crate::mesh::SkippedList;
use crate::text;

/// Returns the JSON of a GLB, and its binary chunk.
pub(super) fn chunks<'a>(bytes: &'a [u8], skipped: &mut SkippedList) -> Result<(&'a [u8], Option<&'a [u8]>), Fault> {
    let malformed = |why: String| Fault::malformed(None, why);
    let word = |at: usize| -> Option<u32> { Some(u32::from_le_bytes(*bytes.get(at..)?.first_chunk::<4>()?)) };
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return Err(malformed("the header of the GLB is cut (expected 12 bytes)".into()));
    };
    if version != 2 {
        return Err(Fault::unsupported(None, format!("version {version} of GLB")));
    }
    if length as usize != bytes.len() {
        let why = format!("the GLB states a length of {length} bytes, but has {}", bytes.len());
        return Err(malformed(why));
    }
    let (mut json, mut binary, mut at) = (None, None, 12);
    while at < bytes.len() {
        let chunk = word(at).zip(word(at + 4)).and_then(|(length, kind)| {
            let start = at + 8;
            let end = start.checked_add(length as usize)?;
            Some((kind, bytes.get(start..end)?, end))
        });
        let Some((kind, data, end)) = chunk else {
            return Err(malformed(format!("the chunk at byte {at} of the GLB is cut")));
        };
        match &kind.to_le_bytes() {
            b"JSON" if json.is_none() => json = Some(data),
            b"BIN\0" if json.is_some() && binary.is_none() => binary = Some(data),
            b"JSON" | b"BIN\0" => {
                let why = format!("the chunk at byte {at} of the GLB is misplaced (expected JSON, then BIN)");
                return Err(malformed(why));
            }
            _ => skipped.add(None, "unknown chunks"),
        }
        at = end;
    }
    let json = json.ok_or_else(|| malformed("the GLB has no chunk of JSON".into()))?;
    Ok((json, binary))
}

type Bytes<'a> = Rc<Cow<'a, [u8]>>;

/// The buffers of a file, each read once.
pub(super) struct Buffers<'a> {
    /// The whole file.
    pub(super) root: Item<'a>,
    folder: &'a Path,
    binary: Option<&'a [u8]>,
    known: HashMap<usize, Bytes<'a>>,
    files: HashMap<PathBuf, Bytes<'a>>,
    /// Number of bytes of other files.
    pub(super) external: usize,
}

impl<'a> Buffers<'a> {
    pub(super) fn new(root: &Item<'a>, folder: &'a Path, binary: Option<&'a [u8]>) -> Self {
        Self {
            root: root.clone(),
            folder,
            binary,
            known: HashMap::new(),
            files: HashMap::new(),
            external: 0,
        }
    }

    fn buffer(&mut self, index: usize) -> Result<(Bytes<'a>, usize), Fault> {
        let item = self.root.element("buffers", index)?;
        item.check_keys(&["uri", "byteLength"])?;
        let Some(length) = item.whole("byteLength")? else {
            return Err(item.malformed("has no byteLength"));
        };
        let bytes = match self.known.get(&index) {
            Some(known) => known.clone(),
            None => self.load(&item, index)?,
        };
        self.known.insert(index, bytes.clone());
        if length > bytes.len() {
            return Err(item.invalid("byteLength", format!("at most {}, its number of bytes", bytes.len())));
        }
        Ok((bytes, length))
    }

    fn load(&mut self, item: &Item, index: usize) -> Result<Bytes<'a>, Fault> {
        let Some(uri) = item.text("uri")? else {
            return match self.binary {
                Some(binary) if index == 0 => Ok(Rc::new(Cow::Borrowed(binary))),
                _ => Err(item.malformed("has no uri, and is not the chunk BIN of a GLB")),
            };
        };
        if let Some(data) = uri.strip_prefix("data:") {
            let bytes = data
                .split_once(',')
                .filter(|(kind, _)| kind.ends_with(";base64"))
                .and_then(|(_, data)| base64(data));
            return match bytes {
                Some(bytes) => Ok(Rc::new(Cow::Owned(bytes))),
                None => Err(item.invalid("uri", "data in base64")),
            };
        }
        let file = file_name(uri).ok_or_else(|| item.invalid("uri", "data: or a file in the folder of the glTF"))?;
        if let Some(known) = self.files.get(&file) {
            return Ok(known.clone());
        }
        let cannot = |why: &str| {
            let uri = text::quoted(uri);
            let why: String = why.chars().take(50).collect();
            item.malformed(format!("cannot be read from {uri}: {why}"))
        };
        let path = self.folder.join(&file);
        // A device or a pipe may never end.
        match std::fs::metadata(&path) {
            Ok(data) if data.is_file() => {}
            Ok(_) => return Err(cannot("not a file")),
            Err(error) => return Err(cannot(&error.to_string())),
        }
        let mut bytes = Vec::new();
        let read = std::fs::File::open(&path).and_then(|mut file| file.read_to_end(&mut bytes));
        read.map_err(|error| cannot(&error.to_string()))?;
        self.external = self.external.saturating_add(bytes.len());
        let bytes: Bytes = Rc::new(Cow::Owned(bytes));
        self.files.insert(file, bytes.clone());
        Ok(bytes)
    }

    /// Returns `count` elements of `size` bytes in a buffer view: the bytes, the first one, and the
    /// distance from element to element. They are inside the view and the buffer.
    fn span(&mut self, owner: &Item, size: usize, count: usize) -> Result<(Bytes<'a>, usize, usize), Fault> {
        let Some(index) = owner.whole("bufferView")? else {
            return Err(owner.malformed("has no bufferView"));
        };
        let view = self.root.element("bufferViews", index)?;
        view.check_keys(&["buffer", "byteOffset", "byteLength", "byteStride", "target"])?;
        for name in ["EXT_meshopt_compression", "KHR_meshopt_compression"] {
            if view.extension(name)?.is_some() {
                return Err(view.unsupported(name));
            }
        }
        let (Some(buffer), Some(length)) = (view.whole("buffer")?, view.whole("byteLength")?) else {
            return Err(view.malformed("has no buffer or no byteLength"));
        };
        let start = view.whole("byteOffset")?.unwrap_or(0);
        let (bytes, end) = self.buffer(buffer)?;
        if start.checked_add(length).is_none_or(|view_end| view_end > end) {
            return Err(view.invalid("byteLength", format!("an end within {end} bytes of the buffer")));
        }
        let stride = view.whole("byteStride")?.unwrap_or(size);
        if stride < size {
            return Err(view.invalid("byteStride", format!("at least {size}, the size of an element")));
        }
        let offset = owner.whole("byteOffset")?.unwrap_or(0);
        let needs = match count {
            0 => Some(0),
            _ => stride
                .checked_mul(count - 1)
                .and_then(|n| n.checked_add(size)?.checked_add(offset)),
        };
        if needs.is_none_or(|needs| needs > length) {
            let why = format!("needs more bytes than its view has: {count} elements (the view has {length} bytes)");
            return Err(owner.malformed(why));
        }
        Ok((bytes, start + offset, stride))
    }

    /// Returns an accessor, which the property `key` of `user` names.
    pub(super) fn accessor(&mut self, user: &Item, key: &str) -> Result<Option<Accessor<'a>>, Fault> {
        let Some(index) = user.whole(key)? else {
            return Ok(None);
        };
        let item = self.root.element("accessors", index)?;
        item.check_keys(&[
            "bufferView",
            "byteOffset",
            "componentType",
            "normalized",
            "count",
            "type",
            "max",
            "min",
            "sparse",
        ])?;
        let component = Component::new(&item)?;
        let width = match item.text("type")? {
            Some("SCALAR") => 1,
            Some("VEC2") => 2,
            Some("VEC3") => 3,
            Some("VEC4" | "MAT2") => 4,
            Some("MAT3") => 9,
            Some("MAT4") => 16,
            _ => return Err(item.invalid("type", "SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4")),
        };
        let count = item.whole("count")?.filter(|count| u32::try_from(*count).is_ok());
        let count = count.ok_or_else(|| item.invalid("count", "a number of 32 bits"))?;
        let size = width * component.size();
        let sparse = match item.object("sparse")? {
            Some(sparse) => Some(self.sparse(&sparse, size, count)?),
            None => None,
        };
        let data = match item.has("bufferView") || sparse.is_none() {
            true => Some(self.span(&item, size, count)?),
            false => None,
        };
        Ok(Some(Accessor {
            index,
            count,
            width,
            component,
            is_normalized: item.is("normalized")?,
            data,
            sparse,
            item,
        }))
    }

    fn sparse(&mut self, item: &Item<'a>, size: usize, all: usize) -> Result<Sparse<'a>, Fault> {
        item.check_keys(&["count", "indices", "values"])?;
        let count = item.whole("count")?.filter(|count| *count <= all);
        let count = count.ok_or_else(|| item.invalid("count", format!("0 to {all}")))?;
        let (Some(indices), Some(values)) = (item.object("indices")?, item.object("values")?) else {
            return Err(item.malformed("has no indices or no values"));
        };
        indices.check_keys(&["bufferView", "byteOffset", "componentType"])?;
        values.check_keys(&["bufferView", "byteOffset"])?;
        let component = Component::new(&indices)?;
        if !component.is_unsigned() {
            return Err(indices.invalid("componentType", "5121, 5123 or 5125"));
        }
        let (bytes, start, stride) = self.span(&indices, component.size(), count)?;
        let at = |k: usize| component.number(&bytes[start + stride * k..]) as usize;
        let numbers: Vec<usize> = (0..count).map(at).collect();
        if !numbers.is_sorted_by(|a, b| a < b) || numbers.last().is_some_and(|last| *last >= all) {
            let why = format!("has invalid numbers (expected increasing ones below {all})");
            return Err(indices.malformed(why));
        }
        Ok(Sparse {
            numbers,
            values: self.span(&values, size, count)?,
        })
    }
}

/// The type of a number.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn new(item: &Item) -> Result<Self, Fault> {
        Ok(match item.whole("componentType")? {
            Some(5120) => Self::I8,
            Some(5121) => Self::U8,
            Some(5122) => Self::I16,
            Some(5123) => Self::U16,
            Some(5125) => Self::U32,
            Some(5126) => Self::F32,
            _ => return Err(item.invalid("componentType", "5120 to 5123, 5125 or 5126")),
        })
    }

    pub(super) fn is_unsigned(self) -> bool {
        matches!(self, Self::U8 | Self::U16 | Self::U32)
    }

    /// Returns the largest number of a type of integers.
    fn largest(self) -> f64 {
        match self {
            Self::I8 => f64::from(i8::MAX),
            Self::U8 => f64::from(u8::MAX),
            Self::I16 => f64::from(i16::MAX),
            Self::U16 => f64::from(u16::MAX),
            Self::U32 | Self::F32 => f64::from(u32::MAX),
        }
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// Returns the number at the start of the bytes, which must have its size.
    fn number(self, bytes: &[u8]) -> f64 {
        match (self, bytes) {
            (Self::I8, &[a, ..]) => f64::from(a as i8),
            (Self::U8, &[a, ..]) => f64::from(a),
            (Self::I16, &[a, b, ..]) => f64::from(i16::from_le_bytes([a, b])),
            (Self::U16, &[a, b, ..]) => f64::from(u16::from_le_bytes([a, b])),
            (Self::U32, &[a, b, c, d, ..]) => f64::from(u32::from_le_bytes([a, b, c, d])),
            (Self::F32, &[a, b, c, d, ..]) => f64::from(f32::from_le_bytes([a, b, c, d])),
            // Spans are checked against their buffer; NaN would be found as a number of no use.
            _ => f64::NAN,
        }
    }
}

/// Elements of numbers in buffers.
pub(super) struct Accessor<'a> {
    pub(super) item: Item<'a>,
    pub(super) index: usize,
    pub(super) count: usize,
    /// Number of numbers of an element.
    pub(super) width: usize,
    pub(super) component: Component,
    pub(super) is_normalized: bool,
    /// The elements; zeros if there are none.
    data: Option<(Bytes<'a>, usize, usize)>,
    sparse: Option<Sparse<'a>>,
}

/// Elements that replace others.
struct Sparse<'a> {
    numbers: Vec<usize>,
    values: (Bytes<'a>, usize, usize),
}

impl Accessor<'_> {
    pub(super) fn is_float(&self) -> bool {
        self.component == Component::F32 && !self.is_normalized
    }

    /// Returns whether the elements are integers that `KHR_mesh_quantization` allows for positions.
    pub(super) fn is_quantized(&self) -> bool {
        !matches!(self.component, Component::U32 | Component::F32)
    }

    /// Returns an element, as [`stored`](Self::stored); a normalised number is from 0 or -1 to 1.
    pub(super) fn get<const N: usize>(&self, index: usize) -> [f64; N] {
        let stored = self.stored(index);
        match self.is_normalized {
            // The least number of a signed type is -1, as the one above it.
            true => stored
                .map(|x| x / self.component.largest())
                .map(|x| if x < -1.0 { -1.0 } else { x }),
            false => stored,
        }
    }

    /// Returns an element: its first `N` numbers. The index must be below the count, and `N` at most
    /// the width.
    fn stored<const N: usize>(&self, index: usize) -> [f64; N] {
        let sparse = self.sparse.as_ref();
        let replaced = sparse.and_then(|s| Some((&s.values, s.numbers.binary_search(&index).ok()?)));
        let Some(((bytes, start, stride), index)) = replaced.or(self.data.as_ref().map(|data| (data, index))) else {
            return [0.0; N];
        };
        let size = self.component.size();
        let first = start + stride * index;
        std::array::from_fn(|k| self.component.number(&bytes[first + size * k..]))
    }

    /// Returns the number of elements that replace others.
    pub(super) fn replaced(&self) -> usize {
        self.sparse.as_ref().map_or(0, |sparse| sparse.numbers.len())
    }
}

/// Returns the path of a relative URI below the folder of the file: without a scheme, without `..`.
fn file_name(uri: &str) -> Option<PathBuf> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, after @ ..] = rest {
        rest = after;
        match (first, after) {
            (b'%', [a, b, after @ ..]) if a.is_ascii_hexdigit() && b.is_ascii_hexdigit() => {
                let digit = |c: u8| char::from(c).to_digit(16).unwrap_or(0) as u8;
                bytes.push(16 * digit(*a) + digit(*b));
                rest = after;
            }
            _ => bytes.push(*first),
        }
    }
    let decoded = String::from_utf8(bytes).ok()?;
    let parts: Vec<&str> = decoded.split('/').filter(|part| *part != ".").collect();
    let is_below = |part: &&str| !part.is_empty() && *part != ".." && !part.contains(['\\', ':', '\0']);
    parts.iter().all(is_below).then(|| parts.iter().collect())
}

/// Decodes base64 with the alphabet of RFC 4648, with or without padding at the end.
fn base64(text: &str) -> Option<Vec<u8>> {
    let text = text.trim_end_matches('=').as_bytes();
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 2);
    for group in text.chunks(4) {
        let mut bits = 0;
        for k in 0..4 {
            let digit = match group.get(k) {
                Some(c @ b'A'..=b'Z') => c - b'A',
                Some(c @ b'a'..=b'z') => c - b'a' + 26,
                Some(c @ b'0'..=b'9') => c - b'0' + 52,
                Some(b'+') => 62,
                Some(b'/') => 63,
                None if k > 1 => 0,
                _ => return None,
            };
            bits = bits << 6 | u32::from(digit);
        }
        bytes.extend(&bits.to_be_bytes()[1..group.len()]);
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_of_any_length_is_decoded() {
        // The test vectors of RFC 4648.
        for (text, bytes) in [
            ("", ""),
            ("Zg==", "f"),
            ("Zm8=", "fo"),
            ("Zm9v", "foo"),
            ("Zm9vYg==", "foob"),
            ("Zm9vYmE=", "fooba"),
            ("Zm9vYmFy", "foobar"),
        ] {
            assert_eq!(base64(text).as_deref(), Some(bytes.as_bytes()));
            assert_eq!(base64(text.trim_end_matches('=')).as_deref(), Some(bytes.as_bytes()));
        }
        assert_eq!(base64("+/+/"), Some(vec![0xfb, 0xff, 0xbf]));
        for bad in ["Z", "Zm9vY", "Zm9v\n", "Zm 9v", "Zm-_", "Z===", "Zm=v"] {
            assert_eq!(base64(bad), None, "{bad}");
        }
    }

    #[test]
    fn files_of_buffers_are_below_the_folder() {
        let found = |uri| file_name(uri).map(|path| path.to_string_lossy().replace('\\', "/"));
        assert_eq!(found("a.bin").as_deref(), Some("a.bin"));
        assert_eq!(found("./a%20b/%C3%BC.bin").as_deref(), Some("a b/\u{fc}.bin"));
        assert_eq!(found("100%.bin").as_deref(), Some("100%.bin"));
        for bad in [
            "",
            "/etc/a",
            "..",
            "../a.bin",
            "a/../../b",
            "a/%2e%2e/b",
            "http://a/b.bin",
            "file:a",
            "c:\\a",
            "a\\b",
            "%00",
            "%ff",
        ] {
            assert_eq!(file_name(bad), None, "{bad}");
        }
    }
}
