//! The frame checksum: CRC-16/MCRF4XX, called X.25 in MAVLink (initial value 0xFFFF, reflected polynomial 0x1021, no
//! final xor; MAVLink guide, "Serialization").
//!
//! Frames are short (36 bytes in the mean), so what costs time is not the long run but the ragged end. The first one to
//! eight bytes are therefore taken as one word shifted into place: leading zero bytes do not move a zero register, so
//! what is left is a whole number of eight-byte steps and there is no byte loop to mispredict.
//!
//! Where the processor multiplies without carries, that is quicker still: [`multiply`].
//!
//! A CRC is linear over GF(2), which two more functions use: [`advance`] moves a register over zero bytes in constant
//! time, so that the checksum of any part of a buffer follows from the checksums of its prefixes, and
//! [`implied_extra`] finds the `crc_extra` that would explain a checksum.

#[cfg(target_arch = "x86_64")]
mod multiply;

/// Register at the start of a frame.
pub const INIT: u16 = 0xFFFF;

/// Longest distance [`advance`] can move: the checked bytes of a frame with 255 bytes of payload.
pub const MAX_ADVANCE: usize = 9 + 255;

/// `TABLES[k][b]`: register after byte `b` and then `k` zero bytes, from a zero register.
static TABLES: [[u16; 256]; 8] = tables();

/// `ADVANCE[n][i][v]`: where nibble `i` (lowest first) with value `v` of a register ends up after `n` zero bytes.
static ADVANCE: [[[u16; 16]; 4]; MAX_ADVANCE + 1] = advance_tables();

/// `BY_HIGH_BYTE[h]`: which entry of `TABLES[0]` has the high byte `h`.
static BY_HIGH_BYTE: [u8; 256] = by_high_byte();

const fn by_high_byte() -> [u8; 256] {
    let table = tables()[0];
    let mut index = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        index[(table[byte] >> 8) as usize] = byte as u8;
        byte += 1;
    }
    index
}

const fn tables() -> [[u16; 256]; 8] {
    let mut tables = [[0; 256]; 8];
    let mut byte = 0;
    while byte < 256 {
        let mut register = byte as u16;
        let mut bit = 0;
        while bit < 8 {
            register = (register >> 1) ^ if register & 1 == 1 { 0x8408 } else { 0 };
            bit += 1;
        }
        tables[0][byte] = register;
        byte += 1;
    }
    let mut k = 1;
    while k < 8 {
        let mut byte = 0;
        while byte < 256 {
            let register = tables[k - 1][byte];
            tables[k][byte] = (register >> 8) ^ tables[0][(register & 0xFF) as usize];
            byte += 1;
        }
        k += 1;
    }
    tables
}

#[allow(clippy::large_stack_arrays)] // computed by the compiler
const fn advance_tables() -> [[[u16; 16]; 4]; MAX_ADVANCE + 1] {
    let zero_byte = tables()[0];
    let mut table = [[[0; 16]; 4]; MAX_ADVANCE + 1];
    let mut nibble = 0;
    while nibble < 4 {
        let mut value = 0;
        while value < 16 {
            let mut register = (value as u16) << (4 * nibble);
            let mut n = 0;
            while n <= MAX_ADVANCE {
                table[n][nibble][value] = register;
                register = (register >> 8) ^ zero_byte[(register & 0xFF) as usize];
                n += 1;
            }
            value += 1;
        }
        nibble += 1;
    }
    table
}

/// The register after one more byte.
#[inline]
pub const fn push(crc: u16, byte: u8) -> u16 {
    (crc >> 8) ^ TABLES[0][(crc as u8 ^ byte) as usize]
}

/// The register after eight bytes, given as a little-endian word already mixed with the register before.
#[inline]
fn step(word: u64) -> u16 {
    let b = word.to_le_bytes();
    let t = &TABLES;
    (t[7][b[0] as usize] ^ t[6][b[1] as usize] ^ t[5][b[2] as usize] ^ t[4][b[3] as usize])
        ^ (t[3][b[4] as usize] ^ t[2][b[5] as usize] ^ t[1][b[6] as usize] ^ t[0][b[7] as usize])
}

/// Feeds `bytes` to a register.
#[inline]
pub fn accumulate(crc: u16, bytes: &[u8]) -> u16 {
    #[cfg(target_arch = "x86_64")]
    if let Some(crc) = multiply::accumulate(crc, bytes) {
        return crc;
    }
    by_tables(crc, bytes)
}

fn by_tables(crc: u16, bytes: &[u8]) -> u16 {
    let Some(head) = bytes.first_chunk::<8>() else {
        return bytes.iter().fold(crc, |crc, &byte| push(crc, byte));
    };
    // One to eight bytes first, so that the rest is a multiple of eight.
    let head_len = (bytes.len() - 1) % 8 + 1;
    let word = (u64::from_le_bytes(*head) ^ u64::from(crc)) << (8 * (8 - head_len));
    // With a single head byte the register's high byte has not met its data byte yet.
    let mut crc = step(word) ^ (u32::from(crc) >> (8 * head_len.min(2))) as u16;
    for block in bytes[head_len..].as_chunks::<8>().0 {
        crc = step(u64::from_le_bytes(*block) ^ u64::from(crc));
    }
    crc
}

/// Checksum of `bytes` from the initial register: 0x6F91 for `b"123456789"`.
#[inline]
pub fn checksum(bytes: &[u8]) -> u16 {
    accumulate(INIT, bytes)
}

/// The register after `zeros` more zero bytes, in constant time.
///
/// # Panics
/// Where `zeros` exceeds [`MAX_ADVANCE`].
#[inline]
pub fn advance(crc: u16, zeros: usize) -> u16 {
    let nibbles = &ADVANCE[zeros];
    (nibbles[0][usize::from(crc & 15)] ^ nibbles[1][usize::from(crc >> 4 & 15)])
        ^ (nibbles[2][usize::from(crc >> 8 & 15)] ^ nibbles[3][usize::from(crc >> 12)])
}

/// The only `crc_extra` that leads from `register` (after header and payload) to the `received` checksum; `None` where
/// no value does, which is the case for 255 of 256 random checksums. Constant time.
#[inline]
pub fn implied_extra(register: u16, received: u16) -> Option<u8> {
    // The last step added one table entry, and the entries differ in their high bytes.
    let added = received ^ (register >> 8);
    let index = BY_HIGH_BYTE[usize::from(added >> 8)];
    (TABLES[0][usize::from(index)] == added).then_some(index ^ register as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bitwise(mut crc: u16, bytes: &[u8]) -> u16 {
        for &byte in bytes {
            crc ^= u16::from(byte);
            for _ in 0..8 {
                crc = (crc >> 1) ^ if crc & 1 == 1 { 0x8408 } else { 0 };
            }
        }
        crc
    }

    fn noise(len: usize) -> Vec<u8> {
        let mut state = 0x2545_F491_u32;
        let next = |_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        };
        (0..len).map(next).collect()
    }

    #[test]
    fn r6_check_value() {
        assert_eq!(checksum(b"123456789"), 0x6F91);
        assert_eq!(checksum(b""), 0xFFFF);
    }

    #[test]
    fn r6_every_length_and_split_equals_the_bitwise_definition() {
        let bytes = noise(300);
        for len in 0..=bytes.len() {
            assert_eq!(checksum(&bytes[..len]), bitwise(INIT, &bytes[..len]), "length {len}");
            let split = len / 3;
            let parts = accumulate(accumulate(INIT, &bytes[..split]), &bytes[split..len]);
            assert_eq!(parts, checksum(&bytes[..len]), "split at {split} of {len}");
            let by_tables = by_tables(by_tables(INIT, &bytes[..split]), &bytes[split..len]);
            assert_eq!(by_tables, parts, "by tables, split at {split} of {len}");
        }
    }

    #[test]
    fn advance_is_a_run_of_zero_bytes() {
        for zeros in 0..=MAX_ADVANCE {
            for crc in [0, 1, 0x8000, 0x1234, 0xFFFF] {
                assert_eq!(advance(crc, zeros), accumulate(crc, &vec![0; zeros]));
            }
        }
    }

    #[test]
    fn prefix_checksums_give_the_checksum_of_any_part() {
        let bytes = noise(300);
        let prefix: Vec<u16> = (0..=300).map(|end| accumulate(0, &bytes[..end])).collect();
        for (start, end) in [(0, 0), (0, 264), (1, 9), (7, 50), (36, 300), (299, 300)] {
            let part = prefix[end] ^ advance(prefix[start] ^ INIT, end - start);
            assert_eq!(part, checksum(&bytes[start..end]), "{start}..{end}");
        }
    }

    #[test]
    fn implied_extra_finds_the_seed_and_rejects_most_noise() {
        let register = checksum(b"\x09\0\0\0\x01\x01\0\0\0\x04\0\0\0\x02\x03\x51\x04\x03");
        for extra in 0..=255 {
            assert_eq!(implied_extra(register, push(register, extra)), Some(extra));
        }
        let consistent = (0..=u16::MAX).filter(|&crc| implied_extra(register, crc).is_some());
        assert_eq!(consistent.count(), 256);
    }
}
