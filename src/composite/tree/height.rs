//! Heights of the nodes of a tree along a direction.

use nalgebra::Vector3;

use crate::base::num::extremes::Extremes;
use crate::base::num::scalar::sqrt;
use crate::composite::tree::Tree;

/// Returns a vector divided by its length if the length is near one.
pub(in crate::composite) fn unit(v: &Vector3<f64>) -> Option<Vector3<f64>> {
    let square = v.norm_squared();
    (square > 0.5 && square < 2.0).then(|| v / sqrt(square))
}

/// Returns an upper bound of the height along `n` of all points below a node, in stored units of
/// the body.
pub(in crate::composite) fn height(tree: &Tree, node: u32, n: &Vector3<f64>) -> f64 {
    let b = &tree.boxes[node as usize];
    let (unit, half) = (tree.unit(), b.half());
    let centre = tree.centre + b.centre() * unit;
    let of_box = |n: &Vector3<f64>| {
        let [x, y, z] = [0, 1, 2].map(|k| (b.axis(k).dot(n) * half[k]).abs());
        n.dot(&centre) + (x + y + z) * unit
    };
    let Some(slab) = tree.slab(node) else { return of_box(n) };
    let part = |k: usize, along: f64| along * if along > 0.0 { slab.high[k] } else { slab.low[k] };
    let [x, y, s] = slab.axes.map(|a| a.dot(n));
    // n = s m + rest with the normal m: the slab bounds what m contributes, the box the rest, which
    // is next to nothing if n is m. The slab alone is better for its own node.
    let top = part(2, s);
    let rest = of_box(&(n - slab.axes[2] * s));
    top + rest.smaller(part(0, x) + part(1, y) + slab.doubt)
}
