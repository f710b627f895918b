//! The highest point of a surface along a direction, in an interval: branch and bound by control
//! nets.
//!
//! The hull of a net contains its part of the surface, so no point is higher than the highest
//! control point. The corners of a net are points of the surface. Each split of a node makes the
//! interval of a smooth part about four times narrower.

use alloc::collections::BinaryHeap;
use core::cmp::Ordering;
use nalgebra::Vector3;

use super::bezier_surface::BezierSurface;
use super::tree::{Grown, Nodes};
use crate::base::num::extremes::{Bounded, Extremes};
use crate::base::tolerance::HEIGHT;
use crate::pair::location::WitnessLocation;

/// A point of a surface that is about the highest along a direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfaceTop {
    pub(crate) point: Vector3<f64>,
    pub(crate) location: WitnessLocation,
    /// No point of the surface is higher by more than this, up to the rounding of heights.
    pub(crate) excess: f64,
    /// The position error of the point.
    pub(crate) error: f64,
}

/// A node, ordered by the upper bound of its heights.
struct Entry(f64, u32);

impl PartialEq for Entry {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Entry {}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0).then(other.1.cmp(&self.1))
    }
}

impl BezierSurface {
    /// Returns the radius about the origin that scales the errors of points.
    pub(crate) fn reach(&self) -> f64 {
        self.reach
    }

    /// Returns a point that is the highest along a unit direction up to `width`, or after `splits`
    /// splits the best point found.
    pub(crate) fn top(&self, n: &Vector3<f64>, width: f64, splits: usize) -> SurfaceTop {
        let mut grown = Grown::default();
        let mut nodes = Nodes::new(&self.tree, &mut grown);
        let mut best = SurfaceTop {
            point: Vector3::zeros(),
            location: WitnessLocation::on_patch(0, [0.0; 2]),
            excess: 0.0,
            error: 0.0,
        };
        let mut highest = f64::NEG_INFINITY;
        let mut heap = BinaryHeap::new();
        let mut weigh = |nodes: &Nodes, id: u32| {
            let (node, net) = (nodes.node(id), nodes.net(id));
            let high = |k: usize| n.dot(&net.point(k));
            if !node.is_group() {
                let ([p, q], [u, v]) = (node.degrees, node.domain());
                for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    let k = i * p * (q + 1) + j * q;
                    if high(k) > highest {
                        highest = high(k);
                        best.point = net.point(k);
                        best.location = WitnessLocation::on_patch(node.patch(), [u[i], v[j]]);
                        best.error = node.error;
                    }
                }
            }
            let top = (0..node.count as usize).map(high).fold(f64::NEG_INFINITY, f64::larger);
            (top + node.error + HEIGHT * node.reach, highest)
        };
        let (mut bound, mut known) = weigh(&nodes, 0);
        heap.push(Entry(bound, 0));
        let mut left = splits;
        while let Some(Entry(top, id)) = heap.peek() {
            bound = *top;
            let is_group = nodes.node(*id).is_group();
            let is_done = bound - known <= width || !nodes.node(*id).can_split() || left == 0;
            if is_done && !is_group {
                break;
            }
            left -= usize::from(!is_group);
            let id = *id;
            heap.pop();
            let child = nodes.split(id);
            for half in [child, child + 1] {
                let (top, highest) = weigh(&nodes, half);
                known = highest;
                // A bound of a half may be larger than that of the whole by rounding.
                heap.push(Entry(top.smaller(bound), half));
            }
        }
        SurfaceTop {
            excess: (bound - known).at_least(0.0),
            ..best
        }
    }
}
