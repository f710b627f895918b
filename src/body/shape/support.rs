//! Support points of shapes and their derivatives by the direction, for the solvers; and the
//! interface of a curved core.

use crate::base::num::each::Each;
use crate::base::num::extremes::Bounded;
use crate::base::num::fingerprint::Fingerprint;
use crate::base::num::scalar::{Scalar, Vec3, root};
use crate::body::polyhedron::Feature;
use crate::body::shape::Mass;
use nalgebra::Vector3;

/// A flat round face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Disc {
    /// The centre is at `(0, 0, z)`; the outward normal is along z, with the sign of `side`.
    pub(crate) z: f64,
    pub(crate) side: f64,
    pub(crate) radius: f64,
}

impl Disc {
    /// Returns the point of the disc nearest to a given point.
    pub(crate) fn foot<T: Scalar>(&self, place: &Vec3<T>) -> Vec3<T> {
        let off = root(place[0] * place[0] + place[1] * place[1]);
        let r = T::from(self.radius);
        let s = if off > r { r / off } else { T::from(1.0) };
        [place[0] * s, place[1] * s, T::from(self.z)]
    }
}

/// A flat or straight facet of a surface.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Flat {
    Disc(Disc),
    /// A generator of a curved side, by both ends.
    Line([Vector3<f64>; 2]),
}

impl Flat {
    /// Returns the middle of the facet.
    pub(crate) fn middle(&self) -> Vec3<f64> {
        match self {
            Self::Disc(disc) => [0.0, 0.0, disc.z],
            Self::Line([p, q]) => ((p + q) * 0.5).into(),
        }
    }

    /// Returns the point of the facet nearest to a given point.
    pub(crate) fn foot(&self, place: &Vec3<f64>) -> Vec3<f64> {
        match self {
            Self::Disc(disc) => disc.foot(place),
            Self::Line([p, q]) => {
                let u = q - p;
                let t = u.dot(&(Vector3::from(*place) - p)) / u.norm_squared();
                (p + u * t.clamped(0.0, 1.0)).into()
            }
        }
    }
}

/// A convex core by its support function `h(n) = max of n . x`, over branches.
///
/// A *branch* is a domain in which the map from a direction to its support point is smooth: a
/// vertex, a rim, a whole ellipsoid. Directions are unit vectors in the frame of the core. Solvers
/// run in f64 and in double-double.
pub(crate) trait Support {
    /// Whether the core has only one branch.
    const IS_SMOOTH: bool = false;

    /// Returns the largest distance of a point of the core from the origin, rounded up.
    fn reach(&self) -> f64;

    /// Returns branch and support point along `n`, a direction of any length; the search starts at
    /// the branch `hint`.
    fn support<T: Scalar>(&self, n: &Vec3<T>, hint: u32) -> (u32, Vec3<T>);

    /// Returns the point of a branch along `n`. It is a point of the core, and it is the support
    /// point if the branch has the greatest support value along `n`.
    fn of_branch<T: Scalar>(&self, branch: u32, n: &Vec3<T>) -> Vec3<T>;

    /// Returns the displacement of the `point` of a branch along `n` if `n` rotates by the tangent
    /// `d`: the second derivative of the support function, applied to `d`.
    fn bent<T: Scalar>(&self, branch: u32, point: &Vec3<T>, n: &Vec3<T>, d: &Vec3<T>) -> Vec3<T>;

    /// Returns the unit axis `u` and the level `c` of the circle of unit directions, `n . u = c`,
    /// along which two branches have equal support values; `None` if no circle is known.
    fn ridge<T: Scalar>(&self, of: [u32; 2]) -> Option<(Vec3<T>, T)>;

    /// Returns a point of the core on the branch, close to the point `place`, which must be close
    /// to the branch.
    fn onto<T: Scalar>(&self, branch: u32, place: &Vec3<T>) -> Vec3<T>;

    /// Returns centre and radius of a ball inside the core that touches the surface, or almost, at
    /// `point`, where the normal is `n`. The radius is never too large; it is zero if no ball is
    /// known.
    fn inner_ball(&self, point: &Vector3<f64>, n: &Vector3<f64>) -> (Vector3<f64>, f64);

    /// Returns the flat round face whose normal is closest to `n`; `None` if the core has none.
    fn disc(&self, n: &Vector3<f64>) -> Option<Disc>;

    /// Returns the outward unit normals of the edges of the polygon that generates the core by
    /// rotation around the z axis, as components perpendicular to the axis and along it. `None` if
    /// no polygon does.
    fn meridian(&self) -> Option<[[f64; 2]; 3]> {
        None
    }

    /// Calls `each` with the outward normals of the flat faces to which a branch belongs.
    fn flat_faces(&self, _branch: u32, each: &mut impl FnMut(Vec3<f64>)) {
        let sides = [1.0, -1.0].each(|z| self.disc(&Vector3::new(0.0, 0.0, z)));
        sides.iter().flatten().for_each(|disc| each([0.0, 0.0, disc.side]));
    }

    /// Returns the flat or straight facet of the surface whose normal is closest to `n`. `None` if
    /// the core is curved in both directions, or a polyhedron.
    fn flat(&self, n: &Vector3<f64>) -> Option<Flat> {
        self.disc(n).map(Flat::Disc)
    }

    /// Returns the feature that contains the points of up to three branches, `point` among them.
    fn feature(&self, branches: &[u32], point: &Vector3<f64>) -> Feature;
}

/// A core with curved sides: the calls of a shape in addition to support points.
pub(crate) trait Curved: Support + Copy {
    /// Returns the fingerprint of kind and parameters.
    fn fingerprint(&self) -> Fingerprint;

    /// Returns the core with all lengths multiplied by a power of two.
    fn scaled(&self, by: f64) -> Self;

    /// Returns whether the closed core contains a point, up to rounding.
    fn contains(&self, point: &Vector3<f64>) -> bool;

    /// Returns the mass properties at unit density.
    fn mass(&self) -> Mass;

    /// Returns the core whose box has these half lengths, for tests of all kinds. A body of
    /// revolution takes x and z.
    #[cfg(any(test, feature = "__internals"))]
    fn of_half_lengths(half: Vector3<f64>) -> Self;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::num::double_double::DoubleDouble;
    use crate::base::num::scalar::{dot, sub};
    use crate::base::tolerance::UNIT;
    use crate::body::shape::with_curved_kinds;
    use crate::rng::Rng;

    fn unit(rng: &mut Rng) -> Vec3<f64> {
        let n = Vector3::from([(); 3].map(|()| rng.range(-1.0, 1.0)));
        (n / n.norm()).into()
    }

    fn length(v: &Vec3<f64>) -> f64 {
        dot(v, v).sqrt()
    }

    fn height<T: Scalar>(core: &impl Support, n: &Vec3<f64>) -> T {
        let n = n.map(T::from);
        dot(&n, &core.support(&n, 0).1)
    }

    /// Checks what solvers assume about a core of any size.
    fn check(core: &impl Curved) {
        let mut rng = Rng::new(7);
        let reach = core.reach();
        for _ in 0..2_000 {
            let (n, m) = (unit(&mut rng), unit(&mut rng));
            let (branch, point) = core.support(&n, 0);
            let slack = 1e-12 * reach;
            assert!(length(&point) <= reach + slack, "reach");
            // `nonconvex::pieces` and `nonconvex::penetration` take the origin for a point inside.
            assert!(dot(&n, &point) > 0.0, "origin");
            let at = Vector3::from(point);
            assert!(core.contains(&(at * 0.999)), "{at} is inside");
            assert!(
                !core.contains(&(at + Vector3::from(n) * (1e-3 * reach))),
                "{at} is outside"
            );
            let other = core.support(&m, branch).1;
            assert!(
                dot(&n, &other) <= dot(&n, &point) + slack,
                "the support point is the highest"
            );
            let onto = core.onto(branch, &point);
            assert!(length(&sub(&onto, &point)) <= 1e-7 * reach, "onto");

            // `CERTIFICATE` leaves so much for a height.
            let off = height::<DoubleDouble>(core, &n) - DoubleDouble::from(height::<f64>(core, &n));
            assert!(off.hi.abs() <= 16.0 * UNIT * reach, "height: {off:?}");

            // A ball inside the core at the point: its support value is at most that of the core
            // along every direction. `INNER` leaves so much for its error.
            check_ball(core, &at, &n.into(), &m.into());
            // In the middle of a flat part the ball is large.
            let outward = Vector3::from(n);
            if let Some(flat) = core.flat(&outward) {
                let normal = match flat {
                    Flat::Disc(disc) => Vector3::new(0.0, 0.0, disc.side),
                    Flat::Line([p, q]) => {
                        let along = (q - p).normalize();
                        (outward - along * along.dot(&outward)).normalize()
                    }
                };
                let near = (normal + 0.1 * Vector3::from(m)).normalize();
                check_ball(core, &flat.middle().into(), &normal, &near);
                check_ball(core, &flat.middle().into(), &normal, &m.into());
            }
        }
        check_flat(core);
        check_mass(core);
    }

    /// Checks a ball inside that touches the surface at a point with a normal, along a direction.
    fn check_ball(core: &impl Support, point: &Vector3<f64>, n: &Vector3<f64>, m: &Vector3<f64>) {
        let (centre, radius) = core.inner_ball(point, n);
        let highest = height::<DoubleDouble>(core, &(*m).into()).hi;
        let ball = m.dot(&centre) + radius;
        assert!(
            ball <= highest + 64.0 * UNIT * core.reach(),
            "inner ball at {point} along {m}: {ball} over {highest}"
        );
    }

    /// Checks volume and centroid against points of a box that are inside, to some percent.
    fn check_mass(core: &impl Curved) {
        let (mut rng, count) = (Rng::new(10), 40_000);
        let half = Vector3::from([0, 1, 2].map(|k| {
            let axis = Vector3::ith(k, 1.0);
            height::<f64>(core, &axis.into()).max(height::<f64>(core, &(-axis).into()))
        }));
        let (mut inside, mut sum) = (0, Vector3::zeros());
        for _ in 0..count {
            let p = half.map(|h| rng.range(-h, h));
            if core.contains(&p) {
                inside += 1;
                sum += p;
            }
        }
        let volume = 8.0 * half.product() * f64::from(inside) / f64::from(count);
        let mass = core.mass();
        assert!(
            (mass.volume - volume).abs() <= 0.05 * volume,
            "{} is not {volume}",
            mass.volume
        );
        let off = (mass.centroid.coords - sum / f64::from(inside)).component_div(&half);
        assert!(off.amax() <= 0.03, "centroid {} is off by {off}", mass.centroid);
    }

    /// Checks that discs are faces, and that where the support point jumps there is a flat part
    /// with both points.
    fn check_flat(core: &impl Curved) {
        let (mut rng, reach) = (Rng::new(8), core.reach());
        let axes = [0, 1, 2].map(|k| Vector3::ith(k, 1.0));
        for k in 0..200 {
            // A circle through an axis, or any other.
            let from = unit(&mut rng);
            let to = if k % 2 == 0 {
                let axis = axes[k / 2 % 3];
                (2.0 * axis.dot(&Vector3::from(from)) * axis - Vector3::from(from)).into()
            } else {
                unit(&mut rng)
            };
            let along = |t: f64| {
                let n = Vector3::from(from) * (1.0 - t) + Vector3::from(to) * t;
                core.support(&n.normalize().into(), 0).1
            };
            let (mut low, mut high) = (0.0, 1.0);
            let jump = |low: f64, high: f64| length(&sub(&along(low), &along(high)));
            while high - low > 1e-13 {
                let middle = 0.5 * (low + high);
                if jump(low, middle) > jump(middle, high) {
                    high = middle;
                } else {
                    low = middle;
                }
            }
            if jump(low, high) < 1e-3 * reach {
                continue;
            }
            let n = Vector3::from(from) * (1.0 - low) + Vector3::from(to) * low;
            let flat = core
                .flat(&n.normalize())
                .expect("a flat part where the support point jumps");
            for end in [along(low), along(high)] {
                let off = length(&sub(&flat.foot(&end), &end));
                assert!(off <= 1e-6 * reach, "the flat part at {n:?} misses {end:?} by {off}");
            }
        }
        for side in [-1.0, 1.0] {
            let Some(disc) = core.disc(&Vector3::new(0.0, 0.0, side)) else {
                continue;
            };
            for k in 0..16 {
                let (sin, cos) = (f64::from(k) * 0.4).sin_cos();
                let n = [1e-9 * cos, 1e-9 * sin, disc.side];
                let expected = [disc.radius * cos, disc.radius * sin, disc.z];
                let off = length(&sub(&core.support(&n, 0).1, &expected));
                assert!(off <= 1e-6 * reach, "{disc:?} is no face");
            }
        }
    }

    /// Checks the second derivative against a difference quotient, away from poles, for a core that
    /// is neither long nor flat.
    fn check_bent(core: &impl Support) {
        let mut rng = Rng::new(9);
        for _ in 0..2_000 {
            let (n, m) = (unit(&mut rng), unit(&mut rng));
            let (branch, point) = core.support(&n, 0);
            let d = sub(&m, &n.map(|x| x * dot(&n, &m)));
            let step = 1e-6;
            let turned = [0, 1, 2].map(|k| n[k] + step * d[k]);
            let back = [0, 1, 2].map(|k| n[k] - step * d[k]);
            let slope = sub(&core.of_branch(branch, &turned), &core.of_branch(branch, &back)).map(|x| x / (2.0 * step));
            let bent = core.bent(branch, &point, &n, &d);
            let off = length(&sub(&slope, &bent));
            let is_mild = n.iter().all(|x| x.abs() > 0.05);
            assert!(
                !is_mild || off <= 1e-4 * (core.reach() + length(&bent)),
                "{n:?}: {slope:?}, not {bent:?}"
            );
        }
    }

    /// Half lengths of cores: the first is neither long nor flat.
    const SIZES: [[f64; 3]; 3] = [[0.7, 0.6, 1.3], [0.01, 0.02, 100.0], [2.0, 3.0, 0.003]];

    macro_rules! checked {
        ($($kind:ident),*) => {
            $(
                let cores = SIZES.map(|half| crate::body::shape::$kind::of_half_lengths(half.into()));
                cores.iter().for_each(check);
                check_bent(&cores[0]);
            )*
        };
    }

    #[test]
    fn curved_cores_are_what_solvers_take_them_for() {
        with_curved_kinds!(checked);
    }
}
