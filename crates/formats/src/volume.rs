//! Numbers at the nodes of a grid in space: npy, NRRD and raw, written only.
//!
//! Sources: `numpy.lib.format`; "Definition of NRRD File Format" of Teem.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use crate::error::{Fault, FormatError, FormatFault};
use crate::npy;

/// Numbers at the nodes of a grid in space, such as signed distances, to be written to a file.
///
/// All formats have the numbers as `f64`, little endian, so that every bit is kept:
///
/// | file | header | order of the numbers |
/// |---|---|---|
/// | `.npy` | the shape, `(nodes[0], nodes[1], nodes[2])` | z first, then y, then x |
/// | `.nrrd` | the shape, the position of the first node, the steps | x first, then y, then z |
/// | `.raw` | none | x first, then y, then z |
///
/// So the number at the node `[i, j, k]` is `array[i, j, k]` of numpy, and the number at `i` along
/// the first axis, `j` along the second and `k` along the third axis of NRRD.
///
/// A volume is written and not read: a grid of distances is no geometry of `lin-canny`.
///
/// ```
/// use lin_canny_formats::Volume;
///
/// # let file = std::env::temp_dir().join("lin_canny_volume_doc.nrrd");
/// let values = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0];
/// let volume = Volume::new([2, 2, 2], [0.0, 0.0, -0.5], [0.25, 0.25, 0.5], &values);
/// volume.write(&file)?;
/// # std::fs::remove_file(&file).ok();
/// # Ok::<(), lin_canny_formats::FormatError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Volume<'v> {
    /// Numbers of nodes along the axes.
    pub nodes: [usize; 3],
    /// The position of the node `[0, 0, 0]`.
    pub origin: [f64; 3],
    /// Distances of neighbouring nodes along the axes.
    pub step: [f64; 3],
    /// The number at the node `[i, j, k]`, at the index `(i nodes[1] + j) nodes[2] + k`.
    pub values: &'v [f64],
}

/// Format of a file of a [`Volume`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum VolumeFormat {
    /// An array of numpy, `.npy`.
    Npy,
    /// Nearly raw raster data, `.nrrd`.
    Nrrd,
    /// The numbers alone, `.raw`.
    Raw,
}

impl VolumeFormat {
    /// Returns the format of a file, from its extension.
    ///
    /// # Errors
    /// Returns an error if the extension is unknown.
    pub fn of(path: impl AsRef<Path>) -> Result<Self, FormatError> {
        let path = path.as_ref();
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            Some("npy") => Ok(Self::Npy),
            Some("nrrd") => Ok(Self::Nrrd),
            Some("raw") => Ok(Self::Raw),
            _ => {
                let why = "extension of a grid in space is unknown (expected npy, nrrd or raw)";
                Err(Fault::malformed(None, why).of(path))
            }
        }
    }
}

impl<'v> Volume<'v> {
    /// Returns a volume, without a check.
    #[must_use]
    pub const fn new(nodes: [usize; 3], origin: [f64; 3], step: [f64; 3], values: &'v [f64]) -> Self {
        Self {
            nodes,
            origin,
            step,
            values,
        }
    }

    /// Writes the volume in the format of the extension, [`VolumeFormat::of`].
    ///
    /// # Errors
    /// Returns an error if the extension is unknown, if the number of values is not that of the
    /// nodes, if origin or step is not finite, or if the file cannot be written.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), FormatError> {
        let path = path.as_ref();
        let format = VolumeFormat::of(path)?;
        self.check().map_err(|fault| fault.of(path))?;
        let write = || {
            let mut to = BufWriter::new(File::create(path)?);
            self.write_to(format, &mut to)?;
            to.flush()
        };
        write().map_err(|error| {
            let fault = FormatFault::Write(error);
            Fault { line: None, fault }.of(path)
        })
    }

    fn check(&self) -> Result<(), Fault> {
        let [x, y, z] = self.nodes;
        let count = x.checked_mul(y).and_then(|n| n.checked_mul(z));
        if count != Some(self.values.len()) || count == Some(0) {
            let found = self.values.len();
            let why = format!("{found} numbers for a grid of {x} x {y} x {z} nodes (expected one per node)");
            return Err(Fault::malformed(None, why));
        }
        let place = self.origin.iter().chain(&self.step);
        match place.copied().find(|x| !x.is_finite()) {
            Some(x) => Err(Fault::malformed(
                None,
                format!("origin or step of a grid is not finite: {x:?}"),
            )),
            None => Ok(()),
        }
    }

    fn write_to(&self, format: VolumeFormat, to: &mut impl Write) -> io::Result<()> {
        match format {
            VolumeFormat::Npy => {
                to.write_all(&npy::header(self.nodes))?;
                return self.values.iter().try_for_each(|x| to.write_all(&x.to_le_bytes()));
            }
            VolumeFormat::Nrrd => to.write_all(self.nrrd_header().as_bytes())?,
            VolumeFormat::Raw => {}
        }
        let [nx, ny, nz] = self.nodes;
        for k in 0..nz {
            for j in 0..ny {
                (0..nx).try_for_each(|i| to.write_all(&self.values[(i * ny + j) * nz + k].to_le_bytes()))?;
            }
        }
        Ok(())
    }

    /// Returns the header of NRRD, with an empty line at its end.
    ///
    /// With a place in space, the steps are the lengths of the space directions: the format forbids
    /// `spacings` next to them.
    fn nrrd_header(&self) -> String {
        let ([nx, ny, nz], [x, y, z], [dx, dy, dz]) = (self.nodes, self.origin, self.step);
        format!(
            "NRRD0004\n\
             type: double\n\
             dimension: 3\n\
             space dimension: 3\n\
             sizes: {nx} {ny} {nz}\n\
             space directions: ({dx:?},0,0) (0,{dy:?},0) (0,0,{dz:?})\n\
             kinds: domain domain domain\n\
             endian: little\n\
             encoding: raw\n\
             space origin: ({x:?},{y:?},{z:?})\n\n"
        )
    }
}
