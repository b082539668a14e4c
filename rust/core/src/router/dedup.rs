//! Frames that came before over another link: copies from redundant paths and frames that went round a loop.
//!
//! The same bytes again over the *same* link are no duplicate: a sender that does not count its frames, or one whose
//! sequence number came round, means them. The digest is keyed so that nobody can make a frame that passes for another
//! one and so has it dropped. Memory is fixed: what does not fit pushes out the oldest, which only ever lets a frame pass.

use super::links::LinkId;

const BUCKETS: usize = 1 << 14;
const WAYS: usize = 4;

#[derive(Debug, Clone, Copy)]
struct Seen {
    digest: u64,
    /// Milliseconds, modulo 2^32.
    at: u32,
    link: LinkId,
}

/// Frames with the same lower bits of their digest, newest first; one cache line.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
struct Bucket([Seen; WAYS]);

const NEVER: Seen = Seen { digest: 0, at: 0, link: LinkId(0) };

/// The frames of a window of time.
#[derive(Debug, Clone)]
pub(super) struct Dedup {
    /// Milliseconds; 0 switches it off.
    window: u32,
    seed: u64,
    buckets: Box<[Bucket]>,
}

impl Dedup {
    /// `window` in microseconds; 0 for none.
    pub(super) fn new(window: u64, seed: u64) -> Self {
        let window = u32::try_from(window.div_ceil(1000)).unwrap_or(u32::MAX / 2);
        let buckets = if window == 0 { 0 } else { BUCKETS };
        Self { window, seed, buckets: vec![Bucket([NEVER; WAYS]); buckets].into() }
    }

    /// Whether the frame came over another link within the window; if not, it is remembered. `now` in microseconds.
    #[inline]
    pub(super) fn is_duplicate(&mut self, frame: &[u8], link: LinkId, now: u64) -> bool {
        if self.window == 0 {
            return false;
        }
        let digest = digest(frame, self.seed);
        let at = (now / 1000) as u32;
        let Bucket(bucket) = &mut self.buckets[digest as usize % BUCKETS];
        for seen in bucket.iter() {
            if seen.digest == digest && at.wrapping_sub(seen.at) <= self.window {
                return seen.link != link;
            }
        }
        bucket.rotate_right(1);
        bucket[0] = Seen { digest, at, link };
        false
    }
}

/// A keyed digest: eight bytes at a time, multiplied to 128 bits and folded. Never 0, which marks an empty slot.
#[inline]
fn digest(bytes: &[u8], seed: u64) -> u64 {
    const FACTOR: u64 = 0x9E37_79B9_7F4A_7C15;
    let fold = |a: u64, b: u64| {
        let product = u128::from(a) * u128::from(b);
        (product as u64) ^ (product >> 64) as u64
    };
    let key = seed | 1;
    let (words, rest) = bytes.as_chunks::<8>();
    let mut state = seed ^ (bytes.len() as u64).wrapping_mul(FACTOR);
    for &word in words {
        state = fold(state ^ u64::from_le_bytes(word), key ^ FACTOR).wrapping_add(seed);
    }
    let mut last = [0; 8];
    last[..rest.len()].copy_from_slice(rest);
    fold(fold(state ^ u64::from_le_bytes(last), key ^ FACTOR) ^ seed, FACTOR) | 1 << 63
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::noise;
    use std::collections::HashSet;

    const SEED: u64 = 0x0123_4567_89AB_CDEF;
    const A: LinkId = LinkId(0);
    const B: LinkId = LinkId(1);

    #[test]
    fn a_copy_over_another_link_is_a_duplicate_until_the_window_closes() {
        let mut dedup = Dedup::new(500_000, SEED);
        assert!(!dedup.is_duplicate(b"frame", A, 1_000_000));
        assert!(dedup.is_duplicate(b"frame", B, 1_000_000));
        assert!(dedup.is_duplicate(b"frame", B, 1_500_000));
        assert!(!dedup.is_duplicate(b"frame", A, 1_500_000), "a sender that repeats itself");
        assert!(!dedup.is_duplicate(b"other", B, 1_500_000));
        assert!(!dedup.is_duplicate(b"frame", B, 1_502_000), "the window is closed");
        assert!(dedup.is_duplicate(b"frame", A, 1_502_000), "and another one open");
    }

    #[test]
    fn without_a_window_nothing_is_a_duplicate() {
        let mut dedup = Dedup::new(0, SEED);
        assert!(!dedup.is_duplicate(b"frame", A, 0));
        assert!(!dedup.is_duplicate(b"frame", B, 0));
    }

    #[test]
    fn the_clock_comes_round() {
        let mut dedup = Dedup::new(500_000, SEED);
        let turn = (u64::from(u32::MAX) + 1) * 1000;
        assert!(!dedup.is_duplicate(b"frame", A, turn - 2_000));
        assert!(dedup.is_duplicate(b"frame", B, turn + 2_000));
    }

    #[test]
    fn a_flood_lets_frames_pass_and_stops_none() {
        let mut dedup = Dedup::new(500_000, SEED);
        for n in 0..200_000_u32 {
            assert!(!dedup.is_duplicate(&n.to_le_bytes(), A, 5_000_000));
        }
        let caught = (180_000..200_000_u32)
            .filter(|n| dedup.is_duplicate(&n.to_le_bytes(), B, 5_000_001))
            .count();
        assert!(caught > 15_000, "the newest are still known: {caught}");
    }

    #[test]
    fn digests_tell_frames_apart_and_depend_on_the_seed() {
        let base = noise(280, 1);
        let mut digests = HashSet::new();
        for len in 0..=280 {
            assert!(digests.insert(digest(&base[..len], SEED)));
        }
        for bit in 0..280 * 8 {
            let mut changed = base.clone();
            changed[bit / 8] ^= 1 << (bit % 8);
            assert!(digests.insert(digest(&changed, SEED)), "{bit}");
        }
        assert_ne!(digest(&base, SEED), digest(&base, SEED + 2));
    }
}
