//! Deliberately hard bodies, as points and, for bodies with natural faces, faces.
//!
//! Bodies are centred at the origin with a size of about 1 unless stated otherwise. Given faces are
//! counter-clockwise from outside; if `faces` is empty, the hull has to find them.

mod hard;
mod meshes;
mod solids;

pub use hard::*;
pub use meshes::*;
pub use solids::*;

use crate::rng::Rng;
use crate::{Face, Point, Pose, brute_hull};

/// A named body.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// Name, for messages.
    pub name: String,
    /// Points in the body's frame; not all need be extreme.
    pub points: Vec<Point>,
    /// Faces; may be empty.
    pub faces: Vec<Face>,
}

impl Shape {
    /// Returns the body of points and faces.
    pub fn new(name: impl Into<String>, points: Vec<Point>, faces: Vec<Face>) -> Self {
        Self {
            name: name.into(),
            points,
            faces,
        }
    }

    /// Returns the body that is the hull of the points.
    pub fn hull(name: impl Into<String>, points: Vec<Point>) -> Self {
        Self::new(name, points, Vec::new())
    }

    /// Returns the body with exactly computed faces; for a few points only.
    pub fn solved(mut self) -> Self {
        self.faces = brute_hull::faces(&self.points);
        self
    }

    /// Returns the body with moved (and rounded) points and the same faces, which are no longer
    /// exactly planar.
    pub fn moved(mut self, pose: &Pose) -> Self {
        self.points.iter_mut().for_each(|p| *p = pose.apply(*p));
        self
    }

    /// Returns the body in another unit of length, with the same faces.
    pub fn scaled(self, by: f64) -> Self {
        self.stretched([by; 3])
    }

    /// Returns the body stretched along the axes by positive factors, with the same faces.
    pub fn stretched(mut self, by: Point) -> Self {
        self.points
            .iter_mut()
            .for_each(|p| *p = std::array::from_fn(|i| p[i] * by[i]));
        self
    }

    /// Returns the body with its points in random order.
    pub fn shuffled(mut self, rng: &mut Rng) -> Self {
        let mut order: Vec<usize> = (0..self.points.len()).collect();
        rng.shuffle(&mut order); // order[new] = old
        let mut place = vec![0; order.len()];
        order.iter().enumerate().for_each(|(new, &old)| place[old] = new as u32);
        self.points = order.iter().map(|&old| self.points[old]).collect();
        self.faces.iter_mut().flatten().for_each(|i| *i = place[*i as usize]);
        self
    }

    /// Returns the faces, cut into triangles by fans.
    pub fn triangles(&self) -> Vec<[u32; 3]> {
        triangles(&self.faces)
    }
}

/// Returns faces cut into triangles by a fan from each first vertex.
pub fn triangles(faces: &[Face]) -> Vec<[u32; 3]> {
    faces
        .iter()
        .flat_map(|f| f[1..].windows(2).map(|w| [f[0], w[0], w[1]]))
        .collect()
}

/// Returns a random body of at most 16 points with its faces, for the exact oracle.
pub fn small(rng: &mut Rng) -> Shape {
    loop {
        let n = 4 + rng.below(10);
        let thin = rng.log_range(1e-9, 1.0);
        let shape = match rng.below(12) {
            0 => ellipsoid(rng, n, [1.0, 0.5, 0.25]),
            1 => sliver(rng, n, thin),
            2 => needle(rng, n, thin),
            3 => lattice(rng, n, 2),
            4 => roof(thin),
            5 => pyramid_lid(thin),
            6 => prism(3 + rng.below(5), 1.0, 0.7),
            7 => cone(3 + rng.below(9), 1.0, 0.5),
            8 => cuboid([1.0, rng.range(0.2, 1.0), thin]),
            9 => platonic()[[0, 1, 2, 4][rng.below(4)]].clone(),
            _ => sphere(rng, n),
        };
        let solved = shape.solved();
        if !solved.faces.is_empty() {
            return solved;
        }
    }
}

/// Returns one body of each family, from 4 to about 1000 points.
pub fn catalogue(seed: u64) -> Vec<Shape> {
    let mut r = Rng::new(seed);
    let mut all = Vec::from(platonic());
    all.extend([
        cuboid([1.0, 0.5, 1e-6]),
        prism(6, 1.0, 0.3),
        prism(256, 1.0, 0.5),
        cone(5, 1.0, 1.0),
        cone(512, 1.0, 0.4),
    ]);
    all.extend([4, 16, 128, 1024].map(|n| sphere(&mut r, n)));
    all.extend([1e-3, 1e-6].map(|z| ellipsoid(&mut r, 64, [1.0, 0.7, z])));
    all.extend([1e-3, 1e-6, 1e-9, 1e-12].map(|z| sliver(&mut r, 24, z)));
    all.extend([1e-3, 1e-6, 1e-9].map(|z| needle(&mut r, 24, z)));
    for h in [1e-3, 1e-6, 1e-9, 1e-12, 1e-15] {
        all.extend([roof(h), pyramid_lid(h), cap(12, 3, h), dome(6, h)]);
    }
    all.extend([
        lattice(&mut r, 30, 2),
        lattice(&mut r, 200, 5),
        grid(4),
        ball(&mut r, 300),
    ]);
    all.extend([1e-2, 1e-6, 1e-9].map(|c| chamfered([1.0, 0.8, 0.6], c)));
    all.extend([icosphere(1), icosphere(3)]);
    let clean = [cube(), prism(12, 1.0, 0.5), icosphere(1)];
    all.extend(clean.map(|s| dirty(&s, &mut r)));
    all
}

#[cfg(test)]
mod tests;
