//! The naive exact oracle of overlaps: the volume that two closed meshes share, over the rationals.
//!
//! The winding number of a closed mesh is a sum of signed tetrahedra between a point and each
//! triangle. So the shared volume is a sum over all pairs of such tetrahedra, each cut by the four
//! planes of the other. There are no ties and no shift.

use dashu_ratio::RBig;

use crate::rational::placed;
use crate::{Face, Point, Pose};

type Place = [RBig; 3];
type Tetrahedron = [Place; 4];

/// A closed mesh at exact places.
#[derive(Clone, Debug)]
pub struct Exact {
    /// The points.
    pub points: Vec<Place>,
    /// Indices of three points each.
    pub triangles: Vec<[u32; 3]>,
}

impl Exact {
    /// Returns a mesh of triangles at a pose.
    pub fn at(points: &[Point], triangles: &[Face], pose: &Pose) -> Self {
        Self {
            points: placed(points, pose),
            triangles: triangles.iter().map(|t| [t[0], t[1], t[2]]).collect(),
        }
    }
}

fn sub(a: &Place, b: &Place) -> Place {
    [&a[0] - &b[0], &a[1] - &b[1], &a[2] - &b[2]]
}

fn cross(a: &Place, b: &Place) -> Place {
    let component = |i: usize, j: usize| &a[i] * &b[j] - &a[j] * &b[i];
    [component(1, 2), component(2, 0), component(0, 1)]
}

fn dot(a: &Place, b: &Place) -> RBig {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

fn six([a, b, c, d]: &Tetrahedron) -> RBig {
    dot(&sub(b, a), &cross(&sub(c, a), &sub(d, a)))
}

/// Returns the volume of a closed mesh and its first moments, each point counted by its winding
/// number.
#[must_use]
pub fn whole(mesh: &Exact) -> (RBig, Place) {
    let origin = [RBig::ZERO, RBig::ZERO, RBig::ZERO];
    let (mut volume, mut moment) = (RBig::ZERO, origin.clone());
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|v| mesh.points[v as usize].clone());
        let own = six(&[origin.clone(), a.clone(), b.clone(), c.clone()]);
        for k in 0..3 {
            moment[k] += (&a[k] + &b[k] + &c[k]) * &own;
        }
        volume += own;
    }
    (volume / RBig::from(6), moment.map(|m| m / RBig::from(24)))
}

/// The half-space `n . x <= level`.
struct Half {
    n: Place,
    level: RBig,
}

/// A tetrahedron of a mesh, with its sign.
struct Signed {
    sign: RBig,
    corners: Tetrahedron,
    halves: Vec<Half>,
    low: Place,
    high: Place,
}

impl Signed {
    /// Returns the tetrahedra of a mesh that have a volume.
    fn all(mesh: &Exact) -> Vec<Self> {
        let count = RBig::from(mesh.points.len());
        let zero = || [RBig::ZERO, RBig::ZERO, RBig::ZERO];
        let sum = mesh.points.iter().fold(zero(), |s, p| [0, 1, 2].map(|k| &s[k] + &p[k]));
        let middle = sum.map(|x| x / &count);
        let tetrahedron = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| mesh.points[v as usize].clone());
            Self::new([middle.clone(), a, b, c])
        };
        mesh.triangles.iter().filter_map(tetrahedron).collect()
    }

    fn new(corners: Tetrahedron) -> Option<Self> {
        let six = six(&corners);
        if six.is_zero() {
            return None;
        }
        let half = |k: usize| {
            let [a, b, c] = [1, 2, 3].map(|i| &corners[(k + i) % 4]);
            let n = cross(&sub(b, a), &sub(c, a));
            let level = dot(&n, a);
            if dot(&n, &corners[k]) > level {
                Half {
                    n: n.map(|x| -x),
                    level: -level,
                }
            } else {
                Half { n, level }
            }
        };
        let extreme = |is_better: fn(&RBig, &RBig) -> bool| {
            [0, 1, 2].map(|k| {
                let best = (1..4).fold(0, |best, i| {
                    if is_better(&corners[i][k], &corners[best][k]) {
                        i
                    } else {
                        best
                    }
                });
                corners[best][k].clone()
            })
        };
        Some(Self {
            sign: RBig::from(if six > RBig::ZERO { 1 } else { -1 }),
            halves: (0..4).map(half).collect(),
            low: extreme(|x, y| x < y),
            high: extreme(|x, y| x > y),
            corners,
        })
    }
}

/// Returns the point where a segment passes through a plane, given the heights of its ends.
fn mix(p: &Place, q: &Place, h: &RBig, l: &RBig) -> Place {
    let part = h / (h - l);
    [0, 1, 2].map(|k| &p[k] + &part * (&q[k] - &p[k]))
}

fn prism([a, b, c]: [Place; 3], [d, e, f]: [Place; 3]) -> [Tetrahedron; 3] {
    [
        [a.clone(), b.clone(), c, f.clone()],
        [a.clone(), b, e.clone(), f.clone()],
        [a, d, e, f],
    ]
}

/// Returns the parts of tetrahedra in a half-space.
fn cut(all: Vec<Tetrahedron>, half: &Half) -> Vec<Tetrahedron> {
    let mut left = Vec::new();
    for t in all {
        let heights = t.each_ref().map(|p| dot(&half.n, p) - &half.level);
        let (inner, outer): (Vec<usize>, Vec<usize>) = (0..4).partition(|k| heights[*k] <= RBig::ZERO);
        let on = |i: usize, j: usize| mix(&t[i], &t[j], &heights[i], &heights[j]);
        match (inner.as_slice(), outer.as_slice()) {
            (_, []) => left.push(t),
            (&[i], &[j, k, l]) => left.push([t[i].clone(), on(i, j), on(i, k), on(i, l)]),
            (&[i, j, k], &[l]) => {
                let own = [i, j, k].map(|m| t[m].clone());
                left.extend(prism(own, [i, j, k].map(|m| on(m, l))));
            }
            (&[i, j], &[k, l]) => left.extend(prism(
                [t[i].clone(), on(i, k), on(i, l)],
                [t[j].clone(), on(j, k), on(j, l)],
            )),
            _ => {}
        }
    }
    left.retain(|t| !six(t).is_zero());
    left
}

/// Returns the integral of the product of the winding numbers of two closed meshes, and its first
/// moments about the origin.
pub fn shared(a: &Exact, b: &Exact) -> (RBig, Place) {
    let (of_a, of_b) = (Signed::all(a), Signed::all(b));
    let (mut volume, mut moment) = (RBig::ZERO, [RBig::ZERO, RBig::ZERO, RBig::ZERO]);
    for s in &of_a {
        for t in &of_b {
            if (0..3).any(|k| s.low[k] >= t.high[k] || t.low[k] >= s.high[k]) {
                continue;
            }
            let mut parts = vec![s.corners.clone()];
            for half in &t.halves {
                parts = cut(parts, half);
            }
            for part in &parts {
                let own = six(part);
                let own = if own < RBig::ZERO { -own } else { own } * &s.sign * &t.sign;
                for k in 0..3 {
                    moment[k] += &own * (&part[0][k] + &part[1][k] + &part[2][k] + &part[3][k]);
                }
                volume += own;
            }
        }
    }
    (volume / RBig::from(6), moment.map(|m| m / RBig::from(24)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rational::exact;
    use crate::shapes;

    #[test]
    fn boxes_share_the_product_of_their_common_sides() {
        let cube = shapes::cuboid([0.5; 3]);
        let faces: Vec<Face> = cube.triangles().iter().map(|t| t.to_vec()).collect();
        let at = |x: f64| Exact::at(&cube.points, &faces, &Pose::shift([x; 3]));
        let (volume, moment) = shared(&at(0.5), &at(1.0));
        assert_eq!(volume, exact(0.125));
        assert_eq!(moment[0], exact(0.75 * 0.125));
        assert_eq!(whole(&at(0.5)), (exact(1.0), [exact(0.5), exact(0.5), exact(0.5)]));
    }
}
