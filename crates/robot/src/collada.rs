//! Meshes from COLLADA files: the triangles and polygons of the visual scene, in metres.
//!
//! Each geometry is transformed by its nodes. The `<up_axis>` is ignored, as in ROS tools, because
//! files of robots are in the frame of their link. Source: COLLADA 1.4.1 specification, Khronos
//! Group 2008.

use std::collections::HashMap;

use lin_canny::nalgebra::{Matrix4, Point3, Unit, Vector3};
use roxmltree::{Document, Node};

use crate::mesh_file::Soup;
use crate::turn::matrix_about;

/// Maximum number of node instances: a node that is an instance of itself never ends.
const PLACES: usize = 100_000;

/// Returns the geometries of a file, one for each instance.
pub(crate) fn read(text: &str) -> Result<Vec<Soup>, String> {
    let document = Document::parse(text).map_err(|e| format!("malformed COLLADA: {e}"))?;
    let file = File::new(&document)?;
    let mut found = Vec::new();
    let (mut waiting, mut places) = (file.roots()?, 0);
    while let Some((node, place)) = waiting.pop() {
        places += 1;
        if places > PLACES {
            return Err(file.told(node, "node instances form a cycle"));
        }
        let place = place * file.transform(node)?;
        for child in node.children().filter(Node::is_element) {
            match child.tag_name().name() {
                "node" => waiting.push((child, place)),
                "instance_node" => waiting.push((file.named(child, "url")?, place)),
                "instance_geometry" => file.geometry(file.named(child, "url")?, &place, &mut found)?,
                _ => {}
            }
        }
    }
    Ok(found)
}

/// A file, and its elements by id.
struct File<'a> {
    document: &'a Document<'a>,
    ids: HashMap<&'a str, Node<'a, 'a>>,
}

/// A node and the transform of its parent.
type Placed<'a> = (Node<'a, 'a>, Matrix4<f64>);

impl<'a> File<'a> {
    fn new(document: &'a Document<'a>) -> Result<Self, String> {
        if !is(&document.root_element(), "COLLADA") {
            return Err("malformed COLLADA: unknown root element (expected COLLADA)".into());
        }
        let elements = document.descendants();
        let ids = elements.filter_map(|n| Some((n.attribute("id")?, n))).collect();
        Ok(Self { document, ids })
    }

    /// Returns the error of an element.
    fn told(&self, node: Node, what: &str) -> String {
        let line = self.document.text_pos_at(node.range().start).row;
        format!("malformed COLLADA: line {line}: {}: {what}", node.tag_name().name())
    }

    /// Returns the element that an attribute refers to.
    fn named(&self, node: Node, attribute: &str) -> Result<Node<'a, 'a>, String> {
        let name = node.attribute(attribute).unwrap_or_default();
        let found = self.ids.get(name.trim_start_matches('#')).copied();
        found.ok_or_else(|| self.told(node, &format!("no element has this id: {name:?}")))
    }

    /// Returns the nodes of the scene in metres; of all scenes if the file selects none.
    fn roots(&self) -> Result<Vec<Placed<'a>>, String> {
        let element = |name: &'static str| self.document.descendants().filter(move |n| is(n, name));
        let unit = match element("unit").next() {
            Some(unit) => self.numbers(unit, unit.attribute("meter").unwrap_or("1"))?,
            None => Vec::new(),
        };
        let unit = unit.first().copied().unwrap_or(1.0);
        let place = Matrix4::new_scaling(unit);
        let scenes: Vec<_> = match element("instance_visual_scene").next() {
            Some(scene) => vec![self.named(scene, "url")?],
            None => element("visual_scene").collect(),
        };
        Ok(scenes.into_iter().map(|scene| (scene, place)).collect())
    }

    /// Returns the transform of a node: the product of its elements, in their order.
    fn transform(&self, node: Node<'a, 'a>) -> Result<Matrix4<f64>, String> {
        let mut all = Matrix4::identity();
        for child in node.children().filter(Node::is_element) {
            let name = child.tag_name().name();
            if !["matrix", "translate", "rotate", "scale", "lookat", "skew"].contains(&name) {
                continue;
            }
            let numbers = self.numbers(child, child.text().unwrap_or_default())?;
            all *= match (name, &numbers[..]) {
                ("matrix", all) if all.len() == 16 => Matrix4::from_row_slice(all),
                ("translate", &[x, y, z]) => Matrix4::new_translation(&Vector3::new(x, y, z)),
                ("scale", &[x, y, z]) => Matrix4::new_nonuniform_scaling(&Vector3::new(x, y, z)),
                ("rotate", &[x, y, z, degrees]) => {
                    let axis = Unit::try_new(Vector3::new(x, y, z), 0.0);
                    let axis = axis.ok_or_else(|| self.told(child, "rotation axis has no length"))?;
                    matrix_about(&axis, degrees.to_radians()).to_homogeneous()
                }
                _ => return Err(self.told(child, "unsupported or incomplete transform")),
            };
        }
        Ok(all)
    }

    /// Adds the transformed primitives of a geometry.
    fn geometry(&self, node: Node<'a, 'a>, place: &Matrix4<f64>, found: &mut Vec<Soup>) -> Result<(), String> {
        for mesh in node.children().filter(|n| is(n, "mesh")) {
            for primitive in mesh.children().filter(Node::is_element) {
                if !["triangles", "polylist", "polygons"].contains(&primitive.tag_name().name()) {
                    continue;
                }
                let mut soup = self.primitive(primitive)?;
                soup.points.iter_mut().for_each(|p| *p = place.transform_point(p));
                if place.fixed_view::<3, 3>(0, 0).determinant() < 0.0 {
                    soup.triangles.iter_mut().for_each(|t| t.swap(1, 2));
                }
                found.push(soup);
            }
        }
        Ok(())
    }

    /// Returns a primitive, with polygons divided into fans of triangles.
    fn primitive(&self, node: Node<'a, 'a>) -> Result<Soup, String> {
        let children = |name: &'static str| node.children().filter(move |n| is(n, name));
        let offset = |n: Node| n.attribute("offset").and_then(|o| o.parse::<usize>().ok()).unwrap_or(0);
        // Indices per vertex: one more than the greatest offset of an input.
        let stride = children("input").map(offset).max().unwrap_or(0).min(255) + 1;
        let vertex = children("input").find(|n| n.attribute("semantic") == Some("VERTEX"));
        let vertex = vertex.ok_or_else(|| self.told(node, "no input has the semantic VERTEX"))?;
        let points = self.points(self.named(vertex, "source")?)?;
        let mut triangles = Vec::new();
        let counts: Vec<usize> = match children("vcount").next() {
            Some(counts) => self.indices(counts)?,
            None => Vec::new(),
        };
        for list in children("p") {
            let corners: Vec<u32> = self
                .indices(list)?
                .into_iter()
                .skip(offset(vertex))
                .step_by(stride)
                .map(|k| k as u32)
                .collect();
            if corners.iter().any(|k| *k as usize >= points.len()) {
                return Err(self.told(
                    list,
                    &format!("a vertex index does not exist (expected less than {})", points.len()),
                ));
            }
            let mut rest = &corners[..];
            let mut fan = |polygon: &[u32]| {
                triangles.extend((2..polygon.len()).map(|k| [polygon[0], polygon[k - 1], polygon[k]]))
            };
            match node.tag_name().name() {
                "triangles" => rest.chunks_exact(3).for_each(fan),
                "polylist" => {
                    for count in &counts {
                        let Some((polygon, after)) = rest.split_at_checked(*count) else {
                            return Err(self.told(list, "fewer corners than `vcount` requires"));
                        };
                        fan(polygon);
                        rest = after;
                    }
                }
                _ => fan(rest),
            }
        }
        Ok(Soup { points, triangles })
    }

    /// Returns the positions of an element `vertices`.
    fn points(&self, vertices: Node<'a, 'a>) -> Result<Vec<Point3<f64>>, String> {
        let input = vertices
            .children()
            .find(|n| n.attribute("semantic") == Some("POSITION"));
        let input = input.ok_or_else(|| self.told(vertices, "no input has the semantic POSITION"))?;
        let source = self.named(input, "source")?;
        let child = |name: &'static str| source.descendants().find(move |n| is(n, name));
        let list = child("float_array").ok_or_else(|| self.told(source, "no element float_array"))?;
        let stride = child("accessor")
            .and_then(|a| a.attribute("stride")?.parse().ok())
            .unwrap_or(3);
        let numbers = self.numbers(list, list.text().unwrap_or_default())?;
        if stride < 3 {
            return Err(self.told(source, "stride of the positions is fewer than three"));
        }
        Ok(numbers
            .chunks_exact(stride)
            .map(|p| Point3::new(p[0], p[1], p[2]))
            .collect())
    }

    fn indices(&self, node: Node) -> Result<Vec<usize>, String> {
        let words = node.text().unwrap_or_default().split_ascii_whitespace();
        let read: Result<Vec<u32>, _> = words.map(str::parse).collect();
        let read = read.map_err(|e| self.told(node, &format!("not an index: {e}")))?;
        Ok(read.into_iter().map(|k| k as usize).collect())
    }

    fn numbers(&self, node: Node, text: &str) -> Result<Vec<f64>, String> {
        let read: Result<Vec<f64>, _> = text.split_ascii_whitespace().map(str::parse).collect();
        let read = read.map_err(|e| self.told(node, &format!("not a number: {e}")))?;
        let is_sound = read.iter().all(|x| x.is_finite());
        if is_sound {
            Ok(read)
        } else {
            Err(self.told(node, "a number is not finite"))
        }
    }
}

/// Returns whether an element has a name, in the namespace of any version.
fn is(node: &Node, name: &str) -> bool {
    node.is_element() && node.tag_name().name() == name
}
