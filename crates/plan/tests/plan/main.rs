//! Promise: what the planner calls free is free at every instant, what it calls blocked is blocked, and paths are made of
//! segments proven free.

mod apart;
mod arm;
mod certify;
mod changes;
mod curves;
mod far;
mod forget;
mod free;
mod hulls;
mod judge;
mod leave;
mod methods;
mod moving;
mod planner;
mod range_worlds;
mod ranges;
mod smooth;
mod spaces;
