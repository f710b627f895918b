//! Points on boxes that are rotated pieces of a compound, far from the origins of their own frames,
//! judged over the rationals.
//!
//! The judge maps a point into the frame of each piece without rounding. There the piece is a box
//! along the axes, so its signed distance has a closed form.

use crate::support::piece_at;
use std::cmp::Ordering;

use lin_canny::nalgebra::{Isometry3, Point3};
use lin_canny::{Compound, ContactState, ConvexPolyhedron, Geometry, Piece, PointOutcome, PointQuery};

use super::exact_place::{Exact3, line_at};
use crate::pose::{add, norm, off_unit, scale, sub};
use crate::rational::{RBig, exact, placed, rounded};
use crate::rng::Rng;
use crate::{Point, Pose};

/// Number of points per compound.
pub const EACH: u64 = 25;

crate::tally! {
    /// Counts of the points, and the widest bounds.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct Mix {
        /// Points outside, on the surface, inside.
        pub points: [u64; 3],
        /// Points whose side rounding hides.
        pub undecided: u64,
        /// Widest bounds of a distance from outside, in lengths of the pair.
        pub widest: f64,
    }
}

/// A box along the axes of the frame of its piece, and the pose of this frame.
struct PosedBox {
    centre: Point,
    half: Point,
    at: Pose,
}

/// The signed distance of a point from a box: the distance squared outside, minus the depth inside.
enum Signed {
    Outside(RBig),
    Inside(RBig),
}

impl Signed {
    /// Returns the order of the distance and a number.
    fn compare(&self, x: f64) -> Ordering {
        if !x.is_finite() {
            return 0f64.total_cmp(&x);
        }
        match self {
            Self::Outside(_) if x < 0.0 => Ordering::Greater,
            Self::Outside(square) => square.cmp(&(exact(x) * exact(x))),
            Self::Inside(depth) => depth.cmp(&exact(x)),
        }
    }

    fn is_between(&self, lower: f64, upper: f64) -> bool {
        self.compare(lower).is_ge() && self.compare(upper).is_le()
    }

    fn sign(&self) -> i32 {
        match self.compare(0.0) {
            Ordering::Less => -1,
            Ordering::Equal => 0,
            Ordering::Greater => 1,
        }
    }

    fn smaller(self, other: Self) -> Self {
        let is_less = match (&self, &other) {
            (Self::Outside(x), Self::Outside(y)) | (Self::Inside(x), Self::Inside(y)) => x <= y,
            (Self::Inside(_), Self::Outside(_)) => true,
            (Self::Outside(_), Self::Inside(_)) => false,
        };
        if is_less { self } else { other }
    }
}

impl PosedBox {
    /// Draws a box whose middle is up to 1e6 from the origin of its frame and near that of the body.
    fn new(rng: &mut Rng) -> Self {
        let grid = |x: f64| (x * 1024.0).round() / 1024.0;
        let far = [0.0, 1.0, 1e3, 1e6][rng.below(4)];
        let centre = scale(rng.in_ball(), far).map(grid);
        let half = [0; 3].map(|_| grid(rng.log_range(0.01, 2.0)));
        let q = off_unit(rotation(rng), rng);
        let turned = Pose::new(q, [0.0; 3]).rotate(centre);
        let near = scale(rng.in_ball(), [0.0, 1.0, 3.0][rng.below(3)]);
        let t = sub(near, turned);
        let t = if rng.chance(0.5) { t.map(grid) } else { t };
        let at = Pose::new(q, t);
        Self { centre, half, at }
    }

    fn corners(&self) -> Vec<Point> {
        let end = |k: usize, i: usize| if k >> i & 1 == 1 { self.half[i] } else { -self.half[i] };
        (0..8)
            .map(|k| add(self.centre, std::array::from_fn(|i| end(k, i))))
            .collect()
    }

    /// Returns a point of the surface or near it, rounded once.
    fn point(&self, rng: &mut Rng) -> Point {
        let kind = rng.below(6);
        let mut share = [0; 3].map(|_| rng.int(-8, 8) as f64 / 8.0);
        if kind == 5 {
            share = [0; 3].map(|_| rng.range(-1.5, 1.5));
        } else {
            // A face, an edge or a vertex.
            let first = rng.below(3);
            for k in 0..=kind.min(2) {
                share[(first + k) % 3] = rng.sign();
            }
        }
        let own = add(self.centre, std::array::from_fn(|k| share[k] * self.half[k]));
        let mut p = placed(&[own], &self.at)[0].each_ref().map(rounded);
        for _ in 0..rng.below(3) {
            let k = rng.below(3);
            p[k] = if rng.chance(0.5) {
                p[k].next_up()
            } else {
                p[k].next_down()
            };
        }
        p
    }

    fn signed(&self, p: Point) -> Signed {
        let own: Exact3 = line_at(p, [0.0; 3], &self.at).0;
        let over: Exact3 = std::array::from_fn(|k| {
            let x = &own[k] - exact(self.centre[k]);
            let x = if x < RBig::ZERO { -x } else { x };
            x - exact(self.half[k])
        });
        let outside = over.iter().filter(|x| **x > RBig::ZERO);
        let square = outside.fold(RBig::ZERO, |sum, x| sum + x * x);
        match over.into_iter().max() {
            Some(depth) if square == RBig::ZERO => Signed::Inside(depth),
            _ => Signed::Outside(square),
        }
    }
}

/// Returns a rotation, often with an exact matrix.
pub fn rotation(rng: &mut Rng) -> [f64; 4] {
    let r = std::f64::consts::FRAC_1_SQRT_2;
    let exact = [
        [0.0, 0.0, 0.8, 0.6],
        [0.5, 0.5, 0.5, 0.5],
        [0.6, 0.0, 0.0, 0.8],
        [0.0, 0.0, r, r],
        [1.0, 0.0, 0.0, 0.0],
    ];
    if rng.chance(0.5) { *rng.pick(&exact) } else { rng.quat() }
}

/// Plays a compound.
///
/// # Errors
/// Returns the first wrong answer.
pub fn play(seed: u64) -> Result<Mix, String> {
    let mut rng = Rng::new(seed);
    let told = |e: String| format!("seed {seed}: {e}");
    let mut boxes: Vec<PosedBox> = (0..1 + rng.below(3)).map(|_| PosedBox::new(&mut rng)).collect();
    let piece = |b: &PosedBox| {
        let corners: Vec<Point3<f64>> = b.corners().into_iter().map(Point3::from).collect();
        let body = ConvexPolyhedron::from_points(&corners).map_err(|e| e.to_string())?;
        let pose = b.at.isometry();
        Ok(piece_at(pose, body))
    };
    let pieces: Result<Vec<Piece>, String> = boxes.iter().map(piece).collect();
    let body = Compound::new(pieces.map_err(told)?).map_err(|e| told(e.to_string()))?;
    // The body is that of the stored poses.
    for (posed, piece) in boxes.iter_mut().zip(body.pieces()) {
        posed.at.q = piece.pose.rotation.coords.into();
    }
    judge_boxes(&body, &boxes, &mut rng).map_err(told)?;
    let (query, mut mix) = (PointQuery::new(&body), Mix::default());
    for _ in 0..EACH {
        let p = boxes[rng.below(boxes.len())].point(&mut rng);
        judge_point(&query, &boxes, p, &mut mix).map_err(told)?;
    }
    Ok(mix)
}

fn judge_point(query: &PointQuery<'_>, boxes: &[PosedBox], p: Point, mix: &mut Mix) -> Result<(), String> {
    let at = Point3::from(p);
    let found = query.closest_point(&at).map_err(|e| e.to_string())?;
    let each: Vec<Signed> = boxes.iter().map(|b| b.signed(p)).collect();
    let near = query.nearest_features(&at, boxes.len()).map_err(|e| e.to_string())?;
    let told = |found: &PointOutcome| format!("{p:?}: {found:?}");
    let is_right = |f: &PointOutcome, s: &Signed| {
        let side = match f.state {
            ContactState::Separated => s.sign() > 0,
            ContactState::Touching => s.sign() == 0,
            ContactState::Overlapping => s.sign() < 0,
            _ => true,
        };
        side && s.is_between(f.lower, f.upper)
    };
    for f in &near {
        if !is_right(f, &each[f.location.subshape as usize]) {
            return Err(format!("piece {}, {}", f.location.subshape, told(f)));
        }
    }
    let Some(least) = each.into_iter().reduce(Signed::smaller) else {
        return Ok(());
    };
    if !is_right(&found, &least) || query.contains(&at) != Ok(found.is_contained()) {
        return Err(told(&found));
    }
    mix.points[(1 - least.sign()) as usize] += 1;
    mix.undecided += u64::from(!matches!(
        found.state,
        ContactState::Separated | ContactState::Touching | ContactState::Overlapping
    ));
    if least.sign() > 0 {
        let size = boxes.iter().map(|b| norm(b.half)).fold(0.0, f64::max) + found.upper;
        mix.widest = mix.widest.max((found.upper - found.lower) / size);
    }
    Ok(())
}

/// Returns an error if a corner of a piece is outside the box of the body, in its frame or at a pose
/// off unit length.
fn judge_boxes(body: &Compound, boxes: &[PosedBox], rng: &mut Rng) -> Result<(), String> {
    let corners = || boxes.iter().flat_map(|b| placed(&b.corners(), &b.at));
    let holds = |(low, high): (Point3<f64>, Point3<f64>), p: &Exact3| {
        (0..3).all(|k| exact(low[k]) <= p[k] && p[k] <= exact(high[k]))
    };
    if let Some(p) = corners().find(|p| !holds(body.aabb(), p)) {
        return Err(format!("{:?} is outside of {:?}", p.map(|x| rounded(&x)), body.aabb()));
    }
    let q = off_unit(rng.quat(), rng);
    let turn = crate::rational::rotation(q);
    let pose: Isometry3<f64> = Pose::new(q, [0.0; 3]).isometry();
    let outer = Geometry::from(body.clone()).aabb_at(&pose, &mut lin_canny::polyhedron::BoxHint::default());
    for p in corners() {
        let at = std::array::from_fn(|i| &turn[i][0] * &p[0] + &turn[i][1] * &p[1] + &turn[i][2] * &p[2]);
        if !holds(outer, &at) {
            return Err(format!(
                "{:?} is outside of {outer:?} at a pose",
                at.map(|x| rounded(&x))
            ));
        }
    }
    Ok(())
}
