//! Reduction of many candidates to a few: the deepest, and the points that span the most area.

use super::MOST_POINTS;
use super::clip::ContactCandidate;
use crate::base::num::extremes::Extremes;
use crate::base::tolerance::STAY;

/// Indices of the chosen candidates.
#[derive(Debug, Default)]
pub(crate) struct Chosen {
    list: [usize; MOST_POINTS],
    count: usize,
}

impl Chosen {
    pub(crate) fn all(&self) -> &[usize] {
        &self.list[..self.count]
    }

    fn insert(&mut self, index: usize, choice: usize) {
        self.list[index..=self.count].rotate_right(1);
        self.list[index] = choice;
        self.count += 1;
    }
}

/// Chooses at most `most` candidates; `choices` must not be empty.
///
/// The first candidate is the deepest, the second is the farthest from the first, and each further
/// one adds the largest triangle to the polygon of the chosen points. No chosen point is within
/// `merge` of another, or of a side. Depths within `tie` count as equal. Among equals, and within a
/// factor in size, candidates with a bit in `kept` are preferred.
pub(crate) fn reduce(choices: &[ContactCandidate], kept: u64, most: usize, merge: f64, tie: f64) -> Chosen {
    let mut chosen = Chosen::default();
    let first = deepest(choices, kept, tie);
    chosen.insert(0, first);
    if choices.len() <= most {
        for k in 0..choices.len() {
            let apart = |&i: &usize| squared(between(&choices[i], &choices[k])) > merge * merge;
            if k != first && chosen.all().iter().all(apart) {
                chosen.insert(chosen.count, k);
            }
        }
        return chosen;
    }
    let far = |c: &ContactCandidate| {
        let squared = squared(between(&choices[first], c));
        (squared > merge * merge).then_some(squared)
    };
    if let Some(second) = largest(choices, kept, far)
        && most > 1
    {
        chosen.insert(1, second);
    }
    while chosen.count > 1 && chosen.count < most {
        match widest(choices, kept, &chosen, merge) {
            Some((index, k)) => chosen.insert(index, k),
            None => break,
        }
    }
    chosen
}

fn deepest(choices: &[ContactCandidate], kept: u64, tie: f64) -> usize {
    let least = choices.iter().fold(f64::INFINITY, |m, c| m.smaller(c.separation));
    let deep = |c: &ContactCandidate| c.separation <= least + tie;
    let old = (0..choices.len()).find(|&k| has_bit(kept, k) && deep(&choices[k]));
    old.or_else(|| choices.iter().position(deep)).unwrap_or(0)
}

/// Returns the candidate of greatest measure.
fn largest(
    choices: &[ContactCandidate],
    kept: u64,
    measure: impl Fn(&ContactCandidate) -> Option<f64>,
) -> Option<usize> {
    let mut best: Option<(f64, usize)> = None;
    for (k, c) in choices.iter().enumerate() {
        if let Some(m) = measure(c) {
            let m = if has_bit(kept, k) { STAY * m } else { m };
            if best.is_none_or(|(most, _)| m > most) {
                best = Some((m, k));
            }
        }
    }
    best.map(|(_, k)| k)
}

/// Returns the candidate that adds the most area beyond a side of the counter-clockwise polygon of
/// chosen points, and its index in the polygon.
fn widest(choices: &[ContactCandidate], kept: u64, chosen: &Chosen, merge: f64) -> Option<(usize, usize)> {
    let mut best: Option<(f64, usize, usize)> = None;
    for side in 0..chosen.count {
        let (p, q) = (chosen.list[side], chosen.list[(side + 1) % chosen.count]);
        let u = between(&choices[p], &choices[q]);
        let noise = merge * merge * squared(u);
        let beyond = |c: &ContactCandidate| {
            let v = between(&choices[p], c);
            let area = u[1] * v[0] - u[0] * v[1];
            (area > 0.0 && area * area > noise).then_some(area)
        };
        if let Some(k) = largest(choices, kept, beyond) {
            let area = beyond(&choices[k]).unwrap_or(0.0) * if has_bit(kept, k) { STAY } else { 1.0 };
            if best.is_none_or(|(most, ..)| area > most) {
                best = Some((area, side + 1, k));
            }
        }
    }
    best.map(|(_, index, k)| (index, k))
}

/// Returns whether bit `k` is set.
fn has_bit(bits: u64, k: usize) -> bool {
    k < 64 && bits >> k & 1 == 1
}

fn between(p: &ContactCandidate, q: &ContactCandidate) -> [f64; 2] {
    [q.at[0] - p.at[0], q.at[1] - p.at[1]]
}

fn squared(v: [f64; 2]) -> f64 {
    v[0] * v[0] + v[1] * v[1]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64, y: f64, separation: f64) -> ContactCandidate {
        ContactCandidate {
            at: [x, y],
            separation,
            on: ContactCandidate::WITNESS,
        }
    }

    fn ring(n: usize) -> Vec<ContactCandidate> {
        let angle = |k: usize| core::f64::consts::TAU * k as f64 / n as f64;
        (0..n).map(|k| at(angle(k).cos(), angle(k).sin(), k as f64)).collect()
    }

    extern crate std;
    use std::vec::Vec;

    #[test]
    fn the_deepest_stays_and_area_is_kept() {
        for n in 5..40 {
            let chosen = reduce(&ring(n), 0, 4, 1e-9, 1e-12);
            assert_eq!((chosen.all().len(), chosen.all()[0]), (4, 0));
            let vertices: Vec<_> = chosen.all().iter().map(|&k| ring(n)[k].at).collect();
            let area: f64 = (0..4)
                .map(|k| vertices[k][0] * vertices[(k + 1) % 4][1] - vertices[k][1] * vertices[(k + 1) % 4][0])
                .sum::<f64>();
            assert!(area / 2.0 > 1.4, "{n}: {}", area / 2.0);
        }
    }

    #[test]
    fn equal_points_and_points_in_line_are_dropped() {
        let mut points = ring(4);
        points.push(at(1.0, 1e-12, 0.0));
        points.push(at(0.5, 0.5, 0.0));
        assert_eq!(reduce(&points, 0, 5, 1e-9, 1e-12).all().len(), 4);
        let points = [at(0.0, 0.0, 0.0), at(1e-12, 0.0, 0.0), at(1.0, 0.0, -1.0)];
        assert_eq!(reduce(&points, 0, 8, 1e-9, 1e-12).all(), [2, 0]);
        assert_eq!(reduce(&points, 0, 1, 1e-9, 1e-12).all(), [2]);
        let line: Vec<_> = (0..9).map(|k| at(f64::from(k), 0.0, 0.0)).collect();
        assert_eq!(reduce(&line, 0, 4, 1e-9, 1e-12).all(), [0, 8]);
    }

    #[test]
    fn among_equals_the_kept_stay() {
        let mut points = ring(8);
        points.iter_mut().for_each(|p| p.separation = 0.0);
        let mut chosen: Vec<_> = reduce(&points, 0b1010_1010, 4, 1e-9, 1e-12).all().to_vec();
        chosen.sort_unstable();
        assert_eq!(chosen, [1, 3, 5, 7]);
    }
}
