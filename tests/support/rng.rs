//! Seeded generator of random numbers: xoshiro256++ (Blackman and Vigna 2019), with its state
//! filled by splitmix64.
//!
//! The same seed gives the same bits on every machine, so a seed identifies a failing case. The
//! unit tests of the library and the package `truth` use this file, so it depends on neither.

/// The generator. `Rng::new(seed)` accepts any seed, including zero.
#[derive(Clone, Debug)]
pub struct Rng {
    state: [u64; 4],
}

impl Rng {
    /// Returns the stream of `seed`.
    pub fn new(seed: u64) -> Self {
        let mut s = seed;
        Self {
            state: std::array::from_fn(|_| splitmix(&mut s)),
        }
    }

    /// Returns a separate stream for the `k`-th case of this seed, independent of earlier draws.
    pub fn of_case(seed: u64, k: u64) -> Self {
        let mut s = k;
        Self::new(seed ^ splitmix(&mut s))
    }

    /// Returns 64 random bits.
    pub fn bits(&mut self) -> u64 {
        let s = &mut self.state;
        let out = s[0].wrapping_add(s[3]).rotate_left(23).wrapping_add(s[0]);
        let t = s[1] << 17;
        s[2] ^= s[0];
        s[3] ^= s[1];
        s[1] ^= s[2];
        s[0] ^= s[3];
        s[2] ^= t;
        s[3] = s[3].rotate_left(45);
        out
    }

    /// Returns a uniform number in `[0, 1)`, a multiple of `2^-53`.
    pub fn uniform(&mut self) -> f64 {
        (self.bits() >> 11) as f64 * (0.5 / (1u64 << 52) as f64)
    }

    /// Returns a uniform number in `[lo, hi)`.
    pub fn range(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * self.uniform()
    }

    /// Returns a number in `[lo, hi)` with a uniform logarithm; both limits must be positive.
    pub fn log_range(&mut self, lo: f64, hi: f64) -> f64 {
        self.range(lo.ln(), hi.ln()).exp()
    }

    /// Returns a uniform number in `0..n`, `n > 0`. The bias is below `n / 2^64`.
    pub fn below(&mut self, n: usize) -> usize {
        ((u128::from(self.bits()) * n as u128) >> 64) as usize
    }

    /// Returns a uniform number in `lo..=hi`.
    pub fn int(&mut self, lo: i64, hi: i64) -> i64 {
        lo + self.below((hi - lo + 1) as usize) as i64
    }

    /// Returns true with probability `p`.
    pub fn chance(&mut self, p: f64) -> bool {
        self.uniform() < p
    }

    /// Returns `1` or `-1`.
    pub fn sign(&mut self) -> f64 {
        if self.bits() >> 63 == 0 { 1.0 } else { -1.0 }
    }

    /// Returns one of `items`, which must not be empty.
    pub fn pick<'a, T>(&mut self, items: &'a [T]) -> &'a T {
        &items[self.below(items.len())]
    }

    /// Shuffles `items` (Fisher and Yates).
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for i in (1..items.len()).rev() {
            items.swap(i, self.below(i + 1));
        }
    }

    /// Returns a uniform direction, unit up to rounding.
    pub fn unit(&mut self) -> [f64; 3] {
        loop {
            let p: [f64; 3] = std::array::from_fn(|_| self.range(-1.0, 1.0));
            let s: f64 = p.iter().map(|x| x * x).sum();
            if (1e-4..=1.0).contains(&s) {
                return p.map(|x| x / s.sqrt());
            }
        }
    }

    /// Returns a uniform point in the unit ball.
    pub fn in_ball(&mut self) -> [f64; 3] {
        let r = self.uniform().cbrt();
        self.unit().map(|x| x * r)
    }

    /// Returns a uniform rotation as a quaternion `x, y, z, w`, unit up to rounding.
    pub fn quat(&mut self) -> [f64; 4] {
        loop {
            let q: [f64; 4] = std::array::from_fn(|_| self.range(-1.0, 1.0));
            let s: f64 = q.iter().map(|x| x * x).sum();
            if (1e-4..=1.0).contains(&s) {
                return q.map(|x| x / s.sqrt());
            }
        }
    }
}

/// One step of splitmix64 (Steele, Lea and Flood 2014).
fn splitmix(s: &mut u64) -> u64 {
    *s = s.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *s;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec::Vec;

    #[test]
    fn splitmix_gives_its_published_first_values() {
        let mut s = 1234567;
        assert_eq!(splitmix(&mut s), 6457827717110365317);
        assert_eq!(splitmix(&mut s), 3203168211198807973);
    }

    #[test]
    fn the_same_seed_gives_the_same_stream_and_cases_differ() {
        let (mut a, mut b, mut c) = (Rng::new(7), Rng::new(7), Rng::of_case(7, 1));
        let first: Vec<u64> = (0..100).map(|_| a.bits()).collect();
        assert!(first.iter().all(|&x| x == b.bits()));
        assert!(first.iter().any(|&x| x != c.bits()));
    }

    #[test]
    fn numbers_keep_to_their_ranges_and_means() {
        let mut r = Rng::new(1);
        let n = 20_000;
        let mean = (0..n)
            .map(|_| r.uniform())
            .inspect(|x| assert!((0.0..1.0).contains(x)))
            .sum::<f64>()
            / n as f64;
        assert!((mean - 0.5).abs() < 0.01);
        assert!((0..n).all(|_| (1e-6..1e6).contains(&r.log_range(1e-6, 1e6))));
        let mut seen = [0; 7];
        (0..n).for_each(|_| seen[r.below(7)] += 1);
        assert!(seen.iter().all(|&k| k > n / 8));
        assert!((0..n).all(|_| (-2..=3).contains(&r.int(-2, 3))));
    }

    #[test]
    fn directions_and_quaternions_are_unit_and_balanced() {
        let mut r = Rng::new(2);
        let mut sum = [0.0; 3];
        for _ in 0..10_000 {
            let u = r.unit();
            assert!((u.iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-15);
            assert!((r.quat().iter().map(|x| x * x).sum::<f64>() - 1.0).abs() < 1e-15);
            sum = std::array::from_fn(|i| sum[i] + u[i]);
        }
        let inner = (0..10_000)
            .filter(|_| r.in_ball().iter().map(|x| x * x).sum::<f64>() < 0.25)
            .count();
        assert!(
            (1100..1400).contains(&inner),
            "an eighth lies in the inner half: {inner}"
        );
        assert!(sum.iter().all(|s| s.abs() < 300.0));
    }

    #[test]
    fn shuffling_keeps_every_item() {
        let mut items: Vec<u32> = (0..50).collect();
        Rng::new(3).shuffle(&mut items);
        assert_ne!(items, (0..50).collect::<Vec<_>>());
        items.sort_unstable();
        assert_eq!(items, (0..50).collect::<Vec<_>>());
    }
}
