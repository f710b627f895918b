//! The families of cases, and the suites made of them.
//!
//! Each family has one difficulty at many degrees, from harmless to the last bit. A seed draws the
//! bodies, turns and gaps; the difficulty stays.

mod contact;
mod form;
mod motion;
mod queries;
mod size;

use crate::Point;
use crate::maker::{BodyId, Maker, Precision};
use crate::rng::Rng;
use crate::shapes::{self, Shape};
use std::io::{self, Write};

/// Difficulties of bodies of ordinary size: what an engine should answer.
pub const CORE: [&str; 11] = [
    "touching", "parallel", "coplanar", "thin", "deep", "equal", "lattice", "spinning", "resting", "sliding", "round",
];

/// Sizes, offsets and bodies that many engines state no support for.
pub const EXTREME: [&str; 5] = ["far", "tiny", "huge", "ratios", "flat"];

/// Queries other than the distance of a convex pair (version 2 of the format).
pub const QUERIES: [&str; 4] = ["points", "meshes", "casts", "rays"];

/// Returns the families of a suite: `core`, `extreme`, `standard` with both, or `queries`.
pub fn suite(name: &str) -> Option<Vec<&'static str>> {
    match name {
        "core" => Some(CORE.to_vec()),
        "extreme" => Some(EXTREME.to_vec()),
        "standard" => Some([&CORE[..], &EXTREME].concat()),
        "queries" => Some(QUERIES.to_vec()),
        _ => None,
    }
}

/// Writes about `count` cases of each family.
pub fn write(
    out: impl Write,
    name: &str,
    families: &[&'static str],
    seed: u64,
    count: usize,
    precision: Precision,
) -> io::Result<()> {
    let version = if families.iter().any(|f| QUERIES.contains(f)) {
        2
    } else {
        1
    };
    let mut maker = Maker::new(out, version, name, seed, count, precision)?;
    for &family in families {
        maker.start(family, seed);
        let m = &mut maker;
        match family {
            "touching" => contact::touching(m),
            "parallel" => contact::parallel(m),
            "coplanar" => contact::coplanar(m),
            "equal" => contact::equal(m),
            "lattice" => contact::lattice(m),
            "round" => form::round(m),
            "thin" => form::thin(m),
            "flat" => form::flat(m),
            "deep" => form::deep(m),
            "spinning" => motion::spinning(m),
            "resting" => motion::resting(m),
            "sliding" => motion::sliding(m),
            "far" => size::far(m),
            "tiny" => size::tiny(m),
            "huge" => size::huge(m),
            "ratios" => size::ratios(m),
            "points" => queries::points(m),
            "meshes" => queries::pairs(m),
            "casts" => queries::casts(m),
            "rays" => queries::rays(m),
            _ => unreachable!("the constants above name the families"),
        }?;
    }
    Ok(())
}

/// The identity rotation.
const STILL: [f64; 4] = [0.0, 0.0, 0.0, 1.0];

/// Returns `10^e`.
fn ten(e: i64) -> f64 {
    10f64.powi(e as i32)
}

/// Returns a signed distance for bodies of size 1: apart or overlapping, from a tenth down to the
/// last bit, or zero.
fn gap(rng: &mut Rng) -> f64 {
    match rng.below(8) {
        0 => 0.0,
        1 => rng.range(0.1, 2.0),
        2..=4 => ten(-rng.int(1, 15)) * rng.range(1.0, 10.0),
        _ => -ten(-rng.int(2, 15)) * rng.range(1.0, 10.0),
    }
}

/// Returns one of the 24 rotations of the cube; most are exact.
fn quarter_turns(rng: &mut Rng) -> [f64; 4] {
    let h = 0.5f64.sqrt();
    let axis = rng.below(3);
    let sign = rng.sign();
    match rng.below(4) {
        0 => STILL,
        1 => std::array::from_fn(|k| [if k == axis { sign * h } else { 0.0 }, h][usize::from(k == 3)]),
        2 => std::array::from_fn(|k| f64::from(u8::from(k == axis))),
        _ => std::array::from_fn(|k| if k == axis { 0.5 * sign } else { 0.5 }),
    }
}

/// Returns a box whose sides are multiples of 1/16, so that sums of them are exact.
fn dyadic_box(rng: &mut Rng) -> (Shape, Point) {
    let half = [(); 3].map(|()| rng.int(4, 24) as f64 / 16.0);
    (shapes::cuboid(half), half)
}

/// Returns bodies of size 1 of many kinds.
fn assorted<W: Write>(m: &mut Maker<W>) -> Vec<BodyId> {
    let mut all = m.bodies(3, |r| shapes::sphere(r, 8));
    all.extend(m.bodies(3, |r| shapes::sphere(r, 24)));
    all.extend(m.bodies(2, |r| dyadic_box(r).0));
    for shape in [
        shapes::tetrahedron(),
        shapes::octahedron(),
        shapes::icosahedron(),
        shapes::prism(12, 1.0, 0.5),
    ] {
        all.push(m.body(shape));
    }
    all
}
