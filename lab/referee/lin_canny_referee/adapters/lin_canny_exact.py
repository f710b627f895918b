"""lin-canny with exact answers: `Tracker::closest_exact`, by the program `grade` (`cargo build --release -p race
--bin grade`), which must be on the path."""

from ..adapter import Adapter, Tolerance


class Engine(Adapter):
    package = "lin-canny"
    version = "0.1.0"
    options = {"default": "a tracker along each motion"}
    tolerance = Tolerance(0.0, 1e-12)
    program = ["grade", "--level", "exact"]
    code = """// let h = |v: Vec<Point3<f64>>| ConvexPolyhedron::from_points(&v); let (a, b) = (h({a})?, h({b})?);
// let x = |t, q| Isometry3::from_parts(t, q); let pose = RelativePose::new(&x({ta}, {qa}), &x({tb}, {qb}))?;
// Tracker::new().closest_exact(&a, &b, &pose).distance"""
