//! The signing requirements, by number.

use super::*;
use crate::frame::{self, IFLAG_SIGNED};
use crate::testing::{HEARTBEAT_V1, HEARTBEAT_V2, header, unhex};
use mavwire_schema::WireVersion::V2;
use proptest::prelude::*;
use std::collections::HashSet;

const PAYLOAD: [u8; 9] = [4, 0, 0, 0, 2, 3, 0x51, 4, 3];

fn key(byte: u8) -> Option<SecretKey> {
    SecretKey::new(&[byte; 32]).ok()
}

fn receiver() -> SigningState {
    let mut state = SigningState::default();
    state.set_key(key(b'A'));
    state
}

/// A HEARTBEAT from 1/1 signed with key `A`.
fn signed(timestamp: u64, link_id: u8) -> Vec<u8> {
    signed_with(b'A', timestamp, link_id)
}

fn signed_with(key_byte: u8, timestamp: u64, link_id: u8) -> Vec<u8> {
    let mut header = header(V2, 0, 0);
    header.incompat_flags = IFLAG_SIGNED;
    let mut out = Vec::new();
    frame::encode(&mut out, header, &PAYLOAD, 50).expect("a valid header");
    sign(&mut out, &key(key_byte).expect("32 bytes"), link_id, timestamp);
    out
}

fn check(state: &mut SigningState, bytes: &[u8], now: Option<u64>) -> Verdict {
    state.check(&FrameRef::parse(bytes).expect("a whole frame"), now)
}

const GOOD_NEW: Verdict = Verdict::Good { stream: Stream::New };
const GOOD_KNOWN: Verdict = Verdict::Good { stream: Stream::Known };

fn streams(state: &SigningState) -> Vec<(u8, u8, u8, u64)> {
    state.streams.iter().map(|(id, ts)| (id.link_id, id.sysid, id.compid, ts)).collect()
}

#[test]
fn r30_r32_r33_the_block_is_another_implementations() {
    let expected = "fd0901000001010000000400000002035104039c56030605040302019032ccaf5951";
    assert_eq!(signed(0x0102_0304_0506, 3), unhex(expected));
    assert_eq!(timestamp_from_unix_micros(1_420_070_400_000_000), 0);
    assert_eq!(timestamp_from_unix_micros(1_420_070_401_000_019), 100_001);
    assert_eq!(timestamp_from_unix_micros(0), 0);
    assert_eq!(timestamp_from_unix_micros(u64::MAX), MAX_TIMESTAMP);
}

#[test]
fn r34_sent_timestamps_always_grow() {
    let mut state = receiver();
    let clock = [Some(100), Some(100), Some(50), None, Some(99), Some(1000), Some(0)];
    let sent = clock.map(|now| state.next_timestamp(now).unwrap_or(0));
    assert_eq!(sent, [100, 101, 102, 103, 104, 1000, 1001]);
}

#[test]
fn r35_starts_from_the_stored_timestamp_or_the_clock() {
    let mut state = receiver();
    state.timestamp = 500;
    assert_eq!(state.next_timestamp(Some(400)), Ok(500));
    assert_eq!(state.next_timestamp(Some(600)), Ok(600));
    // Without a clock it counts up by one, as pymavlink does.
    assert_eq!(state.next_timestamp(None), Ok(601));
}

#[test]
fn r37_the_local_timestamp_follows_verified_frames_only_upwards() {
    let mut state = receiver();
    state.timestamp = 5;
    assert_eq!(check(&mut state, &signed(999, 3), None), GOOD_NEW);
    assert_eq!(state.timestamp, 999);
    assert_eq!(check(&mut state, &signed(500, 4), None), GOOD_NEW);
    assert_eq!(state.timestamp, 999);
}

#[test]
fn r38_r41_state_changes_only_after_verification() {
    let mut state = receiver();
    // A forged first packet with the largest timestamp neither makes a stream nor moves the clock ...
    let forged = signed_with(b'B', MAX_TIMESTAMP, 3);
    assert_eq!(check(&mut state, &forged, None), Verdict::Mismatch { stream: Stream::New });
    assert_eq!((streams(&state), state.timestamp), (vec![], 0));
    assert_eq!(check(&mut state, &signed(1000, 3), None), GOOD_NEW);
    // ... nor does one of a known stream freeze it.
    assert_eq!(check(&mut state, &forged, None), Verdict::Mismatch { stream: Stream::Known });
    assert_eq!((streams(&state), state.timestamp), (vec![(3, 1, 1, 1000)], 1000));
    assert_eq!(check(&mut state, &signed(1001, 3), None), GOOD_KNOWN);
    assert_eq!(streams(&state), [(3, 1, 1, 1001)]);
}

#[test]
fn r41_a_forged_packet_does_not_reopen_the_replay_window() {
    let mut state = receiver();
    state.timestamp = 10 * NEW_STREAM_WINDOW;
    let captured = signed(1000, 3);
    let too_old = Verdict::NewStreamTooOld { timestamp: 1000, local: state.timestamp };
    assert_eq!(check(&mut state, &captured, None), too_old);
    // Forging a recent packet of that stream would have made it known, so that the old one passes.
    let forged = signed_with(b'B', 10 * NEW_STREAM_WINDOW, 3);
    assert!(!check(&mut state, &forged, None).is_verified());
    assert_eq!(check(&mut state, &captured, None), too_old);
}

#[test]
fn r32_any_flipped_bit_is_a_mismatch() {
    let frame = signed(1000, 3);
    for bit in 0..frame.len() * 8 {
        let mut flipped = frame.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        let mut state = receiver();
        if let Ok(frame) = FrameRef::parse(&flipped) {
            assert!(!state.check(&frame, None).is_verified(), "bit {bit}");
        }
        assert!(state.streams.iter().next().is_none());
    }
}

#[test]
fn r49_digests_are_compared_in_constant_time_and_as_a_whole() {
    let digest = [0x9C, 0x56, 0x03, 0x06, 0x05, 0x04];
    // `Choice` is what constant-time comparing gives: it cannot have come from one that ends early.
    let same: fn(Digest, Digest) -> subtle::Choice = rules::same_digest;
    assert!(bool::from(same(digest, digest)));
    for byte in 0..digest.len() {
        for bit in 0..8 {
            let mut other = digest;
            other[byte] ^= 1 << bit;
            assert!(!bool::from(same(digest, other)), "byte {byte}, bit {bit}");
        }
    }
}

#[test]
fn r39_equal_or_smaller_timestamps_are_replays() {
    let mut state = receiver();
    assert_eq!(check(&mut state, &signed(1000, 3), None), GOOD_NEW);
    for timestamp in [1000, 999, 0] {
        let expected = Verdict::OldTimestamp { timestamp, last: 1000 };
        assert_eq!(check(&mut state, &signed(timestamp, 3), None), expected);
    }
    assert_eq!(check(&mut state, &signed(1001, 3), None), GOOD_KNOWN);
    // Another link, system or component is another stream.
    assert_eq!(check(&mut state, &signed(900, 2), None), GOOD_NEW);
    assert_eq!(streams(&state), [(2, 1, 1, 900), (3, 1, 1, 1001)]);
}

#[test]
fn r40_a_new_stream_may_be_a_minute_behind() {
    let mut state = receiver();
    state.timestamp = 1000 + NEW_STREAM_WINDOW + 1;
    let expected = Verdict::NewStreamTooOld { timestamp: 1000, local: state.timestamp };
    assert_eq!(check(&mut state, &signed(1000, 3), None), expected);
    state.timestamp = 1000 + NEW_STREAM_WINDOW;
    assert_eq!(check(&mut state, &signed(1000, 3), None), GOOD_NEW);
    assert_eq!(state.timestamp, 1000 + NEW_STREAM_WINDOW);
}

#[test]
fn r40_the_window_of_one_that_only_listens_follows_the_clock() {
    let mut state = receiver();
    let now = 1000 + NEW_STREAM_WINDOW;
    let expected = Verdict::NewStreamTooOld { timestamp: 999, local: now };
    assert_eq!(check(&mut state, &signed(999, 3), Some(now)), expected);
    assert_eq!(state.timestamp, 0, "nothing was verified");
    assert_eq!(check(&mut state, &signed(1000, 3), Some(now)), GOOD_NEW);
    // A stream that is known has to rise, and no more.
    assert_eq!(check(&mut state, &signed(1001, 3), Some(2 * now)), GOOD_KNOWN);
}

#[test]
fn r42_links_that_share_a_state_refuse_each_others_replays() {
    let mut shared = receiver();
    let heard_on_link_a = signed(1000, 3);
    assert_eq!(check(&mut shared, &heard_on_link_a, None), GOOD_NEW);
    let replayed_on_link_b = check(&mut shared, &heard_on_link_a, None);
    assert_eq!(replayed_on_link_b, Verdict::OldTimestamp { timestamp: 1000, last: 1000 });
}

#[test]
fn r43_r44_unsigned_and_version_1_frames_are_told_under_a_key() {
    let mut state = receiver();
    assert_eq!(check(&mut state, &HEARTBEAT_V2, None), Verdict::Unsigned);
    assert_eq!(check(&mut state, &HEARTBEAT_V1, None), Verdict::Unsigned);
    assert!(!Verdict::Unsigned.is_verified());
}

#[test]
fn r48_unknown_ids_are_judged_like_any_other() {
    let mut unknown = header(V2, 70_000, 0);
    let mut frame = Vec::new();
    frame::encode(&mut frame, unknown, &PAYLOAD, 77).expect("a valid header");
    assert_eq!(check(&mut receiver(), &frame, None), Verdict::Unsigned);
    frame.clear();
    unknown.incompat_flags = IFLAG_SIGNED;
    frame::encode(&mut frame, unknown, &PAYLOAD, 77).expect("a valid header");
    sign(&mut frame, &key(b'A').expect("32 bytes"), 3, 1000);
    assert_eq!(check(&mut receiver(), &frame, None), GOOD_NEW);
}

#[test]
fn r50_without_a_key_nothing_is_verified() {
    let mut state = SigningState::default();
    assert_eq!(check(&mut state, &signed(1000, 3), None), Verdict::NoKey);
    assert!(
        !Verdict::NoKey.is_verified() && state.streams.iter().next().is_none() && !state.has_key()
    );
    assert_eq!(state.sign(&signed(1000, 3), 3, None), Err(SigningError::NoKey));
}

#[test]
fn r51_the_local_timestamp_stays_near_the_clock_and_never_wraps() {
    let mut state = receiver();
    let now = 1_000_000;
    assert_eq!(check(&mut state, &signed(MAX_TIMESTAMP, 3), Some(now)), GOOD_NEW);
    assert_eq!(state.timestamp, now + MAX_LOCAL_LEAD);
    state.timestamp = MAX_TIMESTAMP;
    assert_eq!(state.sign(&HEARTBEAT_V2, 0, None).map(|(used, _)| used), Ok(MAX_TIMESTAMP));
    for _ in 0..2 {
        let error = state.sign(&HEARTBEAT_V2, 0, None);
        assert_eq!(error, Err(SigningError::TimestampExhausted));
    }
}

#[test]
fn r51_without_a_clock_a_year_of_timestamps_is_left() {
    let mut state = receiver();
    assert_eq!(check(&mut state, &signed(MAX_TIMESTAMP, 3), None), GOOD_NEW);
    assert_eq!(state.timestamp, MAX_TIMESTAMP - KEPT_FREE);
    let signed = state.sign(&HEARTBEAT_V2, 0, None);
    assert_eq!(signed.map(|(used, _)| used), Ok(MAX_TIMESTAMP - KEPT_FREE));
}

#[test]
fn r52_future_timestamps_are_limited_on_request() {
    let mut state = receiver();
    state.max_ahead = Some(1000);
    let far = Verdict::TooFarAhead { timestamp: 2001, now: 1000 };
    assert_eq!(check(&mut state, &signed(2001, 3), Some(1000)), far);
    assert_eq!(check(&mut state, &signed(2000, 3), Some(1000)), GOOD_NEW);
}

#[test]
fn r40_r52_one_fast_clock_shuts_out_no_peer() {
    let (mut state, now) = (receiver(), 100 * MAX_LOCAL_LEAD);
    let ahead = now + 5 * MAX_LOCAL_LEAD;
    assert_eq!(check(&mut state, &signed(ahead, 3), Some(now)), GOOD_NEW);
    assert_eq!(state.timestamp, now + MAX_LOCAL_LEAD, "what is sent follows");
    assert_eq!(check(&mut state, &signed(now - NEW_STREAM_WINDOW, 4), Some(now)), GOOD_NEW);
    let old = now - NEW_STREAM_WINDOW - 1;
    let expected = Verdict::NewStreamTooOld { timestamp: old, local: now };
    assert_eq!(check(&mut state, &signed(old, 5), Some(now)), expected);
}

#[test]
fn r40_timestamps_beyond_the_largest_lead_show_that_the_clock_went_back() {
    let (mut state, now) = (receiver(), 1000);
    state.timestamp = 100 * MAX_LOCAL_LEAD; // as a store kept it
    let local = 99 * MAX_LOCAL_LEAD;
    let old = local - NEW_STREAM_WINDOW - 1;
    let expected = Verdict::NewStreamTooOld { timestamp: old, local };
    assert_eq!(check(&mut state, &signed(old, 3), Some(now)), expected);
    assert_eq!(check(&mut state, &signed(old + 1, 3), Some(now)), GOOD_NEW);
}

#[test]
fn r55_the_longest_silent_stream_is_replaced_and_cannot_be_replayed() {
    let mut state = receiver();
    state.streams = StreamTable::with_capacity(2);
    assert_eq!(check(&mut state, &signed(1, 1), None), GOOD_NEW);
    assert_eq!(check(&mut state, &signed(2, 2), None), GOOD_NEW);
    assert_eq!(check(&mut state, &signed(3, 1), None), GOOD_KNOWN);
    let forged = signed_with(b'B', 4, 3);
    assert_eq!(check(&mut state, &forged, None), Verdict::Mismatch { stream: Stream::New });
    assert_eq!(streams(&state), [(1, 1, 1, 3), (2, 1, 1, 2)], "forged ones take no place");
    assert_eq!(check(&mut state, &signed(4, 3), None), GOOD_NEW);
    assert_eq!(streams(&state), [(1, 1, 1, 3), (3, 1, 1, 4)]);
    let replay = Verdict::NewStreamTooOld { timestamp: 2, local: 4 };
    assert_eq!(check(&mut state, &signed(2, 2), None), replay);
    assert_eq!(state.streams.floor(2), 3);
    assert_eq!(check(&mut state, &signed(1, 4), None), GOOD_NEW, "the floor is of a link id");
    assert_eq!(check(&mut state, &signed(3, 2), None), GOOD_NEW, "it goes on");
    state.streams.clear();
    assert!(state.streams.iter().next().is_none());
}

#[test]
fn r55_a_fast_clock_makes_no_floor_while_others_can_be_replaced() {
    let (mut state, now) = (receiver(), 100 * NEW_STREAM_WINDOW);
    state.streams = StreamTable::with_capacity(2);
    let ahead = now + MAX_LOCAL_LEAD;
    for (timestamp, link_id) in [(ahead, 1), (now, 2), (now, 3)] {
        assert_eq!(check(&mut state, &signed(timestamp, link_id), Some(now)), GOOD_NEW);
    }
    assert_eq!(streams(&state), [(1, 1, 1, ahead), (3, 1, 1, now)]);
    assert_eq!([1, 2].map(|link_id| state.streams.floor(link_id)), [0, now + 1]);
    let mut small = StreamTable::with_capacity(1);
    for link_id in 1..4 {
        small.set(StreamId { link_id, sysid: 1, compid: 1 }, MAX_TIMESTAMP);
    }
    assert_eq!((small.iter().count(), small.floor(2)), (1, MAX_TIMESTAMP + 1));
}

/// A frame of one of a few streams with a timestamp about the clock's, and whether it is only looked at.
fn any_frame() -> impl Strategy<Value = (u8, u64, bool)> {
    (0..12_u8, 0..60_u64, any::<bool>())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn r39_r55_no_frame_is_accepted_twice_after_replacements(
        frames in prop::collection::vec(any_frame(), 1..200),
        has_clock in any::<bool>(),
    ) {
        let (mut state, mut seen) = (receiver(), Sightings::default());
        state.streams = StreamTable::with_capacity(3);
        seen.streams = StreamTable::with_capacity(3);
        let (mut believed, mut shown) = (HashSet::new(), HashSet::new());
        for (n, (link_id, early, is_look)) in (100..).zip(frames) {
            let (timestamp, now) = (n - early, has_clock.then_some(n));
            let frame = signed(timestamp, link_id);
            if is_look {
                let is_good = look(&mut state, &mut seen, &frame, now).is_verified();
                let is_first = !believed.contains(&(link_id, timestamp))
                    && shown.insert((link_id, timestamp));
                prop_assert!(!is_good || is_first, "seen twice");
            } else if check(&mut state, &frame, now).is_verified() {
                prop_assert!(believed.insert((link_id, timestamp)), "believed twice");
            }
            prop_assert!(state.streams.iter().count() <= 3 && seen.streams.iter().count() <= 3);
        }
    }
}

fn look(state: &mut SigningState, seen: &mut Sightings, bytes: &[u8], now: Option<u64>) -> Verdict {
    let streams = state.streams.clone();
    state.look(seen, &streams, &FrameRef::parse(bytes).expect("a whole frame"), now)
}

#[test]
fn r39_what_was_looked_at_is_old_to_who_looks_and_new_to_who_receives() {
    let (mut state, mut seen) = (receiver(), Sightings::default());
    assert_eq!(look(&mut state, &mut seen, &signed(10, 3), None), GOOD_NEW);
    assert_eq!((state.timestamp, streams(&state)), (0, vec![]));
    let old = Verdict::OldTimestamp { timestamp: 10, last: 10 };
    assert_eq!(look(&mut state, &mut seen, &signed(10, 3), None), old);
    assert_eq!(check(&mut state, &signed(10, 3), None), GOOD_NEW);
    assert_eq!(check(&mut state, &signed(12, 3), None), GOOD_KNOWN);
    let old = Verdict::OldTimestamp { timestamp: 11, last: 12 };
    assert_eq!(look(&mut state, &mut seen, &signed(11, 3), None), old);
    let forged = Verdict::Mismatch { stream: Stream::Known };
    assert_eq!(look(&mut state, &mut seen, &signed_with(b'B', 99, 3), None), forged);
    assert_eq!(look(&mut state, &mut seen, &signed(13, 3), None), GOOD_KNOWN);
    assert_eq!(
        look(&mut state, &mut seen.begun_anew(), &signed(13, 3), None),
        Verdict::OldTimestamp { timestamp: 13, last: 13 }
    );
}

#[test]
fn r40_r52_who_looks_obeys_the_rules_of_who_receives() {
    let now = Some(10 * NEW_STREAM_WINDOW);
    let (mut state, mut seen) = (receiver(), Sightings::default());
    state.max_ahead = Some(5);
    let early = 9 * NEW_STREAM_WINDOW - 1;
    let local = 10 * NEW_STREAM_WINDOW;
    let too_old = Verdict::NewStreamTooOld { timestamp: early, local };
    assert_eq!(look(&mut state, &mut seen, &signed(early, 3), now), too_old);
    let ahead = Verdict::TooFarAhead { timestamp: local + 6, now: local };
    assert_eq!(look(&mut state, &mut seen, &signed(local + 6, 3), now), ahead);
    // Without a clock the looks have a local timestamp of their own, which moves.
    assert_eq!(look(&mut state, &mut seen, &signed(local, 3), None), GOOD_NEW);
    assert_eq!(look(&mut state, &mut seen, &signed(early, 4), None), too_old);
    assert_eq!(look(&mut state, &mut seen.begun_anew(), &signed(early, 4), None), GOOD_NEW);
}

#[test]
fn r41_a_look_keeps_nothing_of_a_forged_frame() {
    let (mut state, mut seen) = (receiver(), Sightings::default());
    assert_eq!(check(&mut state, &signed(10, 3), None), GOOD_NEW);
    let forged = Verdict::Mismatch { stream: Stream::Known };
    assert_eq!(look(&mut state, &mut seen, &signed_with(b'B', 11, 3), None), forged);
    let old = Verdict::OldTimestamp { timestamp: 10, last: 10 };
    assert_eq!(look(&mut state, &mut seen, &signed(10, 3), None), old);
    assert!(seen.streams.iter().next().is_none());
}
