//! Pairs that are never measured.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::vec::Vec;

use crate::cell::Cell;
use crate::error::PlanError;
use crate::names::{CellBody, CellPair, Select};

/// Excluded pairs.
impl Cell {
    /// Excludes all pairs of a body of `a` and a body of `b`, and returns those that were measured
    /// before.
    ///
    /// Excluded pairs are never measured and may touch, for example adjacent links of an arm. A
    /// body that is added later is not excluded, even if it has the name.
    ///
    /// # Errors
    /// Returns an error if no body has one of the names, if it is the name of a link without bodies, or
    /// if both are the same body or link. Then nothing changes.
    #[doc(alias = "allow")]
    #[doc(alias = "ignore")]
    #[doc(alias = "allowed collision matrix")]
    pub fn exclude<'a>(
        &mut self,
        a: impl Into<Select<'a>>,
        b: impl Into<Select<'a>>,
    ) -> Result<Vec<CellPair>, PlanError> {
        self.exclude_because(a, b, "User")
    }

    /// Excludes pairs as [`exclude`](Self::exclude) does, and notes why: `Adjacent`, `Never`, or what a
    /// person should read. A pair that is excluded already has this reason from then on.
    ///
    /// # Errors
    /// As [`exclude`](Self::exclude).
    pub fn exclude_because<'a>(
        &mut self,
        a: impl Into<Select<'a>>,
        b: impl Into<Select<'a>>,
        reason: &str,
    ) -> Result<Vec<CellPair>, PlanError> {
        let mut pairs = self.pairs_of(a.into(), b.into())?;
        let reason: Arc<str> = reason.into();
        pairs.retain(|pair| self.excluded.insert(*pair, reason.clone()).is_none());
        self.changes.note(|changes| changes.pairs.extend(&pairs));
        Ok(pairs)
    }

    /// Excludes a pair, unless it is excluded.
    pub(super) fn note_excluded(&mut self, pair: CellPair, reason: &str) {
        self.excluded.entry(pair).or_insert_with(|| reason.into());
        self.changes.note(|changes| changes.pairs.push(pair));
    }

    /// Includes all pairs of a body of `a` and a body of `b` again, and returns those that were
    /// excluded.
    ///
    /// # Errors
    /// As [`exclude`](Self::exclude).
    #[doc(alias = "disallow")]
    pub fn include<'a>(
        &mut self,
        a: impl Into<Select<'a>>,
        b: impl Into<Select<'a>>,
    ) -> Result<Vec<CellPair>, PlanError> {
        let mut pairs = self.pairs_of(a.into(), b.into())?;
        pairs.retain(|pair| self.excluded.remove(pair).is_some());
        self.changes.note(|changes| changes.pairs.extend(&pairs));
        Ok(pairs)
    }

    /// Excludes all pairs for which `is_excluded` returns true, without a reason.
    ///
    /// ```
    /// # use lin_canny_plan::{Cell, CellBody};
    /// # use lin_canny::{Shape, nalgebra::Isometry3};
    /// let mut cell = Cell::new();
    /// let [arm, hand] = ["arm", "hand"].map(|name| cell.robot_body(name, Shape::ball(0.1).unwrap()));
    /// cell.add_obstacle("post", Shape::ball(0.2)?, Isometry3::translation(1.0, 0.0, 0.0))?;
    /// // The robot is checked against the post only.
    /// cell.exclude_if(|pair| matches!(pair.b, CellBody::Robot(_)));
    /// assert!(cell.excluded().eq([[arm, hand]]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn exclude_if(&mut self, is_excluded: impl Fn(CellPair) -> bool) {
        let all: Vec<CellBody> = self.bodies().map(|b| b.0).collect();
        for (k, &a) in all.iter().enumerate() {
            let pairs = all[k + 1..].iter().filter_map(|&b| CellPair::new(a, b));
            for pair in pairs.filter(|pair| is_excluded(*pair)) {
                self.note_excluded(pair, "");
            }
        }
    }

    /// Returns the excluded pairs in ascending order, each with the smaller id first.
    ///
    /// Pairs of bodies that keep their relative pose are never measured, and are not in this view
    /// unless they are excluded as well.
    #[doc(alias = "allow")]
    #[doc(alias = "allowed collision matrix")]
    pub fn excluded(&self) -> impl ExactSizeIterator<Item = [CellBody; 2]> {
        self.excluded.keys().map(|pair| [pair.a, pair.b])
    }

    /// Returns the reason of an excluded pair, empty if none was given; `None` if it is not excluded.
    #[must_use]
    pub fn exclusion(&self, pair: CellPair) -> Option<&str> {
        self.excluded.get(&pair).map(|reason| &**reason)
    }

    /// Returns the names of excluded pairs with the reason: each two names once, if all their pairs are
    /// excluded. The reason is that of the last pair with one.
    #[must_use]
    #[doc(alias = "allowed collision matrix")]
    pub fn excluded_names(&self) -> Vec<([&str; 2], &str)> {
        let mut counts: BTreeMap<[&str; 2], (usize, &str)> = BTreeMap::new();
        for (pair, reason) in &self.excluded {
            let mut names = [self.name(pair.a), self.name(pair.b)];
            names.sort_unstable();
            let (count, why) = counts.entry(names).or_default();
            *count += 1;
            if !reason.is_empty() {
                *why = reason;
            }
        }
        let mut of_name: BTreeMap<&str, Vec<CellBody>> = BTreeMap::new();
        for (id, name) in self.bodies() {
            of_name.entry(name).or_default().push(id);
        }
        let is_whole = |names: &[&str; 2], count: usize| {
            let pairs = of_name[names[0]]
                .iter()
                .flat_map(|a| of_name[names[1]].iter().map(move |b| (*a, *b)));
            let pairs: BTreeSet<_> = pairs.filter_map(|(a, b)| CellPair::new(a, b)).collect();
            pairs.len() == count
        };
        let whole = counts.into_iter().filter(|(names, (count, _))| is_whole(names, *count));
        whole.map(|(names, (_, reason))| (names, reason)).collect()
    }
}
