//! COLLADA 1.4 and 1.5: the triangles and polygons of the visual scene, in metres.
//!
//! Each instance of a geometry becomes an object, transformed by its nodes. The axis that is up is
//! left as it is, as in ROS tools, because files of robots are in the frame of their link. A skin
//! is at its rest pose: its points times `bind_shape_matrix`, transformed by the nodes of its
//! instance, not by its joints. A morph is its base mesh. Animations and physics are not read.
//! Source: COLLADA 1.4.1 and 1.5.0 specifications, Khronos Group 2008.

mod geometry;

use std::collections::HashMap;
use std::rc::Rc;

use roxmltree::NodeId;

use crate::error::Fault;
use crate::mesh::{MeshFormat, MeshObject};
use crate::scene::{PlacedMesh, RawScene};
use crate::transform::{self, IDENTITY, Matrix, from_rows, product};
use crate::xml::{Element, Text, Xml, children, elements, name, shown};
use geometry::Geometries;

/// Most nodes above each other, and most controllers in a row.
const DEPTH: usize = 1000;

/// Most bytes of objects that a file may have: so many, and so many for each of its bytes. A file
/// without repeated instances has fewer than the second.
const SCENE: (usize, usize) = (64 << 20, 40);

/// Reads a COLLADA file.
pub(crate) fn read(bytes: &[u8]) -> Result<RawScene, Fault> {
    let text = Text::new(bytes);
    let document = text.parse()?;
    let xml = Xml::new(&document, &text);
    let mut reader = Reader {
        xml: &xml,
        geometries: Geometries::new(&xml),
        nodes: HashMap::new(),
        bodies: Vec::new(),
        known: HashMap::new(),
        places: Vec::new(),
        left: bytes.len().saturating_mul(SCENE.1).saturating_add(SCENE.0),
    };
    reader.scenes()?;
    Ok(RawScene {
        format: MeshFormat::Collada,
        meshes: reader.bodies.iter().map(|body| (**body).clone()).collect(),
        places: reader.places,
        left: reader.left,
        skipped: reader.geometries.skipped.build(),
    })
}

/// A file as far as it is read. Everything is read once, however often the scene contains it.
struct Reader<'a> {
    xml: &'a Xml<'a>,
    geometries: Geometries<'a>,
    nodes: HashMap<NodeId, Rc<Contents<'a>>>,
    /// The geometries that the scene has, and the transform of each.
    bodies: Vec<Rc<MeshObject>>,
    known: HashMap<*const MeshObject, usize>,
    places: Vec<PlacedMesh>,
    /// Bytes of nodes and objects that may still follow.
    left: usize,
}

/// What a node contains, in the order of the file.
struct Contents<'a> {
    transform: Matrix,
    children: Vec<Child<'a>>,
}

enum Child<'a> {
    Node(Element<'a>),
    /// A geometry, the transform of its skin, and the element that puts it into the node.
    Body(Rc<MeshObject>, Matrix, Element<'a>),
}

/// A node on the way from the scene to the current instance.
struct Step<'a> {
    /// The transform from the node into the scene.
    transform: Matrix,
    /// The name, or else the id; empty for the scene itself.
    name: &'a str,
    contents: Rc<Contents<'a>>,
    /// The next child.
    next: usize,
}

impl<'a> Reader<'a> {
    /// Reads the scene; all scenes if the file selects none; all geometries if it has none.
    fn scenes(&mut self) -> Result<(), Fault> {
        let (xml, root) = (self.xml, self.xml.document.root_element());
        if name(root) != "COLLADA" {
            let why = format!("unknown root element: {} (expected COLLADA)", shown(name(root)));
            return Err(Fault::malformed(xml.line(root), why));
        }
        let version = root.attribute("version").unwrap_or("1.4");
        if !version.starts_with("1.4") && !version.starts_with("1.5") {
            return Err(xml.unsupported(root, format!("version {} of COLLADA", shown(version))));
        }
        for child in elements(root) {
            match name(child) {
                "asset"
                | "library_geometries"
                | "library_controllers"
                | "library_nodes"
                | "library_visual_scenes"
                | "scene" => {}
                other => self.geometries.skipped.add(xml.line(child), known_library(other)),
            }
        }
        let unit = self.unit()?;
        let mut selected = Vec::new();
        for child in children(root, "scene").flat_map(elements) {
            match name(child) {
                "instance_visual_scene" if selected.is_empty() => {
                    selected.push(xml.named(child, "url", &["visual_scene"])?);
                }
                "instance_visual_scene" => {
                    return Err(xml.malformed(child, "is there twice (expected one for the file)"));
                }
                _ => self
                    .geometries
                    .skipped
                    .add(xml.line(child), "physics, kinematics and extra of the scene"),
            }
        }
        let library = |of: &'static str, kind: &'static str| children(root, of).flat_map(move |l| children(l, kind));
        let all: Vec<_> = library("library_visual_scenes", "visual_scene").collect();
        let scenes = if selected.is_empty() { &all } else { &selected };
        if selected.is_empty() && all.len() > 1 {
            self.geometries
                .skipped
                .add(xml.line(all[0]), "missing choice of a scene (all are read)");
        }
        let is_left_out = |scene: &&Element| !selected.is_empty() && !selected.contains(scene);
        if let Some(left_out) = all.iter().find(is_left_out) {
            self.geometries
                .skipped
                .add(xml.line(*left_out), "visual scenes that are not selected");
        }
        for scene in scenes {
            self.scene(*scene, &unit)?;
        }
        if scenes.is_empty() {
            let mut placed = library("library_nodes", "node").chain(library("library_controllers", "controller"));
            if let Some(node) = placed.next() {
                return Err(xml.unsupported(node, format!("a {} in a file without a scene", name(node))));
            }
            self.geometries
                .skipped
                .add(None, "missing scene (all geometries are read)");
            for geometry in library("library_geometries", "geometry") {
                let body = self.geometries.geometry(geometry)?;
                self.put(&body, String::new(), &unit, geometry)?;
            }
        }
        for geometry in library("library_geometries", "geometry") {
            if !self.geometries.is_known(geometry) {
                self.geometries
                    .skipped
                    .add(xml.line(geometry), "geometries outside the scene");
            }
        }
        Ok(())
    }

    /// Returns the transform from the unit of the file into metres.
    fn unit(&mut self) -> Result<Matrix, Fault> {
        let (xml, root) = (self.xml, self.xml.document.root_element());
        let mut asset = children(root, "asset").flat_map(elements);
        if let Some(axis) = asset.find(|n| name(*n) == "up_axis" && n.text().is_none_or(|t| t.trim() != "Z_UP")) {
            self.geometries
                .skipped
                .add(xml.line(axis), "up_axis (points are not turned)");
        }
        let mut metres = None;
        for unit in xml
            .document
            .descendants()
            .filter(|n| n.is_element() && name(*n) == "unit")
        {
            let asset = unit.parent_element().filter(|n| name(*n) == "asset");
            match asset.and_then(|n| n.parent_element()) {
                Some(owner) if owner == root && metres.is_some() => {
                    return Err(xml.malformed(unit, "is there twice (expected one for the file)"));
                }
                Some(owner) if owner == root => {
                    let text = unit.attribute("meter").unwrap_or("1");
                    // Some exporters write numbers as in the language of their user.
                    let number = text.trim().replacen(',', ".", 1).parse().ok();
                    metres = number.filter(|x: &f64| x.is_finite() && *x > 0.0);
                    if metres.is_none() {
                        let why = format!("is invalid: {} (expected a positive number of metres)", shown(text));
                        return Err(xml.malformed(unit, why));
                    }
                }
                Some(_) => self
                    .geometries
                    .skipped
                    .add(xml.line(unit), "units outside the asset of the file"),
                None => {}
            }
        }
        Ok(transform::scaling([metres.unwrap_or(1.0); 3]))
    }

    /// Adds the objects of a visual scene: a walk through its nodes and those that they instance.
    fn scene(&mut self, scene: Element<'a>, unit: &Matrix) -> Result<(), Fault> {
        let mut path = vec![self.step(scene, unit)?];
        while let Some(step) = path.last_mut() {
            let (contents, next, transform) = (step.contents.clone(), step.next, step.transform);
            step.next += 1;
            match contents.children.get(next) {
                None => drop(path.pop()),
                Some(Child::Body(body, bind, instance)) => {
                    let names: Vec<_> = path.iter().map(|step| step.name).filter(|n| !n.is_empty()).collect();
                    self.put(body, names.join("/"), &product(&transform, bind), *instance)?;
                }
                Some(Child::Node(node)) => {
                    if path.len() >= DEPTH {
                        let why = format!("is nested more than {DEPTH} deep: node instances form a cycle");
                        return Err(self.xml.malformed(*node, why));
                    }
                    self.spend(size_of::<MeshObject>(), *node)?;
                    path.push(self.step(*node, &transform)?);
                }
            }
        }
        Ok(())
    }

    fn step(&mut self, node: Element<'a>, parent: &Matrix) -> Result<Step<'a>, Fault> {
        let contents = self.contents(node)?;
        let named = node.attribute("name").or(node.attribute("id")).unwrap_or_default();
        Ok(Step {
            transform: product(parent, &contents.transform),
            name: if name(node) == "node" { named } else { "" },
            contents,
            next: 0,
        })
    }

    /// Counts the bytes of nodes and objects.
    fn spend(&mut self, bytes: usize, node: Element) -> Result<(), Fault> {
        let left = self.left.checked_sub(bytes);
        self.left = left.ok_or_else(|| {
            self.xml
                .malformed(node, "makes the scene too large by repeated instances")
        })?;
        Ok(())
    }

    /// Adds a geometry with a transform.
    fn put(&mut self, body: &Rc<MeshObject>, path: String, transform: &Matrix, instance: Element) -> Result<(), Fault> {
        self.spend(size_of::<PlacedMesh>() + path.len(), instance)?;
        if body.triangles.is_empty() {
            return Ok(());
        }
        let mesh = *self.known.entry(Rc::as_ptr(body)).or_insert_with(|| {
            self.bodies.push(body.clone());
            self.bodies.len() - 1
        });
        let place = PlacedMesh {
            mesh,
            transform: *transform,
            path,
            name: String::new(),
            line: Some(self.xml.line(instance)),
            element: name(instance).into(),
        };
        self.places.push(place.checked()?);
        Ok(())
    }

    /// Returns what a node or a visual scene contains.
    fn contents(&mut self, node: Element<'a>) -> Result<Rc<Contents<'a>>, Fault> {
        if let Some(known) = self.nodes.get(&node.id()) {
            return Ok(known.clone());
        }
        let xml = self.xml;
        let (mut transform, mut found) = (IDENTITY, Vec::new());
        for child in elements(node) {
            match name(child) {
                "node" => found.push(Child::Node(child)),
                "instance_node" => found.push(Child::Node(xml.named(child, "url", &["node"])?)),
                "instance_geometry" => {
                    self.skip_materials(child);
                    let body = self.geometries.geometry(xml.named(child, "url", &["geometry"])?)?;
                    found.push(Child::Body(body, IDENTITY, child));
                }
                "instance_controller" => {
                    self.skip_materials(child);
                    let (body, bind) = self.controller(child)?;
                    found.push(Child::Body(body, bind, child));
                }
                "matrix" | "translate" | "rotate" | "scale" | "lookat" | "skew" if name(node) == "node" => {
                    transform = product(&transform, &self.transform(child)?);
                }
                "instance_camera" => self.geometries.skipped.add(xml.line(child), "cameras"),
                "instance_light" => self.geometries.skipped.add(xml.line(child), "lights"),
                "extra" => self.geometries.skipped.add(xml.line(child), "extra"),
                "evaluate_scene" | "asset" => {}
                _ => return Err(xml.unknown(child)),
            }
        }
        let contents = Rc::new(Contents {
            transform,
            children: found,
        });
        self.nodes.insert(node.id(), contents.clone());
        Ok(contents)
    }

    fn skip_materials(&mut self, instance: Element) {
        if let Some(material) = children(instance, "bind_material").next() {
            self.geometries.skipped.add(self.xml.line(material), "materials");
        }
    }

    /// Returns one transform of a node.
    fn transform(&mut self, node: Element<'a>) -> Result<Matrix, Fault> {
        let xml = self.xml;
        let numbers = xml.numbers(node)?;
        if let Some(k) = numbers.iter().position(|x| !x.is_finite()) {
            let why = format!("{} has a number that is not finite: {}", name(node), numbers[k]);
            return Err(Fault::malformed(xml.line_of_word(node, k), why));
        }
        let invalid = |rule: &str| xml.malformed(node, format!("is an invalid transform (expected {rule})"));
        match (name(node), &numbers[..]) {
            ("matrix", all) if all.len() == 16 => from_rows(all).ok_or_else(|| invalid("0 0 0 1 as last row")),
            ("translate", &[x, y, z]) => Ok(transform::translation([x, y, z])),
            ("scale", &[x, y, z]) => Ok(transform::scaling([x, y, z])),
            ("rotate", &[x, y, z, degrees]) => Ok(transform::rotation([x, y, z], degrees).unwrap_or_else(|| {
                self.geometries
                    .skipped
                    .add(xml.line(node), "rotate about an axis of length zero");
                IDENTITY
            })),
            ("lookat", &[a, b, c, d, e, f, g, h, i]) => transform::look_at([a, b, c], [d, e, f], [g, h, i])
                .ok_or_else(|| invalid("an eye away from its target, and up across the view")),
            ("skew", &[degrees, a, b, c, d, e, f]) => transform::skew(degrees, [a, b, c], [d, e, f])
                .ok_or_else(|| invalid("two perpendicular axes and less than 90 degrees")),
            (of, all) => {
                let expected = match of {
                    "matrix" => 16,
                    "lookat" => 9,
                    "skew" => 7,
                    "rotate" => 4,
                    _ => 3,
                };
                Err(xml.malformed(
                    node,
                    format!("is a transform of {} numbers (expected {expected})", all.len()),
                ))
            }
        }
    }

    /// Returns the geometry of an instance of a controller at rest, and its transform.
    fn controller(&mut self, instance: Element<'a>) -> Result<(Rc<MeshObject>, Matrix), Fault> {
        let xml = self.xml;
        if let Some(skeleton) = children(instance, "skeleton").next() {
            self.geometries
                .skipped
                .add(xml.line(skeleton), "skeletons (skins are at rest)");
        }
        let mut node = xml.named(instance, "url", &["controller"])?;
        let mut bind = IDENTITY;
        for _ in 0..DEPTH {
            let mut kinds = elements(node).filter(|child| !matches!(name(*child), "asset" | "extra"));
            let (Some(kind), None) = (kinds.next(), kinds.next()) else {
                return Err(xml.malformed(node, "has no skin or morph, or several (expected one)"));
            };
            match name(kind) {
                "skin" => bind = product(&bind, &self.skin(kind)?),
                "morph" => self.morph(kind)?,
                _ => return Err(xml.unknown(kind)),
            }
            node = xml.named(kind, "source", &["geometry", "controller"])?;
            if name(node) == "geometry" {
                return Ok((self.geometries.geometry(node)?, bind));
            }
        }
        Err(xml.malformed(node, "is inside itself: controllers form a cycle"))
    }

    /// Returns the transform of a skin.
    fn skin(&mut self, skin: Element<'a>) -> Result<Matrix, Fault> {
        let mut bind = IDENTITY;
        for child in elements(skin) {
            match name(child) {
                "bind_shape_matrix" => {
                    let numbers = self.xml.numbers(child)?;
                    let invalid = || {
                        let why = "is an invalid transform (expected 16 numbers, and 0 0 0 1 as last row)";
                        self.xml.malformed(child, why)
                    };
                    bind = from_rows(&numbers).ok_or_else(invalid)?;
                }
                "source" | "joints" | "vertex_weights" | "extra" => {}
                _ => return Err(self.xml.unknown(child)),
            }
        }
        Ok(bind)
    }

    /// Returns an error if a morph is not its base mesh.
    fn morph(&mut self, morph: Element<'a>) -> Result<(), Fault> {
        self.geometries.skipped.add(self.xml.line(morph), "morph targets");
        for child in elements(morph) {
            match name(child) {
                "targets" => {
                    let is_weight = |n: &Element| n.attribute("semantic") == Some("MORPH_WEIGHT");
                    for input in children(child, "input").filter(is_weight) {
                        let source = self.xml.named(input, "source", &["source"])?;
                        for array in children(source, "float_array") {
                            if self.geometries.array(array)?.iter().any(|weight| *weight != 0.0) {
                                return Err(self.xml.unsupported(array, "a morph with a weight other than 0"));
                            }
                        }
                    }
                }
                "source" | "extra" => {}
                _ => return Err(self.xml.unknown(child)),
            }
        }
        Ok(())
    }
}

/// Returns the name of a part of a file that contains no geometry of the scene.
fn known_library(name: &str) -> &'static str {
    const KNOWN: [&str; 16] = [
        "library_animations",
        "library_animation_clips",
        "library_articulated_systems",
        "library_cameras",
        "library_effects",
        "library_force_fields",
        "library_formulas",
        "library_images",
        "library_joints",
        "library_kinematics_models",
        "library_kinematics_scenes",
        "library_lights",
        "library_materials",
        "library_physics_materials",
        "library_physics_models",
        "library_physics_scenes",
    ];
    let known = KNOWN.into_iter().find(|known| *known == name);
    known.unwrap_or(if name == "extra" { "extra" } else { "unknown libraries" })
}
