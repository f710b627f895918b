//! Meshes: the triangles of primitives over the positions that they use, and skins.

use super::buffer::{Accessor, Buffers};
use super::json::Item;
use crate::error::Fault;
use crate::mesh::{MeshObject, ObjectBuilder, SkippedList};
use crate::transform::{FLAT, Matrix, apply, orientation};

/// Largest difference of the sum of the weights of a vertex from 1.
const SUM: f64 = 0.02;

/// Most bytes of objects and of corners that a file may have: so many, and so many for each of its
/// bytes. A file that puts every mesh once has fewer than the second.
const SCENE: (usize, usize) = (48 << 20, 100);

/// Bytes of a corner of a primitive, with what finds it again, and of the numbers of a vertex in a
/// skin or a sparse accessor.
const CORNER: usize = 64;
const NUMBER: usize = 8;

/// The meshes of a file, what may be spent on them, and what readers have passed over.
pub(super) struct Meshes<'a> {
    pub(super) buffers: Buffers<'a>,
    pub(super) skipped: SkippedList,
    /// The file uses `KHR_mesh_quantization`: positions may be integers.
    pub(super) is_quantized: bool,
    /// Number of bytes of objects and corners that may still follow.
    pub(super) left: usize,
}

impl<'a> Meshes<'a> {
    /// Returns the meshes of a file of `size` bytes.
    pub(super) fn new(buffers: Buffers<'a>, skipped: SkippedList, size: usize) -> Self {
        Self {
            buffers,
            skipped,
            is_quantized: false,
            left: size.saturating_mul(SCENE.1).saturating_add(SCENE.0),
        }
    }

    /// Counts the bytes of objects and corners.
    pub(super) fn spend(&mut self, count: usize, item: &Item) -> Result<(), Fault> {
        let external = std::mem::take(&mut self.buffers.external);
        let left = self.left.saturating_add(external.saturating_mul(SCENE.1));
        let left = left.checked_sub(count);
        self.left = left.ok_or_else(|| item.malformed("makes the scene too large by repeated use of data"))?;
        Ok(())
    }

    /// Returns a mesh without the transforms of nodes, or moved by the joints of a skin.
    pub(super) fn mesh(&mut self, item: &Item<'a>, joints: Option<&[Matrix]>) -> Result<MeshObject, Fault> {
        item.check_keys(&["primitives", "weights"])?;
        let mut builder = ObjectBuilder::new(item.text("name")?.unwrap_or_default());
        let mut is_mirrored = None;
        let primitives = item.elements("primitives")?;
        if item.list("primitives")?.is_empty() {
            return Err(item.malformed("has no primitives"));
        }
        for (number, primitive) in primitives.enumerate() {
            self.primitive(&primitive?, number, joints, &mut is_mirrored, &mut builder)?;
        }
        let mut object = builder.build();
        if is_mirrored == Some(true) {
            object.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        Ok(object)
    }

    fn primitive(
        &mut self,
        item: &Item<'a>,
        number: usize,
        joints: Option<&[Matrix]>,
        is_mirrored: &mut Option<bool>,
        builder: &mut ObjectBuilder,
    ) -> Result<(), Fault> {
        item.check_keys(&["attributes", "indices", "material", "mode", "targets"])?;
        let keys = item
            .object("attributes")?
            .map_or(0, |attributes| attributes.keys().count());
        self.spend(CORNER * (1 + keys), item)?;
        let mode = item.whole("mode")?.unwrap_or(4);
        match mode {
            0 => self.skipped.add(None, "points"),
            1..=3 => self.skipped.add(None, "lines"),
            4..=6 => {}
            _ => return Err(item.invalid("mode", "0 to 6")),
        }
        if mode < 4 {
            return Ok(());
        }
        if item.has("targets") {
            self.skipped.add(None, "morph targets");
        }
        let Some(attributes) = item.object("attributes")? else {
            return Err(item.malformed("has no attributes"));
        };
        self.check_fallback(item, &attributes)?;
        let Some(positions) = self.buffers.accessor(&attributes, "POSITION")? else {
            return Err(item.malformed("has no attribute POSITION"));
        };
        if !positions.is_float() && !positions.is_quantized() {
            return Err(positions
                .item
                .invalid("componentType", "5120 to 5123, or 5126 for POSITION"));
        }
        if !positions.is_float() && !self.is_quantized {
            return Err(positions
                .item
                .malformed("is a quantized POSITION (expected KHR_mesh_quantization in extensionsUsed)"));
        }
        if positions.width != 3 {
            return Err(positions.item.invalid("type", "VEC3 for POSITION"));
        }
        let indices = self.buffers.accessor(item, "indices")?;
        if let Some(indices) = &indices
            && !(indices.width == 1 && indices.component.is_unsigned() && !indices.is_normalized)
        {
            return Err(indices
                .item
                .malformed("is invalid (expected SCALAR of 5121, 5123 or 5125 for indices)"));
        }
        let corners = indices.as_ref().map_or(positions.count, |indices| indices.count);
        let triangles = match mode {
            4 if corners % 3 == 0 => corners / 3,
            4 => return Err(item.malformed(format!("has {corners} corners (expected a multiple of 3)"))),
            _ if corners >= 3 => corners - 2,
            _ => return Err(item.malformed(format!("has {corners} corners of a strip or fan (expected 3 or more)"))),
        };
        let mut vertices = Vertices {
            // Points of two primitives over the same positions are the same points, unless they
            // have different weights.
            group: if joints.is_some() { number } else { positions.index },
            positions,
            joints,
            influences: Vec::new(),
            is_mirrored,
        };
        match joints {
            Some(_) => vertices.influences = self.influences(item, &attributes, vertices.positions.count)?,
            None => self.skip_attributes(&attributes),
        }
        let sets = vertices.influences.as_flattened();
        let replaced = sets
            .iter()
            .chain([&vertices.positions])
            .chain(&indices)
            .map(Accessor::replaced);
        let work = corners.saturating_mul(CORNER + NUMBER * sets.len());
        let replaced: usize = replaced.sum();
        self.spend(work.saturating_add(NUMBER * replaced), item)?;
        for k in 0..triangles {
            let places = match mode {
                4 => [3 * k, 3 * k + 1, 3 * k + 2],
                5 if k % 2 == 0 => [k, k + 1, k + 2],
                // Every second triangle of a strip is turned.
                5 => [k + 1, k, k + 2],
                _ => [k + 1, k + 2, 0],
            };
            let [a, b, c] = match &indices {
                Some(indices) => places.map(|place| indices.get::<1>(place)[0] as usize),
                None => places,
            };
            // A repeated corner joins two strips; it makes no triangle.
            if mode == 4 || (a != b && b != c && c != a) {
                vertices.add(item, [a, b, c], builder)?;
            } else if let Some(&index) = [a, b, c].iter().find(|&&index| index >= vertices.positions.count) {
                return Err(vertices.missing(item, index));
            }
        }
        Ok(())
    }

    /// Returns an error if the data of a primitive is in an extension alone.
    fn check_fallback(&mut self, item: &Item<'a>, attributes: &Item<'a>) -> Result<(), Fault> {
        const DRACO: &str = "KHR_draco_mesh_compression";
        if item.extension(DRACO)?.is_none() {
            return Ok(());
        }
        for (user, key) in [(attributes, "POSITION"), (item, "indices")] {
            if let Some(accessor) = user.whole(key)?
                && !self.buffers.root.element("accessors", accessor)?.has("bufferView")
            {
                return Err(item.unsupported(format!("{DRACO} without other data")));
            }
        }
        self.skipped
            .add(None, "KHR_draco_mesh_compression (its fallback is read)");
        Ok(())
    }

    fn skip_attributes(&mut self, attributes: &Item<'a>) {
        for key in attributes.keys() {
            let what = match key.split('_').next() {
                Some("POSITION") if key == "POSITION" => continue,
                Some("NORMAL" | "TANGENT") => "normals",
                Some("TEXCOORD") => "texture coordinates",
                Some("COLOR") => "colors",
                Some("JOINTS" | "WEIGHTS") => "joints and weights",
                _ => "other attributes",
            };
            self.skipped.add(None, what);
        }
    }

    /// Returns the joints and weights of the vertices of a skin, four in each set.
    fn influences(
        &mut self,
        item: &Item<'a>,
        attributes: &Item<'a>,
        count: usize,
    ) -> Result<Vec<[Accessor<'a>; 2]>, Fault> {
        let mut influences = Vec::new();
        for set in 0.. {
            let (joints, weights) = (format!("JOINTS_{set}"), format!("WEIGHTS_{set}"));
            let sets = attributes
                .keys()
                .filter(|key| key.starts_with("JOINTS_") || key.starts_with("WEIGHTS_"));
            let (joints, weights) = (
                self.buffers.accessor(attributes, &joints)?,
                self.buffers.accessor(attributes, &weights)?,
            );
            let (Some(joints), Some(weights)) = (joints, weights) else {
                let sets = sets.count();
                if set == 0 || 2 * set != sets {
                    let why = "has no JOINTS or no WEIGHTS of a set (expected both from 0 for a skin)";
                    return Err(item.malformed(why));
                }
                break;
            };
            let is_right = |a: &Accessor| a.width == 4 && a.count == count;
            if !(is_right(&joints) && joints.component.is_unsigned() && !joints.is_normalized) {
                return Err(joints
                    .item
                    .malformed(format!("is invalid (expected {count} VEC4 of joints)")));
            }
            let is_weight = weights.is_float() || weights.component.is_unsigned() && weights.is_normalized;
            if !(is_right(&weights) && is_weight) {
                return Err(weights
                    .item
                    .malformed(format!("is invalid (expected {count} VEC4 of weights)")));
            }
            influences.push([joints, weights]);
        }
        Ok(influences)
    }
}

/// The vertices of a primitive.
struct Vertices<'a, 'b> {
    positions: Accessor<'a>,
    group: usize,
    joints: Option<&'b [Matrix]>,
    /// Joints and weights.
    influences: Vec<[Accessor<'a>; 2]>,
    /// Whether the joints that are used mirror.
    is_mirrored: &'b mut Option<bool>,
}

impl Vertices<'_, '_> {
    fn add(&mut self, item: &Item, corners: [usize; 3], builder: &mut ObjectBuilder) -> Result<(), Fault> {
        let mut points = [[0.0; 3]; 3];
        for (point, vertex) in points.iter_mut().zip(corners) {
            *point = self.point(item, vertex)?;
        }
        let keys = corners.map(|vertex| (self.group as u64) << 32 | vertex as u64);
        let point = |key: u64| {
            let corner = keys.iter().position(|known| *known == key);
            points[corner.unwrap_or(0)]
        };
        let added = builder.triangle(keys, point);
        added.ok_or_else(|| item.malformed("has too many points for 32-bit indices"))
    }

    fn missing(&self, item: &Item, vertex: usize) -> Fault {
        let count = self.positions.count;
        item.malformed(format!(
            "uses vertex {vertex} that does not exist (expected less than {count})"
        ))
    }

    fn point(&mut self, item: &Item, vertex: usize) -> Result<[f64; 3], Fault> {
        if vertex >= self.positions.count {
            return Err(self.missing(item, vertex));
        }
        let mut point: [f64; 3] = self.positions.get(vertex);
        if let Some(joints) = self.joints {
            point = self.moved(item, vertex, point, joints)?;
        }
        match point.iter().all(|x| x.is_finite()) {
            true => Ok(point),
            false => Err(item.malformed(format!("uses vertex {vertex} that is not finite"))),
        }
    }

    /// Returns a point of a skin: where its joints move it, weighted.
    fn moved(&mut self, item: &Item, vertex: usize, point: [f64; 3], joints: &[Matrix]) -> Result<[f64; 3], Fault> {
        let (mut sum, mut moved) = (0.0, [0.0; 3]);
        for [numbers, weights] in &self.influences {
            let (numbers, weights): ([f64; 4], [f64; 4]) = (numbers.get(vertex), weights.get(vertex));
            for (joint, weight) in numbers.into_iter().zip(weights) {
                if weight == 0.0 {
                    continue;
                }
                let Some(transform) = joints.get(joint as usize) else {
                    let why = format!(
                        "uses joint {joint} that does not exist (expected less than {})",
                        joints.len()
                    );
                    return Err(item.malformed(why));
                };
                let orientation = orientation(transform);
                if !(orientation.abs() > FLAT) {
                    let why = format!("uses joint {joint} with an invalid transform: flat or not finite");
                    return Err(item.malformed(why));
                }
                if *self.is_mirrored.get_or_insert(orientation < 0.0) != (orientation < 0.0) {
                    return Err(item.unsupported("a skin of which some joints are mirrored"));
                }
                if !(weight > 0.0) {
                    return Err(item.malformed(format!("has an invalid weight of vertex {vertex}: {weight}")));
                }
                sum += weight;
                let target = apply(transform, point);
                moved = std::array::from_fn(|k| moved[k] + weight * target[k]);
            }
        }
        if !((sum - 1.0).abs() < SUM) {
            let why = format!("has weights of vertex {vertex} with the sum {sum} (expected 1)");
            return Err(item.malformed(why));
        }
        Ok(moved.map(|x| x / sum))
    }
}
