//! A robot from a URDF file: links as convex hulls of their collision geometry, joints as a table.

use std::path::{Path, PathBuf};

use lab::arm::Trouble;
use lab::meshes;
use lin_canny::ConvexPolyhedron;
use lin_canny::nalgebra::{Isometry3, Point3, Translation3, Unit, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use urdf_rs::{Geometry, JointType};

/// Vertices of the circles that stand for the circles of cylinders. The polygon lies inside: a cylinder of radius r is at
/// most 0.0022 r thinner than given.
const CIRCLE: usize = 48;

/// A link: its name, and the pieces of its collision geometry in the frame of the link.
pub(crate) struct Link {
    pub(crate) name: String,
    pub(crate) pieces: Vec<ConvexPolyhedron>,
}

/// A joint that moves one link against another, at the pose `origin` in the frame of the parent.
struct Joint {
    parent: usize,
    child: usize,
    origin: Isometry3<f64>,
    axis: Option<Unit<Vector3<f64>>>,
    slides: bool,
    limits: [f64; 2],
}

/// Links and joints, parents before children.
pub(crate) struct Robot {
    pub(crate) links: Vec<Link>,
    joints: Vec<Joint>,
}

impl Robot {
    /// Reads a URDF; `folder` is where its meshes are looked for.
    pub(crate) fn read(text: &str, folder: &Path) -> Result<Self, Trouble> {
        let robot = urdf_rs::read_from_string(text)?;
        let links = robot.links.iter().map(|link| {
            let pieces = link.collision.iter().map(|c| {
                let origin = pose(&c.origin);
                piece(&c.geometry, folder)?.transformed(&origin).map_err(Trouble::from)
            });
            let pieces = pieces.collect::<Result<Vec<_>, _>>();
            let pieces = pieces.map_err(|e| format!("link {}: {e}", link.name))?;
            Ok(Link {
                name: link.name.clone(),
                pieces,
            })
        });
        let links = links.collect::<Result<Vec<_>, Trouble>>()?;
        let number = |name: &str| {
            let found = links.iter().position(|link| link.name == name);
            found.ok_or_else(|| format!("a joint names link {name}, which does not exist"))
        };
        let mut joints = Vec::new();
        for j in &robot.joints {
            let axis = Unit::try_new(Vector3::from(*j.axis.xyz), 1e-9);
            let (moves, slides) = match j.joint_type {
                JointType::Revolute | JointType::Continuous => (true, false),
                JointType::Prismatic => (true, true),
                _ => (false, false),
            };
            let is_limited = j.limit.upper > j.limit.lower && j.limit.upper.is_finite() && j.limit.lower.is_finite();
            joints.push(Joint {
                parent: number(&j.parent.link)?,
                child: number(&j.child.link)?,
                origin: pose(&j.origin),
                axis: axis.filter(|_| moves),
                slides,
                limits: if is_limited {
                    [j.limit.lower, j.limit.upper]
                } else {
                    [-1.0, 1.0]
                },
            });
        }
        Self { links, joints }.sorted()
    }

    /// Puts parents before children.
    fn sorted(mut self) -> Result<Self, Trouble> {
        let mut placed: Vec<bool> = (0..self.links.len())
            .map(|k| !self.joints.iter().any(|j| j.child == k))
            .collect();
        let mut sorted = Vec::new();
        while let Some(next) = self.joints.iter().position(|j| placed[j.parent] && !placed[j.child]) {
            let joint = self.joints.remove(next);
            placed[joint.child] = true;
            sorted.push(joint);
        }
        if !self.joints.is_empty() {
            return Err("the joints are no tree".into());
        }
        self.joints = sorted;
        Ok(self)
    }

    /// The joints that move: their limits.
    pub(crate) fn limits(&self) -> Vec<[f64; 2]> {
        let moving = self.joints.iter().filter(|j| j.axis.is_some());
        moving.map(|j| j.limits).collect()
    }

    /// Whether one or two joints connect two links.
    pub(crate) fn are_close(&self, a: usize, b: usize) -> bool {
        let connected = |x: usize, y: usize| {
            let mut joints = self.joints.iter().map(|j| (j.parent, j.child));
            joints.any(|pair| pair == (x, y) || pair == (y, x))
        };
        connected(a, b) || (0..self.links.len()).any(|c| connected(a, c) && connected(c, b))
    }

    /// Poses of all links for the values of the joints that move, in the order of [`limits`](Self::limits).
    pub(crate) fn poses(&self, values: &[f64]) -> Vec<Isometry3<f64>> {
        let mut poses = vec![Isometry3::identity(); self.links.len()];
        let mut values = values.iter();
        for j in &self.joints {
            let moved = match (j.axis, j.slides) {
                (None, _) => Isometry3::identity(),
                (Some(axis), true) => Translation3::from(axis.scale(*values.next().unwrap_or(&0.0))).into(),
                (Some(axis), false) => Isometry3::from_parts(
                    Translation3::identity(),
                    UnitQuaternion::from_axis_angle(&axis, *values.next().unwrap_or(&0.0)),
                ),
            };
            poses[j.child] = lin_canny::normalize(&(poses[j.parent] * j.origin * moved));
        }
        poses
    }
}

fn pose(origin: &urdf_rs::Pose) -> Isometry3<f64> {
    let [roll, pitch, yaw] = *origin.rpy;
    Isometry3::from_parts(
        Translation3::from(Vector3::from(*origin.xyz)),
        UnitQuaternion::from_euler_angles(roll, pitch, yaw),
    )
}

/// The hull of one piece of collision geometry.
fn piece(geometry: &Geometry, folder: &Path) -> Result<ConvexPolyhedron, Trouble> {
    Ok(match geometry {
        Geometry::Box { size } => solids::cuboid(Vector3::from(**size) * 0.5)?,
        Geometry::Cylinder { radius, length } => solids::prism(CIRCLE, 0.5 * length, *radius)?,
        Geometry::Sphere { radius } => solids::geodesic_sphere(3, *radius)?,
        Geometry::Capsule { radius, length } => {
            let ball = solids::geodesic_sphere(2, *radius)?;
            let ends = [-0.5, 0.5].map(|s| Vector3::z() * (s * length));
            let points: Vec<_> = ends
                .iter()
                .flat_map(|end| ball.vertex_points().map(move |p| p + end))
                .collect();
            ConvexPolyhedron::from_points(&points)?
        }
        Geometry::Mesh { filename, scale } => {
            let scale = scale.map_or([1.0; 3], |s| *s);
            let points: Vec<_> = meshes::load(found(filename, folder))?.points;
            let scaled = points
                .iter()
                .map(|p| Point3::new(p[0] * scale[0], p[1] * scale[1], p[2] * scale[2]));
            ConvexPolyhedron::from_points(&scaled.collect::<Vec<_>>()).map_err(|e| format!("{filename}: {e}"))?
        }
    })
}

/// The file that a URDF names: `package://name/rest` is looked for as `name/rest` and `rest` in the folder of the URDF and
/// the folders above.
fn found(name: &str, folder: &Path) -> PathBuf {
    let plain = name.trim_start_matches("file://");
    let Some(inside) = plain.strip_prefix("package://") else {
        return folder.join(plain);
    };
    let rest = inside.split_once('/').map_or(inside, |(_, rest)| rest);
    let mut places = folder
        .ancestors()
        .flat_map(|above| [above.join(inside), above.join(rest)]);
    places.find(|p| p.exists()).unwrap_or_else(|| folder.join(rest))
}
