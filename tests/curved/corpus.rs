//! Every line of `corpus.txt`, cold and warm, in both orders.

use super::Mix;
use super::suites::sampled;
use lin_canny::shape::Core;
use lin_canny::{ContactState, Outcome, PairTracker, RelativePose, Shape};
use truth::curved::{Kind, Place, parse};
use truth::rng::Rng;

/// Returns a shape without its rounding, in our form and in the judge's.
fn core(shape: &Shape) -> (Shape, Kind) {
    let kind = match shape.core() {
        Core::Polyhedron(body) => Kind::Hull(body.vertex_points().map(|p| p.coords.into()).collect()),
        Core::Ellipsoid(core) => Kind::Ellipsoid(core.semi_axes().into()),
        Core::Cylinder(core) => Kind::Cylinder(core.half_height(), core.radius()),
        Core::Cone(core) => Kind::Cone(core.half_height(), core.radius()),
        other => panic!("{other:?} is new"),
    };
    (kind.shape(), kind)
}

fn place(pose: &RelativePose) -> Place {
    let (_, b) = pose.poses();
    let q = b.rotation.coords;
    Place::new([q.x, q.y, q.z, q.w], b.translation.vector.into())
}

fn meet(o: &Outcome, p: &Outcome, line: &str) {
    let slack = 1e-13 * (o.distance.abs() + p.distance.abs());
    assert!(o.lower <= p.upper + slack, "{line}\n{o:?}\n{p:?}");
    assert!(p.lower <= o.upper + slack, "{line}\n{o:?}\n{p:?}");
}

#[test]
fn every_line_is_answered() {
    let text = include_str!("corpus.txt");
    let lines = text.lines().filter(|l| !l.is_empty() && !l.starts_with('#'));
    let (mut mix, mut rng, mut classes) = (Mix::default(), Rng::new(2170), [0; 4]);
    for line in lines {
        let pair = parse::pair(line).expect(line);
        let ((a, first), (b, second)) = (core(&pair.a), core(&pair.b));
        let at = place(&pair.pose);
        let o = PairTracker::new().closest(&a, &b, &pair.pose);
        let size = at.size(&first, &second);
        assert_ne!(o.state, ContactState::Undecided, "{line} {o:?}");
        if matches!((a.core(), b.core()), (Core::Polyhedron(_), Core::Polyhedron(_))) {
            // Two polyhedra are judged elsewhere.
        } else if o.state == ContactState::Separated {
            mix.judge(&first, &second, &at, &o);
        } else {
            let s = sampled(&first, &second, &at, &mut rng);
            assert!(s <= o.upper + 1e-14 * size, "{line}: {s} {o:?}");
            assert!(o.upper - o.lower <= 3e-6 * size, "{line}: {o:?}");
        }
        classes[o.state as usize] += 1;
        // Rounded: both radii subtracted; warm, swapped, and after another pair.
        let mut tracker = PairTracker::new();
        let rounded = tracker.closest(&pair.a, &pair.b, &pair.pose);
        let radii = pair.a.rounding_radius() + pair.b.rounding_radius();
        let slack = 1e-15 * (size + radii);
        assert!(rounded.lower <= o.upper - radii + slack, "{line} {o:?} {rounded:?}");
        assert!(o.lower - radii <= rounded.upper + slack, "{line} {o:?} {rounded:?}");
        let again = tracker.closest(&pair.a, &pair.b, &pair.pose);
        let swapped = tracker.closest(&pair.b, &pair.a, &pair.pose.swapped());
        for other in [again, swapped] {
            assert_eq!(other.state, rounded.state, "{line} {rounded:?} {other:?}");
            meet(&other, &rounded, line);
        }
    }
    mix.print("corpus", "");
    println!("classes {classes:?}");
    assert!(mix.widest <= 1e-13, "{}", mix.widest);
    assert!(classes[ContactState::Separated as usize] > 30, "{classes:?}");
    assert!(classes[ContactState::Overlapping as usize] > 3, "{classes:?}");
}
