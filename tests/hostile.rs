//! Files that were tampered with are refused, or hold bodies and poses as good as any (feature `serde`).
#![cfg(feature = "serde")]

#[path = "support/bytes.rs"]
#[allow(dead_code, unreachable_pub)]
mod bytes;

use lab::rng::Rng;
use lab::shapes;
use lin_canny::nalgebra::{Isometry3, Point3, Vector3};
use lin_canny::{ConvexPolyhedron, RelativePose, Tracker};

/// One to four bytes of a text changed to others that JSON knows.
fn tampered(text: &str, rng: &mut Rng) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..1 + rng.below(4) {
        let at = rng.below(bytes.len());
        bytes[at] = *rng.pick(b"0123456789.-e,[]{}\"ABVFnull");
    }
    String::from_utf8(bytes).unwrap_or_default()
}

#[test]
fn tampered_files_do_no_harm() {
    let mut rng = Rng::new(81);
    let shape = shapes::small(&mut rng);
    let points: Vec<_> = shape.points.iter().map(|&p| Point3::from(p)).collect();
    let a = ConvexPolyhedron::from_points(&points).unwrap();
    let pose = Isometry3::new(Vector3::new(2.0, 0.5, -1.0), Vector3::new(0.1, 0.2, 0.3));
    let pose = RelativePose::from_isometry(&pose).unwrap();
    let mut pair = Tracker::new();
    pair.closest(&a, &a, &pose);
    let body_text = serde_json::to_string(&a).unwrap();
    let pose_text = serde_json::to_string(&pose).unwrap();
    let pair_text = serde_json::to_string(&pair).unwrap();
    assert_eq!(serde_json::from_str::<Tracker>(&pair_text).unwrap(), pair);
    assert_eq!(serde_json::from_str::<RelativePose>(&pose_text).unwrap(), pose);
    let (mut read, mut refused) = ([0; 3], [0; 3]);
    for _ in 0..6000 {
        let body = serde_json::from_str::<ConvexPolyhedron>(&tampered(&body_text, &mut rng));
        let moved = serde_json::from_str::<RelativePose>(&tampered(&pose_text, &mut rng));
        let tracker = serde_json::from_str::<Tracker>(&tampered(&pair_text, &mut rng));
        for (k, ok) in [body.is_ok(), moved.is_ok(), tracker.is_ok()].into_iter().enumerate() {
            *(if ok { &mut read[k] } else { &mut refused[k] }) += 1;
        }
        let body = body.unwrap_or_else(|_| a.clone());
        bytes::query(&a, &body, &moved.unwrap_or(pose), &mut tracker.unwrap_or_default(), 0.5);
    }
    assert!(read.iter().chain(&refused).all(|&n| n > 20), "{read:?} {refused:?}");
}
