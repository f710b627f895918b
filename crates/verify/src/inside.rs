//! Whether one body could be inside the other.
//!
//! **Lemma 12.** A body with faces is a solid: triangles, and the points about which they wind. Let the
//! surfaces of A and B never touch during a motion, and their hulls be apart at one time of it. How
//! often the surface of A winds about a point of B cannot change while the point does not meet the
//! surface, and at that time it is zero; the same holds with A and B exchanged. So no point of a
//! surface is ever inside the other body. A point of both bodies would have, on a way to infinity, a
//! first point of a surface, which is inside the other body or on its surface. So there is none. Legs
//! are one motion, as each starts where the one before ends; each two configurations of a range are of
//! a motion in it. A body with parts has its inside stated.

use std::collections::BTreeSet;

use crate::claim::{all_parts, radii};
use crate::json::Json;
use crate::motion::Span;
use crate::plane::Plane;
use crate::real::Real;
use crate::scene::Scene;
use crate::{Stop, half_space};

/// The pairs of which one body is a solid.
#[derive(Default)]
pub(crate) struct Inside {
    /// Their hulls are apart at some time.
    hulls_apart: BTreeSet<(usize, usize)>,
    /// Groups of their parts are apart, not their hulls.
    by_parts: BTreeSet<(usize, usize)>,
}

impl Inside {
    /// Adds evidence about a pair.
    pub(crate) fn add(&mut self, scene: &Scene, pair: (usize, usize), is_of_hulls: bool) {
        if !scene.bodies[pair.0].solid && !scene.bodies[pair.1].solid {
            return;
        }
        let list = if is_of_hulls {
            &mut self.hulls_apart
        } else {
            &mut self.by_parts
        };
        list.insert(pair);
    }

    /// Reads a line: the plane that must hold at its time.
    pub(crate) fn read(scene: &Scene, whole: Span, line: &Json) -> Result<Plane, Stop> {
        line.only(&["outside", "at", "normal"])?;
        let (pair, time) = (scene.pair(line.get("outside")?)?, line.get("at")?.real()?);
        let normal = line.get("normal")?.reals::<3>()?.map(Real::exact);
        half_space::refuse(scene, pair)?;
        scene.must_prove(pair)?;
        if !(whole.from..=whole.until).contains(&time) {
            return Stop::fails(format!("{}: a time outside of the interval", scene.names(pair)));
        }
        Ok(Plane {
            pair,
            some: [None, None],
            span: Span::at(time),
            kept: radii(scene, pair, all_parts(scene, pair)),
            normal,
            spin: None,
            floor: None,
        })
    }

    /// Returns the pairs of which one body could be inside the other.
    pub(crate) fn not_looked_at(&self) -> impl Iterator<Item = (usize, usize)> {
        self.by_parts.difference(&self.hulls_apart).copied()
    }
}
