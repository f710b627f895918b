//! Bodies that are not convex: triangles of a mesh, pieces of a compound, in the order of a tree.
//!
//! A part is the hull of some points of the body. Parts are sorted so that those with numbers in a
//! range, halved as often as one likes, are near each other: evidence names parts by such ranges.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;

use nalgebra::{Point3, Vector3};

use super::hull::StatedHull;
use super::scene::Body;
use crate::extremes::Extremes;
use lin_canny::polyhedron::ConvexPolyhedron;
use lin_canny::{Compound, Mesh, MeshKind, RelativePose, Tracker};

/// The points and the parts of a body that is not convex.
#[derive(Clone, Debug)]
pub(super) struct StatedParts {
    pub(super) points: Vec<Point3<f64>>,
    pub(super) parts: Vec<Vec<usize>>,
    /// The parts are triangles, and what they enclose belongs to the body.
    pub(super) is_solid: bool,
    pub(super) radius: f64,
    /// What the parts are, if they are larger than the body.
    pub(super) around: Option<&'static str>,
}

impl StatedParts {
    pub(super) fn of_mesh(mesh: &Mesh) -> Self {
        let triangles = mesh.triangle_vertices().into_iter();
        let stated = Self {
            points: mesh.vertices(),
            parts: triangles.map(|t| t.map(|k| k as usize).to_vec()).collect(),
            is_solid: mesh.kind() == MeshKind::Solid,
            radius: 0.0,
            around: None,
        };
        stated.sorted()
    }

    /// Returns the pieces, or `None` if one has no polyhedron around it. All pieces get the greatest
    /// radius.
    pub(super) fn of_compound(compound: &Compound) -> Option<Self> {
        let (mut points, mut parts, mut radii, mut around) = (Vec::new(), Vec::new(), Vec::new(), None);
        for piece in compound.pieces() {
            let stated = StatedHull::of_shape(&piece.shape)?;
            let first = points.len();
            points.extend(stated.hull.vertex_points().map(|p| piece.pose * p));
            parts.push((first..points.len()).collect());
            radii.push(stated.radius);
            around = around.or(stated.around.map(|_| "curved pieces in polyhedra of 32 sides"));
        }
        let radius = radii.iter().copied().fold(0.0, f64::larger);
        if radii.iter().any(|other| *other != radius) {
            around = Some("all pieces with the greatest radius");
        }
        let stated = Self {
            points,
            parts,
            is_solid: false,
            radius,
            around,
        };
        Some(stated.sorted())
    }

    fn sorted(mut self) -> Self {
        let middle = |part: &Vec<usize>| {
            let sum: Vector3<f64> = part.iter().map(|k| self.points[*k].coords).sum();
            sum / part.len() as f64
        };
        let mut middles: Vec<(Vector3<f64>, Vec<usize>)> =
            self.parts.into_iter().map(|part| (middle(&part), part)).collect();
        sort(&mut middles);
        self.parts = middles.into_iter().map(|x| x.1).collect();
        self
    }
}

/// Returns where a range of parts is cut.
pub(super) fn half([low, high]: [usize; 2]) -> usize {
    low + (high - low) / 2
}

/// Sorts parts such that the lower and the upper half are apart along the longest axis, and so on.
fn sort(parts: &mut [(Vector3<f64>, Vec<usize>)]) {
    if parts.len() < 2 {
        return;
    }
    let first = parts[0].0;
    let [low, high] = parts.iter().fold([first; 2], |[low, high], (p, _)| {
        [low.zip_map(p, f64::smaller), high.zip_map(p, f64::larger)]
    });
    let axis = (high - low).imax();
    let middle = half([0, parts.len()]);
    parts.select_nth_unstable_by(middle, |x, y| {
        x.0[axis].total_cmp(&y.0[axis]).then_with(|| x.1.cmp(&y.1))
    });
    let (lower, upper) = parts.split_at_mut(middle);
    sort(lower);
    sort(upper);
}

/// Some parts of a body: their hull, and which point of the body each of its vertices is.
#[derive(Debug)]
pub(super) struct Group {
    pub(super) hull: Arc<ConvexPolyhedron>,
    pub(super) points: Vec<usize>,
    pub(super) vertices: Vec<Vector3<f64>>,
    /// Diagonal of the box.
    pub(super) size: f64,
}

impl Group {
    fn new(body: &Body, [low, high]: [usize; 2]) -> Option<Self> {
        if body.parts.is_empty() {
            return Self::of_hull(body.hull.clone(), (0..body.points.len()).collect());
        }
        let mut named: Vec<usize> = body.parts.get(low..high)?.iter().flatten().copied().collect();
        named.sort_unstable();
        named.dedup();
        let cloud: Vec<Point3<f64>> = named.iter().map(|k| body.points[*k]).collect();
        let hull = hull_of(&cloud)?;
        let mut numbers = BTreeMap::new();
        let key = |p: &Point3<f64>| [p.x, p.y, p.z].map(|x| (x + 0.0).to_bits());
        for (k, p) in named.iter().zip(&cloud) {
            numbers.entry(key(p)).or_insert(*k);
        }
        let points: Option<Vec<usize>> = hull.vertex_points().map(|p| numbers.get(&key(&p)).copied()).collect();
        Self::of_hull(Arc::new(hull), points?)
    }

    fn of_hull(hull: Arc<ConvexPolyhedron>, points: Vec<usize>) -> Option<Self> {
        let vertices: Vec<Vector3<f64>> = hull.vertex_points().map(|p| p.coords).collect();
        let first = *vertices.first()?;
        let [low, high] = vertices.iter().fold([first; 2], |[low, high], p| {
            [low.zip_map(p, f64::smaller), high.zip_map(p, f64::larger)]
        });
        Some(Self {
            hull,
            points,
            vertices,
            size: (high - low).norm(),
        })
    }
}

/// Returns the hull of a cloud, flat or not.
pub(super) fn hull_of(cloud: &[Point3<f64>]) -> Option<ConvexPolyhedron> {
    let first = *cloud.first()?;
    let far = |from: Point3<f64>| {
        let each = cloud.iter().copied();
        each.max_by(|p, q| (p - from).norm_squared().total_cmp(&(q - from).norm_squared()))
    };
    let end = far(first)?;
    let (start, flat) = (far(end)?, ConvexPolyhedron::polygon(cloud));
    let full = flat.or_else(|_| ConvexPolyhedron::from_points(cloud));
    let line = full.or_else(|_| ConvexPolyhedron::segment(start, end));
    line.or_else(|_| ConvexPolyhedron::point(first)).ok()
}

/// The groups of a body that were made already.
pub(super) struct Groups<'a> {
    body: &'a Body,
    known: RefCell<BTreeMap<[usize; 2], Option<Rc<Group>>>>,
}

impl<'a> Groups<'a> {
    pub(super) fn new(body: &'a Body) -> Self {
        let known = RefCell::default();
        Self { body, known }
    }

    /// Returns all parts of the body.
    pub(super) fn all(&self) -> [usize; 2] {
        [0, self.body.parts.len()]
    }

    pub(super) fn get(&self, range: [usize; 2]) -> Option<Rc<Group>> {
        let mut known = self.known.borrow_mut();
        let group = known
            .entry(range)
            .or_insert_with(|| Group::new(self.body, range).map(Rc::new));
        group.clone()
    }
}

/// Appends pairs of single parts that are at most `reach` apart, at most so many.
pub(super) fn near_parts(
    groups: &[Groups<'_>; 2],
    ranges: [[usize; 2]; 2],
    a_from_b: &RelativePose,
    reach: f64,
    most: usize,
    found: &mut Vec<[Rc<Group>; 2]>,
) {
    let (Some(x), Some(y)) = (groups[0].get(ranges[0]), groups[1].get(ranges[1])) else {
        return;
    };
    let far = Tracker::new().closest(&x.hull, &y.hull, a_from_b).lower > reach;
    if far || found.len() == most {
        return;
    }
    let is_cut = |side: usize| ranges[side][1] > ranges[side][0] + 1;
    let side = match [is_cut(0), is_cut(1)] {
        [false, false] => return found.push([x, y]),
        [true, true] => usize::from(y.size > x.size),
        [first, _] => usize::from(!first),
    };
    let [mut lower, mut upper] = [ranges; 2];
    let middle = half(ranges[side]);
    (lower[side][1], upper[side][0]) = (middle, middle);
    for ranges in [lower, upper] {
        near_parts(groups, ranges, a_from_b, reach, most, found);
    }
}
