//! Promise: a repaired mesh is closed, and its sides are exact and those of the mesh before the damage.

use lin_canny::nalgebra::Point3;
use lin_canny::{
    ContactState, Mesh, MeshError, MeshKind, MeshRepair, PairTracker, PointQuery, Progress, RepairOptions, VertexError,
    WithProgress,
};
use std::ops::ControlFlow;
use truth::driven::{played, repairs};
use truth::soups::{self, Soup};

fn points_of(soup: &Soup) -> Vec<Point3<f64>> {
    soup.points.iter().map(|p| Point3::from(*p)).collect()
}

fn repaired(soup: &Soup) -> (Mesh, MeshRepair) {
    with_report(Mesh::repaired(
        &points_of(soup),
        &soup.triangles,
        &RepairOptions::default(),
    ))
}

fn with_report(mesh: Result<Mesh, MeshError>) -> (Mesh, MeshRepair) {
    let mesh = mesh.expect("a mesh");
    let repair = mesh.report().repair.as_deref().cloned();
    (mesh, repair.expect("a repaired mesh"))
}

fn winding(mesh: &Mesh, p: [f64; 3]) -> Option<i32> {
    PointQuery::new(mesh).winding_number(&Point3::from(p)).expect("a solid")
}

fn check(seeds: std::ops::Range<u64>) {
    let n = seeds.end - seeds.start;
    let mix = played(seeds, repairs::play);
    println!("{mix:?}");
    let parts = [&mix.damages[..], &mix.soups, &mix.points, &mix.repaired].concat();
    assert!(
        parts.iter().all(|count| *count > n / 12) && mix.changed < n / 10,
        "{mix:?}"
    );
}

#[test]
fn damaged_meshes_have_the_sides_of_exact_arithmetic() {
    check(0..100);
}

#[test]
#[ignore = "minutes: 10,000 meshes; cargo test --release --all-features --test meshes ten_thousand_damaged -- --ignored --nocapture"]
fn ten_thousand_damaged_meshes_have_the_sides_of_exact_arithmetic() {
    check(1_000..11_000);
}

fn check_on_lattice(seeds: std::ops::Range<u64>) {
    let n = seeds.end - seeds.start;
    let mix = played(seeds, repairs::play_on_lattice);
    println!("{mix:?}");
    let parts = [&mix.damages[..], &mix.soups, &mix.points, &mix.repaired].concat();
    assert!(
        parts.iter().all(|count| *count > n / 16) && mix.changed < n * 30,
        "{mix:?}"
    );
}

#[test]
fn damaged_meshes_have_the_sides_of_exact_integers() {
    check_on_lattice(0..100);
}

#[test]
#[ignore = "minutes: ten million points; cargo test --release --all-features --test meshes ten_million_points -- --ignored --nocapture"]
fn ten_million_points_of_damaged_meshes_have_the_sides_of_exact_integers() {
    check_on_lattice(1_000..11_000);
}

/// A box of side 2 about the origin, each face cut into 32 triangles.
fn cube() -> Soup {
    truth::driven::slots::union_of(&[[[-1.0; 3], [1.0; 3]]], 4)
}

#[test]
fn a_lost_triangle_is_its_own_cap() {
    for lost in 0..192 {
        let mut soup = cube();
        let gone = soup.triangles.remove(lost);
        let (mesh, repair) = repaired(&soup);
        assert_eq!((mesh.kind(), mesh.volume()), (MeshKind::Solid, 8.0));
        let [cap] = &repair.caps[..] else { panic!("{repair}") };
        assert_eq!((cap.first, cap.corners.len(), repair.longest_loop()), (191, 3, 3));
        assert!(gone.iter().all(|v| cap.corners.contains(v)));
        assert!(mesh.is_cap(191) && !mesh.is_cap(190));
        assert!((repair.cap_share - 1.0 / 192.0).abs() < 1e-12);
        assert_eq!(repair.to_string(), "1 cap (0.52 % of the area, at most 3 corners)");
    }
    assert_eq!(repaired(&cube()).1.to_string(), "nothing to repair");
}

#[test]
fn a_lid_is_flat() {
    // The face at x = 1 is lost: a loop of sixteen corners.
    let mut soup = cube();
    let is_of_face = |t: &[u32; 3]| t.iter().all(|v| soup.points[*v as usize][0] == 1.0);
    let kept: Vec<_> = soup.triangles.iter().copied().filter(|t| !is_of_face(t)).collect();
    soup.triangles = kept;
    let (mesh, repair) = repaired(&soup);
    assert_eq!((mesh.volume(), repair.caps.len(), repair.longest_loop()), (8.0, 1, 16));
    assert_eq!(winding(&mesh, [0.999, 0.1, 0.2]), Some(1));
    assert_eq!(winding(&mesh, [1.001, 0.1, 0.2]), Some(0));
    assert_eq!(winding(&mesh, [1.0, 0.1, 0.2]), None);
}

/// Loops that share a vertex, loops that share two vertices, and triangles lost on both sides of an
/// edge.
#[test]
fn loops_that_share_vertices_are_closed_apart() {
    let whole = soups::sphere(3);
    let fan = |v: u32| (0..whole.triangles.len()).filter(move |t| soups::sphere(3).triangles[*t].contains(&v));
    for taken in [vec![0, 2], vec![0, 3], vec![0, 2, 4], vec![0, 1], vec![0, 1, 3, 4]] {
        let around: Vec<usize> = fan(40).collect();
        // In the order around the vertex.
        let mut order = vec![around[0]];
        while order.len() < around.len() {
            let last = whole.triangles[order[order.len() - 1]];
            let next = around.iter().find(|t| {
                let shared = whole.triangles[**t].iter().filter(|v| last.contains(v)).count();
                !order.contains(t) && shared == 2
            });
            order.push(*next.expect("a fan"));
        }
        let lost: Vec<usize> = taken.iter().map(|k| order[*k]).collect();
        let mut soup = whole.clone();
        let kept = (0..whole.triangles.len()).filter(|t| !lost.contains(t));
        soup.triangles = kept.map(|t| whole.triangles[t]).collect();
        let (mesh, repair) = repaired(&soup);
        assert_eq!(mesh.kind(), MeshKind::Solid);
        assert_eq!(mesh.triangle_count(), whole.triangles.len(), "{taken:?}");
        assert!(repair.longest_loop() <= 4, "{taken:?} {repair}");
    }
}

#[test]
fn what_encloses_nothing_says_so() {
    let one = Soup {
        points: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        triangles: vec![[0, 1, 2]],
    };
    let (mesh, repair) = repaired(&one);
    assert!(
        repair.is_empty && repair.to_string().ends_with(", nothing is inside"),
        "{repair}"
    );
    assert_eq!((mesh.kind(), mesh.triangle_count()), (MeshKind::Solid, 2));
    assert_eq!(winding(&mesh, [0.2, 0.2, 1e-30]), Some(0));
    assert!(!repaired(&cube()).1.is_empty);
}

#[test]
fn nothing_but_turned_triangles_is_the_solid_itself() {
    for part in 1..5 {
        let mut soup = cube();
        soup.triangles
            .iter_mut()
            .enumerate()
            .filter(|x| x.0 % part == 0)
            .for_each(|x| x.1.swap(0, 1));
        let turned: Vec<u32> = (0..192).filter(|k| k % part as u32 == 0).collect();
        let (mesh, repair) = repaired(&soup);
        assert_eq!((mesh.volume(), &repair.turned, repair.caps.len()), (8.0, &turned, 0));
    }
}

#[test]
fn repetitions_of_any_number_are_one_triangle() {
    for times in 1..5 {
        let mut soup = cube();
        for k in [3, 50, 77] {
            (0..times).for_each(|_| soup.triangles.push(soup.triangles[k]));
        }
        soup.triangles.remove(20);
        let (mesh, repair) = repaired(&soup);
        assert_eq!((mesh.volume(), repair.caps.len()), (8.0, 1));
        assert_eq!(mesh.report().repeated.len(), 3 * times);
    }
}

/// A strip with one side, and three sheets on an edge: nothing can be inside or outside of them by
/// their triangles, and the chain is closed all the same.
#[test]
fn what_cannot_be_oriented_is_closed() {
    let n = 12;
    let mut strip = Soup::default();
    for k in 0..n {
        let turn = std::f64::consts::PI * f64::from(k) / f64::from(n);
        let (s, c) = (2.0 * turn).sin_cos();
        for side in [-0.3, 0.3] {
            let r = 1.0 + side * turn.cos();
            strip.points.push([r * c, r * s, side * turn.sin()]);
        }
        let [a, b] = [2 * k, 2 * k + 1];
        let [c, d] = if k + 1 < n { [2 * k + 2, 2 * k + 3] } else { [1, 0] };
        strip.triangles.extend([[a, c, b], [b, c, d]]);
    }
    let (mesh, repair) = repaired(&strip);
    assert_eq!((mesh.kind(), repair.one_sided_edges.len()), (MeshKind::Solid, 1));
    let book = Soup {
        points: vec![
            [0.0; 3],
            [0.0, 0.0, 1.0],
            [1.0, 0.0, 0.5],
            [-1.0, 0.5, 0.5],
            [-1.0, -0.5, 0.5],
        ],
        triangles: vec![[0, 1, 2], [0, 1, 3], [0, 1, 4]],
    };
    let (mesh, repair) = repaired(&book);
    assert_eq!((mesh.kind(), repair.one_sided_edges.len()), (MeshKind::Solid, 0));
}

/// A tube without its ends: two loops of 50,000 corners, and one of 100,000 along its length.
#[test]
fn loops_of_a_hundred_thousand_corners_take_a_moment() {
    let n = 50_000;
    let mut tube = Soup::default();
    for k in 0..n {
        let (s, c) = (std::f64::consts::TAU * f64::from(k) / f64::from(n)).sin_cos();
        tube.points.extend([[c, s, 0.0], [c, s, 1.0]]);
        let [a, b, c, d] = [2 * k, 2 * k + 1, (2 * k + 2) % (2 * n), (2 * k + 3) % (2 * n)];
        tube.triangles.extend([[a, c, b], [b, c, d]]);
    }
    let began = cpu_time::ThreadTime::now();
    let (mesh, repair) = repaired(&tube);
    assert_eq!(
        (mesh.kind(), repair.caps.len(), repair.longest_loop()),
        (MeshKind::Solid, 2, 50_000)
    );
    assert!((mesh.volume() - std::f64::consts::PI).abs() < 1e-6);
    tube.triangles.remove(7);
    tube.triangles.remove(6);
    let (mesh, repair) = repaired(&tube);
    assert_eq!(
        (mesh.kind(), repair.caps.len(), repair.longest_loop()),
        (MeshKind::Solid, 1, 100_000)
    );
    assert!(began.elapsed().as_secs() < 20, "{:?}", began.elapsed());
}

/// Many loops that meet in one vertex are found in linear time.
#[test]
fn many_loops_at_one_vertex_take_a_moment() {
    let n = 100_000u32;
    let mut soup = Soup {
        points: vec![[0.0; 3]],
        triangles: Vec::new(),
    };
    for k in 0..n {
        let (s, c) = (std::f64::consts::TAU * f64::from(k) / f64::from(n)).sin_cos();
        soup.points.extend([[c, s, 0.0], [c, s, 1.0]]);
        soup.triangles.push([0, 2 * k + 1, 2 * k + 2]);
    }
    let began = cpu_time::ThreadTime::now();
    let (mesh, repair) = repaired(&soup);
    assert!(repair.is_empty && mesh.triangle_count() == 2 * n as usize, "{repair}");
    assert!(began.elapsed().as_secs() < 20, "{:?}", began.elapsed());
}

#[test]
fn scales_of_powers_of_two_change_no_choice() {
    for seed in 0..20 {
        let mut rng = truth::rng::Rng::new(seed);
        let mut soup = soups::rock(2, seed);
        let lost: Vec<usize> = (0..30).map(|_| rng.below(soup.triangles.len())).collect();
        let kept = (0..soup.triangles.len()).filter(|t| !lost.contains(t));
        soup.triangles = kept.map(|t| soup.triangles[t]).collect();
        let run = |exponent: i32| {
            let unit = 2f64.powi(exponent);
            let scaled = soup.clone().map(|p| p.map(|x| x * unit));
            let options = RepairOptions::default().weld(unit / 64.0);
            let (mesh, repair) = with_report(Mesh::repaired(&points_of(&scaled), &scaled.triangles, &options));
            let area = repair.cap_share.to_bits();
            (
                repair,
                area,
                mesh.triangle_vertices(),
                mesh.vertices().iter().map(|p| p / unit).collect::<Vec<_>>(),
            )
        };
        let one = run(0);
        for exponent in [-330, -211, -40, 40, 211, 330] {
            assert_eq!(run(exponent), one, "{exponent}");
        }
    }
}

#[test]
fn a_tolerance_out_of_range_is_refused() {
    let soup = cube();
    for tolerance in [-1.0, f64::NAN, f64::INFINITY, 0.13, 5e-324] {
        let options = RepairOptions::default().weld(tolerance);
        let refused = Mesh::repaired(&points_of(&soup), &soup.triangles, &options);
        assert!(
            matches!(refused, Err(MeshError::Weld { extent: 2.0, .. })),
            "{refused:?}"
        );
    }
    let mut lost = points_of(&soup);
    lost[7].y = f64::NAN;
    for weld in [0.0, 0.1] {
        let refused = Mesh::repaired(&lost, &soup.triangles, &RepairOptions::default().weld(weld));
        assert!(matches!(refused, Err(MeshError::NotFinite { index: 7 })), "{refused:?}");
    }
    let far = soup.clone().map(|p| p.map(|x| 1e200 * x));
    for weld in [0.0, 1e190] {
        let refused = Mesh::repaired(&points_of(&far), &far.triangles, &RepairOptions::default().weld(weld));
        assert!(matches!(refused, Err(MeshError::OutOfRange { .. })), "{refused:?}");
    }
    let missing = Mesh::repaired(&points_of(&soup), &[[0, 1, 9999]], &RepairOptions::default().weld(0.1));
    assert!(matches!(missing, Err(MeshError::IndexOutOfRange { .. })));
    assert!(matches!(
        Mesh::repaired(&points_of(&soup), &[], &RepairOptions::default().weld(0.1)),
        Err(MeshError::Weld { .. })
    ));
    assert!(matches!(
        Mesh::repaired(&points_of(&soup), &[], &RepairOptions::default()),
        Err(MeshError::Empty { given: 0 })
    ));
}

/// Caps bend with their corners: the mesh stays closed, and its answers are those of a new mesh.
#[test]
fn caps_bend() {
    let mut soup = soups::sphere(2);
    for k in 0..7 {
        soup.triangles.remove(5 * k);
    }
    let (mut mesh, _) = repaired(&soup);
    let longer: Vec<_> = mesh
        .vertices()
        .iter()
        .map(|p| Point3::new(p.x, p.y, 2.0 * p.z))
        .collect();
    mesh.set_vertices(&longer).expect("as many vertices");
    let new = Mesh::new(&longer, &mesh.triangle_vertices()).expect("a mesh");
    assert_eq!(
        (mesh.kind(), mesh.volume().to_bits()),
        (MeshKind::Solid, new.volume().to_bits())
    );
    assert_eq!(winding(&mesh, [0.0, 0.0, 1.8]), Some(1));
}

/// A cap on one line has no area, and might have one after its corners move.
#[test]
fn a_cap_on_one_line_does_not_bend() {
    let mut soup = cube();
    let [a, b, c] = soup.triangles[0];
    let [p, q] = [a, b].map(|v| soup.points[v as usize]);
    soup.points.push([0, 1, 2].map(|k| 0.5 * (p[k] + q[k])));
    let middle = soup.points.len() as u32 - 1;
    soup.triangles[0] = [a, middle, c];
    soup.triangles.push([middle, b, c]);
    // Closed along the line as it is; with one more hole, the line has a cap as well.
    assert_eq!(repaired(&soup).1.caps.len(), 0);
    soup.triangles.remove(100);
    let (mut mesh, repair) = repaired(&soup);
    assert_eq!(
        (mesh.kind(), mesh.volume(), repair.caps.len()),
        (MeshKind::Solid, 8.0, 2)
    );
    assert_eq!(mesh.report().degenerate.len(), 1);
    let now = mesh.vertices();
    let refused = mesh.set_vertices(&now).expect_err("it might open");
    assert!(
        matches!(refused, VertexError::Dropped { triangle } if mesh.is_cap(triangle)),
        "{refused}"
    );
}

#[test]
fn a_repair_is_stopped_between_its_stages() {
    let mut soup = soups::sphere(4);
    soup.triangles.remove(0);
    let (points, options) = (points_of(&soup), RepairOptions::default().weld(1e-6));
    let mut stages = Vec::new();
    let mut note = |now: Progress| {
        stages.push(now.stage);
        ControlFlow::Continue(())
    };
    let told = WithProgress::new(&mut note).repaired(&points, &soup.triangles, &options);
    assert_eq!(with_report(told).1.caps.len(), 1);
    assert!(
        stages.contains(&"weld") && stages.contains(&"caps") && stages.contains(&"tree"),
        "{stages:?}"
    );
    for stage in ["weld", "edges", "caps", "tree"] {
        let mut stop = |now: Progress| {
            if now.stage == stage {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let stopped = WithProgress::new(&mut stop).repaired(&points, &soup.triangles, &options);
        assert!(matches!(stopped, Err(MeshError::Stopped)), "{stage}");
    }
}

/// Queries of a repaired mesh know an inside: a part in it overlaps, and a depth exists.
#[test]
fn a_part_inside_a_repaired_mesh_overlaps_it() {
    let mut soup = cube();
    soup.triangles.remove(0);
    let open = Mesh::new(&points_of(&soup), &soup.triangles).expect("a mesh");
    let (closed, _) = repaired(&soup);
    let part = super::mesh(&soups::sphere(1).map(|p| p.map(|x| 0.1 * x)));
    let at = super::relative(&truth::Pose::shift([0.2, 0.1, 0.0]));
    let state = |mesh: &Mesh| PairTracker::new().closest(mesh, &part, &at).state;
    assert_eq!(
        [state(&open), state(&closed)],
        [ContactState::Separated, ContactState::Overlapping]
    );
    let no_winding = PointQuery::new(&open)
        .winding_number(&Point3::origin())
        .expect_err("it is open");
    assert_eq!(
        no_winding.to_string(),
        "this mesh has no winding number (expected a polyhedron or a closed mesh)"
    );
}

/// A file holds the caps, too.
#[cfg(feature = "serde")]
#[test]
fn files_hold_caps() {
    let mut soup = soups::rock(2, 3);
    soup.triangles.truncate(300);
    let (mesh, _) = repaired(&soup);
    let text = serde_json::to_string(&mesh).expect("it is written");
    let again: Mesh = serde_json::from_str(&text).expect("it is read");
    let caps = |m: &Mesh| m.triangles().map(|(t, _)| m.is_cap(t)).collect::<Vec<_>>();
    assert_eq!(caps(&again), caps(&mesh));
    assert_eq!(
        (again.kind(), again.volume().to_bits()),
        (mesh.kind(), mesh.volume().to_bits())
    );
}
