//! Promise: a half-space has the exact signed distance of every kind of body, at rest and in motion.

use lin_canny::impact::{Impact, Tolerance, cast};
use lin_canny::motion::{Motion, Steady};
use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::scene::{Body, Group, PairQueries, Scene};
use lin_canny::surface::{BezierPatch, BezierSurface};
use lin_canny::{
    Compound, ContactState, DepthMode, Geometry, GeometryKind, HalfSpace, HalfSpaceError, ManifoldOptions, Mesh,
    MeshError, MeshKind, PairTracker, Piece, QueryOptions, Ray, RayCast, RayCaster, RelativePose, Shape, Velocity,
};
use truth::curved::{KINDS, Kind};
use truth::forms::mesh;
use truth::rational::{RBig, exact, over_root, placed, rotation};
use truth::rng::Rng;
use truth::support::Decide;
use truth::{Point, Pose, soups};

/// A convex member of a body: points, or a curved shape, with a rounding radius.
#[derive(Clone, Debug)]
struct Part {
    kind: Kind,
    radius: f64,
    pose: Pose,
}

/// A body and what it is made of.
struct Case {
    geometry: Geometry,
    parts: Vec<Part>,
    /// The bounds may be this much farther apart than those of points, in units of the size.
    slack: f64,
}

fn hull(points: Vec<Point>) -> Part {
    Part {
        kind: Kind::Hull(points),
        radius: 0.0,
        pose: Pose::IDENTITY,
    }
}

fn scaled(kind: &Kind, by: f64) -> Kind {
    match kind {
        Kind::Hull(points) => Kind::Hull(points.iter().map(|p| p.map(|x| x * by)).collect()),
        Kind::Ellipsoid(a) => Kind::Ellipsoid(a.map(|x| x * by)),
        Kind::Cylinder(h, r) => Kind::Cylinder(h * by, r * by),
        Kind::Cone(h, r) => Kind::Cone(h * by, r * by),
    }
}

fn random_soup(rng: &mut Rng, by: f64) -> soups::Soup {
    let soup = match rng.below(4) {
        0 => soups::torus(12, 8, 0.3),
        1 => soups::rock(2, rng.bits()),
        2 => soups::gear(9),
        _ => soups::loose(40, 0.3, rng),
    };
    let aside = rng.unit().map(|x| x * rng.range(0.0, 3.0));
    soup.map(|p| [0, 1, 2].map(|k| (p[k] + aside[k]) * by))
}

/// Returns a random body of a kind.
fn random_case(rng: &mut Rng, k: usize, by: f64) -> Case {
    let convex = |rng: &mut Rng| {
        let name = KINDS[rng.below(KINDS.len())];
        let kind = scaled(&Kind::random(name, rng, 20.0), by);
        let radius = if rng.chance(0.5) {
            0.0
        } else {
            by * rng.log_range(1e-3, 1.0)
        };
        Part {
            kind,
            radius,
            pose: Pose::IDENTITY,
        }
    };
    let shape = |part: &Part| {
        let shape = part.kind.shape();
        if part.radius > 0.0 {
            shape.rounded(part.radius).expect("a radius")
        } else {
            shape
        }
    };
    match k % 5 {
        0 | 1 => {
            let part = convex(rng);
            Case {
                geometry: Geometry::from(shape(&part)),
                parts: vec![part],
                slack: 0.0,
            }
        }
        2 => {
            let soup = random_soup(rng, by);
            Case {
                geometry: Geometry::from(mesh(&soup)),
                parts: vec![hull(soup.points.clone())],
                slack: 0.0,
            }
        }
        3 => {
            let mut parts: Vec<_> = (0..1 + rng.below(6)).map(|_| convex(rng)).collect();
            if rng.chance(0.7) {
                for part in &mut parts {
                    part.pose = Pose::new(rng.quat(), rng.unit().map(|x| x * by * 2.0));
                }
            }
            let piece = |part: &Part| {
                let mut piece = Piece::new(shape(part));
                piece.pose = part.pose.isometry();
                piece
            };
            let compound = Compound::new(parts.iter().map(piece).collect()).expect("a compound");
            for (part, piece) in parts.iter_mut().zip(compound.pieces()) {
                let q = piece.pose.rotation.coords;
                part.pose.q = [q.x, q.y, q.z, q.w];
            }
            Case {
                geometry: Geometry::from(compound),
                parts,
                slack: 2e-14,
            }
        }
        _ => {
            let soup = random_soup(rng, by);
            let mesh = mesh(&soup);
            Case {
                geometry: Geometry::from(BezierSurface::from_mesh(&mesh).expect("a surface")),
                parts: vec![hull(soup.points.clone())],
                slack: 1e-8,
            }
        }
    }
}

/// Returns the points that may be the lowest along a direction after some poses, one after the
/// other.
///
/// Heights are in double precision. The margin is some million times their error.
fn lowest(points: &[Point], along: &Point, poses: &[&Pose]) -> Vec<Point> {
    let place = |p: &Point| poses.iter().fold(*p, |p, pose| pose.apply(p));
    let heights: Vec<_> = points.iter().map(|p| truth::pose::dot(*along, place(p))).collect();
    let sizes = points.iter().chain(poses.iter().map(|pose| &pose.t));
    let size: f64 = sizes.map(|p| truth::pose::norm(*p)).sum();
    let least = heights.iter().copied().fold(f64::INFINITY, f64::min);
    let is_low = |h: &f64| *h <= least + 1e-9 * size;
    let low = points.iter().zip(&heights).filter(|(_, h)| is_low(h));
    low.map(|(p, _)| *p).collect()
}

/// Returns the signed distance of a body from a half-space, rounded once or by about 1e-15 of the
/// size for curved members.
fn truth_of(space: &HalfSpace, pose: &Pose, case: &Case, of_body: &Pose) -> f64 {
    let n: Point = space.normal().into_inner().into();
    let m = rotation(pose.q);
    let (n, t) = (n.map(exact), pose.t.map(exact));
    // The normal in the world, and the offset there.
    let out: [RBig; 3] = std::array::from_fn(|i| &m[i][0] * &n[0] + &m[i][1] * &n[1] + &m[i][2] * &n[2]);
    let up = pose.rotate(space.normal().into_inner().into());
    let dot = |a: &[RBig; 3], b: &[RBig; 3]| &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2];
    let offset = exact(space.offset()) + dot(&out, &t);
    let norm2 = dot(&n, &n);
    let height_of = |part: &Part| {
        let stands = part.pose != Pose::IDENTITY;
        if let Kind::Hull(points) = &part.kind {
            let points = lowest(points, &up, &[&part.pose, of_body]);
            let at = if stands {
                placed(&points, &part.pose)
            } else {
                points.iter().map(|p| p.map(exact)).collect()
            };
            let r = rotation(of_body.q);
            let t = of_body.t.map(exact);
            let heights = at.iter().map(|p| {
                let x: [RBig; 3] =
                    std::array::from_fn(|i| &r[i][0] * &p[0] + &r[i][1] * &p[1] + &r[i][2] * &p[2] + &t[i]);
                dot(&out, &x) - &offset
            });
            return over_root(&heights.min().expect("a point"), &norm2) - part.radius;
        }
        // The direction towards the half-space in the frame of the member, rounded.
        let r = rotation(of_body.q);
        let back = |r: &[[RBig; 3]; 3], v: &[RBig; 3]| -> [RBig; 3] {
            std::array::from_fn(|i| &r[0][i] * &v[0] + &r[1][i] * &v[1] + &r[2][i] * &v[2])
        };
        let in_body = back(&r, &out);
        let in_part = back(&rotation(part.pose.q), &in_body);
        let down = in_part.each_ref().map(|x| -over_root(x, &norm2));
        let origin = dot(&in_body, &part.pose.t.map(exact)) + dot(&out, &of_body.t.map(exact)) - &offset;
        let wide = down.map(truth::curved::Wide::from);
        over_root(&origin, &norm2) - part.kind.height(&wide).0 - part.radius
    };
    case.parts.iter().map(height_of).fold(f64::INFINITY, f64::min)
}

fn judge(seed: u64, count: usize) {
    let mut states = [0; 4];
    for k in 0..count {
        let mut rng = Rng::of_case(seed, k as u64);
        let by = match rng.below(4) {
            0 => 2f64.powi(rng.int(-320, 190) as i32),
            _ => 1.0,
        };
        let case = random_case(&mut rng, k, by);
        let n = rng.unit();
        let space = HalfSpace::new(Vector3::from(n) * 3.0, 3.0 * by * rng.range(-2.0, 2.0)).expect("a half-space");
        let far = by * *rng.pick(&[0.0, 1.0, 1.0, 1e6]);
        let random_pose = |rng: &mut Rng| {
            Pose::new(
                *rng.pick(&[
                    rng.clone().quat(),
                    [0.0, 0.0, 0.0, 1.0],
                    [0.0, 1.0, 0.0, 0.0],
                    [0.5, 0.5, -0.5, 0.5],
                ]),
                rng.unit().map(|x| x * far),
            )
        };
        let of_space = random_pose(&mut rng);
        let mut of_body = random_pose(&mut rng);
        let goal = by * *rng.pick(&[-10.0, -0.3, -1e-6, 0.0, 0.0, 1e-6, 0.5, 30.0]);
        let out = of_space.rotate(space.normal().into_inner().into());
        let before = truth_of(&space, &of_space, &case, &of_body);
        of_body.t = [0, 1, 2].map(|i| of_body.t[i] + out[i] * (goal - before));
        let value = truth_of(&space, &of_space, &case, &of_body);

        let floor = Geometry::from(space);
        let pose = RelativePose::new(&of_space.isometry(), &of_body.isometry()).expect("a pose");
        let mut tracker = PairTracker::new();
        let found = tracker.closest(&floor, &case.geometry, &pose);
        let radius = case
            .parts
            .iter()
            .map(|p| p.kind.radius() + p.radius + truth::pose::norm(p.pose.t));
        let between = truth::pose::sub(of_body.t, of_space.t);
        let size = radius.fold(0.0, f64::max) + truth::pose::norm(between) + space.offset().abs();
        let told = format!(
            "{k}: {value:e} {found:?} {space:?} {of_space:?} {of_body:?} {}",
            case.geometry.kind()
        );
        let noise = if case.slack > 0.0 { 1e-14 * size } else { 0.0 };
        // Far from the origin of the world, translations are subtracted first, and that rounds.
        assert!(found.lower <= value + noise && value - noise <= found.upper, "{told}");
        assert!(found.lower <= found.distance && found.distance <= found.upper, "{told}");
        assert!(found.upper - found.lower <= (2e-13 + case.slack) * size, "{told}");
        let expected = match (found.lower, found.upper) {
            (lower, _) if lower > 0.0 => ContactState::Separated,
            (_, upper) if upper < 0.0 => ContactState::Overlapping,
            _ if case.geometry.kind() == GeometryKind::BezierSurface => ContactState::Undecided,
            _ => ContactState::Touching,
        };
        assert_eq!(found.state, expected, "{told}");
        states[found.state as usize] += 1;
        // The witnesses are opposite each other, on the plane and on the body.
        let (on_a, on_b) = (found.point_on_a, pose_of(&pose) * found.point_on_b);
        let apart = on_b - on_a - found.normal.into_inner() * found.distance;
        assert!(apart.norm() <= (1e-12) * size, "{told}");
        let off = (space.normal().dot(&on_a.coords) - space.offset()).abs();
        assert!(off <= 1e-13 * size, "{told}");
        assert!((found.normal.norm() - 1.0).abs() < 1e-14, "{told}");

        // Both orders and a tracker that has seen another pose.
        let mut swapped = PairTracker::new();
        let back = pose.swapped();
        let _ = swapped.closest(
            &case.geometry,
            &floor,
            &RelativePose::from_isometry(&Isometry3::identity()).unwrap(),
        );
        let other = swapped.closest(&case.geometry, &floor, &back);
        assert_eq!(
            (other.state, other.distance, other.lower, other.upper),
            (found.state, found.distance, found.lower, found.upper),
            "{told}"
        );
        assert_eq!(other.point_on_a, found.point_on_b, "{told}");
        assert_eq!(other.point_on_b, found.point_on_a, "{told}");
        let facing = pose.swapped();
        let turned = pose_of(&facing).rotation * -found.normal.into_inner();
        assert!((turned - other.normal.into_inner()).norm() < 1e-13, "{told}");
        // Predicates.
        for d in [0.0, value.max(0.0), 2.0 * value.abs(), by] {
            let is_within = tracker.within(&floor, &case.geometry, &pose, d);
            assert_eq!(
                is_within,
                swapped.within(&case.geometry, &floor, &back, d),
                "{told} {d:e}"
            );
            assert!(is_within || found.lower > d - case.slack * size, "{told} {d:e}");
            assert!(!is_within || found.lower <= d, "{told} {d:e}");
        }
        assert_eq!(
            tracker.intersects(&floor, &case.geometry, &pose),
            found.lower <= 0.0 || is_open(&found),
            "{told}"
        );
        assert!(!tracker.within(&floor, &case.geometry, &pose, f64::NAN), "{told}");
        assert!(!tracker.within(&floor, &case.geometry, &pose, -1.0), "{told}");
        let flat = QueryOptions::default().depth(DepthMode::None);
        let without = tracker.closest_with(&floor, &case.geometry, &pose, &flat);
        if found.state == ContactState::Overlapping {
            assert_eq!((without.distance, without.upper), (0.0, 0.0), "{told}");
            assert_eq!(without.lower, f64::NEG_INFINITY, "{told}");
        } else {
            assert_eq!(without, found, "{told}");
        }
    }
    assert!(states[..3].iter().all(|n| *n > count / 40), "{states:?}");
}

fn is_open(found: &lin_canny::Outcome) -> bool {
    found.state == ContactState::Undecided
}

fn pose_of(pose: &RelativePose) -> Isometry3<f64> {
    let (a, b) = pose.poses();
    let unit = |i: Isometry3<f64>| {
        Isometry3::from_parts(i.translation, UnitQuaternion::new_normalize(i.rotation.into_inner()))
    };
    unit(a).inverse() * unit(b)
}

#[test]
fn signed_distances_are_those_of_exact_arithmetic() {
    judge(7001, 400);
}

#[test]
#[ignore = "10,000 cases: a minute"]
fn signed_distances_are_those_of_exact_arithmetic_10_000() {
    judge(7002, 10_000);
}

/// Bodies of whole coordinates on planes at whole heights, at poses without rounding: half turns,
/// and turns by a third about a diagonal.
#[test]
fn bodies_that_lie_on_the_plane_touch_it() {
    let mut rng = Rng::new(7003);
    for k in 0..400 {
        let corner = |rng: &mut Rng| [0, 1, 2].map(|_| rng.int(-4, 4) as f64);
        let points: Vec<_> = (0..12).map(|_| Point3::from(corner(&mut rng))).collect();
        let Ok(shape) = Shape::hull(&points) else { continue };
        let body = solids::cuboid(Vector3::new(1.0, 2.0, 3.0)).expect("a box");
        let geometry = match k % 4 {
            0 => Geometry::from(shape),
            1 => Geometry::from(shape.rounded(0.5).expect("a radius")),
            2 => Geometry::from(Mesh::from_convex(&body).expect("a mesh")),
            _ => Geometry::from(Compound::new(vec![Piece::new(shape), Piece::new(body)]).expect("a compound")),
        };
        let turns = [
            [0.0, 0.0, 0.0, 1.0],
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, -1.0, 0.0],
            [0.5, 0.5, 0.5, 0.5],
            [-0.5, 0.5, 0.5, 0.5],
        ];
        let pose = |rng: &mut Rng| Pose::new(*rng.pick(&turns), corner(rng));
        let (of_space, mut of_body) = (pose(&mut rng), pose(&mut rng));
        let axis = rng.below(3);
        let mut normal = Vector3::zeros();
        normal[axis] = rng.sign();
        let space = HalfSpace::new(normal, rng.int(-3, 3) as f64).expect("a half-space");
        let out = of_space.rotate(normal.into());
        let at = |of_body: &Pose| RelativePose::new(&of_space.isometry(), &of_body.isometry()).expect("a pose");
        let mut tracker = PairTracker::new();
        let first = tracker.closest(&space, &geometry, &at(&of_body)).distance;
        assert_eq!(first * 2.0, (first * 2.0).round(), "no rounding");
        for (by, state) in [
            (0.0, ContactState::Touching),
            (1.0, ContactState::Separated),
            (-1.0, ContactState::Overlapping),
        ] {
            let before = tracker.closest(&space, &geometry, &at(&of_body)).distance;
            of_body.t = [0, 1, 2].map(|i| of_body.t[i] + out[i] * (by - before));
            let found = tracker.closest(&space, &geometry, &at(&of_body));
            assert_eq!((found.state, found.distance), (state, by), "{k} {found:?}");
            assert_eq!(tracker.intersects(&space, &geometry, &at(&of_body)), by <= 0.0);
            assert!(tracker.within(&space, &geometry, &at(&of_body), 1.0));
            assert!(!tracker.within(&space, &geometry, &at(&of_body), 1.0 - 1e-9) || by < 1.0);
        }
    }
}

/// A scene in another unit has the same answers in that unit, bit for bit.
#[test]
fn answers_scale_by_powers_of_two() {
    for exponent in [-300, -37, 1, 64, 300] {
        let by = 2f64.powi(exponent);
        for k in 0..40 {
            let answer = |by: f64| {
                let mut rng = Rng::of_case(7004, k);
                let case = random_case(&mut rng, [0, 1, 2, 3][k as usize % 4], by);
                let space = HalfSpace::new(Vector3::from(rng.unit()), by * rng.range(-1.0, 1.0)).expect("one");
                let pose = Pose::new(rng.quat(), rng.unit().map(|x| x * by));
                let pose = RelativePose::from_isometry(&pose.isometry()).expect("a pose");
                let found = PairTracker::new().closest(&space, &case.geometry, &pose);
                [found.distance, found.lower, found.upper].map(|x| x / by)
            };
            let (one, other) = (answer(1.0), answer(by));
            // Bodies are stored in another unit beyond 2^105, where the last bits may differ.
            let near = |x: f64, y: f64| (x - y).abs() <= 1e-14;
            let same = (0..3).all(|i| {
                if exponent.abs() < 100 {
                    one[i] == other[i]
                } else {
                    near(one[i], other[i])
                }
            });
            assert!(same, "{exponent} {k}: {one:?} {other:?}");
        }
    }
}

#[test]
fn bezier_surfaces_have_an_interval() {
    let mut rng = Rng::new(7005);
    for k in 0..40 {
        let degrees = [1 + rng.below(4), 1 + rng.below(4)];
        let points: Vec<_> = truth::nets::bumps(&mut rng, degrees, 0.4)
            .into_iter()
            .map(Point3::from)
            .collect();
        let weights: Vec<f64> = points.iter().map(|_| rng.range(0.5, 2.0)).collect();
        let patch = if k % 2 == 0 {
            BezierPatch::polynomial(degrees, &points)
        } else {
            BezierPatch::rational(degrees, &points, &weights)
        };
        let patch = patch.expect("a patch");
        let surface = BezierSurface::new(vec![patch.clone()]).expect("a surface");
        let space = HalfSpace::new(Vector3::from(rng.unit()), rng.range(-2.0, 2.0)).expect("a half-space");
        let pose = Pose::new(rng.quat(), rng.unit());
        let at = RelativePose::from_isometry(&pose.isometry()).expect("a pose");
        let narrow = QueryOptions::default().width(1e-10);
        let mut tracker = PairTracker::new();
        let found = tracker.closest_with(&space, &surface, &at, &narrow);
        assert!(found.is_converged, "{k} {found:?}");
        assert!(found.upper - found.lower < 1.1e-10, "{k} {found:?}");
        let height = |u: f64, v: f64| {
            let p = Point3::from(pose.apply(patch.point(u, v).into()));
            space.normal().dot(&p.coords) - space.offset()
        };
        let n = 60;
        let grid = (0..=n).flat_map(|i| (0..=n).map(move |j| [i, j].map(|k| f64::from(k) / f64::from(n))));
        let least = grid.map(|[u, v]| height(u, v)).fold(f64::INFINITY, f64::min);
        assert!(found.lower <= least + 1e-13, "{k} {found:?} {least}");
        let [u, v] = found.locations[1].parameters;
        assert!((height(u, v) - found.distance).abs() < 1e-13, "{k} {found:?}");
        // Few splits give a wide interval that contains the narrow one.
        let wide = tracker.closest_with(&space, &surface, &at, &QueryOptions::default().width(0.0).splits(3));
        assert!(wide.lower <= found.upper && found.lower <= wide.upper, "{k} {wide:?}");
        assert!(tracker.decide(&space, &surface, &at, found.upper + 1e-9).is_yes() || found.upper < -1e-9);
        assert!(found.lower < 2e-9 || tracker.decide(&space, &surface, &at, found.lower - 1e-9).is_no());
    }
}

#[test]
fn half_spaces_overlap_unless_their_normals_are_opposite() {
    let floor = HalfSpace::new(Vector3::z(), 1.0).expect("a floor");
    let ceiling = HalfSpace::new(-Vector3::z(), -4.0).expect("a ceiling");
    let wall = HalfSpace::new(Vector3::x(), -50.0).expect("a wall");
    let mut tracker = PairTracker::new();
    let still = RelativePose::from_isometry(&Isometry3::identity()).unwrap();
    let found = tracker.closest(&floor, &ceiling, &still);
    assert_eq!(found.state, ContactState::Separated, "{found:?}");
    assert_eq!(found.distance, 3.0, "{found:?}");
    assert!(tracker.within(&floor, &ceiling, &still, 3.0) && !tracker.within(&floor, &ceiling, &still, 2.9));
    let lower = RelativePose::from_isometry(&Isometry3::translation(5.0, 1.0, -4.0)).unwrap();
    let found = tracker.closest(&floor, &ceiling, &lower);
    assert_eq!(found.state, ContactState::Overlapping, "{found:?}");
    assert_eq!(found.distance, -1.0, "{found:?}");
    for other in [&wall, &floor] {
        let found = tracker.closest(&floor, other, &still);
        assert_eq!(found.state, ContactState::Overlapping, "{found:?}");
        assert_eq!(found.distance, 0.0, "{found:?}");
        assert_eq!(found.lower, f64::NEG_INFINITY);
        assert!(tracker.intersects(&floor, other, &still));
    }
    // Rotations about the normal keep the planes parallel, up to rounding.
    for angle in [0.1, 1.0, 3.0] {
        let turned = Isometry3::rotation(Vector3::z() * angle);
        let found = tracker.closest(&floor, &ceiling, &RelativePose::from_isometry(&turned).unwrap());
        assert!((found.distance - 3.0).abs() < 1e-14, "{found:?}");
    }
    let tilted = RelativePose::from_isometry(&Isometry3::rotation(Vector3::x() * 1e-12)).unwrap();
    let answer = tracker.closest(&floor, &ceiling, &tilted).state;
    assert_eq!(answer, ContactState::Overlapping);
    assert!(
        tracker
            .contacts(&floor, &wall, &still, &ManifoldOptions::default().prediction(1.0))
            .unwrap()
            .is_empty()
    );
}

/// Casts of every kind: free before `safe`, and met at `hit`, judged by exact distances.
fn judge_casts(seed: u64, count: usize) {
    let mut found_hits = 0;
    for k in 0..count {
        let mut rng = Rng::of_case(seed, k as u64);
        let by = *rng.pick(&[1.0, 1.0, 2f64.powi(-200), 2f64.powi(150)]);
        let case = random_case(&mut rng, [0, 1, 2, 3, 4][k % 5], by);
        let space = HalfSpace::new(Vector3::from(rng.unit()), by * rng.range(-1.0, 1.0)).expect("a half-space");
        let turning = |rng: &mut Rng, most: f64| {
            if rng.chance(0.4) {
                Vector3::zeros()
            } else {
                Vector3::from(rng.unit()) * rng.range(0.0, most)
            }
        };
        let of_space = Pose::new(rng.quat(), rng.unit().map(|x| x * by));
        let mut of_body = Pose::new(rng.quat(), rng.unit().map(|x| x * by));
        let out = of_space.rotate(space.normal().into_inner().into());
        let before = truth_of(&space, &of_space, &case, &of_body);
        let gap = by * rng.log_range(1e-3, 10.0);
        of_body.t = [0, 1, 2].map(|i| of_body.t[i] + out[i] * (gap - before));
        let spin = turning(&mut rng, 0.5);
        let of_floor = Velocity::new(Vector3::from(rng.unit()) * by * rng.range(0.0, 0.5), spin);
        let sink = -Vector3::from(out) * gap * rng.range(0.0, 4.0);
        let aside = Vector3::from(rng.unit()) * by * rng.range(0.0, 2.0);
        let thrown = Velocity::new(sink + aside, turning(&mut rng, 4.0));
        let first = Steady::new(&of_space.isometry(), of_floor).expect("a motion");
        let second = Steady::new(&of_body.isometry(), thrown).expect("a motion");
        let mut tracker = PairTracker::new();
        let is_swapped = rng.chance(0.5);
        let tolerance = Tolerance::Distance(by * 1e-7);
        let found = if is_swapped {
            let mut pair = tracker.pair(&case.geometry, &space);
            cast(&mut pair, &second, &first, 0.0..1.0, tolerance)
        } else {
            let mut pair = tracker.pair(&space, &case.geometry);
            cast(&mut pair, &first, &second, 0.0..1.0, tolerance)
        };
        let found = found.expect("a cast");
        let told = format!("{k}: {found:?} {} {of_floor:?} {thrown:?}", case.geometry.kind());
        let height = |time: f64| {
            let of = |motion: &Steady| {
                let p = motion.pose(time);
                let q = p.rotation.coords;
                Pose::new([q.x, q.y, q.z, q.w], p.translation.vector.into())
            };
            truth_of(&space, &of(&first), &case, &of(&second))
        };
        let free_until = match found.impact {
            Impact::Miss => 1.0,
            Impact::Hit { safe, hit, .. } => {
                found_hits += 1;
                assert!(safe < hit && height(hit) <= 1e-13 * by, "{told} {:e}", height(hit));
                assert!(height(safe) >= -1e-13 * by, "{told} {:e}", height(safe));
                assert!(height(safe) <= 2e-7 * by, "{told} {:e}", height(safe));
                safe
            }
            other => panic!("{other:?} {told}"),
        };
        for i in 0..=20 {
            let time = free_until * f64::from(i) / 20.0;
            assert!(height(time) > -1e-13 * by, "{told} {time} {:e}", height(time));
        }
        assert!(found.queries < 200, "{told}");
    }
    assert!(found_hits > count / 4, "{found_hits}");
}

#[test]
fn casts_are_free_before_and_met_after() {
    judge_casts(7006, 100);
}

#[test]
#[ignore = "10,000 casts: minutes"]
fn casts_are_free_before_and_met_after_10_000() {
    judge_casts(7007, 10_000);
}

#[test]
fn bodies_at_rest_stand_on_their_contacts() {
    let floor = Geometry::from(HalfSpace::new(Vector3::z(), 0.0).expect("a floor"));
    let die = solids::cuboid(Vector3::repeat(1.0)).expect("a box");
    let mut leg = Piece::new(solids::cuboid(Vector3::new(0.1, 0.1, 1.0)).expect("a leg"));
    let legs: Vec<_> = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
        .map(|[x, y]| {
            leg.pose = Isometry3::translation(x, y, 0.0);
            leg.clone()
        })
        .into();
    let table = Compound::new(legs).expect("a table");
    let options = ManifoldOptions::default().prediction(0.02);
    let bodies = [
        (Geometry::from(die.clone()), 4, 1.0),
        (Geometry::from(Shape::from(die.clone()).rounded(0.25).unwrap()), 4, 1.25),
        (Geometry::from(Mesh::from_convex(&die).unwrap()), 4, 1.0),
        (Geometry::from(table), 4, 1.0),
        (Geometry::from(Shape::cylinder(1.0, 0.5).unwrap()), 4, 1.0),
        (Geometry::from(Shape::ball(1.0).unwrap()), 1, 1.0),
        (
            Geometry::from(Shape::ellipsoid(Vector3::new(2.0, 2.0, 1.0)).unwrap()),
            1,
            1.0,
        ),
        (Geometry::from(BezierSurface::from_convex(&die).unwrap()), 1, 1.0),
    ];
    for (body, count, height) in &bodies {
        for sink in [0.01, 0.0, -0.01] {
            let at = RelativePose::from_isometry(&Isometry3::translation(3.0, -2.0, height + sink)).unwrap();
            let mut tracker = PairTracker::new();
            let groups = tracker
                .contacts(&floor, body, &at, &options)
                .expect("contacts")
                .to_vec();
            let told = format!("{} {sink} {groups:?}", body.kind());
            assert_eq!((groups.len(), groups[0].contacts.len()), (1, *count), "{told}");
            for contact in &groups[0].contacts {
                let point = &contact.point;
                assert!((point.separation - sink).abs() < 1e-8, "{told}");
                assert!(point.point_on_a.z.abs() < 1e-8, "{told}");
                let on_b = pose_of(&at) * point.point_on_b;
                let off = (on_b - point.point_on_a - Vector3::z() * point.separation).norm();
                assert!(off < 1e-12, "{told}");
            }
            // Around the centre: no gap of half a turn.
            if *count == 4 {
                let mut angles: Vec<f64> = groups[0]
                    .contacts
                    .iter()
                    .map(|c| c.point.point_on_b.coords)
                    .map(|p| p.y.atan2(p.x))
                    .collect();
                angles.sort_by(f64::total_cmp);
                angles.push(angles[0] + std::f64::consts::TAU);
                assert!(angles.windows(2).all(|w| w[1] - w[0] < 3.0), "{told}");
            }
            let back = tracker
                .contacts(body, &floor, &at.swapped(), &options)
                .expect("contacts");
            assert_eq!(back[0].contacts.len(), *count);
            for (x, y) in back[0].contacts.iter().zip(&groups[0].contacts) {
                assert_eq!(x.point.point_on_a, y.point.point_on_b);
                assert_eq!(x.point.point_on_b, y.point.point_on_a);
                assert_eq!(x.point.features, y.point.features.swapped());
                assert!((x.normal.into_inner() + Vector3::z()).norm() < 1e-14);
            }
        }
        let above = RelativePose::from_isometry(&Isometry3::translation(0.0, 0.0, height + 0.1)).unwrap();
        assert!(
            PairTracker::new()
                .contacts(&floor, body, &above, &options)
                .unwrap()
                .is_empty()
        );
    }
    // A cylinder on its side has both ends of its line.
    let can = Geometry::from(Shape::cylinder(1.0, 0.5).unwrap());
    let lying = Isometry3::new(
        Vector3::new(0.0, 0.0, 0.499),
        Vector3::x() * std::f64::consts::FRAC_PI_2,
    );
    let lying = RelativePose::from_isometry(&lying).unwrap();
    let mut tracker = PairTracker::new();
    let groups = tracker.contacts(&floor, &can, &lying, &options).unwrap();
    let xs: Vec<f64> = groups[0].contacts.iter().map(|c| c.point.point_on_a.y.abs()).collect();
    assert!(xs.len() == 2, "{groups:?}");
    assert!(xs.iter().all(|y| (y - 1.0).abs() < 1e-12), "{groups:?}");
}

#[test]
fn rays_meet_the_plane() {
    let mut rng = Rng::new(7008);
    let mut caster = RayCaster::new();
    for _ in 0..200 {
        let by = *rng.pick(&[1.0, 1e-90, 1e90]);
        let space = HalfSpace::new(Vector3::from(rng.unit()), by * rng.range(-1.0, 1.0)).unwrap();
        let pose = Pose::new(rng.quat(), rng.unit().map(|x| x * by));
        let origin = Point3::from(rng.unit().map(|x| x * by * 3.0));
        let ray = Ray::new(origin, Vector3::from(rng.unit())).unwrap();
        let floor = Geometry::from(space);
        let n = Vector3::from(pose.rotate(space.normal().into_inner().into()));
        let height = |p: Point3<f64>| n.dot(&(p.coords - Vector3::from(pose.t))) - space.offset();
        let (start, pace) = (height(origin), -n.dot(&ray.direction));
        match caster.cast(&floor, &pose.isometry(), &ray, f64::INFINITY).unwrap() {
            RayCast::Inside => assert!(start <= 1e-13 * by),
            RayCast::Miss => assert!(start > 0.0 && pace <= 1e-14),
            RayCast::Hit(hit) => {
                let at = start / pace;
                assert!(hit.safe <= at * (1.0 + 1e-13), "{hit:?} {at}");
                assert!(at <= hit.hit * (1.0 + 1e-13), "{hit:?} {at}");
                assert!(hit.hit - hit.safe <= 1e-12 * by / pace + 1e-13 * at / pace, "{hit:?}");
                assert!(height(hit.point).abs() <= 1e-12 * (by + at) && (hit.normal.into_inner() - n).norm() < 1e-12);
                let short = caster.cast(&floor, &pose.isometry(), &ray, 0.99 * at).unwrap();
                assert_eq!(short, RayCast::Miss);
            }
            other => panic!("{other:?} {start} {pace}"),
        }
    }
}

/// A floor in a scene pairs with every body that may touch it, and answers all queries.
#[test]
fn scenes_have_floors() {
    let (all, moving) = (Group::default(), Group::new(1).unwrap());
    let mut scene = Scene::new();
    let queries = PairQueries::none()
        .overlap(true)
        .distance(0.5)
        .features(true)
        .depth(true);
    scene
        .set_queries(
            all,
            moving,
            queries.manifold(ManifoldOptions::default().prediction(0.02)),
        )
        .unwrap();
    let tilted = HalfSpace::new(Vector3::new(0.1, 0.0, 1.0), -50.0).unwrap();
    let floor = HalfSpace::new(Vector3::z(), 0.0).unwrap();
    let fixed = scene.insert(Body::fixed(floor), Isometry3::identity()).unwrap();
    let slope = scene.insert(Body::fixed(tilted), Isometry3::identity()).unwrap();
    let die = Geometry::from(solids::cuboid(Vector3::repeat(0.5)).unwrap());
    let part = Geometry::from(Mesh::from_convex(&solids::cuboid(Vector3::repeat(0.5)).unwrap()).unwrap());
    let ids: Vec<_> = (0..100)
        .map(|k| {
            let shape = if k % 2 == 0 { &die } else { &part };
            let at = Isometry3::translation(3.0 * f64::from(k % 10), 3.0 * f64::from(k / 10), 0.5);
            scene.insert(Body::moving(shape.clone()).group(moving), at).unwrap()
        })
        .collect();
    for height in [0.49, 0.5, 0.6, 1.2, 0.45] {
        for (k, id) in (0..).zip(&ids) {
            let at = Isometry3::translation(3.0 * f64::from(k % 10), 3.0 * f64::from(k / 10), height);
            scene.set_pose(*id, at).unwrap();
        }
        scene.step();
        scene.check().unwrap();
        for id in &ids {
            let pair = scene.pair(fixed, *id);
            let distance = pair.as_ref().and_then(|p| p.distance);
            if height - 0.5 > 0.5 {
                assert!(distance.is_none(), "{distance:?}");
                continue;
            }
            let distance = distance.expect("a distance");
            assert!((distance.value - (height - 0.5)).abs() < 1e-13, "{distance:?} {height}");
            assert!(distance.lower > f64::NEG_INFINITY);
            let found = pair
                .unwrap()
                .contacts
                .map_or(0, |groups| groups.iter().map(|g| g.contacts.len()).sum());
            assert_eq!(found, if height <= 0.52 { 4 } else { 0 }, "{height}");
            assert!(scene.pair(slope, *id).and_then(|p| p.distance).is_none());
        }
    }
    let down = Ray::new(Point3::new(1.5, 1.5, 7.0), -Vector3::z()).unwrap();
    let (hit, found) = scene
        .cast_ray(&down, f64::INFINITY, |_| true)
        .unwrap()
        .expect("the floor");
    assert_eq!(hit, fixed);
    assert!(
        matches!(found, RayCast::Hit(h) if (h.safe - 7.0).abs() < 1e-12),
        "{found:?}"
    );
    // Fast bodies do not fall through, and a moving floor is followed.
    let mut scene = Scene::new();
    scene
        .set_queries(
            all,
            all,
            PairQueries::none().overlap(true).impact(Tolerance::Time(1e-9)),
        )
        .unwrap();
    let lift = scene.insert(Body::moving(floor), Isometry3::identity()).unwrap();
    let ball = scene
        .insert(
            Body::moving(Shape::ball(0.5).unwrap()),
            Isometry3::translation(0.0, 0.0, 100.5),
        )
        .unwrap();
    scene
        .set_velocity(ball, Velocity::new(-Vector3::z() * 1e4, Vector3::zeros()))
        .unwrap();
    scene.advance(1.0).unwrap();
    scene.step();
    let [impact] = scene.impacts() else {
        panic!("through the floor")
    };
    assert!(
        matches!(impact.impact, Impact::Hit { safe, hit, .. } if safe <= 0.01 && 0.01 <= hit),
        "{impact:?}"
    );
    scene.set_velocity(ball, Velocity::default()).unwrap();
    scene.set_pose(ball, Isometry3::translation(0.0, 0.0, 10.0)).unwrap();
    scene.step();
    assert!(scene.pair(lift, ball).is_none_or(|p| p.overlaps != Some(true)));
    scene.set_pose(lift, Isometry3::translation(0.0, 0.0, 9.75)).unwrap();
    scene.step();
    assert!(scene.pair(lift, ball).is_some_and(|p| p.overlaps == Some(true)));
}

#[test]
fn bad_half_spaces_are_refused() {
    for normal in [[0.0; 3], [f64::NAN, 0.0, 1.0], [f64::INFINITY, 0.0, 0.0]] {
        assert!(matches!(
            HalfSpace::new(normal.into(), 0.0),
            Err(HalfSpaceError::Normal(_))
        ));
    }
    for offset in [f64::NAN, f64::INFINITY, 1e117] {
        assert!(matches!(
            HalfSpace::new(Vector3::x(), offset),
            Err(HalfSpaceError::Offset(_))
        ));
    }
    // The largest poses and offsets still have an answer.
    let space = HalfSpace::new(Vector3::new(1.0, 2.0, 3.0), 1e116).unwrap();
    let ball = Shape::ball(1e-100).unwrap();
    for t in [[1e308, 0.0, 0.0], [-5e307; 3], [5e307; 3], [0.0; 3], [1e-320, 0.0, 0.0]] {
        let pose = RelativePose::from_isometry(&Pose::shift(t).isometry()).unwrap();
        let found = PairTracker::new().closest(&space, &ball, &pose);
        assert!(!found.lower.is_nan(), "{found:?}");
        assert!(!found.upper.is_nan(), "{found:?}");
        assert!(!found.distance.is_nan(), "{found:?}");
        assert!(found.lower <= found.distance, "{found:?}");
        assert!(found.distance <= found.upper, "{found:?}");
    }
}

#[cfg(feature = "serde")]
#[test]
fn half_spaces_are_stored_bit_for_bit() {
    let mut rng = Rng::new(7009);
    for _ in 0..100 {
        let space = HalfSpace::new(Vector3::from(rng.unit()) * 7.0, rng.range(-9.0, 9.0)).unwrap();
        let geometry = Geometry::from(space);
        let text = serde_json::to_string(&geometry).unwrap();
        let back: Geometry = serde_json::from_str(&text).unwrap();
        let Geometry::HalfSpace(back) = back else {
            panic!("{text}")
        };
        assert_eq!(*back, space, "{text}");
    }
    let refused = serde_json::from_str::<HalfSpace>(r#"{"normal":[0.0,0.0,0.0],"offset":1.0}"#);
    assert!(refused.is_err());
}

#[test]
fn height_fields_are_meshes() {
    let mut rng = Rng::new(7010);
    for _ in 0..20 {
        let (rows, columns) = (2 + rng.below(6), 2 + rng.below(6));
        let spacing = [rng.range(0.5, 2.0), rng.range(0.5, 2.0)];
        let heights: Vec<f64> = (0..rows * columns).map(|_| rng.range(0.0, 1.0)).collect();
        let solid = Mesh::from_heights(rows, columns, spacing, &heights, Some(-0.5)).unwrap();
        let open = Mesh::from_heights(rows, columns, spacing, &heights, None).unwrap();
        assert!((solid.kind(), open.kind()) == (MeshKind::Solid, MeshKind::Open));
        assert_eq!(open.triangle_count(), 2 * (rows - 1) * (columns - 1));
        // Along vertical rays the surface is where the two triangles of a square have it.
        let (i, j) = (rng.below(rows - 1), rng.below(columns - 1));
        let [u, v] = [rng.uniform(), rng.uniform()];
        let z = |i: usize, j: usize| heights[i * columns + j];
        let (a, b, c, d) = (z(i, j), z(i, j + 1), z(i + 1, j + 1), z(i + 1, j));
        let expected = if v < u {
            a + (b - a) * u + (c - b) * v
        } else {
            a + (c - d) * u + (d - a) * v
        };
        let origin = Point3::new((j as f64 + u) * spacing[0], (i as f64 + v) * spacing[1], 5.0);
        let ray = Ray::new(origin, -Vector3::z()).unwrap();
        for mesh in [&solid, &open] {
            let found = RayCaster::new().cast(mesh, &Isometry3::identity(), &ray, 20.0).unwrap();
            assert!(
                matches!(found, RayCast::Hit(h) if (5.0 - h.safe - expected).abs() < 1e-10),
                "{found:?} {expected}"
            );
        }
        let up = Ray::new(Point3::new(origin.x, origin.y, -5.0), Vector3::z()).unwrap();
        let found = RayCaster::new()
            .cast(&solid, &Isometry3::identity(), &up, 20.0)
            .unwrap();
        assert!(
            matches!(found, RayCast::Hit(h) if (h.safe - 4.5).abs() < 1e-10),
            "{found:?}"
        );
    }
    let build =
        |rows, columns, spacing, heights: &[f64], base| Mesh::from_heights(rows, columns, spacing, heights, base);
    let refused = |found: Result<Mesh, MeshError>| found.expect_err("bad input").to_string();
    let four = [0.0; 4];
    assert!(refused(build(1, 4, [1.0; 2], &four, None)).contains("4 heights for 1 rows"));
    assert!(refused(build(2, 3, [1.0; 2], &four, None)).contains("4 heights for 2 rows and 3 columns"));
    assert!(refused(build(usize::MAX, 2, [1.0; 2], &four, None)).contains("heights for"));
    assert!(refused(build(2, 2, [1.0, -2.0], &four, None)).contains("axis 1 is -2"));
    assert!(refused(build(2, 2, [f64::NAN, 1.0], &four, None)).contains("axis 0 is NaN"));
    assert!(refused(build(2, 2, [1.0; 2], &[0.0, 0.0, f64::NAN, 0.0], None)).contains("height 2 is NaN"));
    assert!(refused(build(2, 2, [1.0; 2], &[0.0, -2.0, 0.0, 0.0], Some(-1.0))).contains("height 1 is -2"));
    assert!(refused(build(2, 2, [1.0; 2], &four, Some(0.0))).contains("height 0 is 0"));
    assert!(refused(build(2, 2, [1.0; 2], &four, Some(f64::NAN))).contains("base"));
}

/// Prints the time of steps of 1,000 boxes that bounce on a floor: a half-space, along an axis and
/// oblique, and a wide box.
#[test]
#[ignore = "prints times"]
fn a_floor_under_1_000_boxes() {
    let (all, moving) = (Group::default(), Group::new(1).unwrap());
    let plate = solids::cuboid(Vector3::new(1e3, 1e3, 1.0)).unwrap();
    let tilted = Isometry3::rotation(Vector3::x() * 0.3);
    let floors = [
        ("box", Geometry::from(plate), Isometry3::translation(0.0, 0.0, -1.0)),
        (
            "half-space",
            Geometry::from(HalfSpace::new(Vector3::z(), 0.0).unwrap()),
            Isometry3::identity(),
        ),
        (
            "oblique",
            Geometry::from(HalfSpace::new(Vector3::z(), 0.0).unwrap()),
            tilted,
        ),
    ];
    for (name, floor, at) in floors {
        let mut scene = Scene::new();
        scene
            .set_queries(all, moving, PairQueries::none().overlap(true).distance(0.1).depth(true))
            .unwrap();
        scene.insert(Body::fixed(floor), at).unwrap();
        let die = Geometry::from(solids::cuboid(Vector3::repeat(0.5)).unwrap());
        let place = |k: u32, step: u32| {
            let top = if name == "box" { 1.0 } else { 0.0 };
            let height = top + 0.5 + f64::from((k * 7 + step) % 40) * 0.02;
            at * Isometry3::translation(2.0 * f64::from(k % 32), 2.0 * f64::from(k / 32), height)
        };
        let ids: Vec<_> = (0..1000)
            .map(|k| {
                scene
                    .insert(Body::moving(die.clone()).group(moving), place(k, 0))
                    .unwrap()
            })
            .collect();
        let mut best = f64::INFINITY;
        for step in 0..60 {
            for (k, id) in (0..).zip(&ids) {
                scene.set_pose(*id, place(k, step)).unwrap();
            }
            let start = std::time::Instant::now();
            scene.step();
            best = best.min(start.elapsed().as_secs_f64());
        }
        println!("{name}: {:.1} us a step, {} pairs", best * 1e6, scene.pairs().count());
    }
}
