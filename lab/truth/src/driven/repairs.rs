//! Damaged meshes, repaired and judged over the rationals.
//!
//! A closed mesh loses triangles, or has some turned, doubled or split at an edge; it may become a
//! soup whose corners are apart by cracks. The repaired mesh must be closed, and the sides and winding
//! numbers of points those of its chain of triangles with caps. If no two damaged triangles share a
//! vertex, the sides must also be those of the mesh before the damage. The instrument `soak` uses this
//! module.

use lin_canny::nalgebra::Point3;
use lin_canny::{ContactState, Mesh, MeshKind, PointQuery, RepairOptions};

use super::exact_place::Place;
use crate::lattice_points::{LATTICE_KINDS, LatticeMesh, float};
use crate::near_points::{MESH_KINDS, hard_mesh, place};
use crate::pose::{add, cross, norm, scale, sub};
use crate::rng::Rng;
use crate::soups::Soup;
use crate::{Point, pose};

/// Points of a mesh over the rationals, and on the lattice.
const EACH: usize = 10;
const EACH_ON_LATTICE: usize = 1000;

crate::tally! {
    /// Counts of the results; if a count is zero, its ingredient was not tested.
    #[derive(Clone, Copy, Debug, Default)]
    pub struct Mix {
        /// Meshes with triangles lost, turned, doubled, split at an edge, of all these, and with a
        /// connected patch lost.
        pub damages: [u64; 6],
        /// Meshes whose triangles have corners of their own, at equal places and apart.
        pub soups: [u64; 2],
        /// Points outside and inside.
        pub points: [u64; 2],
        /// Points whose side a lost patch has changed.
        pub changed: u64,
        /// Caps, and triangles that were turned.
        pub repaired: [u64; 2],
    }
}

/// A damaged mesh, and the vertices of a patch that it lost.
struct Damaged {
    soup: Soup,
    patch: Vec<Point>,
}

/// Returns triangles of which no two share a vertex.
fn apart(soup: &Soup, most: usize, rng: &mut Rng) -> Vec<usize> {
    let mut order: Vec<usize> = (0..soup.triangles.len()).collect();
    rng.shuffle(&mut order);
    let (mut taken, mut chosen) = (vec![false; soup.points.len()], Vec::new());
    for t in order {
        let corners = soup.triangles[t].map(|v| v as usize);
        if chosen.len() < most && corners.iter().all(|v| !taken[*v]) {
            corners.iter().for_each(|v| taken[*v] = true);
            chosen.push(t);
        }
    }
    chosen
}

/// Returns a connected set of triangles.
fn patch(soup: &Soup, most: usize, rng: &mut Rng) -> Vec<usize> {
    let mut chosen = vec![rng.below(soup.triangles.len())];
    while chosen.len() < most {
        let is_next = |t: &usize| {
            let shares = |u: &usize| soup.triangles[*u].iter().any(|v| soup.triangles[*t].contains(v));
            !chosen.contains(t) && chosen.iter().any(shares)
        };
        let next: Vec<usize> = (0..soup.triangles.len()).filter(is_next).take(8).collect();
        if next.is_empty() {
            break;
        }
        chosen.push(*rng.pick(&next));
    }
    chosen
}

fn damaged(soup: &Soup, kind: usize, rng: &mut Rng) -> Damaged {
    let most = 1 + (soup.triangles.len() as f64 * rng.log_range(0.001, 0.05)) as usize;
    let mut damaged = soup.clone();
    if kind == 5 {
        let lost = patch(soup, most.min(soup.triangles.len() / 2), rng);
        let patch = lost.iter().flat_map(|t| soup.corners(*t)).collect();
        let kept = (0..soup.triangles.len()).filter(|t| !lost.contains(t));
        damaged.triangles = kept.map(|t| soup.triangles[t]).collect();
        return Damaged { soup: damaged, patch };
    }
    let mut chosen = apart(soup, most, rng);
    chosen.sort_unstable();
    // From the last one on, so that the indices of the others stay.
    for t in chosen.into_iter().rev() {
        let [a, b, c] = soup.triangles[t];
        match if kind == 4 { rng.below(4) } else { kind } {
            0 => drop(damaged.triangles.remove(t)),
            1 => damaged.triangles[t].swap(0, 1),
            2 => damaged.triangles.push([b, c, a]),
            _ => {
                let [p, q] = [a, b].map(|v| soup.points[v as usize]);
                damaged.points.push(scale(add(p, q), 0.5));
                let m = damaged.points.len() as u32 - 1;
                damaged.triangles[t] = [a, m, c];
                damaged.triangles.push([m, b, c]);
            }
        }
    }
    Damaged {
        soup: damaged,
        patch: Vec::new(),
    }
}

fn given(soup: &Soup) -> Vec<Point3<f64>> {
    soup.points.iter().map(|p| Point3::from(*p)).collect()
}

/// Returns the triangles of a mesh, those of caps included.
fn chain(mesh: &Mesh) -> Soup {
    let mut all: Vec<_> = mesh.triangles().collect();
    all.sort_by_key(|x| x.0);
    let points: Vec<Point> = all.iter().flat_map(|x| x.1).map(Into::into).collect();
    let triangles = (0..all.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Soup::new(points, triangles)
}

/// Returns whether a point is in the box of some points.
fn is_in_box(p: Point, points: &[Point], slack: f64) -> bool {
    (0..3).all(|k| {
        let low = points.iter().fold(f64::INFINITY, |m, q| m.min(q[k]));
        let high = points.iter().fold(f64::NEG_INFINITY, |m, q| m.max(q[k]));
        p[k] >= low - slack && p[k] <= high + slack
    })
}

/// A damaged mesh that may be a soup, and how it is to be repaired.
struct Case {
    soup: Soup,
    patch: Vec<Point>,
    options: RepairOptions,
    /// Points nearer to the surface than this may change sides.
    doubt: f64,
}

fn case(base: &Soup, damage: usize, mix: &mut Mix, rng: &mut Rng) -> Case {
    let Damaged { mut soup, patch } = damaged(base, damage, rng);
    mix.damages[damage] = 1;
    let mut options = RepairOptions::default();
    let mut doubt = 0.0;
    if rng.chance(0.4) {
        soup = soup.unwelded();
        let cracked = rng.chance(0.5);
        mix.soups[usize::from(cracked)] = 1;
        if cracked {
            let edges = base.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
            let length = |[a, b]: [u32; 2]| norm(sub(base.points[a as usize], base.points[b as usize]));
            let tolerance = 0.05 * edges.map(length).fold(f64::INFINITY, f64::min);
            for p in &mut soup.points {
                *p = add(*p, scale(rng.in_ball(), 0.25 * tolerance));
            }
            options = options.weld(tolerance);
            doubt = 2.0 * tolerance;
        }
    }
    Case {
        soup,
        patch,
        options,
        doubt,
    }
}

/// Plays a damaged mesh with vertices on a lattice, where a thousand points are judged by exact integers.
///
/// # Errors
/// Returns the first wrong answer.
pub fn play_on_lattice(seed: u64) -> Result<Mix, String> {
    let mut rng = Rng::new(seed);
    let (kind, damage) = (rng.below(MESH_KINDS), rng.below(6));
    let mut mix = Mix::default();
    let base = hard_mesh(kind, &mut rng);
    let largest = base.points.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
    // Even steps, so that the middle of an edge is on the lattice.
    let on_lattice = |step: f64| move |p: Point| p.map(|x| (x / step).round() * step);
    let base = base.map(|p| scale(p, 1.9 / largest)).map(on_lattice(2f64.powi(-19)));
    let is_flat = |soup: &Soup, t: usize| {
        let [a, b, c] = soup.corners(t);
        cross(sub(b, a), sub(c, a)) == [0.0; 3]
    };
    if (0..base.triangles.len()).any(|t| is_flat(&base, t)) {
        return Ok(mix);
    }
    let mut case = case(&base, damage, &mut mix, &mut rng);
    case.soup = case.soup.map(on_lattice(2f64.powi(-20)));
    let what = format!("seed {seed}: lattice mesh {kind}, damage {damage}, {:?}", case.options);
    let mesh = Mesh::repaired(&given(&case.soup), &case.soup.triangles, &case.options);
    let mesh = mesh.map_err(|e| format!("{what}: {e}"))?;
    let repair = mesh.report().repair.as_deref().ok_or("no report of a repair")?;
    mix.repaired = [repair.caps.len() as u64, repair.turned.len() as u64];
    let mut chain = chain(&mesh);
    let solid = (0..chain.triangles.len()).filter(|t| !is_flat(&chain, *t));
    chain.triangles = solid.map(|t| chain.triangles[t]).collect();
    let (before, after) = (LatticeMesh::new(&base), LatticeMesh::new(&chain));
    let query = PointQuery::new(&mesh);
    for k in 0..EACH_ON_LATTICE {
        let from = if k % 3 == 0 { &before } else { &after };
        let fine = from.hard_point(k % LATTICE_KINDS, &mut rng);
        let p = float(fine, 0);
        let point = Point3::from(p);
        let told = |e: lin_canny::PointError| format!("{what}: {e}");
        let (found, truth) = (query.winding_number(&point).map_err(told)?, after.winding(fine));
        let is_inside = query.contains(&point).map_err(told)?;
        if found != truth || is_inside != truth.is_none_or(|w| w != 0) {
            return Err(format!(
                "{what}, {p:?}: winding {found:?}, not {truth:?}; inside {is_inside}"
            ));
        }
        mix.points[usize::from(is_inside)] += 1;
        // On the surface of either mesh both sides are right.
        let was = before.winding(fine);
        if was.is_some() && truth.is_some() && (was != Some(0)) != is_inside {
            let near = query.closest_point(&point).map_err(told)?.lower.abs();
            if near <= case.doubt || is_in_box(p, &case.patch, 0.0) {
                mix.changed += 1;
                continue;
            }
            return Err(format!(
                "{what}, {p:?}: winding before {was:?}, now {truth:?}, {repair}"
            ));
        }
    }
    Ok(mix)
}

/// Plays a damaged mesh.
///
/// # Errors
/// Returns the first wrong answer.
pub fn play(seed: u64) -> Result<Mix, String> {
    let mut rng = Rng::new(seed);
    let (kind, damage) = (rng.below(MESH_KINDS), rng.below(6));
    let size = *rng.pick(&[1.0, 1.0, 1.0, 2e-99, 1e-30, 3e50, 1e99]);
    let base = hard_mesh(kind, &mut rng).map(|p| scale(p, size));
    let mut mix = Mix::default();
    let Case {
        soup,
        patch,
        options,
        doubt,
    } = case(&base, damage, &mut mix, &mut rng);
    let what = format!("seed {seed}: mesh {kind} times {size:e}, damage {damage}, {options:?}");
    let repaired = |soup: &Soup, options: &RepairOptions| {
        Mesh::repaired(&given(soup), &soup.triangles, options).map_err(|e| format!("{what}: {e}"))
    };
    let whole = repaired(&base, &RepairOptions::default())?;
    let mesh = repaired(&soup, &options)?;
    let repair = mesh.report().repair.as_deref().ok_or("no report of a repair")?;
    if mesh.kind() != MeshKind::Solid {
        return Err(format!("{what}: it is open: {repair}"));
    }
    mix.repaired = [repair.caps.len() as u64, repair.turned.len() as u64];
    let (chain, queries) = (chain(&mesh), [&whole, &mesh].map(PointQuery::new));
    let reach = 2.0 * base.radius();
    for _ in 0..EACH {
        let corners = base.corners(rng.below(base.triangles.len()));
        let (mut u, mut v) = (rng.uniform(), rng.uniform());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let along = [1, 2].map(|k| sub(corners[k], corners[0]));
        let on = add(corners[0], add(scale(along[0], u), scale(along[1], v)));
        // Scaled first, so that products stay in range.
        let normal = pose::unit(cross(scale(along[0], 1.0 / reach), scale(along[1], 1.0 / reach)));
        let height = (doubt + reach * rng.log_range(1e-6, 1e-1)) * rng.sign();
        let p = add(on, scale(normal, height));
        let point = Point3::from(p);
        let told = |e: lin_canny::PointError| format!("{what}: {e}");
        let found = queries[1].closest_point(&point).map_err(told)?;
        let winding = queries[1].winding_number(&point).map_err(told)?;
        let truth = place(&chain, p, &mut rng);
        let side = match truth {
            Place::Outside => (ContactState::Separated, winding == Some(0)),
            Place::On => (ContactState::Touching, winding.is_none()),
            Place::Inside => (ContactState::Overlapping, winding.is_some_and(|w| w != 0)),
        };
        if side != (found.state, true) {
            return Err(format!("{what}, {p:?}: {truth:?}, not {found:?}, winding {winding:?}"));
        }
        let before = queries[0].contains(&point).map_err(told)?;
        mix.points[usize::from(before)] += 1;
        if before != found.is_contained() {
            let nearest = queries[0].closest_point(&point).map_err(told)?;
            // A point near another part of the surface than that of its triangle.
            if nearest.lower.abs() <= doubt || is_in_box(p, &patch, 0.0) {
                mix.changed += 1;
                continue;
            }
            return Err(format!("{what}, {p:?}: inside before is {before}, {repair}"));
        }
    }
    Ok(mix)
}
