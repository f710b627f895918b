//! The queries that a scene computes for each pair of groups, and the lowest level of detail that
//! answers them. A census counts the bodies by kind, and so shows which queries their pairs can
//! answer.

use crate::base::num::extremes::Extremes;
use crate::base::tolerance::SCENE_REACH;
use crate::convex::contact::ManifoldOptions;
use crate::pair::outcome::DepthMode;
use crate::pair_tracker::geometry::GeometryKind;
use crate::scene::SceneError;
use crate::time::impact::Tolerance;
use alloc::boxed::Box;
use alloc::collections::BTreeMap;

/// One of 32 groups. Every body is in one group, and the groups of two bodies select the queries of
/// the pair.
///
/// ```
/// use lin_canny::scene::Group;
///
/// const ROBOT: Group = Group::new(1).unwrap();
/// assert_eq!(Group::new(32), None);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "u8", into = "u8"))]
pub struct Group(u8);

/// Number of groups.
pub(super) const GROUPS: usize = 32;

impl Group {
    /// Returns group `number`, which must be 0 to 31.
    #[must_use]
    pub const fn new(number: u8) -> Option<Self> {
        if (number as usize) < GROUPS {
            Some(Self(number))
        } else {
            None
        }
    }

    /// Returns the number of the group.
    #[must_use]
    pub const fn number(self) -> u8 {
        self.0
    }

    pub(super) fn index(self) -> usize {
        usize::from(self.0)
    }
}

impl core::fmt::Display for Group {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "group {}", self.0)
    }
}

impl TryFrom<u8> for Group {
    type Error = &'static str;

    fn try_from(number: u8) -> Result<Self, Self::Error> {
        Self::new(number).ok_or("groups are numbered 0 to 31")
    }
}

impl From<Group> for u8 {
    fn from(group: Group) -> Self {
        group.0
    }
}

/// The queries to run for pairs of bodies of two groups. A query that is not enabled is neither
/// computed nor stored.
///
/// | level of detail | enabled by | work of a step for a pair | memory of a pair |
/// |---|---|---|---|
/// | nothing | [`none`](Self::none) | the bodies are never paired | nothing |
/// | boxes | `boxes` | events when boxes start and stop overlapping | a slot |
/// | predicates | `overlap`, `within`, `impact`, `impact_within` | predicate, budget | a tracker |
/// | distance | `distance`, `depth`, `local_depth` | signed distance, bounds | distance as well |
/// | features | `features` | features, witnesses and normal as well | the outcome as well |
/// | manifold | `manifold` | contact points as well | a manifold as well, within its prediction |
///
/// A level also answers the enabled queries of the levels above it in the table: if a distance is
/// computed, events of overlaps cost nothing more. `depth` and `local_depth` add to the levels from
/// `distance` on: without them an overlap has no depth.
///
/// ```
/// use lin_canny::scene::PairQueries;
///
/// let near = PairQueries::none().within(0.05);
/// let full = near.distance(f64::INFINITY).features(true).depth(true);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct PairQueries {
    /// Events when the boxes of two bodies start and stop overlapping. The boxes are grown by the
    /// distances of the queries below.
    pub boxes: bool,
    /// Whether two bodies share a point, exactly, and events when this changes. Touching bodies
    /// share a point.
    pub overlap: bool,
    /// Whether two bodies are at most this far apart, exactly, and events when this changes. Boxes
    /// grow by this distance.
    pub within: Option<f64>,
    /// The signed distance, with bounds, of bodies at most this far apart. Boxes grow by this
    /// distance. If it is infinite, all pairs of the two groups are measured: as many as the
    /// product of the group sizes.
    #[cfg_attr(feature = "serde", serde(with = "range"))]
    pub distance: Option<f64>,
    /// Features, witness points and normal of the pairs that have a distance. Without `distance`,
    /// pairs at most `within` apart are measured; if `within` is not set either, only bodies that
    /// share a point.
    pub features: bool,
    /// The depth of an overlap. Without this query and `local_depth`, an overlap has the distance 0
    /// and no lower bound. Without `distance` or `features`, only overlaps are measured.
    pub depth: bool,
    /// An upper bound of the depth of an overlap. It has no effect if `depth` is enabled or
    /// `manifold` requires the depth. It takes a fraction of the time of the depth, see
    /// [`Tracker::closest_with_local_depth`]. Convex bodies other than polyhedra, sharp or rounded,
    /// get the depth. Without `distance` or `features`, only overlaps are measured.
    ///
    /// [`Tracker::closest_with_local_depth`]: crate::Tracker::closest_with_local_depth
    #[cfg_attr(feature = "serde", serde(default))]
    pub local_depth: bool,
    /// The contact points of bodies within the prediction of these options. Includes the queries
    /// `features` and `depth`, or `local_depth` instead of `depth` if the options say so. Boxes
    /// grow by the prediction.
    pub manifold: Option<ManifoldOptions>,
    /// Continuous collision detection: the first time between two steps at which two bodies meet,
    /// as a bracket of this width. It finds collisions of bodies that
    /// [`Scene::advance`](super::Scene::advance) moves, however fast or thin they are; see
    /// [`Scene::impacts`](super::Scene::impacts). Boxes of both groups contain the whole swept
    /// motion.
    pub impact: Option<Tolerance>,
    /// The first time between two steps at which two bodies come within a distance, as a bracket of
    /// this width: [`impact`](field@Self::impact) with a distance. `within` finds only the bodies
    /// that are within a distance when a step is made. Boxes grow by the distance.
    #[cfg_attr(feature = "serde", serde(default))]
    pub impact_within: Option<(f64, Tolerance)>,
    /// Whether pairs of two fixed bodies are queried as well. They are not by default, because the
    /// parts of a cell or a building often touch by design. A step counts the pairs that were left
    /// out ([`StepWork::fixed_left_out`](super::StepWork::fixed_left_out)).
    #[cfg_attr(feature = "serde", serde(default))]
    pub fixed: bool,
}

impl PairQueries {
    /// Returns no queries: the bodies of the two groups are not even paired.
    #[must_use]
    pub const fn none() -> Self {
        Self {
            boxes: false,
            overlap: false,
            within: None,
            distance: None,
            features: false,
            depth: false,
            local_depth: false,
            manifold: None,
            impact: None,
            impact_within: None,
            fixed: false,
        }
    }

    /// Returns the queries with or without [`boxes`](field@Self::boxes).
    #[must_use]
    pub const fn boxes(mut self, boxes: bool) -> Self {
        self.boxes = boxes;
        self
    }

    /// Returns the queries with or without [`overlap`](field@Self::overlap).
    #[must_use]
    pub const fn overlap(mut self, overlap: bool) -> Self {
        self.overlap = overlap;
        self
    }

    /// Returns the queries with [`within`](field@Self::within) set to a distance.
    #[must_use]
    pub const fn within(mut self, within: f64) -> Self {
        self.within = Some(within);
        self
    }

    /// Returns the queries with [`distance`](field@Self::distance) up to a range.
    #[must_use]
    pub const fn distance(mut self, distance: f64) -> Self {
        self.distance = Some(distance);
        self
    }

    /// Returns the queries with or without [`features`](field@Self::features).
    #[must_use]
    pub const fn features(mut self, features: bool) -> Self {
        self.features = features;
        self
    }

    /// Returns the queries with or without [`depth`](field@Self::depth).
    #[must_use]
    pub const fn depth(mut self, depth: bool) -> Self {
        self.depth = depth;
        self
    }

    /// Returns the queries with or without [`local_depth`](field@Self::local_depth).
    #[must_use]
    pub const fn local_depth(mut self, local_depth: bool) -> Self {
        self.local_depth = local_depth;
        self
    }

    /// Returns the queries with [`manifold`](field@Self::manifold).
    #[must_use]
    pub const fn manifold(mut self, manifold: ManifoldOptions) -> Self {
        self.manifold = Some(manifold);
        self
    }

    /// Returns the queries with [`impact`](field@Self::impact)s in a bracket of this width.
    #[must_use]
    pub const fn impact(mut self, impact: Tolerance) -> Self {
        self.impact = Some(impact);
        self
    }

    /// Returns the queries with [`impact_within`](field@Self::impact_within) a distance, in a
    /// bracket of this width.
    #[must_use]
    pub const fn impact_within(mut self, distance: f64, tolerance: Tolerance) -> Self {
        self.impact_within = Some((distance, tolerance));
        self
    }

    /// Returns the queries with or without pairs of two [`fixed`](field@Self::fixed) bodies.
    #[must_use]
    pub const fn fixed(mut self, fixed: bool) -> Self {
        self.fixed = fixed;
        self
    }

    /// Returns the distances whose first times are queried, each with the width of its brackets.
    fn impacts(&self) -> [Option<(f64, Tolerance)>; 2] {
        [self.impact.map(|tolerance| (0.0, tolerance)), self.impact_within]
    }

    /// Returns an error if a distance or a manifold option is invalid: a file could not store it.
    fn check(&self) -> Result<(), SceneError> {
        let finite = |d: f64| (0.0..=SCENE_REACH).contains(&d);
        let refused = |value: f64| Err(SceneError::Range { value });
        if let Some(options) = self.manifold.filter(|m| !finite(m.prediction)) {
            return refused(options.prediction);
        }
        if self.manifold.is_some_and(|m| {
            [m.max_face_sine, m.rebuild_motion, m.reselect_motion]
                .iter()
                .any(|x| x.is_nan())
        }) {
            return Err(SceneError::ManifoldOptions);
        }
        for (distance, Tolerance::Distance(size) | Tolerance::Time(size)) in self.impacts().into_iter().flatten() {
            if let Some(value) = [distance, size].into_iter().find(|value| !finite(*value)) {
                return refused(value);
            }
        }
        match (self.within, self.distance) {
            (Some(d), _) if !finite(d) => refused(d),
            (_, Some(d)) if !(finite(d) || d == f64::INFINITY) => refused(d),
            _ => Ok(()),
        }
    }

    /// Returns the depth that the queries need of an overlap: the least that serves all of them.
    fn until(&self) -> DepthMode {
        let has_depth = self.depth || self.local_depth || self.manifold.is_some();
        let is_local = !self.depth && self.manifold.is_none_or(|m| m.local_depth);
        DepthMode::of_depth(has_depth, is_local)
    }

    fn resolved(&self) -> PairPlan {
        let measured = self.distance.is_some() || self.features || self.depth || self.local_depth;
        let range = self.distance.or_else(|| measured.then(|| self.within.unwrap_or(0.0)));
        let within = self.within.unwrap_or(NEVER);
        let impacts = self.impacts();
        let predicates = self.overlap || self.within.is_some() || impacts.iter().any(Option::is_some);
        let least = if self.overlap { 0.0 } else { NEVER };
        let least = impacts.iter().flatten().fold(least, |d, impact| d.larger(impact.0));
        let detail = match (self.features, measured, predicates, self.boxes) {
            _ if self.manifold.is_some() => Detail::Manifold,
            (true, ..) => Detail::Features,
            (_, true, ..) => Detail::Distance,
            (_, _, true, _) => Detail::Predicates,
            (.., true) => Detail::Boxes,
            _ => Detail::Nothing,
        };
        let prediction = self.manifold.map_or(NEVER, |m| m.prediction);
        let range = range.unwrap_or(NEVER).larger(prediction);
        PairPlan {
            detail,
            boxes: self.boxes,
            overlap: self.overlap,
            within,
            range,
            until: self.until(),
            manifold: self.manifold,
            impacts,
            fixed: self.fixed,
            reach: least.larger(within).larger(range),
        }
    }
}

/// Threshold below every distance: it means that the query is not enabled.
pub(super) const NEVER: f64 = f64::NEG_INFINITY;

/// The last stage of the pipeline that a pair needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Detail {
    Nothing,
    Boxes,
    Predicates,
    Distance,
    Features,
    Manifold,
}

/// Queries in the form that a step reads.
#[derive(Clone, Copy, Debug)]
pub(super) struct PairPlan {
    pub(super) detail: Detail,
    pub(super) boxes: bool,
    pub(super) overlap: bool,
    /// The distance of `within`, or [`NEVER`].
    pub(super) within: f64,
    /// The largest distance that is computed, or [`NEVER`].
    pub(super) range: f64,
    /// The depth that overlaps get.
    pub(super) until: DepthMode,
    /// Options of the contact points, if enabled.
    pub(super) manifold: Option<ManifoldOptions>,
    /// Distances whose first times are queried, and the widths of their brackets.
    pub(super) impacts: [Option<(f64, Tolerance)>; 2],
    /// Whether pairs of two fixed bodies are queried.
    pub(super) fixed: bool,
    /// The largest threshold: beyond this distance the answer to every query is no.
    pub(super) reach: f64,
}

impl PairPlan {
    /// Returns whether any first time is queried.
    #[inline]
    pub(super) fn has_impacts(&self) -> bool {
        self.impacts[0].is_some() || self.impacts[1].is_some()
    }

    /// Returns whether a query is enabled, but not for two fixed bodies.
    pub(super) fn leaves_fixed_out(&self) -> bool {
        self.detail > Detail::Nothing && !self.fixed
    }
}

/// Index of an unordered pair of groups.
pub(super) type GroupPair = u16;

/// Returns the index of the unordered pair of two groups.
pub(super) fn group_pair_of(g: Group, h: Group) -> GroupPair {
    u16::from(g.0.min(h.0)) * GROUPS as u16 + u16::from(g.0.max(h.0))
}

/// The queries of all pairs of groups.
#[derive(Clone, Debug)]
pub(super) struct Table {
    queries: Box<[PairQueries]>,
    plans: Box<[PairPlan]>,
    impacts: u32,
    manifolds: u32,
}

impl Default for Table {
    fn default() -> Self {
        let nothing = PairQueries::none();
        Self {
            queries: alloc::vec![nothing; GROUPS * GROUPS].into(),
            plans: alloc::vec![nothing.resolved(); GROUPS * GROUPS].into(),
            impacts: 0,
            manifolds: 0,
        }
    }
}

impl Table {
    pub(super) fn set_queries(&mut self, g: Group, h: Group, queries: PairQueries) -> Result<(), SceneError> {
        queries.check()?;
        let groups = usize::from(group_pair_of(g, h));
        self.queries[groups] = queries;
        self.plans[groups] = queries.resolved();
        self.impacts = self.groups(|queries| queries.impact.is_some() || queries.impact_within.is_some());
        self.manifolds = self.groups(|queries| queries.manifold.is_some());
        Ok(())
    }

    /// Returns the groups with queries that `is_meant` accepts, as bits.
    fn groups(&self, is_meant: impl Fn(&PairQueries) -> bool) -> u32 {
        let calls = |g: &u8| (0..GROUPS as u8).any(|h| is_meant(&self.queries(Group(*g), Group(h))));
        (0..GROUPS as u8).filter(calls).fold(0, |mask, g| mask | 1 << g)
    }

    /// Returns the groups with which contact points are enabled, as bits.
    pub(super) fn manifold_groups(&self) -> u32 {
        self.manifolds
    }

    /// Returns the groups with which an impact is enabled, as bits.
    pub(super) fn impact_groups(&self) -> u32 {
        self.impacts
    }

    pub(super) fn queries(&self, g: Group, h: Group) -> PairQueries {
        self.queries[usize::from(group_pair_of(g, h))]
    }

    #[inline]
    pub(super) fn plan(&self, groups: GroupPair) -> &PairPlan {
        &self.plans[usize::from(groups)]
    }

    /// Returns the groups with which any query is enabled, as bits.
    pub(super) fn partners(&self, g: Group) -> u32 {
        let pairs = |h: &u8| self.plan(group_pair_of(g, Group(*h))).detail > Detail::Nothing;
        (0..GROUPS as u8).filter(pairs).fold(0, |mask, h| mask | 1 << h)
    }

    /// Returns the groups with whose fixed bodies the fixed bodies of a group are paired, as bits.
    pub(super) fn fixed_partners(&self, g: Group) -> u32 {
        let pairs = |h: &u8| self.plan(group_pair_of(g, Group(*h))).fixed;
        self.partners(g) & (0..GROUPS as u8).filter(pairs).fold(0, |mask, h| mask | 1 << h)
    }

    /// Returns the growth of the boxes of a group: half the largest threshold, because the boxes of
    /// the other group grow by the other half.
    pub(super) fn growth(&self, g: Group) -> f64 {
        let reach = |h: u8| self.plan(group_pair_of(g, Group(h))).reach;
        0.5 * (0..GROUPS as u8).map(reach).fold(0.0, f64::larger)
    }

    /// Iterates over the pairs of groups with any query, each pair once.
    #[cfg(feature = "serde")]
    pub(super) fn entries(&self) -> impl Iterator<Item = (Group, Group, PairQueries)> + '_ {
        let all = (0..GROUPS as u8).flat_map(|g| (g..GROUPS as u8).map(move |h| (Group(g), Group(h))));
        all.map(|(g, h)| (g, h, self.queries(g, h)))
            .filter(|(.., queries)| *queries != PairQueries::none())
    }
}

/// Serialization of a range. Infinity, which some formats cannot store, is written as the largest
/// number.
#[cfg(feature = "serde")]
mod range {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use crate::base::num::extremes::Bounded;

    pub(super) fn serialize<S: Serializer>(range: &Option<f64>, serializer: S) -> Result<S::Ok, S::Error> {
        range.map(|d| d.at_most(f64::MAX)).serialize(serializer)
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
        let range = Option::<f64>::deserialize(deserializer)?;
        Ok(range.map(|d| if d == f64::MAX { f64::INFINITY } else { d }))
    }
}

/// Returns the name of an enabled query that two kinds cannot answer, if there is one.
fn unanswered(queries: &PairQueries, a: GeometryKind, b: GeometryKind) -> Option<&'static str> {
    if a.is_convex() && b.is_convex() {
        return None;
    }
    if a == GeometryKind::HalfSpace || b == GeometryKind::HalfSpace {
        // Contacts of a half-space are groups, which need the feature.
        let has_contacts = cfg!(feature = "meshes");
        return queries.manifold.filter(|_| !has_contacts).map(|_| "manifold");
    }
    if queries.depth || queries.local_depth {
        return Some(if queries.depth { "depth" } else { "local_depth" });
    }
    let is_surface = |kind: GeometryKind| kind == GeometryKind::BezierSurface;
    if !is_surface(a) && !is_surface(b) {
        return None;
    }
    queries.manifold.map(|_| "manifold")
}

/// The number of bodies by group and kind. Two fixed bodies are not paired unless queries say so,
/// so fixed bodies are counted separately.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Census(BTreeMap<Member, u32>);

/// Group and kind of a body, and whether the body is fixed.
pub(super) type Member = (Group, GeometryKind, bool);

impl Census {
    /// Adds one body.
    pub(super) fn add(&mut self, member: Member) {
        *self.0.entry(member).or_insert(0) += 1;
    }

    /// Removes one body.
    pub(super) fn remove(&mut self, member: Member) {
        if let Some(count) = self.0.get_mut(&member) {
            *count -= 1;
            if *count == 0 {
                self.0.remove(&member);
            }
        }
    }

    /// Returns whether any body of these groups (bits) is a compound, a mesh or a surface.
    pub(super) fn has_parts(&self, groups: u32) -> bool {
        let of = |key: &&Member| groups & 1 << key.0.number() != 0 && !key.1.is_convex();
        self.0.keys().any(|key| of(&key))
    }

    /// Returns the number of bodies of the groups that `is_asked` accepts.
    pub(super) fn count(&self, is_asked: impl Fn(Group) -> bool) -> u64 {
        let asked = self.0.iter().filter(|(key, _)| is_asked(key.0));
        asked.map(|(_, count)| u64::from(*count)).sum()
    }

    /// Returns the number of pairs of fixed bodies of groups that `is_meant` accepts.
    pub(super) fn fixed_pairs(&self, is_meant: impl Fn(Group, Group) -> bool) -> u64 {
        let mut fixed = [0; GROUPS];
        for (key, count) in self.0.iter().filter(|(key, _)| key.2) {
            fixed[key.0.index()] += u64::from(*count);
        }
        let filled = || (0..GROUPS as u8).map(Group).filter(|g| fixed[g.index()] > 0);
        let mut pairs = 0;
        for g in filled() {
            for h in filled().filter(|h| g <= *h && is_meant(g, *h)) {
                let (n, m) = (fixed[g.index()], fixed[h.index()]);
                pairs += if g == h { n * (n - 1) / 2 } else { n * m };
            }
        }
        pairs
    }

    /// Returns an error if bodies of two groups cannot answer the queries.
    pub(super) fn check_queries(&self, these: Group, those: Group, queries: &PairQueries) -> Result<(), SceneError> {
        let mut all = self.0.keys().filter(|key| key.0 == these);
        all.try_for_each(|key| self.check_pairs(*key, 2, |other| (other == those).then_some(*queries)))
    }

    /// Returns an error if a new body, paired with the bodies of the scene, cannot answer the
    /// queries of their groups.
    pub(super) fn check_body(&self, key: Member, queries: impl Fn(Group) -> PairQueries) -> Result<(), SceneError> {
        self.check_pairs(key, 1, |other| Some(queries(other)))
    }

    /// Checks the pairs of a body of one key with all others. Bodies of the same key count if there
    /// are at least `least`.
    fn check_pairs(
        &self,
        key: Member,
        least: u32,
        queries: impl Fn(Group) -> Option<PairQueries>,
    ) -> Result<(), SceneError> {
        let (_, these, is_fixed) = key;
        for (other, count) in &self.0 {
            if key == *other && *count < least {
                continue;
            }
            let asked = queries(other.0).filter(|e| e.fixed || !(is_fixed && other.2));
            if let Some(query) = asked.and_then(|e| unanswered(&e, these, other.1)) {
                let those = other.1;
                return Err(SceneError::Unanswered { query, these, those });
            }
        }
        Ok(())
    }
}
