//! Changes to a frame where it enters or leaves a network: signatures are verified, added or removed, and the frame is
//! written in the other wire version.
//!
//! Frames pass a router unchanged. A link that has a border changes them on the way in, before they are routed, and on
//! the way out. The meaning of a message stays the same. A message that the other version cannot carry is refused.

use std::borrow::Cow;
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::Arc;

use mavwire_schema::WireVersion;

use crate::codec::payload_extended;
use crate::frame::{
    CHECKSUM_LEN, FrameBuffer, FrameRef, HEADER_LEN_V1, HEADER_LEN_V2, Header, IFLAG_SIGNED,
    SIGNATURE_LEN,
};
use crate::registry::Entry;
use crate::signing::{SecretKey, SigningState, Verdict, without_signature};
use crate::x25;

/// The settings of a border. With the defaults it changes and refuses nothing.
#[derive(Debug, Clone, Default)]
#[allow(clippy::struct_excessive_bools)] // each is asked for by itself
pub struct BorderOptions {
    /// Frames leave in this version.
    pub version: Option<WireVersion>,
    /// The key to verify and to sign with.
    pub key: Option<Arc<SecretKey>>,
    /// Incoming frames need a valid signature, if there is a key.
    pub verify: bool,
    /// Message ids that may come in without a signature all the same.
    pub unsigned: Vec<u32>,
    /// Frames leave signed by this side, if there is a key. An earlier signature does not matter.
    pub sign: bool,
    /// Signatures are removed from incoming frames after they were verified.
    pub strip_in: bool,
    /// Signatures are removed from outgoing frames.
    pub strip_out: bool,
    /// Signatures whose timestamp is further ahead of the clock are not good ones; `None` sets no limit.
    pub max_ahead: Option<u64>,
    /// The link id of the signatures made here.
    pub link_id: u8,
}

impl BorderOptions {
    /// Nothing is verified and nothing changed.
    pub fn is_open(&self) -> bool {
        self.version.is_none() && !(self.verify || self.sign || self.strip_in || self.strip_out)
    }

    /// Bytes of a frame of `len` bytes once it left; as many as it may have where zeros at its end are cut.
    pub fn len_outside(&self, len: usize, header: &Header, entry: Option<Entry>) -> usize {
        let signature = if header.is_signed() { SIGNATURE_LEN } else { 0 };
        let version = if self.sign { Some(WireVersion::V2) } else { self.version };
        let bare = match (header.version, version) {
            (WireVersion::V1, Some(WireVersion::V2)) => len + HEADER_LEN_V2 - HEADER_LEN_V1,
            (WireVersion::V2, Some(WireVersion::V1)) => {
                let payload = entry.map_or(0, |entry| usize::from(entry.min_len));
                HEADER_LEN_V1 + payload + CHECKSUM_LEN
            }
            _ if self.sign || self.strip_out => len - signature,
            _ => len,
        };
        bare + if self.sign { SIGNATURE_LEN } else { 0 }
    }
}

/// A frame that came in through a border.
#[derive(Debug, PartialEq, Eq)]
pub struct Entered<'a> {
    /// Its bytes from here on.
    pub frame: Cow<'a, [u8]>,
    /// Nothing had to be proven, or its signature did; false for a message that may come without one.
    pub proven: bool,
}

/// The border of one link. Links with the same key share their signing state, so that what was heard on one of them cannot
/// be replayed on another.
#[derive(Debug)]
pub struct Border {
    options: BorderOptions,
    signing: Rc<RefCell<SigningState>>,
}

impl Border {
    /// A border with the state that belongs to its key.
    pub fn new(options: BorderOptions, signing: Rc<RefCell<SigningState>>) -> Self {
        Self { options, signing }
    }

    /// Only frames with a good signature, and those of `allow_unsigned_in`, get in.
    pub fn verifies(&self) -> bool {
        self.options.verify
    }

    /// A good frame as it enters; `None` if it has no good signature and needs one. `now` in units of signing timestamps.
    pub fn incoming<'a>(&self, frame: &'a [u8], now: u64) -> Option<Entered<'a>> {
        let whole = FrameRef::parse(frame).ok()?;
        let mut proven = true;
        if self.options.verify {
            let mut signing = self.signing.borrow_mut();
            signing.max_ahead = self.options.max_ahead; // this link's: others share the state
            match signing.check(&whole, Some(now)) {
                Verdict::Good { .. } => {}
                Verdict::Unsigned if self.options.unsigned.contains(&whole.header().msgid) => {
                    proven = false;
                }
                _ => return None,
            }
        }
        let bare = self.options.strip_in && whole.header().is_signed();
        let frame = if bare { Cow::Owned(without_signature(frame)) } else { Cow::Borrowed(frame) };
        Some(Entered { frame, proven })
    }

    /// A good frame as it leaves; `None` if it cannot be said in the version of the link, or not be signed.
    pub fn outgoing<'a>(
        &self,
        frame: &'a [u8],
        entry: Option<Entry>,
        now: u64,
    ) -> Option<Cow<'a, [u8]>> {
        let whole = FrameRef::parse(frame).ok()?;
        let header = whole.header();
        if self.options.sign {
            return self.signed(&whole, entry, now).map(Cow::Owned);
        }
        match self.options.version {
            Some(version) if version != header.version => {
                converted(&whole, entry, version, 0).map(|frame| Cow::Owned(frame.to_vec()))
            }
            _ if self.options.strip_out && header.is_signed() => {
                Some(Cow::Owned(without_signature(frame)))
            }
            _ => Some(Cow::Borrowed(frame)),
        }
    }

    fn signed(&self, frame: &FrameRef<'_>, entry: Option<Entry>, now: u64) -> Option<Vec<u8>> {
        let mut signed = converted(frame, entry, WireVersion::V2, IFLAG_SIGNED)?;
        let mut signing = self.signing.borrow_mut();
        let (_, block) = signing.sign(&signed, self.options.link_id, Some(now)).ok()?;
        signed.append_signature(&block);
        Some(signed.to_vec())
    }
}

/// The same message in a wire version, with flags. A message that nobody knows keeps the `crc_extra` that its checksum
/// implies; how long it is in version 1 cannot be known.
fn converted(
    frame: &FrameRef<'_>,
    entry: Option<Entry>,
    version: WireVersion,
    incompat_flags: u8,
) -> Option<FrameBuffer> {
    let header = Header { version, incompat_flags, ..*frame.header() };
    let implied = || x25::implied_extra(x25::checksum(frame.crc_region()), frame.checksum());
    let crc_extra = entry.map(|entry| entry.crc_extra).or_else(implied)?;
    let mut space = [0; 255];
    let payload = match (version, entry) {
        (WireVersion::V2, _) => frame.payload(),
        // Extension fields are not for version 1, and zeros are not cut there.
        (WireVersion::V1, Some(entry)) => {
            payload_extended(frame.payload(), entry.min_len, &mut space)
        }
        (WireVersion::V1, None) => return None,
    };
    let mut buffer = FrameBuffer::default();
    buffer.encode(header, payload, crc_extra).ok()?;
    Some(buffer)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::encode;
    use crate::registry::Registry;
    use crate::testing::{HEARTBEAT_V1, HEARTBEAT_V2, header, registry};
    use WireVersion::{V1, V2};

    const NOW: u64 = 5_000_000_000;
    /// No definition has it.
    const UNKNOWN: u32 = 201;

    fn state(key: u8) -> Rc<RefCell<SigningState>> {
        let mut state = SigningState::default();
        state.set_key(Some(SecretKey::new(&[key; 32]).expect("32 bytes")));
        state.timestamp = NOW;
        Rc::new(RefCell::new(state))
    }

    fn border(options: BorderOptions, key: u8) -> Border {
        Border::new(options, state(key))
    }

    fn leaves(border: &Border, registry: &Registry, frame: &[u8]) -> Option<Vec<u8>> {
        let header = Header::parse(frame).expect("a frame");
        let entry = registry.lookup(header.msgid);
        let left = border.outgoing(frame, entry, NOW).map(Cow::into_owned);
        if let Some(left) = &left {
            let foretold = border.options.len_outside(frame.len(), &header, entry);
            let spare = foretold.checked_sub(left.len()).expect("at least as many");
            assert!(spare == 0 || left[0] != frame[0], "{foretold}: {left:?}");
        }
        left
    }

    fn enters(border: &Border, frame: &[u8]) -> Option<Vec<u8>> {
        border.incoming(frame, NOW).map(|entered| entered.frame.into_owned())
    }

    fn frame(version: WireVersion, msgid: u32, payload: &[u8], crc_extra: u8) -> Vec<u8> {
        let mut out = Vec::new();
        encode(&mut out, header(version, msgid, 7), payload, crc_extra).expect("it fits");
        out
    }

    #[test]
    fn a_frame_leaves_in_the_version_of_the_link() {
        let registry = registry();
        let to = |version| border(BorderOptions { version: Some(version), ..<_>::default() }, 1);
        for (from, into, version) in [
            (&HEARTBEAT_V2[..], &HEARTBEAT_V1[..], V1),
            (&HEARTBEAT_V1, &HEARTBEAT_V1, V1),
            (&HEARTBEAT_V1, &HEARTBEAT_V2, V2),
            (&HEARTBEAT_V2, &HEARTBEAT_V2, V2),
        ] {
            let mut from = from.to_vec();
            let seq = if from[0] == 0xFD { 4 } else { 2 };
            let mut into = into.to_vec();
            let into_seq = if into[0] == 0xFD { 4 } else { 2 };
            // The twins differ in their number; that of the one that goes in counts.
            into[into_seq] = from[seq];
            for bytes in [&mut from, &mut into] {
                let end = bytes.len() - 2;
                let checksum = x25::push(x25::checksum(&bytes[1..end]), 50);
                bytes[end..].copy_from_slice(&checksum.to_le_bytes());
            }
            assert_eq!(leaves(&to(version), &registry, &from), Some(into), "{version:?}");
        }
    }

    #[test]
    fn what_a_version_cannot_say_is_refused() {
        let registry = registry();
        let to = |version| border(BorderOptions { version: Some(version), ..<_>::default() }, 1);
        let unknown = frame(V2, UNKNOWN, &[3; 20], 77);
        assert_eq!(leaves(&to(V1), &registry, &unknown), None, "nobody knows its length");
        let long_id = frame(V2, 17_000, &[3; 20], registry.lookup(17_000).unwrap().crc_extra);
        assert_eq!(leaves(&to(V1), &registry, &long_id), None);
        let old = frame(V1, UNKNOWN, &[3; 20], 77);
        assert_eq!(leaves(&to(V2), &registry, &old), Some(unknown), "its checksum says enough");
        assert_eq!(leaves(&to(V2), &registry, b"\xfdjunk, which is no frame"), None);
    }

    #[test]
    fn what_is_signed_here_is_believed_there_and_once_only() {
        let registry = registry();
        let here = border(BorderOptions { sign: true, link_id: 9, ..<_>::default() }, 1);
        let options = BorderOptions { verify: true, strip_in: true, ..<_>::default() };
        let (there, stranger) = (border(options.clone(), 1), border(options, 2));
        for plain in [HEARTBEAT_V2.to_vec(), frame(V2, UNKNOWN, &[3; 20], 77)] {
            let signed = leaves(&here, &registry, &plain).expect("it can be signed");
            assert_eq!(signed.len(), plain.len() + 13);
            assert_eq!(enters(&stranger, &signed), None);
            assert_eq!(enters(&there, &signed), Some(plain.clone()), "and bare");
            assert_eq!(there.incoming(&signed, NOW), None, "a replay");
            assert_eq!(there.incoming(&plain, NOW), None, "not signed");
            let again = leaves(&here, &registry, &signed).expect("signed anew");
            assert_eq!(enters(&there, &again), Some(plain));
        }
        let old = leaves(&here, &registry, &HEARTBEAT_V1).expect("version 2 from here on");
        assert!(there.incoming(&old, NOW).is_some());
    }

    #[test]
    fn r52_each_link_says_how_far_ahead_a_signature_may_be() {
        let shared = state(1);
        let with = |max_ahead| {
            let options = BorderOptions { verify: true, max_ahead, ..<_>::default() };
            Border::new(options, Rc::clone(&shared))
        };
        let (near, any) = (with(Some(10)), with(None));
        let key = SecretKey::new(&[1; 32]).expect("32 bytes");
        let ahead = |timestamp| {
            let header = Header { incompat_flags: IFLAG_SIGNED, ..header(V2, 0, 7) };
            let mut frame = Vec::new();
            encode(&mut frame, header, &[1; 9], 50).expect("it fits");
            crate::signing::sign(&mut frame, &key, 3, NOW + timestamp);
            frame
        };
        assert!(near.incoming(&ahead(10), NOW).is_some());
        assert!(near.incoming(&ahead(11), NOW).is_none());
        assert!(any.incoming(&ahead(12), NOW).is_some());
        assert!(near.incoming(&ahead(13), NOW).is_none(), "its own limit again");
    }

    #[test]
    fn messages_may_be_named_that_need_no_signature() {
        let options = BorderOptions { verify: true, unsigned: vec![0], ..<_>::default() };
        let border = border(options, 1);
        let entered = border.incoming(&HEARTBEAT_V2, NOW).expect("it is named");
        assert_eq!(entered, Entered { frame: Cow::Borrowed(&HEARTBEAT_V2), proven: false });
        let genuine = super::tests::border(BorderOptions { sign: true, ..<_>::default() }, 1);
        let genuine = leaves(&genuine, &registry(), &HEARTBEAT_V2).expect("signed");
        assert!(border.incoming(&genuine, NOW).expect("signed").proven);
        assert_eq!(border.incoming(&frame(V2, 30, &[1; 28], 39), NOW), None);
        let forged = leaves(
            &super::tests::border(BorderOptions { sign: true, ..<_>::default() }, 2),
            &registry(),
            &HEARTBEAT_V2,
        );
        assert_eq!(border.incoming(&forged.expect("signed"), NOW), None, "a wrong one is wrong");
    }

    #[test]
    fn signatures_are_taken_off_what_leaves() {
        let registry = registry();
        let here = border(BorderOptions { sign: true, ..<_>::default() }, 1);
        let signed = leaves(&here, &registry, &HEARTBEAT_V2).expect("signed");
        let bare = border(BorderOptions { strip_out: true, ..<_>::default() }, 1);
        assert_eq!(leaves(&bare, &registry, &signed).as_deref(), Some(&HEARTBEAT_V2[..]));
        assert_eq!(leaves(&bare, &registry, &HEARTBEAT_V1).as_deref(), Some(&HEARTBEAT_V1[..]));
        assert!(BorderOptions::default().is_open() && !bare.options.is_open());
    }
}
