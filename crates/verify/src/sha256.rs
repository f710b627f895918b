//! SHA-256 (FIPS 180-4, section 6.2), for the hash in the tail of a receipt.

/// First 32 bits of the fractional part of the cube root (square root) of a prime, by integers.
const fn fraction(prime: u128, cube: bool) -> u32 {
    // The root of prime 2^96 (prime 2^64) is that of the prime, times 2^32.
    let scaled = if cube { prime << 96 } else { prime << 64 };
    let (mut root, mut bit) = (0u128, 1u128 << 36);
    while bit > 0 {
        let next = root | bit;
        let power = if cube { next * next * next } else { next * next };
        if power <= scaled {
            root = next;
        }
        bit >>= 1;
    }
    root as u32
}

const fn fractions<const N: usize>(cube: bool) -> [u32; N] {
    let (mut all, mut count, mut number) = ([0; N], 0, 2);
    while count < N {
        let (mut prime, mut k) = (true, 2);
        while k * k <= number {
            if number % k == 0 {
                prime = false;
            }
            k += 1;
        }
        if prime {
            all[count] = fraction(number, cube);
            count += 1;
        }
        number += 1;
    }
    all
}

const ROUND: [u32; 64] = fractions(true);

/// The hash of bytes that arrive in parts.
pub(crate) struct Sha256 {
    state: [u32; 8],
    block: [u8; 64],
    length: u64,
}

impl Sha256 {
    pub(crate) fn new() -> Self {
        Self {
            state: fractions(false),
            block: [0; 64],
            length: 0,
        }
    }

    pub(crate) fn add(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.block[(self.length % 64) as usize] = byte;
            self.length += 1;
            if self.length.is_multiple_of(64) {
                self.round();
            }
        }
    }

    fn round(&mut self) {
        let mut w = [0u32; 64];
        for (word, bytes) in w.iter_mut().zip(self.block.chunks_exact(4)) {
            *word = bytes.iter().fold(0, |word, &byte| word << 8 | u32::from(byte));
        }
        for k in 16..64 {
            let (x, y) = (w[k - 15], w[k - 2]);
            let small = x.rotate_right(7) ^ x.rotate_right(18) ^ x >> 3;
            let large = y.rotate_right(17) ^ y.rotate_right(19) ^ y >> 10;
            w[k] = w[k - 16].wrapping_add(small).wrapping_add(w[k - 7]).wrapping_add(large);
        }
        let [mut a, mut b, mut c, mut d, mut e, mut f, mut g, mut h] = self.state;
        for k in 0..64 {
            let sum = e.rotate_right(6) ^ e.rotate_right(11) ^ e.rotate_right(25);
            let choice = e & f ^ !e & g;
            let first = [sum, choice, ROUND[k], w[k]]
                .iter()
                .fold(h, |all, x| all.wrapping_add(*x));
            let sum = a.rotate_right(2) ^ a.rotate_right(13) ^ a.rotate_right(22);
            let second = sum.wrapping_add(a & b ^ a & c ^ b & c);
            (h, g, f, e, d, c, b, a) = (g, f, e, d.wrapping_add(first), c, b, a, first.wrapping_add(second));
        }
        for (state, x) in self.state.iter_mut().zip([a, b, c, d, e, f, g, h]) {
            *state = state.wrapping_add(x);
        }
    }

    /// Returns the hash in 64 hex digits.
    pub(crate) fn text(mut self) -> String {
        let bits = self.length.wrapping_mul(8);
        self.add(&[0x80]);
        while self.length % 64 != 56 {
            self.add(&[0]);
        }
        self.add(&bits.to_be_bytes());
        self.state.iter().map(|word| format!("{word:08x}")).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::Sha256;

    #[test]
    fn the_examples_of_the_standard() {
        let long = "abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq";
        for (text, hash) in [
            ("", "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"),
            (
                "abc",
                "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad",
            ),
            (long, "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1"),
        ] {
            let mut sum = Sha256::new();
            for part in text.as_bytes().chunks(7) {
                sum.add(part);
            }
            assert_eq!(sum.text(), hash);
        }
    }
}
