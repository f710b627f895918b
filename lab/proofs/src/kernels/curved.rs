//! Support points of curved shapes, and mixtures of them.

use crate::factor::Positive;
use crate::number::Number;

/// `shape::ellipsoid::of_branch`: by coordinates, the support point of an ellipsoid along a direction.
pub fn on_ellipsoid<P: Positive>(axes: &[P; 3], n: &[P; 3]) -> [P; 3] {
    let turned: [P; 3] = std::array::from_fn(|k| axes[k].clone() * n[k].clone());
    let [x, y, z] = turned.clone().map(P::squared);
    let inverse = P::exact(1.0) / (x + y + z).root();
    std::array::from_fn(|k| axes[k].clone() * turned[k].clone() * inverse.clone())
}

/// `shape::cylinder::of_circle`: by its two coordinates, the support point of a circle.
pub fn on_circle<P: Positive>(radius: P, n: &[P; 2]) -> [P; 2] {
    let [x, y] = n.clone().map(P::squared);
    let s = radius / (x + y).root();
    n.clone().map(|n| n * s.clone())
}

/// `shape::cone::support`: whether the apex is no lower than the rim, from the radius, half the height, and the parts of
/// the direction across the axis and along it: the height of the apex, and that of the rim.
pub fn apex_and_rim<N: Number>([radius, half]: [N; 2], [across, along]: [N; 2]) -> [N; 2] {
    [half * along, radius * across - half * along]
}

/// `smooth::best_bounds::mixture`: a coordinate of points by their weights, and the sum of these, which divides it.
pub fn mixed<N: Number>(points: &[N], weights: &[N]) -> [N; 2] {
    let none = [N::exact(0.0); 2];
    points
        .iter()
        .zip(weights)
        .fold(none, |[total, sum], (p, w)| [total + *p * *w, sum + *w])
}
