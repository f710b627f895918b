//! Meshes with a common history or a common shape, queried alternately by one tracker.
//!
//! The meshes are clones that change differently, or the same shape under several numberings. Every
//! answer is judged by all pairs of triangles.

use super::Mix;
use crate::rng::Rng;
use crate::soups::Soup;
use crate::support::Decide;
use crate::{Pose, brute};
use lin_canny::nalgebra::{Point3, Vector3};
use lin_canny::polyhedron::solids;
use lin_canny::surface::BezierSurface;
use lin_canny::{Geometry, Mesh, PairTracker, RelativePose};

/// Squares of the sheet along x and y.
const SQUARES: [u32; 2] = [16, 6];

/// Queries of a family.
const QUERIES: usize = 24;

/// Error of an answer and of brute force, in units of L.
const NOISE: f64 = 1e-13;

/// Returns the vertices of a sheet: flat, in waves, or rolled up by some turns.
fn sheet(shape: usize, turns: f64) -> Vec<Point3<f64>> {
    let [n, m] = SQUARES;
    let bent = |x: f64, y: f64| match shape {
        0 => Point3::new(x, y, 0.0),
        1 => Point3::new(x, y, 0.1 * (turns * (3.0 * x + y)).sin()),
        _ => {
            let angle = turns * std::f64::consts::TAU * x.max(0.0);
            let start = 0.12 / turns;
            let radius = start * (1.0 + 0.05 * angle);
            Point3::new(x.min(0.0) + radius * angle.sin(), y, start - radius * angle.cos())
        }
    };
    let place = |i: u32, j: u32| {
        bent(
            2.0 * f64::from(i) / f64::from(n) - 1.0,
            f64::from(j) / f64::from(m) - 0.5,
        )
    };
    (0..=n).flat_map(|i| (0..=m).map(move |j| place(i, j))).collect()
}

fn triangles() -> Vec<[u32; 3]> {
    let [n, m] = SQUARES;
    let square = |i: u32, j: u32| {
        let [a, b, c, d] = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(k, l)| (i + k) * (m + 1) + j + l);
        [[a, b, c], [a, c, d]]
    };
    (0..n).flat_map(|i| (0..m).flat_map(move |j| square(i, j))).collect()
}

/// Returns the flat sheet with another numbering of its vertices and the same triangles.
fn renumbered(rng: &mut Rng) -> Mesh {
    let points = sheet(0, 1.0);
    let mut number: Vec<u32> = (0..points.len() as u32).collect();
    for _ in 0..1 + rng.below(4) {
        let (i, j) = (rng.below(number.len()), rng.below(number.len()));
        number.swap(i, j);
    }
    let mut moved = points.clone();
    (0..points.len()).for_each(|k| moved[number[k] as usize] = points[k]);
    let named: Vec<_> = triangles().iter().map(|t| t.map(|v| number[v as usize])).collect();
    Mesh::new(&moved, &named).expect("a sheet")
}

fn order(mesh: &Mesh) -> Vec<u32> {
    mesh.triangles().map(|t| t.0).collect()
}

/// Changes a mesh: its vertices all, in part or not at all, or its tree.
fn change(mesh: &mut Mesh, rng: &mut Rng, mix: &mut Mix) -> Result<(), String> {
    let before = order(mesh);
    let turns = 0.25 + 0.25 * rng.below(8) as f64;
    match rng.below(6) {
        0 => {
            // Nothing moves, for as many calls as one tree may serve.
            let now = mesh.vertices();
            for _ in 0..1 + rng.below(20) {
                mesh.set_vertices(&now).map_err(|e| e.to_string())?;
            }
        }
        1 => {
            let first = rng.below(mesh.vertex_count());
            let part: Vec<_> = mesh
                .vertices()
                .iter()
                .skip(first)
                .take(9)
                .map(|p| p + Vector3::z() * 0.01)
                .collect();
            mesh.set_vertices_from(first, &part).map_err(|e| e.to_string())?;
        }
        2 => {
            mesh.rebuild();
            mix.trees[1] += u64::from(before != order(mesh));
            return Ok(());
        }
        shape => mesh.set_vertices(&sheet(shape - 3, turns)).map_err(|e| e.to_string())?,
    }
    mix.trees[0] += u64::from(before != order(mesh));
    Ok(())
}

fn soup(corners: impl Iterator<Item = [Point3<f64>; 3]>) -> Soup {
    let mut soup = Soup::default();
    for t in corners {
        let base = soup.points.len() as u32;
        soup.points.extend(t.map(|p| [p.x, p.y, p.z]));
        soup.triangles.push([base, base + 1, base + 2]);
    }
    soup
}

/// Plays a family of meshes.
pub(super) fn family(seed: u64) -> Result<Mix, String> {
    let mut rng = Rng::new(seed);
    let mut mix = Mix::default();
    mix.families[0] = 1;
    let mut first = Mesh::new(&sheet(0, 1.0), &triangles()).map_err(|e| e.to_string())?;
    for _ in 0..rng.below(4) {
        change(&mut first, &mut rng, &mut mix)?;
    }
    let mut meshes = vec![first.clone(), first.clone(), first];
    if rng.chance(0.5) {
        meshes.push(renumbered(&mut rng));
        meshes.push(Mesh::new(&sheet(0, 1.0), &triangles()).map_err(|e| e.to_string())?);
        mix.numbered += 1;
    }
    let die = solids::cuboid(Vector3::new(0.05, 0.08, 0.03)).map_err(|e| e.to_string())?;
    let die_soup = soup(die.triangles().map(|t| t.map(|v| die.vertex(v).unwrap_or_default())));
    let is_shell = rng.chance(0.1);
    let probe: Geometry = if is_shell {
        BezierSurface::from_convex(&die).map_err(|e| e.to_string())?.into()
    } else {
        Mesh::from_convex(&die).map_err(|e| e.to_string())?.into()
    };
    let mut tracker = PairTracker::new();
    let mut place = rng.in_ball();
    for query in 0..QUERIES {
        if rng.chance(0.3) {
            // The same change in all meshes, or a different one in each.
            let (same, is_same) = (rng.bits(), rng.chance(0.5));
            for mesh in &mut meshes {
                let mut own = if is_same { Rng::new(same) } else { Rng::new(rng.bits()) };
                change(mesh, &mut own, &mut mix)?;
            }
        }
        let mesh = &meshes[rng.below(meshes.len())];
        place = crate::pose::add(place, rng.in_ball().map(|x| 0.1 * x));
        let pose = Pose::new(rng.quat(), place);
        let relative = RelativePose::from_isometry(&pose.isometry()).map_err(|e| e.to_string())?;
        let own = soup(mesh.triangles().map(|t| t.1));
        let truth = brute::distance(&own, &die_soup, &pose).0;
        let noise = if is_shell {
            1e-8
        } else {
            NOISE * (own.radius() + 0.1 + crate::pose::norm(place))
        };
        let wrong = |what: &str, found: &dyn std::fmt::Debug| {
            Err(format!("query {query}, {what}: {found:?}, {truth:e} by brute force"))
        };
        match rng.below(4) {
            0 => {
                for d in [
                    0.0,
                    0.5 * truth,
                    truth - 2.0 * noise,
                    truth + 2.0 * noise,
                    2.0 * truth + 0.1,
                ] {
                    let said = tracker.decide(mesh, &probe, &relative, d);
                    if said.is_yes() && truth - noise > d || d >= 0.0 && said.is_no() && truth + noise <= d {
                        return wrong("within", &(d, said));
                    }
                }
            }
            1 => {
                let found = tracker.lower_bound(mesh, &probe, &relative);
                if found > truth + noise {
                    return wrong("a lower bound", &found);
                }
            }
            2 if query % 4 == 0 => {
                let (found, fresh) = (tracker.self_closest(mesh), PairTracker::new().self_closest(mesh));
                let far = found
                    .zip(fresh)
                    .is_none_or(|(x, y)| (x.distance - y.distance).abs() > noise);
                if far {
                    return wrong("a mesh against itself", &(found, fresh));
                }
            }
            _ => {
                let found = tracker.closest(mesh, &probe, &relative);
                if found.lower.max(0.0) > truth + noise || found.upper.max(0.0) < truth - noise {
                    return wrong("closest", &found);
                }
                if !is_shell && (found.distance.max(0.0) - truth).abs() > noise {
                    return wrong("closest", &found);
                }
            }
        }
        mix.families[1] += 1;
    }
    Ok(mix)
}
