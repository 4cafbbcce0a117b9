//! The SHA-256 of files: FIPS 180-4, *Secure Hash Standard* (2015), section 6.2.

use std::array::from_fn;

/// Bytes of a block.
const BLOCK: usize = 64;

/// The first 32 bits of the fractional parts of the square roots of the first eight primes.
const START: [u32; 8] = [
    0x6a09_e667,
    0xbb67_ae85,
    0x3c6e_f372,
    0xa54f_f53a,
    0x510e_527f,
    0x9b05_688c,
    0x1f83_d9ab,
    0x5be0_cd19,
];

/// Fractional parts of the cube roots of the first 64 primes.
static ROUNDS: [u32; 64] = rounds();

/// The 64 constants, the first 32 bits of the fractional part of ∛p, in integer arithmetic.
const fn rounds() -> [u32; 64] {
    let mut constants = [0; 64];
    let (mut found, mut candidate) = (0, 2_u128);
    while found < 64 {
        let mut divisor = 2;
        while divisor * divisor <= candidate && !candidate.is_multiple_of(divisor) {
            divisor += 1;
        }
        if divisor * divisor > candidate {
            // The largest x with x³ ≤ 2⁹⁶ p, bit by bit; ∛p is below 8.
            let (mut root, mut bit) = (0_u128, 1_u128 << 34);
            while bit > 0 {
                let larger = root + bit;
                // x³ is below 2¹⁰⁵.
                if larger * larger * larger <= candidate << 96 {
                    root = larger;
                }
                bit >>= 1;
            }
            constants[found] = root as u32;
            found += 1;
        }
        candidate += 1;
    }
    constants
}

/// SHA-256 of the concatenation of several parts.
pub fn sha256(parts: &[&[u8]]) -> [u8; 32] {
    let mut state = START;
    let mut rest = [0; BLOCK];
    let (mut filled, mut length) = (0, 0_u64);
    for part in parts {
        length += part.len() as u64;
        let mut part = *part;
        if filled > 0 {
            let taken = part.len().min(BLOCK - filled);
            rest[filled..filled + taken].copy_from_slice(&part[..taken]);
            (filled, part) = (filled + taken, &part[taken..]);
            if filled < BLOCK {
                continue;
            }
            compress(&mut state, &rest);
        }
        let (blocks, tail) = part.as_chunks::<BLOCK>();
        for block in blocks {
            compress(&mut state, block);
        }
        rest[..tail.len()].copy_from_slice(tail);
        filled = tail.len();
    }
    // Padding: a one bit, zeros, and the length in bits.
    rest[filled] = 0x80;
    rest[filled + 1..].fill(0);
    if filled + 1 > BLOCK - 8 {
        compress(&mut state, &rest);
        rest.fill(0);
    }
    rest[BLOCK - 8..].copy_from_slice(&(8 * length).to_be_bytes());
    compress(&mut state, &rest);
    let words = state.map(u32::to_be_bytes);
    from_fn(|byte| words[byte / 4][byte % 4])
}

fn compress(state: &mut [u32; 8], block: &[u8; BLOCK]) {
    let mut schedule = [0_u32; 64];
    for (word, bytes) in schedule.iter_mut().zip(block.as_chunks::<4>().0) {
        *word = u32::from_be_bytes(*bytes);
    }
    for t in 16..64 {
        let (w15, w2) = (schedule[t - 15], schedule[t - 2]);
        let s0 = w15.rotate_right(7) ^ w15.rotate_right(18) ^ (w15 >> 3);
        let s1 = w2.rotate_right(17) ^ w2.rotate_right(19) ^ (w2 >> 10);
        let sum = schedule[t - 16].wrapping_add(s0);
        schedule[t] = sum.wrapping_add(schedule[t - 7]).wrapping_add(s1);
    }
    let [mut a, mut b, mut c, mut d, mut e, mut f, mut g, mut h] = *state;
    for (word, constant) in schedule.iter().zip(&ROUNDS) {
        let s1 = e.rotate_right(6) ^ e.rotate_right(11) ^ e.rotate_right(25);
        let choice = (e & f) ^ (!e & g);
        let first = h.wrapping_add(s1).wrapping_add(choice);
        let first = first.wrapping_add(*constant).wrapping_add(*word);
        let s0 = a.rotate_right(2) ^ a.rotate_right(13) ^ a.rotate_right(22);
        let majority = (a & b) ^ (a & c) ^ (b & c);
        let second = s0.wrapping_add(majority);
        (h, g, f, e) = (g, f, e, d.wrapping_add(first));
        (d, c, b, a) = (c, b, a, first.wrapping_add(second));
    }
    let found = [a, b, c, d, e, f, g, h];
    *state = from_fn(|k| state[k].wrapping_add(found[k]));
}
