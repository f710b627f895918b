//! Meshes over a frame: pairs of nodes of both trees that a direction parts at both ends, and the
//! first contact of the pairs of triangles that are left.

use alloc::vec;
use alloc::vec::Vec;
use nalgebra::{Isometry3, Matrix3, Point3, UnitQuaternion, Vector3};

use super::pair::{First, triangles_until};
use super::paths::Path;
use super::search::{FirstContact, SearchWork};
use super::{cast_of, measure, width};
use crate::base::num::scalar::sqrt;
use crate::base::pose::RelativePose;
use crate::base::tolerance::{CERTIFICATE, UNIT};
use crate::composite::front::NodePair;
use crate::composite::mesh::Mesh;
use crate::composite::tree::Below;
use crate::composite::tree::height::height;
use crate::pair::outcome::Class;
use crate::time::impact::{Cast, ImpactError, Tolerance};

/// A mesh at an end of a frame.
#[derive(Clone, Debug)]
struct MeshAtEnd<'a> {
    mesh: &'a Mesh,
    rotation: Matrix3<f64>,
    place: Vector3<f64>,
}

impl<'a> MeshAtEnd<'a> {
    fn new(mesh: &'a Mesh, pose: &Isometry3<f64>) -> Self {
        let rotation = *pose.rotation.to_rotation_matrix().matrix();
        let place = pose.translation.vector;
        Self { mesh, rotation, place }
    }

    fn point(&self, vertex: u32) -> Point3<f64> {
        let own = self.mesh.given(&self.mesh.points[vertex as usize]);
        Point3::from(self.rotation * own.coords + self.place)
    }

    /// Returns how far points are from the origin of the mesh's frame at most.
    fn radius(&self) -> f64 {
        self.mesh.radius * self.mesh.unit()
    }

    /// Returns an upper bound of the height of the points below a node.
    fn height(&self, node: u32, n: &Vector3<f64>) -> f64 {
        let own = self.rotation.tr_mul(n);
        height(&self.mesh.tree, node, &own) * self.mesh.unit() + n.dot(&self.place)
    }

    /// Returns the middle of the box of a node.
    fn middle(&self, node: u32) -> Vector3<f64> {
        let tree = &self.mesh.tree;
        let own = (tree.centre + tree.boxes[node as usize].centre() * tree.unit()) * self.mesh.unit();
        self.rotation * own + self.place
    }
}

/// A mesh from the begin of a frame to its end, for [`meshes`] and [`self_contact`]: the same
/// triangles, each vertex on a straight path at constant velocity in the frame of the mesh, and the
/// mesh at rest in that frame unless [`moving`](Self::moving) tells its poses.
#[derive(Clone, Debug)]
pub struct MeshOverFrame<'a> {
    ends: [MeshAtEnd<'a>; 2],
    /// How far a point may be from the straight path between its places at both ends.
    sagitta: f64,
}

impl<'a> MeshOverFrame<'a> {
    /// Takes a mesh as it is at the begin and as it is at the end: a clone from before
    /// [`set_vertices`](Mesh::set_vertices), and the mesh after. Both are the same for a body that
    /// does not bend.
    ///
    /// # Errors
    /// [`ImpactError::Mesh`] if both are not the same triangles in the same tree: other meshes, or
    /// [`rebuild`](Mesh::rebuild) was called in between.
    pub fn new(begin: &'a Mesh, end: &'a Mesh) -> Result<Self, ImpactError> {
        let is_same = begin.triangles == end.triangles
            && begin.source_triangles == end.source_triangles
            && begin.points.len() == end.points.len()
            && begin.tree.is_laid_out_as(&end.tree);
        if !is_same {
            return Err(ImpactError::Mesh);
        }
        let here = Isometry3::identity();
        Ok(Self {
            ends: [begin, end].map(|mesh| MeshAtEnd::new(mesh, &here)),
            sagitta: 0.0,
        })
    }

    /// Moves the mesh from one pose to another: its origin on a straight path, its rotation by the
    /// lesser angle about one axis, both at constant velocity.
    ///
    /// Places at both ends are rounded, within some 1e-15 of their size. Points of a body that
    /// rotates move on arcs: within `(r w^2 + 2 l w) / 8` of the straight paths, for a body of
    /// radius `r` about its origin that turns by `w` and whose vertices move by up to `l` in its
    /// frame. So much is taken off every gap; what comes nearer ends as
    /// [`Near`](crate::impact::Impact::Near). Half the time has a quarter of it.
    ///
    /// # Errors
    /// If a pose is refused as by [`RelativePose::new`](crate::RelativePose::new).
    pub fn moving(mut self, begin: &Isometry3<f64>, end: &Isometry3<f64>) -> Result<Self, ImpactError> {
        for pose in [begin, end] {
            RelativePose::from_isometry(pose)?;
        }
        let meshes = [self.ends[0].mesh, self.ends[1].mesh];
        let [begin, end] = [begin, end].map(|pose| {
            let rotation = UnitQuaternion::new_normalize(pose.rotation.into_inner());
            Isometry3::from_parts(pose.translation, rotation)
        });
        self.ends = [MeshAtEnd::new(meshes[0], &begin), MeshAtEnd::new(meshes[1], &end)];
        // Half the length of the chord of two quaternions is the sine of a quarter of the angle;
        // asin x <= x + (pi / 2 - 1) x^3 from zero to one.
        let (p, q) = (begin.rotation.coords, end.rotation.coords);
        let square = (p - q).norm_squared().min((p + q).norm_squared());
        let half = 0.5 * sqrt(square);
        let angle = 4.0 * half * (1.0 + 0.571 * half * half) * (1.0 + 16.0 * UNIT);
        if square > 0.0 {
            let radius = self.ends[0].radius().max(self.ends[1].radius());
            let [x, y] = meshes;
            let bent = x
                .points
                .iter()
                .zip(&y.points)
                .fold(0.0, |m: f64, (p, q)| m.max((y.given(q) - x.given(p)).amax()));
            // The largest coordinate of a vector, times the root of three.
            self.sagitta = angle * (radius * angle + 2.0 * 1.75 * bent) * 0.125 * (1.0 + 16.0 * UNIT);
        }
        Ok(self)
    }

    /// Returns the corners of a triangle as they move.
    fn paths(&self, triangle: u32) -> [Path; 3] {
        let corners = self.ends[0].mesh.triangles[triangle as usize];
        corners.map(|v| Path::new(self.ends[0].point(v), self.ends[1].point(v)))
    }

    fn source(&self, triangle: u32) -> u32 {
        self.ends[0].mesh.source_triangles[triangle as usize]
    }

    fn below(&self, node: u32) -> Below {
        self.ends[0].mesh.tree.below(node)
    }

    /// Returns upper bounds of the heights of the points below a node at both ends.
    fn heights(&self, node: u32, n: &Vector3<f64>) -> [f64; 2] {
        [0, 1].map(|k| self.ends[k].height(node, n))
    }

    /// Returns the largest coordinate of a point, or more.
    fn reach(&self) -> f64 {
        let of = |end: &MeshAtEnd| end.radius() + end.place.abs().sum();
        of(&self.ends[0]).max(of(&self.ends[1]))
    }

    /// Returns all vertices as they move.
    fn vertices(&self) -> Vec<Path> {
        let count = self.ends[0].mesh.points.len() as u32;
        let path = |v| Path::new(self.ends[0].point(v), self.ends[1].point(v));
        (0..count).map(path).collect()
    }

    fn radius_of(&self, node: u32) -> f64 {
        let mesh = self.ends[0].mesh;
        f64::from(mesh.tree.boxes[node as usize].radius()) * mesh.tree.unit() * mesh.unit()
    }
}

/// Returns the first contact of two meshes from the begin of a frame to its end, from time zero to
/// time one: of their surfaces.
///
/// [`Impact::Miss`](crate::impact::Impact::Miss) is a proof for every pair of triangles,
/// [`Impact::Hit`](crate::impact::Impact::Hit) a bracket of the first contact, with the triangles
/// that meet as pieces of the measure, whose bounds are of these two. A body that is inside
/// another, with no contact of the surfaces, is apart: ask [`PairTracker`](crate::PairTracker) at
/// the begin.
///
/// ```
/// use lin_canny::continuous::{self, MeshOverFrame};
/// use lin_canny::impact::{Impact, Tolerance};
/// use lin_canny::nalgebra::Point3;
/// use lin_canny::{Mesh, polyhedron::solids};
///
/// let ball = Mesh::from_convex(&solids::icosahedron(0.5)?)?;
/// let at = |x, y, z| Point3::new(x, y, z);
/// let corners =
///     [at(-2., -2., 1.), at(2., -2., 1.), at(2., 2., 1.), at(-2., 2., 1.)];
/// let before = Mesh::new(&corners, &[[0, 1, 2], [0, 2, 3]])?;
/// let mut cloth = before.clone();
/// // In one frame the cloth falls through the ball.
/// cloth.set_vertices(&corners.map(|p| at(p.x, p.y, -1.0)))?;
/// let cloth = MeshOverFrame::new(&before, &cloth)?;
/// let ball = MeshOverFrame::new(&ball, &ball)?;
/// let cast = continuous::meshes(&cloth, &ball, Tolerance::Time(1e-9))?;
/// let Impact::Hit { safe, hit, .. } = cast.impact else {
///     panic!("{:?}", cast.impact)
/// };
/// assert!(0.25 < safe && hit < 0.5 && hit - safe <= 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// If the tolerance is negative or not finite.
pub fn meshes(a: &MeshOverFrame, b: &MeshOverFrame, tolerance: Tolerance) -> Result<Cast, ImpactError> {
    let vertices = [a.vertices(), b.vertices()];
    let width = width(vertices.iter().flatten(), tolerance)?;
    Ok(FrameSearch::new([a, b], false, width).run())
}

/// Returns the first contact of a mesh with itself from the begin of a frame to its end: of two
/// triangles that share no vertex. Poses do not count.
///
/// # Errors
/// If the tolerance is negative or not finite.
pub fn self_contact(mesh: &MeshOverFrame, tolerance: Tolerance) -> Result<Cast, ImpactError> {
    let here = MeshOverFrame::new(mesh.ends[0].mesh, mesh.ends[1].mesh)?;
    let width = width(here.vertices().iter(), tolerance)?;
    Ok(FrameSearch::new([&here, &here], true, width).run())
}

/// Two meshes over a frame, or one and itself.
struct FrameSearch<'a> {
    a: &'a MeshOverFrame<'a>,
    b: &'a MeshOverFrame<'a>,
    is_self: bool,
    width: f64,
    /// What a gap along a unit direction must exceed: how far paths may be from straight ones.
    sagitta: f64,
    /// The same for nodes, with what rounding takes.
    doubt: f64,
    first: First,
    /// The triangles of the first contact, or of what is open, so far.
    pair: NodePair,
    work: SearchWork,
}

impl<'a> FrameSearch<'a> {
    fn new([a, b]: [&'a MeshOverFrame<'a>; 2], is_self: bool, width: f64) -> Self {
        let sagitta = a.sagitta + b.sagitta;
        // Heights of two nodes, the rotations of the direction, and the rounding of places: each
        // less than the error of a height.
        let rounding = 4.0 * CERTIFICATE * UNIT * (a.reach() + b.reach());
        Self {
            a,
            b,
            is_self,
            width,
            sagitta,
            doubt: sagitta * (1.0 + 16.0 * UNIT) + rounding,
            first: First::default(),
            pair: [0; 2],
            work: SearchWork::default(),
        }
    }

    /// Goes down both trees. Contacts found shorten the time for which the rest is asked.
    fn run(mut self) -> Cast {
        let mut open = vec![[0, 0]];
        while let Some([i, j]) = open.pop() {
            if self.first.is_start {
                break;
            }
            let is_itself = self.is_self && i == j;
            if !is_itself && self.is_parted([i, j]) {
                continue;
            }
            match (self.a.below(i), self.b.below(j)) {
                (Below::Children(c), _) if is_itself => open.extend([[c, c], [c + 1, c + 1], [c, c + 1]]),
                (Below::Leaf(first, count), Below::Leaf(other, others)) => {
                    for x in first..first + count {
                        (other..other + others).for_each(|y| self.ask([x, y]));
                    }
                }
                (Below::Children(c), Below::Children(_)) if self.a.radius_of(i) >= self.b.radius_of(j) => {
                    open.extend([[c, j], [c + 1, j]]);
                }
                (Below::Children(c), Below::Leaf(..)) => open.extend([[c, j], [c + 1, j]]),
                (_, Below::Children(c)) => open.extend([[i, c], [i, c + 1]]),
            }
        }
        self.told()
    }

    /// Returns until when the rest is asked: what is later changes nothing.
    fn until(&self) -> f64 {
        let First { safe, hit, .. } = self.first;
        (if self.sagitta > 0.0 { safe } else { hit }).min(1.0)
    }

    /// Returns whether a direction parts two nodes from the begin to the first contact known: at
    /// any instant the highest point of a node is no higher than the mean, by the time, of its
    /// highest points at the ends.
    fn is_parted(&mut self, [i, j]: NodePair) -> bool {
        self.work.intervals = self.work.intervals.saturating_add(1);
        let until = self.until();
        let [begin, end] = [0, 1].map(|k| self.b.ends[k].middle(j) - self.a.ends[k].middle(i));
        let way = begin + end;
        let parts = |n: &Vector3<f64>| {
            let ([a, c], [b, d]) = (self.a.heights(i, n), self.b.heights(j, &-n));
            let (first, last) = (-(a + b), -(c + d));
            first > self.doubt && first * (1.0 - until) + last * until > self.doubt
        };
        let along = |n: &Vector3<f64>| unit(n).is_some_and(|n| parts(&n));
        let turned = |n: Vector3<f64>| if n.dot(&way) < 0.0 { -n } else { n };
        let axes = |of: &MeshOverFrame, node: u32, end: usize| {
            let MeshAtEnd { mesh, rotation, .. } = &of.ends[end];
            let b = &mesh.tree.boxes[node as usize];
            [2, 1, 0].map(|k| rotation * b.axis(k))
        };
        let mut all = [
            axes(self.a, i, 0),
            axes(self.b, j, 0),
            axes(self.a, i, 1),
            axes(self.b, j, 1),
        ]
        .into_iter();
        along(&way) || along(&begin) || along(&end) || all.any(|axes| axes.into_iter().any(|n| along(&turned(n))))
    }

    /// Asks two triangles, unless they share a vertex of one mesh, or were asked.
    fn ask(&mut self, pair: NodePair) {
        let [x, y] = pair;
        if self.first.is_start {
            return;
        }
        if self.is_self {
            let [s, t] = pair.map(|k| self.a.ends[0].mesh.triangles[k as usize]);
            if x >= y || s.iter().any(|v| t.contains(v)) {
                return;
            }
        }
        let time = (self.until(), self.width);
        let (a, b) = (self.a.paths(x), self.b.paths(y));
        let found = triangles_until((&a, &b), self.sagitta, time, &mut self.work);
        let before = self.first;
        self.first.add(found);
        let is_first = match found {
            FirstContact::Miss => false,
            FirstContact::Start => true,
            FirstContact::Hit { hit, .. } => hit < before.hit,
            FirstContact::Open { safe } => before.hit > 1.0 && safe < before.safe,
        };
        if is_first {
            self.pair = pair;
        }
    }

    fn told(self) -> Cast {
        let [x, y] = self.pair;
        let (a, b) = (self.a.paths(x), self.b.paths(y));
        let pieces = [self.a.source(x), self.b.source(y)];
        let (sagitta, found) = (self.sagitta, self.first.found());
        let is_near = sagitta > 0.0 || !cfg!(feature = "exact");
        cast_of(found, &self.work, is_near, |time: f64, class: Class| {
            let mut seen = measure(&a, &b, time, class);
            seen.pieces = pieces;
            // Of these two triangles, and on straight paths.
            seen.lower = (seen.lower - sagitta).max(0.0);
            seen.upper += sagitta;
            seen
        })
    }
}

/// Returns the unit vector of a direction; `None` for a zero direction and for NaN.
fn unit(n: &Vector3<f64>) -> Option<Vector3<f64>> {
    let largest = n.amax();
    if !(largest > 0.0 && largest < f64::INFINITY) {
        return None;
    }
    // Twice, as a quotient of a subnormal number loses bits.
    let scaled = n / largest;
    Some(scaled / sqrt(scaled.norm_squared()))
}
