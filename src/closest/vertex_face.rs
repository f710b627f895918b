//! A vertex beside a face: it must stand over the face, and the face's plane must support its body at it.

use nalgebra::Vector3;

use super::placed::Sides;
use super::slide::{Slide, slide};
use super::state::{Found, State, Step};
use crate::polyhedron::ConvexPolyhedron;
use crate::pose::Which;
use crate::tolerance::{DIFFERENCE, DIRECTION, ON_BOUNDARY};

#[inline]
pub(crate) fn look<const CERTIFY: bool>(sides: &Sides, of: Which, vertex: u32, face: u32) -> Step {
    let Sides {
        x: body,
        y: other,
        y_from_x,
        x_from_y,
    } = *sides;
    let x = y_from_x.point(&body.points[vertex as usize]);
    let plane = &other.planes[face as usize];
    let size = y_from_x.size;
    if let Some(edge) = outside(other, face, &plane.normal, &x, DIFFERENCE * size) {
        return Step::Move(State::VertexEdge { of, vertex, edge });
    }
    let on_rim = other.points[other.topology.half_edge(other.topology.rim_start(face)).to as usize];
    let height = plane.normal.dot(&(x - on_rim));
    if height <= ON_BOUNDARY * size {
        return behind(other, of, vertex, face, &x, ON_BOUNDARY * size);
    }
    let n = y_from_x.direction(&plane.normal);
    let fan = body.fan_minimum(vertex, &n);
    if let Some(h) = body.descent(vertex, &fan, DIRECTION) {
        return slide(
            sides,
            of,
            &Slide {
                half_edge: h,
                start: x,
                face,
                from_rim: None,
            },
        );
    }
    let lower = if CERTIFY && body.proves_lowest(&fan, &n) {
        (plane.normal.dot(&x) - plane.offset) * y_from_x.unit
    } else {
        f64::NEG_INFINITY
    };
    let distance = height * y_from_x.unit;
    let (on_x, foot) = (body.points[vertex as usize], x - plane.normal * height);
    Step::Found(match of {
        Which::A => Found {
            normal: -x_from_y.vector(&plane.normal),
            point_a: on_x,
            point_b: foot,
            distance,
            lower,
        },
        Which::B => Found {
            normal: plane.normal,
            point_a: foot,
            point_b: on_x,
            distance,
            lower,
        },
    })
}

/// The edge of the rim whose side plane `x` is furthest outside of, where it is outside by more than `noise`.
#[inline]
fn outside(body: &ConvexPolyhedron, face: u32, n: &Vector3<f64>, x: &Vector3<f64>, noise: f64) -> Option<u32> {
    let start = body.topology.rim_start(face);
    let mut from = body.points[body.topology.from(start) as usize];
    let (mut worst, mut furthest) = (None, 0.0);
    let mut h = start;
    loop {
        let e = body.topology.half_edge(h);
        let to = body.points[e.to as usize];
        let u = to - from;
        let side = n.cross(&u).dot(&(x - to));
        if side < -noise * u.abs().sum() {
            let squared = side * side / u.norm_squared();
            if squared > furthest {
                (worst, furthest) = (Some(h.min(e.twin)), squared);
            }
        }
        (from, h) = (to, e.next);
        if h == start {
            return worst;
        }
    }
}

/// A vertex on the back side: climbs over neighbouring faces to the one it is furthest above.
#[cold]
fn behind(body: &ConvexPolyhedron, of: Which, vertex: u32, face: u32, x: &Vector3<f64>, least: f64) -> Step {
    let height = |f: u32| body.planes[f as usize].normal.dot(x) - body.planes[f as usize].offset;
    let (mut best, mut top) = (face, height(face));
    loop {
        let from = best;
        for h in body.topology.rim(from) {
            let f = body.topology.half_edge(body.topology.half_edge(h).twin).face;
            let up = height(f);
            if up > top {
                (best, top) = (f, up);
            }
        }
        if best == from {
            break;
        }
    }
    if best != face && top > least {
        Step::Jump(State::VertexFace { of, vertex, face: best })
    } else {
        Step::Lost
    }
}
