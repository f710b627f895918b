//! Generated faults of real mesh files.
//!
//! Triangles without area, cut edges, repeats and slivers ([`faulty`]) do not open a closed
//! surface. Other faults do ([`broken`]).

use crate::pose::{add, scale};
use crate::rng::Rng;
use crate::soups::{self, Soup};

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

/// Number of the kinds of [`broken`].
pub const BROKEN_KINDS: usize = 12;

/// Returns a mesh with faults of one kind: open, repeated, crossing, with parts or triangles inside
/// out, without area, with T-junctions, of several shells apart or inside each other, all together.
pub fn broken(kind: usize, rng: &mut Rng) -> Soup {
    let part = |rng: &mut Rng, size: f64| {
        let off = [0; 3].map(|_| rng.int(-8, 8) as f64 / 16.0);
        soups::rock(2, rng.bits()).map(|p| add(scale(p, size), off))
    };
    let mut soup = part(rng, 1.0);
    let count = soup.triangles.len();
    match kind {
        0 => {
            for _ in 0..1 + rng.below(4) {
                soup.triangles.swap_remove(rng.below(count - 4));
            }
        }
        1 => {
            let again: Vec<_> = (0..8).map(|_| soup.triangles[rng.below(count)]).collect();
            soup.triangles.extend(again);
        }
        // The whole surface twice, or once more inside out.
        2 => {
            let again = if rng.below(2) == 0 {
                soup.clone()
            } else {
                soup.clone().flipped()
            };
            soup.triangles.extend(again.triangles);
        }
        3 => soup = soup.with(&part(rng, 0.75)),
        4 => soup = soup.with(&part(rng, 0.75).flipped()),
        5 => (0..1 + rng.below(4)).for_each(|_| soup.triangles[rng.below(count)].swap(0, 1)),
        6 => {
            let [a, b, c] = soup.triangles[rng.below(count)];
            soup.triangles.extend([[a, b, a], [c, c, c], [b, c, b]]);
            (0..3).for_each(|_| slit(&mut soup, rng, true));
        }
        7 => (0..1 + rng.below(6)).for_each(|_| slit(&mut soup, rng, false)),
        8 => {
            for x in [4.0, 8.0, -4.0] {
                soup = soup.with(&part(rng, 1.0).map(|p| add(p, [x, 0.0, 0.0])));
            }
        }
        9 | 10 => {
            for k in 1..4 {
                let inner = soups::rock(1, rng.bits()).map(|p| scale(p, 0.25 / f64::from(k)));
                let is_cavity = kind == 9 && k % 2 == 1;
                soup = soup.with(&if is_cavity { inner.flipped() } else { inner });
            }
        }
        _ => {
            for _ in 0..3 {
                soup = soup.with(&broken(rng.below(BROKEN_KINDS - 1), rng));
            }
            return soup;
        }
    }
    on_grid(soup)
}
