//! Effects that pairs of kinds of shapes can answer.

use alloc::collections::BTreeMap;

use super::SceneError;
use super::effects::{Effects, Group};
use crate::pair_tracker::geometry::ShapeKind;

/// Returns the name of an effect called for that two kinds cannot answer, if there is one.
fn unanswered(effects: &Effects, a: ShapeKind, b: ShapeKind) -> Option<&'static str> {
    if a.is_convex() && b.is_convex() {
        return None;
    }
    if effects.depth || effects.local_depth {
        return Some(if effects.depth { "depth" } else { "local_depth" });
    }
    let is_surface = |kind: ShapeKind| kind == ShapeKind::Surface;
    if !is_surface(a) && !is_surface(b) {
        return None;
    }
    effects.manifold.map(|_| "manifold")
}

/// The number of bodies by group and kind. Two fixed bodies make no pair, so fixed bodies are
/// counted apart.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Census(BTreeMap<Member, u32>);

/// Group and kind of a body, and whether the body is fixed.
pub(super) type Member = (Group, ShapeKind, bool);

impl Census {
    /// Counts one body more.
    pub(super) fn add(&mut self, member: Member) {
        *self.0.entry(member).or_insert(0) += 1;
    }

    /// Counts one body less.
    pub(super) fn remove(&mut self, member: Member) {
        if let Some(count) = self.0.get_mut(&member) {
            *count -= 1;
            if *count == 0 {
                self.0.remove(&member);
            }
        }
    }

    /// Returns whether a body of these groups, as bits, is a composite or a mesh.
    pub(super) fn has_parts(&self, groups: u32) -> bool {
        let of = |key: &&Member| groups & 1 << key.0.number() != 0 && !key.1.is_convex();
        self.0.keys().any(|key| of(&key))
    }

    /// Returns the number of bodies of the groups that `is_asked` accepts.
    pub(super) fn count(&self, is_asked: impl Fn(Group) -> bool) -> u64 {
        let asked = self.0.iter().filter(|(key, _)| is_asked(key.0));
        asked.map(|(_, count)| u64::from(*count)).sum()
    }

    /// Refuses effects that the bodies of two groups cannot answer.
    pub(super) fn check_effects(&self, these: Group, those: Group, effects: &Effects) -> Result<(), SceneError> {
        let mut all = self.0.keys().filter(|key| key.0 == these);
        all.try_for_each(|key| self.check_pairs(*key, 2, |other| (other == those).then_some(*effects)))
    }

    /// Refuses a body to come whose pairs with the bodies there are cannot answer the effects of
    /// their groups.
    pub(super) fn check_body(&self, key: Member, effects: impl Fn(Group) -> Effects) -> Result<(), SceneError> {
        self.check_pairs(key, 1, |other| Some(effects(other)))
    }

    /// Checks the pairs of bodies of one key; with bodies of the same key if there are `least`.
    fn check_pairs(
        &self,
        key: Member,
        least: u32,
        effects: impl Fn(Group) -> Option<Effects>,
    ) -> Result<(), SceneError> {
        let (_, these, is_fixed) = key;
        for (other, count) in &self.0 {
            if is_fixed && other.2 || key == *other && *count < least {
                continue;
            }
            if let Some(effect) = effects(other.0).and_then(|e| unanswered(&e, these, other.1)) {
                let those = other.1;
                return Err(SceneError::Unanswered { effect, these, those });
            }
        }
        Ok(())
    }
}
