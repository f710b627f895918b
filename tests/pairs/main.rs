//! Promise: answers about two bodies are right, and proven, however they are asked for.

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
mod rounded;
mod seeds;
mod subnormal;
