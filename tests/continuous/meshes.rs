//! Meshes over a frame: first contacts are those of all pairs of triangles, and exact arithmetic
//! confirms them in the bracket.

use super::given;
use lin_canny::continuous::{self, MovingMesh, elements};
use lin_canny::impact::{Impact, ImpactError, Tolerance};
use lin_canny::nalgebra::{Isometry3, Point3};
use lin_canny::{ContactState, Mesh};
use truth::Point;
use truth::forms::mesh;
use truth::paths::{self, Truth};
use truth::pose::{add, scale};
use truth::rational::exact;
use truth::rng::Rng;
use truth::soups::{self, Soup};

const WIDTH: f64 = 1e-9;

pub(crate) fn sheet(n: u32, side: f64) -> Soup {
    let at = |i: u32| side * (f64::from(i) / f64::from(n) - 0.5);
    let points = (0..=n)
        .flat_map(|i| (0..=n).map(move |j| [at(i), at(j), 0.0]))
        .collect();
    let square = |i: u32, j: u32| {
        let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(k, l)| (i + k) * (n + 1) + j + l);
        [[a, b, c], [a, c, d]]
    };
    let triangles = (0..n).flat_map(|i| (0..n).flat_map(move |j| square(i, j))).collect();
    Soup::new(points, triangles)
}

pub(crate) fn vertices(soup: &Soup) -> Vec<Point3<f64>> {
    soup.points.iter().map(|p| Point3::from(*p)).collect()
}

/// Returns the mesh of a body at rest at both ends of a frame.
pub(crate) fn ends(rest: &Soup, [begin, end]: [&Soup; 2]) -> [Mesh; 2] {
    let mut m = mesh(rest);
    m.set_vertices(&vertices(begin)).unwrap();
    let before = m.clone();
    m.set_vertices(&vertices(end)).unwrap();
    [before, m]
}

/// Returns the paths of a triangle between two states of the same soup.
fn corners([begin, end]: [&Soup; 2], t: usize) -> [paths::Path; 3] {
    let (p, q) = (begin.corners(t), end.corners(t));
    [0, 1, 2].map(|k| [p[k], q[k]])
}

/// Returns the first contact of all pairs of triangles by the crate's kernel: at the start, or
/// between two times.
fn brute(a: [&Soup; 2], b: [&Soup; 2], is_self: bool) -> Option<[f64; 2]> {
    let mut first = [f64::INFINITY; 2];
    for i in 0..a[0].triangles.len() {
        for j in 0..b[0].triangles.len() {
            let (s, t) = (a[0].triangles[i], b[0].triangles[j]);
            if is_self && (i >= j || s.iter().any(|v| t.contains(v))) {
                continue;
            }
            let [p, q]: [elements::Positions<3>; 2] = [given(&corners(a, i)), given(&corners(b, j))];
            match elements::cast_triangles(&p, &q, Tolerance::Time(WIDTH)).unwrap().impact {
                Impact::Miss => {}
                Impact::AtStart { .. } => return Some([-1.0, 0.0]),
                Impact::Hit { safe, hit, .. } => first = [first[0].min(safe), first[1].min(hit)],
                other => panic!("{other:?}"),
            }
        }
    }
    (first[1] <= 1.0).then_some(first)
}

/// Judges a cast; returns 0 for a miss, 1 for a start, 2 for a hit.
pub(crate) fn judge(impact: &Impact, a: [&Soup; 2], b: [&Soup; 2], is_self: bool, what: &str) -> usize {
    let truth = brute(a, b, is_self);
    let named = |pieces: [u32; 2]| {
        let [i, j] = pieces.map(|k| k as usize);
        paths::triangles(&corners(a, i), &corners(b, j))
    };
    match (impact, truth) {
        (Impact::Miss, None) => 0,
        (Impact::AtStart { seen }, Some([_, 0.0])) => {
            assert!(matches!(named(seen.subshapes), Truth::Start), "{what}: {impact:?}");
            1
        }
        (Impact::Hit { safe, hit, seen }, Some([low, high])) if high > 0.0 => {
            assert!(hit - safe <= WIDTH, "{what}: {impact:?} {low} {high}");
            assert!(*safe < high, "{what}: {impact:?} {low} {high}");
            assert!(low < *hit, "{what}: {impact:?} {low} {high}");
            assert!(seen.state == ContactState::Separated, "{what}: {impact:?}");
            assert!(seen.lower <= seen.upper, "{what}: {impact:?}");
            // The reported triangles meet in the bracket, or after its start and before its end.
            let Truth::At(from, to) = named(seen.subshapes) else {
                panic!("{what}: {impact:?} does not meet")
            };
            assert!(exact(*safe) <= to && from < exact(*hit), "{what}: {impact:?}");
            2
        }
        _ => panic!("{what}: {impact:?} {truth:?}"),
    }
}

/// Motions of a body in a frame.
const WAYS: [&str; 6] = ["fall", "wave", "crumple", "fold", "lattice", "still"];

pub(crate) fn moved(way: &str, rng: &mut Rng, rest: &Soup) -> [Soup; 2] {
    let (shift, high) = (rng.range(-1.5, 1.5), rng.range(0.05, 1.2));
    let phase = rng.range(0.0, 6.0);
    let wave = |[x, y, z]: Point, time: f64| [x, y, z + 0.3 * (3.0 * x + phase + 2.0 * time).sin() + high];
    let rest = rest.clone();
    let rounded = |p: Point| p.map(|x| (4.0 * x).round() / 4.0);
    match way {
        "fall" => [
            rest.clone().map(|p| add(p, [0.1, 0.2, high])),
            rest.map(|p| add(p, [0.1, 0.2, high - 1.5])),
        ],
        "wave" => [rest.clone().map(|p| wave(p, 0.0)), rest.map(|p| wave(p, shift))],
        "crumple" => {
            let mut shaken = |size: f64| {
                let points = rest.points.iter().map(|p| add(*p, scale(rng.unit(), size))).collect();
                let triangles = rest.triangles.clone();
                Soup::new(points, triangles)
            };
            let lifted = shaken(0.05).map(|p| add(p, [0.0, 0.0, high]));
            [lifted, shaken(0.2)]
        }
        "fold" => {
            let turned = |[x, y, z]: Point, angle: f64| match x > 0.0 {
                true => [x * angle.cos() - z * angle.sin(), y, x * angle.sin() + z * angle.cos()],
                false => [x, y, z],
            };
            let first = 2.0 + 0.2 * shift;
            [
                rest.clone().map(|p| turned(p, first)),
                rest.map(|p| turned(p, first + high)),
            ]
        }
        "lattice" => [
            rest.clone().map(|p| rounded(wave(p, 0.0))),
            rest.map(|p| rounded(wave(p, shift))),
        ],
        _ => [rest.clone().map(|p| wave(p, 0.0)), rest.map(|p| wave(p, 0.0))],
    }
}

#[test]
fn a_bending_mesh_meets_another_when_all_pairs_of_triangles_say() {
    let (mut tally, mut rng) = ([0; 3], Rng::new(7));
    for round in 0..6 {
        for way in WAYS {
            for (k, rest) in [sheet(6, 2.0), soups::rock(1, 5)].iter().enumerate() {
                let other = &[soups::rock(1, 3), soups::torus(8, 5, 0.4)][round % 2];
                let other = other.clone().map(|p| scale(p, 0.5));
                let [begin, end] = moved(way, &mut rng, rest);
                let begin = if k == 1 {
                    begin.map(|p| add(p, [0.0, 0.0, 1.1]))
                } else {
                    begin
                };
                let m = ends(rest, [&begin, &end]);
                let n = mesh(&other);
                let (a, b) = (MovingMesh::new(&m[0], &m[1]).unwrap(), MovingMesh::new(&n, &n).unwrap());
                let what = format!("{way} {round} {k}");
                let (p, q) = ([&begin, &end], [&other, &other]);
                let found = continuous::cast_meshes(&a, &b, Tolerance::Time(WIDTH)).unwrap();
                tally[judge(&found.impact, p, q, false, &what)] += 1;
                let back = continuous::cast_meshes(&b, &a, Tolerance::Time(WIDTH)).unwrap();
                judge(&back.impact, q, p, false, &what);
            }
        }
    }
    assert!(tally.iter().all(|n| *n > 4), "{tally:?}");
}

/// Judges a mesh against itself between two lists of positions; the result is that of `judge`.
fn judge_self(rest: &Soup, p: [&Soup; 2], what: &str) -> usize {
    let [begin, end] = ends(rest, p);
    let moving = MovingMesh::new(&begin, &end).unwrap();
    let found = continuous::cast_self(&moving, Tolerance::Time(WIDTH)).unwrap();
    judge(&found.impact, p, p, true, what)
}

#[test]
fn a_mesh_meets_itself_when_all_pairs_of_triangles_say() {
    let (mut tally, mut rng) = ([0; 3], Rng::new(9));
    for round in 0..6 {
        for way in WAYS {
            for (k, rest) in [sheet(6, 2.0), soups::knot(16, 4, 0.1)].iter().enumerate() {
                let [begin, end] = moved(way, &mut rng, rest);
                tally[judge_self(rest, [&begin, &end], &format!("{way} {round} {k}"))] += 1;
            }
        }
    }
    assert!(tally.iter().all(|n| *n > 3), "{tally:?}");
}

/// Strips that wind about an axis twice, or about once.
///
/// Every part is a height field, the whole is not, and layers that pass each other meet. A flat
/// spiral is a height field that never meets itself.
#[test]
fn strips_that_wind_over_themselves_meet_when_all_pairs_of_triangles_say() {
    let mut tally = [0; 3];
    for (k, turns) in [2.0, 1.05, 0.97, 1.4, 2.0, 1.02].into_iter().enumerate() {
        // Pitches, and the rotation of the ends.
        for (from, to, more) in [
            (0.3, -0.3, 0.0),
            (0.3, 0.02, 0.0),
            (0.0, 0.3, 0.0),
            (0.2, 0.2, 0.0),
            (-0.2, 0.4, 0.0),
            (0.0, 0.0, 0.08),
            (0.1, -0.05, 0.06),
        ] {
            let n = 40;
            // Growing radii keep even a flat strip apart from itself, if they grow by more than the
            // width per turn.
            let place = |i: u32, side: f64, (pitch, turns): (f64, f64)| {
                let turn = turns * f64::from(i) / f64::from(n);
                let (sine, cosine) = (std::f64::consts::TAU * turn).sin_cos();
                let r = 1.0 + side + if k >= 4 { 0.5 * turn } else { 0.0 };
                [r * cosine, r * sine, pitch * turn + 0.01 * side * f64::from(i % 3)]
            };
            let at = |pitch: (f64, f64)| {
                let points = (0..=n)
                    .flat_map(|i| [place(i, 0.0, pitch), place(i, 0.4, pitch)])
                    .collect();
                let square = |i: u32| [[2 * i, 2 * i + 1, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 2]];
                Soup::new(points, (0..n).flat_map(square).collect())
            };
            let (begin, end) = (at((from, turns)), at((to, turns + more)));
            let what = format!("{turns} {from} {to} {more} {k}");
            tally[judge_self(&at((0.5, turns)), [&begin, &end], &what)] += 1;
        }
    }
    assert!(tally.iter().all(|n| *n > 2), "{tally:?}");
}

/// A tree that is rebuilt between both ends of a frame changes no answer.
#[test]
fn a_tree_may_be_made_anew_within_a_frame() {
    let rest = sheet(12, 2.0);
    let at = |z: &dyn Fn(&Point) -> f64| {
        Soup::new(
            rest.points.iter().map(|p| [p[0], p[1], z(p)]).collect(),
            rest.triangles.clone(),
        )
    };
    let floor = mesh(&at(&|p| -0.5 + 0.2 * p[0] * p[1]));
    let floor = MovingMesh::new(&floor, &floor).unwrap();
    for k in 0..10 {
        let bend = 0.015 * f64::from(k);
        let [before, after] = ends(&rest, [&at(&|p| bend * p[0]), &at(&|p| bend * p[0] * p[0] - 1.0)]);
        let mut anew = after.clone();
        anew.rebuild();
        let frames = [(&before, &after), (&before, &anew), (&anew, &before)].map(|(begin, end)| {
            let frame = MovingMesh::new(begin, end).unwrap();
            continuous::cast_meshes(&frame, &floor, Tolerance::Time(WIDTH))
                .unwrap()
                .impact
        });
        let [
            Impact::Hit { safe, hit, .. },
            Impact::Hit {
                safe: low, hit: high, ..
            },
            back,
        ] = frames
        else {
            panic!("{frames:?}");
        };
        assert!(low <= hit && safe <= high, "{frames:?}");
        let Impact::Hit { safe, hit, .. } = back else {
            panic!("{back:?}")
        };
        assert!(0.0 < safe && safe < hit && hit < 1.0, "{back:?}");
    }
}

/// The middle of a sheet is pushed over its surroundings, and down: the boundary stays fixed, and
/// triangles turn over.
#[test]
fn a_sheet_that_is_pushed_over_itself_meets_itself_when_all_pairs_of_triangles_say() {
    let (mut tally, mut rng) = ([0; 3], Rng::new(29));
    let rest = sheet(7, 2.0);
    for round in 0..30 {
        let (far, up) = (rng.range(0.0, 1.0), rng.range(0.02, 0.3));
        let pushed = |x: f64, z: f64| {
            rest.clone().map(|p| {
                let is_inner = p[0].abs() < 0.5 && p[1].abs() < 0.5;
                if is_inner { add(p, [x, 0.3 * x, z]) } else { p }
            })
        };
        let begin = pushed(far, up);
        let end = pushed(far * rng.range(0.5, 1.2), up * rng.range(-1.0, 1.0));
        tally[judge_self(&rest, [&begin, &end], &format!("{round}"))] += 1;
    }
    assert!(tally[0] > 4 && tally[2] > 4, "{tally:?}");
}

#[test]
fn other_meshes_and_sizes_are_refused() {
    let (rest, other) = (sheet(4, 2.0), sheet(5, 2.0));
    let (m, n) = (mesh(&rest), mesh(&other));
    assert_eq!(MovingMesh::new(&m, &n).err(), Some(ImpactError::Mesh));
    let mut anew = m.clone();
    let fold = |p: &Point| Point3::new(p[0].abs(), p[1], 0.2 * p[0]);
    anew.set_vertices(&rest.points.iter().map(fold).collect::<Vec<_>>())
        .unwrap();
    assert!(MovingMesh::new(&m, &anew).is_ok());
    let frame = MovingMesh::new(&m, &m).unwrap();
    for bad in [f64::NAN, -1.0, f64::INFINITY] {
        assert!(continuous::cast_meshes(&frame, &frame, Tolerance::Time(bad)).is_err());
        assert!(continuous::cast_self(&frame, Tolerance::Distance(bad)).is_err());
    }
    let nan = Isometry3::translation(f64::NAN, 0.0, 0.0);
    assert!(matches!(
        frame.with_poses(&nan, &Isometry3::identity()).err(),
        Some(ImpactError::Pose(_))
    ));
}

#[test]
fn casts_scale_by_powers_of_two() {
    let run = |size: f64| {
        let mut rng = Rng::new(21);
        let mut all = Vec::new();
        for way in WAYS {
            let rest = sheet(5, 2.0);
            let sized = |s: Soup| s.map(|p| scale(p, size));
            let [begin, end] = moved(way, &mut rng, &rest).map(sized);
            let m = ends(&sized(rest), [&begin, &end]);
            let n = mesh(&sized(soups::rock(1, 3).map(|p| scale(p, 0.5))));
            let (a, b) = (MovingMesh::new(&m[0], &m[1]).unwrap(), MovingMesh::new(&n, &n).unwrap());
            let at = Isometry3::translation(0.0, 0.0, -0.7 * size);
            let b = b.with_poses(&at, &at).unwrap();
            let cast = continuous::cast_meshes(&a, &b, Tolerance::Time(WIDTH)).unwrap();
            let own = continuous::cast_self(&a, Tolerance::Distance(1e-6 * size)).unwrap();
            let bracket = |impact: Impact| match impact {
                Impact::Hit { safe, hit, seen } => [safe, hit, seen.upper / size],
                Impact::Miss => [2.0; 3],
                Impact::AtStart { .. } => [-1.0; 3],
                other => panic!("{other:?}"),
            };
            all.push((bracket(cast.impact), bracket(own.impact), cast.queries));
        }
        all
    };
    let one = run(1.0);
    for exponent in [-300, -70, 1, 70, 300] {
        assert_eq!(run(2f64.powi(exponent)), one, "{exponent}");
    }
}
