//! The secret key and the digest made with it.
//!
//! A frame with its key is at most 306 bytes, so the padded message fits five SHA-256 blocks on the stack and is
//! compressed in one call, which is a good deal cheaper than feeding a hasher piece by piece.

use super::SigningError;
use sha2::block_api::compress256;
use sha2::{Digest as _, Sha256};
use std::fmt;
use std::hint::black_box;
use subtle::ConstantTimeEq;

/// First six bytes of SHA-256.
pub type Digest = [u8; 6];

const KEY_LEN: usize = 32;
const BLOCK: usize = 64;
const MAX_BLOCKS: usize = 5;
/// Enough for payloads of up to 68 bytes; clearing five costs some nanoseconds more.
const USUAL_BLOCKS: usize = 2;
/// One bit of padding and the length in bits.
const PADDING: usize = 1 + 8;

/// Initial SHA-256 state (FIPS 180-4, 5.3.3).
const INITIAL: [u32; 8] = [
    0x6a09_e667,
    0xbb67_ae85,
    0x3c6e_f372,
    0xa54f_f53a,
    0x510e_527f,
    0x9b05_688c,
    0x1f83_d9ab,
    0x5be0_cd19,
];

/// A signing key. It is overwritten when dropped, does not show in debug output, and is not copied.
pub struct SecretKey([u8; KEY_LEN]);

impl SecretKey {
    /// Takes a key.
    ///
    /// # Errors
    /// Not 32 bytes.
    pub fn new(key: &[u8]) -> Result<Self, SigningError> {
        key.try_into().map(Self).map_err(|_| SigningError::KeyLength(key.len()))
    }

    /// True for the same key, in constant time.
    pub fn equals(&self, other: &Self) -> bool {
        self.0.ct_eq(&other.0).into()
    }

    /// Overwrites the key, which the compiler may not leave out.
    fn wipe(&mut self) {
        self.0 = [0; KEY_LEN];
        black_box(&self.0);
    }

    /// The key's bytes, for code that must hand them on.
    pub fn expose(&self) -> &[u8; KEY_LEN] {
        &self.0
    }
}

impl Drop for SecretKey {
    fn drop(&mut self) {
        self.wipe();
    }
}

impl fmt::Debug for SecretKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("SecretKey(..)")
    }
}

/// The digest over key and `parts`, which together are the frame from STX through the timestamp.
pub fn sig48(key: &SecretKey, parts: &[&[u8]]) -> Digest {
    let len = KEY_LEN + parts.iter().map(|part| part.len()).sum::<usize>();
    let padded = len + PADDING;
    if padded <= USUAL_BLOCKS * BLOCK {
        sig48_in::<USUAL_BLOCKS>(key, parts, len)
    } else if padded <= MAX_BLOCKS * BLOCK {
        sig48_in::<MAX_BLOCKS>(key, parts, len)
    } else {
        sig48_long(key, parts)
    }
}

/// The same for `len` bytes that fit `N` blocks with their padding.
fn sig48_in<const N: usize>(key: &SecretKey, parts: &[&[u8]], len: usize) -> Digest {
    let mut blocks = [[0; BLOCK]; N];
    let message = blocks.as_flattened_mut();
    message[..KEY_LEN].copy_from_slice(&key.0);
    let mut at = KEY_LEN;
    for part in parts {
        message[at..at + part.len()].copy_from_slice(part);
        at += part.len();
    }
    message[at] = 0x80;
    let end = (len + PADDING).next_multiple_of(BLOCK);
    message[end - 8..end].copy_from_slice(&(8 * len as u64).to_be_bytes());
    let mut state = INITIAL;
    compress256(&mut state, &blocks[..end / BLOCK]);
    blocks[0][..KEY_LEN].fill(0);
    black_box(&blocks[0]);
    let mut digest = [0; 6];
    digest[..4].copy_from_slice(&state[0].to_be_bytes());
    digest[4..].copy_from_slice(&state[1].to_be_bytes()[..2]);
    digest
}

/// The same for more than a frame.
fn sig48_long(key: &SecretKey, parts: &[&[u8]]) -> Digest {
    let mut hasher = Sha256::new();
    hasher.update(key.0);
    for part in parts {
        hasher.update(part);
    }
    let digest = hasher.finalize();
    std::array::from_fn(|n| digest[n])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn r31_keys_have_32_bytes() {
        for len in [0, 5, 31, 33, 64] {
            let error = SecretKey::new(&vec![7; len]).err();
            assert_eq!(error, Some(SigningError::KeyLength(len)));
        }
        assert!(SecretKey::new(&[7; 32]).is_ok());
    }

    #[test]
    fn keys_are_compared_by_their_bytes() {
        let key = |byte| SecretKey([byte; 32]);
        assert!(key(1).equals(&key(1)));
        assert!(!key(1).equals(&key(2)));
    }

    #[test]
    fn r56_a_key_that_is_dropped_is_overwritten() {
        let mut key = SecretKey([0xAB; 32]);
        key.wipe();
        assert_eq!(key.expose(), &[0; 32]);
        assert!(std::mem::needs_drop::<SecretKey>());
    }

    #[test]
    fn r56_debug_output_does_not_show_the_key() {
        let key = SecretKey::new(&[0xAB; 32]).ok();
        assert_eq!(format!("{key:?}"), "Some(SecretKey(..))");
    }

    #[test]
    fn r32_one_call_equals_the_streaming_hash_at_every_length() {
        let key = SecretKey(std::array::from_fn(|n| n as u8));
        let bytes: Vec<u8> = (0..600).map(|n| (n * 7) as u8).collect();
        for len in 0..600 {
            let parts: &[&[u8]] = &[&bytes[..len / 2], &bytes[len / 2..len]];
            assert_eq!(sig48(&key, parts), sig48_long(&key, parts), "{len} bytes");
        }
    }
}
