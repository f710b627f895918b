//! The judge: a subdivision of its own, in twice the digits of f64.
//!
//! The upper bound is judged by the points at the parameters returned. The lower bound by a search that
//! must prove every pair of parts at least so far apart, along the normal returned, or along the line of
//! the middles of both parts.

use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::patch::{Surface, SurfaceOutcome, SurfacePoint};

use lab::curved::{Triple, Wide, dot, matrix, norm, turned, wide};

type Homogeneous = [Wide; 4];

/// A patch given by its control points and weights, in A's frame.
#[derive(Clone)]
struct Part {
    degrees: [usize; 2],
    net: Vec<Homogeneous>,
}

/// What a judge saw.
#[derive(Debug, PartialEq)]
pub(crate) enum Sentence {
    Holds,
    /// The search was too long.
    Open,
}

fn half(a: &Homogeneous, b: &Homogeneous, t: Wide) -> Homogeneous {
    let s = Wide::from(1.0) - t;
    [0, 1, 2, 3].map(|k| a[k] * s + b[k] * t)
}

fn place(h: &Homogeneous) -> Triple {
    [0, 1, 2].map(|k| h[k] / h[3])
}

fn less(a: &Triple, b: &Triple) -> Triple {
    [0, 1, 2].map(|k| a[k] - b[k])
}

impl Part {
    /// The parts of a surface, placed; numbers are those of the surface.
    fn all(surface: &Surface, pose: &Isometry3<f64>) -> Vec<Self> {
        let c = pose.rotation.coords;
        let (rotation, t) = (matrix([c.x, c.y, c.z, c.w]), wide(pose.translation.vector.into()));
        let placed = |(p, w): (Point3<f64>, f64)| {
            let q = turned(&rotation, &wide(p.coords.into()));
            let w = Wide::from(w);
            [(q[0] + t[0]) * w, (q[1] + t[1]) * w, (q[2] + t[2]) * w, w]
        };
        let part = |p: &lin_canny::patch::Patch| Self {
            degrees: p.degrees(),
            net: p.control_points().map(placed).collect(),
        };
        surface.patches().iter().map(part).collect()
    }

    fn point(&self, at: &SurfacePoint) -> Triple {
        let [p, q] = self.degrees;
        let curve = |mut c: Vec<Homogeneous>, t: f64| {
            while c.len() > 1 {
                c = c.windows(2).map(|w| half(&w[0], &w[1], Wide::from(t))).collect();
            }
            c[0]
        };
        let rows = (0..=p).map(|i| curve(self.net[i * (q + 1)..][..=q].to_vec(), at.v));
        place(&curve(rows.collect(), at.u))
    }

    /// The halves by the direction in which the net is longer.
    fn halves(&self) -> [Self; 2] {
        let [p, q] = self.degrees;
        let at = |i: usize, j: usize| i * (q + 1) + j;
        let leg = |i: usize, j: usize| norm(&less(&place(&self.net[i]), &place(&self.net[j]))).0;
        let long_u = (0..=q)
            .map(|j| (0..p).map(|i| leg(at(i, j), at(i + 1, j))).sum::<f64>())
            .fold(0.0, f64::max);
        let long_v = (0..=p)
            .map(|i| (0..q).map(|j| leg(at(i, j), at(i, j + 1))).sum::<f64>())
            .fold(0.0, f64::max);
        let (mut low, mut high) = (self.clone(), self.clone());
        let mut line = |ids: Vec<usize>| {
            let mut c: Vec<Homogeneous> = ids.iter().map(|&k| self.net[k]).collect();
            for level in 0..ids.len() {
                low.net[ids[level]] = c[0];
                high.net[ids[ids.len() - 1 - level]] = c[c.len() - 1];
                c = c.windows(2).map(|w| half(&w[0], &w[1], Wide::from(0.5))).collect();
            }
        };
        if long_u >= long_v {
            (0..=q).for_each(|j| line((0..=p).map(|i| at(i, j)).collect()));
        } else {
            (0..=p).for_each(|i| line((0..=q).map(|j| at(i, j)).collect()));
        }
        [low, high]
    }

    fn points(&self) -> impl Iterator<Item = Triple> + '_ {
        self.net.iter().map(place)
    }

    fn middle_and_size(&self) -> ([f64; 3], f64) {
        let all: Vec<[f64; 3]> = self.points().map(|p| p.map(|x| x.0)).collect();
        let mean = [0, 1, 2].map(|k| all.iter().map(|p| p[k]).sum::<f64>() / all.len() as f64);
        let far = |p: &[f64; 3]| (Vector3::from(*p) - Vector3::from(mean)).norm();
        (mean, all.iter().map(far).fold(0.0, f64::max))
    }
}

/// The gap of two parts along a direction.
fn gap(a: &Part, b: &Part, n: &Triple) -> f64 {
    let low = b
        .points()
        .map(|p| dot(&p, n))
        .reduce(|m, x| if (x - m).0 < 0.0 { x } else { m });
    let high = a.points().map(|p| dot(&p, n)).reduce(Wide::max);
    low.zip(high)
        .map_or(f64::INFINITY, |(low, high)| ((low - high) / norm(n)).0)
}

/// Judges an outcome; panics if a bound is wrong by more than `slack`.
pub(crate) fn judge(a: &Surface, b: &Surface, pose: &Isometry3<f64>, o: &SurfaceOutcome, slack: f64) -> Sentence {
    let (parts_a, parts_b) = (Part::all(a, &Isometry3::identity()), Part::all(b, pose));
    let p = parts_a[o.on_a.patch as usize].point(&o.on_a);
    let q = parts_b[o.on_b.patch as usize].point(&o.on_b);
    let between = norm(&less(&q, &p)).0;
    assert!(between <= o.upper, "witnesses are {between:e} apart: {o:?}");
    if o.lower == 0.0 {
        return Sentence::Holds;
    }
    let goal = o.lower - slack;
    let normal = wide((*o.normal).into());
    let mut open: Vec<(Part, Part)> = Vec::new();
    parts_a
        .iter()
        .for_each(|x| open.extend(parts_b.iter().map(|y| (x.clone(), y.clone()))));
    let mut looks = 0;
    while let Some((x, y)) = open.pop() {
        looks += 1;
        if looks > 60_000 {
            return Sentence::Open;
        }
        let ((c, r), (d, s)) = (x.middle_and_size(), y.middle_and_size());
        let line = Vector3::from(d) - Vector3::from(c);
        if line.norm() - r - s > goal + 1e-9 || gap(&x, &y, &normal) >= goal || gap(&x, &y, &wide(line.into())) >= goal
        {
            continue;
        }
        let corner = |p: &Part| place(&p.net[0]);
        let apart = norm(&less(&corner(&x), &corner(&y))).0;
        assert!(apart >= goal, "two points are {apart:e} apart: {o:?}");
        if r >= s {
            let [low, high] = x.halves();
            open.extend([(low, y.clone()), (high, y)]);
        } else {
            let [low, high] = y.halves();
            open.extend([(x.clone(), low), (x, high)]);
        }
    }
    Sentence::Holds
}
