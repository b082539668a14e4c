//! The signing state beside a plain account of it: each verdict is foretold, and nobody without the key changes anything.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;

use mavwire_core::border::{Border, BorderOptions};
use mavwire_core::frame::{FrameRef, Header, IFLAG_SIGNED};
use mavwire_core::signing::{
    MAX_LOCAL_LEAD, MAX_TIMESTAMP, NEW_STREAM_WINDOW, Sightings, SigningState, Stream, StreamId,
    StreamTable, Verdict,
};
use mavwire_schema::WireVersion;

use crate::dialects::{ALL, any_frame, frame_of, key, signed};
use crate::input::Input;

/// Steps of timestamps and clocks, which are about equal, just within the window, or just beyond it.
const STEPS: [i64; 12] = [
    0,
    1,
    2,
    100,
    100_000,
    -1,
    -100,
    NEW_STREAM_WINDOW as i64 - 1,
    NEW_STREAM_WINDOW as i64,
    NEW_STREAM_WINDOW as i64 + 1,
    -(NEW_STREAM_WINDOW as i64),
    -(NEW_STREAM_WINDOW as i64) - 1,
];

/// Streams that the table has room for; senders make up more.
const CAPACITY: usize = 12;
const MAX_AHEAD: u64 = 1_000_000;

/// A timestamp a small step away from another one.
fn near(input: &mut Input<'_>, from: u64) -> u64 {
    let step = STEPS[usize::from(input.byte()) % STEPS.len()];
    from.saturating_add_signed(step).min(MAX_TIMESTAMP)
}

/// A small frame from one of a few senders with a timestamp, signed with one of two keys, perhaps with a flipped bit; and
/// whether it is as it was signed with the first of them.
fn signed_frame(input: &mut Input<'_>, timestamp: u64) -> (Vec<u8>, bool) {
    let header = Header::new(WireVersion::V2, 0, input.byte() % 4, input.byte() % 2, 0);
    let frame = frame_of(header, &[1; 9], 9, 50);
    let (key_byte, link_id) = (input.byte() % 4, input.byte() % 4);
    let mut frame = signed(&frame, u8::from(key_byte == 3), link_id, timestamp);
    let mut genuine = key_byte != 3;
    if input.byte() % 8 == 7 {
        let (at, bit) = (usize::from(input.byte()) % frame.len(), input.byte() % 8);
        frame[at] ^= 1 << bit;
        genuine = false;
    }
    (frame, genuine)
}

/// The verified streams: the timestamp of the last frame, and when it came. And by link id, the last timestamps of replaced
/// streams.
#[derive(Default)]
struct Account {
    known: BTreeMap<StreamId, (u64, u64)>,
    gone: BTreeMap<u8, u64>,
    heard: u64,
}

impl Account {
    /// Notes a genuine frame. It may replace the longest silent stream; streams far ahead of the clock are replaced last.
    fn note(&mut self, id: StreamId, timestamp: u64, now: Option<u64>) {
        if !self.known.contains_key(&id) && self.known.len() == CAPACITY {
            let ahead = |timestamp| now.is_some_and(|now| timestamp > now + NEW_STREAM_WINDOW);
            let order =
                |(_, (timestamp, heard)): &(StreamId, (u64, u64))| (ahead(*timestamp), *heard);
            let known = self.known.iter().map(|(&id, &one)| (id, one));
            let (gone, (timestamp, _)) = known.min_by_key(order).expect("it is full");
            self.known.remove(&gone);
            let floor = self.gone.entry(gone.link_id).or_default();
            *floor = timestamp.max(*floor);
        }
        self.heard += 1;
        self.known.insert(id, (timestamp, self.heard));
    }
}

/// The expected verdict about a frame.
fn foretold(
    state: &SigningState,
    streams: &Account,
    frame: &FrameRef<'_>,
    genuine: bool,
    now: Option<u64>,
) -> Verdict {
    let Some(signature) = frame.signature() else { return Verdict::Unsigned };
    let timestamp = signature.timestamp;
    let behind = state.timestamp.saturating_sub(MAX_LOCAL_LEAD);
    let local = now.map_or(state.timestamp, |now| behind.max(now));
    let gone = streams.gone.get(&signature.link_id);
    let stream = match streams.known.get(&stream_of(frame)) {
        Some(&(last, _)) if timestamp <= last => return Verdict::OldTimestamp { timestamp, last },
        Some(_) => Stream::Known,
        None if gone.is_some_and(|&gone| timestamp <= gone) => {
            let local = gone.map_or(local, |gone| local.max(gone + 1));
            return Verdict::NewStreamTooOld { timestamp, local };
        }
        None if local.saturating_sub(timestamp) > NEW_STREAM_WINDOW => {
            return Verdict::NewStreamTooOld { timestamp, local };
        }
        None => Stream::New,
    };
    match now.filter(|_| state.max_ahead.is_some()) {
        Some(now) if timestamp > now + MAX_AHEAD => Verdict::TooFarAhead { timestamp, now },
        _ if !genuine => Verdict::Mismatch { stream },
        _ => Verdict::Good { stream },
    }
}

fn stream_of(frame: &FrameRef<'_>) -> StreamId {
    let (header, signature) = (frame.header(), frame.signature().expect("it is signed"));
    StreamId { link_id: signature.link_id, sysid: header.sysid, compid: header.compid }
}

/// Any sequence of sending and receiving, with and without a key and a clock.
pub fn signing(data: &[u8]) {
    let mut input = Input::new(data);
    let mut state = SigningState::default();
    state.streams = StreamTable::with_capacity(CAPACITY);
    state.timestamp = input.long() >> 16;
    state.max_ahead = (input.byte() % 2 == 1).then_some(MAX_AHEAD);
    state.set_key(Some(key(0)));
    let (mut streams, mut seen, mut sent) = (Account::default(), Sightings::default(), None);
    let (mut clock, mut newest) = (state.timestamp, state.timestamp);
    while !input.is_empty() {
        let step = input.byte();
        let now = (step % 2 == 1).then(|| near(&mut input, clock));
        clock = now.unwrap_or(clock);
        match step / 2 % 16 {
            0 => state.set_key((!state.has_key()).then(|| key(0))),
            1..=3 => {
                if let Ok(timestamp) = state.next_timestamp(now) {
                    assert!(timestamp <= MAX_TIMESTAMP && Some(timestamp) > sent);
                    assert!(timestamp >= now.unwrap_or(0).min(MAX_TIMESTAMP));
                    assert_eq!(state.timestamp, timestamp + 1);
                    sent = Some(timestamp);
                } else {
                    assert!(state.timestamp > MAX_TIMESTAMP);
                }
            }
            _ => {
                let timestamp = near(&mut input, newest);
                let (frame, genuine) = signed_frame(&mut input, timestamp);
                let Ok(frame) = FrameRef::parse(&frame) else { continue };
                if step & 128 != 0 {
                    looked_at(&mut state, &mut seen, &frame, now);
                }
                received(&mut state, &mut streams, &frame, genuine, now);
                newest = timestamp;
            }
        }
        assert!(state.streams.iter().eq(streams.known.iter().map(|(&id, &(last, _))| (id, last))));
    }
}

/// A look accepts no frame twice, and changes nothing for the receiver.
fn looked_at(
    state: &mut SigningState,
    seen: &mut Sightings,
    frame: &FrameRef<'_>,
    now: Option<u64>,
) {
    let (timestamp, streams) = (state.timestamp, state.streams.clone());
    let first = state.look(seen, &streams, frame, now);
    let second = state.look(seen, &streams, frame, now);
    assert!(!(first.is_verified() && second.is_verified()));
    assert_eq!(state.timestamp, timestamp);
    assert!(state.streams.iter().eq(streams.iter()));
}

fn received(
    state: &mut SigningState,
    streams: &mut Account,
    frame: &FrameRef<'_>,
    genuine: bool,
    now: Option<u64>,
) {
    let before = state.timestamp;
    let mut expected = foretold(state, streams, frame, genuine, now);
    if !state.has_key() {
        expected = Verdict::NoKey;
    }
    assert_eq!(state.check(frame, now), expected);
    if expected.is_verified() {
        let timestamp = frame.signature().expect("it is signed").timestamp;
        streams.note(stream_of(frame), timestamp, now);
        assert!(state.timestamp == before || (before..=timestamp).contains(&state.timestamp));
    } else {
        assert_eq!(state.timestamp, before, "without the key nothing changes");
    }
}

/// Frames through the border of a link: what leaves has a good checksum, what was signed here is believed once, and what a
/// stranger signed never.
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
        max_ahead: (flags & 64 != 0).then_some(MAX_AHEAD),
        link_id: input.byte(),
    };
    let mut newest = input.long() >> 20;
    let state = || {
        let mut state = SigningState::default();
        state.set_key(Some(key(0)));
        state.timestamp = newest;
        Rc::new(RefCell::new(state))
    };
    let border = Border::new(options.clone(), state());
    let verify = BorderOptions { verify: true, ..BorderOptions::default() };
    let peer = Border::new(verify, state());
    while !input.is_empty() {
        let now = near(&mut input, newest);
        newest = newest.max(now) + 1;
        let plain = any_frame(&mut input);
        let by = input.byte();
        let frame = match by % 4 {
            0 => plain,
            one => signed(&plain, u8::from(one == 3), by / 4, near(&mut input, newest)),
        };
        leaves(&border, &peer, &options, &frame, now);
        enters(&border, &options, &frame, by % 4 != 3, now);
        let any = input.bytes(usize::from(by / 16));
        let _ = (border.incoming(any, now), border.outgoing(any, None, now));
    }
}

fn leaves(border: &Border, peer: &Border, options: &BorderOptions, frame: &[u8], now: u64) {
    let before = *FrameRef::parse(frame).expect("a frame").header();
    let entry = ALL.lookup(before.msgid);
    let Some(left) = border.outgoing(frame, entry, now) else {
        let is_old = options.version == Some(WireVersion::V1) && !options.sign;
        return assert!(options.sign || is_old && before.msgid > 255, "refused for nothing");
    };
    check(&left);
    let after = *FrameRef::parse(&left).expect("a frame").header();
    let is_kept = before.is_signed()
        && !options.strip_out
        && options.version.is_none_or(|version| version == before.version);
    assert_eq!(after.is_signed(), options.sign || is_kept);
    let id = |header: Header| (header.msgid, header.seq, header.sysid, header.compid);
    assert_eq!(id(after), id(before));
    assert!(left.len() <= options.len_outside(frame.len(), &before, entry));
    if options.sign {
        assert!(after.incompat_flags == IFLAG_SIGNED && after.version == WireVersion::V2);
        if peer.incoming(&left, now).is_some() {
            assert!(peer.incoming(&left, now).is_none(), "a replay");
        }
    }
}

fn enters(border: &Border, options: &BorderOptions, frame: &[u8], is_own: bool, now: u64) {
    let header = *FrameRef::parse(frame).expect("a frame").header();
    let Some(entered) = border.incoming(frame, now) else {
        let needs_none = !header.is_signed() && options.unsigned.contains(&header.msgid);
        return assert!(options.verify && !needs_none, "refused for nothing");
    };
    check(&entered.frame);
    if options.verify {
        assert!(is_own || !header.is_signed(), "signed by a stranger");
        assert_eq!(entered.proven, header.is_signed());
        assert!(header.is_signed() || options.unsigned.contains(&header.msgid));
        assert!(!header.is_signed() || border.incoming(frame, now).is_none(), "a replay");
    }
    let after = *FrameRef::parse(&entered.frame).expect("a frame").header();
    assert_eq!(after.is_signed(), header.is_signed() && !options.strip_in);
}

fn check(frame: &[u8]) {
    let whole = FrameRef::parse(frame).expect("what a border lets through is a frame");
    if let Some(entry) = ALL.lookup(whole.header().msgid) {
        assert_eq!(whole.checksum(), whole.calculated_checksum(entry.crc_extra));
    }
}
