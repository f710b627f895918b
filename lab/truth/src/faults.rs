//! Generated faults of real mesh files: triangles without area, cut edges, repeats and slivers.
//!
//! None of them opens a closed surface.

use crate::pose::{add, scale};
use crate::rng::Rng;
use crate::soups::Soup;

/// Rounds coordinates to a grid, so that the middle of an edge is exactly on the edge.
pub fn on_grid(soup: Soup) -> Soup {
    soup.map(|p| p.map(|x| (x * 1_048_576.0).round() / 1_048_576.0))
}

/// Cuts a triangle at the middle of an edge without changing its neighbour.
///
/// If `is_capped`, a triangle without area closes the slit.
pub fn slit(soup: &mut Soup, rng: &mut Rng, is_capped: bool) {
    let t = rng.below(soup.triangles.len());
    let [a, b, c] = soup.triangles[t];
    let ends = [a, b].map(|v| soup.points[v as usize]);
    let middle = soup.points.len() as u32;
    soup.points.push(scale(add(ends[0], ends[1]), 0.5));
    soup.triangles[t] = [a, middle, c];
    soup.triangles.push([middle, b, c]);
    if is_capped {
        soup.triangles.push([a, b, middle]);
    }
}

/// Adds triangles that change no winding number.
fn litter(soup: &mut Soup, rng: &mut Rng, kind: usize) {
    let [a, b, c] = soup.triangles[rng.below(soup.triangles.len())];
    match kind {
        0 => slit(soup, rng, true),
        1 => slit(soup, rng, false),
        // Triangles with repeated vertices, without area.
        2 => soup.triangles.extend([[a, a, a], [a, b, a], [b, b, c]]),
        // One more copy, without an opposite.
        3 => soup.triangles.push([b, c, a]),
        // Two more copies, with opposites.
        4 => soup.triangles.extend([[a, b, c], [b, c, a], [a, c, b], [c, b, a]]),
        // One more copy, with an opposite.
        5 => soup.triangles.extend([[c, a, b], [b, a, c]]),
        // A sliver and its reverse.
        _ => {
            let middle = soup.points.len() as u32;
            let ends = [a, b].map(|v| soup.points[v as usize]);
            let off = scale(add(ends[0], ends[1]), 0.5);
            soup.points.push([off[0], off[1], off[2] + 2f64.powi(-40)]);
            soup.triangles.extend([[a, b, middle], [b, a, middle]]);
        }
    }
}

/// Returns the mesh with one to six faults.
///
/// Triangles repeated without an opposite look like a second layer if other repeats are counted, so
/// they are never combined with other faults.
pub fn faulty(clean: &Soup, rng: &mut Rng) -> Soup {
    let mut soup = clean.clone();
    let alone = rng.below(4) == 0;
    for _ in 0..1 + rng.below(6) {
        let kind = if alone { 3 } else { [0, 1, 2, 4, 5, 6][rng.below(6)] };
        litter(&mut soup, rng, kind);
    }
    if rng.below(2) == 0 { soup.unwelded() } else { soup }
}
