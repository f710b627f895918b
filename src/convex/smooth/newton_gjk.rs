//! Main solver: GJK whose direction step uses the curvature.
//!
//! From a unit direction, [`model`](super::model) gives the next direction. Without curvature this
//! is the step of GJK; with one smooth branch per core it is Newton's method on the normal. The
//! support points at the next direction serve both the next step and the certificate.

use super::best_bounds::{BranchSet, ProvenBounds};
use super::depth;
use super::flat_round_faces::{self, Flush};
use super::model::{MOST, ModelPlane, top};
use super::posed::{DifferencePoint, PlaneStep, PosedCores, Toward, add, tangent, unit};
use crate::base::num::scalar::{Scalar, Vec3, dot, root};
use crate::base::tolerance::{AGREE_CURVED, UNIT};
use crate::body::shape::Support;

/// Largest number of directions of a run: a heuristic.
const STEPS: u32 = 24;

/// Largest number of cuts of a step, to a third each, before the run ends: a heuristic.
const CUTS: u32 = 6;

/// The axis of a flat round face is tried if the squared sine of its angle with the direction is
/// below this: a heuristic.
const NEAR_AXIS: f64 = 1.0 / 64.0;

/// A depth run ends after two steps whose squares are below this: such steps gain only rounding,
/// and the second step knows the branches that the first one found. A heuristic.
const SETTLED: f64 = 4.0 * UNIT * UNIT;

/// End of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum RunEnd {
    /// The bounds agree.
    Closed,
    /// The cores seem to overlap: the best direction is close to a local minimum of the depth.
    Inside,
    /// The bounds do not agree.
    Open,
}

/// Returns whether two points lie behind each other, from the component along the direction and the
/// length of the vector between them.
#[inline(always)]
pub(super) fn far_behind<T: Scalar>(along: &T, length: &T) -> bool {
    *along < T::from(0.0) && *along < *length * T::from(-0.98)
}

/// A direction and the branch pairs known there.
#[derive(Clone, Copy)]
struct Centre<T> {
    toward: Toward<T>,
    height: T,
    pieces: [DifferencePoint<T>; MOST],
    len: usize,
    weights: [T; MOST],
}

impl<T: Scalar> Centre<T> {
    fn pieces(&self) -> &[DifferencePoint<T>] {
        &self.pieces[..self.len]
    }

    fn knows(&self, of: [u32; 2]) -> bool {
        self.pieces().iter().any(|p| p.of == of)
    }

    /// Adds a branch pair without weight. If there is no room, it replaces another pair without
    /// weight.
    fn add(&mut self, piece: DifferencePoint<T>) {
        let zero = T::from(0.0);
        if self.len < MOST {
            self.weights[self.len] = zero;
            self.pieces[self.len] = piece;
            self.len += 1;
        } else if let Some(k) = (0..MOST).find(|&k| !(self.weights[k] > zero)) {
            self.pieces[k] = piece;
        }
    }

    /// Returns the weighted sum of the branch pairs.
    fn between(&self) -> Vec3<T> {
        let mut v = [T::from(0.0); 3];
        for (piece, &weight) in self.pieces().iter().zip(&self.weights) {
            for k in 0..3 {
                v[k] = v[k] + piece.w[k] * weight;
            }
        }
        v
    }
}

/// One run, from a direction and the branches expected there.
pub(super) struct SolverRun<'r, 'p, A, B, T> {
    pub(super) posed: &'r PosedCores<'p, A, B, T>,
    pub(super) best: &'r mut ProvenBounds<T>,
    /// Whether the run searches the depth of cores that overlap.
    pub(super) deep: bool,
}

impl<A: Support, B: Support, T: Scalar> SolverRun<'_, '_, A, B, T> {
    /// Runs until the bounds agree.
    // Not inlined: one copy for each pair of kinds.
    #[inline(never)]
    pub(super) fn run(&mut self, n: Vec3<T>, set: &BranchSet) -> RunEnd {
        let mut centre = self.evaluate(n, set.branches(), [0; 2]);
        let share = T::from(1.0) / T::from(centre.len as f64);
        centre.weights = [share; MOST];
        let (mut flush, mut kept_back, mut was_small) = (Flush::new(), None, false);
        let slack = T::from(AGREE_CURVED / 4.0 * self.posed.size);
        let last = self.best.evaluations + STEPS;
        while self.best.evaluations < last {
            let Some(step) = self.advance(&mut centre) else {
                return RunEnd::Open;
            };
            if self.best.closes(self.posed) {
                return RunEnd::Closed;
            }
            if self.deep {
                depth::take_balls(self.posed, &centre.toward, centre.pieces(), &centre.weights, self.best);
                let is_small = (step[0] * step[0] + step[1] * step[1]).value() < SETTLED;
                if is_small && was_small {
                    return RunEnd::Open;
                }
                was_small = is_small;
            } else if self.seems_inside(&centre, &step) {
                return RunEnd::Inside;
            }
            if !self.deep
                && let Some(piece) =
                    flat_round_faces::near(self.posed, self.best, &centre.toward, &step, &mut flush, NEAR_AXIS)
            {
                if self.best.closes(self.posed) {
                    return RunEnd::Closed;
                }
                if let Some(n) = unit(&piece.w) {
                    // Next to the face: continue from the direction of the nearest point.
                    centre = self.evaluate(n, &[piece.of], piece.of);
                    let share = T::from(1.0) / T::from(centre.len as f64);
                    (centre.weights, kept_back) = ([share; MOST], None);
                    continue;
                }
            }
            let Some(trial) = self.follow(&mut centre, &step, slack, &mut kept_back) else {
                return RunEnd::Open;
            };
            centre = trial;
        }
        RunEnd::Open
    }

    /// Computes both support points along `n`, and the points of the branches expected there.
    fn evaluate(&mut self, n: Vec3<T>, of: &[[u32; 2]], hint: [u32; 2]) -> Centre<T> {
        let toward = self.posed.toward(n);
        let hint = of.first().copied().unwrap_or(hint);
        let new = self.posed.support(&toward, hint);
        let mut centre = Centre {
            toward,
            height: self.best.prove(&toward, &new),
            pieces: [new; MOST],
            len: 1,
            weights: [T::from(0.0); MOST],
        };
        for &of in of.iter().filter(|&&of| of != new.of) {
            let piece = self.posed.of_branches(of, &toward, centre.pieces());
            centre.add(piece);
        }
        centre
    }

    /// Returns the step of the model at the centre. The weighted points, both unmoved and moved
    /// along their surfaces by the step, update the upper bound.
    fn advance(&mut self, centre: &mut Centre<T>) -> Option<PlaneStep<T>> {
        let (toward, mut planes) = (centre.toward, [ModelPlane::default(); MOST]);
        for (plane, piece) in planes.iter_mut().zip(centre.pieces()) {
            let [d, e] = &toward.tangents;
            *plane = ModelPlane {
                c: dot(&toward.n, &piece.w),
                g: [dot(d, &piece.w), dot(e, &piece.w)],
                bend: self.posed.bend(piece, &toward),
            };
        }
        let v = centre.between();
        let half = root(dot(&v, &v)) * T::from(0.5);
        let mu = if self.deep || centre.height > half {
            centre.height
        } else {
            half
        };
        let planes = &planes[..centre.len];
        // If the height is negative, the model is concave only if the bend outweighs the height.
        let top = top(planes, &centre.weights, mu).or_else(|| top(planes, &centre.weights, half))?;
        centre.weights = top.weights;
        let weighted = centre.pieces.into_iter().zip(centre.weights);
        let kept = weighted.filter(|(_, weight)| *weight > T::from(0.0));
        if !self.deep {
            self.best.mixture(self.posed, centre.pieces(), &centre.weights);
        }
        let size = top.step[0].value() * top.step[0].value() + top.step[1].value() * top.step[1].value();
        if !self.deep && size < 0.0625 && !self.best.closes(self.posed) {
            let mut slid = [DifferencePoint::default(); MOST];
            let mut len = 0;
            for (piece, _) in kept {
                slid[len] = self.posed.slid(&piece, &toward, &top.step);
                len += 1;
            }
            self.best.nearest(self.posed, &slid[..len]);
        }
        Some(top.step)
    }

    /// Returns whether the closest points of the branch pairs lie behind each other along the
    /// direction.
    fn seems_inside(&self, centre: &Centre<T>, step: &PlaneStep<T>) -> bool {
        let far = (step[0] * step[0] + step[1] * step[1]).value() > 0.0625;
        if far || centre.height > T::from(0.0) {
            return false;
        }
        let v = centre.between();
        far_behind(&dot(&v, &centre.toward.n), &root(dot(&v, &v)))
    }

    /// Makes the step if the height does not fall. If it falls, a new branch pair is added, or a
    /// curved kink is followed for one more step; any other step is cut.
    fn follow(
        &mut self,
        centre: &mut Centre<T>,
        step: &PlaneStep<T>,
        slack: T,
        kept_back: &mut Option<(Centre<T>, PlaneStep<T>)>,
    ) -> Option<Centre<T>> {
        let (mut of, mut len) = ([[0; 2]; MOST], 0);
        for (piece, weight) in centre.pieces().iter().zip(&centre.weights) {
            if *weight > T::from(0.0) {
                of[len] = piece.of;
                len += 1;
            }
        }
        let mut step = *step;
        let floor = match kept_back {
            Some((before, _)) if before.height > centre.height => before.height,
            _ => centre.height,
        };
        for _ in 0..CUTS {
            let n = unit(&add(&centre.toward.n, &tangent(&centre.toward, &step)))?;
            let mut trial = self.evaluate(n, &of[..len], of[0]);
            self.carry(centre, &mut trial);
            let rises = trial.height >= floor - slack;
            if rises {
                *kept_back = None;
                return Some(trial);
            }
            let new = trial.pieces[0].of;
            if !centre.knows(new) {
                // The model did not contain this branch pair: solve again with it.
                let piece = self.posed.of_branches(new, &centre.toward, centre.pieces());
                centre.add(piece);
                return Some(*centre);
            }
            match kept_back.take() {
                // Along a curved kink the height falls by the square of the step, and rises in the
                // next step (Maratos effect).
                None if len > 1 => {
                    *kept_back = Some((*centre, step));
                    return Some(trial);
                }
                Some((before, first)) if before.height > trial.height => {
                    (*centre, step) = (before, first);
                    len = 0;
                    for (piece, weight) in centre.pieces().iter().zip(&centre.weights) {
                        if *weight > T::from(0.0) {
                            of[len] = piece.of;
                            len += 1;
                        }
                    }
                }
                _ => {}
            }
            let third = T::from(1.0 / 3.0);
            step = [step[0] * third, step[1] * third];
            if !(step[0].value().abs() + step[1].value().abs() > UNIT * UNIT) {
                return None;
            }
        }
        None
    }

    /// Copies the weights of branch pairs that both centres contain.
    fn carry(&self, from: &Centre<T>, to: &mut Centre<T>) {
        let mut any = false;
        for k in 0..to.len {
            let same = from.pieces().iter().position(|p| p.of == to.pieces[k].of);
            to.weights[k] = same.map_or(T::from(0.0), |j| from.weights[j]);
            any |= to.weights[k] > T::from(0.0);
        }
        if !any {
            to.weights[0] = T::from(1.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::base::num::scalar::neg;
    use crate::body::shape::{Core, Shape};
    use crate::convex::smooth::cores::PolyhedralCore;
    use crate::pair::transform::Transform;
    use crate::rng::Rng;

    fn direction(rng: &mut Rng) -> Vec3<f64> {
        let n = Vector3::from([(); 3].map(|()| rng.range(-1.0, 1.0)));
        (n / n.norm()).into()
    }

    /// Runs from random directions on separated cores, and compares the bounds with heights along
    /// other directions and distances of other points. Returns the share of runs whose bounds
    /// agree.
    fn share_closed(a: &impl Support, b: &impl Support) -> f64 {
        let (mut rng, mut closed) = (Rng::new(11), 0);
        for _ in 0..500 {
            let turn = nalgebra::UnitQuaternion::from_euler_angles(
                rng.range(-3.0, 3.0),
                rng.range(-1.5, 1.5),
                rng.range(-3.0, 3.0),
            );
            let matrix = turn.to_rotation_matrix().into_inner();
            let away = Vector3::from(direction(&mut rng)) * rng.range(2.6, 4.0);
            let frame = Transform {
                matrix: [0, 1, 2].map(|r| [0, 1, 2].map(|c| matrix[(r, c)])),
                translation: away.into(),
            };
            let size = a.reach() + b.reach() + away.norm();
            let posed = PosedCores { a, b, frame, size };
            let mut best = ProvenBounds::new();
            let toward = posed.toward(direction(&mut rng));
            let mut set = BranchSet::default();
            set.add(posed.support(&toward, [0; 2]).of);
            let deep = false;
            let ended = SolverRun {
                posed: &posed,
                best: &mut best,
                deep,
            }
            .run(toward.n, &set);
            let slack = 1e-12 * size;
            assert!(best.lower <= best.upper + slack, "{} {}", best.lower, best.upper);
            if ended == RunEnd::Closed {
                closed += 1;
                assert!(best.closes(&posed), "{} {}", best.lower, best.upper);
            }
            for _ in 0..20 {
                let piece = posed.support(&posed.toward(direction(&mut rng)), [0; 2]);
                assert!(
                    dot(&piece.w, &piece.w).sqrt() >= best.lower - slack,
                    "two points nearer than the bound"
                );
                let toward = posed.toward(direction(&mut rng));
                let height = dot(&toward.n, &posed.support(&toward, [0; 2]).w);
                assert!(height <= best.upper + slack, "a plane between farther than the bound");
            }
            let joined = sub_points(&posed.at(&best.on_b), &best.on_a);
            assert!((dot(&joined, &joined).sqrt() - best.upper).abs() <= slack || best.upper.is_infinite());
        }
        f64::from(closed) / 500.0
    }

    fn sub_points(p: &Vec3<f64>, q: &Vec3<f64>) -> Vec3<f64> {
        add(p, &neg(q))
    }

    #[test]
    fn bounds_of_a_run_hold_and_mostly_agree() {
        let axes = Vector3::new(1.0, 0.7, 0.4);
        let shapes = [
            Shape::ellipsoid(axes),
            Shape::cylinder(0.8, 0.6),
            Shape::cone(0.8, 0.6),
            Shape::cuboid(Vector3::new(0.5, 0.7, 0.9)),
        ]
        .map(|shape| shape.unwrap().core().clone());
        let [
            Core::Ellipsoid(ellipsoid),
            Core::Cylinder(cylinder),
            Core::Cone(cone),
            Core::Polyhedron(body),
        ] = &shapes
        else {
            panic!("cores of other kinds");
        };
        let hull = PolyhedralCore {
            body,
            unit: body.unit(),
        };
        let shares = [
            share_closed(ellipsoid, ellipsoid),
            share_closed(&hull, ellipsoid),
            share_closed(cylinder, cone),
            share_closed(&hull, cone),
        ];
        assert!(shares.iter().all(|share| *share > 0.8), "{shares:?}");
    }
}
