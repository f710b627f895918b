//! Inputs that a kernel may meet, and those that it had better not.

use truth::rng::Rng;

/// Numbers of one kernel and one try.
pub(crate) struct Inputs {
    rng: Rng,
    kind: usize,
    last: f64,
}

impl Inputs {
    /// A number of single precision: ordinary, whole, or of some range, so that products of six stay finite.
    pub(crate) fn single(&mut self) -> f32 {
        let ordinary = self.rng.range(-1.0, 1.0);
        let x = match self.rng.below(4) {
            0 => self.rng.int(-2, 2) as f64,
            1 => ordinary * 2f64.powi(self.rng.int(-6, 6) as i32),
            _ => ordinary,
        };
        x as f32
    }

    /// The inputs of the `k`-th try.
    pub(crate) fn new(seed: u64, k: u64) -> Self {
        let mut rng = Rng::of_case(seed, k);
        let kind = rng.below(6);
        Self { rng, kind, last: 1.0 }
    }

    /// A number: ordinary, whole, of any size, below the normal ones, huge, or almost the last one.
    pub(crate) fn number(&mut self) -> f64 {
        let rng = &mut self.rng;
        let ordinary = rng.range(-1.0, 1.0);
        self.last = match if rng.chance(0.8) { self.kind } else { rng.below(6) } {
            0 => ordinary,
            1 => rng.int(-3, 3) as f64,
            2 => ordinary * 2f64.powi(rng.int(-600, 400) as i32),
            3 => ordinary * f64::MIN_POSITIVE,
            4 => ordinary * 2f64.powi(rng.int(300, 1023) as i32),
            _ => self.last * (1.0 + rng.int(-4, 4) as f64 * f64::EPSILON),
        };
        self.last
    }

    /// Several numbers.
    pub(crate) fn numbers<const K: usize>(&mut self) -> [f64; K] {
        std::array::from_fn(|_| self.number())
    }

    /// A number between two others.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        self.rng.range(low, high)
    }

    /// A whole number below `n`.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        self.rng.below(n)
    }

    /// A quaternion of length one but for rounding: of any direction, or near an axis.
    pub(crate) fn quaternion(&mut self) -> [f64; 4] {
        let mut q = self.rng.quat();
        if self.kind > 2 {
            let kept = self.rng.below(4);
            let small = 2f64.powi(-(self.rng.below(1100) as i32));
            q = std::array::from_fn(|k| if k == kept { q[k].signum() } else { q[k] * small });
            let norm = q.iter().map(|x| x * x).sum::<f64>().sqrt();
            q = q.map(|x| x / norm);
        }
        q
    }
}
