//! Rays at polygons, hulls, meshes, half-spaces and clouds, in planes of faces, along edges and close
//! to both, at poses off unit length, judged over the rationals.
//!
//! The judge maps a ray into the frame of the body without rounding. The crossings of triangles, of
//! a plane and of boxes are rational. A ball is entered between two distances if the least square of
//! a distance from its centre up to the first is larger than the square of the radius, and up to the
//! second is not. Rays at clouds are proven up to the rounding of a position, so the judge grows and
//! shrinks the elements of a cloud by as much.

use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::{Cloud, CloudElement, ConvexPolyhedron, Geometry, HalfSpace, Mesh, Ray, RayCast, RayCaster};

use super::exact_place::{Exact3, ExactMesh, Place, line_at};
use super::turned_boxes::rotation;
use crate::pose::{add, cross, dot, norm, off_unit, scale, sub, unit};
use crate::rational::{RBig, exact, placed, rounded};
use crate::rng::Rng;
use crate::soups::{self, Soup};
use crate::{Point, Pose};

/// Number of rays per body.
pub const EACH: u64 = 10;

/// Number of the kinds of bodies.
pub const KINDS: usize = 5;

/// Error of a position on a ray at a cloud, in units of the coordinates.
const ROUNDING: f64 = 1e-14;

crate::tally! {
    /// Counts of the rays at polygons, hulls, meshes, half-spaces and clouds: misses, hits, starts
    /// inside, undecided.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct Mix {
        /// Counts by kind.
        pub rays: [[u64; 4]; KINDS],
    }
}

/// What the judge knows of a body.
enum Truth {
    /// Triangles, and whether points inside belong to the body.
    Triangles(Soup, ExactMesh, bool),
    /// Normal and offset.
    HalfSpace(Point, f64),
    /// Balls about points.
    Balls(Vec<Point>, f64),
    /// Boxes about points, by their half extents.
    Boxes(Vec<Point>, Point),
}

/// The result of the judge: the distance of the first point; zero if the ray starts in the body.
type First = Option<RBig>;

struct World {
    kind: usize,
    body: Geometry,
    truth: Truth,
    at: Pose,
    size: f64,
}

/// Returns a flat polygon with vertices on a lattice: points of a parabola in a plane.
fn polygon(rng: &mut Rng) -> Vec<Point> {
    let mut way = || [0; 3].map(|_| rng.int(-2, 2) as f64);
    let (mut u, mut v) = (way(), way());
    while norm(cross(u, v)) == 0.0 {
        (u, v) = (way(), way());
    }
    let count = 3 + rng.below(12);
    let corner = |k: usize| {
        let x = k as f64 - 2.0;
        scale(add(scale(u, x), scale(v, x * x)), 0.125)
    };
    (0..count).map(corner).collect()
}

fn fan(points: &[Point]) -> Soup {
    Soup::new(
        points.to_vec(),
        (2..points.len() as u32).map(|k| [0, k - 1, k]).collect(),
    )
}

/// Returns a mesh and whether it is closed; among them a plate without thickness, both sides of it.
fn mesh(rng: &mut Rng) -> (Soup, bool) {
    match rng.below(6) {
        0 => (soups::gear(2 + rng.below(3)), true),
        1 => (soups::bracket(), true),
        2 => (soups::plate(1, [1.0, 0.5, 0.25]), true),
        3 => (fan(&polygon(rng)), false),
        4 => {
            let sheet = fan(&polygon(rng));
            let under = sheet.clone().flipped();
            let triangles = [sheet.triangles, under.triangles].concat();
            (Soup { triangles, ..sheet }, true)
        }
        _ => (soups::rock(1, rng.bits()), true),
    }
}

fn at(points: &[Point]) -> Vec<Point3<f64>> {
    points.iter().map(|p| Point3::from(*p)).collect()
}

impl World {
    fn new(rng: &mut Rng) -> Result<Self, String> {
        let kind = rng.below(KINDS);
        let told = |e: &dyn std::fmt::Display| e.to_string();
        let of = |soup: Soup, is_solid| {
            let exact = ExactMesh::new(&soup);
            Truth::Triangles(soup, exact, is_solid)
        };
        let (body, truth): (Geometry, Truth) = match kind {
            0 => {
                let points = polygon(rng);
                let body = ConvexPolyhedron::polygon(&at(&points)).map_err(|e| told(&e))?;
                (body.into(), of(fan(&points), false))
            }
            1 => {
                let half = [0; 3].map(|_| rng.int(1, 8) as f64 / 4.0);
                let points = if rng.chance(0.5) {
                    soups::plate(1, half).points
                } else {
                    (0..12).map(|_| [0; 3].map(|_| rng.int(-4, 4) as f64 / 4.0)).collect()
                };
                let body = ConvexPolyhedron::from_points(&at(&points)).map_err(|e| told(&e))?;
                let soup = Soup::new(
                    body.vertex_points().map(Into::into).collect(),
                    body.triangles().map(|t| t.map(|v| v.index() as u32)).collect(),
                );
                let is_solid = body.face_count() > 2;
                (body.into(), of(soup, is_solid))
            }
            2 => {
                let (soup, is_solid) = mesh(rng);
                let body = Mesh::new(&at(&soup.points), &soup.triangles).map_err(|e| told(&e))?;
                (body.into(), of(soup, is_solid))
            }
            3 => {
                let normal = if rng.chance(0.5) {
                    *rng.pick(&[[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 0.6, 0.8]])
                } else {
                    rng.unit()
                };
                let offset = [0.0, 1.0, rng.range(-1.0, 1.0)][rng.below(3)];
                let body = HalfSpace::new(normal.into(), offset).map_err(|e| told(&e))?;
                let truth = Truth::HalfSpace(body.normal().into_inner().into(), body.offset());
                (body.into(), truth)
            }
            _ => {
                // Points that are equal, or closer than single precision separates.
                let near = [0.0, 1e-12, 1e-8, 1.0][rng.below(4)];
                let middle = scale(rng.in_ball(), 4.0);
                let mut points: Vec<Point> = (0..1 + rng.below(8))
                    .map(|_| add(middle, scale(rng.in_ball(), near)))
                    .collect();
                let twice = *rng.pick(&points);
                points.push(twice);
                let half = [0.5, 0.25, 1.0];
                let (element, truth) = if rng.chance(0.5) {
                    (CloudElement::Ball(0.5), Truth::Balls(points.clone(), 0.5))
                } else {
                    (CloudElement::Box(half.into()), Truth::Boxes(points.clone(), half))
                };
                let body = Cloud::new(&at(&points), element).map_err(|e| told(&e))?;
                (body.into(), truth)
            }
        };
        let t = match rng.below(3) {
            0 => [0.0; 3],
            1 => [1.0, -3.0, 2.0],
            _ => scale(rng.in_ball(), rng.log_range(1.0, 1e4)),
        };
        let q = off_unit(rotation(rng), rng);
        let size = match &truth {
            Truth::Triangles(soup, ..) => soup.radius(),
            _ => 4.0,
        };
        let at = Pose::new(q, t);
        Ok(Self {
            kind,
            body,
            truth,
            at,
            size,
        })
    }

    /// Returns a point of the surface, a normal there, and a direction along the surface.
    fn spot(&self, rng: &mut Rng) -> (Point, Point, Point) {
        match &self.truth {
            Truth::Triangles(soup, ..) => {
                let [a, b, c] = soup.corners(rng.below(soup.triangles.len()));
                let shares = *rng.pick(&[[1.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.25, 0.25, 0.5]]);
                let at = add(add(scale(a, shares[0]), scale(b, shares[1])), scale(c, shares[2]));
                (at, unit(cross(sub(b, a), sub(c, a))), sub(b, a))
            }
            Truth::HalfSpace(n, offset) => {
                let along = cross(*n, rng.unit());
                (add(scale(*n, *offset), scale(along, rng.range(-3.0, 3.0))), *n, along)
            }
            Truth::Balls(points, radius) => {
                let n = rng.unit();
                (add(*rng.pick(points), scale(n, *radius)), n, cross(n, rng.unit()))
            }
            Truth::Boxes(points, half) => {
                let (p, k) = (*rng.pick(points), rng.below(3));
                let (mut n, mut along) = ([0.0; 3], [0.0; 3]);
                (n[k], along[(k + 1) % 3]) = (rng.sign(), 1.0);
                let share: Point = std::array::from_fn(|i| if i == k { n[k] } else { rng.int(-2, 2) as f64 * 0.5 });
                (add(p, std::array::from_fn(|i| share[i] * half[i])), n, along)
            }
        }
    }

    /// Returns a ray in the world that meets a point of the surface, runs along it, or passes close
    /// to it.
    fn ray(&self, rng: &mut Rng) -> Option<Ray> {
        let (at, normal, along) = self.spot(rng);
        let lift = if rng.chance(0.5) {
            0.0
        } else {
            rng.log_range(1e-17, 1e-6) * rng.sign() * self.size
        };
        let (way, to) = match rng.below(5) {
            0 => (rng.unit(), at),
            1 => (scale(normal, -1.0), at),
            2 => (along, add(at, scale(normal, lift))),
            3 => (cross(normal, rng.unit()), add(at, scale(normal, lift))),
            // Almost along the surface.
            _ => (add(unit(along), scale(normal, lift)), at),
        };
        if norm(way) == 0.0 {
            return None;
        }
        let far = [0.0, 1.0, 3.0, rng.range(0.0, 4.0), rng.log_range(1e-16, 1.0)][rng.below(5)];
        let from = sub(to, scale(unit(way), far * self.size));
        let turn = self.at.moved_to([0.0; 3]);
        let [origin, way] = [(from, &self.at), (way, &turn)].map(|(p, at)| placed(&[p], at)[0].each_ref().map(rounded));
        Ray::new(Point3::from(origin), Vector3::from(way)).ok()
    }

    /// Returns the first point of a ray, over the rationals, and for elements of clouds that are
    /// larger by `grown`.
    fn first(&self, line: &(Exact3, Exact3), grown: f64, rng: &mut Rng) -> First {
        let (origin, way) = line;
        let times = |n: &Point, v: &Exact3| (0..3).fold(RBig::ZERO, |sum, k| sum + exact(n[k]) * &v[k]);
        match &self.truth {
            Truth::Triangles(_, mesh, is_solid) => {
                let place = mesh.place(origin, rng);
                if place == Place::On || *is_solid && place == Place::Inside {
                    return Some(RBig::ZERO);
                }
                mesh.first(line).map(|f| f.0)
            }
            Truth::HalfSpace(n, offset) => {
                let (height, rise) = (times(n, origin) - exact(*offset), times(n, way));
                if height <= RBig::ZERO {
                    return Some(RBig::ZERO);
                }
                (rise < RBig::ZERO).then(|| height / -rise)
            }
            // The distance is not rational; see `is_met`.
            Truth::Balls(..) => None,
            Truth::Boxes(points, half) => {
                let each = points.iter().filter_map(|p| {
                    let (mut from, mut until) = (RBig::ZERO, None::<RBig>);
                    for k in 0..3 {
                        let (x, h) = (&origin[k] - exact(p[k]), exact(half[k]) + exact(grown));
                        if way[k] == RBig::ZERO {
                            if x > h || x < -&h {
                                return None;
                            }
                            continue;
                        }
                        let ends = [-&h - &x, h - &x].map(|y| y / &way[k]);
                        let [a, b] = ends;
                        let (a, b) = if a < b { (a, b) } else { (b, a) };
                        from = from.max(a);
                        until = Some(until.map_or(b.clone(), |u| u.min(b)));
                    }
                    until.is_none_or(|u| from <= u).then_some(from)
                });
                each.min()
            }
        }
    }

    /// Returns whether a ray meets a body up to a distance, for elements of clouds that are larger by
    /// `grown`.
    fn is_met(&self, line: &(Exact3, Exact3), until: f64, grown: f64, rng: &mut Rng) -> bool {
        if let Truth::Balls(points, radius) = &self.truth {
            let (origin, way) = line;
            let dot = |u: &Exact3, v: &Exact3| (0..3).fold(RBig::ZERO, |sum, k| sum + &u[k] * &v[k]);
            let square = (exact(*radius) + exact(grown)) * (exact(*radius) + exact(grown));
            return points.iter().any(|p| {
                let from: Exact3 = std::array::from_fn(|k| &origin[k] - exact(p[k]));
                let mut s = (-dot(&from, way) / dot(way, way)).max(RBig::ZERO);
                if until.is_finite() {
                    s = s.min(exact(until));
                }
                let nearest: Exact3 = std::array::from_fn(|k| &from[k] + &s * &way[k]);
                dot(&nearest, &nearest) <= square
            });
        }
        self.first(line, grown, rng)
            .is_some_and(|s| until == f64::INFINITY || s <= exact(until))
    }

    /// Casts a ray and judges the result.
    fn cast(&self, ray: &Ray, length: f64, rng: &mut Rng) -> Result<usize, String> {
        let found = RayCaster::new()
            .cast(&self.body, &self.at.isometry(), ray, length)
            .map_err(|e| e.to_string())?;
        let line = line_at(ray.origin.into(), ray.direction.into_inner().into(), &self.at);
        let coordinates = norm(ray.origin.into()) + norm(self.at.t) + self.size;
        let slack = if self.kind == 4 { ROUNDING * coordinates } else { 0.0 };
        let starts = |grown: f64, rng: &mut Rng| self.is_met(&line, 0.0, grown, rng);
        let is_right = match &found {
            RayCast::Inside => starts(slack, rng),
            RayCast::Miss => !self.is_met(&line, length, -slack, rng),
            RayCast::Hit(hit) => {
                hit.safe <= hit.hit
                    && hit.hit <= length
                    && self.is_met(&line, hit.hit, slack, rng)
                    && (hit.safe <= 0.0 || !self.is_met(&line, hit.safe.next_down(), -slack, rng))
                    && !(self.kind != 4 && starts(0.0, rng))
            }
            RayCast::Undecided { safe } => *safe <= 0.0 || !self.is_met(&line, safe.next_down(), -slack, rng),
            _ => false,
        };
        // The normal is of unit length, and the outward one of a half-space.
        let is_normal = match (&found, &self.truth) {
            (RayCast::Hit(hit), truth) => {
                let n: Point = hit.normal.into_inner().into();
                let is_of_plane = |m: &Point| {
                    let turn = self.at.moved_to([0.0; 3]);
                    norm(sub(n, placed(&[*m], &turn)[0].each_ref().map(rounded))) < 1e-14
                };
                (dot(n, n) - 1.0).abs() < 4e-14
                    && match truth {
                        Truth::HalfSpace(m, _) => is_of_plane(m),
                        _ => true,
                    }
            }
            _ => true,
        };
        if is_right && is_normal {
            return Ok(match found {
                RayCast::Miss => 0,
                RayCast::Hit(_) => 1,
                RayCast::Inside => 2,
                _ => 3,
            });
        }
        let first = self.first(&line, 0.0, rng).map(|s| rounded(&s));
        Err(format!(
            "kind {}, {first:?}, normal {is_normal}: {found:?}; {ray:?} {length:e} {:?}",
            self.kind, self.at
        ))
    }
}

/// Plays a body.
///
/// # Errors
/// Returns the first wrong answer.
pub fn play(seed: u64) -> Result<Mix, String> {
    let mut rng = Rng::new(seed);
    let told = |e: String| format!("seed {seed}: {e}");
    let world = World::new(&mut rng).map_err(told)?;
    let mut mix = Mix::default();
    for _ in 0..EACH {
        let Some(ray) = world.ray(&mut rng) else { continue };
        let length = if rng.chance(0.8) {
            f64::INFINITY
        } else {
            rng.range(0.0, 4.0) * world.size
        };
        mix.rays[world.kind][world.cast(&ray, length, &mut rng).map_err(told)?] += 1;
    }
    Ok(mix)
}
