//! The kinds of queries.

mod convex;
mod curved;
mod parts;
mod plan;
mod points;
mod robots;
mod scenes;
mod surfaces;
mod time;
mod zeros;

use crate::Kind;

/// Distances of the calls of `within`.
const WITHIN: [f64; 4] = [0.0, 0.05, 0.3, 2.0];

/// All kinds: name, seed, and the function that asks. The seed of a kind never changes, and no two
/// kinds have the same.
pub const KINDS: &[(&str, u64, Kind)] = &[
    ("hulls", 1, convex::hulls),
    ("solids", 2, convex::basic_solids),
    ("masses", 3, convex::masses),
    ("pairs", 4, convex::pairs),
    ("cold-pairs", 5, convex::cold_pairs),
    ("hard-pairs", 6, convex::hard_pairs),
    ("exact", 7, convex::exact),
    ("depths", 8, convex::depths),
    ("manifolds", 9, convex::manifolds),
    ("half-spaces", 10, convex::half_spaces),
    ("files", 36, convex::files),
    ("motions", 11, time::motions),
    ("casts", 12, time::casts_of_hulls),
    ("casts-shapes", 13, time::casts_of_shapes),
    ("casts-meshes", 14, time::casts_of_meshes),
    ("casts-surfaces", 15, time::casts_of_surfaces),
    ("plane-normals", 16, time::plane_normals),
    ("continuous", 24, time::continuous_contacts),
    ("curved", 17, curved::curved_pairs),
    ("meshes", 19, parts::meshes),
    ("mesh-contacts", 20, parts::mesh_contacts),
    ("mesh-self", 21, parts::mesh_self),
    ("bending", 22, parts::bending),
    ("faulty-meshes", 23, parts::faulty_meshes),
    ("repairs", 55, parts::repairs),
    ("overlaps", 56, parts::overlaps),
    ("compounds", 25, parts::compounds),
    ("clouds", 44, parts::clouds),
    ("decompositions", 26, parts::decompositions),
    ("any-pair", 29, parts::any_pair),
    ("rays", 30, parts::rays),
    ("points", 45, points::points),
    ("grids", 46, points::grids),
    ("surfaces", 27, surfaces::surfaces),
    ("surfaces-mixed", 28, surfaces::surfaces_mixed),
    ("broad", 31, scenes::boxes),
    ("scenes", 32, scenes::scenes),
    ("spaces", 33, plan::spaces),
    ("arm", 34, plan::arm),
    ("arm-plan", 35, plan::arm_plan),
    ("curves", 47, plan::curves),
    ("ranges", 48, plan::ranges),
    ("receipts", 54, plan::receipts),
    ("timed-obstacles", 49, plan::timed_obstacles),
    ("worlds", 50, plan::worlds),
    ("urdf", 37, robots::urdf),
    ("mjcf", 51, robots::mjcf),
    ("sdformat", 52, robots::sdformat),
    ("meshes-zeros", 38, zeros::meshes_zeros),
    ("meshes-hostile", 39, zeros::meshes_hostile),
    ("broad-zeros", 40, zeros::boxes_zeros),
    ("scenes-zeros", 41, zeros::scenes_zeros),
    ("surfaces-zeros", 42, zeros::surfaces_zeros),
    ("mixed-zeros", 43, zeros::mixed_zeros),
    ("points-zeros", 53, points::points_zeros),
];
