//! Polygons as triangles that cover the polygon and nothing else, notches and holes included.
//!
//! The polygon is projected by dropping one coordinate, so that its coordinates stay as they are. A
//! convex polygon becomes a fan. Any other becomes the triangles of a constrained Delaunay
//! triangulation around which the border winds once and no hole winds. Corners on a line stay,
//! because the faces next to the polygon use them.

use std::collections::{HashMap, VecDeque};

use spade::handles::FixedVertexHandle;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

/// Largest distance of a corner from the plane of its polygon, divided by the size of the polygon.
/// Faces of curved bodies with four corners or more are often not flat: up to 0.27 in public robots.
const BENT: f64 = 0.5;

/// Distance of corners along the normal from which a polygon is listed, divided by its size.
const FLAT: f64 = 1e-3;

/// Largest distance of corners from a line, divided by their length, at which a polygon counts as
/// without area.
const LINE: f64 = 1e-15;

type Point = [f64; 3];

/// Cuts a polygon with holes into triangles with the outside of the polygon. Corners are indices;
/// `point` returns their positions.
///
/// Equal neighbours are one corner. A polygon without area has no triangles; then `note` is called,
/// and also if a polygon is not flat.
pub(crate) fn triangulate(
    rings: &[&[u64]],
    point: impl Fn(u64) -> Point,
    mut note: impl FnMut(&'static str),
) -> Result<Vec<[u64; 3]>, String> {
    let rings: Vec<Vec<u64>> = rings.iter().map(|ring| without_repeats(ring, &point)).collect();
    let Some(outer) = rings.first() else {
        return Ok(Vec::new());
    };
    if let ([a, b, c], [_]) = (&outer[..], &rings[..]) {
        return Ok(vec![[*a, *b, *c]]);
    }
    let corners = relative(&rings, &point)?;
    let border = &corners[..outer.len()];
    if is_on_a_line(border) {
        return match rings[1..].iter().all(|hole| hole.len() < 3) {
            true => {
                note("faces without area");
                Ok(Vec::new())
            }
            false => Err(HOLE_OUTSIDE.into()),
        };
    }
    let normal = normal(border);
    let axis = (0..3).fold(0, |best, k| if normal[k].abs() > normal[best].abs() { k } else { best });
    if !(normal[axis].abs() > 0.0) {
        return Err("polygon is not simple: its area is zero, but its corners are not on a line".into());
    }
    let height = height(&corners, &normal);
    if !(height <= BENT) {
        return Err(format!(
            "polygon is not flat: {height:.3e} of its size along its normal (expected at most {BENT})"
        ));
    }
    if height > FLAT {
        note("polygons that are not flat (their diagonals are chosen)");
    }
    let flat = |k: u64| {
        let p = point(k);
        Point2::new(p[(axis + 1) % 3], p[(axis + 2) % 3])
    };
    match (rings.len() == 1)
        .then(|| fan(outer, normal[axis] < 0.0, &flat))
        .flatten()
    {
        Some(fan) => Ok(fan),
        None => by_winding(&rings, &point, &flat),
    }
}

fn without_repeats(ring: &[u64], point: &impl Fn(u64) -> Point) -> Vec<u64> {
    let mut kept: Vec<u64> = Vec::with_capacity(ring.len());
    for &corner in ring {
        if kept.last().is_none_or(|&last| point(last) != point(corner)) {
            kept.push(corner);
        }
    }
    while kept.len() > 1 && point(kept[0]) == point(kept[kept.len() - 1]) {
        kept.pop();
    }
    kept
}

/// Returns the larger of two numbers, and the first of two zeros: `f64::max` may return either.
fn larger(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// Returns the corners of all rings relative to the first corner and divided by their size, because
/// products of large or tiny coordinates overflow or vanish.
fn relative(rings: &[Vec<u64>], point: &impl Fn(u64) -> Point) -> Result<Vec<Point>, String> {
    let corners: Vec<Point> = rings.iter().flatten().map(|&k| point(k)).collect();
    let from = |p: &Point| [0, 1, 2].map(|k| p[k] - corners[0][k]);
    let size = corners.iter().flat_map(from).fold(0.0, |size, x| larger(size, x.abs()));
    if !size.is_finite() {
        return Err("size of a polygon is not finite".into());
    }
    Ok(corners
        .iter()
        .map(|p| from(p).map(|x| if size > 0.0 { x / size } else { 0.0 }))
        .collect())
}

/// Returns the normal of a polygon by Newell's method: twice the area along each axis.
fn normal(corners: &[Point]) -> Point {
    let mut sum = [0.0; 3];
    for (k, p) in corners.iter().enumerate() {
        let q = corners[(k + 1) % corners.len()];
        for (axis, sum) in sum.iter_mut().enumerate() {
            let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
            *sum += p[i] * q[j] - p[j] * q[i];
        }
    }
    sum
}

/// Returns whether all corners are on a line through the origin, up to rounding.
fn is_on_a_line(corners: &[Point]) -> bool {
    let square = |v: &Point| v.iter().map(|x| x * x).sum::<f64>();
    let farthest = corners
        .iter()
        .fold([0.0; 3], |far, v| if square(v) > square(&far) { *v } else { far });
    let across = |v: &Point| {
        let cross = [0, 1, 2].map(|k| {
            let (i, j) = ((k + 1) % 3, (k + 2) % 3);
            v[i] * farthest[j] - v[j] * farthest[i]
        });
        square(&cross)
    };
    let largest = corners.iter().map(across).fold(0.0, larger);
    largest <= LINE * LINE * square(&farthest) * square(&farthest)
}

/// Returns how far apart corners of size 1 are along the normal, those of holes included.
fn height(corners: &[Point], normal: &Point) -> f64 {
    let length = normal.iter().map(|x| x * x).sum::<f64>().sqrt();
    let heights = corners
        .iter()
        .map(|p| (0..3).map(|k| p[k] * normal[k]).sum::<f64>() / length);
    let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| {
        (if h < low { h } else { low }, larger(high, h))
    });
    high - low
}

/// Returns the orientation of three points: positive if they turn left, exactly.
fn orientation(a: Point2<f64>, b: Point2<f64>, c: Point2<f64>) -> f64 {
    let coord = |p: Point2<f64>| robust::Coord { x: p.x, y: p.y };
    robust::orient2d(coord(a), coord(b), coord(c))
}

/// Returns the fan of a polygon that is strictly convex in the projection.
fn fan(ring: &[u64], is_turned: bool, flat: &impl Fn(u64) -> Point2<f64>) -> Option<Vec<[u64; 3]>> {
    let n = ring.len();
    let turns = |a: u64, b: u64, c: u64| {
        let turn = orientation(flat(a), flat(b), flat(c));
        if is_turned { turn < 0.0 } else { turn > 0.0 }
    };
    let is_convex = (0..n).all(|k| turns(ring[k], ring[(k + 1) % n], ring[(k + 2) % n]));
    // A border that winds around its first corner turns the same way everywhere, but leaves the
    // side of its first edge.
    let is_beside = (2..n).all(|k| turns(ring[0], ring[1], ring[k]));
    let fan: Vec<[u64; 3]> = (1..n - 1).map(|k| [ring[0], ring[k], ring[k + 1]]).collect();
    (is_convex && is_beside && fan.iter().all(|&[a, b, c]| turns(a, b, c))).then_some(fan)
}

const HOLE_OUTSIDE: &str = "polygon has a hole outside its border or in another hole";

/// How often rings wind around a face: pairs of ring and number, without zeros, by ring.
type Windings = Vec<(usize, i32)>;

/// Returns the triangles around which the border winds once and no hole winds. They have the
/// orientation of the border.
fn by_winding(
    rings: &[Vec<u64>],
    point: &impl Fn(u64) -> Point,
    flat: &impl Fn(u64) -> Point2<f64>,
) -> Result<Vec<[u64; 3]>, String> {
    let mut cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let mut corner_of: HashMap<FixedVertexHandle, u64> = HashMap::new();
    let mut handles: Vec<Vec<FixedVertexHandle>> = Vec::new();
    for ring in rings {
        let mut of_ring = Vec::new();
        for &corner in ring {
            let p = flat(corner);
            let why = |_| {
                format!(
                    "corner of a polygon is out of range: {:e} {:e} (expected 0 or 1.8e-43..=3e60)",
                    p.x, p.y
                )
            };
            let handle = cdt.insert(p).map_err(why)?;
            let first = *corner_of.entry(handle).or_insert(corner);
            if point(first) != point(corner) {
                return Err("polygon is not flat: two of its corners differ only along its normal".into());
            }
            of_ring.push(handle);
        }
        handles.push(of_ring);
    }
    // What an edge adds to the windings where it is crossed from its right to its left.
    let mut steps: HashMap<[FixedVertexHandle; 2], Windings> = HashMap::new();
    for (number, ring) in handles.iter().enumerate() {
        for (k, &from) in ring.iter().enumerate() {
            let to = ring[(k + 1) % ring.len()];
            if from == to {
                continue;
            }
            if !cdt.can_add_constraint(from, to) {
                return Err("polygon is not simple: two of its edges cross".into());
            }
            cdt.add_constraint(from, to);
            if cdt.get_edge_from_neighbors(from, to).is_none() {
                return Err("polygon is not simple: a corner lies on another edge".into());
            }
            add(steps.entry([from, to]).or_default(), number, 1);
            add(steps.entry([to, from]).or_default(), number, -1);
        }
    }
    let mut windings: HashMap<_, Windings> = HashMap::from([(cdt.outer_face().fix(), Vec::new())]);
    // Edges whose right side is known, or whose left side is the outer face.
    let mut waiting: VecDeque<_> = cdt
        .convex_hull()
        .flat_map(|edge| [edge.fix(), edge.rev().fix()])
        .collect();
    let mut triangles = Vec::new();
    let mut sign = None;
    while let Some(edge) = waiting.pop_front() {
        let edge = cdt.directed_edge(edge);
        let Some(triangle) = edge.face().as_inner() else {
            continue;
        };
        if windings.contains_key(&edge.face().fix()) {
            continue;
        }
        let mut here = windings[&edge.rev().face().fix()].clone();
        for &(ring, step) in steps.get(&[edge.from().fix(), edge.to().fix()]).into_iter().flatten() {
            add(&mut here, ring, step);
        }
        match here[..] {
            [] => {}
            [(0, w)] | [(0, w), (_, -1 | 1)] if w.abs() == 1 && *sign.get_or_insert(w) == w => {}
            [(0, _)] => return Err("polygon is not simple: its border winds twice or in both senses".into()),
            _ => return Err(HOLE_OUTSIDE.into()),
        }
        if let [(0, w)] = here[..] {
            let [a, b, c] = triangle.vertices().map(|v| corner_of[&v.fix()]);
            triangles.push(if w > 0 { [a, b, c] } else { [a, c, b] });
        }
        windings.insert(edge.face().fix(), here);
        waiting.extend(triangle.adjacent_edges().map(|edge| edge.rev().fix()));
    }
    match triangles.is_empty() {
        true => Err("polygon is not simple: its border winds around no area".into()),
        false => Ok(triangles),
    }
}

/// Adds a step to the winding of a ring.
fn add(windings: &mut Windings, ring: usize, step: i32) {
    match windings.binary_search_by_key(&ring, |&(ring, _)| ring) {
        Ok(at) if windings[at].1 + step == 0 => drop(windings.remove(at)),
        Ok(at) => windings[at].1 += step,
        Err(at) => windings.insert(at, (ring, step)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangulate(rings: &[&[u64]], point: impl Fn(u64) -> Point) -> Result<Vec<[u64; 3]>, String> {
        super::triangulate(rings, point, |_| {})
    }

    /// A generator of numbers from 0 to 1.
    struct Random(u64);

    impl Random {
        fn next(&mut self) -> f64 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        }
    }

    fn twice_area(corners: &[Point]) -> Point {
        normal(corners)
    }

    /// Triangles cover the polygon: areas agree, none is turned over, and each border edge is used
    /// once.
    fn check(rings: &[Vec<Point>]) {
        let points: Vec<Point> = rings.iter().flatten().copied().collect();
        let mut first = 0;
        let indices: Vec<Vec<u64>> = rings
            .iter()
            .map(|ring| {
                let indices = (first..first + ring.len() as u64).collect();
                first += ring.len() as u64;
                indices
            })
            .collect();
        let slices: Vec<&[u64]> = indices.iter().map(Vec::as_slice).collect();
        let triangles = triangulate(&slices, |k| points[k as usize]).expect("a simple polygon");
        let whole = twice_area(&rings[0]);
        let length = whole.iter().map(|x| x * x).sum::<f64>().sqrt();
        let along = |v: Point| (0..3).map(|k| v[k] * whole[k] / length).sum::<f64>();
        let holes: f64 = rings[1..].iter().map(|hole| along(twice_area(hole)).abs()).sum();
        let (mut sum, mut edges) = (0.0, HashMap::<[u64; 2], i32>::new());
        for t in &triangles {
            let area = along(twice_area(&t.map(|k| points[k as usize])));
            assert!(area > -1e-12 * length, "{area} of {length}: {rings:?}");
            sum += area;
            for k in 0..3 {
                *edges.entry([t[k], t[(k + 1) % 3]]).or_default() += 1;
            }
        }
        assert!(
            (sum - (length - holes)).abs() < 1e-9 * length,
            "{sum} of {length} - {holes}"
        );
        for ring in &indices {
            for (k, &a) in ring.iter().enumerate() {
                let b = ring[(k + 1) % ring.len()];
                let uses = [[a, b], [b, a]].map(|e| edges.get(&e).copied().unwrap_or(0));
                assert_eq!(uses[0] + uses[1], 1, "edge {a}-{b}: {rings:?}");
            }
        }
    }

    /// Turns points in space.
    fn turned(ring: &[[f64; 2]], rng: &mut Random) -> impl Fn(&[[f64; 2]]) -> Vec<Point> + use<> {
        let _ = ring;
        let (a, b) = (6.0 * rng.next(), 6.0 * rng.next());
        let shift = [rng.next(), rng.next(), rng.next()];
        move |ring| {
            let turn = |[x, y]: [f64; 2]| {
                let (x, y) = (x * a.cos() - y * a.sin(), x * a.sin() + y * a.cos());
                let (y, z) = (y * b.cos(), y * b.sin());
                [x + shift[0], y + shift[1], z + shift[2]]
            };
            ring.iter().map(|&p| turn(p)).collect()
        }
    }

    #[test]
    fn random_polygons_are_covered() {
        let mut rng = Random(88_172_645_463_325_252);
        for case in 0..3_000 {
            // A star: any radius at increasing angles, some corners on a line between neighbours.
            let n = 3 + (rng.next() * 20.0) as usize;
            let mut ring: Vec<[f64; 2]> = (0..n)
                .map(|k| {
                    let angle = std::f64::consts::TAU * (k as f64 + 0.6 * rng.next()) / n as f64;
                    let radius = if rng.next() < 0.2 { 0.02 } else { 0.2 + rng.next() };
                    [radius * angle.cos(), radius * angle.sin()]
                })
                .collect();
            if n > 4 && case % 3 == 0 {
                let (p, q) = (ring[1], ring[2]);
                ring.insert(2, [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])]);
            }
            if case % 2 == 0 {
                ring.reverse();
            }
            let place = turned(&ring, &mut rng);
            check(&[place(&ring)]);
            let flat: Vec<Point> = ring.iter().map(|&[x, y]| [x, y, 0.0]).collect();
            check(&[flat]);
        }
    }

    #[test]
    fn a_ring_has_a_hole() {
        let mut rng = Random(362_436_069);
        let square = |r: f64| [[-r, -r], [r, -r], [r, r], [-r, r]];
        for k in 0..100 {
            let inner = square(0.05 + 0.009 * f64::from(k));
            let place = turned(&square(1.0), &mut rng);
            let mut hole = place(&inner);
            check(&[place(&square(1.0)), hole.clone()]);
            hole.reverse();
            check(&[place(&square(1.0)), hole]);
        }
    }

    #[test]
    fn crossing_edges_are_an_error() {
        let points = [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
        let found = triangulate(&[&[0, 1, 2, 3]], |k| points[k as usize]);
        assert!(found.expect_err("a bow tie").contains("not simple"));
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 1.0], [1.0, 1.0, 0.0], [0.0, 1.0, 1.0]];
        let found = triangulate(&[&[0, 1, 2, 3]], |k| points[k as usize]);
        assert!(found.expect_err("far from a plane").contains("not flat"));
    }

    #[test]
    fn a_hole_outside_is_an_error() {
        let square = |x: f64, r: f64| [[x - r, -r, 0.0], [x + r, -r, 0.0], [x + r, r, 0.0], [x - r, r, 0.0]];
        let points: Vec<Point> = square(0.0, 1.0).into_iter().chain(square(3.0, 0.5)).collect();
        let found = triangulate(&[&[0, 1, 2, 3], &[4, 5, 6, 7]], |k| points[k as usize]);
        assert!(found.expect_err("a hole outside").contains("hole"));
    }

    #[test]
    fn polygons_without_area_have_no_triangles() {
        let bow = [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let found = triangulate(&[&[0, 1, 2, 3]], |k| bow[k as usize]);
        assert!(found.expect_err("a bow tie of two equal halves").contains("not simple"));
        let points = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0]];
        assert!(
            triangulate(&[&[0, 1, 2, 3]], |k| points[k as usize])
                .expect("a line")
                .is_empty()
        );
        assert!(
            triangulate(&[&[0, 0, 1, 1]], |k| points[k as usize])
                .expect("two points")
                .is_empty()
        );
    }

    #[test]
    fn borders_around_their_first_corner_are_an_error() {
        let spiral = [
            [0.0, 0.0],
            [1.0, 0.0],
            [0.0, 1.0],
            [-1.0, 0.0],
            [0.0, -1.0],
            [1.3, 0.75],
        ];
        let found = triangulate(&[&[0, 1, 2, 3, 4, 5]], |k| {
            let [x, y] = spiral[k as usize];
            [x, y, 0.0]
        });
        assert!(found.expect_err("a spiral").contains("edges cross"));
    }

    #[test]
    fn corners_along_the_normal_are_an_error() {
        let points = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [1.0, 1.0, 0.09],
            [0.0, 1.0, 0.0],
        ];
        let found = triangulate(&[&[0, 1, 2, 3, 4]], |k| points[k as usize]);
        assert!(found.expect_err("a step").contains("along its normal"));
    }

    #[test]
    fn borders_that_touch_themselves_wind_once() {
        // A square and a loop from its first corner: a hole if it runs back, or covered twice.
        let points = [
            [0.0, 0.0],
            [4.0, 0.0],
            [4.0, 4.0],
            [0.0, 4.0],
            [2.0, 1.0],
            [1.0, 2.0],
            [0.0, 0.0],
        ];
        let at = |k: u64| [points[k as usize][0], points[k as usize][1], 0.0];
        let area = |t: &[u64; 3]| 0.5 * twice_area(&t.map(at))[2];
        let back = triangulate(&[&[0, 1, 2, 3, 6, 5, 4]], at).expect("a hole that touches its border");
        assert_eq!(back.iter().map(area).sum::<f64>(), 16.0 - 1.5);
        let twice = triangulate(&[&[0, 1, 2, 3, 6, 4, 5]], at);
        assert!(twice.expect_err("covered twice").contains("winds twice"));
        let whole = triangulate(&[&[0, 1, 2, 3, 0, 1, 2, 3]], at);
        assert!(whole.expect_err("all covered twice").contains("winds twice"));
    }

    #[test]
    fn holes_are_inside_the_border_and_outside_other_holes() {
        let square = |x: f64, z: f64, r: f64| [[x - r, -r, z], [x + r, -r, z], [x + r, r, z], [x - r, r, z]];
        let cut = |holes: &[[Point; 4]]| {
            let points: Vec<Point> = [square(0.0, 0.0, 1.0)].iter().chain(holes).flatten().copied().collect();
            let rings: Vec<[u64; 4]> = (0..=holes.len() as u64)
                .map(|k| [0, 1, 2, 3].map(|c| 4 * k + c))
                .collect();
            let rings: Vec<&[u64]> = rings.iter().map(|ring| &ring[..]).collect();
            triangulate(&rings, |k| points[k as usize]).map(|triangles| triangles.len())
        };
        assert_eq!(cut(&[square(0.5, 0.0, 2e-4), square(-0.5, 0.0, 2e-4)]), Ok(14));
        // Holes that share an edge are one hole.
        assert_eq!(cut(&[square(-0.25, 0.0, 0.25), square(0.25, 0.0, 0.25)]), Ok(10));
        for (holes, why) in [
            (vec![square(3.0, 0.0, 2e-4)], "outside its border"),
            (vec![square(0.0, 0.0, 0.5), square(0.0, 0.0, 2e-4)], "in another hole"),
            (vec![square(0.0, 0.0, 1.0)], "winds around no area"),
            (vec![square(0.0, 5.0, 0.5)], "not flat"),
            (vec![square(0.9, 0.0, 0.2)], "edges cross"),
        ] {
            match (cut(&holes), why) {
                (Err(error), _) => assert!(error.contains(why), "{error}"),
                (Ok(count), _) => panic!("{count} triangles: {why}"),
            }
        }
        let line = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let found = triangulate(&[&[0, 1], &[0, 1, 2, 3]], |k| line[k as usize]);
        assert!(found.expect_err("a hole in a line").contains("hole"));
    }
}
