//! The search: pairs of boxes, then a row for each pair that is near enough.

use std::borrow::Cow;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::Thread;
use std::time::Duration;

use lin_canny::broad::{Aabb, BodyOptions, SweepAndPrune};
use lin_canny::nalgebra::Translation3;
use lin_canny::polyhedron::BoxHint;
use lin_canny::{
    ContactState, Geometry, GeometryKind, Mesh, MeshKind, PairOutcome, PairTracker, Progress, RelativePose,
};
use rayon::iter::{IndexedParallelIterator, IntoParallelRefIterator, ParallelIterator};

use crate::error::ClashError;
use crate::model::{Model, Part};
use crate::row::{Kind, Row};
use crate::rules::{Rules, check_length, larger};

/// Why a crossing has no depth.
const NO_INSIDE: &str = "a part has no inside, so that the depth is unknown";

/// Share of the size of a pair by which surfaces are moved apart that may only touch.
const MOVED: f64 = 1e-9;

/// Share of a volume that rounding may leave outside a part that is inside another.
const INSIDE: f64 = 1e-9;

/// Time between two calls of a progress callback.
const BREATH: Duration = Duration::from_millis(50);

/// Which pairs have a row, and what a row holds.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct ClashOptions {
    /// Pairs at most this far apart have a row, in addition to pairs that are closer than they must keep.
    pub within: f64,
    /// Whether rows have the volume that two parts share.
    pub volume: bool,
}

impl ClashOptions {
    /// Sets [`within`](Self::within).
    #[must_use]
    pub fn within(self, within: f64) -> Self {
        Self { within, ..self }
    }

    /// Sets [`volume`](Self::volume).
    #[must_use]
    pub fn volume(self, volume: bool) -> Self {
        Self { volume, ..self }
    }
}

/// What a search has found.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Clashes {
    /// A row for each pair, in the order of the parts.
    pub rows: Vec<Row>,
    /// Number of pairs that were measured: their boxes are near each other, and no rule excludes them.
    pub measured: usize,
    /// Number of pairs with boxes near each other that a rule excludes.
    pub excluded: usize,
    /// Whether all pairs were measured: false if the caller has stopped the search.
    pub is_complete: bool,
}

/// Finds the pairs of a model that clash or are near each other.
///
/// `progress` is called on the calling thread, a few times per second, with the number of pairs that are
/// measured and of all pairs to measure; it may stop the search. All cores work; the rows do not depend on
/// their number.
///
/// ```
/// use std::ops::ControlFlow;
///
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::polyhedron::solids;
/// use lin_canny_clash::{ClashOptions, Kind, Model, Rules, find};
///
/// let die = solids::cuboid(Vector3::repeat(0.5))?;
/// let mut model = Model::new();
/// for x in [0.0, 0.875, 1.875] {
///     model.add("die", die.clone(), Isometry3::translation(x, 0.0, 0.0));
/// }
/// let options = ClashOptions::default().volume(true);
/// let found = find(&model, &Rules::default(), &options, |_| ControlFlow::Continue(()))?;
/// let kinds: Vec<_> = found.rows.iter().map(|row| (&*row.a, &*row.b, row.kind)).collect();
/// assert_eq!(kinds, [("die", "die#2", Kind::Overlapping), ("die#2", "die#3", Kind::Touching)]);
/// let [low, high] = found.rows[0].depth;
/// assert!(low <= 0.125 && 0.125 <= high && high - low < 1e-8 && found.rows[0].broken);
/// let [low, high] = found.rows[0].volume.unwrap();
/// assert!(low <= 0.125 && 0.125 <= high);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Returns an error if the pose or the box of a part is out of range, which names the part, or if
/// [`within`](ClashOptions::within) is negative or not finite.
pub fn find(
    model: &Model,
    rules: &Rules,
    options: &ClashOptions,
    mut progress: impl FnMut(Progress) -> ControlFlow<()>,
) -> Result<Clashes, ClashError> {
    check_length("within", options.within)?;
    let parts = model.parts();
    let pairs = near_pairs(parts, larger(options.within, rules.largest()))?;
    let kept: Vec<_> = pairs
        .iter()
        .filter(|&&(a, b)| model.exclusion(a, b).is_none() && rules.excluded(&parts[a].name, &parts[b].name).is_none())
        .collect();
    let (is_stopped, is_over, done) = (AtomicBool::new(false), AtomicBool::new(false), AtomicUsize::new(0));
    let measure = |&&(a, b): &&(usize, usize)| {
        if is_stopped.load(Ordering::Relaxed) {
            return Ok(None);
        }
        let row = Pair::new(&parts[a], &parts[b])?.row(rules, options);
        done.fetch_add(1, Ordering::Relaxed);
        Ok(row)
    };
    let mut rows: Result<Vec<Option<Row>>, ClashError> = Ok(Vec::new());
    let caller = std::thread::current();
    rayon::in_place_scope(|scope| {
        scope.spawn(|_| {
            let _end = End(&is_over, &caller);
            rows = kept.par_iter().with_max_len(16).map(measure).collect();
        });
        while !is_over.load(Ordering::Acquire) {
            let now = Progress::new("pairs", done.load(Ordering::Relaxed), Some(kept.len()));
            if progress(now).is_break() {
                is_stopped.store(true, Ordering::Relaxed);
            }
            // A thread of a pool works as well; any other one waits.
            if rayon::yield_now() != Some(rayon::Yield::Executed) {
                std::thread::park_timeout(BREATH);
            }
        }
    });
    let (rows, measured) = (rows?.into_iter().flatten().collect(), done.into_inner());
    Ok(Clashes {
        rows,
        measured,
        excluded: pairs.len() - kept.len(),
        is_complete: measured == kept.len(),
    })
}

/// Ends the wait of the caller, also if a measurement panics.
struct End<'a>(&'a AtomicBool, &'a Thread);

impl Drop for End<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
        self.1.unpark();
    }
}

/// Returns the pairs of parts whose boxes are at most `reach` apart, in the order of the parts.
fn near_pairs(parts: &[Part], reach: f64) -> Result<Vec<(usize, usize)>, ClashError> {
    let mut broad = SweepAndPrune::new();
    let mut part_of = std::collections::HashMap::new();
    for (k, part) in parts.iter().enumerate() {
        let (low, high) = part.geometry.aabb_at(&part.pose, &mut BoxHint::default());
        // Each box grows by half of the reach, rounded up.
        let grown = Aabb::new(low, high).grown(0.5 * reach * (1.0 + f64::EPSILON));
        let body = BodyOptions::default();
        let added = match matches!(part.geometry, Geometry::HalfSpace(_)) {
            true => broad.insert_unbounded(&grown, body),
            false => broad.insert(&grown, body),
        };
        let id = added.map_err(|reason| ClashError::Box {
            part: part.name.clone(),
            reason,
        })?;
        part_of.insert(id, k);
    }
    broad.step();
    let mut pairs: Vec<_> = broad
        .pairs()
        .map(|pair| {
            let [a, b] = [part_of[&pair.a], part_of[&pair.b]];
            (a.min(b), a.max(b))
        })
        .collect();
    pairs.sort_unstable();
    Ok(pairs)
}

/// Two parts at their poses.
struct Pair<'a> {
    parts: [&'a Part; 2],
    pose: RelativePose,
}

impl<'a> Pair<'a> {
    fn new(a: &'a Part, b: &'a Part) -> Result<Self, ClashError> {
        let pose = RelativePose::new(&a.pose, &b.pose).map_err(|reason| ClashError::Pose {
            part: b.name.clone(),
            reason,
        })?;
        Ok(Self { parts: [a, b], pose })
    }

    /// Returns the row of the pair; `None` if it is farther apart than `within`.
    fn row(&self, rules: &Rules, options: &ClashOptions) -> Option<Row> {
        let [a, b] = self.parts;
        let (x, y) = (&a.geometry, &b.geometry);
        let mut tracker = PairTracker::new();
        let required = rules.required(&a.name, &b.name);
        let found = tracker.closest(x, y, &self.pose);
        let mut row = Row {
            a: a.name.clone(),
            b: b.name.clone(),
            kind: Kind::Apart,
            gap: [0.0; 2],
            depth: [0.0; 2],
            volume: None,
            point: (a.pose * found.point_on_a).into(),
            rule: None,
            broken: false,
            note: None,
        };
        match found.state {
            ContactState::Separated => {
                row.gap = [at_least_zero(found.lower), found.upper];
                // A distance that equals what must be kept is kept.
                let is_close = required.distance > 0.0
                    && found.lower < required.distance
                    && (found.upper < required.distance
                        || tracker.within(x, y, &self.pose, required.distance.next_down()));
                if !is_close && !tracker.within(x, y, &self.pose, options.within) {
                    return None;
                }
                if is_close {
                    row.kind = Kind::Close;
                    row.broken = true;
                    row.rule = Some(required.rule);
                }
            }
            ContactState::Touching if self.crosses(&found) => {
                row.kind = Kind::Crossing;
                row.broken = true;
                row.note = Some(NO_INSIDE.into());
            }
            ContactState::Touching => {
                row.kind = Kind::Touching;
                row.broken = required.distance > 0.0 || rules.forbids_touching();
                row.rule = match (required.distance > 0.0, rules.forbids_touching()) {
                    (true, _) => Some(required.rule),
                    (_, true) => Some("touching".into()),
                    _ => None,
                };
            }
            ContactState::Overlapping => self.overlap(&mut row, &mut tracker, rules, options),
            _ => {
                row.kind = Kind::Undecided;
                row.gap = [at_least_zero(found.lower), at_least_zero(found.upper)];
                row.note = Some(undecided(&found));
                if found.upper < required.distance {
                    row.broken = true;
                    row.rule = Some(required.rule);
                }
            }
        }
        Some(row)
    }

    /// Returns whether surfaces cross of which one has no inside: they share no volume, and are not
    /// apart after a small translation along the normal of their contact.
    ///
    /// Of two surfaces of triangles, an edge of one passes through a triangle of the other; this test is
    /// exact, but for the rounding of vertices.
    fn crosses(&self, found: &PairOutcome) -> bool {
        let [x, y] = self.parts.map(|part| &part.geometry);
        if has_inside(x) && has_inside(y) {
            return false;
        }
        if let (Some(x), Some(y)) = (surface(x), surface(y)) {
            let b_in_a = self.parts[0].pose.inverse() * self.parts[1].pose;
            let mut points = x.vertices();
            let (first, own) = (points.len() as u32, x.triangle_count() as u32);
            points.extend(y.vertices().iter().map(|p| b_in_a * p));
            let mut triangles = x.triangle_vertices();
            triangles.extend(y.triangle_vertices().into_iter().map(|t| t.map(|v| v + first)));
            let Ok(both) = Mesh::new(&points, &triangles) else {
                return true;
            };
            let crossings = both.inspect(usize::MAX).crossings;
            return crossings.iter().any(|[t, u]| (*t < own) != (*u < own));
        }
        let [(_, r), (_, s)] = [x.bounding_ball(), y.bounding_ball()];
        let moved = Translation3::from(found.normal.into_inner() * (MOVED * (r + s)));
        let b_in_a = moved * (self.parts[0].pose.inverse() * self.parts[1].pose);
        RelativePose::from_isometry(&b_in_a).is_ok_and(|pose| PairTracker::new().intersects(x, y, &pose))
    }

    /// Completes the row of two parts that overlap.
    fn overlap(&self, row: &mut Row, tracker: &mut PairTracker, rules: &Rules, options: &ClashOptions) {
        let [a, b] = self.parts;
        let (x, y) = (&a.geometry, &b.geometry);
        row.broken = true;
        let Some(depth) = tracker.penetration(x, y, &self.pose) else {
            row.kind = Kind::Crossing;
            row.note = Some(NO_INSIDE.into());
            return;
        };
        row.kind = Kind::Overlapping;
        row.depth = [depth.lower, depth.upper];
        let mut volume = None;
        match tracker.overlap(x, y, &self.pose) {
            Ok(shared) => {
                let bounds = [at_least_zero(shared.lower), at_least_zero(shared.upper)];
                if !shared.covers_itself {
                    row.kind = kind_by_volumes(bounds, [x, y].map(volume_of));
                }
                volume = Some(bounds);
                if options.volume {
                    row.volume = volume;
                    if let Some(centroid) = shared.centroid {
                        row.point = (a.pose * centroid).into();
                    }
                }
            }
            Err(error) if options.volume => row.note = Some(error.to_string()),
            Err(_) => {}
        }
        let (a, b) = (&a.name, &b.name);
        let by_depth = rules.allowed_depth(a, b).filter(|(most, _)| row.depth[1] <= *most);
        let by_volume = rules
            .allowed_volume(a, b)
            .filter(|(most, _)| volume.is_some_and(|volume| volume[1] <= *most));
        if let Some((_, rule)) = by_depth.or(by_volume) {
            row.broken = false;
            row.rule = Some(rule);
        }
    }
}

fn has_inside(geometry: &Geometry) -> bool {
    match geometry {
        Geometry::Mesh(mesh) => mesh.kind() == MeshKind::Solid,
        geometry => geometry.kind() != GeometryKind::BezierSurface,
    }
}

/// Returns the triangles of a polyhedron or a mesh.
fn surface(geometry: &Geometry) -> Option<Cow<'_, Mesh>> {
    match geometry {
        Geometry::Mesh(mesh) => Some(Cow::Borrowed(mesh)),
        Geometry::Polyhedron(body) => Mesh::from_convex(body).ok().map(Cow::Owned),
        _ => None,
    }
}

/// Returns bounds of the volume of a polyhedron or a closed mesh.
fn volume_of(geometry: &Geometry) -> Option<[f64; 2]> {
    match geometry {
        Geometry::Mesh(mesh) if mesh.kind() == MeshKind::Solid => {
            let (lower, upper) = mesh.volume_bounds();
            // Of a mesh that faces inward, it is negative.
            Some(if upper < 0.0 { [-upper, -lower] } else { [lower, upper] })
        }
        Geometry::Polyhedron(body) => {
            let (lower, upper) = Mesh::from_convex(body).ok()?.volume_bounds();
            Some([lower, upper])
        }
        _ => None,
    }
}

/// Returns the kind of an overlap by the volumes of the common part and of both parts.
fn kind_by_volumes(shared: [f64; 2], volumes: [Option<[f64; 2]>; 2]) -> Kind {
    let is_inside =
        |volume: Option<[f64; 2]>| volume.is_some_and(|[_, upper]| upper > 0.0 && shared[0] >= upper * (1.0 - INSIDE));
    match volumes.map(is_inside) {
        [true, true] => Kind::Equal,
        [false, false] => Kind::Overlapping,
        _ => Kind::Inside,
    }
}

fn undecided(found: &PairOutcome) -> String {
    format!(
        "the distance is between {} and {}, which decides nothing",
        found.lower, found.upper
    )
}

/// Returns the number, or zero if it is negative or not a number. `f64::max` returns either zero of two.
fn at_least_zero(x: f64) -> f64 {
    if x > 0.0 { x } else { 0.0 }
}
