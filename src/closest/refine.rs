//! What follows a walk that the certificate refuses: each layer finer and slower than the one before.

use nalgebra::Vector3;

use super::fallback::{Minimum, solve};
use super::outcome::{Class, Layer, Work};
use super::placed::{Frame, Placed};
use super::simplex::Simplex;
use super::state::State;
use super::{Answer, certified_walk, seed};
use crate::double_double::DoubleDouble;
use crate::polyhedron::ConvexPolyhedron;
use crate::pose::Which;
use crate::scalar::Scalar;
use crate::tolerance::{AGREE, CERTIFICATE, UNIT};

/// Restart, fallback, double-double, exact: the first that proves its answer.
#[cold]
pub(crate) fn refine(placed: &Placed, state: State, warm: bool, work: &mut Work) -> Answer {
    let mut state = state;
    if warm {
        work.restarts += 1;
        match certified_walk(placed, seed::facing(placed), Layer::Restart, work) {
            Ok(answer) => return answer,
            Err(last) => state = last,
        }
    }
    work.fallbacks += 1;
    let plain = solve(placed, &Frame::of(&placed.a_from_b), state);
    let plain = answer(placed, &plain, Layer::Fallback, work);
    if plain.is_proven(placed) {
        return plain;
    }
    doubled(placed, plain.state, work)
}

/// The f64 solver alone, its bounds not looked at.
#[cold]
pub(crate) fn unchecked(placed: &Placed, state: State, work: &mut Work) -> Answer {
    work.fallbacks += 1;
    answer(
        placed,
        &solve(placed, &Frame::of(&placed.a_from_b), state),
        Layer::Fallback,
        work,
    )
}

/// The double-double layer and what follows it.
pub(crate) fn doubled(placed: &Placed, state: State, work: &mut Work) -> Answer {
    work.double_doubles += 1;
    let Some(frame) = Frame::<DoubleDouble>::new(placed.a, placed.b, placed.pose) else {
        return undecided(placed, state, work);
    };
    let fine = answer(placed, &solve(placed, &frame, state), Layer::DoubleDouble, work);
    if fine.is_proven(placed) {
        return fine;
    }
    #[cfg(feature = "exact")]
    {
        work.exacts += 1;
        super::exact::answer(placed, fine.state, work)
    }
    #[cfg(not(feature = "exact"))]
    {
        let class = match fine.class {
            Class::Overlapping => Class::Overlapping,
            _ if fine.is_narrow(placed.size()) => Class::Touching,
            _ => Class::Undecided,
        };
        Answer { class, ..fine }
    }
}

/// The distance of a separated pair within one unit in the last place: by the double-double layer where its bounds
/// are that close, else by the exact rung.
#[cfg(feature = "exact")]
pub(crate) fn sharpen(placed: &Placed, certified: Answer) -> Answer {
    if certified.class != Class::Separated || certified.layer == Layer::Exact {
        return certified;
    }
    let mut work = certified.work;
    work.double_doubles += 1;
    if let Some(frame) = Frame::<DoubleDouble>::new(placed.a, placed.b, placed.pose) {
        let minimum = solve(placed, &frame, certified.state);
        if let Minimum::Outside { simplex, lower, .. } = &minimum {
            let distance = simplex.reach();
            let gap = (distance - *lower).value().abs()
                + 2.0 * CERTIFICATE * DoubleDouble::UNIT * placed.reach::<DoubleDouble>();
            let d = distance.value();
            // Rounding takes half a unit; what is left open must not take the other half.
            if gap <= 0.25 * (d - d.next_down()) {
                let fine = answer(placed, &minimum, Layer::DoubleDouble, &work);
                return Answer {
                    distance: d,
                    lower: d.next_down(),
                    upper: d.next_up(),
                    ..fine
                };
            }
        }
    }
    work.exacts += 1;
    super::exact::answer(placed, certified.state, &work)
}

impl Answer {
    /// Whether class and distance are settled: apart with bounds no wider than they should be, or overlapping with
    /// witnesses that are one point up to rounding (the weights of a flat tetrahedron around the origin may be wrong in
    /// every digit while the signs of its volumes are certain).
    fn is_proven(&self, placed: &Placed) -> bool {
        match self.class {
            Class::Overlapping => {
                let between = placed.a_from_b.point(&self.point_b) - self.point_a;
                crate::scalar::sqrt(between.norm_squared()) <= AGREE * placed.size()
            }
            Class::Separated => self.is_narrow(placed.size()),
            Class::Touching | Class::Undecided => false,
        }
    }

    /// Whether the bounds agree as well as a certified answer's must.
    fn is_narrow(&self, size: f64) -> bool {
        self.upper - self.lower <= (AGREE + 2.0 * CERTIFICATE * UNIT) * size
    }
}

/// The bounds that a solve proves, and its witnesses.
fn answer<T: Scalar>(placed: &Placed, minimum: &Minimum<T>, layer: Layer, work: &Work) -> Answer {
    let term = CERTIFICATE * T::UNIT * placed.reach::<T>();
    match minimum {
        Minimum::Inside { simplex } => {
            let state = features(placed, simplex);
            let (point_a, point_b) = witnesses(placed, simplex);
            // The direction has no meaning inside; any unit vector serves.
            let blank = Answer {
                class: Class::Overlapping,
                distance: 0.0,
                lower: f64::NEG_INFINITY,
                ..zero(state)
            };
            Answer {
                upper: 0.0,
                point_a,
                point_b,
                layer,
                work: *work,
                ..blank
            }
        }
        Minimum::Outside {
            simplex,
            lower,
            direction: d,
        } => {
            let distance = simplex.reach();
            let lower = outward(*lower, -term);
            let upper = outward(distance, term);
            let class = if lower > 0.0 {
                Class::Separated
            } else {
                Class::Undecided
            };
            let (point_a, point_b) = witnesses(placed, simplex);
            let normal = Vector3::new(-d[0].value(), -d[1].value(), -d[2].value());
            let normal = if normal.norm_squared() > 0.0 {
                normal
            } else {
                Vector3::x()
            };
            let distance = distance.value().clamp(lower.max(0.0), upper.max(0.0));
            let state = features(placed, simplex);
            Answer {
                class,
                distance,
                lower,
                upper,
                state,
                point_a,
                point_b,
                normal,
                layer,
                work: *work,
            }
        }
    }
}

/// An answer that says nothing yet.
fn zero(state: State) -> Answer {
    Answer {
        class: Class::Undecided,
        distance: 0.0,
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        state,
        point_a: Vector3::zeros(),
        point_b: Vector3::zeros(),
        normal: Vector3::x(),
        layer: Layer::DoubleDouble,
        work: Work::default(),
    }
}

/// Out of the range of the finer arithmetic: what any two vertices prove.
pub(super) fn undecided(placed: &Placed, state: State, work: &Work) -> Answer {
    let (a, b) = state.vertices_of(placed.a, placed.b);
    let (point_a, point_b) = (placed.a.points[a as usize], placed.b.points[b as usize]);
    let normal = placed.a_from_b.point(&point_b) - point_a;
    let upper = crate::scalar::sqrt(normal.norm_squared()) + CERTIFICATE * UNIT * placed.size();
    Answer {
        upper,
        distance: upper,
        point_a,
        point_b,
        normal,
        work: *work,
        ..zero(state)
    }
}

/// `x + by`, rounded away from `x` by the last place, in f64.
fn outward<T: Scalar>(x: T, by: f64) -> f64 {
    let sum = (x + T::from(by)).value();
    if by < 0.0 { sum.next_down() } else { sum.next_up() }
}

/// The convex combinations of the corners' vertices, each in its body's stored frame.
fn witnesses<T: Scalar>(placed: &Placed, simplex: &Simplex<T>) -> (Vector3<f64>, Vector3<f64>) {
    let (mut on_a, mut on_b) = ([T::from(0.0); 3], [T::from(0.0); 3]);
    for (c, &w) in simplex.kept().iter().zip(&simplex.weights) {
        let (p, q) = (placed.a.points[c.a as usize], placed.b.points[c.b as usize]);
        for k in 0..3 {
            on_a[k] = on_a[k] + w * T::from(p[k]);
            on_b[k] = on_b[k] + w * T::from(q[k]);
        }
    }
    (
        Vector3::from(on_a.map(|c| c.value())),
        Vector3::from(on_b.map(|c| c.value())),
    )
}

/// The smallest features that hold the corners' vertices.
fn features<T: Scalar>(placed: &Placed, simplex: &Simplex<T>) -> State {
    let (mut a, mut b) = ([0; 4], [0; 4]);
    for (k, c) in simplex.kept().iter().enumerate() {
        (a[k], b[k]) = (c.a, c.b);
    }
    state_of(placed, &a[..simplex.len], &b[..simplex.len])
}

/// The smallest features that hold one to four vertices of each body.
pub(super) fn state_of(placed: &Placed, a: &[u32], b: &[u32]) -> State {
    let (fa, fb) = (placed.a.feature_of(a), placed.b.feature_of(b));
    use Hull::{Edge, Face, Vertex};
    match (fa, fb) {
        (Vertex(a), Vertex(b)) => State::VertexVertex { a, b },
        (Vertex(vertex), Edge(edge)) => State::VertexEdge {
            of: Which::A,
            vertex,
            edge,
        },
        (Edge(edge), Vertex(vertex)) => State::VertexEdge {
            of: Which::B,
            vertex,
            edge,
        },
        (Vertex(vertex), Face(face)) => State::VertexFace {
            of: Which::A,
            vertex,
            face,
        },
        (Face(face), Vertex(vertex)) => State::VertexFace {
            of: Which::B,
            vertex,
            face,
        },
        (Edge(a), Edge(b)) => State::EdgeEdge { a, b },
        // An edge over a face, or two faces: parallel features, of which a vertex over the face is closest too.
        (Face(face), _) => State::VertexFace {
            of: Which::B,
            vertex: b[0],
            face,
        },
        (_, Face(face)) => State::VertexFace {
            of: Which::A,
            vertex: a[0],
            face,
        },
    }
}

/// A feature by its number.
enum Hull {
    Vertex(u32),
    Edge(u32),
    Face(u32),
}

impl ConvexPolyhedron {
    /// The smallest feature that holds the given vertices (one to four, with repeats); the first vertex where no face
    /// holds them all.
    fn feature_of(&self, vertices: &[u32]) -> Hull {
        let v = vertices[0];
        let Some(&w) = vertices.iter().find(|&&w| w != v) else {
            return Hull::Vertex(v);
        };
        let t = &self.topology;
        if vertices.iter().all(|&x| x == v || x == w) {
            if let Some(h) = t.fan(v).find(|&h| t.half_edge(h).to == w) {
                return Hull::Edge(t.edge(h));
            }
        }
        let holds = |f: u32| vertices.iter().all(|&x| t.rim(f).any(|h| t.half_edge(h).to == x));
        match t.fan(v).map(|h| t.half_edge(h).face).find(|&f| holds(f)) {
            Some(f) => Hull::Face(f),
            None => Hull::Vertex(v),
        }
    }
}
