//! Faces that cancel: a window modelled as a cavity through the whole wall, with its ends in the
//! faces of the wall.

use super::{mesh, relative};
use lin_canny::nalgebra::Point3;
use lin_canny::{ContactState, Mesh, MeshKind, PairTracker};
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
    assert!(
        !faces.is_empty() && found.cancelling.iter().all(|[t, u]| *t < 12 && *u >= 12),
        "{found:?}"
    );
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
            let (solid, found) = Mesh::oriented(&points, &triangles).unwrap();
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
    let (solid, turned) = Mesh::oriented(&points, &triangles).unwrap();
    assert_eq!(solid.volume(), 56.0);
    // All except the one that faced outward.
    assert_eq!(turned.len(), triangles.len() - 1);
    assert!(!turned.contains(&5));
}

#[test]
fn what_no_turning_closes_is_refused_by_an_edge() {
    let square = union_of(&[[[0.0; 3], [1.0; 3]]], 1);
    let points: Vec<_> = square.points.iter().map(|p| Point3::from(*p)).collect();
    let open = Mesh::oriented(&points, &square.triangles[..11])
        .unwrap_err()
        .to_string();
    assert!(
        open.starts_with("cannot orient the mesh: 1 triangles share the edge of points"),
        "{open}"
    );
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
    let one_sided = Mesh::oriented(&points, &plane).unwrap_err().to_string();
    assert!(
        one_sided.starts_with("cannot orient the mesh: it has one side"),
        "{one_sided}"
    );
}
