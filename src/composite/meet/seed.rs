//! A close pair of items to begin with: no proof, but a distance beyond which boxes are passed by.

use crate::composite::front::NodePair;
use crate::composite::meet::frame::split_pair;
use crate::composite::meet::search::AT_ONCE;
use crate::composite::meet::search::{Judge, TreeSearch};

impl<J: Judge> TreeSearch<'_, J> {
    /// Finds a close pair of items: the few most promising pairs of nodes, level by level.
    pub(in crate::composite) fn seed(&mut self) {
        let mut beam = [[0u32; 2]; AT_ONCE];
        let mut width = 1;
        let mut leaves = [(f32::INFINITY, [0u32; 2], [0.0f32; 3]); AT_ONCE];
        while width > 0 {
            let mut halves = [[0; 2]; 2 * AT_ONCE];
            let mut count = 0;
            for &pair in &beam[..width] {
                match split_pair((self.a, self.b), self.frame, pair) {
                    Some(two) => {
                        halves[count..count + 2].copy_from_slice(&two);
                        count += 2;
                    }
                    None => keep(&mut leaves, (-f32::MAX, pair, [0.0; 3])),
                }
            }
            if count == 0 {
                break;
            }
            let found = self.bound(&halves[..count]);
            let mut next = [(f32::INFINITY, [0u32; 2], [0.0f32; 3]); AT_ONCE];
            for (k, &pair) in halves[..count].iter().enumerate() {
                let is_leaf = self.a.is_leaf(pair[0]) && self.b.is_leaf(pair[1]);
                keep(
                    if is_leaf { &mut leaves } else { &mut next },
                    (found.gap[k], pair, found.normal[k]),
                );
            }
            width = next.iter().filter(|x| x.0 < f32::INFINITY).count();
            (0..width).for_each(|k| beam[k] = next[k].1);
        }
        for (_, pair, normal) in leaves.into_iter().filter(|x| x.0 < f32::INFINITY).take(2) {
            self.judge_leaves(pair, normal);
        }
    }
}

/// Puts a pair into a list sorted by gap; the last one falls out.
fn keep(list: &mut [(f32, NodePair, [f32; 3]); AT_ONCE], new: (f32, NodePair, [f32; 3])) {
    if new.0 < list[AT_ONCE - 1].0 {
        list[AT_ONCE - 1] = new;
        list.sort_by(|p, q| p.0.total_cmp(&q.0));
    }
}
