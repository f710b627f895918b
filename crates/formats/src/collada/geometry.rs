//! Geometries: the primitives of a mesh as triangles over the positions that they use.

use std::collections::HashMap;
use std::rc::Rc;

use roxmltree::NodeId;

use crate::error::Fault;
use crate::mesh::{MeshObject, ObjectBuilder, SkippedList};
use crate::polygon;
use crate::xml::{Element, Xml, children, elements, name};

/// Positions: a part of an array of numbers, as its accessor describes it.
struct Positions<'a> {
    source: Element<'a>,
    array: Element<'a>,
    numbers: Rc<Vec<f64>>,
    count: usize,
    offset: usize,
    stride: usize,
    /// Where x, y and z are among the numbers of a position.
    axes: [usize; 3],
}

impl Positions<'_> {
    fn get(&self, index: usize) -> [f64; 3] {
        self.axes
            .map(|axis| self.numbers[self.offset + self.stride * index + axis])
    }

    /// Returns a number of an object for a position: positions of two sources differ.
    fn key(&self, index: usize) -> u64 {
        u64::from(self.source.id().get()) << 32 | index as u64
    }

    /// Returns an error if the position is not finite.
    fn check(&self, xml: &Xml, index: usize) -> Result<(), Fault> {
        let point = self.get(index);
        let Some(axis) = point.iter().position(|x| !x.is_finite()) else {
            return Ok(());
        };
        let word = self.offset + self.stride * index + self.axes[axis];
        let line = xml.line_of_word(self.array, word);
        let value = point[axis];
        let why = format!("position {index} is not finite: {value} (expected finite coordinates where triangles are)");
        Err(Fault::malformed(line, why))
    }
}

/// A primitive: which of the indices of a corner names its position.
struct Primitive<'a> {
    node: Element<'a>,
    positions: Rc<Positions<'a>>,
    offset: usize,
    /// Number of indices of a corner.
    stride: usize,
}

/// The geometries of a file, each read once, and what readers have passed over.
pub(super) struct Geometries<'a> {
    xml: &'a Xml<'a>,
    pub(super) skipped: SkippedList,
    /// The geometries as in the file, without the transforms of nodes.
    known: HashMap<NodeId, Rc<MeshObject>>,
    /// The positions of an element `vertices`, and those of an element `source`.
    positions: HashMap<NodeId, Rc<Positions<'a>>>,
    arrays: HashMap<NodeId, Rc<Vec<f64>>>,
}

impl<'a> Geometries<'a> {
    pub(super) fn new(xml: &'a Xml<'a>) -> Self {
        Self {
            xml,
            skipped: SkippedList::default(),
            known: HashMap::new(),
            positions: HashMap::new(),
            arrays: HashMap::new(),
        }
    }

    /// Returns whether a geometry was read.
    pub(super) fn is_known(&self, node: Element) -> bool {
        self.known.contains_key(&node.id())
    }

    /// Returns a geometry without the transforms of nodes.
    pub(super) fn geometry(&mut self, node: Element<'a>) -> Result<Rc<MeshObject>, Fault> {
        if let Some(known) = self.known.get(&node.id()) {
            return Ok(known.clone());
        }
        let title = node.attribute("name").or(node.attribute("id"));
        let mut builder = ObjectBuilder::new(title.unwrap_or_default());
        for child in elements(node) {
            match name(child) {
                "convex_mesh" if child.has_attribute("convex_hull_of") => {
                    return Err(self
                        .xml
                        .unsupported(child, "a mesh that is the hull of another (convex_hull_of)"));
                }
                "mesh" | "convex_mesh" => self.mesh(child, &mut builder)?,
                "asset" => {}
                "extra" => self.skipped.add(self.xml.line(child), "extra"),
                _ => return Err(self.xml.unknown(child)),
            }
        }
        self.skipped.append(std::mem::take(&mut builder.skipped));
        let geometry = Rc::new(builder.build());
        self.known.insert(node.id(), geometry.clone());
        Ok(geometry)
    }

    fn mesh(&mut self, mesh: Element<'a>, builder: &mut ObjectBuilder) -> Result<(), Fault> {
        for child in elements(mesh) {
            match name(child) {
                "triangles" | "tristrips" | "trifans" | "polylist" | "polygons" => self.primitive(child, builder)?,
                "lines" | "linestrips" => self.skipped.add(self.xml.line(child), "lines"),
                "source" | "vertices" => {}
                "extra" => self.skipped.add(self.xml.line(child), "extra"),
                _ => return Err(self.xml.unknown(child)),
            }
        }
        Ok(())
    }

    /// Adds the triangles of a primitive.
    fn primitive(&mut self, node: Element<'a>, builder: &mut ObjectBuilder) -> Result<(), Fault> {
        let (xml, kind) = (self.xml, name(node));
        let (mut lists, mut counts) = (Vec::new(), None);
        for child in elements(node) {
            match name(child) {
                "p" => lists.push(child),
                "ph" if kind == "polygons" => lists.push(child),
                "vcount" if kind == "polylist" && counts.is_none() => counts = Some(xml.indices(child)?),
                "input" => self.skip_input(child),
                "extra" => self.skipped.add(xml.line(child), "extra"),
                _ => return Err(xml.unknown(child)),
            }
        }
        // An exporter may write a primitive without anything.
        if lists.is_empty() && counts.as_ref().is_none_or(Vec::is_empty) {
            return xml.check_count(node, 0, "primitives");
        }
        let primitive = self.inputs(node)?;
        let mut found = 0;
        match kind {
            "triangles" => {
                for list in lists {
                    let corners = primitive.corners(xml, list)?;
                    let (triangles, rest) = corners.as_chunks::<3>();
                    if !rest.is_empty() {
                        let why = format!("has {} corners of triangles (expected a multiple of 3)", corners.len());
                        return Err(xml.malformed(list, why));
                    }
                    found += triangles.len();
                    triangles
                        .iter()
                        .try_for_each(|t| primitive.add(xml, list, *t, builder))?;
                }
            }
            "polylist" => {
                let counts = counts.unwrap_or_default();
                found = counts.len();
                let [list] = lists[..] else {
                    let why = format!("has {} elements p (expected one)", lists.len());
                    return Err(xml.malformed(node, why));
                };
                primitive.polylist(xml, list, &counts, builder)?;
            }
            "polygons" => {
                for list in lists {
                    found += 1;
                    if name(list) == "ph" {
                        primitive.polygon_with_holes(xml, list, builder)?;
                    } else {
                        primitive.polygon(xml, list, &[&primitive.corners(xml, list)?], builder)?;
                    }
                }
            }
            _ => {
                for list in lists {
                    found += 1;
                    primitive.strip_or_fan(xml, list, builder)?;
                }
            }
        }
        xml.check_count(node, found, "primitives")
    }

    fn skip_input(&mut self, input: Element) {
        let what = match input.attribute("semantic") {
            Some("VERTEX") => return,
            Some("NORMAL") => "normals",
            Some("TEXCOORD") => "texture coordinates",
            Some("COLOR") => "colors",
            _ => "other inputs",
        };
        self.skipped.add(self.xml.line(input), what);
    }

    /// Reads the inputs of a primitive.
    fn inputs(&mut self, node: Element<'a>) -> Result<Primitive<'a>, Fault> {
        let xml = self.xml;
        let is_alone = children(node, "input").nth(1).is_none();
        let (mut last, mut vertex) = (0, None);
        for input in children(node, "input") {
            let offset = match xml.count(input, "offset")? {
                Some(offset) => offset,
                None if is_alone => 0,
                None => return Err(xml.malformed(input, "has no attribute offset")),
            };
            last = last.max(offset);
            if input.attribute("semantic") == Some("VERTEX") && vertex.replace((input, offset)).is_some() {
                return Err(xml.malformed(input, "is the second of the semantic VERTEX (expected one)"));
            }
        }
        let Some((input, offset)) = vertex else {
            return Err(xml.malformed(node, "has no input of the semantic VERTEX"));
        };
        let vertices = xml.named(input, "source", &["vertices"])?;
        Ok(Primitive {
            node,
            positions: self.positions(vertices)?,
            offset,
            stride: last.saturating_add(1),
        })
    }

    /// Returns the positions of an element `vertices`.
    fn positions(&mut self, vertices: Element<'a>) -> Result<Rc<Positions<'a>>, Fault> {
        if let Some(known) = self.positions.get(&vertices.id()) {
            return Ok(known.clone());
        }
        let xml = self.xml;
        let mut inputs = children(vertices, "input").filter(|n| n.attribute("semantic") == Some("POSITION"));
        let (Some(input), None) = (inputs.next(), inputs.next()) else {
            return Err(xml.malformed(
                vertices,
                "has no input of the semantic POSITION, or several (expected one)",
            ));
        };
        let source = xml.named(input, "source", &["source"])?;
        let positions = match self.positions.get(&source.id()) {
            Some(known) => known.clone(),
            None => Rc::new(self.source(source)?),
        };
        self.positions.insert(source.id(), positions.clone());
        self.positions.insert(vertices.id(), positions.clone());
        Ok(positions)
    }

    fn source(&mut self, source: Element<'a>) -> Result<Positions<'a>, Fault> {
        let xml = self.xml;
        let accessor = children(source, "technique_common").find_map(|n| children(n, "accessor").next());
        let array = match accessor {
            Some(accessor) => Some(xml.named(accessor, "source", &["float_array"])?),
            None => children(source, "float_array").next(),
        };
        let array = array.ok_or_else(|| xml.malformed(source, "has no element float_array"))?;
        let numbers = self.array(array)?;
        let of_accessor = |attribute| accessor.map_or(Ok(None), |n| xml.count(n, attribute));
        let names: Vec<_> = accessor
            .into_iter()
            .flat_map(|n| children(n, "param"))
            .map(|n| n.attribute("name").filter(|name| !name.is_empty()))
            .collect();
        let node = accessor.unwrap_or(source);
        let stride = of_accessor("stride")?.unwrap_or(names.len().max(3));
        if stride < 3 || stride < names.len() {
            let least = names.len().max(3);
            return Err(xml.malformed(
                node,
                format!("has an invalid stride: {stride} (expected {least} or more)"),
            ));
        }
        let axes = axes(&names, stride).ok_or_else(|| xml.malformed(node, "names fewer than three coordinates"))?;
        let offset = of_accessor("offset")?.unwrap_or(0);
        let last_axis = axes[0].max(axes[1]).max(axes[2]);
        let room = numbers.len().saturating_sub(offset);
        let count = match of_accessor("count")? {
            Some(count) => count,
            None if room.is_multiple_of(stride) => room / stride,
            None => {
                let why = format!("has {room} numbers (expected a multiple of its stride, {stride})");
                return Err(xml.malformed(node, why));
            }
        };
        // The last position may end with its last coordinate.
        let fits = match count.checked_sub(1) {
            Some(rest) => rest
                .checked_mul(stride)
                .and_then(|n| n.checked_add(last_axis))
                .is_some_and(|n| n < room),
            None => true,
        };
        if !fits || u32::try_from(count).is_err() {
            let why = format!(
                "has a wrong count of positions: {count} (expected at most {})",
                room.div_ceil(stride)
            );
            return Err(xml.malformed(node, why));
        }
        Ok(Positions {
            source,
            array,
            numbers,
            count,
            offset,
            stride,
            axes,
        })
    }

    /// Returns the numbers of an array.
    pub(super) fn array(&mut self, node: Element<'a>) -> Result<Rc<Vec<f64>>, Fault> {
        if let Some(known) = self.arrays.get(&node.id()) {
            return Ok(known.clone());
        }
        let numbers = Rc::new(self.xml.numbers(node)?);
        self.xml.check_count(node, numbers.len(), "numbers")?;
        self.arrays.insert(node.id(), numbers.clone());
        Ok(numbers)
    }
}

/// Returns where x, y and z are, by the parameters of an accessor: by name, or else the first three
/// that have a name. Parameters that are missing at the end count as named.
fn axes(names: &[Option<&str>], stride: usize) -> Option<[usize; 3]> {
    let at = |axis: &str| {
        names
            .iter()
            .position(|name| name.is_some_and(|n| n.eq_ignore_ascii_case(axis)))
    };
    if let (Some(x), Some(y), Some(z)) = (at("x"), at("y"), at("z")) {
        return Some([x, y, z]);
    }
    let mut used = (0..stride).filter(|&k| names.get(k).is_none_or(Option::is_some));
    Some([used.next()?, used.next()?, used.next()?])
}

impl Primitive<'_> {
    /// Returns the positions of the corners of a list of indices.
    fn corners(&self, xml: &Xml, list: Element) -> Result<Vec<usize>, Fault> {
        let mut indices = xml.indices(list)?;
        if !indices.len().is_multiple_of(self.stride) {
            let (count, stride) = (indices.len(), self.stride);
            let why = format!("has {count} indices (expected a multiple of {stride}, as the inputs need)");
            return Err(xml.malformed(list, why));
        }
        let corners = indices.len() / self.stride;
        for k in 0..corners {
            let at = self.stride * k + self.offset;
            let index = indices[at];
            if index >= self.positions.count {
                let count = self.positions.count;
                let why = format!("vertex {index} does not exist (expected less than {count})");
                return Err(Fault::malformed(xml.line_of_word(list, at), why));
            }
            self.positions.check(xml, index)?;
            indices[k] = index;
        }
        indices.truncate(corners);
        Ok(indices)
    }

    fn add(&self, xml: &Xml, list: Element, corners: [usize; 3], builder: &mut ObjectBuilder) -> Result<(), Fault> {
        let keys = corners.map(|k| self.positions.key(k));
        // The lower half of a key is the index.
        let point = |key: u64| self.positions.get(key as u32 as usize);
        let added = builder.triangle(keys, point);
        added.ok_or_else(|| xml.malformed(list, "has too many points for 32-bit indices"))
    }

    /// Adds a strip or a fan.
    fn strip_or_fan(&self, xml: &Xml, list: Element, builder: &mut ObjectBuilder) -> Result<(), Fault> {
        let corners = self.corners(xml, list)?;
        if corners.len() < 3 {
            let why = format!("has {} corners of a strip or fan (expected 3 or more)", corners.len());
            return Err(xml.malformed(list, why));
        }
        let is_fan = name(self.node) == "trifans";
        for k in 2..corners.len() {
            let [a, b, c] = match k % 2 {
                _ if is_fan => [corners[0], corners[k - 1], corners[k]],
                0 => [corners[k - 2], corners[k - 1], corners[k]],
                // Every second triangle of a strip is turned.
                _ => [corners[k - 1], corners[k - 2], corners[k]],
            };
            // A repeated corner joins two strips; it makes no triangle.
            if a != b && b != c && c != a {
                self.add(xml, list, [a, b, c], builder)?;
            }
        }
        Ok(())
    }

    fn polylist(&self, xml: &Xml, list: Element, counts: &[usize], builder: &mut ObjectBuilder) -> Result<(), Fault> {
        let corners = self.corners(xml, list)?;
        let mut rest = &corners[..];
        for &count in counts {
            let Some((polygon, after)) = rest.split_at_checked(count) else {
                let why = format!("has {} corners, fewer corners than vcount requires", corners.len());
                return Err(xml.malformed(list, why));
            };
            self.polygon(xml, list, &[polygon], builder)?;
            rest = after;
        }
        if rest.is_empty() {
            return Ok(());
        }
        let why = format!(
            "has {} corners, {} more than vcount requires",
            corners.len(),
            rest.len()
        );
        Err(xml.malformed(list, why))
    }

    /// Adds the polygon of an element `ph`.
    fn polygon_with_holes(&self, xml: &Xml, node: Element, builder: &mut ObjectBuilder) -> Result<(), Fault> {
        let mut rings = Vec::new();
        for child in elements(node) {
            match (name(child), rings.is_empty()) {
                ("p", true) | ("h", false) => rings.push(self.corners(xml, child)?),
                _ => return Err(xml.malformed(child, "is at the wrong place (expected one p, and then h)")),
            }
        }
        let rings: Vec<&[usize]> = rings.iter().map(Vec::as_slice).collect();
        self.polygon(xml, node, &rings, builder)
    }

    /// Adds a polygon: its outer ring, and its holes.
    fn polygon(&self, xml: &Xml, list: Element, rings: &[&[usize]], builder: &mut ObjectBuilder) -> Result<(), Fault> {
        if let Some(ring) = rings.iter().find(|ring| ring.len() < 3) {
            let why = format!("has a polygon of {} corners (expected 3 or more)", ring.len());
            return Err(xml.malformed(list, why));
        }
        match rings {
            [] => Err(xml.malformed(list, "has no corners")),
            &[&[a, b, c]] => self.add(xml, list, [a, b, c], builder),
            _ => {
                let corners = rings.concat();
                let point = |k: u64| self.positions.get(corners[k as usize]);
                // Positions of polygons without area are used as well.
                if let Some(&corner) = corners
                    .iter()
                    .find(|&&k| self.positions.get(k).iter().any(|x| !x.is_finite()))
                {
                    return Err(xml.malformed(list, format!("position {corner} is not finite")));
                }
                let mut first = 0;
                let numbers: Vec<Vec<u64>> = rings
                    .iter()
                    .map(|ring| {
                        let end = first + ring.len() as u64;
                        (std::mem::replace(&mut first, end)..end).collect()
                    })
                    .collect();
                let numbers: Vec<&[u64]> = numbers.iter().map(Vec::as_slice).collect();
                let line = xml.line(list);
                let triangles = polygon::triangulate(&numbers, point, |what| builder.skipped.add(line, what));
                let triangles = triangles.map_err(|why| xml.malformed(list, format!("has an invalid face: {why}")))?;
                triangles
                    .iter()
                    .try_for_each(|t| self.add(xml, list, t.map(|k| corners[k as usize]), builder))
            }
        }
    }
}
