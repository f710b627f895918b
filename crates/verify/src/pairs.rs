//! The pairs of a scene: how lines name them, and which must be proven.

use crate::Stop;
use crate::json::Json;
use crate::scene::Scene;

impl Scene {
    fn number(&self, json: &Json) -> Result<usize, Stop> {
        let k = json.whole()?;
        if k < self.bodies.len() {
            Ok(k)
        } else {
            Stop::bad(format!("unknown body {k}"))
        }
    }

    /// Reads `[A,[B,...]]`: pairs in order.
    pub(crate) fn star(&self, json: &Json) -> Result<Vec<(usize, usize)>, Stop> {
        let [a, others] = json.list::<2>()?;
        let (a, mut all) = (self.number(a)?, Vec::new());
        for b in others.array()? {
            let b = self.number(b)?;
            all.push((a.min(b), a.max(b)));
        }
        let mut sorted = all.clone();
        sorted.sort_unstable();
        if all.is_empty() || all.iter().any(|x| x.0 == x.1) || sorted.windows(2).any(|x| x[0] == x[1]) {
            return Stop::bad("a list of pairs: empty, a body with itself, or a pair twice");
        }
        Ok(all)
    }

    /// Reads `[A,B]` with A < B.
    pub(crate) fn pair(&self, json: &Json) -> Result<(usize, usize), Stop> {
        let [a, b] = json.list::<2>()?;
        let (a, b) = (self.number(a)?, self.number(b)?);
        if a < b {
            Ok((a, b))
        } else {
            Stop::bad("a pair has the lesser number first")
        }
    }

    /// Refuses a proof of a pair that needs none.
    pub(crate) fn must_prove(&self, pair: (usize, usize)) -> Result<(), Stop> {
        if self.ignored.contains_key(&pair) || !(self.bodies[pair.0].moves || self.bodies[pair.1].moves) {
            return Stop::fails(format!(
                "{}: a proof of a pair that is ignored or rests",
                self.names(pair)
            ));
        }
        Ok(())
    }

    pub(crate) fn names(&self, (a, b): (usize, usize)) -> String {
        format!("{} against {}", self.bodies[a].name, self.bodies[b].name)
    }
}

/// Names the first pair that is neither ignored nor proven.
pub(crate) fn missing(scene: &Scene, proven: impl Fn(&(usize, usize)) -> bool) -> Result<(), Stop> {
    // Pairs of two bodies that rest are never visited: a file has many legs for few bytes.
    let every: Vec<usize> = (0..scene.bodies.len()).collect();
    let movers: Vec<usize> = every.iter().copied().filter(|k| scene.bodies[*k].moves).collect();
    let all = every.iter().flat_map(|a| {
        let others = if scene.bodies[*a].moves { &every } else { &movers };
        let first = others.partition_point(|b| b <= a);
        others[first..].iter().map(move |b| (*a, *b))
    });
    let mut missing = all.filter(|pair| !scene.ignored.contains_key(pair) && !proven(pair));
    missing
        .next()
        .map_or(Ok(()), |pair| Stop::fails(format!("no proof of {}", scene.names(pair))))
}

/// Returns the number of pairs to prove, and of pairs that rest and are not ignored.
pub(crate) fn needed(scene: &Scene) -> (usize, usize) {
    let pairs = |n: usize| n * n.saturating_sub(1) / 2;
    let rest = |pair: &(usize, usize)| !scene.bodies[pair.0].moves && !scene.bodies[pair.1].moves;
    let resting = pairs(scene.bodies.iter().filter(|b| !b.moves).count());
    let ignored_resting = scene.ignored.keys().filter(|pair| rest(pair)).count();
    let ignored = scene.ignored.len() - ignored_resting;
    (pairs(scene.bodies.len()) - resting - ignored, resting - ignored_resting)
}
