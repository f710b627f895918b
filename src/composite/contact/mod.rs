//! Contacts of meshes and bodies of pieces: one manifold for each pair of convex patches.
//!
//! Triangles of a convex region are a single body to a manifold, so that the edges inside the
//! region bear no contact; a contact is kept only if it lies on the mesh and its normal is in the
//! normal cone of the mesh there ([`skin`]). So a body that slides over the edges of a tessellated
//! floor, or along a reflex edge, feels none of them.

mod patches;
mod skin;

use alloc::collections::BTreeMap;
use alloc::vec::Vec;
use nalgebra::{Unit, Vector3};

pub use patches::ContactPatches;

use super::bounds::bounds;
use super::frame::Frame;
use super::front::Pair;
use super::parts::Parted;
use super::search::split_pair;
use crate::contact::{ContactPoint, Manifold, ManifoldOptions};
use crate::num::scalar::sqrt;
use crate::pose::RelativePose;
use crate::tolerance::ACROSS;
use crate::tracker::Tracker;

/// A contact and the patches that bear it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PatchContact {
    /// The patch or piece of A and of B. With the id of the point, a name that lasts as long as the
    /// contact.
    pub patches: [u32; 2],
    /// The points, in the bodies' frames.
    pub point: ContactPoint,
}

/// Contacts along one direction.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PatchContacts {
    /// Unit direction from A to B, in A's frame: that of the deepest contact.
    pub normal: Unit<Vector3<f64>>,
    /// At most [`ManifoldOptions::max_points`] contacts, the deepest first, the others far from
    /// each other.
    pub contacts: Vec<PatchContact>,
}

/// The manifolds of the pairs of patches of two bodies that are near.
///
/// Overlaps deeper than the patches have no contact: a patch of a mesh has its own depth, and a
/// quarter of its radius if it is flat.
///
/// ```
/// use lin_canny::nalgebra::{Isometry3, Vector3};
/// use lin_canny::polyhedron::solids;
/// use lin_canny::{ContactPatches, ManifoldOptions, Mesh};
/// use lin_canny::{PatchTracker, RelativePose};
///
/// let floor = Mesh::from_convex(&solids::cuboid(Vector3::new(5.0, 5.0, 1.0))?)?;
/// let part = Mesh::from_convex(&solids::cuboid(Vector3::new(0.5, 0.5, 0.5))?)?;
/// let floor = ContactPatches::of_mesh(&floor)?;
/// let part = ContactPatches::of_mesh(&part)?;
/// let mut pair = PatchTracker::new();
/// let at = RelativePose::from_isometry(&Isometry3::translation(0.1, 0.0, 1.49))?;
/// let found = pair.contacts(&floor, &part, &at, &ManifoldOptions::within(0.02));
/// assert_eq!((found.len(), found[0].contacts.len()), (1, 4));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct PatchTracker {
    fingerprints: [u64; 2],
    near: BTreeMap<Pair, Near>,
    found: Vec<PatchContacts>,
}

/// The state of two patches that are near.
#[derive(Clone, Debug, Default)]
struct Near {
    tracker: Tracker,
    manifold: Manifold,
    /// Whether the last query met the pair.
    seen: bool,
}

impl PatchTracker {
    /// Returns a tracker without a start.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the contacts within `options.prediction`, in groups of one direction.
    pub fn contacts(
        &mut self,
        a: &ContactPatches,
        b: &ContactPatches,
        a_from_b: &RelativePose,
        options: &ManifoldOptions,
    ) -> &[PatchContacts] {
        let fingerprints = [a.hulls.fingerprint(), b.hulls.fingerprint()];
        if self.fingerprints != fingerprints {
            *self = Self::default();
            self.fingerprints = fingerprints;
        }
        let named = |c: &PatchContact| (c.patches, c.point.id);
        let before: Vec<_> = self.found.iter().flat_map(|g| g.contacts.iter().map(named)).collect();
        self.found.clear();
        let Some(frame) = Frame::new(a.hulls.side(), b.hulls.side(), a_from_b) else {
            return &self.found;
        };
        self.near.values_mut().for_each(|n| n.seen = false);
        for pair in near_pairs((a, b), &frame, options.prediction) {
            self.ask((a, b), a_from_b, &frame, options, pair);
        }
        self.near.retain(|_, near| near.seen);
        let spacing = options.drift * a.hulls.side().radius.min(b.hulls.side().radius * frame.scale);
        for group in &mut self.found {
            let was = |c: &PatchContact| before.contains(&named(c));
            reduce(
                &mut group.contacts,
                options.max_points,
                spacing * a.hulls.stored_unit(),
                was,
            );
        }
        &self.found
    }

    /// Adds the contacts of two patches.
    fn ask(
        &mut self,
        (a, b): (&ContactPatches, &ContactPatches),
        pose: &RelativePose,
        frame: &Frame,
        options: &ManifoldOptions,
        patches: Pair,
    ) {
        let (Some(p), Some(q)) = (a.hull(patches[0]), b.hull(patches[1])) else {
            return;
        };
        let Near {
            tracker,
            manifold,
            seen,
        } = self.near.entry(patches).or_default();
        *seen = true;
        tracker.manifold(p, q, pose, options, manifold);
        let n = manifold.normal();
        let inward = frame.rotation.tr_mul(&-*n);
        let slack = 4.0 * ACROSS * frame.size * a.hulls.stored_unit();
        let bears = |side: &ContactPatches, patch, point: &Vector3<f64>, n: &Vector3<f64>| {
            let skin = side.skin.as_ref();
            skin.is_none_or(|s| s.bears(patch, point, n, options.sine, slack))
        };
        for &point in manifold.points() {
            let is_near = point.separation <= options.prediction;
            if is_near
                && bears(a, patches[0], &point.point_on_a.coords, &n)
                && bears(b, patches[1], &point.point_on_b.coords, &inward)
            {
                add(&mut self.found, n, PatchContact { patches, point }, options.sine);
            }
        }
    }
}

/// Adds a contact to the group of its direction.
fn add(groups: &mut Vec<PatchContacts>, normal: Unit<Vector3<f64>>, contact: PatchContact, sine: f64) {
    let is_same =
        |g: &&mut PatchContacts| g.normal.dot(&normal) > 0.0 && g.normal.cross(&normal).norm_squared() <= sine * sine;
    match groups.iter_mut().find(is_same) {
        Some(group) => {
            let deepest = |c: &PatchContact| c.point.separation <= contact.point.separation;
            if !group.contacts.iter().any(deepest) {
                group.normal = normal;
            }
            group.contacts.push(contact);
        }
        None => groups.push(PatchContacts {
            normal,
            contacts: alloc::vec![contact],
        }),
    }
}

/// Keeps the deepest contact, then the ones farthest from those kept, contacts of the last query
/// first among nearly equals.
fn reduce(contacts: &mut Vec<PatchContact>, most: usize, spacing: f64, was: impl Fn(&PatchContact) -> bool) {
    let deepest = (0..contacts.len()).min_by(|&i, &j| {
        let depth = |k: usize| contacts[k].point.separation;
        depth(i).total_cmp(&depth(j))
    });
    let Some(deepest) = deepest else { return };
    contacts.swap(0, deepest);
    let mut kept = 1;
    while kept < contacts.len() && kept < most.max(1) {
        let far = |c: &PatchContact| {
            let away = |k: &PatchContact| (c.point.point_on_a - k.point.point_on_a).norm_squared();
            contacts[..kept].iter().map(away).fold(f64::INFINITY, f64::min)
        };
        // A quarter more for contacts that were there.
        let rated = |c: &PatchContact| far(c) * if was(c) { 1.25 } else { 1.0 };
        let next = (kept..contacts.len()).max_by(|&i, &j| rated(&contacts[i]).total_cmp(&rated(&contacts[j])));
        let Some(next) = next else { break };
        if !(sqrt(far(&contacts[next])) > spacing) {
            break;
        }
        contacts.swap(kept, next);
        kept += 1;
    }
    contacts.truncate(kept);
}

/// The pairs of patches whose boxes are not proven farther apart than the prediction.
fn near_pairs((a, b): (&ContactPatches, &ContactPatches), frame: &Frame, prediction: f64) -> Vec<Pair> {
    let (of_a, of_b) = (a.hulls.side().tree, b.hulls.side().tree);
    let level = frame.single_up(prediction.max(0.0) / a.hulls.stored_unit());
    let (mut stack, mut found) = (alloc::vec![[0, 0]], Vec::new());
    while !stack.is_empty() {
        let from = stack.len().saturating_sub(8);
        let batch = stack.split_off(from);
        let at = |k: usize| batch[k.min(batch.len() - 1)];
        let gaps = bounds(
            &frame.single,
            core::array::from_fn(|k| &of_a.boxes[at(k)[0] as usize]),
            core::array::from_fn(|k| &of_b.boxes[at(k)[1] as usize]),
        );
        for (&pair, gap) in batch.iter().zip(gaps.gap) {
            if frame.single.error.is_finite() && gap - frame.single.error > level {
                continue;
            }
            match split_pair((of_a, of_b), frame, pair) {
                Some(two) => stack.extend(two),
                None => found.push([
                    a.hulls.number(of_a.range(pair[0]).0),
                    b.hulls.number(of_b.range(pair[1]).0),
                ]),
            }
        }
    }
    found.sort_unstable();
    found
}
