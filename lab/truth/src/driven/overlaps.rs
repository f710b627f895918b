//! Volumes that two solids share, judged by closed forms and over the rationals.
//!
//! [`play`] draws bodies of cells of a lattice: boxes, sets of cells with edges of four faces, nested
//! shells, bodies that cover themselves, and equal, flush and thin overlaps. Their shared volume is a
//! sum of products of small integers. [`play_exactly`] draws meshes of every kind at any pose, broken
//! and repaired, bent, and as polyhedra; the oracle cuts tetrahedra over the rationals. [`play_bytes`]
//! is the entry of `fuzz/`. The instrument `soak` uses this module.

use crate::support::piece_at;
use dashu_ratio::RBig;
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{Compound, ConvexPolyhedron, Geometry, Mesh, OverlapVolume, PairTracker, RelativePose};
use lin_canny::{MeshKind, RepairOptions, polyhedron::solids};

use crate::near_points::hard_mesh;
use crate::pose::{add, scale};
use crate::rational::{exact, placed};
use crate::rng::Rng;
use crate::soups::{self, Soup};
use crate::volumes::{Exact, shared, whole};
use crate::{Point, Pose};

use super::{Bytes, slots::union_of};

crate::tally! {
    /// Counts of the results; if a count is zero, its ingredient was not tested.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct Mix {
        /// Pairs of each family.
        pub families: [u64; FAMILIES],
        /// Pairs with a shared volume, and without one.
        pub shared: [u64; 2],
        /// Bodies as meshes, polyhedra and compounds.
        pub forms: [u64; 3],
        /// Pairs whose bodies cover themselves.
        pub twice: u64,
        /// The widest bounds, relative to the volume.
        pub width: f64,
    }
}

/// Number of families.
pub const FAMILIES: usize = 10;

/// Largest width of the bounds, relative to the volume; it holds for volumes above `LEAST`, relative to
/// the cube of the size.
const WIDTH: f64 = 1e-9;
const LEAST: f64 = 1e-12;

/// Width that the rounding of vertices may add, relative to the cube of the size.
const ROUNDED: f64 = 2e-15;

/// A body of cells on a lattice: how often each cell counts.
type Cells = Vec<([i64; 3], i64)>;

/// Returns a random set of cells.
fn blob(side: i64, rng: &mut Rng) -> Cells {
    let all = (0..side * side * side).map(|k| [k % side, k / side % side, k / side / side]);
    let part = rng.range(0.2, 0.9);
    let mut cells: Cells = all.filter(|_| rng.chance(part)).map(|c| (c, 1)).collect();
    if cells.is_empty() {
        cells.push(([0; 3], 1));
    }
    cells
}

/// Returns the surface of cells that count once, moved by half-integers.
fn surface(cells: &Cells, at: [i64; 3], half: Point) -> Soup {
    let brick = |c: &[i64; 3]| {
        let low = [0, 1, 2].map(|k| (c[k] + at[k]) as f64 + half[k]);
        [low, low.map(|x| x + 1.0)]
    };
    let bricks: Vec<_> = cells.iter().map(|(c, _)| brick(c)).collect();
    union_of(&bricks, 1)
}

/// Returns eight times the shared volume of two bodies of cells, the second moved by halves.
fn eightfold(a: &[([i64; 3], i64)], b: &[([i64; 3], i64)], halves: [i64; 3]) -> i64 {
    let side = |x: i64, y: i64| (2 - (2 * x - y).abs()).max(0);
    let mut sum = 0;
    for (p, m) in a {
        for (q, n) in b {
            let product: i64 = (0..3).map(|k| side(p[k], 2 * q[k] + halves[k])).product();
            sum += m * n * product;
        }
    }
    sum
}

/// Compares a result with the truth; `rounded` is a width that is allowed besides.
fn judge(found: &OverlapVolume, truth: &RBig, size: f64, rounded: f64, what: &str) -> Result<f64, String> {
    let wrong = || format!("{what}: {found:?}, not {}", truth.to_f64().value());
    if !(found.lower.is_finite() && found.upper.is_finite()) {
        return Err(wrong());
    }
    if exact(found.lower) > *truth || exact(found.upper) < *truth {
        return Err(wrong());
    }
    let volume = truth.to_f64().value();
    let width = found.upper - found.lower;
    if volume > LEAST * size * size * size {
        if !(width <= WIDTH * volume + rounded) {
            return Err(format!("{}: the bounds are {width:e} apart", wrong()));
        }
        return Ok((width - rounded).max(0.0) / volume);
    }
    Ok(0.0)
}

/// Returns a mesh of a soup.
fn mesh(soup: &Soup) -> Result<Mesh, String> {
    let points: Vec<Point3<f64>> = soup.points.iter().map(|p| Point3::from(*p)).collect();
    Mesh::new(&points, &soup.triangles).map_err(|e| e.to_string())
}

/// Returns a compound of unit boxes.
fn boxes(cells: &Cells, half: Point) -> Result<Geometry, String> {
    let piece = |(c, _): &([i64; 3], i64)| {
        let body = solids::cuboid(Vector3::repeat(0.5)).map_err(|e| e.to_string())?;
        let at = |k: usize| c[k] as f64 + half[k] + 0.5;
        let pose = Isometry3::translation(at(0), at(1), at(2));
        Ok(piece_at(pose, body))
    };
    let pieces = cells.iter().map(piece).collect::<Result<Vec<_>, String>>()?;
    Ok(Geometry::from(Compound::new(pieces).map_err(|e| e.to_string())?))
}

/// Plays a pair of bodies of cells.
///
/// # Errors
/// Returns the first wrong answer.
pub fn play(seed: u64) -> Result<Mix, String> {
    let mut rng = Rng::new(seed);
    let mut mix = Mix::default();
    let family = rng.below(6);
    mix.families[family] = 1;
    let half = |rng: &mut Rng, most: i64| [0; 3].map(|_| rng.int(-most, most));
    let one = || vec![([0; 3], 1)];
    let (a, b, halves) = match family {
        // Boxes at offsets of 0, 1/2 and 1.
        0 => (one(), one(), half(&mut rng, 2)),
        1 => {
            let (m, n) = (rng.int(1, 4), rng.int(1, 4));
            let (a, b) = (blob(m, &mut rng), blob(n, &mut rng));
            (a, b, half(&mut rng, 6))
        }
        // Equal bodies.
        2 => {
            let a = blob(3, &mut rng);
            (a.clone(), a, [0; 3])
        }
        // Flush: one above the other, or in its holes.
        3 => {
            let (n, (mut a, mut b)) = (rng.int(1, 3), (Cells::new(), Cells::new()));
            for (cell, _) in blob(n, &mut rng) {
                if rng.chance(0.5) { &mut a } else { &mut b }.push((cell, 1));
            }
            if a.is_empty() || b.is_empty() {
                (one(), one(), [0, 0, 2])
            } else {
                (a, b, [0; 3])
            }
        }
        // A shell of 26 cells.
        4 => {
            let mut a = Cells::new();
            for k in 0..27 {
                let cell = [k % 3, k / 3 % 3, k / 9];
                if cell != [1; 3] {
                    a.push((cell, 1));
                }
            }
            let b = if rng.chance(0.5) { a.clone() } else { blob(2, &mut rng) };
            (a, b, half(&mut rng, 4))
        }
        // A box and another one that contains it: some points count twice.
        _ => {
            let (b, at) = (blob(2, &mut rng), half(&mut rng, 2));
            (vec![([0; 3], 2), ([1, 0, 0], 1)], b, at)
        }
    };
    let truth = eightfold(&a, &b, halves);
    // Powers of two change no other bit; a shift of both bodies changes nothing.
    let unit = 2f64.powi(*rng.pick(&[0, 0, 0, 1, -20, 300, -300, 330, -330]));
    let far = *rng.pick(&[0.0, 0.0, 1.0, 1_048_576.0]);
    let shift = [far, -far, 2.0 * far];
    let by_pose = rng.chance(0.5);
    let apart = halves.map(|h| 0.5 * h as f64);
    let of_a = if family == 5 {
        let both = vec![([0; 3], 1), ([1, 0, 0], 1)];
        surface(&one(), [0; 3], [0.0; 3]).with(&surface(&both, [0; 3], [0.0; 3]))
    } else {
        surface(&a, [0; 3], [0.0; 3])
    };
    let of_b = surface(&b, [0; 3], if by_pose { [0.0; 3] } else { apart });
    let moved = |soup: Soup| soup.map(|p| scale(add(p, shift), unit));
    let (x, y) = (mesh(&moved(of_a))?, mesh(&moved(of_b))?);
    let pose = Pose::shift(scale(if by_pose { apart } else { [0.0; 3] }, unit));
    // A common rotation cancels if the translations are equal.
    let common = Pose::new(rng.quat(), rng.in_ball());
    let relative = if !by_pose && rng.chance(0.5) {
        RelativePose::new(&common.isometry(), &common.isometry())
    } else {
        RelativePose::from_isometry(&pose.isometry())
    }
    .map_err(|e| e.to_string())?;
    let what = format!("seed {seed}, family {family}, {a:?} and {b:?} at {halves:?} times {unit:e} beside {far}");
    let value = RBig::from(truth) / RBig::from(8) * exact(unit) * exact(unit) * exact(unit);
    let size = unit * 4.0;
    let mut tracker = PairTracker::new();
    let refused = |e: lin_canny::OverlapError| format!("{what}: {e}");
    let found = tracker.overlap(&x, &y, &relative).map_err(refused)?;
    mix.width = judge(&found, &value, size, 0.0, &what)?;
    let back = tracker.overlap(&y, &x, &relative.swapped()).map_err(refused)?;
    mix.width = mix
        .width
        .max(judge(&back, &value, size, 0.0, &format!("{what}, swapped"))?);
    mix.shared[usize::from(truth == 0)] = 1;
    mix.forms[0] = 2;
    mix.twice = u64::from(found.covers_itself);
    let is_twice = family == 5 && eightfold(&a[..1], &b, halves) > 0;
    if [found, back]
        .iter()
        .any(|x| x.covers_itself && family != 5 || is_twice && !x.covers_itself)
    {
        return Err(format!("{what}: {found:?} {back:?}"));
    }
    // The same bodies in other forms.
    if unit == 1.0 && far == 0.0 && family != 5 {
        let form = if by_pose { [0.0; 3] } else { apart };
        let compounds = [boxes(&a, [0.0; 3])?, boxes(&b, form)?];
        let both = tracker
            .overlap(&compounds[0], &compounds[1], &relative)
            .map_err(refused)?;
        judge(&both, &value, size, 0.0, &format!("{what}, compounds"))?;
        let one = tracker.overlap(&x, &compounds[1], &relative).map_err(refused)?;
        judge(&one, &value, size, 0.0, &format!("{what}, a compound"))?;
        mix.forms[2] = 2;
    }
    Ok(mix)
}

/// Plays two meshes of lattice points, which bytes choose.
///
/// Each mesh is the boundary of up to four tetrahedra with corners on a lattice, so it is closed, and
/// ties are everywhere. It may cover itself and face inward.
///
/// # Errors
/// Returns the first wrong answer.
pub fn play_bytes(data: &[u8]) -> Result<(), String> {
    let mut bytes = Bytes(data);
    let mut body = || {
        let mut soup = Soup::default();
        for _ in 0..1 + bytes.byte() % 4 {
            let first = soup.points.len() as u32;
            for _ in 0..4 {
                let x = bytes.byte();
                soup.points.push([x % 4, x / 4 % 4, x / 16 % 4].map(f64::from));
            }
            let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
            soup.triangles.extend(faces.map(|t| t.map(|v| first + v)));
        }
        soup
    };
    let (a, b) = (body(), body());
    // Flat tetrahedra leave no triangle.
    let (Ok(x), Ok(y)) = (mesh(&a), mesh(&b)) else {
        return Ok(());
    };
    if x.kind() == MeshKind::Open || y.kind() == MeshKind::Open {
        return Err(format!("{a:?} or {b:?} is open"));
    }
    let here = RelativePose::from_isometry(&Isometry3::identity()).map_err(|e| e.to_string())?;
    let (truth, moment) = shared(&chain(&x), &chain(&y));
    let mut tracker = PairTracker::new();
    for (p, q) in [(&x, &y), (&y, &x)] {
        let found = tracker.overlap(p, q, &here).map_err(|e| e.to_string())?;
        let what = format!("{a:?} {b:?}");
        judge(&found, &truth, 4.0, 0.0, &what)?;
        if let Some(centroid) = found.centroid {
            judge_centre(centroid, found.centroid_error, (&truth, &moment), &what)?;
        }
        let curves = tracker.overlap_loops(p, q, &here).map_err(|e| e.to_string())?;
        if !curves.loops.iter().flatten().all(|p| p.iter().all(|x| x.is_finite())) {
            return Err(format!("{a:?} {b:?}: {curves:?}"));
        }
    }
    Ok(())
}

/// Judges a centre of mass by the exact volume and first moments.
///
/// # Errors
/// Returns the axis along which the bound does not hold.
pub fn judge_centre(
    centre: Point3<f64>,
    error: f64,
    (volume, moment): (&RBig, &[RBig; 3]),
    what: &str,
) -> Result<(), String> {
    for k in 0..3 {
        let at = &moment[k] / volume;
        let off = &at - exact(centre[k]);
        if off > exact(error) || -off > exact(error) {
            let at = at.to_f64().value();
            return Err(format!("{what}: {centre} up to {error:e}, axis {k} is at {at}"));
        }
    }
    Ok(())
}

/// Returns a box as a mesh.
fn brick(low: Point, high: Point) -> Soup {
    union_of(&[[low, high]], 1)
}

/// Returns a closed mesh of few triangles.
fn few(rng: &mut Rng) -> Soup {
    match rng.below(8) {
        0 => hard_mesh(0, rng),
        1 => soups::bracket(),
        2 => soups::torus(5, 4, 0.4),
        3 => soups::gear(3),
        4 => hard_mesh(8, rng),
        5 => hard_mesh(9, rng),
        6 => hard_mesh(10, rng),
        _ => hard_mesh(11, rng),
    }
}

/// A body, and the chain of triangles that it has.
struct Judged {
    body: Geometry,
    chain: Exact,
}

fn chain(mesh: &Mesh) -> Exact {
    let corners = mesh.triangles().flat_map(|x| x.1);
    let points: Vec<_> = corners.map(|p| [0, 1, 2].map(|k| exact(p[k]))).collect();
    let triangles = (0..points.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
    Exact {
        triangles: triangles.collect(),
        points,
    }
}

impl Judged {
    /// Makes a body of a mesh: as it is, repaired, bent or as the hull of its points.
    fn new(soup: &Soup, rng: &mut Rng, mix: &mut Mix) -> Result<Self, String> {
        let points: Vec<Point3<f64>> = soup.points.iter().map(|p| Point3::from(*p)).collect();
        let told = |e: &dyn std::fmt::Display| e.to_string();
        let form = rng.below(5);
        if form == 4 {
            let hull = ConvexPolyhedron::from_points(&points).map_err(|e| told(&e))?;
            let mesh = Mesh::from_convex(&hull).map_err(|e| told(&e))?;
            mix.forms[1] += 1;
            return Ok(Self {
                body: hull.into(),
                chain: chain(&mesh),
            });
        }
        mix.forms[0] += 1;
        let mut triangles = soup.triangles.clone();
        if form == 2 {
            for _ in 0..rng.below(4) {
                let at = rng.below(triangles.len());
                match rng.below(2) {
                    0 => drop(triangles.remove(at)),
                    _ => triangles[at].swap(0, 1),
                }
            }
            mix.families[8] += 1;
        }
        let options = RepairOptions::default();
        let mut mesh = Mesh::repaired(&points, &triangles, &options).map_err(|e| told(&e))?;
        if form == 3 {
            let amount = *rng.pick(&[0.1, 1e-6, 1e-15]);
            let near = |p: &Point3<f64>| Point3::from(add((*p).into(), scale(rng.in_ball(), amount)));
            let bent: Vec<Point3<f64>> = mesh.vertices().iter().map(near).collect();
            if mesh.set_vertices(&bent).is_ok() {
                mix.families[9] += 1;
            }
        }
        let chain = chain(&mesh);
        let (volume, moment) = whole(&chain);
        let (lower, upper) = mesh.volume_bounds();
        if exact(lower) > volume || volume > exact(upper) {
            return Err(format!("{soup:?}: the volume {volume} is not in {lower} to {upper}"));
        }
        if let Some((centre, error)) = mesh.centroid_bounds() {
            judge_centre(centre, error, (&volume, &moment), &format!("{soup:?}"))?;
        }
        Ok(Self {
            chain,
            body: mesh.into(),
        })
    }
}

/// Plays a pair of meshes at any pose, judged over the rationals.
///
/// # Errors
/// Returns the first wrong answer.
pub fn play_exactly(seed: u64) -> Result<Mix, String> {
    let mut rng = Rng::new(seed);
    let mut mix = Mix::default();
    let family = 6 + rng.below(2);
    mix.families[family] = 1;
    let (mut a, mut b) = (few(&mut rng), few(&mut rng));
    let quarter = std::f64::consts::FRAC_PI_2;
    let mut pose = Pose::new(
        match rng.below(4) {
            0 => Pose::IDENTITY.q,
            1 => crate::pose::quat([0.0, 0.0, 1.0], quarter * *rng.pick(&[0.5, 1.0, 2.0])),
            2 => crate::pose::quat([1.0, 0.0, 0.0], *rng.pick(&[1e-3, 1e-9, 1e-12])),
            _ => rng.quat(),
        },
        match rng.below(3) {
            0 => [0.0; 3],
            1 => [0; 3].map(|_| 0.25 * rng.int(-4, 4) as f64),
            _ => scale(rng.in_ball(), 1.5),
        },
    );
    if family == 7 {
        // Thin: a block sunk into a block by a small depth, turned together.
        let depth = *rng.pick(&[1e-3, 1e-6, 1e-9, 1e-12]);
        let turn = Pose::new(rng.quat(), [0.0; 3]);
        a = brick([-1.0; 3], [1.0, 1.0, 0.0]).moved(&turn);
        b = brick([-0.5, -2.0, -depth], [2.0, 0.5, 1.0]).moved(&turn);
        pose = Pose::IDENTITY;
    }
    let far = *rng.pick(&[0.0, 0.0, 1e3, 1e6]);
    a = a.map(|p| add(p, [far, -far, far]));
    b = b.map(|p| {
        add(
            p,
            if pose == Pose::IDENTITY {
                [far, -far, far]
            } else {
                [0.0; 3]
            },
        )
    });
    if pose != Pose::IDENTITY {
        pose.t = add(pose.t, [far, -far, far]);
    }
    let x = Judged::new(&a, &mut rng, &mut mix)?;
    let y = Judged::new(&b, &mut rng, &mut mix)?;
    let what = format!(
        "seed {seed}, family {family}, {pose:?}, {:?} {:?}",
        x.body.kind(),
        y.body.kind()
    );
    let relative = RelativePose::from_isometry(&pose.isometry()).map_err(|e| e.to_string())?;
    let given: Vec<Point> = y
        .chain
        .points
        .iter()
        .map(|p| p.each_ref().map(|x| x.to_f64().value()))
        .collect();
    let there = Exact {
        points: placed(&given, &pose),
        triangles: y.chain.triangles.clone(),
    };
    let (truth, moment) = shared(&x.chain, &there);
    let size = 4.0;
    // Vertices that a pose rounds add their rounding times an area.
    let rounded = if pose == Pose::IDENTITY {
        0.0
    } else {
        ROUNDED * size * size * size
    };
    let mut tracker = PairTracker::new();
    let refused = |e: lin_canny::OverlapError| format!("{what}: {e}");
    let found = tracker.overlap(&x.body, &y.body, &relative).map_err(refused)?;
    mix.width = judge(&found, &truth, size, rounded, &what)?;
    let back = tracker
        .overlap(&y.body, &x.body, &relative.swapped())
        .map_err(refused)?;
    mix.width = mix
        .width
        .max(judge(&back, &truth, size, rounded, &format!("{what}, swapped"))?);
    mix.shared[usize::from(truth == RBig::ZERO)] = 1;
    mix.twice = u64::from(found.covers_itself);
    if let Some(centroid) = found.centroid
        && truth > exact(LEAST)
    {
        judge_centre(centroid, found.centroid_error, (&truth, &moment), &what)?;
        // The rounding of vertices moves the centre by its volume over the whole.
        let slack = 1e-12 * (1.0 + far) + 16.0 * (found.upper - found.lower) / found.upper;
        if found.centroid_error > slack {
            return Err(format!("{what}: {found:?} has a wide centre, above {slack:e}"));
        }
    }
    Ok(mix)
}
