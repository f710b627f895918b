//! Pairs of curved shapes at powers of two: bit for bit where all are solved in the caller's unit,
//! and where all are solved in a scaled unit.

use lin_canny::nalgebra::{Isometry3, Quaternion, UnitQuaternion, Vector3};
use lin_canny::{ContactState, Geometry, PairTracker, RelativePose, Shape};
use truth::rng::Rng;

/// A drawn pair: kinds, sizes, a rotation and a translation.
struct Pair {
    kinds: [usize; 2],
    measures: [[f64; 3]; 2],
    rotation: UnitQuaternion<f64>,
    translation: [f64; 3],
}

impl Pair {
    fn new(rng: &mut Rng) -> Self {
        let [x, y, z, w] = if rng.chance(0.3) {
            [0.0, 0.0, 0.0, 1.0]
        } else {
            rng.quat()
        };
        Self {
            kinds: [0; 2].map(|_| rng.below(3)),
            measures: [0; 2].map(|_| [0; 3].map(|_| rng.range(0.2, 1.0))),
            rotation: UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z)),
            translation: [0; 3].map(|_| rng.range(-2.0, 2.0)),
        }
    }

    /// Returns contact state, distance and both bounds at a scale, in the unit of the drawn pair.
    fn answer(&self, exponent: i32) -> (ContactState, [f64; 3]) {
        let (unit, back) = (2f64.powi(exponent), 2f64.powi(-exponent));
        let shape = |k: usize| {
            let [x, y, z] = self.measures[k].map(|x| x * unit);
            let shape = match self.kinds[k] {
                0 => Shape::ellipsoid(Vector3::new(x, y, z)),
                1 => Shape::cylinder(x, y),
                _ => Shape::cone(x, y),
            };
            Geometry::from(shape.expect("measures of a shape"))
        };
        let place = Vector3::from(self.translation.map(|x| x * unit));
        let pose = RelativePose::from_isometry(&Isometry3::from_parts(place.into(), self.rotation)).expect("a pose");
        let told = PairTracker::new().closest(&shape(0), &shape(1), &pose).outcome;
        (told.state, [told.distance, told.lower, told.upper].map(|x| x * back))
    }
}

#[test]
fn curved_pairs_scale_bit_for_bit() {
    let mut rng = Rng::new(407);
    for k in 0..300 {
        let pair = Pair::new(&mut rng);
        for (first, others) in [
            (0, [-136, -60, 60, 136]),
            (250, [150, 172, 190, 300]),
            (-250, [-150, -172, -190, -300]),
        ] {
            let told = pair.answer(first);
            for exponent in others {
                assert_eq!(pair.answer(exponent), told, "{k}: 2^{exponent} beside 2^{first}");
            }
        }
    }
}
