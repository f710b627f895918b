//! Faults that files of real meshes have, made on purpose: triangles without area, cut edges, repeats and slivers. None of them opens
//! a closed surface.

use crate::pose::{add, scale};
use crate::rng::Rng;
use crate::soups::Soup;

/// Coordinates on a grid, so that the middle of an edge is exactly on the edge.
pub fn on_grid(soup: Soup) -> Soup {
    soup.map(|p| p.map(|x| (x * 1_048_576.0).round() / 1_048_576.0))
}

/// Cuts a triangle at the middle of an edge; the neighbour is left as it is, and the slit is closed
/// by a triangle without area, or not at all.
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
        // Without corners, without area.
        2 => soup.triangles.extend([[a, a, a], [a, b, a], [b, b, c]]),
        // Once more, without an opposite.
        3 => soup.triangles.push([b, c, a]),
        // Twice more, with opposites.
        4 => soup.triangles.extend([[a, b, c], [b, c, a], [a, c, b], [c, b, a]]),
        // Once more, with an opposite.
        5 => soup.triangles.extend([[c, a, b], [b, a, c]]),
        // A sliver and its back.
        _ => {
            let middle = soup.points.len() as u32;
            let ends = [a, b].map(|v| soup.points[v as usize]);
            let off = scale(add(ends[0], ends[1]), 0.5);
            soup.points.push([off[0], off[1], off[2] + 2f64.powi(-40)]);
            soup.triangles.extend([[a, b, middle], [b, a, middle]]);
        }
    }
}

/// The mesh with one to six faults. Triangles that are repeated without an opposite cannot be told from a second layer where
/// others are counted, so they come alone.
pub fn faulty(clean: &Soup, rng: &mut Rng) -> Soup {
    let mut soup = clean.clone();
    let alone = rng.below(4) == 0;
    for _ in 0..1 + rng.below(6) {
        let kind = if alone { 3 } else { [0, 1, 2, 4, 5, 6][rng.below(6)] };
        litter(&mut soup, rng, kind);
    }
    if rng.below(2) == 0 { soup.unwelded() } else { soup }
}
