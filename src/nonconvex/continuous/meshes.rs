//! First contact of two meshes over a frame.
//!
//! 1. A search of both trees discards the node pairs that a direction separates at both ends of the
//!    time interval.
//! 2. The first contact of each remaining pair of triangles is computed.
//!
//! Triangles of rotating meshes deviate from straight paths by the sagitta of their arcs, which
//! shrinks with the square of the time interval ([`TrianglesOnArcs`]).

use crate::base::num::each::Each;
use crate::pair::draft::direction;
use alloc::vec;
use nalgebra::{Point3, Vector3};

use super::frame::{Moment, MovingMesh};
use super::height_field::HeightFields;
use super::paths::{VertexPath, VertexPaths, VertexPlaces, determinant};
use super::search::{First, FirstContact, LEAST_WIDTH, SearchWork, is_free, triangles_until};
use super::{cast_of, measure, search, width};
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::num::scalar::sqrt;
use crate::base::tolerance::{CERTIFICATE, PATH_VOLUME, UNIT};
use crate::nonconvex::front::NodePair;
use crate::nonconvex::tree::Below;
use crate::pair::outcome::ContactState;
use crate::time::impact::{Cast, ImpactError, Tolerance};

/// If a mesh rotates, the frame is searched in equal steps. The number of steps makes the sagitta
/// of a step at most `ARC_PART` times the half size of the smaller mesh, but it is at most
/// `ARC_STEPS + 1`.
const ARC_PART: f64 = 1.0 / 1024.0;
const ARC_STEPS: f64 = 64.0;

/// Returns the first contact of the surfaces of two meshes over a frame.
///
/// The frame is from time zero to time one. [`Impact::Miss`](crate::impact::Impact::Miss) is a
/// proof for every pair of triangles. [`Impact::Hit`](crate::impact::Impact::Hit) is a proven
/// interval of the first contact; its measurement names the triangles that meet, and its bounds are
/// those of these two. A body inside another counts as separated if the surfaces have no contact:
/// query [`PairTracker`](crate::PairTracker) at the start.
///
/// If a mesh rotates, a hit is proven for the motion itself: no contact up to `safe`, and at `hit`
/// an edge of one surface passes through a triangle of the other, beyond all rounding. The interval
/// is as narrow as requested if at its end the surfaces are about 1e-12 of their size deep in each
/// other, and wider otherwise. [`Impact::AtStart`](crate::impact::Impact::AtStart) holds for the
/// rounded positions at the start. [`Impact::Undecided`](crate::impact::Impact::Undecided) is
/// returned if surfaces touch without an edge that passes, if they come nearer than about 1e-12 of
/// their size, or if 1,024 intervals do not prove a pair of triangles separated. Then nothing is
/// known of later times.
///
/// ```
/// use lin_canny::continuous::{self, MovingMesh};
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
/// let cloth = MovingMesh::new(&before, &cloth)?;
/// let ball = MovingMesh::new(&ball, &ball)?;
/// let cast = continuous::cast_meshes(&cloth, &ball, Tolerance::Time(1e-9))?;
/// let Impact::Hit { safe, hit, .. } = cast.impact else {
///     panic!("{:?}", cast.impact)
/// };
/// assert!(0.25 < safe && hit < 0.5 && hit - safe <= 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Returns an error if the tolerance is negative or not finite.
pub fn cast_meshes(a: &MovingMesh, b: &MovingMesh, tolerance: Tolerance) -> Result<Cast, ImpactError> {
    let vertices = [a.vertices(), b.vertices()];
    let width = width(vertices.iter().flatten(), tolerance)?;
    if a.is_straight() && b.is_straight() {
        return Ok(FrameSearch::new([a, b], false, width).run());
    }
    let ([x, y], origin) = MovingMesh::beside(a, b)?;
    let search = FrameSearch::new([&x, &y], false, width);
    Ok(FrameSearch { origin, ..search }.run())
}

/// Returns the first contact of a mesh with itself over a frame.
///
/// Only triangles that share no vertex count. Poses have no effect.
///
/// # Errors
/// Returns an error if the tolerance is negative or not finite.
pub fn cast_self(mesh: &MovingMesh, tolerance: Tolerance) -> Result<Cast, ImpactError> {
    let [begin, end] = mesh.both();
    let here = MovingMesh::new(begin, end)?;
    let vertices = here.vertices();
    let width = width(vertices.iter(), tolerance)?;
    let fields = Some(HeightFields::new(&here, &vertices));
    let search = FrameSearch::new([&here, &here], true, width);
    Ok(FrameSearch { fields, ..search }.run())
}

/// Search for the first contact of two meshes over a frame, or of one mesh with itself.
struct FrameSearch<'a> {
    a: &'a MovingMesh<'a>,
    b: &'a MovingMesh<'a>,
    is_self: bool,
    /// Only for a mesh against itself.
    fields: Option<HeightFields<'a>>,
    width: f64,
    /// Origin of the coordinates in the world.
    origin: Vector3<f64>,
    /// The searched interval of the frame: both meshes at its start, and at its end.
    step: [[Moment; 2]; 2],
    /// Bound of the position errors of two points together; zero on straight paths.
    placed: f64,
    /// Bound of the distances of points of both meshes from straight paths over the frame,
    /// together.
    sagitta: f64,
    first: First,
    /// The triangles of the first contact found so far, or of an open pair if there is no contact.
    pair: NodePair,
    work: SearchWork,
}

impl<'a> FrameSearch<'a> {
    fn new([a, b]: [&'a MovingMesh<'a>; 2], is_self: bool, width: f64) -> Self {
        let is_straight = a.is_straight() && b.is_straight();
        let sagitta = |of: &MovingMesh| {
            if is_straight {
                0.0
            } else {
                of.sagitta(of.radius(), of.bend())
            }
        };
        Self {
            a,
            b,
            is_self,
            fields: None,
            width,
            origin: Vector3::zeros(),
            step: [0, 1].each(|k| [a.ends[k], b.ends[k]]),
            placed: if is_straight { 0.0 } else { placed(a, b) },
            sagitta: sagitta(a) + sagitta(b),
            first: First::default(),
            pair: [0; 2],
            work: SearchWork::default(),
        }
    }

    fn is_straight(&self) -> bool {
        self.placed == 0.0
    }

    /// Searches the frame in steps until a step has a contact or an open pair.
    ///
    /// The steps are short enough for the sagitta to be small compared with the meshes.
    fn run(mut self) -> Cast {
        let size = self.a.half_size().smaller(self.b.half_size());
        let wanted = sqrt(self.sagitta / (ARC_PART * size)).at_most(ARC_STEPS);
        let steps = if wanted > 1.0 { wanted as u32 + 1 } else { 1 };
        for k in 0..steps {
            if steps > 1 {
                self.step = [k, k + 1].each(|k| {
                    let time = f64::from(k) / f64::from(steps);
                    [self.a.moment(time), self.b.moment(time)]
                });
            }
            self.descend();
            if self.first.is_start || self.first.safe <= 1.0 {
                break;
            }
        }
        self.into_cast()
    }

    /// Searches both trees. Each contact found shortens the time that remains to be searched.
    fn descend(&mut self) {
        let mut open = vec![[0, 0]];
        while let Some([i, j]) = open.pop() {
            if self.first.is_start {
                break;
            }
            let is_itself = self.is_self && i == j;
            if !is_itself && self.is_parted([i, j]) || self.is_height_field([i, j]) {
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
    }

    /// Returns the start of the step, and its end or the first contact known. Later events have no
    /// effect.
    fn times(&self) -> [f64; 2] {
        let [begin, end] = self.step.each(|[a, _]| a.time);
        [begin, self.first.hit.smaller(end)]
    }

    /// Returns whether a direction separates two nodes from the start of the step to the first
    /// contact known.
    ///
    /// At any time, the support value of a node is at most the linear interpolation of its support
    /// values at both ends, plus the sagitta.
    fn is_parted(&mut self, [i, j]: NodePair) -> bool {
        self.work.intervals = self.work.intervals.saturating_add(1);
        let doubt = self.doubt();
        let [from, to] = &self.step;
        let [begin, end] = [from, to].each(|[a, b]| self.b.middle(j, b) - self.a.middle(i, a));
        let way = begin + end;
        let share = self.share();
        let parts = |n: &Vector3<f64>| {
            let gap = |[a, b]: &[Moment; 2]| -(self.a.height(i, n, a) + self.b.height(j, &-n, b));
            let (first, last) = (gap(from), gap(to));
            first > doubt && first * (1.0 - share) + last * share > doubt
        };
        let along = |n: &Vector3<f64>| direction(n).is_some_and(|n| parts(&n));
        let turned = |n: Vector3<f64>| if n.dot(&way) < 0.0 { -n } else { n };
        let mut all = [from, to]
            .into_iter()
            .flat_map(|[a, b]| [self.a.axes(i, a), self.b.axes(j, b)]);
        along(&way) || along(&begin) || along(&end) || all.any(|axes| axes.into_iter().any(|n| along(&turned(n))))
    }

    /// Returns whether the triangles below one or two nodes of a mesh together are a height field.
    fn is_height_field(&mut self, [i, j]: NodePair) -> bool {
        let Some(fields) = &mut self.fields else { return false };
        self.work.intervals = self.work.intervals.saturating_add(1);
        if i == j {
            fields.holds(&[i])
        } else {
            fields.holds(&[i, j])
        }
    }

    /// Returns what a gap between two nodes must exceed.
    fn doubt(&self) -> f64 {
        let [begin, end] = self.step.each(|[a, _]| a.time);
        let length = end - begin;
        // Support values of two nodes, rotations of the direction, and rounding of positions. Each
        // is less than the error of a support value.
        let rounding = 4.0 * CERTIFICATE * UNIT * (self.a.reach() + self.b.reach());
        self.sagitta * (length * length) * (1.0 + 32.0 * UNIT) + self.placed + rounding
    }

    /// Returns the fraction of the step that must still be searched.
    fn share(&self) -> f64 {
        let [begin, end] = self.step.each(|[a, _]| a.time);
        let [_, until] = self.times();
        if begin == 0.0 && end == 1.0 {
            return until;
        }
        ((until - begin) / (end - begin) * (1.0 + 8.0 * UNIT)).at_most(1.0)
    }

    /// Tests two triangles that share no vertex.
    ///
    /// Each pair of a mesh against itself is tested in one order only.
    fn ask(&mut self, pair: NodePair) {
        let [x, y] = pair;
        if self.first.is_start {
            return;
        }
        if self.is_self {
            let [s, t] = pair.each(|k| self.a.both()[0].triangles[k as usize]);
            if x >= y || s.iter().any(|v| t.contains(v)) {
                return;
            }
        }
        let times = self.times();
        let found = if self.is_straight() {
            let [a, b] = self.paths(pair);
            triangles_until(&a, &b, times[1], self.width, &mut self.work)
        } else {
            let latest = self.first.hit.at_most(1.0);
            self.on_arcs(pair)
                .first_contact(times, latest, self.width, &mut self.work)
        };
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

    /// Returns the straight paths of two triangles over the frame.
    fn paths(&self, [x, y]: NodePair) -> [[VertexPath; 3]; 2] {
        let of = |mesh: &MovingMesh, triangle| mesh.paths(triangle, mesh.ends.each_ref());
        [of(self.a, x), of(self.b, y)]
    }

    fn on_arcs(&self, pair: NodePair) -> TrianglesOnArcs<'a> {
        TrianglesOnArcs::new([self.a, self.b], pair, self.placed)
    }

    fn into_cast(self) -> Cast {
        let [x, y] = self.pair;
        let pieces = [self.a.source(x), self.b.source(y)];
        let is_near = !self.is_straight() || !cfg!(feature = "exact");
        cast_of(
            self.first.found(),
            &self.work,
            is_near,
            |time: f64, state: ContactState| {
                let ([a, b], time) = if self.is_straight() {
                    (self.paths(self.pair), time)
                } else {
                    (self.on_arcs(self.pair).at_rest(time), 0.0)
                };
                let mut seen = measure(&a, &b, time, state);
                seen.subshapes = pieces;
                if !self.is_straight() {
                    seen.point_on_a += self.origin;
                    seen.point_on_b += self.origin;
                }
                if state == ContactState::Separated {
                    // The bounds are those of these two triangles.
                    seen.lower = (seen.lower - self.placed).at_least(0.0);
                    seen.upper += self.placed;
                }
                seen
            },
        )
    }
}

/// Largest number of time intervals for one pair of triangles of rotating meshes.
const ARC_INTERVALS: u32 = 1024;

/// Returns a bound of the position errors of two points together, computed at one time.
///
/// Let `L` be the largest coordinate of both meshes. A position has three errors: the pose of the
/// motion (64 UNIT of the radius by `TURN`, 48 of the position by `PLACED_CENTRE`), the matrix and
/// the product (33 UNIT), and the interpolation and the sum (4 UNIT). Together they are less than
/// twice `CERTIFICATE`.
pub(super) fn placed(a: &MovingMesh, b: &MovingMesh) -> f64 {
    2.0 * CERTIFICATE * UNIT * (a.reach() + b.reach())
}

/// Two triangles of meshes at least one of which rotates.
struct TrianglesOnArcs<'a> {
    of: [&'a MovingMesh<'a>; 2],
    triangles: NodePair,
    /// Bound of the errors of the computed vertex positions.
    placed: f64,
    /// Bound of the distances of vertices from straight paths over the frame.
    sagitta: f64,
}

/// Vertices of both triangles at a time.
type Corners = [[Point3<f64>; 3]; 2];

impl<'a> TrianglesOnArcs<'a> {
    pub(super) fn new(of: [&'a MovingMesh<'a>; 2], triangles: NodePair, placed: f64) -> Self {
        let [a, b] = [0, 1].each(|k| of[k].sagitta_of(triangles[k]));
        Self {
            of,
            triangles,
            placed,
            sagitta: a + b,
        }
    }

    fn at(&self, time: f64) -> Corners {
        [0, 1].each(|k| {
            let of = self.of[k];
            of.corners(self.triangles[k], &of.moment(time))
        })
    }

    /// Returns both triangles at rest, in their positions at a time.
    pub(super) fn at_rest(&self, time: f64) -> [[VertexPath; 3]; 2] {
        self.at(time).each(|corners| corners.each(|p| VertexPath::new(p, p)))
    }

    /// Returns the first contact between two times. The triangles are separated before the first.
    ///
    /// The bracket is at most `width` wide if the triangles are deep enough in each other by then.
    /// If a contact starts in the interval, its proof may be at a later time, up to `latest`.
    pub(super) fn first_contact(
        &self,
        [from, until]: [f64; 2],
        latest: f64,
        width: f64,
        work: &mut SearchWork,
    ) -> FirstContact {
        // A quarter, because an edge may need some time to pass by more than the errors.
        let width = (0.25 * width).at_least(LEAST_WIDTH);
        let (mut safe, mut tried) = (from, 0);
        let mut ends = [until; 64];
        let mut count = 1;
        let mut x = self.at(from);
        while count > 0 {
            let end = ends[count - 1];
            let y = self.at(end);
            tried += 1;
            work.intervals = work.intervals.saturating_add(1);
            if self.are_apart([&x, &y], end - safe) {
                (safe, x) = (end, y);
                count -= 1;
                continue;
            }
            if safe == 0.0 && tried == 1 && self.is_start(work) {
                return FirstContact::Start;
            }
            // A contact at the start of the interval is deeper later.
            let later = (safe + width).smaller(latest);
            if end - safe <= 0.5 * width
                && let Some(hit) = [end, later].into_iter().find(|t| self.is_crossed(*t, work))
            {
                return FirstContact::Hit { safe, hit };
            }
            if end - safe <= LEAST_WIDTH || tried >= ARC_INTERVALS || count == ends.len() {
                return self.crossed_later([safe, latest], width, work);
            }
            ends[count] = 0.5 * (safe + end);
            count += 1;
        }
        FirstContact::Miss
    }

    /// Returns whether a direction separates the triangles over an interval of this length.
    fn are_apart(&self, [x, y]: [&Corners; 2], length: f64) -> bool {
        let paths = |k: usize| [0, 1, 2].each(|i| VertexPath::new(x[k][i], y[k][i]));
        let slack = self.placed + self.sagitta * (length * length) * (1.0 + 8.0 * UNIT);
        VertexPaths::new(&paths(0), &paths(1)).is_some_and(|paths| {
            let paths = paths.within(slack);
            let middle = paths.at(0.5);
            let both = [&paths.at(0.0), &paths.at(1.0)];
            is_free(&paths, [0.0, 1.0], both) || crosses(&middle).any(|n| paths.are_parted(both, &n))
        })
    }

    /// Returns whether the triangles, in their rounded positions at the start, share a point.
    fn is_start(&self, work: &mut SearchWork) -> bool {
        let [a, b] = self.at_rest(0.0);
        matches!(search::triangles(&a, &b, 1.0, work), FirstContact::Start)
    }

    /// Returns a contact proven after `safe`, the time until which the triangles are proven
    /// separated.
    ///
    /// The intervals after `safe` that are tried double in length.
    fn crossed_later(&self, [safe, latest]: [f64; 2], width: f64, work: &mut SearchWork) -> FirstContact {
        let mut ahead = width;
        while ahead < latest - safe {
            let hit = safe + ahead;
            if self.is_crossed(hit, work) {
                return FirstContact::Hit { safe, hit };
            }
            ahead *= 2.0;
        }
        if self.is_crossed(latest, work) {
            return FirstContact::Hit { safe, hit: latest };
        }
        FirstContact::Open { safe }
    }

    /// Returns whether an edge of one triangle passes through the interior of the other at a time.
    ///
    /// The result is true only if this holds for all position errors.
    fn is_crossed(&self, time: f64, work: &mut SearchWork) -> bool {
        work.proofs = work.proofs.saturating_add(1);
        let [a, b] = self.at_rest(time);
        let Some(paths) = VertexPaths::new(&a, &b) else {
            return false;
        };
        // Differences of halves of coordinates are below one.
        let VertexPlaces { a: p, b: q } = paths.at(0.0);
        let off = 0.5 * self.placed / paths.unit[0] / paths.unit[1];
        if !(off < 1.0 / 64.0) {
            return false;
        }
        let [p, q] = [p, q].each(|t| t.each(|x| x * 0.5));
        passes(&p, &q, off) || passes(&q, &p, off)
    }
}

/// Returns the common perpendiculars of the edges of two triangles, in both directions.
///
/// They are needed where two edges nearly meet, because the vector between the closest points is
/// then too short to have a reliable direction.
fn crosses(places: &VertexPlaces<3, 3>) -> impl Iterator<Item = Vector3<f64>> {
    let edge = |t: &[Vector3<f64>; 3], k: usize| t[(k + 1) % 3] - t[k];
    (0..18).map(move |k| {
        let n = edge(&places.a, k / 6).cross(&edge(&places.b, k / 2 % 3));
        if k % 2 == 0 { n } else { -n }
    })
}

/// Returns whether an edge of a triangle is proven to pass through the interior of another one.
///
/// Coordinates are below a half. Each vertex is wrong by at most `off`, which is below 1/64.
fn passes(p: &[Vector3<f64>; 3], q: &[Vector3<f64>; 3], off: f64) -> bool {
    // The three vectors have lengths up to the root of three, and each is wrong by at most twice
    // the error of a vertex: 3 * 2 * 3 off. The terms of second and third order are 0.4 off.
    let doubt = PATH_VOLUME + 20.0 * off;
    let sign = |a: &Vector3<f64>, others: [&Vector3<f64>; 3]| {
        let [u, v, w] = others.each(|x| x - a);
        let volume = determinant([&u, &v, &w]);
        i32::from(volume > doubt) - i32::from(volume < -doubt)
    };
    let sides = [0, 1, 2].each(|k| sign(&p[k], [&q[0], &q[1], &q[2]]));
    (0..3).any(|k| {
        let (from, to) = (&p[k], &p[(k + 1) % 3]);
        if sides[k] * sides[(k + 1) % 3] >= 0 {
            return false;
        }
        let turns = [0, 1, 2].each(|j| sign(from, [to, &q[j], &q[(j + 1) % 3]]));
        turns[0] != 0 && turns[1] == turns[0] && turns[2] == turns[0]
    })
}
