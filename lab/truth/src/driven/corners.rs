//! Shallow overlaps of unions of boxes: bodies pressed into inner corners, slots and steps.
//!
//! Both bodies are unions of boxes with whole coordinates that share no inner point. B then moves
//! by at most one tiny overlap along each axis. Near the first position, the translations at which
//! the bodies share inner points are a union of octants, so the exact depth is the shortest of
//! eight translations. A contact may not be deeper. Where a cell of A is next to a cell of B, there
//! is a wall, and one contact must lie along its normal at the distance of the wall.

use crate::support::piece_at;
use std::collections::BTreeSet;

use crate::driven::slots::union_of;
use crate::pose::{norm, scale};
use crate::rng::Rng;
use crate::soups::Soup;
use crate::tally::Tally;
use crate::{Point, Pose};
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{
    Cloud, Compound, ConvexPolyhedron, Geometry, ManifoldOptions, Mesh, MeshKind, PairTracker, Piece, RelativePose,
    Shape,
};

/// Overlaps that are judged in each play, in units of the cells.
pub const OVERLAPS: [f64; 4] = [0.0, 1e-12, 1e-6, 1e-3];

/// Rounding error of a contact, relative to the size of the pair.
const ROUNDING: f64 = 4.0 * 64.0 / (1u64 << 53) as f64;

crate::tally! {
    /// Counts of the overlaps of a run.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct Mix {
        /// Overlaps judged.
        pub overlaps: u64,
        /// Contacts judged.
        pub contacts: u64,
        /// Walls whose contact was found.
        pub walls: u64,
        /// Overlaps pressed into two or three walls.
        pub inner: u64,
        /// Bodies that are closed meshes.
        pub meshes: u64,
        /// Meshes inside out, wholly or in some components.
        pub inward: u64,
        /// Bodies of pieces.
        pub compounds: u64,
        /// Bodies of voxels.
        pub voxels: u64,
        /// Convex bodies, curved ones included.
        pub convex: u64,
        /// Depths compared with the truth.
        pub depths: u64,
    }
}

type Cell = [i64; 3];

/// A box of whole coordinates: its lower and its upper corner.
type Block = [Cell; 2];

fn brick(block: &Block) -> [Point; 2] {
    block.map(|p| p.map(|x| x as f64))
}

fn cells(blocks: &[Block]) -> BTreeSet<Cell> {
    let mut all = BTreeSet::new();
    for [low, high] in blocks {
        for x in low[0]..high[0] {
            for y in low[1]..high[1] {
                all.extend((low[2]..high[2]).map(|z| [x, y, z]));
            }
        }
    }
    all
}

fn moved(cell: &Cell, by: Cell) -> Cell {
    [0, 1, 2].map(|k| cell[k] + by[k])
}

/// Returns a body with inner corners: an L, a U, a bin, steps or a heap.
fn cornered(rng: &mut Rng) -> Vec<Block> {
    let mut size = || 2 + rng.below(3) as i64;
    let (x, y, z) = (size(), size(), size());
    match rng.below(5) {
        // Two walls, and the box in their corner.
        0 => vec![
            [[-1, -1, 0], [0, 0, z]],
            [[0, -1, 0], [x, 0, z]],
            [[-1, 0, 0], [0, y, z]],
        ],
        1 => vec![
            [[-1, -1, 0], [x + 1, 0, z]],
            [[-1, 0, 0], [0, y, z]],
            [[x, 0, 0], [x + 1, y, z]],
        ],
        2 => vec![
            [[-1, -1, -1], [x + 1, y + 1, 0]],
            [[-1, -1, 0], [x + 1, 0, z]],
            [[-1, y, 0], [x + 1, y + 1, z]],
            [[-1, 0, 0], [0, y, z]],
            [[x, 0, 0], [x + 1, y, z]],
        ],
        // A height field of steps.
        3 => {
            let columns = (0..x).flat_map(|i| (0..y).map(move |j| (i, j)));
            columns
                .map(|(i, j)| [[i, j, -1], [i + 1, j + 1, rng.below(4) as i64]])
                .collect()
        }
        _ => heap(rng, 2, 4),
    }
}

/// Returns a few boxes anywhere.
fn heap(rng: &mut Rng, least: usize, most: usize) -> Vec<Block> {
    let count = least + rng.below(most - least + 1);
    let mut one = || {
        let low = [0; 3].map(|_| rng.below(3) as i64);
        [low, low.map(|x| x + 1 + rng.below(2) as i64)]
    };
    (0..count).map(|_| one()).collect()
}

/// A body: its blocks, and how its voxels fill them if it is a single cell.
struct Body {
    blocks: Vec<Block>,
    cells: BTreeSet<Cell>,
}

impl Body {
    fn new(blocks: Vec<Block>) -> Self {
        let cells = cells(&blocks);
        Self { blocks, cells }
    }

    fn soup(&self, fine: usize) -> Soup {
        union_of(&self.blocks.iter().map(brick).collect::<Vec<_>>(), fine)
    }

    /// Returns the body in a frame, in a form of its own.
    ///
    /// Voxels are along the axes of their frame, which becomes the identity.
    fn made(&self, frame: &mut Pose, rng: &mut Rng, mix: &mut Mix) -> Result<Geometry, String> {
        let is_convex = self.blocks.len() == 1;
        let form = rng.below(if is_convex { 6 } else { 5 });
        if form == 1 {
            *frame = Pose::IDENTITY;
        }
        let at = |p: Point| Point3::from(frame.apply(p));
        match form {
            0 => {
                mix.compounds += 1;
                self.compound(frame, rng)
            }
            1 => {
                mix.voxels += 1;
                let low = [0, 1, 2].map(|k| self.cells.iter().map(|c| c[k]).min().unwrap_or(0));
                let all: Vec<[u16; 3]> = self
                    .cells
                    .iter()
                    .map(|c| [0, 1, 2].map(|k| (c[k] - low[k]) as u16))
                    .collect();
                let origin = Point3::from(low.map(|x| x as f64));
                let cloud = Cloud::from_cells(origin, Vector3::repeat(1.0), &all).map_err(|e| e.to_string())?;
                Ok(cloud.into())
            }
            5 => {
                mix.convex += 1;
                let corners: Vec<_> = self.soup(1).points.iter().map(|p| at(*p)).collect();
                Ok(ConvexPolyhedron::from_points(&corners)
                    .map_err(|e| e.to_string())?
                    .into())
            }
            _ => {
                mix.meshes += 1;
                let mut soup = self.soup(1 + rng.below(2));
                if form == 4 {
                    mix.inward += 1;
                    soup = soup.flipped();
                }
                let points: Vec<_> = soup.points.iter().map(|p| at(*p)).collect();
                let mesh = Mesh::new(&points, &soup.triangles).map_err(|e| e.to_string())?;
                match mesh.kind() {
                    MeshKind::Solid => Ok(mesh.into()),
                    _ => Err(format!("not closed: {}", mesh.report())),
                }
            }
        }
    }

    /// Returns the blocks as pieces, each in a frame of its own.
    fn compound(&self, frame: &Pose, rng: &mut Rng) -> Result<Geometry, String> {
        let piece = |block: &Block| -> Result<Piece, String> {
            let [low, high] = brick(block).map(Vector3::from);
            let about = Isometry3::translation(0.5 * (low.x + high.x), 0.5 * (low.y + high.y), 0.5 * (low.z + high.z));
            let pose = frame.isometry() * about;
            if rng.chance(0.5) {
                let shape = Shape::cuboid((high - low) * 0.5).map_err(|e| e.to_string())?;
                return Ok(piece_at(pose, shape));
            }
            let own = Pose::new(rng.quat(), scale(rng.in_ball(), rng.log_range(0.1, 20.0))).isometry();
            let local = own.inverse() * pose;
            let corners: Vec<_> = (0..8)
                .map(|k| {
                    let side = |axis: usize| if k >> axis & 1 == 0 { -0.5 } else { 0.5 };
                    let half = (high - low).component_mul(&Vector3::new(side(0), side(1), side(2)));
                    local * Point3::from(half)
                })
                .collect();
            let body = ConvexPolyhedron::from_points(&corners).map_err(|e| e.to_string())?;
            Ok(piece_at(own, Shape::from(body)))
        };
        let pieces: Vec<Piece> = self.blocks.iter().map(piece).collect::<Result<_, _>>()?;
        Ok(Compound::new(pieces).map_err(|e| e.to_string())?.into())
    }

    /// Returns a curved body that touches all six sides of the single cell at the origin.
    fn curved(frame: &Pose, rng: &mut Rng) -> Result<Geometry, String> {
        let radius = rng.range(0.05, 0.4);
        let inner = 0.5 - radius;
        let shape = match rng.below(4) {
            0 => Shape::ball(0.5),
            1 => Shape::cuboid(Vector3::repeat(inner)).and_then(|s| s.rounded(radius)),
            2 => Shape::cylinder(0.5, 0.5),
            _ => Shape::cylinder(inner, inner).and_then(|s| s.rounded(radius)),
        }
        .map_err(|e| e.to_string())?;
        let pose = frame.isometry() * Isometry3::translation(0.5, 0.5, 0.5);
        let piece = piece_at(pose, shape);
        Ok(Compound::new(vec![piece]).map_err(|e| e.to_string())?.into())
    }
}

/// Returns whether a translation of B by `u` makes the bodies share inner points.
fn is_shared(a: &[Block], b: &[Block], by: Cell, u: &Point) -> bool {
    a.iter().any(|[low, high]| {
        b.iter().any(|[from, to]| {
            (0..3).all(|k| {
                // Whole numbers first, so that tiny translations are exact.
                let below = to[k] + by[k] - low[k];
                let above = high[k] - from[k] - by[k];
                below as f64 > -u[k] && above as f64 > u[k]
            })
        })
    })
}

/// Returns the exact depth after B has moved by `shift` from a position without common inner
/// points.
fn depth(a: &[Block], b: &[Block], by: Cell, shift: &Point) -> f64 {
    let ends = (0..8).map(|k| [0, 1, 2].map(|axis| if k >> axis & 1 == 0 { shift[axis] } else { 0.0 }));
    let free = ends.filter(|u| !is_shared(a, b, by, u));
    free.map(|u| norm([0, 1, 2].map(|k| u[k] - shift[k])))
        .fold(f64::INFINITY, f64::min)
}

/// Returns the six directions along the axes.
fn ways() -> impl Iterator<Item = Cell> {
    (0..6).map(|k| {
        let mut way = [0; 3];
        way[k / 2] = if k % 2 == 0 { 1 } else { -1 };
        way
    })
}

/// Returns the directions from A to B in which a cell of B is next to a cell of A.
fn walls(a: &BTreeSet<Cell>, b: &BTreeSet<Cell>, by: Cell) -> Vec<Cell> {
    ways()
        .filter(|way| b.iter().any(|c| a.contains(&moved(&moved(c, by), way.map(|x| -x)))))
        .collect()
}

/// Returns whether a cell of B is next to a cell of A, or shares an edge or a vertex with one.
fn touches(a: &BTreeSet<Cell>, b: &BTreeSet<Cell>, by: Cell) -> bool {
    let about = || (0..27).map(|k| [k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1]);
    b.iter()
        .any(|c| about().any(|way| a.contains(&moved(&moved(c, by), way))))
}

/// Returns a position of B, in whole numbers, where it touches A, and the walls there.
fn position(rng: &mut Rng, a: &Body, b: &Body) -> Option<(Cell, Vec<Cell>)> {
    let mut best: Option<(Cell, Vec<Cell>)> = None;
    let wanted = rng.below(5);
    for _ in 0..60 {
        let by = [0; 3].map(|_| rng.int(-3, 6));
        if b.cells.iter().any(|c| a.cells.contains(&moved(c, by))) {
            continue;
        }
        let found = walls(&a.cells, &b.cells, by);
        if touches(&a.cells, &b.cells, by) && best.as_ref().is_none_or(|best| best.1.len() < found.len()) {
            let is_enough = found.len() >= wanted;
            best = Some((by, found));
            if is_enough {
                break;
            }
        }
    }
    best
}

/// Plays a body pressed into another one by all overlaps.
///
/// # Errors
///
/// Returns the fault.
pub fn play(seed: u64) -> Result<Mix, String> {
    let (mut rng, mut mix) = (Rng::new(seed), Mix::default());
    let a = Body::new(cornered(&mut rng));
    let b = Body::new(match rng.below(6) {
        0 => vec![[[0; 3], [1; 3]]],
        1 => heap(&mut rng, 2, 3),
        _ => vec![[[0; 3], [0; 3].map(|_| 1 + rng.below(3) as i64)]],
    });
    let Some((by, walls)) = position(&mut rng, &a, &b) else {
        return Ok(mix);
    };
    let is_cell = b.blocks == [[[0; 3], [1; 3]]];
    let mut frame = || {
        if rng.chance(0.4) {
            Pose::IDENTITY
        } else {
            let t = scale(rng.in_ball(), rng.log_range(0.1, 20.0));
            Pose::new(rng.quat(), t)
        }
    };
    let mut frames = [frame(), frame()];
    let mut forms = mix;
    let of_a = a.made(&mut frames[0], &mut rng, &mut forms)?;
    let of_b = if is_cell && rng.chance(0.7) {
        forms.convex += 1;
        Body::curved(&frames[1], &mut rng)?
    } else {
        b.made(&mut frames[1], &mut rng, &mut forms)?
    };
    mix.add(&forms);
    let made = [of_a, of_b];
    let is_exchanged = rng.chance(0.5);
    // Towards a wall, along it or away from it.
    let press = [0, 1, 2].map(|k| {
        let toward: Vec<i64> = walls.iter().map(|w| -w[k]).filter(|x| *x != 0).collect();
        if toward.is_empty() || rng.chance(0.25) {
            rng.int(-1, 1)
        } else {
            *rng.pick(&toward)
        }
    });
    mix.inner += u64::from(walls.iter().filter(|w| (0..3).any(|k| w[k] * press[k] < 0)).count() > 1);
    let size = 16.0 + norm(frames[0].t) + norm(frames[1].t);
    let noise = ROUNDING * size;
    let mut tracker = PairTracker::new();
    for overlap in OVERLAPS {
        let shift = press.map(|x| x as f64 * overlap);
        let to = [0, 1, 2].map(|k| by[k] as f64 + shift[k]);
        let [in_a, in_b] = frames.map(|f| f.isometry());
        let a_from_b = in_a * Isometry3::translation(to[0], to[1], to[2]) * in_b.inverse();
        let (first, second, at, turn) = if is_exchanged {
            (&made[1], &made[0], a_from_b.inverse(), in_b.rotation)
        } else {
            (&made[0], &made[1], a_from_b, in_a.rotation)
        };
        let pose = RelativePose::from_isometry(&at).map_err(|e| e.to_string())?;
        let prediction = 2.0 * overlap + *rng.pick(&[1e-9, 1e-2]);
        let options = ManifoldOptions::default().prediction(prediction);
        let found = tracker
            .contacts(first, second, &pose, &options)
            .map_err(|e| e.to_string())?
            .to_vec();
        let truth = depth(&a.blocks, &b.blocks, by, &shift);
        let told = |what: String| {
            format!(
                "overlap {overlap:e}, depth {truth:e}: {what}; walls {walls:?}, pressed {press:?}, exchanged {is_exchanged}, {forms:?}, A {:?}, B {:?} at {by:?}",
                a.blocks, b.blocks
            )
        };
        let all: Vec<_> = found.iter().flat_map(|g| &g.contacts).collect();
        for contact in &all {
            let (n, point) = (contact.normal.into_inner(), &contact.point);
            let between = at * point.point_on_b - point.point_on_a;
            if !(point.separation >= -truth - noise) {
                let n = turn.inverse() * n;
                let on_a = (if is_exchanged { in_b } else { in_a }).inverse() * point.point_on_a;
                return Err(told(format!(
                    "a contact {:e} deep along {n:?} at {on_a:?}, patches {:?} {:?}",
                    -point.separation, contact.patches, point.features
                )));
            }
            if !((between - n * point.separation).norm() <= 1e-9 * size && (n.norm() - 1.0).abs() < 1e-12) {
                return Err(told(format!("the points are not opposite: {contact:?}")));
            }
        }
        mix.contacts += all.len() as u64;
        for wall in &walls {
            let sign = if is_exchanged { -1.0 } else { 1.0 };
            let n = turn * Vector3::from(wall.map(|x| sign * x as f64));
            let gap: f64 = (0..3).map(|k| wall[k] as f64 * shift[k]).sum();
            let is_its = |c: &&lin_canny::PatchContact| {
                (*c.normal - n).norm() < 1e-6 && (c.point.separation - gap).abs() <= noise
            };
            if !all.iter().any(is_its) {
                return Err(told(format!("no contact of the wall {wall:?}")));
            }
            mix.walls += 1;
        }
        if rng.chance(0.05) {
            let bounds = tracker.penetration(first, second, &pose).ok_or("no solids")?;
            if !(bounds.lower <= truth + noise) {
                return Err(told(format!("{bounds:?}")));
            }
            mix.depths += 1;
        }
        mix.overlaps += 1;
    }
    Ok(mix)
}
