//! Prisms over polygons in whole coordinates: their surfaces, and the convex cells whose union they
//! are.

use crate::Point;
use crate::rng::Rng;
use crate::soups::Soup;
use std::collections::HashMap;

/// A point in whole coordinates.
pub(super) type Whole = [i64; 3];

/// The vertices of a triangular prism: three below, three above.
pub(super) type Cell = [Whole; 6];

/// Lengths are multiples of this, so that edges can be halved twice.
pub(super) const GRID: i64 = 16;

/// The outline of a prism.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outline {
    Box,
    Wedge,
    Octagon,
    L,
    U,
    H,
}

/// The space between two copies of a polygon, one directly above the other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Prism {
    pub(super) kind: Outline,
    /// Counter-clockwise.
    pub(super) outline: Vec<[i64; 2]>,
    pub(super) low: i64,
    pub(super) high: i64,
    /// The axis of the prism.
    pub(super) axis: usize,
}

/// Twice the signed area of a triangle.
fn turn(a: [i64; 2], b: [i64; 2], c: [i64; 2]) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Cuts a polygon into triangles by clipping ears, starting at a vertex.
fn ears(outline: &[[i64; 2]], first: usize) -> Vec<[usize; 3]> {
    let mut rest: Vec<usize> = (0..outline.len()).map(|k| (k + first) % outline.len()).collect();
    let mut all = Vec::new();
    while rest.len() > 3 {
        let n = rest.len();
        let is_ear = |k: usize| {
            let [i, j, l] = [rest[k], rest[(k + 1) % n], rest[(k + 2) % n]];
            let [a, b, c] = [i, j, l].map(|v| outline[v]);
            let holds = |p: [i64; 2]| turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
            turn(a, b, c) > 0 && rest.iter().all(|&v| [i, j, l].contains(&v) || !holds(outline[v]))
        };
        let k = (0..n).find(|&k| is_ear(k)).expect("a simple polygon has an ear");
        all.push([rest[k], rest[(k + 1) % n], rest[(k + 2) % n]]);
        rest.remove((k + 1) % n);
    }
    all.push([rest[0], rest[1], rest[2]]);
    all
}

impl Prism {
    pub(super) fn draw(rng: &mut Rng) -> Self {
        let kinds = [
            Outline::Box,
            Outline::Wedge,
            Outline::Octagon,
            Outline::L,
            Outline::U,
            Outline::H,
        ];
        let kind = kinds[rng.below(6)];
        let [w, h] = [(); 2].map(|()| 3 + rng.below(4) as i64);
        let mut outline: Vec<[i64; 2]> = match kind {
            Outline::Box => vec![[0, 0], [w, 0], [w, h], [0, h]],
            Outline::Wedge => vec![[0, 0], [w, 0], [0, h]],
            Outline::Octagon => vec![
                [1, 0],
                [w - 1, 0],
                [w, 1],
                [w, h - 1],
                [w - 1, h],
                [1, h],
                [0, h - 1],
                [0, 1],
            ],
            Outline::L => vec![[0, 0], [w, 0], [w, 1], [1, 1], [1, h], [0, h]],
            Outline::U => vec![[0, 0], [w, 0], [w, h], [w - 1, h], [w - 1, 1], [1, 1], [1, h], [0, h]],
            Outline::H => vec![
                [0, 0],
                [1, 0],
                [1, 1],
                [w - 1, 1],
                [w - 1, 0],
                [w, 0],
                [w, h],
                [w - 1, h],
                [w - 1, 2],
                [1, 2],
                [1, h],
                [0, h],
            ],
        };
        for _ in 0..rng.below(4) {
            outline.iter_mut().for_each(|p| *p = [-p[1], p[0]]);
        }
        let at = [(); 2].map(|()| rng.below(5) as i64 - 2);
        outline
            .iter_mut()
            .for_each(|p| *p = [GRID * (p[0] + at[0]), GRID * (p[1] + at[1])]);
        let low = rng.below(5) as i64 - 2;
        Self {
            kind,
            outline,
            low: GRID * low,
            high: GRID * (low + 1 + rng.below(4) as i64),
            axis: if rng.chance(0.6) { 2 } else { rng.below(3) },
        }
    }

    /// Returns the box of the same outline, shrunk on some sides: flush with the other sides, or
    /// inside.
    pub(super) fn within(&self, rng: &mut Rng) -> Self {
        let bounds = |k: usize| {
            let all = || self.outline.iter().map(|p| p[k]);
            (all().min().unwrap_or(0), all().max().unwrap_or(0))
        };
        let mut inner = |(low, high): (i64, i64)| {
            let by = [(); 2].map(|()| GRID / 4 * rng.below(2) as i64);
            (low + by[0], high - by[1])
        };
        let [(l, r), (d, u)] = [inner(bounds(0)), inner(bounds(1))];
        let (low, high) = inner((self.low, self.high));
        Self {
            kind: Outline::Box,
            outline: vec![[l, d], [r, d], [r, u], [l, u]],
            low,
            high,
            axis: self.axis,
        }
    }

    pub(super) fn moved(mut self, by: Whole) -> Self {
        let [x, y] = [(self.axis + 1) % 3, (self.axis + 2) % 3];
        self.outline.iter_mut().for_each(|p| *p = [p[0] + by[x], p[1] + by[y]]);
        (self.low, self.high) = (self.low + by[self.axis], self.high + by[self.axis]);
        self
    }

    pub(super) fn is_convex(&self) -> bool {
        matches!(self.kind, Outline::Box | Outline::Wedge | Outline::Octagon)
    }

    fn point(&self, [x, y]: [i64; 2], height: i64) -> Whole {
        let mut p = [height; 3];
        (p[(self.axis + 1) % 3], p[(self.axis + 2) % 3]) = (x, y);
        p
    }

    /// Returns the vertices, the lower ones first.
    pub(super) fn corners(&self) -> Vec<Whole> {
        let layer = |h: i64| self.outline.iter().map(move |p| self.point(*p, h));
        layer(self.low).chain(layer(self.high)).collect()
    }

    /// Returns the cells whose union is the prism.
    pub(super) fn cells(&self) -> Vec<Cell> {
        let cell = |t: &[usize; 3]| {
            let [a, b, c] = t.map(|k| self.outline[k]);
            let layer = |h: i64| [a, b, c].map(|p| self.point(p, h));
            let ([p, q, r], [s, t, u]) = (layer(self.low), layer(self.high));
            [p, q, r, s, t, u]
        };
        ears(&self.outline, 0).iter().map(cell).collect()
    }

    /// Returns the surface with randomly cut faces; each triangle is split into four `halvings`
    /// times.
    pub(super) fn surface(&self, rng: &mut Rng, halvings: usize) -> WholeSoup {
        let n = self.outline.len();
        let mut triangles = Vec::new();
        for [i, j, k] in ears(&self.outline, rng.below(n)) {
            triangles.push([i, k, j]);
        }
        for [i, j, k] in ears(&self.outline, rng.below(n)) {
            triangles.push([i + n, j + n, k + n]);
        }
        for i in 0..n {
            let j = (i + 1) % n;
            if rng.chance(0.5) {
                triangles.extend([[i, j, j + n], [i, j + n, i + n]]);
            } else {
                triangles.extend([[i, j, i + n], [j, j + n, i + n]]);
            }
        }
        let mut soup = WholeSoup {
            points: self.corners(),
            triangles,
        };
        (0..halvings).for_each(|_| soup.halve());
        let count = soup.triangles.len();
        for k in (1..count).rev() {
            soup.triangles.swap(k, rng.below(k + 1));
            soup.triangles[k].rotate_left(rng.below(3));
        }
        soup
    }
}

/// Triangles in whole coordinates.
#[derive(Clone, Debug)]
pub(super) struct WholeSoup {
    points: Vec<Whole>,
    triangles: Vec<[usize; 3]>,
}

impl WholeSoup {
    /// Splits every triangle into four.
    fn halve(&mut self) {
        let mut middles = HashMap::new();
        let points = &mut self.points;
        let mut middle = |i: usize, j: usize| {
            *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                let (p, q) = (points[i], points[j]);
                points.push([0, 1, 2].map(|k| (p[k] + q[k]) / 2));
                points.len() - 1
            })
        };
        let four = |&[a, b, c]: &[usize; 3]| {
            let [p, q, r] = [middle(a, b), middle(b, c), middle(c, a)];
            [[a, p, r], [p, b, q], [r, q, c], [p, q, r]]
        };
        self.triangles = self.triangles.iter().flat_map(four).collect();
    }

    pub(super) fn placed(&self, place: impl Fn(Whole) -> Point) -> Soup {
        Soup::new(
            self.points.iter().map(|p| place(*p)).collect(),
            self.triangles.iter().map(|t| t.map(|v| v as u32)).collect(),
        )
    }
}
