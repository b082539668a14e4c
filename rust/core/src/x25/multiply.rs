//! The same checksum by carry-less multiplication, in a quarter of the instructions that the tables take.
//!
//! A word of eight bytes with `d` words behind it adds `word * x^(64 d + 16) mod P` to the register. The products with
//! the remainders of those powers do not depend on each other and are 80 bits each, so they are added up first and the
//! sum alone is reduced: by Barrett's method, which multiplies by the quotient `x^80 / P` instead of dividing by `P`.
//!
//! Bits are reflected everywhere, as on the wire: the lowest bit of a word is its highest power of x. A product of two
//! reflected words comes out one bit short, so factors stand one bit higher.

use std::arch::x86_64::{
    __m128i, _mm_clmulepi64_si128, _mm_cvtsi64_si128, _mm_extract_epi16, _mm_xor_si128,
};

/// Longest input, in words of eight bytes: any frame.
const MAX_WORDS: usize = super::MAX_ADVANCE.div_ceil(8);

/// x^16 + x^12 + x^5 + 1.
const POLYNOMIAL: u128 = 0x1_1021;

/// [`POLYNOMIAL`] without x^16, reflected.
const REFLECTED: u64 = 0x8408 << 1;

/// `FACTORS[MAX_WORDS - d]`: the remainder of x^(64 d + 16), reflected. One more than that is read, and multiplied by 0.
static FACTORS: [u64; MAX_WORDS + 2] = factors();

/// The quotient of x^80 and [`POLYNOMIAL`], reflected; its lowest power, which moves no quotient, has no room.
const QUOTIENT: u64 = quotient();

const fn factors() -> [u64; MAX_WORDS + 2] {
    let mut factors = [0; MAX_WORDS + 2];
    // The highest bit is x^0. Two zero bytes make it x^16, eight more each further factor.
    let mut register = super::push(super::push(0x8000, 0), 0);
    let mut d = 0;
    while d <= MAX_WORDS {
        factors[MAX_WORDS - d] = (register as u64) << 1;
        let mut zeros = 0;
        while zeros < 8 {
            register = super::push(register, 0);
            zeros += 1;
        }
        d += 1;
    }
    factors
}

const fn quotient() -> u64 {
    let mut rest = 1 << 80;
    let mut reflected = 0;
    let mut power = 64;
    while power > 0 {
        if rest >> (power + 16) & 1 == 1 {
            rest ^= POLYNOMIAL << power;
            reflected |= 1 << (64 - power);
        }
        power -= 1;
    }
    reflected
}

/// Feeds `bytes` to a register; `None` where there are fewer than 8 of them or more than a frame has, or the processor
/// cannot multiply so.
#[inline]
#[allow(unsafe_code)] // nothing else in this crate needs any
pub(super) fn accumulate(crc: u16, bytes: &[u8]) -> Option<u16> {
    let head = bytes.first_chunk::<8>()?;
    let can_multiply = is_x86_feature_detected!("pclmulqdq") && is_x86_feature_detected!("sse2");
    if bytes.len() > 8 * MAX_WORDS || !can_multiply {
        return None;
    }
    // SAFETY: the processor has the instructions, as was just found.
    Some(unsafe { multiplied(crc, u64::from_le_bytes(*head), bytes) })
}

#[target_feature(enable = "pclmulqdq,sse2")]
fn multiplied(crc: u16, head: u64, bytes: &[u8]) -> u16 {
    // One to eight bytes first, shifted into place, so that the rest is whole words: zeros in front move no register.
    let head_len = (bytes.len() - 1) % 8 + 1;
    let (words, _) = bytes[head_len..].as_chunks::<8>();
    let factors = &FACTORS[MAX_WORDS - words.len()..];
    let head = (head ^ u64::from(crc)) << (8 * (8 - head_len));
    // With a single head byte the register's high byte meets the byte behind it.
    let late = u64::from(crc) >> (8 * head_len.min(2));
    let mut sum = _mm_xor_si128(product(head, factors[0]), product(late, factors[1]));
    for (word, factor) in words.iter().zip(&factors[1..]) {
        sum = _mm_xor_si128(sum, product(u64::from_le_bytes(*word), *factor));
    }
    // The register is the upper half of the sum, and what the lower half leaves when it is divided.
    let quotient = _mm_clmulepi64_si128::<0>(sum, in_vector(QUOTIENT));
    let rest = _mm_clmulepi64_si128::<0>(quotient, in_vector(REFLECTED));
    _mm_extract_epi16::<4>(_mm_xor_si128(sum, rest)) as u16
}

#[target_feature(enable = "pclmulqdq,sse2")]
fn product(a: u64, b: u64) -> __m128i {
    _mm_clmulepi64_si128::<0>(in_vector(a), in_vector(b))
}

#[target_feature(enable = "sse2")]
fn in_vector(word: u64) -> __m128i {
    _mm_cvtsi64_si128(word as i64)
}
