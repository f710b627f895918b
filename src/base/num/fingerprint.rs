//! Fingerprints: 128-bit hashes by which cached state recognises the bodies from which it was made.
//!
//! State applied to the wrong body would prove something false, and bodies may come from untrusted
//! files. So the hash must resist deliberate collisions. A hash whose steps can be inverted one by
//! one does not, and neither does one of 64 bits, because `2^32` tries find a collision. The
//! function is SipHash-2-4 (Aumasson and Bernstein 2012) with a result of 128 bits, for which a
//! collision takes `2^64` tries. SipHash is made for secret keys. Here the key is zero, so that
//! another process recognises saved state. The hashed sequence of words determines the body, so no
//! two bodies have the same sequence.
//!
//! The input consists of words and needs no buffer, unlike the bytes in the crate `siphasher`, so
//! these few lines are the whole function. A cryptographic digest such as BLAKE2b takes several
//! times as long, a considerable fraction of the time to build a mesh.

use nalgebra::Vector3;

/// A 128-bit hash of a body: bodies with equal fingerprints are identical for all practical
/// purposes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Fingerprint([u64; 2]);

impl Fingerprint {
    /// Returns the fingerprint of a kind of body that numbers describe.
    pub(crate) fn of(kind: [u8; 8], numbers: &[f64]) -> Self {
        let mut all = Fingerprinter::new(kind);
        numbers.iter().for_each(|x| all.number(*x));
        all.end()
    }

    /// Returns the fingerprint of a body and a number that changes it as `kind` names.
    pub(crate) fn with(self, kind: [u8; 8], number: f64) -> Self {
        let mut all = Fingerprinter::new(kind);
        all.fingerprint(self);
        all.number(number);
        all.end()
    }
}

/// A fingerprint to which words are added.
pub(crate) struct Fingerprinter {
    state: [u64; 4],
    words: u64,
}

/// Rounds per word.
const ROUNDS: usize = 2;

/// Rounds per half of the result.
const LAST_ROUNDS: usize = 4;

impl Fingerprinter {
    /// Starts the fingerprint of a kind of body.
    pub(crate) fn new(kind: [u8; 8]) -> Self {
        // "somepseudorandomlygeneratedbytes", and the mark of a result of 128 bits.
        let state = [
            0x736f_6d65_7073_6575,
            0x646f_7261_6e64_6f6d ^ 0xee,
            0x6c79_6765_6e65_7261,
            0x7465_6462_7974_6573,
        ];
        let mut begun = Self { state, words: 0 };
        begun.word(u64::from_le_bytes(kind));
        begun
    }

    #[inline]
    pub(crate) fn word(&mut self, word: u64) {
        self.state[3] ^= word;
        self.rounds::<ROUNDS>();
        self.state[0] ^= word;
        self.words = self.words.wrapping_add(1);
    }

    pub(crate) fn number(&mut self, number: f64) {
        self.word(number.to_bits());
    }

    pub(crate) fn vector(&mut self, vector: &Vector3<f64>) {
        vector.iter().for_each(|x| self.number(*x));
    }

    pub(crate) fn fingerprint(&mut self, Fingerprint([low, high]): Fingerprint) {
        self.word(low);
        self.word(high);
    }

    /// Adds 32-bit numbers, two per word. The words before must determine how many numbers there
    /// are.
    pub(crate) fn indices(&mut self, indices: impl Iterator<Item = u32>) {
        let mut half = None;
        for index in indices.map(u64::from) {
            half = match half {
                None => Some(index),
                Some(low) => {
                    self.word(low | index << 32);
                    None
                }
            };
        }
        self.word(half.unwrap_or(u64::MAX));
    }

    /// Returns the fingerprint of all words.
    pub(crate) fn end(mut self) -> Fingerprint {
        // The last word contains the number of bytes modulo 256.
        self.word((self.words * 8) << 56);
        self.state[2] ^= 0xee;
        let low = self.result();
        self.state[1] ^= 0xdd;
        Fingerprint([low, self.result()])
    }

    fn result(&mut self) -> u64 {
        self.rounds::<LAST_ROUNDS>();
        self.state.iter().fold(0, |all, x| all ^ x)
    }

    #[inline]
    fn rounds<const N: usize>(&mut self) {
        let [mut a, mut b, mut c, mut d] = self.state;
        for _ in 0..N {
            a = a.wrapping_add(b);
            c = c.wrapping_add(d);
            b = b.rotate_left(13) ^ a;
            d = d.rotate_left(16) ^ c;
            a = a.rotate_left(32).wrapping_add(d);
            c = c.wrapping_add(b);
            b = b.rotate_left(17) ^ c;
            d = d.rotate_left(21) ^ a;
            c = c.rotate_left(32);
        }
        self.state = [a, b, c, d];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values from another implementation, in another language, for bytes.
    #[test]
    fn fingerprints_are_those_of_siphash_2_4() {
        let mut words = Fingerprinter::new(*b"ellipsoi");
        assert_eq!(
            Fingerprinter::new(*b"ellipsoi").end(),
            Fingerprint([0xac4e_e6f8_4c93_0bc2, 0x4da7_cad2_0d94_6671])
        );
        (0..5_u64).for_each(|k| words.word(k.wrapping_mul(0x9e37_79b9_7f4a_7c15)));
        assert_eq!(words.end(), Fingerprint([0x6e5c_572e_0542_1cf7, 0xcdc4_5253_bb34_e206]));
    }

    /// Each bit of a word changes about half of the bits of the result.
    #[test]
    fn every_bit_counts() {
        let of = |x: u64, n: u64| {
            let mut all = Fingerprinter::new(*b"anything");
            all.word(x);
            (0..n).for_each(|k| all.word(k));
            all.end().0
        };
        for n in 0..3 {
            for bit in 0..64 {
                let (p, q) = (of(0, n), of(1 << bit, n));
                let changed = (p[0] ^ q[0]).count_ones() + (p[1] ^ q[1]).count_ones();
                assert!((32..=96).contains(&changed), "{n} {bit}: {changed}");
            }
        }
    }

    #[test]
    fn lists_of_indices_are_told_apart() {
        let of = |list: &[u32]| {
            let mut all = Fingerprinter::new(*b"anything");
            all.word(list.len() as u64);
            all.indices(list.iter().copied());
            all.end()
        };
        let lists: [&[u32]; 6] = [&[], &[0], &[0, 0], &[1, 0], &[0, 1], &[u32::MAX, u32::MAX]];
        for (k, p) in lists.iter().enumerate() {
            assert!(lists[..k].iter().all(|q| of(p) != of(q)), "{p:?}");
        }
    }
}
