//! The cell: bodies of a robot, attached objects and obstacles, and what each pair must keep.

pub(crate) mod attached_object;
mod excluded_pairs;
mod margins_and_paddings;
pub(crate) mod mesh_hull;
pub(crate) mod range_body;
pub(crate) mod world;
