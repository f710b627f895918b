//! Reader of the corpus of hard cases. `tests/corpus/README.md` defines the format.

use crate::pose::{norm, radius, sub};
use crate::shapes::{self, Shape};
use crate::verdict::{ContactState, Exact};
use crate::{Pose, exact};
use serde_json::Value;
use std::collections::HashSet;
use std::path::Path;

/// Two bodies at two poses with the exact values, or one frame of a motion.
#[derive(Clone, Debug)]
pub struct Case {
    /// Unique name; for a frame, the name of the motion and the number of the frame.
    pub name: String,
    /// Name of its file.
    pub family: String,
    /// Motion to which a frame belongs; its frames are in order.
    pub motion: Option<String>,
    /// The first body.
    pub a: Shape,
    /// The second body.
    pub b: Shape,
    /// World pose of A.
    pub pose_a: Pose,
    /// World pose of B.
    pub pose_b: Pose,
    /// Exact contact state.
    pub state: ContactState,
    /// Signed distance to the nearest double, for separated cases and for cases whose depth the
    /// oracle knows.
    pub distance: Option<f64>,
}

impl Case {
    /// Returns whether the exact oracle can judge the case quickly: bodies of at most `most`
    /// points, one of them solid.
    pub fn is_small(&self, most: usize) -> bool {
        let solid = |s: &Shape| s.points.len() > 3;
        self.a.points.len().max(self.b.points.len()) <= most && (solid(&self.a) || solid(&self.b))
    }

    /// Returns the result of the oracle.
    pub fn truth(&self) -> Exact {
        let faces = |s: &Shape| match s.points.len() {
            1 | 2 => s.clone(),
            // A triangle has two sides.
            3 => Shape {
                faces: vec![vec![0, 1, 2], vec![2, 1, 0]],
                ..s.clone()
            },
            _ => s.clone().solved(),
        };
        exact::solve(
            (&faces(&self.a)).into(),
            &self.pose_a,
            (&faces(&self.b)).into(),
            &self.pose_b,
        )
    }

    /// Returns the size L about the bodies' origins, which is at least the size about their
    /// centres.
    pub fn size(&self) -> f64 {
        radius(&self.a.points) + radius(&self.b.points) + norm(sub(self.pose_b.t, self.pose_a.t))
    }
}

fn text<'a>(v: &'a Value, key: &str) -> &'a str {
    v[key].as_str().unwrap_or_else(|| panic!("{key} is missing in {v}"))
}

fn numbers<const N: usize>(v: &Value) -> [f64; N] {
    let list: Vec<f64> = v
        .as_array()
        .map_or(vec![], |l| l.iter().filter_map(Value::as_f64).collect());
    list.try_into().unwrap_or_else(|_| panic!("{N} numbers expected: {v}"))
}

fn recipe(words: &str) -> Shape {
    let mut words = words.split(' ');
    let kind = words.next().unwrap_or_default();
    let x: Vec<f64> = words.map(|w| w.parse().expect("numbers follow the recipe")).collect();
    match (kind, &x[..]) {
        ("box", &[x, y, z]) => shapes::cuboid([x, y, z]),
        ("prism", &[n, r, h]) => shapes::prism(n as usize, r, h),
        ("cone", &[n, r, h]) => shapes::cone(n as usize, r, h),
        ("icosphere", &[level]) => shapes::icosphere(level as usize),
        ("icosahedron", []) => shapes::icosahedron(),
        ("octahedron", []) => shapes::octahedron(),
        ("tetrahedron", []) => shapes::tetrahedron(),
        ("dodecahedron", []) => shapes::dodecahedron(),
        ("roof", &[h]) => shapes::roof(h),
        ("lid", &[h]) => shapes::pyramid_lid(h),
        ("dome", &[k, h]) => shapes::dome(k as usize, h),
        ("grid", &[k]) => shapes::grid(k as usize),
        ("chamfered", &[x, y, z, c]) => shapes::chamfered([x, y, z], c),
        _ => panic!("unknown recipe {kind} {x:?}"),
    }
}

fn shape(v: &Value) -> Shape {
    match v.as_str() {
        Some(words) => recipe(words),
        None => Shape::hull(
            "points",
            v.as_array().expect("points").iter().map(numbers::<3>).collect(),
        ),
    }
}

fn pose(v: &Value) -> Pose {
    let q = v.get("q").map_or(Pose::IDENTITY.q, numbers::<4>);
    Pose::new(q, numbers(&v["t"]))
}

/// Returns a single case, or a frame of a motion: `at` holds poses and exact values.
fn case(v: &Value, at: &Value, family: &str, frame: Option<usize>) -> Case {
    let name = text(v, "name").to_owned();
    Case {
        name: frame.map_or(name.clone(), |k| format!("{name}/{k}")),
        family: family.to_owned(),
        motion: frame.map(|_| name),
        a: shape(&v["a"]),
        b: shape(&v["b"]),
        pose_a: at.get("pose_a").or(v.get("pose_a")).map_or(Pose::IDENTITY, pose),
        pose_b: at.get("pose_b").or(v.get("pose_b")).map_or(Pose::IDENTITY, pose),
        state: ContactState::from_word(text(at, "class")).expect("sep, touch or pen"),
        distance: at.get("distance").and_then(Value::as_f64),
    }
}

fn read(v: &Value, family: &str) -> Vec<Case> {
    assert!(!text(v, "origin").is_empty() && !text(v, "why").is_empty());
    match v.get("frames").and_then(Value::as_array) {
        None => vec![case(v, v, family, None)],
        Some(frames) => {
            let each = frames.iter().enumerate();
            each.map(|(k, at)| case(v, at, family, Some(k))).collect()
        }
    }
}

/// Returns all cases of a folder, ordered by file and position.
///
/// Panics, naming the file, on an invalid file: the corpus is part of the source.
pub fn load(folder: &Path) -> Vec<Case> {
    let list = std::fs::read_dir(folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display()));
    let mut files: Vec<_> = list.filter_map(|f| Some(f.ok()?.path())).collect();
    files.sort();
    let mut cases = vec![];
    for file in files.iter().filter(|f| f.extension().is_some_and(|e| e == "json")) {
        let fault = |e: &dyn std::fmt::Display| -> ! { panic!("{}: {e}", file.display()) };
        let text = std::fs::read_to_string(file).unwrap_or_else(|e| fault(&e));
        let list: Vec<Value> = serde_json::from_str(&text).unwrap_or_else(|e| fault(&e));
        let family = file.file_stem().unwrap_or_default().to_string_lossy();
        cases.extend(list.iter().flat_map(|v| read(v, &family)));
    }
    let names: HashSet<_> = cases.iter().map(|c| &c.name).collect();
    assert_eq!(names.len(), cases.len(), "names are unique");
    cases
}
