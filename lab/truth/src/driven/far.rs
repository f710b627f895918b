//! Pairs of convex solids far from the origins of their frames, as bodies of every kind: hulls,
//! meshes, compounds and clouds; judged by the exact oracle.
//!
//! The vertices are up to 1e12 sizes from the origin of the body's frame. The poses bring the
//! bodies together, near the origin of the world or far from it. The instrument `soak` uses this
//! module.

use crate::brute_hull;
use crate::exact::{self, Exact};
use crate::pose::{add, cross, dot, norm, scale, sub};
use crate::rational::{exact as rational, placed, rounded};
use crate::rng::Rng;
use crate::{Face, Point, Pose};
use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use lin_canny::{
    Cloud, CloudElement, Compound, ContactState, ConvexPolyhedron, Geometry, ManifoldOptions, Mesh, PairTracker, Piece,
    PointQuery, Ray, RayCast, RayCaster, RelativePose, Shape,
};

crate::tally! {
    /// Counts of the results; if a count is zero, its ingredient was not tested.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct Mix {
        /// Pairs that are separated, touch, and overlap.
        pub states: [u64; 3],
        /// Bodies that are hulls, meshes, compounds in place and with poses, and clouds.
        pub kinds: [u64; 5],
        /// Pairs at most a millionth of their size apart, or that deep.
        pub near: u64,
        /// Points.
        pub points: u64,
        /// Rays that hit.
        pub rays: u64,
        /// Depths of pairs.
        pub depths: u64,
        /// Pairs with contacts.
        pub contacts: u64,
        /// The widest interval of a distance, in units of 1e-13 L.
        pub widest: f64,
    }
}

/// A convex solid far from the origin of its frame.
struct Solid {
    points: Vec<Point>,
    faces: Vec<Face>,
    middle: Point,
    /// Half the diagonal of the box.
    radius: f64,
}

impl Solid {
    /// Returns a box or the hull of a few points, moved; `None` if rounding makes it flat.
    fn new(rng: &mut Rng, offset: f64) -> Option<Self> {
        let size = if rng.chance(0.7) {
            1.0
        } else {
            rng.log_range(0.01, 10.0)
        };
        let middle = scale(
            if rng.chance(0.3) { *rng.pick(&AXES) } else { rng.unit() },
            offset * size,
        );
        let own: Vec<Point> = if rng.chance(0.5) {
            let half = [(); 3].map(|()| size * f64::from(1 + rng.below(8) as u32) / 8.0);
            let sign = |k: usize, i: usize| if k >> i & 1 == 1 { half[i] } else { -half[i] };
            (0..8).map(|k| [0, 1, 2].map(|i| sign(k, i))).collect()
        } else {
            let count = 4 + rng.below(6);
            (0..count).map(|_| scale(rng.in_ball(), size)).collect()
        };
        Self::of(own.into_iter().map(|p| add(p, middle)).collect())
    }

    fn of(all: Vec<Point>) -> Option<Self> {
        let extreme = brute_hull::extreme(&all);
        let points: Vec<Point> = extreme.iter().map(|&k| all[k as usize]).collect();
        if points.len() < 4 {
            return None;
        }
        let end = |k: usize, pick: fn(f64, f64) -> f64| points.iter().map(|p| p[k]).reduce(pick).expect("four");
        let (low, high) = ([0, 1, 2].map(|k| end(k, f64::min)), [0, 1, 2].map(|k| end(k, f64::max)));
        let (radius, faces) = (0.5 * norm(sub(high, low)), brute_hull::faces(&points));
        let middle = add(scale(low, 0.5), scale(high, 0.5));
        (faces.len() >= 4).then_some(Self {
            points,
            faces,
            middle,
            radius,
        })
    }

    /// Returns the reference point of the pair size L and the radius about it.
    ///
    /// See the front page of the library: the middle of the box in each coordinate in which it is
    /// more than two half diagonals from the origin.
    fn reference(&self) -> (Point, f64) {
        let point = self.middle.map(|x| if x.abs() > 2.0 * self.radius { x } else { 0.0 });
        let far = self.points.iter().map(|p| norm(sub(*p, point)));
        (point, far.fold(0.0, f64::max))
    }

    /// Returns the middle in each coordinate in which all points minus the middle are exact.
    fn exact_middle(&self) -> Point {
        let is_exact =
            |k: usize, p: &Point| rational(p[k] - self.middle[k]) == rational(p[k]) - rational(self.middle[k]);
        [0, 1, 2].map(|k| {
            if self.points.iter().all(|p| is_exact(k, p)) {
                self.middle[k]
            } else {
                0.0
            }
        })
    }

    fn body(&self) -> exact::Body<'_> {
        exact::Body {
            points: &self.points,
            faces: &self.faces,
        }
    }

    /// Returns the body as one of five kinds. Its vertices are exactly the points.
    fn geometry(&self, kind: usize, rng: &mut Rng) -> Result<Geometry, String> {
        let hull = |points: &[Point]| {
            let points: Vec<Point3<f64>> = points.iter().map(|p| (*p).into()).collect();
            ConvexPolyhedron::from_points(&points).map_err(|e| e.to_string())
        };
        let told = |e: &dyn std::fmt::Display| e.to_string();
        let middle = self.exact_middle();
        let about = |from: Point| self.points.iter().map(|p| sub(*p, from)).collect::<Vec<_>>();
        Ok(match kind {
            0 => hull(&self.points)?.into(),
            1 => {
                let fan = |f: &Face| f.windows(2).skip(1).map(|w| [f[0], w[0], w[1]]).collect::<Vec<_>>();
                let triangles: Vec<_> = self.faces.iter().flat_map(fan).collect();
                let points: Vec<Point3<f64>> = self.points.iter().map(|p| (*p).into()).collect();
                Mesh::new(&points, &triangles).map_err(|e| told(&e))?.into()
            }
            2 => Compound::new(vec![Piece::new(hull(&self.points)?)])
                .map_err(|e| told(&e))?
                .into(),
            3 => {
                let (axes, q) = *rng.pick(&TURNS);
                let from = if rng.chance(0.5) { middle } else { [0.0; 3] };
                // The piece is rotated by a quarter or a third, so nothing is rounded.
                let own: Vec<Point> = about(from).iter().map(|p| axes.map(|(k, sign)| sign * p[k])).collect();
                let mut piece = Piece::new(hull(&own)?);
                piece.pose = Isometry3::from_parts(from.into(), UnitQuaternion::new_unchecked(q.into()));
                Compound::new(vec![piece]).map_err(|e| told(&e))?.into()
            }
            _ => {
                let element = CloudElement::Shape(Shape::from(hull(&about(middle))?));
                let points = [Point3::from(middle); 2];
                Cloud::new(&points[..1 + rng.below(2)], element)
                    .map_err(|e| told(&e))?
                    .into()
            }
        })
    }
}

const AXES: [Point; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Rotations without rounding: the coordinate and the sign of each coordinate of a point before the
/// rotation, and the quaternion (x, y, z, w).
type Turn = ([(usize, f64); 3], [f64; 4]);
const TURNS: [Turn; 3] = [
    ([(0, 1.0), (1, 1.0), (2, 1.0)], [0.0, 0.0, 0.0, 1.0]),
    ([(0, 1.0), (1, -1.0), (2, -1.0)], [1.0, 0.0, 0.0, 0.0]),
    // x to y, y to z, z to x.
    ([(1, 1.0), (2, 1.0), (0, 1.0)], [0.5, 0.5, 0.5, 0.5]),
];

/// Returns the two rotations of a pair.
fn rotations(rng: &mut Rng) -> [[f64; 4]; 2] {
    let here = [0.0, 0.0, 0.0, 1.0];
    let common = rng.quat();
    let [mut a, mut b] = match rng.below(5) {
        0 | 1 => [here; 2],
        2 => [common; 2],
        3 => [here, common],
        _ => [common, rng.quat()],
    };
    if rng.chance(0.3) {
        // Off unit, within the accepted range.
        a = a.map(|x| x * (1.0 + rng.range(-4.9e-13, 4.9e-13)));
        b = b.map(|x| x * (1.0 - 3e-13));
    }
    [a, b]
}

/// Returns the greatest height of the points along a direction of the world.
fn height(solid: &Solid, pose: &Pose, n: Point) -> f64 {
    let own = pose.rotate_back(n);
    let middle = pose.rotate(solid.middle);
    let top = solid
        .points
        .iter()
        .map(|p| dot(own, sub(*p, solid.middle)))
        .fold(f64::MIN, f64::max);
    dot(n, middle) + top
}

/// Plays a pair.
///
/// # Errors
/// Returns the first wrong answer.
pub fn play(seed: u64) -> Result<Mix, String> {
    let mut rng = Rng::new(seed);
    let mut mix = Mix::default();
    let offset = |rng: &mut Rng| {
        if rng.chance(0.15) {
            0.0
        } else {
            rng.log_range(1.0, 1e12)
        }
    };
    let far = offset(&mut rng);
    let other = if rng.chance(0.5) { far } else { offset(&mut rng) };
    let solids = (Solid::new(&mut rng, far), Solid::new(&mut rng, other));
    let (Some(a), Some(b)) = solids else { return Ok(mix) };
    let [qa, qb] = rotations(&mut rng);
    let turned = |q: [f64; 4], solid: &Solid| Pose::new(q, [0.0; 3]).rotate(solid.middle);
    // The middle of A is near the origin of the world, or its frame is.
    let size = a.radius + b.radius;
    let ta = match rng.below(3) {
        0 => [0.0; 3],
        1 => scale(turned(qa, &a), -1.0),
        _ => scale(rng.unit(), size * rng.log_range(1.0, 1e9)),
    };
    let n = if rng.chance(0.5) { *rng.pick(&AXES) } else { rng.unit() };
    let n = scale(n, rng.sign());
    let aside = if rng.chance(0.5) {
        [0.0; 3]
    } else {
        scale(rng.unit(), 0.3 * size)
    };
    let aside = sub(aside, scale(n, dot(n, aside)));
    let gap = rng.sign() * size * *rng.pick(&[0.0, 0.0, 0.0, 1e-15, 1e-13, 1e-10, 1e-6, 1e-3, 0.1, 1.0]);
    let pose_a = Pose::new(qa, ta);
    let mut pose_b = Pose::new(qb, [0.0; 3]);
    let (of_a, of_b) = (pose_a.rotate(a.middle), pose_b.rotate(b.middle));
    let tops = (
        height(&a, &pose_a, n) - dot(n, of_a),
        height(&b, &pose_b, scale(n, -1.0)) + dot(n, of_b),
    );
    // Put middle on middle, then move B by both heights and the gap.
    pose_b.t = add(add(sub(of_a, of_b), ta), add(aside, scale(n, tops.0 + tops.1 + gap)));
    if rng.chance(0.5) {
        // The closest points, not the heights, are then as far apart as the gap, up to rounding.
        let hulls = (a.geometry(0, &mut rng)?, b.geometry(0, &mut rng)?);
        let pose = RelativePose::new(&pose_a.isometry(), &pose_b.isometry()).map_err(|e| e.to_string())?;
        let found = PairTracker::new().closest(&hulls.0, &hulls.1, &pose);
        let n = pose_a.rotate(found.normal.into_inner().into());
        pose_b.t = add(pose_b.t, scale(n, gap - found.distance));
    }
    let truth = exact::solve(a.body(), &pose_a, b.body(), &pose_b);
    let ((from_a, radius_a), (from_b, radius_b)) = (a.reference(), b.reference());
    let between = {
        let (x, y) = (placed(&[from_a], &pose_a), placed(&[from_b], &pose_b));
        norm([0, 1, 2].map(|k| rounded(&(&y[0][k] - &x[0][k]))))
    };
    let far_from = |p: Point| p.iter().map(|x| x.abs()).sum::<f64>();
    let l = radius_a + radius_b + between + 2.0f64.powi(-49) * (far_from(from_a) + far_from(from_b));
    let which = [rng.below(5), 1 + rng.below(4)];
    which.iter().for_each(|k| mix.kinds[*k] += 1);
    let (p, q) = (a.geometry(which[0], &mut rng)?, b.geometry(which[1], &mut rng)?);
    let pose = RelativePose::new(&pose_a.isometry(), &pose_b.isometry()).map_err(|e| e.to_string())?;
    let told = |what: &str| {
        format!(
            "{what}: seed {seed}, kinds {which:?}, offsets {far:e} {other:e}, L {l:e}, truth {} {:e}",
            truth.state, truth.distance
        )
    };
    let state = truth.state as usize;
    mix.states[state] += 1;
    mix.near += u64::from(truth.distance.abs() < 1e-6 * l);
    // Poses of pieces and of elements are composed.
    let is_composed = which.iter().any(|k| *k > 2);
    judge_distance(&mut mix, &p, &q, &pose, &truth, l, is_composed).map_err(|e| told(&e))?;
    judge_depth(&mut mix, &p, &q, &pose, &truth, l).map_err(|e| told(&e))?;
    judge_points(&mut mix, &b, &q, which[1], &mut rng).map_err(|e| told(&e))?;
    judge_rays(&mut mix, &b, &q, which[1], &mut rng).map_err(|e| told(&e))?;
    Ok(mix)
}

fn judge_distance(
    mix: &mut Mix,
    p: &Geometry,
    q: &Geometry,
    pose: &RelativePose,
    truth: &Exact,
    l: f64,
    is_composed: bool,
) -> Result<(), String> {
    let most = if is_composed { 1.5e-13 } else { 1e-13 } * l;
    let distance = truth.distance.max(0.0);
    let is_apart = truth.state == exact::ContactState::Separated;
    let is_inside = truth.state == exact::ContactState::Overlapping;
    for k in 0..2 {
        let (p, q, pose) = if k == 0 { (p, q, *pose) } else { (q, p, pose.swapped()) };
        let mut tracker = PairTracker::new();
        let found = tracker.closest(p, q, &pose);
        let told = |what: &str| {
            Err(format!(
                "{what} {k}: {:?} {:e} {:e}",
                found.state, found.lower, found.upper
            ))
        };
        if found.lower > distance.next_up() || found.upper < distance.next_down() && !is_inside {
            return told("bounds");
        }
        if is_apart && found.state != ContactState::Overlapping {
            let width = found.upper - found.lower.max(0.0);
            mix.widest = mix.widest.max(width / (1e-13 * l));
            if width > most {
                return told("width");
            }
        }
        let is_right = match found.state {
            ContactState::Separated => is_apart,
            ContactState::Overlapping => is_inside,
            _ => truth.distance.abs() <= most,
        };
        if !is_right {
            return told("state");
        }
        let meets = tracker.intersects(p, q, &pose);
        // At composed poses ties count as within.
        if meets == is_apart && !(is_composed && meets && distance <= most) {
            return told("intersects");
        }
        for d in [
            0.5 * distance,
            distance * (1.0 - 1e-9),
            distance * (1.0 + 1e-9),
            distance + 0.1 * l,
        ] {
            let is_within = tracker.within(p, q, &pose, d);
            let certainly = distance < d || !is_apart;
            let maybe = distance <= d + if is_composed { most } else { 0.0 };
            if is_within && !maybe || !is_within && certainly {
                return told("within");
            }
        }
    }
    Ok(())
}

fn judge_depth(
    mix: &mut Mix,
    p: &Geometry,
    q: &Geometry,
    pose: &RelativePose,
    truth: &Exact,
    l: f64,
) -> Result<(), String> {
    if let Some(bounds) = PairTracker::new().penetration(p, q, pose) {
        let depth = (-truth.distance).max(0.0);
        let noise = 1e-12 * l;
        if bounds.lower > depth.next_up() || bounds.upper < depth.next_down() || bounds.upper > depth + 0.02 * l + noise
        {
            return Err(format!("depth {:e} {:e}", bounds.lower, bounds.upper));
        }
        mix.depths += 1;
    }
    let is_shallow = truth.distance.abs() < 1e-4 * l;
    let mut options = ManifoldOptions::default();
    options.prediction = 1e-3 * l;
    let mut tracker = PairTracker::new();
    if is_shallow && let Ok(groups) = tracker.contacts(p, q, pose, &options) {
        let all = groups.iter().flat_map(|group| &group.contacts);
        let Some(deepest) = all.map(|c| c.point.separation).reduce(f64::min) else {
            return Err("no contact".to_owned());
        };
        mix.contacts += 1;
        // Contacts are along normals of faces or of the closest points.
        if deepest > truth.distance + 1e-9 * l || deepest < truth.distance - 1e-3 * l {
            return Err(format!("contact {deepest:e}"));
        }
    }
    Ok(())
}

fn judge_points(mix: &mut Mix, solid: &Solid, body: &Geometry, kind: usize, rng: &mut Rng) -> Result<(), String> {
    let reach = solid.radius * *rng.pick(&[0.5, 1.0, 2.0, 20.0]);
    let mut place = add(solid.middle, scale(rng.in_ball(), reach));
    if rng.chance(0.3) {
        place = *rng.pick(&solid.points);
    }
    let point = exact::Body {
        points: &[place],
        faces: &[],
    };
    let truth = exact::solve(point, &Pose::IDENTITY, solid.body(), &Pose::IDENTITY);
    let found = PointQuery::new(body)
        .closest_point(&place.into())
        .map_err(|e| e.to_string())?;
    mix.points += 1;
    // Pieces and elements are measured as pairs are, about their reference points.
    let (from, radius) = if kind > 1 {
        solid.reference()
    } else {
        (solid.middle, solid.radius)
    };
    let (distance, l) = (truth.distance, radius + norm(sub(place, from)));
    let told = |what: &str| {
        Err(format!(
            "point {what} {:?} {:e} {:e} {distance:e}",
            found.state, found.lower, found.upper
        ))
    };
    let is_out = truth.state == exact::ContactState::Separated;
    if is_out && (found.lower > distance.next_up() || found.upper < distance.next_down()) {
        return told("bounds");
    }
    if is_out && found.upper - found.lower > 1e-13 * l {
        return told("width");
    }
    let is_right = match found.state {
        ContactState::Separated => is_out,
        ContactState::Overlapping => distance <= 0.0 && !is_out,
        _ => distance.abs() <= 1e-13 * l,
    };
    if is_right { Ok(()) } else { told("state") }
}

/// Rays along an axis at a box are judged exactly: the ray is in the frame of the body.
fn judge_rays(mix: &mut Mix, solid: &Solid, body: &Geometry, kind: usize, rng: &mut Rng) -> Result<(), String> {
    let axis = rng.below(3);
    let target = add(solid.middle, scale(rng.in_ball(), 0.9 * solid.radius));
    let mut origin = target;
    origin[axis] -= solid.radius * rng.range(2.0, 20.0);
    let ray = Ray::new(origin.into(), Vector3::from(AXES[axis])).map_err(|e| e.to_string())?;
    // The first crossing with a triangle of a face, over the rationals.
    let truth = along(solid, axis, origin);
    let found = RayCaster::new()
        .cast(body, &Isometry3::identity(), &ray, f64::INFINITY)
        .map_err(|e| e.to_string())?;
    let l = solid.radius + norm(sub(origin, solid.middle));
    // A point that moves along the ray sinks into an oblique face more slowly.
    let most = |cosine: f64| if kind > 1 { 5e-12 / cosine } else { 2e-12 } * l;
    match (found, truth) {
        (RayCast::Hit(hit), Some((at, cosine))) => {
            mix.rays += 1;
            if hit.safe > at.next_up() || hit.hit < at.next_down() || hit.hit - hit.safe > most(cosine) {
                return Err(format!("ray {:e} {:e} {at:e}", hit.safe, hit.hit));
            }
            Ok(())
        }
        (RayCast::Miss, None) => Ok(()),
        // Pieces and elements have no exact stage.
        (RayCast::Undecided { safe }, at) if kind > 1 && at.is_none_or(|at| safe <= at.0.next_up()) => Ok(()),
        (found, truth) => Err(format!("ray {found:?} {truth:?}")),
    }
}

/// Returns how far a ray along an axis travels until it meets a convex solid, and the cosine of its
/// angle with the normal of the face there; `None` if it never does.
fn along(solid: &Solid, axis: usize, origin: Point) -> Option<(f64, f64)> {
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    let of = |p: &Point, k: usize| rational(p[k]) - rational(origin[k]);
    let zero = rational(0.0);
    let mut best = None;
    for face in &solid.faces {
        let p: Vec<&Point> = face.iter().map(|k| &solid.points[*k as usize]).collect();
        let turn = |x: &Point, y: &Point| of(x, i) * of(y, j) - of(x, j) * of(y, i);
        let turns: Vec<_> = (0..p.len()).map(|k| turn(p[k], p[(k + 1) % p.len()])).collect();
        if !(turns.iter().all(|t| *t >= zero) || turns.iter().all(|t| *t <= zero)) {
            continue;
        }
        for k in 1..p.len() - 1 {
            let area = |x: &Point, y: &Point, z: &Point| turn(x, y) + turn(y, z) + turn(z, x);
            let (a, b, c) = (p[0], p[k], p[k + 1]);
            let all = area(a, b, c);
            let (u, v, w) = (turn(b, c), turn(c, a), turn(a, b));
            let signs = [&u, &v, &w];
            if all == zero || !(signs.iter().all(|x| **x >= zero) || signs.iter().all(|x| **x <= zero)) {
                continue;
            }
            let at = (u * of(a, axis) + v * of(b, axis) + w * of(c, axis)) / all;
            if at >= zero && best.as_ref().is_none_or(|(known, _)| at < *known) {
                let normal = cross(sub(*b, *a), sub(*c, *a));
                best = Some((at, normal[axis].abs() / norm(normal)));
            }
        }
    }
    best.map(|(at, cosine)| (rounded(&at), cosine))
}
