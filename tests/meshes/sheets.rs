//! Faces that cancel: a window modelled as a cavity through the whole wall, with its ends in the
//! faces of the wall.

use super::{mesh, relative};
use lin_canny::nalgebra::Point3;
use lin_canny::{ContactState, Mesh, MeshKind, MeshRepair, PairTracker, PointQuery, RepairOptions};
use truth::Pose;
use truth::driven::slots::union_of;
use truth::rng::Rng;
use truth::soups::Soup;

/// Returns a wall of 4 x 10 x 2 with its window, and a bar through the window.
fn wall_and_bar(fine: usize) -> [Soup; 2] {
    let wall = union_of(&[[[-2.0, 0.0, -1.0], [2.0, 10.0, 1.0]]], 1);
    let window = union_of(&[[[-2.0, 3.0, -1.0], [2.0, 7.0, 1.0]]], fine).flipped();
    [wall.with(&window), bar([-8.0, 4.0, -0.5], [8.0, 6.0, 0.5])]
}

fn repair_of(mesh: &Mesh) -> &MeshRepair {
    mesh.report().repair.as_deref().expect("a repaired mesh")
}

/// Returns the mesh with its triangles turned, and which were.
fn oriented(points: &[Point3<f64>], triangles: &[[u32; 3]]) -> (Mesh, Vec<u32>) {
    let mesh = Mesh::repaired(points, triangles, &RepairOptions::default().caps(false)).unwrap();
    let turned = repair_of(&mesh).turned.clone();
    (mesh, turned)
}

fn bar(low: [f64; 3], high: [f64; 3]) -> Soup {
    union_of(&[[low, high]], 2)
}

#[test]
fn a_bar_that_also_meets_the_wall_overlaps_it() {
    let wall = mesh(&wall_and_bar(1)[0]);
    let bars = [
        // Through the side of the window, through the wall above, and with one end in the wall.
        ([-8.0, 2.0, -0.5], [8.0, 6.0, 0.5]),
        ([-8.0, 8.0, -0.5], [8.0, 9.0, 0.5]),
        ([1.0, 8.0, -0.5], [8.0, 9.0, 0.5]),
        ([-8.0, 2.999, -0.5], [8.0, 6.0, 0.5]),
        ([-8.0, 8.0, -0.5], [-1.999, 9.0, 0.5]),
    ];
    for (low, high) in bars {
        let bar = mesh(&bar(low, high));
        for (a, b) in [(&wall, &bar), (&bar, &wall)] {
            let found = PairTracker::new().closest(a, b, &relative(&Pose::IDENTITY));
            assert_eq!(found.state, ContactState::Overlapping, "{low:?} {found:?}");
        }
    }
}

#[test]
fn inspection_finds_faces_that_cancel() {
    let [wall, bar] = wall_and_bar(1).map(|s| mesh(&s));
    let found = wall.inspect(100);
    // Both ends, and the sides of the window in the sides of the wall: two triangles each, on both
    // of the other's.
    let faces: Vec<_> = found.cancelling.iter().flatten().collect();
    assert!(found.is_complete && found.crossings.is_empty(), "{found:?}");
    assert!(!faces.is_empty(), "{found:?}");
    assert!(found.cancelling.iter().all(|[t, u]| *t < 12 && *u >= 12), "{found:?}");
    assert!(!wall.inspect(1).is_complete);
    assert!(bar.inspect(100).cancelling.is_empty());
    // A cavity entirely inside has none.
    let inner = bar_with_cavity();
    assert!(inner.inspect(100).cancelling.is_empty());
}

fn bar_with_cavity() -> Mesh {
    let outer = union_of(&[[[0.0; 3], [4.0; 3]]], 2);
    mesh(&outer.with(&union_of(&[[[1.0; 3], [2.0; 3]]], 2).flipped()))
}

/// Returns a solid with randomly flipped triangles, and the original mesh.
fn mixed(soup: &Soup, part: f64, rng: &mut Rng) -> (Vec<Point3<f64>>, Vec<[u32; 3]>, Vec<u32>) {
    let points = soup.points.iter().map(|p| Point3::from(*p)).collect();
    let (mut triangles, mut turned) = (soup.triangles.clone(), Vec::new());
    for (k, t) in (0u32..).zip(&mut triangles) {
        if rng.chance(part) {
            t.swap(0, 1);
            turned.push(k);
        }
    }
    (points, triangles, turned)
}

#[test]
fn turned_triangles_are_turned_back() {
    let mut rng = Rng::new(4);
    let outer = union_of(&[[[0.0; 3], [4.0; 3]]], 4);
    let cavity = union_of(&[[[1.0; 3], [3.0; 3]]], 4).flipped();
    let core = union_of(&[[[1.5; 3], [2.5; 3]]], 4);
    let shapes = [
        outer.clone(),
        outer.clone().with(&cavity),
        outer.clone().with(&cavity).with(&core),
        truth::soups::knot(60, 8, 0.12),
        truth::soups::bracket().with(&outer.clone().moved(&Pose::shift([9.0, 0.0, 0.0]))),
    ];
    let mut surfaces = 0;
    for soup in &shapes {
        for k in 0..20 {
            let (points, triangles, turned) = mixed(soup, [0.02, 0.2][k % 2], &mut rng);
            let given = Mesh::new(&points, &triangles).unwrap();
            surfaces += u32::from(given.kind() == MeshKind::Open);
            assert_eq!(given.kind() == MeshKind::Open, !turned.is_empty());
            assert_eq!(given.report().misoriented_edges.is_empty(), turned.is_empty());
            let (solid, found) = oriented(&points, &triangles);
            assert_eq!((solid.kind(), &found), (MeshKind::Solid, &turned));
            let (as_it_was, now) = (mesh(soup).volume(), solid.volume());
            assert!((now - as_it_was).abs() < 1e-12 * as_it_was);
        }
    }
    assert!(surfaces > 80, "{surfaces}");
}

#[test]
fn parts_that_face_inward_are_turned_with_the_parts_in_them() {
    let outer = union_of(&[[[0.0; 3], [4.0; 3]]], 2);
    let cavity = union_of(&[[[1.0; 3], [3.0; 3]]], 2).flipped();
    let inside_out = outer.with(&cavity).flipped();
    let points: Vec<_> = inside_out.points.iter().map(|p| Point3::from(*p)).collect();
    let mut triangles = inside_out.triangles.clone();
    triangles[5].swap(0, 1);
    let (solid, turned) = oriented(&points, &triangles);
    assert_eq!(solid.volume(), 56.0);
    // All except the one that faced outward.
    assert_eq!(turned.len(), triangles.len() - 1);
    assert!(!turned.contains(&5));
}

/// Closed meshes with components inside out: alone, nested, in cavities, and touching at a vertex, at
/// an edge and along a part of a face.
#[test]
fn closed_meshes_are_turned_outward_and_keep_their_inside() {
    let cube = |low: f64, high: f64| union_of(&[[[low; 3], [high; 3]]], 2);
    let at = |low: [f64; 3]| union_of(&[[low, low.map(|x| x + 4.0)]], 2);
    let nested = cube(0.0, 4.0).with(&cube(1.0, 3.0).flipped());
    let cases = [
        // The components, the volume, and the components that face inward.
        (vec![cube(0.0, 4.0).flipped()], 64.0, vec![0]),
        (vec![nested.clone()], 56.0, vec![]),
        (vec![nested.clone().flipped()], 56.0, vec![0]),
        // A core in a cavity, and a solid in a solid: the inner one counts twice.
        (vec![nested.clone(), cube(1.5, 2.5).flipped()], 57.0, vec![1]),
        (
            vec![cube(0.0, 4.0).flipped(), cube(1.0, 3.0).flipped()],
            72.0,
            vec![0, 1],
        ),
        (vec![cube(0.0, 4.0), at([9.0; 3]).flipped()], 128.0, vec![1]),
        (vec![cube(0.0, 4.0).flipped(), at([4.0; 3])], 128.0, vec![0]),
        (vec![cube(0.0, 4.0), at([4.0, 4.0, 0.0]).flipped()], 128.0, vec![1]),
        (vec![cube(0.0, 4.0), at([4.0, 1.0, 1.0]).flipped()], 128.0, vec![1]),
        (vec![cube(0.0, 4.0), at([4.0, 0.0, 0.0]).flipped()], 128.0, vec![1]),
        (
            vec![cube(0.0, 4.0).flipped(), at([4.0, 0.0, 0.0]).flipped()],
            128.0,
            vec![0, 1],
        ),
    ];
    let mut rng = Rng::new(6);
    for (k, (parts, volume, inward)) in cases.iter().enumerate() {
        let turn = Pose::new(truth::pose::unit_quat(rng.quat()), rng.in_ball());
        for pose in [Pose::IDENTITY, turn] {
            let (mut soup, mut expected) = (Soup::default(), Vec::new());
            for (part, own) in parts.iter().enumerate() {
                let first = soup.triangles.len() as u32;
                soup = soup.with(&own.clone().moved(&pose));
                if inward.contains(&part) {
                    expected.extend(first..soup.triangles.len() as u32);
                }
            }
            let points: Vec<_> = soup.points.iter().map(|p| Point3::from(*p)).collect();
            let given = mesh(&soup);
            let (solid, turned) = oriented(&points, &soup.triangles);
            assert_eq!(solid.kind(), MeshKind::Solid, "{k}");
            // Of the last two cubes, the common face cancels however it faces.
            assert!(turned == expected || k == 10, "{k}: {turned:?}");
            assert!((solid.volume() - volume).abs() < 1e-9, "{k}: {}", solid.volume());
            for _ in 0..200 {
                let p = Point3::from(pose.apply([0; 3].map(|_| rng.range(-1.0, 9.0))));
                let [before, now] = [&given, &solid].map(|m| PointQuery::new(m).contains(&p).unwrap());
                assert_eq!(before, now, "{k} {p}");
            }
            // Turned meshes have nothing left to turn.
            let again: Vec<_> = soup
                .triangles
                .iter()
                .enumerate()
                .map(|(t, &[a, b, c])| {
                    if turned.contains(&(t as u32)) {
                        [a, c, b]
                    } else {
                        [a, b, c]
                    }
                })
                .collect();
            assert!(oriented(&points, &again).1.is_empty(), "{k}");
            // One more turned triangle, and the mesh is open: the same components are found.
            let mut mixed = soup.triangles.clone();
            mixed[5].swap(0, 1);
            let (solid, _) = oriented(&points, &mixed);
            if solid.kind() == MeshKind::Solid {
                assert!((solid.volume() - volume).abs() < 1e-9, "{k}: {}", solid.volume());
            }
        }
    }
}

/// A dropped repetition of a turned triangle is turned too.
#[test]
fn repeated_triangles_are_turned_together() {
    let soup = union_of(&[[[0.0; 3], [1.0; 3]]], 1).flipped();
    let points: Vec<_> = soup.points.iter().map(|p| Point3::from(*p)).collect();
    let mut triangles = soup.triangles.clone();
    triangles.push(triangles[3]);
    let (solid, turned) = oriented(&points, &triangles);
    assert_eq!((solid.kind(), solid.volume()), (MeshKind::Solid, 1.0));
    assert_eq!(turned, (0..13).collect::<Vec<_>>());
}

/// The contact states, depths and normals of meshes do not depend on which way their triangles face.
#[test]
fn states_and_normals_are_those_of_meshes_that_face_outward() {
    let outward = union_of(&[[[0.0; 3], [2.0; 3]], [[2.0, 0.0, 0.0], [4.0, 2.0, 1.0]]], 1);
    let [plain, inside_out] = [outward.clone(), outward.flipped()].map(|s| mesh(&s));
    let shifts = [
        [0.0; 3],
        [0.0, 0.5, 0.0],
        [2.0, 0.0, 1.0],
        [2.0, 0.0, 0.5],
        [4.0, 0.0, 0.0],
        [0.0, 0.0, 2.0],
        [1.0, 1.0, 0.25],
        [2.0, 2.0, 0.0],
    ];
    for shift in shifts {
        let at = relative(&Pose::shift(shift));
        let state = |a: &Mesh, b: &Mesh| PairTracker::new().closest(a, b, &at).state;
        let expected = state(&plain, &plain);
        assert_eq!(state(&inside_out, &inside_out), expected, "{shift:?}");
        assert_eq!(state(&plain, &inside_out), expected, "{shift:?}");
        assert_eq!(state(&inside_out, &plain), expected, "{shift:?}");
    }
    for p in [[1.0, 0.5, 0.0], [2.0, 1.0, 1.5], [3.0, 1.0, 1.0], [4.0, 0.3, 0.2]] {
        let normal = |m: &Mesh| PointQuery::new(m).closest_point(&Point3::from(p)).unwrap();
        let [expected, found] = [&plain, &inside_out].map(normal);
        assert_eq!((found.state, found.normal), (expected.state, expected.normal), "{p:?}");
    }
}

#[test]
fn what_no_turning_closes_stays_open_without_caps() {
    let square = union_of(&[[[0.0; 3], [1.0; 3]]], 1);
    let points: Vec<_> = square.points.iter().map(|p| Point3::from(*p)).collect();
    let (open, turned) = oriented(&points, &square.triangles[..11]);
    assert_eq!((open.kind(), turned.len()), (MeshKind::Open, 0));
    // The projective plane of six vertices: closed, two triangles at each edge, one-sided.
    let plane = [
        [0, 1, 2],
        [0, 2, 3],
        [0, 3, 4],
        [0, 4, 5],
        [0, 5, 1],
        [1, 2, 4],
        [2, 3, 5],
        [3, 4, 1],
        [4, 5, 2],
        [5, 1, 3],
    ];
    let mut rng = Rng::new(5);
    let points: Vec<_> = (0..6).map(|_| Point3::from(rng.in_ball())).collect();
    let options = RepairOptions::default().caps(false);
    let open = Mesh::repaired(&points, &plane, &options).unwrap();
    let repair = repair_of(&open);
    assert_eq!(open.kind(), MeshKind::Open);
    assert!(!repair.one_sided_edges.is_empty());
    let solid = Mesh::repaired(&points, &plane, &RepairOptions::default()).unwrap();
    let repair = repair_of(&solid);
    assert_eq!(solid.kind(), MeshKind::Solid);
    assert!(!repair.one_sided_edges.is_empty() && !repair.caps.is_empty());
}
