//! The signing state: nobody without the key changes it, and no timestamp is taken twice.

use std::cell::RefCell;
use std::collections::HashSet;
use std::rc::Rc;
use std::sync::Arc;

use mavwire_core::border::{Border, BorderOptions};
use mavwire_core::frame::{FrameRef, Header, IFLAG_SIGNED};
use mavwire_core::signing::{MAX_TIMESTAMP, SecretKey, SigningState, Verdict, sign};
use mavwire_schema::WireVersion;

use crate::dialects::{ALL, any_frame};
use crate::input::Input;

fn key(byte: u8) -> SecretKey {
    SecretKey::new(&[byte; 32]).expect("32 bytes")
}

/// A small frame from one of a few senders, signed with one of two keys, perhaps with a flipped bit.
fn signed_frame(input: &mut Input<'_>) -> (Vec<u8>, bool) {
    let header = Header {
        version: WireVersion::V2,
        payload_len: 0,
        incompat_flags: IFLAG_SIGNED,
        compat_flags: 0,
        seq: 0,
        sysid: input.byte() % 4,
        compid: input.byte() % 2,
        msgid: 0,
    };
    let mut frame = Vec::new();
    mavwire_core::frame::encode(&mut frame, header, &[1; 9], 50).expect("it fits");
    let (key_byte, link_id, timestamp) = (input.byte() % 2, input.byte() % 4, input.long());
    sign(&mut frame, &key(key_byte), link_id, timestamp >> 16);
    let mut genuine = key_byte == 0;
    if input.byte() % 4 == 3 {
        let (at, bit) = (usize::from(input.byte()) % frame.len(), input.byte() % 8);
        frame[at] ^= 1 << bit;
        genuine = false;
    }
    (frame, genuine)
}

/// Any sequence of sending and receiving.
pub fn signing(data: &[u8]) {
    let mut input = Input::new(data);
    let mut state = SigningState::new();
    state.set_key(Some(key(0)));
    state.timestamp = input.long() >> 16;
    state.max_ahead = (input.byte() % 2 == 1).then_some(1_000_000);
    let (mut taken, mut sent) = (HashSet::new(), None);
    while !input.is_empty() {
        let step = input.byte();
        let now = (step % 2 == 1).then(|| input.long() >> 16);
        let before = (state.timestamp, state.streams.iter().collect::<Vec<_>>());
        if step % 8 > 5 {
            if let Ok(timestamp) = state.next_timestamp(now) {
                assert!(timestamp <= MAX_TIMESTAMP && Some(timestamp) > sent);
                sent = Some(timestamp);
            }
            continue;
        }
        let (frame, genuine) = signed_frame(&mut input);
        let Ok(whole) = FrameRef::parse(&frame) else { continue };
        let verdict = state.check(&whole, now);
        assert!(genuine || !verdict.is_verified(), "{verdict:?} without the key");
        if verdict.is_verified() {
            assert!(taken.insert(frame), "taken twice");
            assert!(state.timestamp >= before.0);
        } else {
            assert_eq!((state.timestamp, state.streams.iter().collect::<Vec<_>>()), before);
        }
        assert!(verdict != Verdict::NoKey);
    }
}

/// Frames through the border of a link: what leaves has a good checksum, and what was signed here is believed once.
pub fn border(data: &[u8]) {
    let mut input = Input::new(data);
    let flags = input.byte();
    let options = BorderOptions {
        version: [None, Some(WireVersion::V1), Some(WireVersion::V2), None][usize::from(flags % 4)],
        key: Some(Arc::new(key(0))),
        verify: flags & 4 != 0,
        unsigned: vec![109],
        sign: flags & 8 != 0,
        strip_in: flags & 16 != 0,
        strip_out: flags & 32 != 0,
        link_id: input.byte(),
    };
    let state = || {
        let mut state = SigningState::new();
        state.set_key(Some(key(0)));
        Rc::new(RefCell::new(state))
    };
    let border = Border::new(options.clone(), state());
    let verify = BorderOptions { verify: true, ..BorderOptions::default() };
    let peer = Border::new(verify, state());
    while !input.is_empty() {
        let now = input.long() >> 20;
        let frame = any_frame(&mut input);
        let entry = ALL.lookup(FrameRef::parse(&frame).expect("a frame").header().msgid);
        if let Some(left) = border.outgoing(&frame, entry, now) {
            check(&left);
            let signed = FrameRef::parse(&left).expect("a frame").header().is_signed();
            assert_eq!(signed, options.sign);
            if signed && peer.incoming(&left, now).is_some() {
                assert!(peer.incoming(&left, now).is_none(), "a replay");
            }
        }
        if let Some(entered) = border.incoming(&frame, now) {
            check(&entered.frame);
        }
        let any = input.bytes(40);
        let _ = (border.incoming(any, now), border.outgoing(any, None, now));
    }
}

fn check(frame: &[u8]) {
    let whole = FrameRef::parse(frame).expect("what a border lets through is a frame");
    if let Some(entry) = ALL.lookup(whole.header().msgid) {
        assert_eq!(whole.checksum(), whole.calculated_checksum(entry.crc_extra));
    }
}
