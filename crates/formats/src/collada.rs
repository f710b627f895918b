//! COLLADA 1.4 and 1.5: the triangles and polygons of the visual scene, in metres.
//!
//! Each geometry is transformed by the nodes that place it. `<up_axis>` is not applied, as in ROS
//! tools, because files of robots are in the frame of their link. Skins and morphs are an error: the
//! shape of their body depends on joints and weights. Source: COLLADA 1.4.1 specification, Khronos
//! Group 2008.

use std::collections::{HashMap, HashSet};

use roxmltree::{Document, Node, ParsingOptions};

use crate::error::Fault;
use crate::mesh::{MeshFile, MeshFormat, MeshObject, ObjectBuilder, SkippedList};
use crate::{polygon, text};

/// Maximum number of placed nodes: a node that is an instance of itself never ends.
const PLACES: usize = 100_000;

/// Maximum number of elements of a file.
const ELEMENTS: u32 = 16_000_000;

/// A transform: three rows of a matrix and a translation.
type Transform = [[f64; 4]; 3];

const IDENTITY: Transform = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

/// Reads a COLLADA file.
pub(crate) fn read(bytes: &[u8]) -> Result<MeshFile, Fault> {
    let text = text::decode(bytes);
    let options = ParsingOptions {
        allow_dtd: true,
        nodes_limit: ELEMENTS,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(text.trim_start(), options)
        .map_err(|e| Fault::malformed(e.pos().row as usize, format!("malformed XML: {e}")))?;
    let mut reader = Reader::new(&document)?;
    reader.scenes()?;
    Ok(MeshFile {
        format: MeshFormat::Collada,
        objects: reader.objects,
        skipped: reader.skipped.build(),
    })
}

/// A file, its elements by id, and what was read so far.
struct Reader<'a> {
    document: &'a Document<'a>,
    ids: HashMap<&'a str, Node<'a, 'a>>,
    objects: Vec<MeshObject>,
    skipped: SkippedList,
}

/// The positions of a source: numbers, and where the coordinates of each point are.
struct Positions {
    numbers: Vec<f64>,
    count: usize,
    offset: usize,
    stride: usize,
    axes: [usize; 3],
}

impl Positions {
    fn point(&self, k: usize) -> [f64; 3] {
        self.axes.map(|axis| self.numbers[self.offset + k * self.stride + axis])
    }
}

impl<'a> Reader<'a> {
    fn new(document: &'a Document<'a>) -> Result<Self, Fault> {
        let mut ids = HashMap::new();
        for node in document.descendants() {
            if let Some(id) = node.attribute("id") {
                ids.entry(id).or_insert(node);
            }
        }
        let reader = Self {
            document,
            ids,
            objects: Vec::new(),
            skipped: SkippedList::default(),
        };
        let root = document.root_element();
        if is(&root, "COLLADA") {
            return Ok(reader);
        }
        let why = format!(
            "unknown root element: {:?} (expected \"COLLADA\")",
            root.tag_name().name()
        );
        Err(reader.fault(root, why))
    }

    fn line(&self, node: Node) -> usize {
        self.document.text_pos_at(node.range().start).row as usize
    }

    /// Returns the fault of an element.
    fn fault(&self, node: Node, why: impl std::fmt::Display) -> Fault {
        Fault::malformed(self.line(node), format!("{}: {why}", node.tag_name().name()))
    }

    fn unsupported(&self, node: Node, what: impl Into<String>) -> Fault {
        Fault::unsupported(self.line(node), what)
    }

    /// Returns the fault of an element that this reader does not know.
    fn unknown(&self, node: Node) -> Fault {
        let parent = node.parent().map_or("", |parent| parent.tag_name().name());
        self.fault(node, format!("unknown element in <{parent}>"))
    }

    /// Returns the element that an attribute refers to.
    fn named(&self, node: Node, attribute: &str) -> Result<Node<'a, 'a>, Fault> {
        let name = node.attribute(attribute).unwrap_or_default().trim();
        let Some(id) = name.strip_prefix('#') else {
            return Err(self.unsupported(node, format!("an element of another file ({name:?})")));
        };
        let found = self.ids.get(id).copied();
        found.ok_or_else(|| self.fault(node, format!("element {name:?} does not exist")))
    }

    /// Reads all nodes of the scene; of all scenes if the file selects none.
    fn scenes(&mut self) -> Result<(), Fault> {
        let unit = self.unit()?;
        let place = IDENTITY.map(|row| row.map(|x| x * unit));
        let elements = |name: &'static str| self.document.descendants().filter(move |n| is(n, name));
        let scenes: Vec<Node> = match elements("instance_visual_scene").next() {
            Some(scene) => vec![self.named(scene, "url")?],
            None => elements("visual_scene").collect(),
        };
        if scenes.is_empty() {
            let geometries: Vec<Node> = elements("geometry").collect();
            self.skipped.add(None, "missing visual_scene");
            return geometries.into_iter().try_for_each(|node| self.geometry(node, &place));
        }
        let mut waiting = Vec::new();
        for scene in scenes {
            for child in elements_of(scene) {
                match child.tag_name().name() {
                    "node" => waiting.push((child, place)),
                    "asset" | "extra" | "evaluate_scene" => {}
                    _ => return Err(self.unknown(child)),
                }
            }
        }
        waiting.reverse();
        let mut places = 0;
        while let Some((node, place)) = waiting.pop() {
            places += 1;
            if places > PLACES {
                return Err(self.fault(
                    node,
                    format!("more than {PLACES} nodes are placed: instances form a cycle"),
                ));
            }
            let place = product(&place, &self.transform(node)?);
            let first = waiting.len();
            for child in elements_of(node) {
                match child.tag_name().name() {
                    "node" => waiting.push((child, place)),
                    "instance_node" => waiting.push((self.named(child, "url")?, place)),
                    "instance_geometry" => {
                        let geometry = self.named(child, "url")?;
                        self.geometry(geometry, &place)?;
                    }
                    "instance_controller" => {
                        return Err(self.unsupported(child, "a skinned or morphed geometry (instance_controller)"));
                    }
                    "instance_camera" | "instance_light" => self.skipped.add(self.line(child), "cameras and lights"),
                    "asset" | "extra" | "lookat" | "matrix" | "rotate" | "scale" | "skew" | "translate" => {}
                    _ => return Err(self.unknown(child)),
                }
            }
            // Children wait in the order of the file.
            waiting[first..].reverse();
        }
        Ok(())
    }

    /// Returns the length of a unit in metres, from the asset of the file.
    fn unit(&self) -> Result<f64, Fault> {
        let root = self.document.root_element();
        let asset = elements_of(root).find(|n| is(n, "asset"));
        let Some(unit) = asset.and_then(|asset| elements_of(asset).find(|n| is(n, "unit"))) else {
            return Ok(1.0);
        };
        let word = unit.attribute("meter").unwrap_or("1").trim();
        // Some exporters write the comma of their language.
        let number = text::number(word).or_else(|| text::number(&word.replacen(',', ".", 1)));
        number.filter(|meter| *meter > 0.0).ok_or_else(|| {
            let why = format!("meter is out of range: {word:?} (expected a positive number)");
            self.fault(unit, why)
        })
    }

    /// Returns the transform of a node: the product of its elements, in their order.
    fn transform(&mut self, node: Node<'a, 'a>) -> Result<Transform, Fault> {
        let mut all = IDENTITY;
        for child in elements_of(node) {
            let name = child.tag_name().name();
            if !["lookat", "matrix", "rotate", "scale", "skew", "translate"].contains(&name) {
                continue;
            }
            let numbers = self.numbers(child)?;
            if numbers.iter().any(|x| !x.is_finite()) {
                return Err(self.fault(child, "a number is not finite"));
            }
            let next = match (name, &numbers[..]) {
                ("matrix", m) if m.len() == 16 => {
                    if m[12..] != [0.0, 0.0, 0.0, 1.0] {
                        return Err(self.fault(child, "last row is out of range (expected 0 0 0 1)"));
                    }
                    [0, 4, 8].map(|k| [m[k], m[k + 1], m[k + 2], m[k + 3]])
                }
                ("translate", &[x, y, z]) => [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]],
                ("scale", &[x, y, z]) => [[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, z, 0.0]],
                ("rotate", &[x, y, z, degrees]) => match unit_vector([x, y, z]) {
                    Some(axis) => rotation(axis, degrees.to_radians()),
                    None => {
                        self.skipped
                            .add(self.line(child), "rotations about an axis without length");
                        IDENTITY
                    }
                },
                ("skew", m) if m.len() == 7 => self.skew(child, m)?,
                ("lookat", m) if m.len() == 9 => self.lookat(child, m)?,
                _ => {
                    let why = format!("invalid number of values: {}", numbers.len());
                    return Err(self.fault(child, why));
                }
            };
            all = product(&all, &next);
        }
        Ok(all)
    }

    /// Returns the shear that moves points along the second axis until the first axis has turned by
    /// the angle (RenderMan, `Skew`).
    fn skew(&self, node: Node, m: &[f64]) -> Result<Transform, Fault> {
        let axes = [unit_vector([m[1], m[2], m[3]]), unit_vector([m[4], m[5], m[6]])];
        let [Some(first), Some(along)] = axes else {
            return Err(self.fault(node, "an axis has no length"));
        };
        // The first axis in the plane of `along` and `across`.
        let sine = dot(&first, &along);
        let across = [0, 1, 2].map(|k| first[k] - sine * along[k]);
        let cosine = dot(&across, &across).sqrt();
        let (Some(across), angle) = (unit_vector(across), libm::atan2(sine, cosine) + m[0].to_radians()) else {
            return Err(self.fault(node, "the axes are parallel"));
        };
        if !(angle.abs() < std::f64::consts::FRAC_PI_2) {
            let why = format!(
                "angle is out of range: {} degrees turn the first axis past the second one",
                m[0]
            );
            return Err(self.fault(node, why));
        }
        let shift = libm::tan(angle) - sine / cosine;
        Ok([0, 1, 2].map(|k| {
            let entry = |j: usize| f64::from(u8::from(j == k)) + shift * along[k] * across[j];
            [entry(0), entry(1), entry(2), 0.0]
        }))
    }

    /// Returns the placement of an eye that looks at a point along its negative z axis.
    fn lookat(&self, node: Node, m: &[f64]) -> Result<Transform, Fault> {
        let (eye, at, up) = ([m[0], m[1], m[2]], [m[3], m[4], m[5]], [m[6], m[7], m[8]]);
        let back = unit_vector([0, 1, 2].map(|k| eye[k] - at[k]));
        let side = back.and_then(|back| unit_vector(cross(&up, &back)));
        let (Some(z), Some(x)) = (back, side) else {
            return Err(self.fault(
                node,
                "the direction of view has no length or is parallel to the direction up",
            ));
        };
        let y = cross(&z, &x);
        Ok([0, 1, 2].map(|k| [x[k], y[k], z[k], eye[k]]))
    }

    /// Adds the transformed triangles of a geometry.
    fn geometry(&mut self, node: Node<'a, 'a>, place: &Transform) -> Result<(), Fault> {
        if !is(&node, "geometry") {
            return Err(self.fault(node, "the element is not a geometry"));
        }
        let name = node.attribute("name").or(node.attribute("id")).unwrap_or_default();
        let mut object = ObjectBuilder::new(name);
        // Corners of different lists of positions are different points of the object.
        let mut lists: Vec<(Node, Positions)> = Vec::new();
        for mesh in elements_of(node) {
            match mesh.tag_name().name() {
                "mesh" => {}
                "convex_mesh" if mesh.attribute("convex_hull_of").is_none() => {}
                "asset" | "extra" => continue,
                other => return Err(self.unsupported(mesh, format!("a geometry of kind <{other}>"))),
            }
            for primitive in elements_of(mesh) {
                match primitive.tag_name().name() {
                    "triangles" | "polylist" | "polygons" | "tristrips" | "trifans" => {
                        let vertices = self.vertices(primitive)?;
                        let known = lists.iter().position(|(known, _)| *known == vertices);
                        let list = match known {
                            Some(list) => list,
                            None => {
                                lists.push((vertices, self.positions(vertices)?));
                                lists.len() - 1
                            }
                        };
                        self.primitive(primitive, list, &lists[list].1, place, &mut object)?;
                    }
                    "lines" | "linestrips" => self.skipped.add(self.line(primitive), "lines"),
                    "source" | "vertices" | "extra" => {}
                    _ => return Err(self.unknown(primitive)),
                }
            }
        }
        self.objects.push(object.build());
        Ok(())
    }

    /// Returns the element `vertices` of a primitive.
    fn vertices(&self, node: Node<'a, 'a>) -> Result<Node<'a, 'a>, Fault> {
        let vertex = elements_of(node).find(|n| is(n, "input") && n.attribute("semantic") == Some("VERTEX"));
        let vertex = vertex.ok_or_else(|| self.fault(node, "no input has the semantic VERTEX"))?;
        self.named(vertex, "source")
    }

    /// Returns the positions of an element `vertices`.
    fn positions(&self, vertices: Node<'a, 'a>) -> Result<Positions, Fault> {
        let input = elements_of(vertices).find(|n| n.attribute("semantic") == Some("POSITION"));
        let input = input.ok_or_else(|| self.fault(vertices, "no input has the semantic POSITION"))?;
        let source = self.named(input, "source")?;
        let child = |name: &'static str| source.descendants().find(move |n| is(n, name));
        let array = match child("accessor").and_then(|a| self.named(a, "source").ok()) {
            Some(array) if is(&array, "float_array") => array,
            _ => child("float_array").ok_or_else(|| self.fault(source, "element float_array does not exist"))?,
        };
        let numbers = self.numbers(array)?;
        let number = |node: Node, name: &str, default: usize| match node.attribute(name) {
            None => Ok(default),
            Some(word) => word.trim().parse::<usize>().map_err(|_| {
                self.fault(
                    node,
                    format!("invalid {name}: {word:?} (expected a number that is not negative)"),
                )
            }),
        };
        let count = number(array, "count", numbers.len())?;
        if count != numbers.len() {
            let why = format!("count is {count}, but the element has {} numbers", numbers.len());
            return Err(self.fault(array, why));
        }
        let mut axes = [0, 1, 2];
        let (mut offset, mut stride, mut count) = (0, 3, numbers.len() / 3);
        if let Some(accessor) = child("accessor") {
            offset = number(accessor, "offset", 0)?;
            let params: Vec<Node> = elements_of(accessor).filter(|n| is(n, "param")).collect();
            stride = number(accessor, "stride", params.len().max(1))?;
            // A parameter without a name is a number that is not used.
            let named = (0..params.len()).filter(|&k| params[k].attribute("name").is_some_and(|n| !n.is_empty()));
            let named: Vec<usize> = named.collect();
            match named[..] {
                [x, y, z, ..] => axes = [x, y, z],
                _ if params.len() < 3 || params.iter().all(|p| p.attribute("name").is_none()) => {}
                _ => return Err(self.fault(accessor, format!("{} parameters have names (expected 3)", named.len()))),
            }
            if stride <= axes[2] {
                let why = format!("stride is out of range: {stride} (expected more than {})", axes[2]);
                return Err(self.fault(accessor, why));
            }
            let holds = (numbers.len().saturating_sub(offset) + stride - 1 - axes[2]) / stride;
            count = number(accessor, "count", holds)?;
            if count > holds {
                let why = format!("count is out of range: {count} (the array has {holds} points)");
                return Err(self.fault(accessor, why));
            }
        }
        Ok(Positions {
            numbers,
            count,
            offset,
            stride,
            axes,
        })
    }

    /// Adds the triangles of a primitive.
    fn primitive(
        &mut self,
        node: Node<'a, 'a>,
        list: usize,
        positions: &Positions,
        place: &Transform,
        object: &mut ObjectBuilder,
    ) -> Result<(), Fault> {
        let mut polygons: Vec<(Node, Vec<Vec<u64>>)> = Vec::new();
        let counts: Option<Vec<usize>> = match elements_of(node).find(|n| is(n, "vcount")) {
            Some(counts) => Some(self.indices(counts)?),
            None => None,
        };
        for child in elements_of(node) {
            match child.tag_name().name() {
                "p" => {
                    let corners = self.corners(node, child, positions.count)?;
                    self.cut(node, child, corners, counts.as_deref(), &mut polygons)?;
                }
                "ph" => {
                    let mut rings = Vec::new();
                    for ring in elements_of(child) {
                        if !is(&ring, "p") && !is(&ring, "h") {
                            return Err(self.unknown(ring));
                        }
                        rings.push(self.corners(node, ring, positions.count)?);
                    }
                    polygons.push((child, rings));
                }
                "input" | "vcount" | "extra" => {}
                _ => return Err(self.unknown(child)),
            }
        }
        let is_strip = ["tristrips", "trifans"].contains(&node.tag_name().name());
        if let Some(word) = node.attribute("count").filter(|_| !is_strip)
            && word.trim().parse::<usize>().ok() != Some(polygons.len())
        {
            let why = format!("count is {word}, but the element has {}", polygons.len());
            return Err(self.fault(node, why));
        }
        let is_mirrored = determinant(place) < 0.0;
        let point = |corner: u64| transformed(place, positions.point((corner & 0xffff_ffff) as usize));
        for (child, rings) in polygons {
            if rings
                .iter()
                .flatten()
                .any(|&corner| point(corner).iter().any(|x| !x.is_finite()))
            {
                return Err(self.fault(child, "a position is not finite"));
            }
            let different: HashSet<u64> = rings.first().into_iter().flatten().copied().collect();
            if different.len() < 3 {
                self.skipped.add(self.line(child), "faces of fewer than three points");
                continue;
            }
            let slices: Vec<&[u64]> = rings.iter().map(Vec::as_slice).collect();
            let mut triangles = polygon::triangulate(&slices, point).map_err(|why| self.fault(child, why))?;
            if triangles.is_empty() {
                self.skipped.add(self.line(child), "faces without area");
            }
            if is_mirrored {
                triangles.iter_mut().for_each(|t| t.swap(1, 2));
            }
            for triangle in triangles {
                let triangle = triangle.map(|corner| corner | (list as u64) << 32);
                let added = object.triangle(triangle, point);
                added.ok_or_else(|| self.fault(child, "too many points for 32-bit indices"))?;
            }
        }
        Ok(())
    }

    /// Returns the vertex indices of a list of corners.
    fn corners(&self, primitive: Node, list: Node, count: usize) -> Result<Vec<u64>, Fault> {
        let offset = |n: Node| match n.attribute("offset").map(str::trim) {
            None => Ok(0),
            Some(word) => word
                .parse::<u8>()
                .map(usize::from)
                .map_err(|_| self.fault(n, format!("invalid offset: {word:?} (expected 0..=255)"))),
        };
        let (mut stride, mut vertex) = (1, 0);
        for input in elements_of(primitive).filter(|n| is(n, "input")) {
            // Indices per corner: one more than the greatest offset of an input.
            stride = stride.max(offset(input)? + 1);
            if input.attribute("semantic") == Some("VERTEX") {
                vertex = offset(input)?;
            }
        }
        let indices = self.indices(list)?;
        if indices.len() % stride != 0 {
            let why = format!(
                "{} indices are no multiple of {stride}, the indices per corner",
                indices.len()
            );
            return Err(self.fault(list, why));
        }
        let corners: Vec<u64> = indices
            .into_iter()
            .skip(vertex)
            .step_by(stride)
            .map(|k| k as u64)
            .collect();
        match corners.iter().find(|k| **k >= count as u64) {
            Some(k) => Err(self.fault(list, format!("vertex {k} does not exist (expected less than {count})"))),
            None => Ok(corners),
        }
    }

    /// Cuts a list of corners into the polygons of its primitive.
    fn cut(
        &self,
        primitive: Node,
        list: Node<'a, 'a>,
        corners: Vec<u64>,
        counts: Option<&[usize]>,
        polygons: &mut Vec<(Node<'a, 'a>, Vec<Vec<u64>>)>,
    ) -> Result<(), Fault> {
        let mut add = |ring: &[u64]| polygons.push((list, vec![ring.to_vec()]));
        match primitive.tag_name().name() {
            "triangles" if !corners.len().is_multiple_of(3) => {
                let why = format!("{} corners are no multiple of 3", corners.len());
                return Err(self.fault(list, why));
            }
            "triangles" => corners.chunks_exact(3).for_each(add),
            "tristrips" | "trifans" if corners.len() < 3 => {
                return Err(self.fault(list, format!("{} corners are fewer than 3", corners.len())));
            }
            "tristrips" => {
                for (k, t) in corners.windows(3).enumerate() {
                    // Every second triangle has the opposite orientation.
                    add(&if k % 2 == 0 {
                        [t[0], t[1], t[2]]
                    } else {
                        [t[1], t[0], t[2]]
                    });
                }
            }
            "trifans" => corners[1..].windows(2).for_each(|t| add(&[corners[0], t[0], t[1]])),
            "polylist" => {
                let counts = counts.ok_or_else(|| self.fault(primitive, "element vcount does not exist"))?;
                let needed = counts.iter().try_fold(0usize, |sum, n| sum.checked_add(*n));
                if needed != Some(corners.len()) {
                    let why = format!("the list has {} corners, but vcount needs other ones", corners.len());
                    return Err(self.fault(list, why));
                }
                let mut rest = &corners[..];
                for &count in counts {
                    let (ring, after) = rest.split_at(count);
                    add(ring);
                    rest = after;
                }
            }
            _ => add(&corners),
        }
        Ok(())
    }

    fn indices(&self, node: Node) -> Result<Vec<usize>, Fault> {
        let words = content(node);
        let indices = words.split_ascii_whitespace().map(|word| {
            let index = word.parse::<u32>().map(|k| k as usize);
            index.map_err(|_| self.fault(node, format!("invalid index: {word:?} (expected 0..=4294967295)")))
        });
        indices.collect()
    }

    /// Returns the numbers of an element; they may be NaN or infinite.
    fn numbers(&self, node: Node) -> Result<Vec<f64>, Fault> {
        let words = content(node);
        let numbers = words.split_ascii_whitespace().map(|word| {
            let number = word.parse::<f64>();
            number.map_err(|_| self.fault(node, format!("invalid number: {word:?}")))
        });
        numbers.collect()
    }
}

/// Returns the text of an element, with comments in between left out.
fn content(node: Node) -> String {
    let parts = node.children().filter(Node::is_text).filter_map(|n| n.text());
    parts.collect::<Vec<_>>().join(" ")
}

/// Returns the child elements of an element.
fn elements_of<'a>(node: Node<'a, 'a>) -> impl Iterator<Item = Node<'a, 'a>> + use<'a> {
    node.children().filter(Node::is_element)
}

/// Returns whether an element has a name, in the namespace of any version.
fn is(node: &Node, name: &str) -> bool {
    node.is_element() && node.tag_name().name() == name
}

fn dot(u: &[f64; 3], v: &[f64; 3]) -> f64 {
    u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
}

fn cross(u: &[f64; 3], v: &[f64; 3]) -> [f64; 3] {
    [
        u[1] * v[2] - u[2] * v[1],
        u[2] * v[0] - u[0] * v[2],
        u[0] * v[1] - u[1] * v[0],
    ]
}

/// Returns the unit vector of a direction; `None` if it has no length.
fn unit_vector(v: [f64; 3]) -> Option<[f64; 3]> {
    let largest = v.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    if !(largest > 0.0) {
        return None;
    }
    let scaled = v.map(|x| x / largest);
    let length = dot(&scaled, &scaled).sqrt();
    Some(scaled.map(|x| x / length))
}

/// Returns the rotation about an axis by an angle in radians.
///
/// For a quarter turn its entries are closer to whole numbers than those of a quaternion.
fn rotation(u: [f64; 3], angle: f64) -> Transform {
    let (sine, cosine) = libm::sincos(angle);
    let rest = 1.0 - cosine;
    let [xy, xz, yz] = [u[0] * u[1] * rest, u[0] * u[2] * rest, u[1] * u[2] * rest];
    let s = u.map(|x| x * sine);
    let diagonal = u.map(|x| x * x + (1.0 - x * x) * cosine);
    [
        [diagonal[0], xy - s[2], xz + s[1], 0.0],
        [xy + s[2], diagonal[1], yz - s[0], 0.0],
        [xz - s[1], yz + s[0], diagonal[2], 0.0],
    ]
}

fn product(a: &Transform, b: &Transform) -> Transform {
    a.map(|row| {
        let entry = |j: usize| row[0] * b[0][j] + row[1] * b[1][j] + row[2] * b[2][j];
        [entry(0), entry(1), entry(2), entry(3) + row[3]]
    })
}

fn transformed(place: &Transform, p: [f64; 3]) -> [f64; 3] {
    place.map(|row| row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3])
}

fn determinant(m: &Transform) -> f64 {
    let row = |k: usize| [m[k][0], m[k][1], m[k][2]];
    dot(&row(0), &cross(&row(1), &row(2)))
}
