//! Meshes that deform: after every replacement of vertices, outcomes are those of brute force and
//! of a new mesh.

use super::{judge_by_surfaces, mesh, relative};
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::{
    Compound, ContactState, ConvexPolyhedron, Geometry, Mesh, MeshKind, PairTracker, Piece, RelativePose, Shape,
    VertexError,
};
use truth::pose::{norm, quat, quat_mul, scale, sub, unit_quat};
use truth::rng::Rng;
use truth::soups::{self, Soup};
use truth::{Point, Pose};

/// Returns a sheet of n by n squares about the origin, of side 2.
pub(crate) fn sheet(n: u32) -> Soup {
    let at = |i: u32| 2.0 * f64::from(i) / f64::from(n) - 1.0;
    let points = (0..=n)
        .flat_map(|i| (0..=n).map(move |j| [at(i), at(j), 0.0]))
        .collect();
    let number = |i: u32, j: u32| i * (n + 1) + j;
    let square = |i: u32, j: u32| {
        let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    let triangles = (0..n).flat_map(|i| (0..n).flat_map(move |j| square(i, j))).collect();
    Soup::new(points, triangles)
}

/// Ways to deform a body of size about two.
pub(crate) const WAYS: [&str; 8] = [
    "wave", "twist", "fold", "crumple", "lattice", "flatten", "shift", "still",
];

/// Returns the position of a point at a time from 0 to 1.
pub(crate) fn bent(way: &str, time: f64, [x, y, z]: Point) -> Point {
    let turned =
        |angle: f64, [x, y, z]: Point| [x, y * angle.cos() - z * angle.sin(), y * angle.sin() + z * angle.cos()];
    match way {
        "wave" => [x, y, z + 0.4 * time * (4.0 * x + 6.0 * time).sin()],
        "twist" => turned(3.0 * time * x, [x, y, z]),
        // The half beyond x = 0 rotates about the y axis until it lies on the other half.
        "fold" if x > 0.0 => {
            let angle = std::f64::consts::PI * time;
            [x * angle.cos() - z * angle.sin(), y, x * angle.sin() + z * angle.cos()]
        }
        "crumple" => {
            let shake = |k: f64| 0.3 * time * (k * (x + 1.7 * y - 0.6 * z) + 9.0 * time + k).sin();
            [x + shake(11.0), y + shake(13.0), z + shake(17.0)]
        }
        // Vertices coincide, and triangles lose their area.
        "lattice" => [x, y, z].map(|x| {
            let step = 0.05 + 0.6 * time;
            (x / step).round() * step
        }),
        "flatten" => [x, y, z * (1.0 - time)],
        "shift" => [x + 40.0 * time * time, y, z],
        _ => [x, y, z],
    }
}

pub(crate) fn vertices(soup: &Soup) -> Vec<Point3<f64>> {
    soup.points.iter().map(|p| Point3::from(*p)).collect()
}

/// Returns a slow tumble at some distance.
fn motion(frames: usize, seed: u64) -> Vec<Pose> {
    let mut rng = Rng::new(seed);
    let (mut q, axis, at) = (rng.quat(), rng.unit(), rng.unit());
    let pose = |k: usize| {
        q = unit_quat(quat_mul(quat(axis, 0.01), q));
        Pose::new(q, at.map(|x| x * (1.5 + 0.7 * (0.08 * k as f64).sin())))
    };
    (0..frames).map(pose).collect()
}

/// Returns the same body as a new mesh; `None` if no triangle has an area.
pub(crate) fn anew(soup: &Soup) -> Option<Mesh> {
    Mesh::new(&vertices(soup), &soup.triangles).ok()
}

/// Returns triangles without area as segments and points.
fn lines(soup: &Soup, triangles: impl Iterator<Item = u32>) -> Vec<Geometry> {
    let line = |t: u32| {
        let corners = soup.corners(t as usize);
        let lengths = [0, 1, 2].map(|k| norm(sub(corners[k], corners[(k + 1) % 3])));
        let longest = (0..3).max_by(|&i, &j| lengths[i].total_cmp(&lengths[j])).unwrap();
        let [from, to] = [longest, (longest + 1) % 3].map(|k| Point3::from(corners[k]));
        ConvexPolyhedron::segment(from, to)
            .or_else(|_| ConvexPolyhedron::point(from))
            .unwrap()
    };
    triangles.map(|t| Geometry::from(line(t))).collect()
}

fn bodies() -> [Soup; 4] {
    [sheet(9), soups::torus(16, 8, 0.3), soups::rock(2, 1), soups::gear(5)]
}

#[test]
fn bent_meshes_equal_brute_force_and_meshes_built_anew() {
    let (mut tally, mut entries, mut failed) = ([0; 3], 0, 0);
    for (way, name) in WAYS.iter().enumerate() {
        for (k, rest) in bodies().iter().enumerate() {
            let other = &[soups::rock(1, 3), soups::torus(12, 6, 0.4)][k % 2];
            let (mut m, n) = (mesh(rest), mesh(other));
            let (mut warm, mut back) = (PairTracker::new(), PairTracker::new());
            for (frame, pose) in motion(24, (way * 10 + k) as u64).iter().enumerate() {
                let now = rest.clone().map(|p| bent(name, frame as f64 / 23.0, p));
                m.set_vertices(&vertices(&now)).unwrap();
                let pose = Pose {
                    t: if *name == "shift" {
                        truth::pose::add(pose.t, bent(name, frame as f64 / 23.0, [0.0; 3]))
                    } else {
                        pose.t
                    },
                    ..*pose
                };
                let (state, truth) = judge_by_surfaces(&mut warm, (&now, other), (&m, &n), &pose);
                tally[state as usize % 3] += 1;
                warm.check(&m, &n, &relative(&pose)).unwrap();
                let turned = back.closest(&n, &m, &relative(&pose).swapped());
                let cold = PairTracker::new().closest(&m, &n, &relative(&pose));
                assert_eq!((turned.state, cold.state), (state, state), "{name} {k} {frame} {truth}");
                if let Some(fresh) = anew(&now)
                    && fresh.kind() == m.kind()
                {
                    let found = PairTracker::new().closest(&fresh, &n, &relative(&pose));
                    assert_eq!(found.state, state, "{name} {k} {frame} {truth}");
                }
            }
            let work = warm.work().trees;
            (entries, failed) = (entries + work.entries, failed + work.failed);
        }
    }
    assert!(tally.iter().filter(|t| **t > 100).count() >= 2, "{tally:?}");
    assert!(entries > 5000 && failed * 4 < entries, "{entries} {failed}");
}

#[test]
fn two_bent_meshes_equal_brute_force_while_frames_are_missed() {
    let (rest, other) = (sheet(8), soups::torus(12, 6, 0.3));
    let (mut m, mut n) = (mesh(&rest), mesh(&other));
    let mut tracker = PairTracker::new();
    let mut entries = 0;
    for (frame, pose) in motion(120, 5).iter().enumerate() {
        let time = frame as f64 / 119.0;
        let now = rest.clone().map(|p| bent("wave", time, p));
        let then = other.clone().map(|p| bent("twist", time, p));
        m.set_vertices(&vertices(&now)).unwrap();
        n.set_vertices(&vertices(&then)).unwrap();
        if frame % 5 < 2 || frame % 40 > 20 {
            continue;
        }
        judge_by_surfaces(&mut tracker, (&now, &then), (&m, &n), pose);
        tracker.check(&m, &n, &relative(pose)).unwrap();
        entries = tracker.work().trees.entries;
    }
    assert!(entries > 200, "{entries}");
}

#[test]
fn clones_bent_in_other_ways_are_told_apart() {
    let (rest, other) = (soups::torus(16, 8, 0.3), soups::rock(1, 3));
    let (mut p, n) = (mesh(&rest), mesh(&other));
    let mut q = p.clone();
    let mut tracker = PairTracker::new();
    for (frame, pose) in motion(60, 9).iter().enumerate() {
        let time = frame as f64 / 59.0;
        let one = rest.clone().map(|p| bent("wave", time, p));
        let two = rest.clone().map(|p| bent("crumple", time, p));
        p.set_vertices(&vertices(&one)).unwrap();
        q.set_vertices(&vertices(&two)).unwrap();
        let (soup, m) = if frame % 3 == 1 { (&two, &q) } else { (&one, &p) };
        judge_by_surfaces(&mut tracker, (soup, &other), (m, &n), pose);
        tracker.check(m, &n, &relative(pose)).unwrap();
        if frame % 20 == 19 {
            q = p.clone();
        }
    }
}

#[test]
fn parts_of_the_vertices_and_new_trees_equal_brute_force() {
    let (rest, other) = (soups::torus(16, 8, 0.3), soups::rock(1, 3));
    let (mut m, n) = (mesh(&rest), mesh(&other));
    let mut now = rest.clone();
    let (mut tracker, mut rng) = (PairTracker::new(), Rng::new(3));
    for (frame, pose) in motion(60, 11).iter().enumerate() {
        let first = rng.below(rest.points.len());
        let last = (first + 1 + rng.below(20)).min(rest.points.len());
        for p in &mut now.points[first..last] {
            *p = truth::pose::add(*p, rng.unit().map(|x| 0.02 * x));
        }
        m.set_vertices_from(first, &vertices(&now)[first..last]).unwrap();
        if frame % 13 == 12 {
            m.rebuild();
        }
        let same: Vec<_> = m.vertices().iter().map(|p| [p.x, p.y, p.z]).collect();
        assert_eq!(same, now.points);
        judge_by_surfaces(&mut tracker, (&now, &other), (&m, &n), pose);
        tracker.check(&m, &n, &relative(pose)).unwrap();
    }
}

/// Rolls a sheet of side 2 up along x by some turns.
fn rolled(turns: f64, [x, y, z]: Point) -> Point {
    let angle = turns * std::f64::consts::PI * (x + 1.0);
    let radius = (1.0 + 0.024 * angle) / (turns * std::f64::consts::PI);
    if turns == 0.0 {
        [x, y, z]
    } else {
        [radius * angle.sin(), y, radius * angle.cos()]
    }
}

#[test]
fn sheets_that_are_rolled_up_equal_brute_force() {
    let (rest, other) = (sheet(28), soups::rock(1, 3).map(|p| scale(p, 0.3)));
    let (mut m, n) = (mesh(&rest), mesh(&other));
    let mut tracker = PairTracker::new();
    for (frame, pose) in motion(48, 17).iter().enumerate() {
        let now = rest.clone().map(|p| rolled(3.0 * (frame as f64 / 47.0), p));
        m.set_vertices(&vertices(&now)).unwrap();
        judge_by_surfaces(&mut tracker, (&now, &other), (&m, &n), pose);
        tracker.check(&m, &n, &relative(pose)).unwrap();
    }
}

#[test]
fn bent_meshes_beside_other_kinds_are_as_meshes_built_anew() {
    let ball = Shape::ball(0.5).unwrap();
    let box_of = |x: f64| solids::cuboid(Vector3::new(x, 0.4, 0.3)).unwrap();
    let piece = |x: f64| {
        let mut piece = Piece::new(box_of(0.3));
        piece.pose = Isometry3::translation(x, 0.0, 0.1);
        piece
    };
    let others: [Geometry; 4] = [
        ball.into(),
        Shape::cylinder(0.5, 0.3).unwrap().into(),
        box_of(0.6).into(),
        Compound::new(vec![piece(-0.4), piece(0.4)]).unwrap().into(),
    ];
    let (mut tally, mut segments) = ([0; 2], 0);
    for (way, name) in WAYS.iter().enumerate().filter(|w| *w.1 != "shift") {
        for (k, rest) in bodies().iter().enumerate() {
            let mut m = mesh(rest);
            let mut warm = [(); 4].map(|()| PairTracker::new());
            for (frame, pose) in motion(12, (way * 10 + k) as u64).iter().enumerate() {
                let now = rest.clone().map(|p| bent(name, frame as f64 / 11.0, p));
                m.set_vertices(&vertices(&now)).unwrap();
                let Some(fresh) = anew(&now).filter(|f| f.kind() == m.kind()) else {
                    continue;
                };
                let fresh_body = Geometry::from(fresh.clone());
                for (other, warm) in others.iter().zip(&mut warm) {
                    let pose = relative(pose);
                    let found = warm.closest(&m, other, &pose);
                    // Triangles that a build removes are measured as the segments and points that
                    // they are.
                    let left = lines(&now, fresh.report().degenerate.iter().copied());
                    let ask = |body: &Geometry| PairTracker::new().closest(body, other, &pose);
                    let each = left.iter().chain([&fresh_body]).map(ask);
                    let truth = each.min_by(|p, q| p.distance.total_cmp(&q.distance)).unwrap();
                    let is_apart = truth.state == ContactState::Separated;
                    let answer = found.state == ContactState::Separated;
                    assert_eq!(answer, is_apart, "{name} {k} {frame} {found:?} {truth:?}");
                    assert!(
                        !left.is_empty() || found.state == truth.state,
                        "{name} {k} {frame} {found:?} {truth:?}"
                    );
                    tally[usize::from(is_apart)] += 1;
                    segments += left.len();
                    let apart = (found.distance - truth.distance.max(0.0)).abs();
                    assert!(apart < 1e-12, "{name} {k} {frame} {found:?} {truth:?}");
                    assert_eq!(warm.intersects(&m, other, &pose), !is_apart);
                    let near = found.distance + 0.01;
                    assert_eq!(warm.within(&m, other, &pose, near), truth.distance <= near);
                    assert!(warm.lower_bound(&m, other, &pose) <= truth.upper + 1e-12);
                }
            }
        }
    }
    assert!(tally.iter().all(|t| *t > 100) && segments > 100, "{tally:?} {segments}");
}

#[test]
fn closed_meshes_remain_solids_and_surfaces_surfaces() {
    for rest in bodies() {
        let mut m = mesh(&rest);
        let kind = m.kind();
        for name in WAYS {
            let now = rest.clone().map(|p| bent(name, 0.7, p));
            m.set_vertices(&vertices(&now)).unwrap();
            assert_eq!(m.kind(), kind);
            if let Some(fresh) = anew(&now).filter(|f| f.kind() == kind) {
                assert!((fresh.volume() - m.volume()).abs() < 1e-12, "{name}");
                assert!((fresh.centroid() - m.centroid()).norm() < 1e-9, "{name}");
                assert_eq!(fresh.aabb(), m.aabb());
            }
        }
    }
    assert_eq!(mesh(&sheet(3)).kind(), MeshKind::Open);
}

#[test]
fn scales_of_powers_of_two_are_bit_for_bit() {
    let (rest, other) = (soups::torus(16, 8, 0.3), soups::rock(1, 3));
    let run = |size: f64| {
        let sized = |soup: &Soup| soup.clone().map(|p| scale(p, size));
        let (mut m, n) = (mesh(&sized(&rest)), mesh(&sized(&other)));
        let mut tracker = PairTracker::new();
        let mut found = Vec::new();
        for (frame, pose) in motion(30, 13).iter().enumerate() {
            let now = rest.clone().map(|p| bent("crumple", frame as f64 / 29.0, p));
            m.set_vertices(&vertices(&sized(&now))).unwrap();
            let pose = Pose::new(pose.q, scale(pose.t, size));
            found.push(tracker.closest(&m, &n, &relative(&pose)).distance / size);
        }
        found
    };
    let one = run(1.0);
    for exponent in [-300, -90, -1, 90, 300] {
        assert_eq!(run(2f64.powi(exponent)), one, "{exponent}");
    }
}

/// A mesh that grows and shrinks by large factors changes its scale exponent.
#[test]
fn meshes_that_change_their_size_are_right() {
    let rest = soups::rock(1, 3);
    let mut m = mesh(&rest);
    let mut tracker = PairTracker::new();
    for exponent in [0, 2, 5, 1, -4, -40, -200, -330, 0, 330, 3] {
        let size = 2f64.powi(exponent);
        let now = rest.clone().map(|p| scale(p, size));
        m.set_vertices(&vertices(&now)).unwrap();
        let fresh = mesh(&now);
        let pose = Pose::shift([3.0 * size, 0.1 * size, 0.0]);
        let p = tracker.closest(&m, &m, &relative(&pose));
        let q = PairTracker::new().closest(&fresh, &fresh, &relative(&pose));
        assert!(p.state == ContactState::Separated, "{exponent}");
        assert!((p.distance - q.distance).abs() < 1e-13 * size, "{exponent}");
        assert!(norm(sub(p.point_on_a.into(), q.point_on_a.into())) < 1e-9 * size);
    }
}

#[test]
fn wrong_vertices_are_refused_by_index_and_change_nothing() {
    let rest = soups::torus(16, 8, 0.3);
    let mut m = mesh(&rest);
    let good = vertices(&rest);
    let pose: RelativePose = relative(&Pose::shift([2.8, 0.0, 0.1]));
    let before = PairTracker::new().closest(&m, &m, &pose).distance;
    let count = good.len();
    for (k, bad) in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY].into_iter().enumerate() {
        let mut wrong = good.clone();
        wrong[7 + k].y = bad;
        assert_eq!(m.set_vertices(&wrong), Err(VertexError::NotFinite { index: 7 + k }));
        let found = m.set_vertices_from(5, &wrong[5..20]);
        assert_eq!(found, Err(VertexError::NotFinite { index: 7 + k }));
    }
    let too_few = m.set_vertices(&good[1..]);
    let truth = Err(VertexError::Count {
        given: count - 1,
        count,
    });
    assert_eq!(too_few, truth);
    let beyond = m.set_vertices_from(count - 1, &good[..2]);
    assert_eq!(beyond, Err(VertexError::Missing { index: count, count }));
    let beyond = m.set_vertices_from(usize::MAX, &good[..2]);
    let expected = Err(VertexError::Missing {
        index: usize::MAX,
        count,
    });
    assert_eq!(beyond, expected);
    let at_once = vec![Point3::new(1.0, 2.0, 3.0); count];
    assert!(matches!(m.set_vertices(&at_once), Err(VertexError::OutOfRange { .. })));
    let far: Vec<_> = good.iter().map(|p| p * 1e110).collect();
    assert!(matches!(m.set_vertices(&far), Err(VertexError::OutOfRange { .. })));
    let mut far = good.clone();
    far[3].x = 1e120;
    assert!(matches!(m.set_vertices(&far), Err(VertexError::OutOfRange { .. })));
    assert_eq!(m.vertices(), good);
    assert_eq!(PairTracker::new().closest(&m, &m, &pose).distance, before);
    assert_eq!(m.set_vertices(&good), Ok(()));
    assert_eq!(m.set_vertices_from(count, &[]), Ok(()));
}

#[test]
fn meshes_that_bending_would_change_are_refused() {
    let mut rest = soups::torus(16, 8, 0.3);
    // A collinear triangle, between three points of one of its edges.
    let [a, b, _] = rest.corners(0);
    rest.points.push([0, 1, 2].map(|k| 0.5 * (a[k] + b[k])));
    let (t, middle) = (rest.triangles[0], rest.points.len() as u32 - 1);
    rest.points[middle as usize] = a;
    rest.points[middle as usize][0] += 1.0;
    rest.points.push(a);
    let last = rest.points.len() - 1;
    rest.points[last][0] += 2.0;
    rest.triangles.push([t[0], middle, last as u32]);
    let mut m = mesh(&rest);
    let dropped = rest.triangles.len() as u32 - 1;
    assert_eq!(m.report().degenerate, [dropped]);
    let given = m.vertices();
    assert_eq!(m.set_vertices(&given), Err(VertexError::Dropped { triangle: dropped }));

    // A square of two triangles on one side, and of four on the other: closed along a line.
    let points = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0.5, 0., 0.]].map(Point3::from);
    let halves = [[0, 2, 3], [3, 2, 1], [0, 1, 2]];
    let mut m = Mesh::new(&points, &halves).unwrap();
    assert_eq!(m.kind(), MeshKind::Solid);
    assert_eq!(m.set_vertices(&points), Err(VertexError::ClosedAlongLines));
}

#[test]
fn vertices_are_numbered_as_the_points_given() {
    let rest = soups::torus(16, 8, 0.3);
    let m = mesh(&rest);
    assert_eq!(m.vertices(), vertices(&rest));
    assert_eq!(m.triangle_vertices(), rest.triangles);
    assert!(m.vertex_sources().into_iter().eq(0..rest.points.len() as u32));
    let soup = rest.unwelded();
    let n = mesh(&soup);
    let sources = n.vertex_sources();
    assert!(sources.is_sorted() && sources.len() == rest.points.len());
    let named: Vec<_> = sources.iter().map(|&k| Point3::from(soup.points[k as usize])).collect();
    assert_eq!(n.vertices(), named);
    let (places, given) = (n.vertices(), vertices(&soup));
    for (own, t) in n.triangle_vertices().iter().zip(&soup.triangles) {
        assert_eq!(own.map(|v| places[v as usize]), t.map(|v| given[v as usize]));
    }
}

/// A triangle that has become a point closes nothing and opens nothing.
#[test]
fn what_is_inside_a_body_with_points_for_triangles_is_inside() {
    let rest = soups::rock(1, 3);
    let small = mesh(&soups::plate(1, [0.01, 0.01, 0.01]));
    let mut rng = Rng::new(17);
    let mut inside = 0;
    for k in 0..rest.triangles.len() {
        let mut m = mesh(&rest);
        let mut now = rest.clone();
        let corners = rest.triangles[k];
        let middle = [0, 1, 2].map(|i| corners.iter().map(|v| rest.points[*v as usize][i]).sum::<f64>() / 3.0);
        corners.iter().for_each(|v| now.points[*v as usize] = middle);
        m.set_vertices(&vertices(&now)).unwrap();
        for _ in 0..20 {
            // Below the point, where the segments to the outside pass.
            let t = [0, 1, 2].map(|i| 0.9 * middle[i] + 0.04 * rng.range(-1.0, 1.0));
            let pose = Pose::shift(t);
            let state = PairTracker::new().closest(&m, &small, &relative(&pose)).state;
            let truth = anew(&now).map(|fresh| PairTracker::new().closest(&fresh, &small, &relative(&pose)).state);
            assert_eq!(Some(state), truth, "{k}");
            inside += usize::from(state == ContactState::Overlapping);
        }
    }
    assert!(inside > 1000, "{inside}");
}
