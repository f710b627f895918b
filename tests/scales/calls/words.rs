//! Content and results of a scene: lengths in its unit, and bodies, poses and motions of its size.

use super::{Scene, Word};
use lin_canny::impact::Impact;
use lin_canny::motion::Steady;
use lin_canny::nalgebra::{Isometry3, Point3, Quaternion, Translation3, UnitQuaternion, Vector3};
use lin_canny::{
    ContactPoint, ConvexPolyhedron, Decision, Distance, Manifold, Outcome, OverlapError, OverlapLoops, OverlapVolume,
    PenetrationBounds, RelativePose, Velocity,
};
use truth::rng::Rng;
use truth::shapes;
use truth::support::body;

impl Scene {
    pub(super) fn lengths(&mut self, what: &str, lengths: impl IntoIterator<Item = f64>) {
        let lengths: Vec<f64> = lengths.into_iter().map(|x| x / self.unit).collect();
        self.told.push(Word::Other(format!("{what} {lengths:?}")));
    }

    pub(super) fn bounds(&mut self, what: &'static str, lower: f64, upper: f64) {
        let bounds = [lower, upper].map(|x| x / self.unit);
        self.told.push(Word::Bounds(what, bounds));
    }

    pub(super) fn plain(&mut self, what: &str, value: impl std::fmt::Debug) {
        self.told.push(Word::Other(format!("{what} {value:?}")));
    }

    pub(super) fn decision(&mut self, what: &str, decision: Decision) {
        match decision {
            Decision::Undecided { lower, upper } => self.lengths(what, [lower, upper]),
            decided => self.plain(what, decided),
        }
    }

    pub(super) fn nearest(
        &mut self,
        what: &'static str,
        [lower, upper]: [f64; 2],
        distance: f64,
        witnesses: [&Point3<f64>; 2],
    ) {
        self.bounds(what, lower, upper);
        let points = witnesses.into_iter().flat_map(|p| p.iter().copied());
        self.lengths(what, [distance].into_iter().chain(points));
    }

    pub(super) fn distance(&mut self, what: &'static str, d: &Distance) {
        self.bounds(what, d.lower, d.upper);
        self.lengths(what, [d.value]);
    }

    pub(super) fn penetration(&mut self, found: Option<PenetrationBounds>) {
        if let Some(p) = found {
            self.bounds("penetration", p.lower, p.upper);
            self.lengths("penetration", p.shift.iter().copied());
        }
    }

    /// Tells a volume that is a normal number in all units.
    pub(super) fn overlap(&mut self, found: Result<OverlapVolume, OverlapError>) {
        let cubed = self.unit * self.unit * self.unit;
        match found {
            Ok(v) if v.lower > 1e-6 * cubed => {
                self.plain("overlap", (v.lower / cubed, v.upper / cubed, v.covers_itself));
                let centre = v.centroid.iter().flat_map(|p| p.iter().copied());
                self.lengths("centroid", centre.chain([v.centroid_error]));
            }
            Ok(v) => self.plain("overlap", v.upper > 1e-6 * cubed),
            Err(e) => self.plain("overlap", e),
        }
    }

    pub(super) fn loops(&mut self, found: Result<OverlapLoops, OverlapError>) {
        match found {
            Ok(found) => self.lengths("loops", found.loops.iter().flatten().flat_map(|p| p.iter().copied())),
            Err(e) => self.plain("loops", e),
        }
    }

    pub(super) fn contact(&mut self, what: &str, p: &ContactPoint) {
        let at = p.point_on_a.iter().chain(p.point_on_b.iter()).copied();
        self.lengths(what, at.chain([p.separation]));
        self.plain(what, (p.features, p.id));
    }

    pub(super) fn outcome(&mut self, what: &str, o: &Outcome) {
        self.nearest(
            "outcome",
            [o.lower, o.upper],
            o.distance,
            [&o.point_on_a, &o.point_on_b],
        );
        self.plain(what, (o.state, o.features, o.solver, o.normal));
    }

    pub(super) fn manifold(&mut self, what: &str, manifold: &Manifold) {
        manifold.points().iter().for_each(|p| self.contact(what, p));
        self.bounds("manifold", manifold.lower(), manifold.upper());
        self.plain(what, (manifold.normal(), manifold.features()));
    }

    pub(super) fn impact(&mut self, what: &str, impact: Impact) {
        match impact {
            Impact::AtStart { seen } => self.lengths(what, [seen.distance, seen.lower, seen.upper]),
            Impact::Hit { safe, hit, seen } => {
                self.bounds("time", safe * self.unit, hit * self.unit);
                self.plain(what, seen.state);
                self.lengths(what, [seen.distance, seen.lower, seen.upper]);
            }
            Impact::Undecided { safe, distance } => {
                self.bounds("time", safe * self.unit, f64::INFINITY);
                self.lengths(what, [distance]);
            }
            other => self.plain(what, other),
        }
    }

    pub(super) fn points(&self, points: &[[f64; 3]]) -> Vec<Point3<f64>> {
        points.iter().map(|&p| Point3::from(p) * self.unit).collect()
    }

    /// Returns a round body whose box has a half diagonal from 1 to 2, so that any two are stored
    /// in one unit.
    pub(super) fn round(&self, rng: &mut Rng, n: usize) -> ConvexPolyhedron {
        let shape = shapes::sphere(rng, n).stretched([1.0, 0.9, 0.8]);
        let body = body(&shape.stretched([self.unit; 3]));
        let (low, high) = body.aabb();
        let half = (high - low).norm() / self.unit / 2.0;
        assert!((1.0..2.0).contains(&half), "{half}");
        body
    }

    /// Returns a random rotation, with the origins `apart` apart.
    pub(super) fn place(&self, rng: &mut Rng, apart: f64) -> Isometry3<f64> {
        let [x, y, z, w] = rng.quat();
        let turn = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
        let at = Vector3::from(rng.unit()) * (apart * self.unit);
        Isometry3::from_parts(Translation3::from(at), turn)
    }

    pub(super) fn pose(&self, rng: &mut Rng, apart: f64) -> RelativePose {
        let (a, b) = (self.place(rng, 3.0), self.place(rng, apart));
        RelativePose::new(&a, &(a * b)).expect("a pose")
    }

    /// Returns two motions whose bodies meet in about half of all cases.
    pub(super) fn motions(&self, rng: &mut Rng) -> [Steady; 2] {
        let start = self.place(rng, 4.0);
        let aim = Vector3::from(rng.unit()) * (rng.range(0.0, 2.5) * self.unit);
        let way = (aim - start.translation.vector) * rng.range(0.8, 1.5);
        let spins = [0, 1].map(|_| Vector3::from(rng.unit()) * rng.range(0.0, 2.0));
        let still = Steady::new(&Isometry3::identity(), Velocity::new(Vector3::zeros(), spins[0]));
        let flying = Steady::new(&start, Velocity::new(way, spins[1]));
        [still, flying].map(|motion| motion.expect("a finite motion"))
    }
}
