//! Pins in slots: a convex bar in the gap of a body, which penetrates one side of the gap and has
//! room on the other.
//!
//! The side is a convex part of the body, so the overlap of two convex bodies is a lower bound of
//! the depth. The translation along the normal of the side separates the bar from the whole body,
//! which is an upper bound. Both equal the depth that was drawn, so the true depth is known in
//! closed form.

use std::collections::HashMap;
use std::f64::consts::TAU;

use crate::pose::{norm, scale};
use crate::rng::Rng;
use crate::soups::Soup;
use crate::{Point, Pose};
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{Compound, ContactState, Geometry, Mesh, MeshKind, PairTracker, Piece, RelativePose, Shape};

/// Largest error of a bound of a depth, relative to the size of the pair.
const ERROR: f64 = 1e-6;

crate::tally! {
    /// Counts of the pins of a run.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct Mix {
        /// Pins judged.
        pub pins: u64,
        /// Connected U-shaped bodies.
        pub joined: u64,
        /// Bodies of two blocks.
        pub blocks: u64,
        /// Pipes through doors.
        pub doors: u64,
        /// Pairs of two meshes.
        pub meshes: u64,
        /// Pairs with a compound.
        pub pieces: u64,
        /// Pairs in which no vertex of one body is inside the other.
        pub bare: u64,
        /// Depths below a thousandth of the size.
        pub shallow: u64,
        /// Meshes with more than 100 triangles.
        pub fine: u64,
        /// Pairs queried in the other order.
        pub exchanged: u64,
    }
}

/// A box given by its lower and its upper corner.
type Brick = [Point; 2];

/// Returns the surface of the union of boxes with disjoint interiors, without faces between them.
///
/// The vertices are on a grid of all planes of the boxes, with every interval cut into `fine`
/// parts.
pub fn union_of(bricks: &[Brick], fine: usize) -> Soup {
    let cuts: [Vec<f64>; 3] = [0, 1, 2].map(|k| {
        let mut planes: Vec<f64> = bricks.iter().flat_map(|b| [b[0][k], b[1][k]]).collect();
        planes.sort_by(f64::total_cmp);
        planes.dedup();
        let part = |w: &[f64], i: usize| w[0] + (w[1] - w[0]) * (i as f64 / fine as f64);
        let last = planes[planes.len() - 1];
        let mut cuts: Vec<f64> = planes
            .windows(2)
            .flat_map(|w| (0..fine).map(move |i| part(w, i)))
            .collect();
        cuts.push(last);
        cuts
    });
    let is_full = |cell: [i64; 3]| {
        let inside = (0..3).all(|k| cell[k] >= 0 && cell[k] + 1 < cuts[k].len() as i64);
        inside && {
            let middle: Point = [0, 1, 2].map(|k| 0.5 * (cuts[k][cell[k] as usize] + cuts[k][cell[k] as usize + 1]));
            let holds = |b: &Brick| (0..3).all(|k| b[0][k] < middle[k] && middle[k] < b[1][k]);
            bricks.iter().any(holds)
        }
    };
    let (mut soup, mut index) = (Soup::default(), HashMap::new());
    let counts = [0, 1, 2].map(|k| cuts[k].len() as i64 - 1);
    for k in 0..counts[0] * counts[1] * counts[2] {
        let cell = [k % counts[0], k / counts[0] % counts[1], k / counts[0] / counts[1]];
        for (axis, up) in (0..3).flat_map(|axis| [(axis, 0), (axis, 1)]) {
            let mut next = cell;
            next[axis] += 2 * up - 1;
            if !is_full(cell) || is_full(next) {
                continue;
            }
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let [a, b, c, d] = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[i, j]| {
                let mut p = cell;
                (p[axis], p[u], p[v]) = (cell[axis] + up, cell[u] + i, cell[v] + j);
                *index.entry(p).or_insert_with(|| {
                    soup.points.push([0, 1, 2].map(|k| cuts[k][p[k] as usize]));
                    soup.points.len() as u32 - 1
                })
            });
            let two = [[a, b, c], [a, c, d]];
            soup.triangles
                .extend(if up == 1 { two } else { two.map(|[a, b, c]| [a, c, b]) });
        }
    }
    soup
}

/// Returns a pipe along z with `n` sides about the origin, cut `fine` times, with a vertex at
/// (-radius, 0).
fn pipe(n: usize, radius: f64, half: f64, fine: usize) -> Soup {
    let corner = |i: usize, j: usize| {
        let angle = TAU * (i as f64 / n as f64 + 0.5);
        [
            radius * angle.cos(),
            radius * angle.sin(),
            half * (2.0 * j as f64 / fine as f64 - 1.0),
        ]
    };
    let mut points: Vec<Point> = (0..=fine)
        .flat_map(|j| (0..n).map(move |i| (i, j)))
        .map(|(i, j)| corner(i, j))
        .collect();
    points[..]
        .iter_mut()
        .for_each(|p| *p = p.map(|x| if x.abs() < 1e-15 * radius { 0.0 } else { x }));
    let at = |i: usize, j: usize| (j * n + i % n) as u32;
    let mut triangles = Vec::new();
    for (i, j) in (0..n).flat_map(|i| (0..fine).map(move |j| (i, j))) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    for i in 1..n - 1 {
        triangles.push([at(0, 0), at(i + 1, 0), at(i, 0)]);
        triangles.push([at(0, fine), at(i, fine), at(i + 1, fine)]);
    }
    Soup::new(points, triangles)
}

/// A body as a mesh and as convex pieces.
struct Body {
    soup: Soup,
    pieces: Vec<Soup>,
}

/// A body with a gap, and a bar in it at the given depth.
struct Slot {
    body: Body,
    bar: Body,
    depth: f64,
    size: f64,
}

/// Returns a bar in the gap between two arms, which a spine may connect. Sizes are about one.
fn arms(rng: &mut Rng, has_spine: bool) -> Slot {
    // The bar is the box (-w, 0, -l) to (w, h, l).
    let (w, h, l) = (rng.range(0.1, 0.4), rng.range(0.3, 0.6), rng.range(0.8, 1.5));
    let depth = rng.log_range(1e-6, 0.3);
    let (out, thick, wide) = (rng.range(w + 0.4, 1.2), rng.range(0.1, 0.6), rng.range(0.2, 0.4));
    let top = h + depth + rng.log_range(1e-4, 0.3);
    let end = rng.range(w + 0.25, 1.0);
    // Thick enough that the shortest separation is upward.
    let low = -(thick + depth);
    let mut bricks = vec![
        [[-out, low, -wide], [end, depth, wide]],
        [[-out, top, -wide], [end, top + thick, wide]],
    ];
    if has_spine {
        bricks.push([[end, low, -wide], [end + 0.3, depth, wide]]);
        bricks.push([[end, depth, -wide], [end + 0.3, top, wide]]);
        bricks.push([[end, top, -wide], [end + 0.3, top + thick, wide]]);
    }
    let bar = [[[-w, 0.0, -l], [w, h, l]]];
    let fines = [0, 1].map(|_| if rng.chance(0.4) { 1 } else { 1 + rng.below(4) });
    Slot {
        body: Body::of(&bricks, fines[0]),
        bar: Body::of(&bar, fines[1]),
        depth,
        size: 4.0,
    }
}

/// Returns a pipe that passes through a door and penetrates one jamb.
fn door(rng: &mut Rng) -> Slot {
    let (n, radius, half) = (4 + 2 * rng.below(12), rng.range(0.1, 0.3), rng.range(0.6, 1.5));
    let depth = rng.log_range(1e-6, 1.0) * radius;
    let (wall, tall) = (rng.range(0.05, 0.4), rng.range(1.0, 1.5));
    // The jamb is the plane x = depth - radius. The wall is thinner along z than the pipe is long.
    let jamb = depth - radius;
    let far = radius + depth + rng.log_range(1e-3, 1.0);
    let bricks = [
        [[jamb - 0.8, -tall, -wall], [jamb, tall, wall]],
        [[far, -tall, -wall], [far + 0.8, tall, wall]],
        [[jamb - 0.8, tall, -wall], [jamb, tall + 0.5, wall]],
        [[jamb, tall, -wall], [far, tall + 0.5, wall]],
        [[far, tall, -wall], [far + 0.8, tall + 0.5, wall]],
    ];
    let fines = [0, 1].map(|_| if rng.chance(0.4) { 1 } else { 1 + rng.below(4) });
    let bar = pipe(n, radius, half, fines[1]);
    Slot {
        body: Body::of(&bricks, fines[0]),
        bar: Body {
            pieces: vec![bar.clone()],
            soup: bar,
        },
        depth,
        size: 4.0,
    }
}

impl Body {
    fn of(bricks: &[Brick], fine: usize) -> Self {
        Self {
            soup: union_of(bricks, fine),
            pieces: bricks.iter().map(|b| union_of(&[*b], 1)).collect(),
        }
    }

    /// Returns the body moved by a pose, as a mesh or as a compound.
    fn made(&self, pose: &Pose, is_mesh: bool) -> Result<Geometry, String> {
        let points = |s: &Soup| -> Vec<Point3<f64>> { s.points.iter().map(|p| Point3::from(pose.apply(*p))).collect() };
        if is_mesh {
            let mesh = Mesh::new(&points(&self.soup), &self.soup.triangles).map_err(|e| e.to_string())?;
            return match mesh.kind() {
                MeshKind::Solid => Ok(mesh.into()),
                _ => Err(format!("not closed: {}", mesh.report())),
            };
        }
        let piece = |s: &Soup| -> Result<Piece, String> {
            let body = lin_canny::ConvexPolyhedron::from_points(&points(s)).map_err(|e| e.to_string())?;
            Ok(Piece::new(Shape::from(body)))
        };
        let pieces: Vec<Piece> = self.pieces.iter().map(piece).collect::<Result<_, _>>()?;
        Ok(Compound::new(pieces).map_err(|e| e.to_string())?.into())
    }

    /// Returns whether a vertex of another body is inside a piece, by the planes of its triangles.
    fn holds_vertex(&self, other: &Self) -> bool {
        let is_below = |s: &Soup, p: &Point| {
            (0..s.triangles.len()).all(|t| {
                let [a, b, c] = s.corners(t).map(Vector3::from);
                let n = (b - a).cross(&(c - a)).normalize();
                n.dot(&(Vector3::from(*p) - a)) < -1e-12
            })
        };
        self.pieces
            .iter()
            .any(|s| other.soup.points.iter().any(|p| is_below(s, p)))
    }
}

/// Plays a pin in a slot.
///
/// # Errors
///
/// Returns the fault.
pub fn play(seed: u64) -> Result<Mix, String> {
    let mut rng = Rng::new(seed);
    let mut mix = Mix::default();
    let slot = match rng.below(3) {
        0 => {
            mix.joined = 1;
            arms(&mut rng, true)
        }
        1 => {
            mix.blocks = 1;
            arms(&mut rng, false)
        }
        _ => {
            mix.doors = 1;
            door(&mut rng)
        }
    };
    let are_mesh = match rng.below(6) {
        0 => [true, false],
        1 => [false, true],
        2 => [false, false],
        _ => [true, true],
    };
    // Each body has a separate frame, sometimes with an origin far from the body; the pose brings
    // them together.
    let mut frame = || {
        if rng.chance(0.3) {
            Pose::IDENTITY
        } else {
            let t = scale(rng.in_ball(), rng.log_range(0.1, 20.0));
            Pose::new(rng.quat(), t)
        }
    };
    let frames = [frame(), frame()];
    let made = [
        slot.body.made(&frames[0], are_mesh[0])?,
        slot.bar.made(&frames[1], are_mesh[1])?,
    ];
    let is_exchanged = rng.chance(0.5);
    let (first, second) = if is_exchanged { (1, 0) } else { (0, 1) };
    let between = frames[first].isometry() * frames[second].isometry().inverse();
    let at = |shift: &Vector3<f64>| {
        let moved = Isometry3::from_parts((between.translation.vector + shift).into(), between.rotation);
        RelativePose::from_isometry(&moved).map_err(|e| e.to_string())
    };
    let mut tracker = PairTracker::new();
    let found = tracker
        .penetration(&made[first], &made[second], &at(&Vector3::zeros())?)
        .ok_or("no solids")?;
    let size = slot.size + norm(frames[0].t) + norm(frames[1].t);
    let (low, high) = (slot.depth - ERROR * slot.size, slot.depth + ERROR * slot.size);
    let noise = 1e-12 * size;
    let holds = found.lower <= slot.depth + noise && slot.depth <= found.upper + noise;
    let state = tracker.closest(&made[first], &made[second], &at(&found.shift)?).state;
    let is_tight = found.lower >= low.max(0.9 * slot.depth) && found.upper <= high.min(1.1 * slot.depth);
    // If a vertex is inside the other body, the search may end at another local minimum.
    let is_bare = !slot.body.holds_vertex(&slot.bar) && !slot.bar.holds_vertex(&slot.body);
    if !holds || is_bare && !is_tight || state != ContactState::Separated {
        return Err(format!(
            "depth {:e}, {found:?}, then {state:?}; {mix:?}, meshes {are_mesh:?}, exchanged {is_exchanged}",
            slot.depth
        ));
    }
    let count = |k: usize, body: &Body| u64::from(are_mesh[k] && body.soup.triangles.len() > 100);
    mix.pins = 1;
    mix.meshes = u64::from(are_mesh == [true; 2]);
    mix.pieces = 1 - mix.meshes;
    mix.bare = u64::from(is_bare);
    mix.shallow = u64::from(slot.depth < 1e-3 * slot.size);
    mix.fine = count(0, &slot.body) + count(1, &slot.bar);
    mix.exchanged = u64::from(is_exchanged);
    Ok(mix)
}
