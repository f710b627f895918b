//! Meshes of slivers, judged over the integers.
//!
//! A sliver is a triangle whose vertices lie on one oblique line up to a few units in the last
//! place. Slivers occur alone, on one line, in one plane and among ordinary triangles. Rounding
//! decides the normal of such a triangle, so the closest point on it may be computed anywhere on
//! its line. On the axes the normal is exactly zero, which is harmless: the lines must be oblique.

use dashu_ratio::RBig;
use lin_canny::nalgebra::Point3;
use lin_canny::{ContactState, Mesh, PairTracker, RelativePose};

use crate::brute::Triangle;
use crate::exact_meshes::square;
use crate::pose::{add, norm, off_unit, scale};
use crate::rational::{exact, sqrt};
use crate::rng::Rng;
use crate::soups::Soup;
use crate::{Point, Pose};

/// Frames of a pair of meshes, with one tracker.
const FRAMES: usize = 3;

/// Largest width of the bounds, relative to the size of the pair.
const WIDTH: f64 = 1e-12;

crate::tally! {
    /// Counts of the meshes of a run.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct Mix {
        /// Meshes built, or bent to slivers.
        pub meshes: u64,
        /// Meshes that had ordinary triangles when built.
        pub bent: u64,
        /// Triangles with vertices on a line up to rounding.
        pub slivers: u64,
        /// Poses judged.
        pub frames: u64,
        /// Frames in which the exact distance is positive.
        pub apart: u64,
        /// Frames in which two meshes share a point.
        pub meeting: u64,
        /// Pairs of triangles of one mesh that were judged.
        pub own: u64,
        /// Predicates tested at a distance and at both adjacent floating-point numbers.
        pub predicates: u64,
    }
}

/// A line, and a plane through it, on which triangles of both meshes lie.
struct Place {
    origin: Point,
    ways: [Point; 2],
}

/// Returns a number moved by a few units in the last place.
fn jogged(x: f64, rng: &mut Rng) -> f64 {
    (0..rng.below(4)).fold(x, |x, _| if rng.chance(0.5) { x.next_up() } else { x.next_down() })
}

impl Place {
    fn new(rng: &mut Rng) -> Self {
        let far = if rng.chance(0.3) { rng.log_range(1.0, 1e3) } else { 0.0 };
        Self {
            origin: scale(rng.unit(), far),
            ways: [rng.unit(), rng.unit()],
        }
    }

    /// Returns a triangle, and whether it is a sliver.
    fn triangle(&self, rng: &mut Rng) -> (Triangle, bool) {
        let [u, v] = self.ways;
        let kind = rng.below(5);
        // A separate line in the common plane, or the common line.
        let turn = rng.range(0.0, std::f64::consts::TAU);
        let own = add(scale(u, turn.cos()), scale(v, turn.sin()));
        let from = add(scale(u, rng.range(-1.0, 1.0)), scale(v, rng.range(-1.0, 1.0)));
        let corners = [(); 3].map(|()| {
            let (s, t) = (rng.range(-1.0, 1.0), rng.range(-1.0, 1.0));
            let p = match kind {
                0 | 1 => scale(u, s),
                2 => add(from, scale(own, s)),
                3 => add(scale(u, s), scale(v, t)),
                _ => scale(rng.in_ball(), 1.0),
            };
            add(self.origin, p).map(|x| if kind < 3 { jogged(x, rng) } else { x })
        });
        (corners, kind < 3)
    }

    fn soup(&self, rng: &mut Rng, mix: &mut Mix) -> Soup {
        let mut soup = Soup::default();
        for _ in 0..1 + rng.below(3) {
            let (corners, is_sliver) = self.triangle(rng);
            let base = soup.points.len() as u32;
            soup.points.extend(corners);
            soup.triangles.push([base, base + 1, base + 2]);
            mix.slivers += u64::from(is_sliver);
        }
        soup
    }
}

fn points(soup: &Soup) -> Vec<Point3<f64>> {
    soup.points.iter().map(|p| Point3::from(*p)).collect()
}

/// Returns the mesh of a soup, built directly or by bending ordinary triangles.
///
/// `Mesh::new` removes a triangle that is exactly a segment, so such a soup is made by bending too.
fn mesh(soup: &Soup, rng: &mut Rng, mix: &mut Mix) -> Result<Mesh, String> {
    mix.meshes += 1;
    if rng.chance(0.7)
        && let Ok(mesh) = Mesh::new(&points(soup), &soup.triangles)
        && mesh.triangle_count() == soup.triangles.len()
        && mesh.vertices().len() == soup.points.len()
    {
        return Ok(mesh);
    }
    mix.bent += 1;
    let size = soup.points.iter().map(|p| norm(*p)).fold(0.0, f64::max);
    let plain: Vec<_> = soup
        .points
        .iter()
        .map(|_| Point3::from(scale(rng.in_ball(), size)))
        .collect();
    let mut mesh = Mesh::new(&plain, &soup.triangles).map_err(|e| format!("{e}: {plain:?}"))?;
    mesh.set_vertices(&points(soup)).map_err(|e| format!("{e}: {soup:?}"))?;
    Ok(mesh)
}

fn triangles(soup: &Soup) -> Vec<Triangle> {
    (0..soup.triangles.len()).map(|t| soup.corners(t)).collect()
}

/// Returns whether bounds contain the root of a square.
fn hold(lower: f64, upper: f64, square: &RBig) -> bool {
    let below = lower <= 0.0 || exact(lower) * exact(lower) <= *square;
    below && upper >= 0.0 && exact(upper) * exact(upper) >= *square
}

/// Returns a distance, its adjacent floating-point numbers, and two numbers farther away.
fn around(square: &RBig) -> [f64; 5] {
    let root = sqrt(square).0;
    [
        root,
        root.next_up(),
        root.next_down().max(0.0),
        root * (1.0 + 1e-6),
        root * (1.0 - 1e-6),
    ]
}

/// Plays two meshes, and each against itself.
///
/// # Errors
///
/// Returns the fault, with all numbers.
pub fn play(seed: u64) -> Result<Mix, String> {
    let (mut rng, mut mix) = (Rng::new(seed), Mix::default());
    let place = Place::new(&mut rng);
    // Of any size, both meshes alike.
    let unit = if rng.chance(0.3) {
        2f64.powi(rng.int(-310, 310) as i32)
    } else {
        1.0
    };
    let [x, y] = [(); 2].map(|()| place.soup(&mut rng, &mut mix).map(|p| scale(p, unit)));
    let (a, b) = (mesh(&x, &mut rng, &mut mix)?, mesh(&y, &mut rng, &mut mix)?);
    let told = |what: &str| format!("{what}\n{x:?}\n{y:?}");
    let mut tracker = PairTracker::new();
    for frame in 0..FRAMES {
        let pose = match frame {
            0 => Pose::IDENTITY,
            1 => Pose::shift(scale(place.ways[0], unit * rng.range(-2.0, 2.0))),
            _ => Pose::new(off_unit(rng.quat(), &mut rng), scale(rng.in_ball(), unit)),
        };
        let truths = triangles(&x)
            .into_iter()
            .flat_map(|p| triangles(&y).into_iter().map(move |q| (p, q)));
        let truth = truths.map(|(p, q)| square(&p, &q, &pose)).min().ok_or("no triangles")?;
        let relative = RelativePose::from_isometry(&pose.isometry()).map_err(|e| e.to_string())?;
        let size = [&x, &y].map(|s| s.points.iter().map(|p| norm(*p)).fold(0.0, f64::max));
        let size = size[0] + size[1] + norm(pose.t);
        let (is_zero, apart) = (truth == RBig::ZERO, sqrt(&truth).0);
        mix.frames += 1;
        mix.apart += u64::from(!is_zero);
        mix.meeting += u64::from(is_zero);
        let fresh = PairTracker::new().closest(&a, &b, &relative);
        let swapped = PairTracker::new().closest(&b, &a, &relative.swapped());
        for found in [tracker.closest(&a, &b, &relative), fresh, swapped] {
            let state = match found.state {
                ContactState::Separated => !is_zero,
                ContactState::Touching | ContactState::Undecided => apart <= WIDTH * size,
                _ => false,
            };
            if !state || !hold(found.lower, found.upper, &truth) || found.upper - found.lower > WIDTH * size {
                return Err(told(&format!("the distance is {apart:e}, not {found:?}, {pose:?}")));
            }
        }
        if tracker.intersects(&a, &b, &relative) != is_zero {
            return Err(told(&format!("they intersect: {is_zero}, {apart:e} apart, {pose:?}")));
        }
        for d in around(&truth) {
            mix.predicates += 1;
            let is_within = truth <= exact(d) * exact(d);
            if tracker.within(&a, &b, &relative, d) != is_within {
                return Err(told(&format!("within {d:e}: {is_within}, {apart:e} apart, {pose:?}")));
            }
        }
    }
    itself(&x, &a, &mut mix).map_err(|what| told(&what))?;
    let both = x.clone().with(&y);
    let mesh = mesh(&both, &mut rng, &mut mix)?;
    itself(&both, &mesh, &mut mix).map_err(|what| told(&what))?;
    Ok(mix)
}

/// Judges a mesh, whose triangles share no vertex, against itself.
fn itself(soup: &Soup, mesh: &Mesh, mix: &mut Mix) -> Result<(), String> {
    let all = triangles(soup);
    let pairs = (0..all.len()).flat_map(|i| (i + 1..all.len()).map(move |j| (i, j)));
    let squares: Vec<RBig> = pairs.map(|(i, j)| square(&all[i], &all[j], &Pose::IDENTITY)).collect();
    let mut tracker = PairTracker::new();
    let found = tracker.self_closest(mesh);
    let (Some(least), Some(found)) = (squares.iter().min(), &found) else {
        let is_right = squares.is_empty() && found.is_none();
        return is_right.then_some(()).ok_or_else(|| format!("of itself {found:?}"));
    };
    mix.own += squares.len() as u64;
    if !hold(found.lower, found.upper, least) {
        return Err(format!("it is {:e} from itself, not {found:?}", sqrt(least).0));
    }
    for d in around(least) {
        let count = squares.iter().filter(|s| **s <= exact(d) * exact(d)).count();
        let (within, pairs) = (tracker.self_within(mesh, d), tracker.self_pairs(mesh, d).len());
        if within != (count > 0) || pairs != count {
            return Err(format!("{count} pairs of itself within {d:e}, not {pairs}, {within}"));
        }
    }
    let here = RelativePose::from_isometry(&Pose::IDENTITY.isometry()).map_err(|e| e.to_string())?;
    tracker.check(mesh, mesh, &here)
}
