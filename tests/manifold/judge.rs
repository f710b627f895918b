//! Properties of every manifold.

use lin_canny::{ConvexPolyhedron, FaceId, Feature, Manifold, ManifoldOptions, Outcome, Solver, Tracker};
use truth::Point;
use truth::motion::Frame;
use truth::pose::{cross, dot, norm, scale, sub, unit};
use truth::support;

/// Returns the distance of a point from a feature of its body.
fn off(body: &ConvexPolyhedron, feature: Feature, p: Point) -> f64 {
    let at = |v| -> Point { body.vertex(v).expect("a vertex of the body").coords.into() };
    match feature {
        Feature::Vertex(v) => norm(sub(p, at(v))),
        Feature::Edge(e) => {
            let [q, r] = body.edge_vertices(e).expect("an edge of the body").map(at);
            let (u, w) = (sub(r, q), sub(p, q));
            let t = (dot(u, w) / dot(u, u)).clamp(0.0, 1.0);
            norm(sub(w, scale(u, t)))
        }
        // One face represents those that are coplanar up to rounding.
        Feature::Face(f) => {
            let n = body.face_plane(f).expect("a face of the body").0;
            let alike = |g: &FaceId| {
                body.face_plane(*g)
                    .is_some_and(|(m, _)| (m.into_inner() - n.into_inner()).norm() < 1e-12)
            };
            let off = |g| {
                let (n, offset) = body.face_plane(g).expect("a face of the body");
                let n: Point = n.into_inner().into();
                let rim: Vec<Point> = body.face_vertices(g).map(at).collect();
                let beside = |k: usize| {
                    let (q, r) = (rim[k], rim[(k + 1) % rim.len()]);
                    dot(unit(cross(sub(r, q), n)), sub(p, q))
                };
                (0..rim.len()).map(beside).fold((dot(n, p) - offset).abs(), f64::max)
            };
            body.faces().filter(alike).map(off).fold(f64::INFINITY, f64::min)
        }
    }
}

/// Judges a manifold that was computed for this frame; returns the outcome that it was made from.
pub(crate) fn judge(
    a: &ConvexPolyhedron,
    b: &ConvexPolyhedron,
    frame: &Frame,
    m: &Manifold,
    o: &ManifoldOptions,
    what: &str,
) -> Outcome {
    let size = support::size(a, b, frame);
    let pose = support::relative(frame);
    let outcome = Tracker::new().closest(a, b, &pose);
    let told = || format!("{what}: {m:?}\n{outcome:?}\n{frame:?}");
    // In A's frame, where the offset of both cancels.
    let n: Point = m.normal().into_inner().into();
    let a_from_b = frame.relative();
    assert!(m.points().len() <= o.max_points, "{}", told());
    if outcome.lower > o.prediction {
        assert!(m.points().is_empty(), "{}", told());
        return outcome;
    }
    assert!(!m.points().is_empty(), "{}", told());
    // Edges that are parallel up to the allowed angle are not exactly opposite each other.
    let beside = m.features().is_some_and(|f| support::kinds(f) == (1, 1));
    // Nor more so than the witnesses.
    let witnesses = {
        let (p, q) = (outcome.point_on_a.coords.into(), outcome.point_on_b.coords.into());
        let between = sub(a_from_b.apply(q), p);
        norm(sub(between, scale(n, outcome.distance)))
    };
    for p in m.points() {
        let (on_a, on_b): (Point, Point) = (p.point_on_a.coords.into(), p.point_on_b.coords.into());
        assert!(support::are_of(p.features, a, b), "{}", told());
        let (from_a, from_b) = (off(a, p.features.a, on_a), off(b, p.features.b, on_b));
        // If rounding has split faces, the features that a solver reports need not contain its
        // witnesses.
        let of_answer = p.features == outcome.features && outcome.solver >= Solver::Gjk;
        assert!(
            of_answer || from_a.max(from_b) <= 1e-13 * size,
            "{from_a:e} {from_b:e} {p:?}\n{}",
            told()
        );
        let between = sub(a_from_b.apply(on_b), on_a);
        assert!((dot(between, n) - p.separation).abs() <= 1e-13 * size, "{}", told());
        let aside = sub(between, scale(n, p.separation));
        assert!(
            beside || norm(aside) <= witnesses + 1e-13 * size,
            "{:e} {}",
            norm(aside),
            told()
        );
        assert!(p.separation >= m.lower() - 1e-14 * size, "{}", told());
        assert!(p.separation <= o.prediction.max(m.upper()) + 1e-14 * size, "{}", told());
    }
    let deepest = m.deepest().expect("not empty").separation;
    assert!(deepest >= outcome.lower - 1e-14 * size, "{deepest:e} {}", told());
    assert!(deepest <= outcome.upper + 1e-14 * size, "{deepest:e} {}", told());
    for (k, p) in m.points().iter().enumerate() {
        assert!(m.points()[..k].iter().all(|q| q.id != p.id), "{}", told());
    }
    outcome
}
