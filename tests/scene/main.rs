//! Promise: a scene says of its bodies what brute force over all pairs says, on every frame.

mod calls;
mod effects;
mod lattice;
mod queries;
mod shapes;
mod surfaces;
mod threads;
mod time;
