//! Predicates and contact states of solids a unit in the last place apart, at the same pose, and at
//! very different scales.

use super::{mesh, relative};
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{Compound, ContactState, ConvexPolyhedron, GeometryRef, Mesh, PairTracker, Piece, RelativePose, Shape};
use truth::Pose;
use truth::pose::{quat, scale};
use truth::rng::Rng;
use truth::soups::{self, Soup};

/// Returns a pyramid upright on z = 0, on its side, or on its top.
fn pyramid(k: usize) -> Soup {
    let base = [[1.0, 1.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, -1.0, 0.0], [1.0, -1.0, 0.0]];
    let mut points = base.to_vec();
    points.push([[0.0, 0.0, 0.5], [0.25, 0.5, 3.0], [0.9, 0.0, 1.0]][k]);
    let triangles = vec![[0, 2, 1], [0, 3, 2], [0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
    Soup::new(points, triangles)
}

fn at(t: [f64; 3]) -> RelativePose {
    relative(&Pose::shift(t))
}

/// Runs all queries for both orders, cold and warm.
fn each(a: &Mesh, b: &Mesh, pose: &RelativePose, check: impl Fn(&str, bool, bool), d: f64) {
    let back = pose.swapped();
    let mut kept = PairTracker::new();
    for round in ["cold", "warm"] {
        check(round, kept.intersects(a, b, pose), kept.within(a, b, pose, d));
    }
    check(
        "turned",
        PairTracker::new().intersects(b, a, &back),
        PairTracker::new().within(b, a, &back, d),
    );
}

#[test]
fn solids_an_ulp_off_a_plate_do_not_meet() {
    let plate = mesh(&soups::plate(1, [4.0, 4.0, 0.5]).map(|[x, y, z]| [x, y, z - 0.5]));
    let others = [
        pyramid(0),
        pyramid(1),
        pyramid(2),
        soups::plate(1, [0.5, 0.25, 0.5]).map(|[x, y, z]| [x, y, z + 0.5]),
    ];
    for (k, other) in others.iter().enumerate() {
        let other = mesh(other);
        for gap in [5e-324, 1e-300, 1e-100, 1e-20, 1e-17, 1e-16, 1e-15, 1e-13] {
            let pose = at([0.3, 0.2, gap]);
            let check = |when: &str, meets: bool, near: bool| assert!(!meets && !near, "{k} {gap:e} {when}");
            // Half of the least number is zero.
            each(&plate, &other, &pose, check, if gap > 1e-320 { 0.5 * gap } else { 0.0 });
            let check = |when: &str, meets: bool, near: bool| assert!(!meets && near, "{k} {gap:e} {when}");
            each(&plate, &other, &pose, check, gap);
        }
        for gap in [0.0, -5e-324, -1e-17, -1e-13] {
            let check = |when: &str, meets: bool, near: bool| assert!(meets && near, "{k} {gap:e} {when}");
            each(&plate, &other, &at([0.3, 0.2, gap]), check, 0.0);
        }
    }
}

#[test]
fn solids_in_a_close_hole_do_not_meet() {
    // A box in the cavity of a box, one unit in the last place below the ceiling: not contained,
    // not in contact.
    let hollow = soups::plate(1, [2.0, 2.0, 2.0]).with(&soups::plate(1, [1.0, 1.0, 1.0]).flipped());
    let hollow = mesh(&hollow);
    let inner = mesh(&soups::plate(1, [0.75, 0.75, 0.25]).map(|[x, y, z]| [x, y, z + (0.75 - 1e-15)]));
    each(
        &hollow,
        &inner,
        &at([0.0; 3]),
        |when, meets, _| assert!(!meets, "{when}"),
        0.0,
    );
    // The same box in a solid box.
    let full = mesh(&soups::plate(1, [2.0, 2.0, 1.0]));
    each(
        &full,
        &inner,
        &at([0.0; 3]),
        |when, meets, _| assert!(meets, "{when}"),
        0.0,
    );
}

/// Solids with every vertex, but not every triangle, within rounding of the other's surface.
#[test]
fn solids_that_fill_the_height_of_a_hole_do_not_meet() {
    let hollow = mesh(&soups::plate(1, [2.0, 2.0, 2.0]).with(&soups::plate(1, [1.0, 1.0, 1.0]).flipped()));
    let full = mesh(&soups::plate(1, [2.0, 2.0, 2.0]));
    let mut rng = Rng::new(93);
    for k in 0..40 {
        let gap = if k == 0 {
            2f64.powi(-53)
        } else {
            rng.log_range(1e-15, 1e-13)
        };
        let half = [rng.range(0.2, 0.8), rng.range(0.2, 0.8), 1.0 - gap];
        // As a box, or as a wedge.
        let taper = if k % 2 == 0 { 1.0 } else { rng.range(0.1, 0.9) };
        let inner = soups::plate(1, half).map(|[x, y, z]| [if z > 0.0 { taper * x } else { x }, y, z]);
        let m = mesh(&inner);
        let pose = at([rng.range(-0.15, 0.15), rng.range(-0.15, 0.15), 0.0]);
        let check = |when: &str, meets: bool, near: bool| assert!(!meets && !near, "{k} {gap:e} {when}");
        each(&hollow, &m, &pose, check, 0.5 * (1.0 - half[2]));
        let check = |when: &str, meets: bool, near: bool| assert!(!meets && near, "{k} {gap:e} {when}");
        each(&hollow, &m, &pose, check, 2.0 * (1.0 - half[2]));
        let check = |when: &str, meets: bool, near: bool| assert!(meets && near, "{k} {gap:e} {when}");
        each(&full, &m, &pose, check, 0.0);
        // As high as the hole.
        let tall = mesh(&inner.map(|[x, y, z]| [x, y, z.signum()]));
        each(&hollow, &tall, &pose, check, 0.0);
    }
}

fn classes(a: &Mesh, b: &Mesh, pose: &RelativePose) -> [ContactState; 4] {
    let mut tracker = PairTracker::new();
    [
        tracker.closest(a, b, pose).state,
        tracker.closest(a, b, pose).state,
        PairTracker::new().closest(b, a, &pose.swapped()).state,
        PairTracker::new().closest(a, b, pose).state,
    ]
}

#[test]
fn bodies_in_one_place_overlap() {
    let mut shapes = super::shapes();
    shapes.extend([soups::sphere(2), pyramid(1), soups::cave(2, 0.7)]);
    for (k, soup) in shapes.iter().enumerate() {
        let m = mesh(soup);
        for t in [[0.0; 3], [5e-324, 0.0, 1e-16]] {
            assert_eq!(classes(&m, &m, &at(t)), [ContactState::Overlapping; 4], "{k} {t:?}");
        }
        // Rotated by no more than rounding.
        let turned = Pose::new(quat([0.6, 0.0, 0.8], 1e-15), [0.0; 3]);
        let answer = classes(&m, &m, &relative(&turned));
        assert_eq!(answer, [ContactState::Overlapping; 4], "{k}");
        // A small copy of the body at the same pose.
        let inner = mesh(&soup.clone().map(|p| scale(p, 0.5)));
        let found = PairTracker::new().closest(&m, &inner, &at([0.0; 3]));
        assert_eq!(
            found.upper > 0.0,
            found.state == ContactState::Separated,
            "{k} {found:?}"
        );
    }
}

#[test]
fn a_part_deep_inside_decides_while_another_touches() {
    let block = mesh(&soups::plate(2, [1.0, 1.0, 1.0]));
    let mut rng = Rng::new(91);
    for k in 0..40 {
        // One component lies on the top, the other one is inside.
        let on = soups::plate(2, [0.25, 0.25, 0.25]).map(|p| [p[0], p[1], p[2] + 1.25]);
        let place = rng.in_ball().map(|x| 0.25 * x);
        let deep = soups::sphere(0).map(|p| [0, 1, 2].map(|i| 0.3 * p[i] + place[i]));
        let both = mesh(&if k % 2 == 0 {
            on.clone().with(&deep)
        } else {
            deep.with(&on)
        });
        let answer = classes(&block, &both, &at([0.0; 3]));
        assert_eq!(answer, [ContactState::Overlapping; 4], "{k}");
        // Without the inner component the bodies touch.
        assert_eq!(classes(&block, &mesh(&on), &at([0.0; 3])), [ContactState::Touching; 4]);
    }
    // Two pins that fill two holes touch all over and share no interior point; pushed sideways they
    // do.
    let slab = soups::plate(1, [2.0, 1.0, 0.5]);
    let hole = |x: f64| {
        soups::plate(1, [0.25, 0.25, 0.5])
            .map(|[a, b, c]| [a + x, b, 0.5 * c])
            .flipped()
    };
    let caves = mesh(&slab.with(&hole(-1.0)).with(&hole(1.0)));
    let pins = mesh(&hole(-1.0).flipped().with(&hole(1.0).flipped()));
    assert_eq!(classes(&caves, &pins, &at([0.0; 3])), [ContactState::Touching; 4]);
    let found = classes(&caves, &pins, &at([0.125, 0.0, 0.0]));
    assert_eq!(found, [ContactState::Overlapping; 4]);
}

#[test]
fn depths_of_bodies_that_hardly_touch_are_small() {
    let plate = mesh(&soups::plate(1, [4.0, 4.0, 0.5]).map(|[x, y, z]| [x, y, z - 0.5]));
    for k in 0..3 {
        for gap in [1e-15, 1e-17, 0.0, -1e-17, -1e-15] {
            let pose = at([0.3, 0.2, gap]);
            let found = PairTracker::new()
                .penetration(&plate, &mesh(&pyramid(k)), &pose)
                .unwrap();
            assert!(found.lower <= 1e-14 && found.upper < 1e-10, "{k} {gap:e} {found:?}");
        }
    }
}

#[test]
fn depths_of_convex_meshes_that_cross_are_proven() {
    let mut rng = Rng::new(92);
    for k in 0..20 {
        let halves = [[1.0, 0.8, 0.01], [0.01, 1.0, 0.7]];
        let [a, b] = halves.map(|h| solids::cuboid(Vector3::from(h)).unwrap());
        let pose = Pose::new(
            if k == 0 {
                Pose::IDENTITY.q
            } else {
                quat(rng.unit(), 0.1)
            },
            [0.0, 0.05, 0.02],
        );
        let depth = -lin_canny::Tracker::new().closest(&a, &b, &relative(&pose)).distance;
        let [m, n] = [&a, &b].map(|p| Mesh::from_convex(p).unwrap());
        let found = PairTracker::new().penetration(&m, &n, &relative(&pose)).unwrap();
        assert!(found.lower <= depth * (1.0 + 1e-12), "{found:?} {depth}");
        assert!(depth <= found.upper, "{found:?} {depth}");
        assert!(found.lower > depth * (1.0 - 1e-9), "{k} {found:?} {depth}");
        let piece = Compound::from(Shape::from(b));
        let found = PairTracker::new().penetration(&m, &piece, &relative(&pose)).unwrap();
        assert!(found.lower > depth * (1.0 - 1e-9), "{k} {found:?} {depth}");
        assert!(depth <= found.upper, "{k} {found:?} {depth}");
    }
}

fn point_body(p: [f64; 3]) -> Compound {
    Compound::from(Shape::from(ConvexPolyhedron::point(Point3::from(p)).unwrap()))
}

#[test]
fn points_at_their_own_origin_are_measured_in_both_orders() {
    let cube = |h: f64| Compound::from(Shape::from(solids::cuboid(Vector3::new(h, h, h)).unwrap()));
    for size in [1e-90, 1e-40, 1.0, 1e40, 1e90] {
        let body = cube(0.5 * size);
        let solid = Mesh::from_convex(&solids::cuboid(Vector3::new(0.5, 0.5, 0.5) * size).unwrap()).unwrap();
        for place in [[0.0; 3], [1e-3 * size, 0.0, 0.0]] {
            let point = point_body(place);
            let pose = at([0.6 * size + place[0], 0.0, 0.0]);
            for other in [GeometryRef::from(&body), GeometryRef::from(&solid)] {
                let this = GeometryRef::from(&point);
                let mut tracker = PairTracker::new();
                for (x, y, pose) in [(&this, &other, pose), (&other, &this, pose.swapped())] {
                    let found = tracker.closest(x, y, &pose);
                    let truth = 0.1 * size;
                    assert_eq!(found.state, ContactState::Separated, "{size:e} {found:?}");
                    assert!(found.lower <= truth * (1.0 + 1e-12) && truth <= found.upper * (1.0 + 1e-12));
                    assert!(found.upper - found.lower < 1e-12 * size, "{size:e} {found:?}");
                    assert!(!tracker.intersects(x, y, &pose) && !tracker.within(x, y, &pose, 0.05 * size));
                    assert!(tracker.lower_bound(x, y, &pose) <= truth * (1.0 + 1e-12));
                }
            }
        }
    }
}

#[test]
fn tiny_bodies_beside_huge_ones_are_measured_in_both_orders() {
    let [small, huge] = [1e-95, 1e40].map(|h| {
        let body = solids::cuboid(Vector3::new(h, h, h)).unwrap();
        (Mesh::from_convex(&body).unwrap(), Compound::from(Shape::from(body)))
    });
    let turn = Isometry3::rotation(Vector3::new(0.0, 0.0, 0.3));
    let place = Isometry3::translation(0.0, 0.0, -3e40) * turn;
    let pose = RelativePose::from_isometry(&place).unwrap();
    let mut tracker = PairTracker::new();
    let ways = [
        (&small.0, &huge.0, pose, place),
        (&huge.0, &small.0, pose.swapped(), place.inverse()),
    ];
    for (a, b, pose, place) in ways {
        let found = tracker.closest(a, b, &pose);
        assert!(found.state == ContactState::Separated && found.lower < 2e40 && found.upper > 2e40 * (1.0 - 1e-15));
        assert!(found.upper - found.lower < 1e28, "{found:?}");
        let apart = place * found.point_on_b - found.point_on_a;
        assert!((apart.norm() / 2e40 - 1.0).abs() < 1e-9 && apart.normalize().dot(&found.normal) > 0.999_999);
        assert!(!tracker.within(a, b, &pose, 1.9e40) && tracker.within(a, b, &pose, 2.1e40));
        assert!(tracker.lower_bound(a, b, &pose) < 2.1e40);
    }
    let mut tracker = PairTracker::new();
    let found = tracker.closest(&small.1, &huge.1, &pose);
    assert!(found.lower > 1.99e40 && found.upper < 2.01e40, "{found:?}");
    assert!(!tracker.intersects(&small.1, &huge.1, &pose));
}

#[test]
fn bodies_a_universe_away_are_apart() {
    let m = Mesh::from_convex(&solids::octahedron(1.0).unwrap()).unwrap();
    let piece = Compound::new(vec![Piece::new(solids::octahedron(1.0).unwrap())]).unwrap();
    for far in [1e100, 1e150, 1e200, 1e300, 1e307, 1.6e308] {
        let pose = at([0.0, far, 0.0]);
        let found = PairTracker::new().closest(&m, &m, &pose);
        assert_eq!(found.state, ContactState::Separated, "{far:e} {found:?}");
        assert!(found.lower <= far, "{found:?}");
        assert!(far <= found.upper, "{found:?}");
        assert!(found.upper.is_finite(), "{found:?}");
        assert!(!PairTracker::new().intersects(&m, &m, &pose), "{far:e}");
        assert!(!PairTracker::new().within(&m, &m, &pose, far * (1.0 - 1e-12)));
        assert!(!PairTracker::new().intersects(&piece, &m, &pose), "{far:e}");
    }
}

#[test]
fn an_unused_point_moves_nothing() {
    let soup = soups::bracket();
    let clean = mesh(&soup);
    for stray in [1e90, -1e115, 1e300, 1e-300] {
        let mut with = soup.clone();
        with.points.push([0.0, stray, 0.0]);
        let m = mesh(&with);
        let report = m.report();
        assert_eq!(report.unused, 1, "{stray:e} {report}");
        assert_eq!(report.flushed_coordinates, 0, "{stray:e} {report}");
        assert_eq!((m.kind(), m.aabb()), (clean.kind(), clean.aabb()));
        assert_eq!(m.vertex_count(), clean.vertex_count());
    }
}
