//! Hashing kinds of messages, once for each frame: one multiplication, and a key, so that nobody can make up kinds that share
//! a place in the table.

use std::hash::{BuildHasher, Hasher, RandomState};

const FACTOR: u64 = 0x9E37_79B9_7F4A_7C15;

/// The key of a table.
#[derive(Debug, Clone)]
pub struct KindHash(u64);

impl Default for KindHash {
    fn default() -> Self {
        Self(RandomState::new().hash_one(0))
    }
}

impl BuildHasher for KindHash {
    type Hasher = KindHasher;

    #[inline]
    fn build_hasher(&self) -> KindHasher {
        KindHasher(self.0)
    }
}

/// A hash that is being made.
#[derive(Debug)]
pub struct KindHasher(u64);

impl Hasher for KindHasher {
    #[inline]
    fn write_u64(&mut self, number: u64) {
        let product = u128::from(self.0 ^ number) * u128::from(FACTOR);
        self.0 = product as u64 ^ (product >> 64) as u64;
    }

    fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.write_u64(byte.into());
        }
    }

    #[inline]
    fn finish(&self) -> u64 {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn kinds_spread_over_a_table() {
        let hash = KindHash(0x0123_4567_89AB_CDEF);
        for shift in [0, 8, 16, 24] {
            let hashes: Vec<u64> = (0..256_u64).map(|n| hash.hash_one(n << shift)).collect();
            // A table looks at the lowest bits, and at the highest seven.
            let lowest: HashSet<u64> = hashes.iter().map(|hash| hash % 1024).collect();
            let highest: HashSet<u64> = hashes.iter().map(|hash| hash >> 57).collect();
            assert!(lowest.len() > 200 && highest.len() > 90, "{shift}: {}", lowest.len());
        }
        assert_ne!(KindHash::default().hash_one(7_u64), KindHash::default().hash_one(7_u64));
    }
}
