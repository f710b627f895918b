//! Promise: the contact state of meshes within rounding of contact is the exact one, in either
//! order and after any queries, and the witness points of meshes in contact are one point.
#![cfg(feature = "exact")]

use super::{mesh, relative, shapes, size};
use lin_canny::{ContactState, Mesh, PairTracker};
use truth::pose::{add, norm, scale, sub};
use truth::rng::Rng;
use truth::soups::Soup;
use truth::{Pose, exact_meshes, rational};

/// Returns a tetrahedron that is no sliver.
fn tetrahedron(rng: &mut Rng) -> Soup {
    loop {
        let points: Vec<_> = (0..4).map(|_| rng.in_ball()).collect();
        let [a, b, c] = [1, 2, 3].map(|k| sub(points[k], points[0]));
        if truth::pose::dot(truth::pose::cross(a, b), c) > 0.01 {
            let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
            return Soup::new(points, triangles);
        }
    }
}

/// Returns whether the middle of a body's box is more than two half diagonals from the origin of its
/// frame, along an axis. Such a mesh stores its vertices relative to that middle, and may count as
/// touching.
fn is_far(soup: &Soup) -> bool {
    let ends = [0, 1, 2].map(|k| {
        let each = || soup.points.iter().map(|p| p[k]);
        [
            each().fold(f64::INFINITY, f64::min),
            each().fold(f64::NEG_INFINITY, f64::max),
        ]
    });
    let half = 0.5 * norm(ends.map(|[low, high]| high - low));
    ends.iter()
        .any(|[low, high]| (0.5 * low + 0.5 * high).abs() > 2.0 * half)
}

/// Returns a pose within a few roundings of contact.
fn pose_in_contact(a: &Mesh, b: &Mesh, rng: &mut Rng) -> Pose {
    let away = scale(rng.unit(), 3.0);
    let mut pose = Pose::turn(rng.unit(), 3.0 * rng.in_ball()[0], away);
    for _ in 0..2 {
        let found = PairTracker::new().closest(a, b, &relative(&pose));
        let short = found.distance + f64::from(rng.below(41) as i32 - 20) * 5e-15;
        pose.t = sub(pose.t, scale(found.normal.into_inner().into(), short));
        if found.state != ContactState::Separated {
            break;
        }
    }
    pose
}

#[derive(Debug, Default)]
struct Tally {
    apart: usize,
    meeting: usize,
    /// Answers that are not decided.
    open: usize,
    /// The greatest distance of witness points beyond the upper bound, in units of L.
    widest: f64,
}

impl Tally {
    /// Judges a pair in both orders, cold and after other queries.
    ///
    /// Bodies with many triangles in contact, or far from their origins, may count as touching.
    fn judge(&mut self, has_few: bool, [x, y]: [&Soup; 2], [a, b]: [&Mesh; 2], rng: &mut Rng) {
        let pose = pose_in_contact(a, b, rng);
        let there = relative(&pose);
        let (square, _) = exact_meshes::apart(x, y, &pose);
        let distance = rational::sqrt(&square).0;
        let wanted = if square.is_zero() {
            self.meeting += 1;
            ContactState::Overlapping
        } else {
            self.apart += 1;
            ContactState::Separated
        };
        let cold = PairTracker::new().closest(a, b, &there);
        let swapped = PairTracker::new().closest(b, a, &there.swapped());
        let mut warm = PairTracker::new();
        for k in [1.0, 1e-2, 1e-9] {
            let t = add(pose.t, scale(rng.in_ball(), k));
            warm.closest(a, b, &relative(&pose.moved_to(t)));
        }
        let warm = warm.closest(a, b, &there);
        for (o, how) in [(cold, "cold"), (swapped, "swapped"), (warm, "warm")] {
            let what = || format!("{how}: {o:?}, exactly {distance:e} at {pose:?}");
            let is_open = !has_few && o.state == ContactState::Touching;
            assert!(o.state == wanted || is_open, "{wanted}, {}", what());
            self.open += usize::from(is_open);
            assert!(o.lower <= distance && distance <= o.upper, "{}", what());
            let mut points = [o.point_on_a.into(), o.point_on_b.into()];
            if how == "swapped" {
                points.reverse();
            }
            let gap = norm(sub(pose.apply(points[1]), points[0]));
            let beyond = (gap - o.upper) / size(x, y, &pose);
            assert!(beyond <= 1e-13, "{beyond:e}: {}", what());
            self.widest = self.widest.max(beyond);
        }
    }
}

fn tetrahedra(count: usize, seed: u64) {
    let (mut rng, mut tally) = (Rng::new(seed), Tally::default());
    for _ in 0..count {
        let soups = [(); 2].map(|()| tetrahedron(&mut rng));
        let meshes = soups.each_ref().map(mesh);
        let is_near = !soups.iter().any(is_far);
        tally.judge(is_near, soups.each_ref(), meshes.each_ref(), &mut rng);
    }
    println!("{tally:?}");
    assert!(tally.apart.min(tally.meeting) > count / 20, "{tally:?}");
}

#[test]
fn tetrahedra_in_contact_have_one_state_and_one_point() {
    tetrahedra(1000, 61);
}

#[test]
#[ignore = "20,000 pairs, minutes: cargo test --release --all-features --test meshes twenty_thousand_tetrahedra -- --ignored --nocapture"]
fn twenty_thousand_tetrahedra_in_contact_have_one_state_and_one_point() {
    tetrahedra(20_000, 62);
}

#[test]
fn meshes_in_contact_have_one_state_and_one_point() {
    let soups = shapes();
    let meshes: Vec<_> = soups.iter().map(mesh).collect();
    let (mut rng, mut tally) = (Rng::new(63), Tally::default());
    for _ in 0..40 {
        let [i, j] = [(); 2].map(|()| rng.below(soups.len()));
        tally.judge(false, [&soups[i], &soups[j]], [&meshes[i], &meshes[j]], &mut rng);
    }
    println!("{tally:?}");
    assert!(tally.apart.min(tally.meeting) > 2, "{tally:?}");
}
