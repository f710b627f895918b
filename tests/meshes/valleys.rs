//! Contacts of a vertex in a valley between two pieces, and between two faces of a mesh: along both
//! faces, against closed formulas.

use super::contacts::exact;
use super::{mesh, relative};
use lin_canny::nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use lin_canny::{Compound, ContactGroup, ConvexPatches, ConvexPolyhedron, PairTracker, Shape};
use truth::Pose;
use truth::rng::Rng;
use truth::soups::Soup;
use truth::support::piece_at;

const PREDICTION: f64 = 5e-3;

/// A valley along y with its bottom at the origin: directions from the bottom up the faces, and the
/// normals of the faces.
struct Valley {
    up: [Vector3<f64>; 2],
    normals: [Vector3<f64>; 2],
}

impl Valley {
    fn new(left: f64, right: f64) -> Self {
        let ((s, c), (t, d)) = (left.sin_cos(), right.sin_cos());
        Self {
            up: [Vector3::new(-c, 0.0, s), Vector3::new(d, 0.0, t)],
            normals: [Vector3::new(s, 0.0, c), Vector3::new(-t, 0.0, d)],
        }
    }

    /// Returns the bodies of both faces: wedges that meet below the bottom, slabs that cross there,
    /// or a slab on a slab.
    fn sections(&self, kind: usize) -> [Vec<Vector3<f64>>; 2] {
        let ([e, f], [n, m]) = (self.up, self.normals);
        let zero = Vector3::zeros();
        match kind {
            0 => {
                let down = -Vector3::z();
                [vec![zero, e, e - n, down], vec![zero, f, f - m, down]]
            }
            1 => {
                let slab = |e: Vector3<f64>, n: Vector3<f64>| vec![e * -0.4, e, e - n * 0.5, e * -0.4 - n * 0.5];
                [slab(e, n), slab(f, m)]
            }
            _ => [
                vec![zero, e, e - f * 0.5, f * -0.5],
                vec![-f, f, f - m * 0.5, -f - m * 0.5],
            ],
        }
    }

    /// Returns the valley as two pieces in separate frames.
    fn pieces(&self, kind: usize, radius: f64, rng: &mut Rng) -> ConvexPatches {
        let piece = |k: usize, rng: &mut Rng| {
            let own = if rng.below(2) == 0 {
                Isometry3::identity()
            } else {
                Pose::new(rng.quat(), rng.in_ball()).isometry()
            };
            // A piece with a radius has its core below the face.
            let core = self.sections(kind)[k].clone();
            let sink = self.normals[k] * radius;
            let ends = core
                .iter()
                .flat_map(|p| [-1.0, 1.0].map(|y| own.inverse() * Point3::from(p - sink + Vector3::y() * y)));
            let body = ConvexPolyhedron::from_points(&ends.collect::<Vec<_>>()).unwrap();
            let shape = Shape::from(body).rounded(radius).unwrap();
            piece_at(own, shape)
        };
        ConvexPatches::from_compound(Compound::new(vec![piece(0, rng), piece(1, rng)]).unwrap())
    }

    /// Returns the valley as two faces of an open mesh.
    fn faces(&self) -> ConvexPatches {
        let ends = |p: Vector3<f64>| [[p.x, -1.0, p.z], [p.x, 1.0, p.z]];
        ConvexPatches::from_mesh(mesh(&Soup::new(
            [self.up[0], Vector3::zeros(), self.up[1]]
                .into_iter()
                .flat_map(ends)
                .collect(),
            vec![[0, 2, 3], [0, 3, 1], [2, 4, 5], [2, 5, 3]],
        )))
    }

    /// Returns the lowest height above a face of the points of a body over it, and whether a vertex
    /// is there; infinite if no point is over the face.
    fn lowest(&self, side: usize, (core, radius): (&[Vector3<f64>], f64)) -> (f64, bool) {
        let (n, e) = (self.normals[side], self.up[side]);
        let mut best = (f64::INFINITY, false);
        for p in core {
            if e.dot(p) > -1e-12 && n.dot(p) - radius < best.0 {
                best = (n.dot(p) - radius, true);
            }
            for q in core {
                let (from, to) = (e.dot(p), e.dot(q));
                if from < 0.0 && to > 0.0 {
                    let height = n.dot(&(p + (q - p) * (from / (from - to)))) - radius;
                    if height < best.0 {
                        best = (height, false);
                    }
                }
            }
        }
        best
    }
}

/// Returns a body whose deepest point is at its origin, with its core and radius: the axis is z.
fn body(kind: usize) -> (Shape, Vec<Vector3<f64>>, f64) {
    let hull = |core: Vec<Vector3<f64>>, radius: f64| {
        let points: Vec<_> = core.iter().map(|p| Point3::from(*p)).collect();
        let shape = match core.len() {
            1 => Shape::ball(radius).unwrap(),
            2 => Shape::from(ConvexPolyhedron::segment(points[0], points[1]).unwrap())
                .rounded(radius)
                .unwrap(),
            _ => Shape::from(ConvexPolyhedron::from_points(&points).unwrap())
                .rounded(radius)
                .unwrap(),
        };
        (shape, core, radius)
    };
    let spike = |sides: usize, steep: f64| {
        let ring = (0..sides).map(|k| {
            let (s, c) = (std::f64::consts::TAU * k as f64 / sides as f64 + 0.2).sin_cos();
            Vector3::new(0.1 * c, 0.1 * s, 0.1 * steep)
        });
        let mut core: Vec<_> = ring.collect();
        core.push(Vector3::zeros());
        core
    };
    match kind {
        6 => hull(spike(4, 2.0), 1e-3),
        0 => hull(spike(4, 2.0), 0.0),
        1 => hull(spike(7, 1.5), 0.0),
        2 => hull(spike(4, 2.0), 0.03),
        3 => hull(vec![Vector3::zeros()], 0.05),
        4 => hull(vec![Vector3::zeros(), Vector3::new(0.02, 0.01, 0.2)], 0.04),
        // A bar with its lower edge along the valley.
        _ => hull(
            [-0.1, 0.1]
                .into_iter()
                .flat_map(|y| [[0.0, 0.0], [-0.1, 0.1], [0.1, 0.1], [0.0, 0.2]].map(|[x, z]| Vector3::new(x, y, z)))
                .collect(),
            0.0,
        ),
    }
}

/// Poses judged, and their faults.
#[derive(Default)]
struct Tally {
    apart: usize,
    touching: usize,
    deep: usize,
    both: usize,
    deepest: usize,
    faults: Vec<String>,
}

impl Tally {
    fn expect(&mut self, holds: bool, fault: impl FnOnce() -> String) {
        if !holds {
            self.faults.push(fault());
        }
    }

    /// Asserts that every contact is on a face of the valley, along its normal, and opposite a
    /// point of the body.
    fn judge_all(&mut self, valley: &Valley, found: &[ContactGroup], pose: &Pose, what: &str) {
        for c in found.iter().flat_map(|g| &g.contacts) {
            let (n, on_a) = (c.normal.into_inner(), c.point.point_on_a.coords);
            let is_along = |side: &usize| (n - valley.normals[*side]).norm() < 1e-9;
            let Some(side) = [0, 1].into_iter().find(is_along) else {
                self.faults.push(format!("{what}: a ghost {c:?}"));
                continue;
            };
            let is_on = n.dot(&on_a).abs() < 1e-9 && valley.up[side].dot(&on_a) > -1e-9;
            self.expect(is_on, || format!("{what}: off the face {c:?}"));
            let between = (pose.isometry() * c.point.point_on_b).coords - on_a;
            let is_opposite = (between - n * c.point.separation).norm() < 1e-9;
            self.expect(is_opposite, || format!("{what}: askew {c:?}"));
        }
    }

    /// Asserts that each face near the body has a contact, as deep as a vertex over the face.
    fn judge(
        &mut self,
        valley: &Valley,
        found: &[ContactGroup],
        core: (&[Vector3<f64>], f64),
        pose: &Pose,
        what: &str,
    ) {
        self.judge_all(valley, found, pose, what);
        let heights = [0, 1].map(|side| valley.lowest(side, core));
        let mut sides = 0;
        for (side, (height, is_vertex)) in heights.into_iter().enumerate() {
            if height > PREDICTION * (1.0 - 1e-6) {
                continue;
            }
            let group = found.iter().find(|g| (*g.normal - valley.normals[side]).norm() < 1e-9);
            let all = group.iter().flat_map(|g| &g.contacts);
            let least = all.map(|c| c.point.separation).fold(f64::INFINITY, f64::min);
            let is_there = least > height - 1e-9
                && least
                    < if is_vertex {
                        height + 1e-9
                    } else if height < -1e-9 {
                        0.0
                    } else {
                        PREDICTION
                    };
            self.expect(is_there, || {
                format!("{what}: side {side}, {height:e}, not {least:e}, at a vertex: {is_vertex}, {found:?}")
            });
            sides += 1;
            self.deepest += usize::from((least - height).abs() < 1e-9);
        }
        *(match heights[0].0.min(heights[1].0) {
            x if x > 1e-9 => &mut self.apart,
            x if x > -1e-9 => &mut self.touching,
            _ => &mut self.deep,
        }) += 1;
        self.both += usize::from(sides == 2);
    }
}

/// Returns heights over both faces: separated, touching both, below both.
fn heights(k: usize, rng: &mut Rng) -> [f64; 2] {
    let deep = |rng: &mut Rng| 10f64.powf(rng.range(-5.0, -2.3));
    match k % 4 {
        0 => [(); 2].map(|()| rng.range(1e-4, 0.9 * PREDICTION)),
        1 => [0.0; 2],
        _ => {
            let depth = deep(rng);
            [-depth, -depth * rng.range(0.1, 1.0)]
        }
    }
}

/// Judges poses of a body over a valley; returns the tally of a hundred or more.
fn poses(name: &str, make: impl Fn(&Valley, &mut Rng) -> ConvexPatches, kind: usize, seed: u64) -> Tally {
    let (mut rng, mut tally) = (Rng::new(seed), Tally::default());
    let (shape, core, radius) = body(kind);
    let b = ConvexPatches::from(shape);
    for k in 0..240 {
        // No steeper than the sides of the body.
        let steep = if kind == 5 { 0.7 } else { 0.9 };
        let (left, right) = (rng.range(0.1, steep), rng.range(0.1, steep));
        let valley = Valley::new(left, right);
        let a = make(&valley, &mut rng);
        // The axis between the normals, with a small deviation.
        let lean = UnitQuaternion::from_axis_angle(&Vector3::y_axis(), 0.5 * (left - right));
        let axis = Vector3::from(rng.unit());
        let tilt = if kind == 5 { 0.0 } else { rng.range(0.0, 0.15) };
        let q = lean * UnitQuaternion::new(axis * tilt);
        let [h, g] = heights(k, &mut rng).map(|h| h + radius);
        let [n, m] = valley.normals;
        let x = (h * m.z - g * n.z) / (n.x * m.z - m.x * n.z);
        let z = (g * n.x - h * m.x) / (n.x * m.z - m.x * n.z);
        let pose = Pose::new([q.i, q.j, q.k, q.w], [x, rng.range(-0.3, 0.3), z]);
        let placed: Vec<_> = core
            .iter()
            .map(|p| (pose.isometry() * Point3::from(*p)).coords)
            .collect();
        let what = format!("{name} {kind} {k}");
        let at = relative(&pose);
        let found = PairTracker::new()
            .contacts_between(&a, &b, &at, &exact(PREDICTION))
            .to_vec();
        tally.judge(&valley, &found, (&placed, radius), &pose, &what);
        // The other order has the same contacts, up to rounding.
        let back = PairTracker::new()
            .contacts_between(&b, &a, &at.swapped(), &exact(PREDICTION))
            .to_vec();
        tally.expect(back.len() == found.len(), || {
            format!("{what}: swapped {found:?} {back:?}")
        });
    }
    println!(
        "{name} {kind}: {} apart, {} touching, {} overlapping; {} with both faces; {} deepest; {} faults",
        tally.apart,
        tally.touching,
        tally.deep,
        tally.both,
        tally.deepest,
        tally.faults.len()
    );
    if let Some(fault) = tally.faults.first() {
        println!("{fault}");
    }
    tally
}

/// Returns whether a tally has enough of every kind.
fn passes(tally: &Tally) -> bool {
    tally.faults.is_empty() && tally.apart > 40 && tally.touching > 40 && tally.deep > 90 && tally.both > 150
}

#[test]
fn a_corner_between_two_pieces_has_contacts_along_both() {
    let mut all = true;
    for (form, name) in ["wedges", "slabs", "a slab on a slab"].into_iter().enumerate() {
        for kind in 0..7 {
            all &= passes(&poses(name, |v, rng| v.pieces(form, 0.0, rng), kind, 40 + form as u64));
        }
    }
    for kind in 0..7 {
        all &= passes(&poses("rounded slabs", |v, rng| v.pieces(1, 0.1, rng), kind, 44));
    }
    assert!(all);
}

#[test]
fn a_corner_between_two_faces_of_a_mesh_has_contacts_along_both() {
    let mut all = true;
    for kind in 0..7 {
        all &= passes(&poses("faces", |v, _| v.faces(), kind, 50));
    }
    assert!(all);
}

/// A vertex next to a ridge of two pieces has only the contact of its side, or of the ridge.
#[test]
fn a_corner_beside_a_ridge_between_two_pieces_has_contacts_of_the_ridge() {
    let mut rng = Rng::new(60);
    let (mut apart, mut deep) = (0, 0);
    for k in 0..400 {
        let kind = [0, 1, 2, 3, 4, 6][k % 6];
        let (shape, core, radius) = body(kind);
        let ridge = Valley::new(-rng.range(0.1, 0.8), -rng.range(0.1, 0.8));
        // Wedges that meet below the ridge: the faces fall away from the middle.
        let a = ridge.pieces(0, 0.0, &mut rng);
        let depth = if k % 2 == 0 {
            rng.range(1e-4, 4e-3)
        } else {
            -10f64.powf(rng.range(-5.0, -2.5))
        };
        let side = rng.below(2);
        // Next to the ridge, over one of the sides.
        let on = ridge.up[side] * rng.range(0.0, 0.02) + ridge.normals[side] * (depth + radius);
        let q = UnitQuaternion::new(Vector3::from(rng.unit()) * rng.range(0.0, 0.15));
        let pose = Pose::new([q.i, q.j, q.k, q.w], [on.x, rng.range(-0.3, 0.3), on.z]);
        let placed: Vec<_> = core
            .iter()
            .map(|p| (pose.isometry() * Point3::from(*p)).coords)
            .collect();
        let found = PairTracker::new()
            .contacts_between(&a, &ConvexPatches::from(shape), &relative(&pose), &exact(PREDICTION))
            .to_vec();
        let (height, is_vertex) = ridge.lowest(side, (&placed, radius));
        let what = format!("{k} {kind} {side} {depth:e} {height:e} {is_vertex} {found:?}");
        assert!(!found.is_empty(), "{what}");
        for c in found.iter().flat_map(|g| &g.contacts) {
            let (n, on_a) = (c.normal.into_inner(), c.point.point_on_a.coords);
            // In the normal cone of the ridge; on one of the faces; and no deeper than the body.
            let is_normal = n.y.abs() < 1e-9 && (0..2).all(|s| ridge.up[s].dot(&n) < 1e-9);
            let own = [0, 1].into_iter().any(|s| (n - ridge.normals[s]).norm() < 1e-9);
            let is_on = (0..2).any(|s| ridge.normals[s].dot(&on_a).abs() < 1e-9 && ridge.up[s].dot(&on_a) > -1e-9);
            let lowest = placed.iter().map(|p| n.dot(p) - radius).fold(f64::INFINITY, f64::min);
            assert!((own || is_normal), "{what}");
            assert!(is_on, "{what}");
            assert!(c.point.separation > lowest - n.dot(&on_a) - 1e-9, "{what}");
        }
        *(if depth > 0.0 { &mut apart } else { &mut deep }) += 1;
    }
    println!("{apart} apart, {deep} overlapping");
    assert!(apart == 200 && deep == 200);
}
