//! glTF 2.0, as JSON and as GLB: the triangles, strips and fans of the meshes of a scene, in metres.
//!
//! Each node with a mesh becomes an object, transformed by its nodes in `f64`. The axis that is up
//! is Y by definition; points are not turned, as those of COLLADA are not. A skin is at rest: each
//! point is moved by its joints where the nodes of the file put them, and not by its own node. A
//! morph is its base mesh. Buffers are in the file, or in files of its folder.
//!
//! JSON has no lines here: errors name the element, such as `meshes[0].primitives[1]`. An unknown
//! property of an element of geometry is an error, because it may be a misspelt one. Extensions
//! that a file requires are errors, apart from those of [`HARMLESS`].
//! Source: glTF 2.0 specification, Khronos Group 2021.

mod buffer;
mod json;
mod mesh;

use std::collections::HashMap;
use std::path::Path;
use std::rc::Rc;

use crate::error::Fault;
use crate::mesh::{MeshFormat, MeshObject, SkippedList};
use crate::scene::{PlacedMesh, RawScene};
use crate::text;
use crate::transform::{self, IDENTITY, Matrix, from_rows, product};
use buffer::Buffers;
use json::Item;
use mesh::Meshes;

/// The extension that allows integers as positions.
const QUANTIZED: &str = "KHR_mesh_quantization";

/// Extensions that change no position.
const HARMLESS: [&str; 22] = [
    "EXT_texture_avif",
    "EXT_texture_webp",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "MSFT_texture_dds",
];

/// Largest difference of the square of the length of a rotation from 1.
const UNIT: f64 = 0.01;

/// Reads a glTF, whose buffers may be in files of the folder.
pub(crate) fn read(bytes: &[u8], folder: &Path) -> Result<RawScene, Fault> {
    let mut skipped = SkippedList::default();
    let (json, binary) = match bytes.starts_with(b"glTF") {
        true => buffer::chunks(bytes, &mut skipped)?,
        false => (bytes, None),
    };
    let value = json::parse(&text::decode(json))?;
    let root = Item::new(String::new(), &value)?;
    let mut reader = Reader {
        meshes: Meshes::new(Buffers::new(&root, folder, binary), skipped, bytes.len()),
        root,
        worlds: Vec::new(),
        parents: Vec::new(),
        children: Vec::new(),
        known: HashMap::new(),
        skins: HashMap::new(),
        bodies: Vec::new(),
        places: Vec::new(),
    };
    reader.check()?;
    let roots = reader.roots()?;
    reader.scene(roots)?;
    Ok(RawScene {
        format: MeshFormat::Gltf,
        meshes: reader.bodies,
        places: reader.places,
        left: reader.meshes.left,
        skipped: reader.meshes.skipped.build(),
    })
}

/// A file as far as it is read.
struct Reader<'a> {
    /// The whole file.
    root: Item<'a>,
    meshes: Meshes<'a>,
    /// The transform of each node into the scene.
    worlds: Vec<Matrix>,
    parents: Vec<Option<usize>>,
    children: Vec<Vec<usize>>,
    /// The place in `bodies` of each mesh of the file that is read.
    known: HashMap<usize, usize>,
    /// The transform of each joint of a skin: from the mesh into the scene.
    skins: HashMap<usize, Rc<Vec<Matrix>>>,
    /// The meshes without the transforms of nodes, and skins at rest.
    bodies: Vec<MeshObject>,
    places: Vec<PlacedMesh>,
}

impl<'a> Reader<'a> {
    /// Checks version and extensions, and lists what is no geometry.
    fn check(&mut self) -> Result<(), Fault> {
        let root = &self.root;
        let Some(asset) = root.object("asset")? else {
            return Err(root.malformed("has no asset (expected a glTF 2.0)"));
        };
        let version = asset.text("version")?.unwrap_or("");
        if version.split('.').next() != Some("2") {
            return Err(root.unsupported(format!("version {} of glTF", text::quoted(version))));
        }
        if let Some(least) = asset.text("minVersion")?.filter(|least| *least != "2.0") {
            return Err(root.unsupported(format!("version {} of glTF", text::quoted(least))));
        }
        for name in root.list("extensionsRequired")? {
            let Some(name) = name.as_str() else {
                return Err(root.malformed("has an invalid extensionsRequired (expected strings)"));
            };
            if name != QUANTIZED && !HARMLESS.contains(&name) {
                let shown: String = name.chars().take(50).collect();
                let what = format!("the required extension {shown:?}");
                return Err(root.unsupported(what));
            }
        }
        let mut used: Vec<&str> = root
            .list("extensionsUsed")?
            .iter()
            .filter_map(|name| name.as_str())
            .collect();
        self.meshes.is_quantized = used.contains(&QUANTIZED);
        used.retain(|name| *name != QUANTIZED);
        if !used.is_empty() {
            self.meshes
                .skipped
                .add(None, &format!("extensions: {}", used.join(", ")));
        }
        root.check_keys(&[
            "accessors",
            "animations",
            "asset",
            "buffers",
            "bufferViews",
            "cameras",
            "extensionsUsed",
            "extensionsRequired",
            "images",
            "materials",
            "meshes",
            "nodes",
            "samplers",
            "scene",
            "scenes",
            "skins",
            "textures",
        ])?;
        for key in ["animations", "cameras", "images", "materials", "textures"] {
            if root.has(key) {
                self.meshes.skipped.add(None, key);
            }
        }
        Ok(())
    }

    /// Reads the nodes, and returns the roots of the selected scene.
    fn roots(&mut self) -> Result<Vec<usize>, Fault> {
        let root = self.root.clone();
        let count = root.list("nodes")?.len();
        if count == 0 && root.has("meshes") {
            return Err(root.malformed("has meshes, but no nodes"));
        }
        let mut locals = Vec::with_capacity(count);
        let mut parents = vec![None; count];
        for (k, node) in root.elements("nodes")?.enumerate() {
            let node = node?;
            let children = node.indices("children", count)?;
            for child in &children {
                if parents[*child].replace(k).is_some() {
                    let why = format!("has a child that is a child already: nodes[{child}] (expected one parent)");
                    return Err(node.malformed(why));
                }
            }
            locals.push(local(&node)?);
            self.children.push(children);
        }
        let all: Vec<usize> = (0..count).filter(|&k| parents[k].is_none()).collect();
        // Parents come before children; nodes of a cycle come never.
        self.worlds = locals;
        let mut visited = vec![false; count];
        let mut stack = all.clone();
        while let Some(node) = stack.pop() {
            visited[node] = true;
            for &child in &self.children[node] {
                self.worlds[child] = product(&self.worlds[node], &self.worlds[child]);
                stack.push(child);
            }
        }
        if let Some(node) = visited.iter().position(|visited| !visited) {
            return Err(root
                .element("nodes", node)?
                .malformed("is inside itself (children form a cycle)"));
        }
        let scenes = root.list("scenes")?.len();
        if scenes > 1 {
            self.meshes.skipped.add(None, "scenes that are not selected");
        }
        let selected = match root.whole("scene")? {
            Some(selected) => root.element("scenes", selected)?,
            None if scenes > 0 => root.element("scenes", 0)?,
            None => {
                self.meshes.skipped.add(None, "missing scene (all root nodes are read)");
                self.parents = parents;
                return Ok(all);
            }
        };
        selected.check_keys(&["nodes"])?;
        let roots = selected.indices("nodes", count)?;
        let mut is_selected = vec![false; count];
        for &node in &roots {
            if parents[node].is_some() || std::mem::replace(&mut is_selected[node], true) {
                let why = format!("has an invalid node: {node} (expected root nodes, each once)");
                return Err(selected.malformed(why));
            }
        }
        if roots.len() < all.len() {
            self.meshes.skipped.add(None, "nodes outside the scene");
        }
        self.parents = parents;
        Ok(roots)
    }

    /// Adds the meshes of nodes and of all nodes below them.
    fn scene(&mut self, mut nodes: Vec<usize>) -> Result<(), Fault> {
        let root = self.root.clone();
        let mut is_placed = vec![false; root.list("meshes")?.len()];
        nodes.reverse();
        while let Some(index) = nodes.pop() {
            nodes.extend(self.children[index].iter().rev());
            let node = root.element("nodes", index)?;
            if node.extension("EXT_mesh_gpu_instancing")?.is_some() {
                return Err(node.unsupported("EXT_mesh_gpu_instancing"));
            }
            let Some(mesh) = node.whole("mesh")? else {
                continue;
            };
            self.put(&node, index, mesh)?;
            is_placed[mesh] = true;
        }
        if is_placed.contains(&false) {
            self.meshes.skipped.add(None, "meshes outside the scene");
        }
        Ok(())
    }

    /// Adds the mesh of a node.
    fn put(&mut self, node: &Item<'a>, index: usize, mesh: usize) -> Result<(), Fault> {
        let item = self.root.element("meshes", mesh)?;
        let weights = match node.numbers("weights")? {
            Some(weights) => Some(weights),
            None => item.numbers("weights")?,
        };
        self.meshes.spend(weights.as_ref().map_or(0, Vec::len), node)?;
        if weights.is_some_and(|weights| weights.iter().any(|weight| *weight != 0.0)) {
            return Err(node.unsupported("a morph with a weight other than 0"));
        }
        let (body, transform) = match node.whole("skin")? {
            Some(skin) => {
                self.meshes.skipped.add(None, "skins (meshes are at rest)");
                let joints = self.skin(skin)?;
                self.bodies.push(self.meshes.mesh(&item, Some(&joints))?);
                (self.bodies.len() - 1, IDENTITY)
            }
            None => {
                let body = match self.known.get(&mesh) {
                    Some(&known) => known,
                    None => {
                        self.bodies.push(self.meshes.mesh(&item, None)?);
                        self.bodies.len() - 1
                    }
                };
                self.known.insert(mesh, body);
                (body, self.worlds[index])
            }
        };
        if self.bodies[body].triangles.is_empty() {
            return Ok(());
        }
        let place = PlacedMesh {
            mesh: body,
            transform,
            path: self.path(index)?,
            name: node.text("name")?.unwrap_or_default().into(),
            line: None,
            element: node.path.clone(),
        };
        let bytes = size_of::<PlacedMesh>() + place.path.len() + place.name.len() + place.element.len();
        self.meshes.spend(bytes, node)?;
        self.places.push(place.checked()?);
        Ok(())
    }

    /// Returns the names of the nodes from the root to a node, with slashes between them.
    fn path(&mut self, index: usize) -> Result<String, Fault> {
        let mut names = Vec::new();
        let mut next = Some(index);
        while let Some(k) = next {
            let node = self.root.element("nodes", k)?;
            self.meshes.spend(size_of::<usize>(), &node)?;
            names.extend(node.text("name")?.filter(|name| !name.is_empty()));
            next = self.parents[k];
        }
        names.reverse();
        Ok(names.join("/"))
    }

    /// Returns the transforms of the joints of a skin: from the mesh to where the nodes are.
    fn skin(&mut self, index: usize) -> Result<Rc<Vec<Matrix>>, Fault> {
        if let Some(known) = self.skins.get(&index) {
            return Ok(known.clone());
        }
        let item = self.root.element("skins", index)?;
        item.check_keys(&["inverseBindMatrices", "joints", "skeleton"])?;
        let joints = item.indices("joints", self.worlds.len())?;
        let inverses = self.meshes.buffers.accessor(&item, "inverseBindMatrices")?;
        if let Some(inverses) = &inverses {
            let is_right = inverses.is_float() && inverses.width == 16 && inverses.count >= joints.len();
            if !is_right {
                let why = format!("is invalid (expected MAT4 of floats for {} joints)", joints.len());
                return Err(inverses.item.malformed(why));
            }
        }
        let mut transforms = Vec::with_capacity(joints.len());
        for (k, joint) in joints.into_iter().enumerate() {
            let inverse = match &inverses {
                Some(inverses) => from_columns(inverses.get(k)).ok_or_else(|| {
                    let why = format!("has an invalid matrix: {k} (expected 0 0 0 1 as last row)");
                    inverses.item.malformed(why)
                })?,
                None => IDENTITY,
            };
            transforms.push(product(&self.worlds[joint], &inverse));
        }
        let transforms = Rc::new(transforms);
        self.skins.insert(index, transforms.clone());
        Ok(transforms)
    }
}

/// Returns the transform of a node into its parent.
fn local(node: &Item) -> Result<Matrix, Fault> {
    node.check_keys(&[
        "camera",
        "children",
        "matrix",
        "mesh",
        "rotation",
        "scale",
        "skin",
        "translation",
        "weights",
    ])?;
    let parts = ["translation", "rotation", "scale"];
    if let Some(columns) = node.vector::<16>("matrix")? {
        if parts.iter().any(|part| node.has(part)) {
            return Err(node.malformed("has a matrix next to translation, rotation or scale (expected one)"));
        }
        return from_columns(columns).ok_or_else(|| node.invalid("matrix", "0 0 0 1 as last row"));
    }
    let mut all = transform::translation(node.vector("translation")?.unwrap_or_default());
    if let Some(rotation) = node.vector::<4>("rotation")? {
        let square: f64 = rotation.iter().map(|x| x * x).sum();
        let turn = transform::from_quaternion(rotation).filter(|_| (square - 1.0).abs() < UNIT);
        all = product(
            &all,
            &turn.ok_or_else(|| node.invalid("rotation", "a quaternion of length 1"))?,
        );
    }
    if let Some(scale) = node.vector("scale")? {
        all = product(&all, &transform::scaling(scale));
    }
    Ok(all)
}

/// Returns the matrix of 16 numbers, column by column; `None` if the last row is not `0 0 0 1` up to
/// rounding to `f32`.
fn from_columns(columns: [f64; 16]) -> Option<Matrix> {
    let mut rows: [f64; 16] = std::array::from_fn(|k| columns[4 * (k % 4) + k / 4]);
    for (entry, exact) in rows[12..].iter_mut().zip([0.0, 0.0, 0.0, 1.0]) {
        if (*entry - exact).abs() < 1e-6 {
            *entry = exact;
        }
    }
    from_rows(&rows)
}
