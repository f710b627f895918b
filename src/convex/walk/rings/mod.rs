//! Large rings (long face boundaries and large fans of edges at a vertex): the walk jumps along a
//! ring instead of taking an edge per step.
//!
//! Two doors: [`newton_jump`] moves a walk that has taken too many steps, [`predict`] chooses the
//! start of the next query. Only bodies with a face or a fan of more than
//! [`LARGE`](crate::polyhedron::topology::LARGE) edges ever come here.

mod cholesky;
mod curve;
pub(crate) mod newton_jump;
pub(crate) mod predict;
