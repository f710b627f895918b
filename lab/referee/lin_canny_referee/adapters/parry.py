"""parry (Rust crate parry3d-f64): `query::contact` at any distance, in double precision, by the program `grade` of
lin-canny (`cargo build --release -p race --bin grade`), which must be on the path. Careful: the given faces instead of
parry's own hull. It documents no tolerance of a distance."""

from ..adapter import Adapter, Tolerance


class Engine(Adapter):
    package = "parry3d-f64"
    version = "0.31"
    options = {"default": "its own hulls", "careful": "the given faces"}
    tolerance = Tolerance(1e-6, 1e-6)
    program = ["grade", "--level", "parry"]
    careful_program = ["--shapes", "mesh"]
    code = """// {careful}: let h = |v: Vec<Vector>, f: Vec<[u32; 3]>| ConvexPolyhedron::from_convex_hull(&v) or from_convex_mesh(v, &f);
// let (a, b) = (h({a}, {fa}), h({b}, {fb})); let x = |t, q| Pose::from_parts(t, Rotation::from_xyzw(q));
// parry3d_f64::query::contact(&x({ta}, {qa}), &a, &x({tb}, {qb}), &b, f64::MAX)"""
