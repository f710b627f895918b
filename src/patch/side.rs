//! What a search asks of a body: nodes and their heights.

use crate::base::num::extremes::Extremes;
use nalgebra::Vector3;

use super::bowl::BowlSide;
use super::height::taylor;
use super::tree::{Node, Nodes};

/// One body of a pair: nodes below a root, number 0, each a part of the body within a convex set.
///
/// Directions are unit vectors in the frame of the body. Errors of a node
/// ([`Node::error`]) are not part of a height.
pub(super) trait NetSide {
    /// Whether the body is one convex set, whose closest point to a point is found at once.
    const IS_CONVEX: bool;

    fn node(&self, id: u32) -> &Node;

    /// Returns the greatest height of the convex set.
    fn highest(&mut self, id: u32, n: &Vector3<f64>) -> f64;

    /// Returns the number and the place of a point towards which the convex set is highest, for the
    /// search of directions, and an upper bound of the height of the convex set.
    fn support(&mut self, id: u32, n: &Vector3<f64>) -> (u32, Vector3<f64>, f64);

    /// Returns a height below which no upper bound of the part can be, if the convex set reaches to
    /// `highest`.
    fn least(&self, id: u32, n: &Vector3<f64>, highest: f64) -> f64;

    /// Returns an upper bound of the height of the part by its curvature: `highest` if none is
    /// known that is lower, or has a hope to be lower by `need`.
    fn cap(&self, id: u32, n: &Vector3<f64>, highest: f64, need: f64) -> f64;

    /// Returns a height above a bowl that the part reaches; `None` if [`above`](Self::above) is not
    /// worth a try.
    fn least_above(&self, id: u32, half: &BowlSide) -> Option<f64>;

    /// Returns an upper bound of the heights of the part above a bowl, errors of the pose aside;
    /// `None` if none is known.
    fn above(&self, id: u32, half: &BowlSide) -> Option<f64>;

    /// Returns the first of the two children; the second follows. Only of a node that can be split.
    fn split(&mut self, id: u32) -> u32;
}

impl NetSide for Nodes<'_> {
    const IS_CONVEX: bool = false;

    #[inline]
    fn node(&self, id: u32) -> &Node {
        self.node(id)
    }

    #[inline]
    fn highest(&mut self, id: u32, n: &Vector3<f64>) -> f64 {
        self.net(id).highest(n)
    }

    #[inline]
    fn support(&mut self, id: u32, n: &Vector3<f64>) -> (u32, Vector3<f64>, f64) {
        let net = self.net(id);
        let k = net.highest_index(n);
        let p = net.point(k);
        (k as u32, p, n.dot(&p))
    }

    /// Corners lie on the surface.
    #[inline]
    fn least(&self, id: u32, n: &Vector3<f64>, _: f64) -> f64 {
        self.net(id).highest_corner(self.node(id).degrees, n)
    }

    #[inline]
    fn cap(&self, id: u32, n: &Vector3<f64>, highest: f64, need: f64) -> f64 {
        let of = taylor(self.node(id), &self.net(id), n, highest, need);
        of.unwrap_or(highest).smaller(highest)
    }

    fn least_above(&self, id: u32, half: &BowlSide) -> Option<f64> {
        let node = self.node(id);
        half.is_near(node).then(|| half.least(node, &self.net(id)))
    }

    fn above(&self, id: u32, half: &BowlSide) -> Option<f64> {
        half.highest(self.node(id), &self.net(id))
    }

    fn split(&mut self, id: u32) -> u32 {
        self.split(id)
    }
}
