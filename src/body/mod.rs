//! Convex bodies: polyhedra, and cores with a rounding radius.

pub mod polyhedron;
pub mod shape;
