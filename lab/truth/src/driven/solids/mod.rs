//! Pairs of solids with common faces, at any distance from their origin.
//!
//! The solids are prisms over boxes, wedges, octagons, Ls, Us and Hs in whole coordinates, as
//! meshes and as compounds. A prism is the union of triangular prisms in whole coordinates. Two
//! triangular prisms share interior points unless a face normal of one, or a cross product of an
//! edge of each, separates them. So the exact contact state follows from whole numbers. The depth
//! of two convex prisms along one axis is known in closed form.

mod prism;

use crate::Point;
use crate::forms;
use crate::rng::Rng;
use lin_canny::nalgebra::{Isometry3, Point3};
use lin_canny::{
    Compound, ContactState, ConvexPolyhedron, GeometryRef, ManifoldOptions, Mesh, MeshKind, PairTracker, Piece,
    RelativePose, Shape,
};
use prism::{Cell, GRID, Outline, Prism, Whole};

/// Positions of the second solid in one play.
pub const PLACES: u64 = 4;

crate::tally! {
    /// Counts of the solids of a run.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct Mix {
        /// Pairs of a solid and another solid at one position.
        pub pairs: u64,
        /// Separated pairs.
        pub apart: u64,
        /// Pairs that touch.
        pub touching: u64,
        /// Pairs that share interior points.
        pub overlapping: u64,
        /// Overlapping pairs of equal solids at the same position.
        pub equal: u64,
        /// Overlaps with coplanar faces on the same side.
        pub flush: u64,
        /// Overlaps in which one body lies entirely in the other.
        pub nested: u64,
        /// Overlaps in which no vertex of one body lies inside the other.
        pub crossing: u64,
        /// Pairs farther from the origin than a million times their size.
        pub far: u64,
        /// Pairs flatter than a thousandth of their width.
        pub flat: u64,
        /// Pairs queried as compounds too.
        pub pieces: u64,
        /// Depths compared with the closed form.
        pub depths: u64,
        /// Faces whose contacts were counted.
        pub supports: u64,
    }
}

/// Plays a pair of solids.
///
/// # Errors
/// Returns the first wrong answer.
pub fn play(seed: u64) -> Result<Mix, String> {
    let mut rng = Rng::new(seed);
    let mut mix = pairs(&mut rng)?;
    if seed.is_multiple_of(8) {
        supports(&mut rng)?;
        mix.supports += 1;
    }
    Ok(mix)
}

fn cross(u: Whole, v: Whole) -> Whole {
    [0, 1, 2].map(|k| u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3])
}

fn sub(p: Whole, q: Whole) -> Whole {
    [0, 1, 2].map(|k| p[k] - q[k])
}

/// Returns the four directions of the edges of a cell.
fn edges(c: &Cell) -> [Whole; 4] {
    [sub(c[1], c[0]), sub(c[2], c[1]), sub(c[0], c[2]), sub(c[3], c[0])]
}

/// Returns the four normals of a cell.
fn normals(c: &Cell) -> [Whole; 4] {
    let [e, f, g, up] = edges(c);
    [cross(e, f), cross(e, up), cross(f, up), cross(g, up)]
}

fn extent(c: &[Whole], n: Whole) -> (i64, i64) {
    let heights = || c.iter().map(|p| p[0] * n[0] + p[1] * n[1] + p[2] * n[2]);
    (heights().min().unwrap_or(0), heights().max().unwrap_or(0))
}

/// Returns the contact state of two convex cells.
fn cells_meet(a: &Cell, b: &Cell) -> ContactState {
    let mut state = ContactState::Overlapping;
    let crossed = edges(a).into_iter().flat_map(|u| edges(b).map(|v| cross(u, v)));
    for n in normals(a).into_iter().chain(normals(b)).chain(crossed) {
        if n == [0; 3] {
            continue;
        }
        let ((low, high), (from, until)) = (extent(a, n), extent(b, n));
        if high < from || until < low {
            return ContactState::Separated;
        }
        if high == from || until == low {
            state = ContactState::Touching;
        }
    }
    state
}

/// Returns the contact state of two prisms.
fn truth(a: &Prism, b: &Prism) -> ContactState {
    let (a, b) = (a.cells(), b.cells());
    let mut state = ContactState::Separated;
    for (p, q) in a.iter().flat_map(|p| b.iter().map(move |q| (p, q))) {
        match cells_meet(p, q) {
            ContactState::Overlapping => return ContactState::Overlapping,
            ContactState::Touching => state = ContactState::Touching,
            _ => {}
        }
    }
    state
}

/// Map from whole coordinates to positions: an offset, then a length for each axis.
///
/// The lengths are powers of two, so positions are exact.
#[derive(Clone, Copy, Debug)]
struct Space {
    offset: Whole,
    unit: Point,
}

impl Space {
    fn draw(rng: &mut Rng) -> Self {
        let size = 8.0 * GRID as f64;
        let far = if rng.chance(0.25) { 0.0 } else { rng.log_range(1.0, 1e9) };
        let axes = rng.below(8);
        let offset = [0, 1, 2].map(|k| {
            let by = if axes >> k & 1 == 1 || axes == 0 {
                1.0
            } else {
                rng.range(0.0, 1e-3)
            };
            GRID * (by * far * size * if rng.chance(0.5) { 1.0 } else { -1.0 } / GRID as f64) as i64
        });
        let mut unit = [2f64.powi(rng.below(41) as i32 - 20); 3];
        if rng.chance(0.4) {
            // A flat solid is thicker than the promised 1e-13 of its coordinates by a large factor.
            let least = (3.0 * (far + 1.0) * size * 4e-12 / GRID as f64).log2().ceil() as i32;
            let most = (-least).clamp(0, 24) as usize;
            unit[rng.below(3)] *= 2f64.powi(-(rng.below(most + 1) as i32));
        }
        Self { offset, unit }
    }

    fn place(&self, p: Whole) -> Point {
        [0, 1, 2].map(|k| (p[k] + self.offset[k]) as f64 * self.unit[k])
    }

    fn is_far(&self) -> bool {
        self.offset.iter().any(|x| x.abs() > 1_000_000 * 8 * GRID)
    }

    fn is_flat(&self) -> bool {
        let (most, least) = self
            .unit
            .iter()
            .fold((0.0, f64::INFINITY), |(m, l): (f64, f64), x| (m.max(*x), l.min(*x)));
        least * 1000.0 <= most
    }
}

/// A solid as a mesh and as a compound.
struct Built {
    mesh: Mesh,
    pieces: Option<Compound>,
}

impl Built {
    fn new(prism: &Prism, space: &Space, rng: &mut Rng) -> Result<Self, String> {
        let halvings = [0, 0, 0, 1, 1, 2][rng.below(6)];
        let soup = prism.surface(rng, halvings).placed(|p| space.place(p));
        let mesh = forms::mesh(&soup);
        if mesh.kind() != MeshKind::Solid {
            return Err(format!("{:?}: {}", mesh.kind(), mesh.report()));
        }
        let hull = |corners: &[Whole]| {
            let points: Vec<_> = corners.iter().map(|p| Point3::from(space.place(*p))).collect();
            ConvexPolyhedron::from_points(&points)
                .ok()
                .map(|hull| Piece::new(Shape::from(hull)))
        };
        let pieces: Option<Vec<Piece>> = if prism.is_convex() {
            hull(&prism.corners()).map(|p| vec![p])
        } else {
            prism.cells().iter().map(|c| hull(c)).collect()
        };
        Ok(Self {
            mesh,
            pieces: pieces.and_then(|p| Compound::new(p).ok()),
        })
    }
}

fn translation(by: Point) -> Result<RelativePose, String> {
    RelativePose::from_isometry(&Isometry3::translation(by[0], by[1], by[2])).map_err(|e| e.to_string())
}

/// A pair, with the second prism at its position.
struct Asked<'a> {
    prisms: [&'a Prism; 2],
    space: &'a Space,
    truth: ContactState,
    pose: RelativePose,
}

impl Asked<'_> {
    fn judge<'g>(
        &self,
        tracker: &mut PairTracker,
        how: &str,
        (a, b): (GeometryRef<'g>, GeometryRef<'g>),
        pose: &RelativePose,
    ) -> Result<(), String> {
        let found = tracker.closest(a, b, pose);
        let bounds = match self.truth {
            ContactState::Separated => found.lower > 0.0,
            _ => {
                found.lower <= 0.0 && found.upper >= 0.0 || found.upper < 0.0 && self.truth == ContactState::Overlapping
            }
        };
        let [p, q] = self.prisms;
        let are_boxes = p.kind == Outline::Box && q.kind == Outline::Box;
        let is_bounded = self.truth != ContactState::Separated || !are_boxes || {
            let apart = self.apart();
            let noise = 1e-12 * self.size();
            found.lower <= apart + noise && apart <= found.upper + noise && found.upper - found.lower <= noise
        };
        let meets = tracker.intersects(a, b, pose);
        if found.state == self.truth && bounds && is_bounded && meets == (self.truth != ContactState::Separated) {
            return Ok(());
        }
        Err(format!("{how}: {:?}, intersects {meets}, not {:?}", *found, self.truth))
    }

    /// Returns the size L, without the pose.
    fn size(&self) -> f64 {
        let lengths = [0, 1, 2].map(|k| (self.space.offset[k].abs() + 16 * GRID) as f64 * self.space.unit[k]);
        2.0 * lengths.iter().sum::<f64>()
    }

    /// Returns the distance of two boxes.
    fn apart(&self) -> f64 {
        let [a, b] = self.prisms.map(Prism::corners);
        let square = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].iter().enumerate().map(|(k, n)| {
            let ((low, high), (from, until)) = (extent(&a, *n), extent(&b, *n));
            let gap = (from - high).max(low - until).max(0) as f64 * self.space.unit[k];
            gap * gap
        });
        square.sum::<f64>().sqrt()
    }

    /// Returns the depth of two convex prisms along one axis: the least overlap along a face normal
    /// of one of them.
    fn depth(&self) -> Option<f64> {
        let [p, q] = self.prisms;
        if !(p.is_convex() && q.is_convex() && p.axis == q.axis) {
            return None;
        }
        let [a, b] = [p, q].map(Prism::corners);
        let sides = [p, q].into_iter().flat_map(|x| {
            let n = x.outline.len();
            (0..n).map(move |k| {
                let (from, to) = (x.outline[k], x.outline[(k + 1) % n]);
                let mut normal = [0; 3];
                (normal[(x.axis + 1) % 3], normal[(x.axis + 2) % 3]) = (to[1] - from[1], from[0] - to[0]);
                normal
            })
        });
        let mut up = [0; 3];
        up[p.axis] = 1;
        let depths = sides.chain([up]).map(|n| {
            let ((low, high), (from, until)) = (extent(&a, n), extent(&b, n));
            let overlap = (high - from).min(until - low) as f64;
            let square = [0, 1, 2].map(|k| (n[k] as f64 / self.space.unit[k]).powi(2));
            overlap / square.iter().sum::<f64>().sqrt()
        });
        depths.min_by(f64::total_cmp)
    }

    fn judge_depth(&self, a: &Mesh, b: &Mesh) -> Result<bool, String> {
        let Some(depth) = self.depth() else { return Ok(false) };
        let found = PairTracker::new().penetration(a, b, &self.pose).ok_or("no solids")?;
        let noise = 1e-11 * self.size();
        if found.lower <= depth + noise && depth <= found.upper + noise {
            return Ok(true);
        }
        Err(format!("depth {depth}: {found:?}"))
    }

    fn count(&self, mix: &mut Mix) {
        let [p, q] = self.prisms;
        mix.pairs += 1;
        mix.far += u64::from(self.space.is_far());
        mix.flat += u64::from(self.space.is_flat());
        mix.apart += u64::from(self.truth == ContactState::Separated);
        mix.touching += u64::from(self.truth == ContactState::Touching);
        if self.truth != ContactState::Overlapping {
            return;
        }
        mix.overlapping += 1;
        mix.equal += u64::from(p == q);
        let sides = |x: &Prism| [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(|n| extent(&x.corners(), n));
        let (of_p, of_q) = (sides(p), sides(q));
        mix.flush += u64::from((0..3).any(|k| of_p[k].0 == of_q[k].0 || of_p[k].1 == of_q[k].1));
        let is_in = |x: &[(i64, i64); 3], y: &[(i64, i64); 3]| (0..3).all(|k| x[k].0 >= y[k].0 && x[k].1 <= y[k].1);
        let nested = p.kind == Outline::Box && is_in(&of_q, &of_p) || q.kind == Outline::Box && is_in(&of_p, &of_q);
        mix.nested += u64::from(nested);
        let has_corner = |x: &Prism, y: &Prism| {
            x.corners()
                .iter()
                .any(|c| y.cells().iter().any(|cell| is_inside(*c, cell)))
        };
        mix.crossing += u64::from(!has_corner(p, q) && !has_corner(q, p));
    }
}

/// Returns whether a point is in the interior of a cell.
fn is_inside(p: Whole, cell: &Cell) -> bool {
    normals(cell).into_iter().all(|n| {
        let (low, high) = extent(cell, n);
        let (at, _) = extent(&[p], n);
        low < at && at < high
    })
}

fn pairs(rng: &mut Rng) -> Result<Mix, String> {
    let space = Space::draw(rng);
    let a = Prism::draw(rng);
    let mut b = match rng.below(8) {
        0 | 1 => a.clone(),
        2 | 3 => a.within(rng),
        _ => Prism::draw(rng),
    };
    // Occasionally one solid has far coordinates and the other near ones.
    let mut of_b = space;
    if rng.chance(0.125) {
        of_b.offset = [0; 3];
    }
    let (built_a, built_b) = (Built::new(&a, &space, rng)?, Built::new(&b, &of_b, rng)?);
    let (mut mix, mut by) = (Mix::default(), [0; 3]);
    let mut warm = [(); 3].map(|()| PairTracker::new());
    for k in 0..PLACES {
        if k > 0 {
            let axis = rng.below(3);
            let step = [-GRID, GRID, GRID / 4, -2 * GRID, 2 * GRID][rng.below(5)];
            by[axis] += step;
            let mut one = [0; 3];
            one[axis] = step;
            b = b.moved(one);
        }
        let shift = [0, 1, 2].map(|k| (by[k] + space.offset[k] - of_b.offset[k]) as f64 * space.unit[k]);
        let asked = Asked {
            prisms: [&a, &b],
            space: &space,
            truth: truth(&a, &b),
            pose: translation(shift)?,
        };
        let fail = |what: String| format!("{what}\nplace {k}, {space:?}, {of_b:?}\n{a:?}\n{b:?}");
        asked.count(&mut mix);
        let back = asked.pose.swapped();
        let (m, n) = (&built_a.mesh, &built_b.mesh);
        let ask = |tracker: &mut PairTracker, how, (x, y), pose| asked.judge(tracker, how, (x, y), pose).map_err(fail);
        ask(&mut PairTracker::new(), "cold", (m.into(), n.into()), &asked.pose)?;
        ask(&mut PairTracker::new(), "cold, turned", (n.into(), m.into()), &back)?;
        ask(&mut warm[0], "warm", (m.into(), n.into()), &asked.pose)?;
        ask(&mut warm[1], "warm, turned", (n.into(), m.into()), &back)?;
        if let (Some(p), Some(q)) = (&built_a.pieces, &built_b.pieces) {
            mix.pieces += 1;
            ask(&mut warm[2], "pieces", (p.into(), q.into()), &asked.pose)?;
            ask(
                &mut PairTracker::new(),
                "pieces, a mesh",
                (p.into(), n.into()),
                &asked.pose,
            )?;
            ask(
                &mut PairTracker::new(),
                "a mesh, pieces",
                (m.into(), q.into()),
                &asked.pose,
            )?;
        }
        if asked.truth == ContactState::Overlapping && rng.chance(0.25) {
            mix.depths += u64::from(asked.judge_depth(m, n).map_err(fail)?);
        }
    }
    Ok(mix)
}

/// Asserts that a box just above a slab, or flush on it, has four contacts at any position of both.
fn supports(rng: &mut Rng) -> Result<(), String> {
    let mut space = Space::draw(rng);
    space.unit = [space.unit[0]; 3];
    let [w, h] = [(); 2].map(|()| GRID * (1 + rng.below(4) as i64));
    let at = [(); 2].map(|()| GRID * rng.below(8) as i64);
    let cuboid = |[l, d]: [i64; 2], [r, u]: [i64; 2], (low, high)| Prism {
        kind: Outline::Box,
        outline: vec![[l, d], [r, d], [r, u], [l, u]],
        low,
        high,
        axis: 2,
    };
    let slab = cuboid([-2 * GRID, -2 * GRID], [16 * GRID, 16 * GRID], (-GRID, 0));
    let die = cuboid(at, [at[0] + w, at[1] + h], (0, GRID));
    let (slab, die) = (Built::new(&slab, &space, rng)?, Built::new(&die, &space, rng)?);
    let gap = [0.0, 2f64.powi(-6), 1e-4][rng.below(3)] * space.unit[0];
    let within = ManifoldOptions::default().prediction(0.5 * space.unit[0]);
    let mut counts = Vec::new();
    let pose = translation([0.0, 0.0, gap])?;
    let mut contacts = |a: GeometryRef, b: GeometryRef, pose: &RelativePose| -> Result<(), String> {
        let mut tracker = PairTracker::new();
        let found = tracker.contacts(a, b, pose, &within).map_err(|e| e.to_string())?;
        counts.push(found.iter().map(|g| g.contacts.len()).sum::<usize>());
        Ok(())
    };
    contacts((&slab.mesh).into(), (&die.mesh).into(), &pose)?;
    contacts((&die.mesh).into(), (&slab.mesh).into(), &pose.swapped())?;
    if let (Some(p), Some(q)) = (&slab.pieces, &die.pieces) {
        contacts(p.into(), (&die.mesh).into(), &pose)?;
        contacts((&slab.mesh).into(), q.into(), &pose)?;
    }
    if counts.iter().all(|n| *n == 4) {
        return Ok(());
    }
    Err(format!(
        "contacts {counts:?}, gap {gap:e}, {space:?}, {w} by {h} at {at:?}"
    ))
}
