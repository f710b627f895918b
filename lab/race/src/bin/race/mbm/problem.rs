//! Problems of MotionBenchMaker: pairs of files `scene0001.yaml` and `request0001.yaml` of MoveIt.
//!
//! The conversion is exact: boxes, cylinders and spheres keep their sizes, and poses their numbers.
//! A pose is the pose of the object, if there is one, times that of the primitive. What the
//! conversion does not know (a mesh, an attached object, another primitive) is an error.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use lin_canny::nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use serde_json::{Value, json};

use super::yaml;

/// A problem: a scene, a start and a goal.
#[derive(Clone, Debug)]
pub(crate) struct Problem {
    /// Set, such as `cage`.
    pub(crate) set: String,
    /// Number in the set.
    pub(crate) index: u32,
    /// The obstacles, as the JSON of a cell.
    pub(crate) cell: String,
    /// Values by the names of joints: all that the start names.
    pub(crate) start: BTreeMap<String, f64>,
    /// The same, with those that the goal names.
    pub(crate) goal: BTreeMap<String, f64>,
}

/// Returns the problems of a robot in the order of sets and numbers: those of the folders
/// `SET_ROBOT` below `folder`, at most `most` of each.
///
/// # Errors
/// Returns an error that names the file, and the field that is missing or unknown.
pub(crate) fn load(folder: &Path, robot: &str, most: usize) -> Result<Vec<Problem>, String> {
    let mut problems = Vec::new();
    for set in names(folder)? {
        let below = folder.join(&set);
        if !below.is_dir() {
            continue;
        }
        let name = set.strip_suffix(&format!("_{robot}")).unwrap_or(&set);
        let numbers = names(&below)?.into_iter().filter_map(|file| {
            let number = file.strip_prefix("scene")?.strip_suffix(".yaml")?;
            Some((number.to_owned(), number.parse().ok()?))
        });
        for (number, index) in numbers.take(most) {
            let [scene, request] = ["scene", "request"].map(|kind| below.join(format!("{kind}{number}.yaml")));
            let (start, goal) = named(&request, ends)?;
            problems.push(Problem {
                set: name.to_owned(),
                index,
                cell: named(&scene, cell)?,
                start,
                goal,
            });
        }
    }
    match problems.is_empty() {
        true => Err(format!(
            "{}: no problems (expected folders with scene0001.yaml)",
            folder.display()
        )),
        false => Ok(problems),
    }
}

/// Returns the names in a folder, sorted.
fn names(folder: &Path) -> Result<Vec<String>, String> {
    let list = fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut all: Vec<String> = list
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .collect();
    all.sort();
    Ok(all)
}

/// Reads a file and converts it; errors name the file.
fn named<T>(file: &Path, convert: fn(&Value) -> Result<T, String>) -> Result<T, String> {
    let at = |e: String| format!("{}: {e}", file.display());
    let text = fs::read_to_string(file).map_err(|e| at(e.to_string()))?;
    let value = yaml::parse(&text).map_err(|(line, reason)| at(format!("line {line}: {reason}")))?;
    convert(&value).map_err(at)
}

/// Returns the obstacles of a scene as the JSON of a cell.
fn cell(scene: &Value) -> Result<String, String> {
    let attached = &scene["robot_state"]["attached_collision_objects"];
    if attached.as_array().is_some_and(|list| !list.is_empty()) {
        return Err("attached_collision_objects are not read".into());
    }
    let mut bodies = Vec::new();
    for object in list(&scene["world"], "collision_objects")? {
        let id = object["id"].as_str().ok_or("an object has no id")?;
        let of_object = |e: String| format!("object {id:?}: {e}");
        if let Some(kind) = ["meshes", "planes"].into_iter().find(|kind| is_filled(&object[*kind])) {
            return Err(of_object(format!("{kind} are not read")));
        }
        let base = match &object["pose"] {
            Value::Null => Isometry3::identity(),
            at => pose(at).map_err(of_object)?,
        };
        let poses = list(object, "primitive_poses").map_err(of_object)?;
        let primitives = list(object, "primitives").map_err(of_object)?;
        if poses.len() != primitives.len() {
            return Err(of_object("numbers of primitives and poses differ".into()));
        }
        for (k, (primitive, at)) in primitives.iter().zip(poses).enumerate() {
            let at = base * pose(at).map_err(of_object)?;
            let q = at.rotation.coords;
            let name = if primitives.len() == 1 {
                id.to_owned()
            } else {
                format!("{id}/{k}")
            };
            let mut body = json!({
                "name": name,
                "xyz": at.translation.vector.as_slice(),
                "xyzw": [q.x, q.y, q.z, q.w],
            });
            let (kind, solid) = solid(primitive).map_err(of_object)?;
            body[kind] = solid;
            bodies.push(body);
        }
    }
    Ok(json!({ "bodies": bodies }).to_string())
}

fn is_filled(list: &Value) -> bool {
    list.as_array().is_some_and(|list| !list.is_empty())
}

/// Returns the name and the sizes of a solid, in the words of a cell.
fn solid(primitive: &Value) -> Result<(&'static str, Value), String> {
    let sizes = numbers(&primitive["dimensions"], "dimensions")?;
    match (primitive["type"].as_str(), &sizes[..]) {
        (Some("box"), [x, y, z]) => Ok(("box", json!({"size": [x, y, z]}))),
        (Some("cylinder"), [length, radius]) => Ok(("cylinder", json!({"length": length, "radius": radius}))),
        (Some("sphere"), [radius]) => Ok(("sphere", json!({ "radius": radius }))),
        (kind, _) => Err(format!("primitive {kind:?} with {} sizes is not read", sizes.len())),
    }
}

fn pose(at: &Value) -> Result<Isometry3<f64>, String> {
    let (p, q) = (
        numbers(&at["position"], "position")?,
        numbers(&at["orientation"], "orientation")?,
    );
    match (&p[..], &q[..]) {
        ([x, y, z], [i, j, k, w]) if q.iter().any(|c| *c != 0.0) => Ok(Isometry3::from_parts(
            Translation3::new(*x, *y, *z),
            UnitQuaternion::new_normalize(Quaternion::new(*w, *i, *j, *k)),
        )),
        _ => Err("a pose is not 3 and 4 numbers".into()),
    }
}

/// Values of joints by name.
type Values = BTreeMap<String, f64>;

/// Returns the values of joints of start and goal.
fn ends(request: &Value) -> Result<(Values, Values), String> {
    let state = &request["start_state"]["joint_state"];
    let values = numbers(&state["position"], "position")?;
    let joints = list(state, "name")?;
    let start: Values = joints
        .iter()
        .zip(values)
        .filter_map(|(name, x)| Some((name.as_str()?.to_owned(), x)))
        .collect();
    let mut goal = start.clone();
    let first = &list(request, "goal_constraints")?[..];
    let first = first.first().ok_or("goal_constraints are empty")?;
    for joint in list(first, "joint_constraints")? {
        let found = joint["joint_name"].as_str().zip(joint["position"].as_f64());
        let (name, x) = found.ok_or("a joint constraint has no name or position")?;
        goal.insert(name.to_owned(), x);
    }
    Ok((start, goal))
}

fn list<'v>(value: &'v Value, field: &str) -> Result<&'v Vec<Value>, String> {
    value[field].as_array().ok_or_else(|| format!("{field} is missing"))
}

fn numbers(value: &Value, field: &str) -> Result<Vec<f64>, String> {
    let list = value.as_array().ok_or_else(|| format!("{field} is missing"))?;
    let all = list.iter().map(Value::as_f64).collect::<Option<Vec<f64>>>();
    all.ok_or_else(|| format!("{field}: a number is invalid"))
}
