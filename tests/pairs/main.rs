//! Promise: outcomes of two bodies are correct and proven for every query.

mod corpus;
mod features;
mod geometries;
mod gradient;
mod half_space;
mod large;
mod metamorphic;
mod motions;
mod oracle;
mod parry;
mod predicates;
mod protocols;
mod queries;
mod rounded;
mod seeds;
mod subnormal;
