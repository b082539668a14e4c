//! The part of a frame that a telemetry log may hold (MAVLink guide, "Message Signing", "Logging").
//!
//! Logs are passed around. A signature proves nothing to a reader without the key, so it is left out, and the key of
//! `SETUP_SIGNING` is overwritten.

use std::borrow::Cow;

use crate::frame::{FrameRef, HEADER_LEN_V2, IFLAG_SIGNED, INCOMPAT_FLAGS_AT, MAX_FRAME_LEN};
use crate::signing::{SETUP_SIGNING, without_signature};
use crate::x25;

/// `crc_extra` of `SETUP_SIGNING`.
const SETUP_SIGNING_EXTRA: u8 = 71;
/// Where `secret_key` begins in the payload of `SETUP_SIGNING`, and its length.
const KEY_OFFSET: usize = 10;
const KEY_LEN: usize = 32;

/// `frame` without signature and without a secret key; as it is where it has neither, or is no whole frame.
pub fn recordable(frame: &[u8]) -> Cow<'_, [u8]> {
    let Ok(whole) = FrameRef::parse(frame) else { return Cow::Borrowed(frame) };
    if whole.header().msgid == SETUP_SIGNING {
        Cow::Owned(without_key(&whole))
    } else if whole.header().is_signed() {
        Cow::Owned(without_signature(frame))
    } else {
        Cow::Borrowed(frame)
    }
}

/// The same `SETUP_SIGNING` with every byte of the key FF, including zeros that were cut from it.
fn without_key(frame: &FrameRef<'_>) -> Vec<u8> {
    let addressing = &frame.payload()[..frame.payload().len().min(KEY_OFFSET)];
    let mut redacted = Vec::with_capacity(MAX_FRAME_LEN);
    redacted.extend_from_slice(&frame.bytes()[..HEADER_LEN_V2]);
    redacted[1] = (KEY_OFFSET + KEY_LEN) as u8;
    redacted[INCOMPAT_FLAGS_AT] &= !IFLAG_SIGNED;
    redacted.extend_from_slice(addressing);
    redacted.resize(HEADER_LEN_V2 + KEY_OFFSET, 0);
    redacted.resize(HEADER_LEN_V2 + KEY_OFFSET + KEY_LEN, 0xFF);
    let checksum = x25::push(x25::checksum(&redacted[1..]), SETUP_SIGNING_EXTRA);
    redacted.extend_from_slice(&checksum.to_le_bytes());
    redacted
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Header;
    use crate::signing::{SecretKey, sign};
    use crate::testing::{HEARTBEAT_V1, HEARTBEAT_V2, encode, header};
    use mavwire_schema::WireVersion::V2;

    /// A frame and the same signed.
    fn twins(msgid: u32, payload: &[u8]) -> (Vec<u8>, Vec<u8>) {
        let plain = header(V2, msgid, 7);
        let mut signed = encode(Header { incompat_flags: IFLAG_SIGNED, ..plain }, payload);
        sign(&mut signed, &SecretKey::new(&[9; 32]).expect("32 bytes"), 3, 1000);
        (encode(plain, payload), signed)
    }

    #[test]
    fn r54_a_signed_frame_becomes_its_unsigned_twin() {
        for len in 1..=255 {
            // Known messages and one that the dialect lacks.
            for msgid in [0, 253, 17000, 70_000] {
                let (plain, signed) = twins(msgid, &vec![0x5A; len]);
                assert_eq!(recordable(&signed), plain, "message {msgid}, {len} bytes");
            }
        }
    }

    #[test]
    fn r53_no_byte_of_a_key_stays_however_much_was_cut() {
        let mut expected = vec![7; KEY_OFFSET];
        expected.resize(KEY_OFFSET + KEY_LEN, 0xFF);
        for len in 1..=KEY_OFFSET + KEY_LEN {
            let (plain, signed) = twins(SETUP_SIGNING, &vec![7; len]);
            for frame in [plain, signed] {
                let redacted = recordable(&frame).into_owned();
                let parsed = FrameRef::parse(&redacted).expect("a whole frame");
                assert_eq!(parsed.calculated_checksum(SETUP_SIGNING_EXTRA), parsed.checksum());
                assert!(!parsed.header().is_signed());
                let addressing = len.min(KEY_OFFSET);
                assert_eq!(parsed.payload()[..addressing], expected[..addressing]);
                assert!(parsed.payload()[addressing..KEY_OFFSET].iter().all(|&byte| byte == 0));
                assert_eq!(parsed.payload()[KEY_OFFSET..], expected[KEY_OFFSET..]);
            }
        }
    }

    #[test]
    fn what_has_no_secret_stays_as_it_is() {
        let cut = &HEARTBEAT_V2[..20];
        for frame in [&HEARTBEAT_V1[..], &HEARTBEAT_V2, cut, b"", b"\xfd", b"junk"] {
            assert!(matches!(recordable(frame), Cow::Borrowed(same) if same == frame));
        }
    }

    #[test]
    fn the_constants_are_the_definitions() {
        let dialect = crate::builtin::dialect("common", V2).expect("it is built in");
        let setup = dialect.messages.iter().find(|m| m.id == SETUP_SIGNING).expect("it has one");
        let key = setup.fields.iter().find(|field| &*field.name == crate::text::SECRET_FIELD);
        let place = key.map(|key| (usize::from(key.offset), usize::from(key.array_length)));
        assert_eq!(setup.crc_extra, SETUP_SIGNING_EXTRA);
        assert_eq!(place, Some((KEY_OFFSET, KEY_LEN)));
    }
}
