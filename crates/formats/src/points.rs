//! A point file: its points, and what was skipped. The module `load` picks its reader.

use crate::error::{Fault, FormatFault};
use crate::mesh::{Skipped, SkippedList};
use crate::number::{Order, Type};
use crate::text;

/// Format of a point file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum PointFormat {
    /// The vertices of a PLY 1.0, text or binary.
    Ply,
    /// PCD, the point clouds of the Point Cloud Library: text, binary or compressed.
    Pcd,
    /// Text with a point per line.
    Xyz,
    /// An array of numpy.
    Npy,
}

/// Points in the type of the file.
#[derive(Clone, Debug, PartialEq)]
pub enum Points {
    /// Single precision: all coordinates of the file are `f32`.
    F32(Vec<[f32; 3]>),
    /// Double precision: everything else. All numbers of the file are exact, those of a text nearest.
    F64(Vec<[f64; 3]>),
}

impl Points {
    /// Returns the number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::F32(points) => points.len(),
            Self::F64(points) => points.len(),
        }
    }

    /// Returns whether there is no point.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the points in double precision, which is exact.
    #[must_use]
    pub fn to_f64(&self) -> Vec<[f64; 3]> {
        match self {
            Self::F32(points) => points.iter().map(|p| p.map(f64::from)).collect(),
            Self::F64(points) => points.clone(),
        }
    }
}

/// What a reader does with points whose coordinates are NaN or infinite.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Invalid {
    /// Drops and counts them.
    #[default]
    Drop,
    /// Returns an error that names the first.
    Refuse,
    /// Keeps them with their coordinates, for a reader that answers row by row. Their radii, if the
    /// file has any, must be valid too.
    Keep,
}

/// A point file as read.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct PointFile {
    /// The format.
    pub format: PointFormat,
    /// The points whose coordinates are finite, in the order and the unit of the file; at least one. With
    /// [`Invalid::Keep`] all points of the file.
    /// Images of points (a PCD whose height is more than 1, an array of more than two axes) are read
    /// row by row.
    pub points: Points,
    /// A radius for each point, if the file has a number of that name: finite and not negative.
    pub radii: Option<Vec<f64>>,
    /// The number of points dropped because a coordinate is NaN or infinite.
    pub dropped: usize,
    /// What the reader has passed over: colours, normals, faces, the pose of the sensor.
    pub skipped: Vec<Skipped>,
}

/// Collects points; those that are not finite are dropped or refused.
#[derive(Debug)]
pub(crate) struct PointList {
    points: Points,
    radii: Option<Vec<f64>>,
    dropped: usize,
    /// Number of points in the file up to now.
    rows: u64,
    invalid: Invalid,
    skipped: SkippedList,
    /// Number of entries of `skipped` with the name of a property.
    named: usize,
}

/// Most properties that are listed with their names.
const NAMED: usize = 32;

impl PointList {
    pub(crate) fn new(invalid: Invalid) -> Self {
        Self {
            points: Points::F64(Vec::new()),
            radii: None,
            dropped: 0,
            rows: 0,
            invalid,
            skipped: SkippedList::default(),
            named: 0,
        }
    }

    /// Returns the file of the points; there must be one.
    pub(crate) fn build(self, format: PointFormat) -> Result<PointFile, Fault> {
        let dropped = self.dropped;
        if self.points.is_empty() {
            let (line, fault) = (None, FormatFault::NoPoint(dropped));
            return Err(Fault { line, fault });
        }
        Ok(PointFile {
            format,
            points: self.points,
            radii: self.radii,
            dropped,
            skipped: self.skipped.build(),
        })
    }

    /// States what follows: points of single precision or not, with a radius each or not. `count` is
    /// a number of points that the bytes of the file suffice for, or 0.
    pub(crate) fn begin(&mut self, is_single: bool, has_radii: bool, count: usize) {
        self.points = if is_single {
            Points::F32(Vec::with_capacity(count))
        } else {
            Points::F64(Vec::with_capacity(count))
        };
        self.radii = has_radii.then(|| Vec::with_capacity(count));
    }

    /// Adds the next point of the file.
    pub(crate) fn push(&mut self, point: [f64; 3], radius: Option<f64>, line: Option<usize>) -> Result<(), Fault> {
        let index = self.rows;
        self.rows += 1;
        if point.iter().any(|x| !x.is_finite()) {
            match self.invalid {
                Invalid::Drop => {
                    self.dropped += 1;
                    return Ok(());
                }
                Invalid::Refuse => {
                    let fault = FormatFault::Invalid { index, point };
                    return Err(Fault { line, fault });
                }
                Invalid::Keep => {}
            }
        }
        if let (Some(radii), Some(radius)) = (&mut self.radii, radius) {
            if !(radius >= 0.0 && radius.is_finite()) {
                let why = format!("point {index} has an invalid radius: {radius:?} (expected 0 or more)");
                return Err(Fault::malformed(line, why));
            }
            radii.push(radius);
        }
        match &mut self.points {
            // The numbers were single.
            Points::F32(points) => points.push(point.map(|x| x as f32)),
            Points::F64(points) => points.push(point),
        }
        Ok(())
    }

    /// Lists a property or an element that is passed over.
    pub(crate) fn skip(&mut self, line: impl Into<Option<usize>>, name: &str) {
        let name = name.to_ascii_lowercase();
        let what = match name.as_str() {
            "nx" | "ny" | "nz" | "normal_x" | "normal_y" | "normal_z" | "normals" => "normals",
            "red" | "green" | "blue" | "alpha" | "diffuse_red" | "diffuse_green" | "diffuse_blue" | "r" | "g" | "b"
            | "a" | "rgb" | "rgba" => "colors",
            "s" | "t" | "u" | "v" | "texcoord" | "texture_u" | "texture_v" => "texture coordinates",
            // A list of names is as long as the file.
            _ if self.named >= NAMED => "other properties",
            _ => {
                self.named += 1;
                return self.skipped.add(line, &text::quoted(&name));
            }
        };
        self.skipped.add(line, what);
    }

    /// Lists something that is passed over, in words.
    pub(crate) fn note(&mut self, line: impl Into<Option<usize>>, what: &str) {
        self.skipped.add(line, what);
    }
}

/// A number of each item of a binary file.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Column {
    pub(crate) of: Type,
    pub(crate) order: Order,
    /// The byte at which the number of the first item starts.
    pub(crate) start: usize,
    /// Number of bytes from item to item.
    pub(crate) stride: usize,
}

impl Column {
    pub(crate) fn number(&self, bytes: &[u8], item: usize) -> Result<f64, String> {
        let start = self.start + item * self.stride;
        let mut rest = bytes.get(start..).unwrap_or_default();
        let number = self.of.take(&mut rest, self.order);
        let number = number.ok_or_else(|| format!("is cut at byte {start}"))?;
        // Greater integers may be rounded.
        if self.of.is_integer() && number.abs() >= (1_u64 << 53) as f64 {
            return Err(format!("has an integer beyond 2^53: {number:?}"));
        }
        Ok(number)
    }
}

impl PointList {
    /// Reads `count` points of a binary file by the columns of x, y, z and of a radius. `item` returns
    /// the number of the item with a point; all items are within `bytes`.
    pub(crate) fn read(
        &mut self,
        bytes: &[u8],
        count: usize,
        axes: [Column; 3],
        radius: Option<Column>,
        item: impl Fn(usize) -> usize,
    ) -> Result<(), Fault> {
        self.begin(axes.iter().all(|axis| axis.of == Type::F32), radius.is_some(), count);
        for k in 0..count {
            let number = |column: &Column| {
                let number = column.number(bytes, item(k));
                number.map_err(|why| Fault::malformed(None, format!("point {k} {why}")))
            };
            let [x, y, z] = &axes;
            let point = [number(x)?, number(y)?, number(z)?];
            self.push(point, radius.as_ref().map(number).transpose()?, None)?;
        }
        Ok(())
    }
}
