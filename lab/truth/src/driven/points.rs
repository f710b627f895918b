//! Points, small bodies and rays next to closed meshes, closer than rounding too, judged over the
//! rationals.
//!
//! The judge tests every triangle. A point is on the mesh if a triangle contains it; otherwise a
//! random ray that meets no edge counts the winding number. A ray meets a mesh at a vertex, at an
//! edge or inside a triangle; the judge tests each case separately.

use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::{
    Compound, ContactState, ConvexPolyhedron, Geometry, Mesh, PairTracker, Ray, RayCast, RayCaster, RelativePose, Shape,
};

use super::exact_place::{ExactMesh, Place, line_at, point_at};
use crate::pose::{add, cross, norm, off_unit, scale, sub, unit};
use crate::rational::{RBig, exact};
use crate::rng::Rng;
use crate::soups::{self, Soup};
use crate::{Point, Pose};

/// Number of points, and of rays, per mesh.
const EACH: usize = 6;

crate::tally! {
    /// Counts of the results; if a count is zero, its ingredient was not tested.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct Mix {
        /// Meshes.
        pub meshes: u64,
        /// Points outside, on and inside.
        pub points: [u64; 3],
        /// Segments and tetrahedra with a vertex at such a point: separated and meeting.
        pub small: [u64; 2],
        /// Small bodies that the judge does not decide, left out.
        pub skipped: u64,
        /// Rays at meshes: misses, hits, starts inside.
        pub rays: [u64; 3],
        /// Rays that meet a vertex or an edge exactly.
        pub through: u64,
        /// Rays that pass a vertex within `1e-12` of the size and miss.
        pub grazing: u64,
        /// Rays at hulls: misses, hits, starts inside, undecided.
        pub hull_rays: [u64; 4],
    }
}

/// Plays a mesh.
///
/// # Errors
/// Returns the first wrong answer.
pub fn play(seed: u64) -> Result<Mix, String> {
    World::new(seed)?.play()
}

/// A mesh at a pose.
struct World {
    rng: Rng,
    soup: Soup,
    size: f64,
    exact: ExactMesh,
    mesh: Geometry,
    hull: Option<Geometry>,
    poses: [Pose; 2],
    mix: Mix,
}

fn shape(rng: &mut Rng) -> (Soup, bool) {
    let sides = [rng.range(0.3, 1.0), rng.range(0.3, 1.0), 1.0];
    match rng.below(6) {
        0 => (soups::plate(1 + rng.below(2), [1.0; 3]), true),
        1 => (soups::plate(1, sides), true),
        2 => (soups::gear(2 + rng.below(3)), false),
        3 => (soups::rock(1, rng.bits()), false),
        4 => (soups::bracket(), false),
        _ => {
            let inner = soups::plate(1, [0.5; 3]);
            let inner = if rng.chance(0.5) { inner.flipped() } else { inner };
            (soups::plate(1, [1.0; 3]).with(&inner), false)
        }
    }
}

/// Returns the poses of the mesh and of the other body, most of them exact.
fn poses(rng: &mut Rng, size: f64) -> [Pose; 2] {
    let halves = [
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0, 0.0],
        [0.5, 0.5, 0.5, 0.5],
        [0.0, 0.0, 0.0, 1.0],
    ];
    let mut pose = || {
        let q = if rng.chance(0.5) {
            *rng.pick(&halves)
        } else {
            rng.quat()
        };
        let t = match rng.below(4) {
            0 => [0.0; 3],
            1 => scale([1.0, -3.0, 2.0], size * 0.25),
            2 => scale(rng.in_ball(), 2.0 * size),
            _ => scale(rng.in_ball(), rng.log_range(1.0, 1e6) * size),
        };
        Pose::new(off_unit(q, rng), t)
    };
    let (a, b) = (pose(), pose());
    match rng.below(3) {
        0 => [Pose::IDENTITY, Pose::IDENTITY],
        1 => [a, Pose::IDENTITY],
        _ => [a, b],
    }
}

impl World {
    fn new(seed: u64) -> Result<Self, String> {
        let mut rng = Rng::new(seed);
        let (soup, is_convex) = shape(&mut rng);
        let size = if rng.chance(0.7) {
            2f64.powi(rng.int(-3, 12) as i32)
        } else {
            rng.log_range(1e-99, 1e99)
        };
        let soup = soup.map(|p| scale(p, size));
        let points: Vec<Point3<f64>> = soup.points.iter().map(|p| Point3::from(*p)).collect();
        let mesh = Mesh::new(&points, &soup.triangles).map_err(|e| e.to_string())?;
        let hull = is_convex.then(|| ConvexPolyhedron::from_points(&points));
        let hull = hull.transpose().map_err(|e| e.to_string())?;
        Ok(Self {
            poses: poses(&mut rng, size),
            size: soup.radius(),
            exact: ExactMesh::new(&soup),
            mesh: mesh.into(),
            hull: hull.map(Geometry::from),
            rng,
            soup,
            mix: Mix::default(),
        })
    }

    fn play(mut self) -> Result<Mix, String> {
        self.mix.meshes = 1;
        for _ in 0..EACH {
            self.point()?;
            self.ray()?;
        }
        Ok(self.mix)
    }

    /// Returns a point of the surface, the normal there, and the vertices of the triangle.
    fn spot(&mut self) -> (Point, Point, [Point; 3]) {
        let corners = self.soup.corners(self.rng.below(self.soup.triangles.len()));
        let [a, b, c] = corners;
        let shares = match self.rng.below(4) {
            0 => [1.0, 0.0, 0.0],
            1 => [0.5, 0.5, 0.0],
            2 => [0.25, 0.25, 0.5],
            _ => {
                let (x, y) = (self.rng.uniform(), self.rng.uniform());
                let (x, y) = if x + y > 1.0 { (1.0 - x, 1.0 - y) } else { (x, y) };
                [x, y, 1.0 - x - y]
            }
        };
        let at = add(add(scale(a, shares[0]), scale(b, shares[1])), scale(c, shares[2]));
        // Scaled first, because squares may overflow or underflow.
        let by = 1.0 / self.size;
        let normal = unit(cross(scale(sub(b, a), by), scale(sub(c, a), by)));
        (at, normal, corners)
    }

    /// Returns a random height above or below the surface.
    fn height(&mut self) -> f64 {
        if self.rng.chance(0.3) {
            return 0.0;
        }
        self.rng.log_range(3e-17, 1e-12) * self.rng.sign() * self.size
    }

    /// Returns a point of the mesh's frame in the frame of the other body, in `f64`.
    fn local(&self, p: Point) -> Point {
        let [a, b] = &self.poses;
        b.apply_inverse(a.apply(p))
    }

    fn point(&mut self) -> Result<(), String> {
        let (at, normal, _) = self.spot();
        let near = add(at, scale(normal, self.height()));
        let near = self.local(near);
        let place = self.exact.place(&point_at(near, &self.poses), &mut self.rng);
        self.mix.points[place as usize] += 1;
        let body = |points: &[Point]| {
            let points: Vec<Point3<f64>> = points.iter().map(|p| Point3::from(*p)).collect();
            match points[..] {
                [p] => ConvexPolyhedron::point(p),
                [p, q] => ConvexPolyhedron::segment(p, q),
                _ => ConvexPolyhedron::from_points(&points),
            }
        };
        let point = body(&[near]).map_err(|e| e.to_string())?;
        let piece = Compound::from(Shape::from(point.clone()));
        self.judge(&point.into(), place, &[near])?;
        self.judge(&piece.into(), place, &[near])?;
        // Bodies with a vertex there; a tetrahedron may be smaller than rounding.
        let length = self.rng.log_range(1e-15, 0.1) * self.size;
        let mut ends = vec![near];
        for _ in 0..if self.rng.chance(0.5) { 1 } else { 3 } {
            let way = add(scale(normal, self.rng.sign()), self.rng.in_ball());
            ends.push(add(
                near,
                scale(self.poses[1].rotate_back(self.poses[0].rotate(way)), length),
            ));
        }
        if ends[1..].contains(&near) {
            return Ok(());
        }
        let Ok(small) = body(&ends) else { return Ok(()) };
        let exact: Vec<_> = ends.iter().map(|p| point_at(*p, &self.poses)).collect();
        let mut met = Some(false);
        for p in &exact {
            if self.exact.place(p, &mut self.rng) != Place::Outside {
                met = Some(true);
            }
        }
        if met == Some(false) {
            met = self.exact.meets(&exact);
        }
        let Some(met) = met else {
            self.mix.skipped += 1;
            return Ok(());
        };
        self.mix.small[usize::from(met)] += 1;
        let place = if met { Place::Inside } else { Place::Outside };
        if ends.len() == 4
            && self.rng.chance(0.5)
            && let Ok(small) = Mesh::from_convex(&small)
        {
            return self.judge(&small.into(), place, &ends);
        }
        self.judge(&small.into(), place, &ends)
    }

    /// Runs all queries on a body, in both orders.
    fn judge(&mut self, body: &Geometry, place: Place, points: &[Point]) -> Result<(), String> {
        let [at_a, at_b] = self.poses.map(|p| p.isometry());
        let pose = RelativePose::new(&at_a, &at_b).map_err(|e| e.to_string())?;
        let met = place != Place::Outside;
        for (a, b, pose) in [(&self.mesh, body, pose), (body, &self.mesh, pose.swapped())] {
            let mut tracker = PairTracker::new();
            let found = tracker.closest(a, b, &pose);
            let is_right = match found.state {
                ContactState::Separated => !met && found.lower > 0.0,
                ContactState::Touching => found.lower <= 0.0,
                ContactState::Overlapping => place == Place::Inside && found.lower <= 0.0,
                _ => false,
            };
            let (shares, within) = (tracker.intersects(a, b, &pose), tracker.within(a, b, &pose, 0.0));
            let bound = tracker.lower_bound(a, b, &pose);
            if !is_right || shares != met || within != met || met && bound > 0.0 {
                let told = format!("{shares:?} {within:?} {bound:e} {found:?}");
                return Err(format!(
                    "{place:?} {:?} {points:?} {:?}: {told}",
                    body.kind(),
                    self.poses
                ));
            }
        }
        Ok(())
    }

    /// Returns the origin and the direction of a ray, in the frame of the mesh.
    fn aim(&mut self) -> (Point, Point) {
        let (at, normal, corners) = self.spot();
        let (lift, far) = (scale(normal, self.height()), self.rng.range(0.0, 4.0));
        let (way, aside) = match self.rng.below(5) {
            // At the point, from a random direction.
            0 => (self.rng.unit(), [0.0; 3]),
            // Straight down, exactly if the face is perpendicular to an axis.
            1 => (normal, [0.0; 3]),
            // Along an edge, or along the face.
            2 => (scale(sub(corners[1], corners[0]), 1.0 / self.size), lift),
            3 => (cross(normal, self.rng.unit()), lift),
            // Along an axis.
            _ => {
                let mut way = [0.0; 3];
                way[self.rng.below(3)] = self.rng.sign();
                (way, lift)
            }
        };
        let to = add(at, aside);
        (add(to, scale(way, far * self.size)), scale(way, -self.size))
    }

    fn ray(&mut self) -> Result<(), String> {
        let (from, way) = self.aim();
        let at = self.poses[0];
        let origin = Point3::from(at.apply(from));
        let Ok(ray) = Ray::new(origin, Vector3::from(at.rotate(way))) else {
            return Ok(());
        };
        let length = if self.rng.chance(0.7) {
            f64::INFINITY
        } else {
            self.rng.range(0.1, 4.0) * self.size
        };
        let line = line_at(origin.into(), ray.direction.into_inner().into(), &at);
        let begins = self.exact.place(&line.0, &mut self.rng);
        let first = self.exact.first(&line);
        let within = first
            .as_ref()
            .filter(|(s, _)| length == f64::INFINITY || *s <= exact(length));
        let found = self.cast(false, &ray, length, begins, within.map(|f| &f.0))?;
        match found {
            RayCast::Inside => self.mix.rays[2] += 1,
            RayCast::Hit(_) => self.mix.rays[1] += 1,
            _ => self.mix.rays[0] += 1,
        }
        self.mix.through += u64::from(within.is_some_and(|f| f.1));
        let slack = 1e-12 * norm(scale(from, 1.0 / self.size)).max(1.0) * self.size;
        let is_near = |p: Point| {
            norm(scale(
                cross(scale(sub(p, from), 1.0 / self.size), unit(scale(way, 1.0 / self.size))),
                self.size,
            )) < slack
        };
        let is_grazing = found == RayCast::Miss && self.soup.points.iter().any(|p| is_near(*p));
        self.mix.grazing += u64::from(is_grazing);
        if self.hull.is_some() {
            let found = self.cast(true, &ray, length, begins, within.map(|f| &f.0))?;
            let which = match found {
                RayCast::Miss => 0,
                RayCast::Hit(_) => 1,
                RayCast::Inside => 2,
                _ => 3,
            };
            self.mix.hull_rays[which] += 1;
        }
        Ok(())
    }

    /// Casts a ray at the mesh or its hull.
    fn cast(
        &self,
        is_hull: bool,
        ray: &Ray,
        length: f64,
        begins: Place,
        first: Option<&RBig>,
    ) -> Result<RayCast, String> {
        let body = self.hull.as_ref().filter(|_| is_hull).unwrap_or(&self.mesh);
        let at = self.poses[0].isometry();
        let found = RayCaster::new()
            .cast(body, &at, ray, length)
            .map_err(|e| e.to_string())?;
        let is_in = begins != Place::Outside;
        let is_right = match found {
            RayCast::Inside => is_in,
            RayCast::Miss => !is_in && first.is_none(),
            RayCast::Hit(hit) => !is_in && first.is_some_and(|s| exact(hit.safe) <= *s && *s <= exact(hit.hit)),
            // A ray along a hull may stay undecided: a point that moves along it proves no contact.
            RayCast::Undecided { safe } => is_hull && first.is_none_or(|s| exact(safe) <= *s),
            _ => false,
        };
        if is_right {
            return Ok(found);
        }
        let first = first.map(|s| s.to_f64().value());
        Err(format!(
            "hull {is_hull}, {begins:?}, {first:?}: {found:?}; {ray:?} {length:e} {:?}",
            self.poses[0]
        ))
    }
}
