//! Insertion of a point: the triangles visible from the point are replaced by a fan from the point
//! to their horizon.
//!
//! ```text
//!      +------+             +------+
//!     / \ v  / \           / '.  .' \      v: visible triangles
//!    /   \  / v \         /    \/    \     horizon: the edges around them
//!   +-----\/-----+   ->  +-----c------+    c: the inserted point, apex of the fan
//!    \  v /\    /         \   / \    /
//!     \  / v\  /           \ /   \  /
//!      +------+             +------+
//! ```

use crate::base::num::scalar::{Scalar, Vec3, dot, sub};
use crate::convex::depth::surface::{BoundState, EnclosingSurface, Filter, SurfaceTriangle};
use crate::pair::difference::MinkowskiPoint;

/// An edge between a visible triangle and a triangle that stays.
#[derive(Clone, Copy, Debug)]
pub(super) struct HorizonEdge {
    from: u32,
    to: u32,
    outer: u32,
}

impl<T> SurfaceTriangle<T> {
    fn edges(&self) -> [HorizonEdge; 3] {
        core::array::from_fn(|k| HorizonEdge {
            from: self.vertices[k],
            to: self.vertices[(k + 1) % 3],
            outer: self.neighbours[k],
        })
    }
}

impl<T: Scalar> EnclosingSurface<T> {
    /// Inserts a point higher than `triangle` along the triangle's direction, and replaces the
    /// triangles visible from the point.
    pub(in crate::convex::depth) fn insert(&mut self, triangle: u32, c: MinkowskiPoint<T>, filter: &Filter<T>) {
        self.flood(triangle, &c.w, filter);
        if !self.order_horizon() {
            // The three edges of a triangle are always a loop.
            self.visible.clear();
            self.visible.push(triangle);
            self.horizon.clear();
            self.horizon.extend(self.triangles[triangle as usize].edges());
        }
        self.points.push(c);
        self.add_fan();
        // Removes the highest index first, so that no listed triangle moves.
        let count = self.horizon.len();
        while self.visible.len() > count {
            let left = &self.visible[count..];
            let last = left.iter().enumerate().max_by_key(|(_, t)| **t).map_or(0, |(k, _)| k);
            let hole = self.visible.swap_remove(count + last);
            self.remove(hole);
        }
    }

    /// Joins the last point to every horizon edge, reusing the visible triangles and adding more if
    /// needed.
    fn add_fan(&mut self) {
        let apex = self.points.len() as u32 - 1;
        let (kept, count) = (self.visible.len(), self.horizon.len());
        let added = self.triangles.len();
        for k in kept..count {
            self.triangles.push(SurfaceTriangle::default());
            self.visible.push((added + k - kept) as u32);
        }
        for k in 0..count {
            let HorizonEdge { from, to, outer } = self.horizon[k];
            let (at, after, before) = (
                self.visible[k],
                self.visible[(k + 1) % count],
                self.visible[(k + count - 1) % count],
            );
            self.triangles[at as usize] = SurfaceTriangle {
                vertices: [from, to, apex],
                neighbours: [outer, after, before],
                ..SurfaceTriangle::default()
            };
            self.compute_bound(at);
            self.join(outer, [to, from], at);
        }
    }

    /// Makes `other` the neighbour of a triangle across an edge.
    fn join(&mut self, triangle: u32, edge: [u32; 2], other: u32) {
        let t = &mut self.triangles[triangle as usize];
        for i in 0..3 {
            if [t.vertices[i], t.vertices[(i + 1) % 3]] == edge {
                t.neighbours[i] = other;
            }
        }
    }

    /// Removes a triangle no neighbour refers to; the last triangle takes its index.
    fn remove(&mut self, hole: u32) {
        let last = self.triangles.len() as u32 - 1;
        self.triangles.swap_remove(hole as usize);
        if hole == last {
            return;
        }
        let SurfaceTriangle {
            vertices, neighbours, ..
        } = self.triangles[hole as usize];
        for i in 0..3 {
            self.join(neighbours[i], [vertices[(i + 1) % 3], vertices[i]], hole);
        }
        if self.triangles[hole as usize].state != BoundState::Unmeasured {
            self.enqueue(hole);
        }
    }

    /// Lists the triangles connected to `from` that are visible from `w` and may be replaced.
    fn flood(&mut self, from: u32, w: &Vec3<T>, filter: &Filter<T>) {
        self.floods += 1;
        self.visible.clear();
        self.visible.push(from);
        self.triangles[from as usize].flood = self.floods;
        let mut done = 0;
        while done < self.visible.len() {
            for k in self.triangles[self.visible[done] as usize].neighbours {
                if self.triangles[k as usize].flood == self.floods || !self.is_visible(k, w, filter) {
                    continue;
                }
                self.triangles[k as usize].flood = self.floods;
                self.visible.push(k);
            }
            done += 1;
        }
    }

    /// Returns whether `w` is outside the plane of a triangle, and some plane certainly has the
    /// origin beneath and both the triangle and `w` above.
    pub(in crate::convex::depth) fn is_visible(&mut self, triangle: u32, w: &Vec3<T>, filter: &Filter<T>) -> bool {
        self.measure(triangle);
        let t = &self.triangles[triangle as usize];
        let p = &self.points[t.vertices[0] as usize].w;
        let is_flat = t.outward.iter().all(|x| x.value() == 0.0);
        // Outside the triangle's plane, `w` is at least as high along the normal as the vertices.
        if !is_flat && !(dot(&t.outward, &sub(w, p)) > filter.noise) {
            return false;
        }
        if !is_flat && t.level > filter.margin {
            return true;
        }
        if self.refine(triangle) {
            self.enqueue(triangle);
        }
        let t = &self.triangles[triangle as usize];
        let height = dot(&t.direction, w);
        let above = t.bound > filter.margin && height > filter.margin;
        above && (!is_flat || height > t.bound + filter.noise)
    }

    /// Orders the horizon edges around the visible triangles; returns whether they form a single
    /// loop without a repeated vertex.
    fn order_horizon(&mut self) -> bool {
        let (flood, all) = (self.floods, &self.triangles);
        let edges = &mut self.horizon;
        edges.clear();
        let edges_of_visible = self.visible.iter().flat_map(|&t| all[t as usize].edges());
        edges.extend(edges_of_visible.filter(|e| all[e.outer as usize].flood != flood));
        for k in 1..edges.len() {
            let Some(next) = (k..edges.len()).find(|&i| edges[i].from == edges[k - 1].to) else {
                return false;
            };
            edges.swap(k, next);
        }
        self.starts.clear();
        self.starts.extend(edges.iter().map(|e| e.from));
        self.starts.sort_unstable();
        let simple = self.starts.windows(2).all(|s| s[0] != s[1]);
        let closed = edges.last().is_some_and(|e| e.to == edges[0].from);
        simple && closed && edges.len() > 2
    }
}
