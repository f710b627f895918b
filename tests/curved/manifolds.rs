//! Promise: contacts of shapes lie on both surfaces, opposite each other along the normal, never
//! deeper than the outcome; contacts of a shape at rest stay fixed.

use super::at_gap;
use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::{ContactPoint, ContactState, Manifold, ManifoldOptions, PairTracker, Shape, Tracker};
use truth::curved::{KINDS, Kind, Place, wide};
use truth::rng::Rng;

const R: f64 = 0.5;

fn plate() -> Kind {
    let half = [3.0, 3.0, 0.5];
    let corner = |k: usize| [0, 1, 2].map(|a| if k >> a & 1 == 1 { half[a] } else { -half[a] });
    Kind::Hull((0..8).map(corner).collect())
}

/// Returns a quarter turn about x: the axis is along -y.
fn lying() -> [f64; 4] {
    let s = 0.5f64.sqrt();
    [s, 0.0, 0.0, s]
}

/// Returns `place` with noise of `size` in translation and rotation.
fn trembled(place: &Place, size: f64, rng: &mut Rng) -> Place {
    let (turn, shift) = (truth::pose::quat(rng.unit(), size * rng.range(0.0, 1.0)), rng.in_ball());
    Place::new(
        truth::pose::unit_quat(truth::pose::quat_mul(turn, place.q)),
        [0, 1, 2].map(|k| place.t[k] + size * shift[k]),
    )
}

/// Judges the properties of any contact.
fn judge(kinds: [&Kind; 2], place: &Place, manifold: &Manifold, told: &str) {
    let size = place.size(kinds[0], kinds[1]);
    let (at, n) = (place.isometry(), manifold.normal());
    for (k, p) in manifold.points().iter().enumerate() {
        let between = at * p.point_on_b - p.point_on_a;
        // Points of cached contacts stay fixed.
        let width = manifold.upper() - manifold.lower();
        // Witness points of a distance within these bounds are beside the normal by no more.
        let beside = (width * (manifold.upper() + manifold.lower()).abs()).sqrt();
        let apart = 1e-9 * size + beside;
        let off = if manifold.is_fresh() {
            between - *n * p.separation
        } else {
            Vector3::zeros()
        };
        assert!(off.norm() <= apart, "not opposite by {:e}: {p:?} {told}", off.norm());
        assert!(
            (between.dot(&n) - p.separation).abs() <= 1e-12 * size + width,
            "not as deep: {p:?} {told}"
        );
        assert!(
            p.separation >= manifold.lower() - 1e-12 * size,
            "too deep: {p:?} {told}"
        );
        for (kind, point) in [(kinds[0], p.point_on_a), (kinds[1], p.point_on_b)] {
            let outside = kind.outside(&wide(point.coords.into()));
            assert!(outside <= 1e-12 * size, "outside by {outside:e}: {p:?} {told}");
        }
        let twin = |q: &ContactPoint| q.id == p.id;
        assert!(!manifold.points()[..k].iter().any(twin), "two of one id: {told}");
    }
}

/// Cylinder and cone rest on a plate, trembling by 1e-7 of the radius.
///
/// 1,000 frames, separated and overlapping, with contacts computed every frame (no drift) or with
/// the default options.
#[test]
fn contacts_at_rest_stand_still() {
    let (can, hat, floor) = (Kind::Cylinder(1.0, R), Kind::Cone(1.0, R), plate());
    let (up, over) = ([0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 0.0]);
    let cases = [
        (&can, up, 1.0, 4),
        (&can, over, 1.0, 4),
        (&can, lying(), R, 2),
        (&hat, up, 1.0, 4),
    ];
    let mut rng = Rng::new(2160);
    for (kind, q, height, points) in cases {
        for (gap, drift) in [
            (1e-3, 0.0),
            (1e-3, 1.0 / 1024.0),
            (-1e-4, 0.0),
            (-1e-4, 1.0 / 1024.0),
            (1e-9, 0.0),
        ] {
            // Rotated about z, so that no axis of the shape is an axis of the plate.
            let yaw = truth::pose::quat([0.0, 0.0, 1.0], 0.3);
            let rest = Place::new(
                truth::pose::unit_quat(truth::pose::quat_mul(yaw, q)),
                [0.2, -0.3, 0.5 + height + gap],
            );
            let mut options = ManifoldOptions::default().prediction(0.01);
            options.rebuild_motion = drift;
            let (a, b) = (floor.shape(), kind.shape());
            let (mut pair, mut manifold) = (PairTracker::new(), Manifold::new());
            let mut first: Vec<ContactPoint> = Vec::new();
            let mut moved = 0.0f64;
            for frame in 0..1000 {
                let place = trembled(&rest, 1e-7 * R, &mut rng);
                pair.manifold(&a, &b, &place.pose(), &options, &mut manifold).unwrap();
                let told = format!("{kind:?} gap {gap} drift {drift} frame {frame} {place:?}");
                judge([&floor, kind], &place, &manifold, &told);
                assert_eq!(manifold.points().len(), points, "{told} {:?}", manifold.points());
                if frame == 0 {
                    first = manifold.points().to_vec();
                }
                for (p, f) in manifold.points().iter().zip(&first) {
                    assert_eq!(p.id, f.id, "{told}");
                    let on_a = (p.point_on_a - f.point_on_a).norm();
                    moved = moved.max(on_a.max((p.point_on_b - f.point_on_b).norm()));
                }
            }
            assert!(
                moved <= 1e-6 * R,
                "{kind:?} gap {gap} drift {drift}: contacts wander by {moved:e}"
            );
        }
    }
}

/// A cylinder at the edge and at the corner of a plate, and on another cylinder: the crossings of
/// its rim and the edges.
#[test]
fn caps_are_clipped_by_edges_and_by_caps() {
    let (can, floor) = (Kind::Cylinder(1.0, R), plate());
    let mut options = ManifoldOptions::default().prediction(0.01);
    options.max_points = 8;
    let contacts = |a: &Kind, t: [f64; 3]| {
        let q = truth::pose::quat([0.0, 0.0, 1.0], 0.1);
        let place = Place::new(q, t);
        let mut manifold = Manifold::new();
        PairTracker::new()
            .manifold(&a.shape(), &can.shape(), &place.pose(), &options, &mut manifold)
            .unwrap();
        judge([a, &can], &place, &manifold, &format!("{a:?} {t:?}"));
        manifold
    };
    let has = |m: &Manifold, p: [f64; 2]| {
        let near = |c: &ContactPoint| (c.point_on_a.xy() - Point3::from([p[0], p[1], 0.0]).xy()).norm() < 1e-12;
        assert!(m.points().iter().any(near), "{p:?} is missing: {:?}", m.points());
    };
    // Half over the edge x = 3.
    let m = contacts(&floor, [3.0, 0.0, 1.501]);
    has(&m, [3.0, R]);
    has(&m, [3.0, -R]);
    // Over the corner: the corner and a crossing on each edge.
    let m = contacts(&floor, [3.0, 3.0, 1.501]);
    has(&m, [3.0, 3.0]);
    has(&m, [3.0, 3.0 - R]);
    has(&m, [3.0 - R, 3.0]);
    // Two caps whose rims cross.
    let d = R;
    let m = contacts(&can, [d, 0.0, 2.001]);
    let across = (R * R - d * d / 4.0).sqrt();
    has(&m, [d / 2.0, across]);
    has(&m, [d / 2.0, -across]);
    // A plate smaller than the cap: all its vertices.
    let small = Kind::Hull(
        (0..8)
            .map(|k| [0, 1, 2].map(|a| if k >> a & 1 == 1 { 0.2 } else { -0.2 }))
            .collect(),
    );
    let m = contacts(&small, [0.0, 0.0, 1.201]);
    for p in [[0.2, 0.2], [-0.2, 0.2], [-0.2, -0.2], [0.2, -0.2]] {
        has(&m, p);
    }
    assert_eq!(m.points().len(), 4);
}

/// All pairs of kinds, near contact and tilted by 0 to 1 degree from flush.
#[test]
fn contacts_of_all_pairs_are_sound() {
    let (counts, overlapping) = sound_contacts(2161, &KINDS, 2000);
    println!("contacts: {counts:?}, overlapping {overlapping}");
    assert!(
        counts[1] > 500 && counts[2] > 50 && counts[4] > 50 && overlapping > 100,
        "{counts:?} {overlapping}"
    );
}

/// The rims and generators of cylinders and cones, of which some nearly touch along a tangent.
#[test]
fn contacts_of_rims_are_sound() {
    sound_contacts(2162, &["cylinder", "cone"], 4000);
}

#[test]
#[ignore = "600,000 pairs"]
fn contacts_of_all_pairs_are_sound_in_full() {
    for seed in 0..100 {
        sound_contacts(seed, &KINDS, 2000);
        sound_contacts(seed, &["cylinder", "cone"], 4000);
    }
}

/// Judges the contacts of pairs over three frames. Returns how many had each number of contacts,
/// and how many overlapped.
fn sound_contacts(seed: u64, names: &[&str], count: usize) -> ([usize; 9], u32) {
    let (mut rng, mut counts, mut overlapping) = (Rng::new(seed), [0; 9], 0);
    let options = ManifoldOptions::default().prediction(0.02);
    for k in 0..count {
        let kinds = [0, 1].map(|_| Kind::random(names[rng.below(names.len())], &mut rng, 4.0));
        if matches!(kinds, [Kind::Hull(_), Kind::Hull(_)]) {
            continue;
        }
        let mut place = at_gap(&kinds[0], &kinds[1], &mut rng, 1e-3);
        if k % 2 == 0 {
            // Axes up, or one of them upside down: caps and bases nearly flush.
            let q = *rng.pick(&[[0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 0.0], lying()]);
            let tilt = rng.log_range(1e-9, 0.02);
            let turn = truth::pose::quat(rng.unit(), if rng.chance(0.2) { 0.0 } else { tilt });
            place.q = truth::pose::unit_quat(truth::pose::quat_mul(turn, q));
            place.t = [rng.range(-0.5, 0.5), rng.range(-0.5, 0.5), 4.0];
            let o = PairTracker::new().closest(&kinds[0].shape(), &kinds[1].shape(), &place.pose());
            let gap = if rng.chance(0.3) { -1e-3 } else { 1e-3 };
            place.t = (Vector3::from(place.t) - Vector3::z() * (o.distance / o.normal.z - gap)).into();
        }
        let (mut pair, mut manifold) = (PairTracker::new(), Manifold::new());
        let (a, b) = (kinds[0].shape(), kinds[1].shape());
        for _ in 0..3 {
            let o = PairTracker::new().closest(&a, &b, &place.pose());
            pair.manifold(&a, &b, &place.pose(), &options, &mut manifold).unwrap();
            let told = format!("{kinds:?} {place:?} {o:?}");
            if manifold.is_fresh() {
                judge([&kinds[0], &kinds[1]], &place, &manifold, &told);
                let size = place.size(&kinds[0], &kinds[1]);
                if let Some(p) = manifold.deepest() {
                    let slack = o.upper - o.lower + 2e-5 * size;
                    assert!(p.separation <= o.distance + slack, "too shallow {p:?} {told}");
                }
                assert_eq!(manifold.points().is_empty(), o.lower > options.prediction, "{told}");
            }
            counts[manifold.points().len()] += 1;
            overlapping += u32::from(o.state == ContactState::Overlapping);
            place = trembled(&place, 1e-3, &mut rng);
        }
    }
    (counts, overlapping)
}

/// A rounded box has the contacts of its core, moved out along the normal; over frames they keep
/// the ids of the core.
#[test]
fn rounded_polyhedra_have_the_contacts_of_their_cores() {
    let mut rng = Rng::new(2162);
    let (half, other) = (Vector3::new(0.5, 0.4, 0.3), Vector3::new(3.0, 3.0, 0.5));
    let [core, floor] = [half, other].map(|h| lin_canny::polyhedron::solids::cuboid(h).expect("a box"));
    let radii = [0.25, 0.125];
    let a = Shape::from(floor.clone()).rounded(radii[0]).expect("a radius");
    let b = Shape::from(core.clone()).rounded(radii[1]).expect("a radius");
    let (mut pair, mut cores) = (PairTracker::new(), Tracker::new());
    let (mut manifold, mut of_cores) = (Manifold::new(), Manifold::new());
    let mut seen = 0;
    for k in 0..400 {
        let place = Place::new(
            truth::pose::quat(rng.unit(), rng.log_range(1e-6, 0.02)),
            [0.003 * f64::from(k), 0.1, 0.8 + 0.375 + rng.range(-0.01, 0.02)],
        );
        let pose = place.pose();
        pair.manifold(
            &a,
            &b,
            &pose,
            &ManifoldOptions::default().prediction(0.01),
            &mut manifold,
        )
        .unwrap();
        cores.manifold(
            &floor,
            &core,
            &pose,
            &ManifoldOptions::default().prediction(0.385),
            &mut of_cores,
        );
        assert_eq!(manifold.points().len(), of_cores.points().len());
        let n = manifold.normal();
        for (p, q) in manifold.points().iter().zip(of_cores.points()) {
            assert_eq!((p.id, p.features), (q.id, q.features));
            assert!((p.separation - (q.separation - 0.375)).abs() < 1e-12, "{p:?} {q:?}");
            let off = (p.point_on_a - (q.point_on_a + *n * radii[0])).norm();
            assert!(off < 1e-5, "{p:?} {q:?}");
            let between = place.isometry() * p.point_on_b - p.point_on_a;
            assert!((between.dot(&n) - p.separation).abs() < 1e-12, "{p:?}");
            seen += 1;
        }
        let o = pair.closest(&a, &b, &pose);
        if manifold.is_fresh() && !manifold.points().is_empty() {
            let deepest = manifold.deepest().expect("a contact").separation;
            assert!((deepest - o.distance).abs() < 1e-12, "{deepest} {o:?}");
        }
        assert!(manifold.lower() <= o.upper && o.lower <= manifold.upper());
    }
    assert!(seen > 800, "{seen}");
    // Two capsules side by side: both ends of the overlap.
    let pill = Shape::capsule(1.0, 0.25).expect("a capsule");
    let at = Place::new([0.0, 0.0, 0.0, 1.0], [0.505, 0.0, 0.5]);
    pair.manifold(
        &pill,
        &pill,
        &at.pose(),
        &ManifoldOptions::default().prediction(0.01),
        &mut manifold,
    )
    .unwrap();
    assert_eq!(manifold.points().len(), 2);
    for p in manifold.points() {
        assert!((p.separation - 0.005).abs() < 1e-14, "{p:?}");
        assert!((p.point_on_a.x - 0.25).abs() < 1e-14, "{p:?}");
    }
}
