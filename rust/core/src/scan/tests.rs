//! The scanner's promises: pymavlink's outcome under `Skip`, no good frame lost under `Rescan`, linear work, and
//! independence of chunking.

use super::*;
use crate::frame::MAX_FRAME_LEN;
use crate::testing::{HEARTBEAT_V1, HEARTBEAT_V2, encode, header, noise, registry};
use mavwire_schema::WireVersion::{V1, V2};

/// Frames and junk runs of a whole input; the key of junk is `None`, neighbouring junk is merged.
type Pieces = Vec<(Option<u32>, Vec<u8>)>;

fn add(pieces: &mut Pieces, msgid: Option<u32>, bytes: &[u8]) {
    match pieces.last_mut() {
        Some((None, junk)) if msgid.is_none() => junk.extend_from_slice(bytes),
        _ => pieces.push((msgid, bytes.to_vec())),
    }
}

/// Feeds `input` in chunks of `chunk` bytes and returns the pieces and the unread rest.
fn scan_with(scanner: &mut Scanner, input: &[u8], chunk: usize) -> (Pieces, Vec<u8>) {
    let registry = registry();
    let (mut pieces, mut start, mut end) = (Vec::new(), 0, 0);
    while end < input.len() {
        end = (end + chunk).min(input.len());
        loop {
            let unread = &input[start..end];
            let (len, msgid) = match scanner.next(unread, &registry) {
                Found::Frame { len, header, .. } => (len, Some(header.msgid)),
                Found::Noise { len } | Found::Rejected { len, .. } => (len, None),
                Found::Incomplete { needed } => {
                    assert!(needed > unread.len(), "{needed} bytes are there");
                    break;
                }
            };
            assert!(len > 0, "every outcome moves on");
            add(&mut pieces, msgid, &unread[..len]);
            start += len;
        }
    }
    (pieces, input[start..].to_vec())
}

fn scan(policy: Resync, input: &[u8]) -> (Pieces, Vec<u8>) {
    scan_with(&mut Scanner::new(policy), input, input.len().max(1))
}

fn frames(pieces: &Pieces) -> Vec<&[u8]> {
    pieces.iter().filter(|(id, _)| id.is_some()).map(|(_, bytes)| bytes.as_slice()).collect()
}

/// Good frames of both versions, all lengths, known and unknown ids, with some signed ones.
fn traffic(count: usize) -> Vec<Vec<u8>> {
    let ids = [0, 30, 253, 110, 22, 254, 17000, 70_000];
    (0..count)
        .map(|n| {
            let msgid = ids[n % ids.len()];
            let version = if n % 3 == 2 && msgid < 256 { V1 } else { V2 };
            let mut payload = noise(n * 7 % 256, n as u32);
            payload.push(1);
            payload.truncate(255);
            let mut header = header(version, msgid, n as u8);
            let signed = n % 5 == 4 && version == V2;
            header.incompat_flags = u8::from(signed);
            let mut frame = encode(header, &payload);
            frame.extend(noise(if signed { 13 } else { 0 }, n as u32));
            frame
        })
        .collect()
}

#[test]
fn r1_r2_both_versions_on_one_link() {
    let input = [&HEARTBEAT_V2[..], &HEARTBEAT_V1, &HEARTBEAT_V2].concat();
    for policy in [Resync::Skip, Resync::Rescan] {
        let (pieces, rest) = scan(policy, &input);
        assert_eq!(frames(&pieces), [&HEARTBEAT_V2[..], &HEARTBEAT_V1, &HEARTBEAT_V2]);
        assert!(rest.is_empty());
    }
}

#[test]
fn the_outcome_describes_the_frame() {
    let registry = registry();
    let found = Scanner::new(Resync::Skip).next(&HEARTBEAT_V1, &registry);
    let entry = registry.lookup(0);
    let header = Header {
        payload_len: 9,
        incompat_flags: 0,
        ..header(mavwire_schema::WireVersion::V1, 0, 0)
    };
    assert_eq!(found, Found::Frame { len: 17, header, entry });
    assert_eq!(entry.map(|e| (e.crc_extra, e.min_len, e.max_len)), Some((50, 9, 9)));
}

#[test]
fn r6_a_wrong_checksum_is_rejected_and_both_values_told() {
    let mut frame = HEARTBEAT_V2;
    frame[20] ^= 0xFF;
    let error = FrameError::BadChecksum { msgid: 0, received: 0x517B, calculated: 0xAE7B };
    for policy in [Resync::Skip, Resync::Rescan] {
        let found = Scanner::new(policy).next(&frame, &registry());
        assert_eq!(found, Found::Rejected { len: 21, error });
    }
    assert_eq!(error.to_string(), "invalid MAVLink CRC in msgID 0 0x517b should be 0xae7b");
    let mut careless = Scanner::new(Resync::Skip);
    careless.ignore_checksum = true;
    assert!(matches!(careless.next(&frame, &registry()), Found::Frame { len: 21, .. }));
}

#[test]
fn r15_unknown_incompat_flags_are_rejected_before_the_checksum() {
    let mut frame = HEARTBEAT_V2;
    frame[2] = 0x02;
    let error = FrameError::IncompatFlags(2);
    assert_eq!(error.to_string(), "invalid incompat_flags 0x2 0xfd 12");
    let mut skip = Scanner::new(Resync::Skip);
    assert_eq!(skip.next(&frame[..20], &registry()), Found::Incomplete { needed: 21 });
    assert_eq!(skip.next(&frame, &registry()), Found::Rejected { len: 21, error });
    // Re-scanning need not wait for the rest.
    let found = Scanner::new(Resync::Rescan).next(&frame[..3], &registry());
    assert_eq!(found, Found::Rejected { len: 3, error });
}

#[test]
fn r15_compat_flags_are_ignored() {
    let mut flagged = header(V2, 0, 0);
    flagged.compat_flags = 0xFF;
    let frame = encode(flagged, &[1; 9]);
    for policy in [Resync::Skip, Resync::Rescan] {
        assert_eq!(frames(&scan(policy, &frame).0), [&frame[..]]);
    }
}

#[test]
fn r13_version_1_with_an_unexpected_length_is_accepted() {
    for len in [0, 1, 8, 10, 200] {
        let frame = encode(header(V1, 0, 0), &vec![5; len]);
        for policy in [Resync::Skip, Resync::Rescan] {
            assert_eq!(frames(&scan(policy, &frame).0), [&frame[..]], "{len} bytes");
        }
    }
}

#[test]
fn r4_the_longest_frame_has_280_bytes() {
    let mut longest = header(V2, 110, 0);
    longest.incompat_flags = IFLAG_SIGNED;
    let mut frame = encode(longest, &[0xFF; 255]);
    frame.extend([0xFD; 13]);
    assert_eq!(frame.len(), MAX_FRAME_LEN);
    for policy in [Resync::Skip, Resync::Rescan] {
        let input = [&frame[..], &HEARTBEAT_V2].concat();
        assert_eq!(frames(&scan(policy, &input).0), [&frame[..], &HEARTBEAT_V2]);
    }
}

#[test]
fn noise_runs_to_the_next_stx() {
    let registry = registry();
    for policy in [Resync::Skip, Resync::Rescan] {
        let mut scanner = Scanner::new(policy);
        assert_eq!(scanner.next(b"", &registry), Found::Incomplete { needed: 1 });
        assert_eq!(scanner.next(b"\x01\x02\x03\xFE\0", &registry), Found::Noise { len: 3 });
        assert_eq!(scanner.next(b"\xFE\0", &registry), Found::Incomplete { needed: 3 });
        assert_eq!(scanner.next(b"\xFE\0\0", &registry), Found::Incomplete { needed: 8 });
        scanner.reset();
        assert_eq!(scanner.next(b"\x01\x02", &registry), Found::Noise { len: 2 });
    }
}

/// A false header that claims the frame behind it as payload, then two bytes for its checksum.
fn embedded() -> Vec<u8> {
    let mut bytes = vec![0xFD, 21];
    bytes.extend_from_slice(&HEARTBEAT_V2[2..10]);
    bytes.extend_from_slice(&HEARTBEAT_V2);
    bytes.extend_from_slice(&[0, 0]);
    bytes
}

#[test]
fn skip_drops_what_the_bad_frame_claimed() {
    let input = [&embedded()[..], &HEARTBEAT_V1].concat();
    let error = FrameError::BadChecksum { msgid: 0, received: 0, calculated: 0x20E6 };
    let found = Scanner::new(Resync::Skip).next(&input, &registry());
    assert_eq!(found, Found::Rejected { len: 33, error });
    assert_eq!(frames(&scan(Resync::Skip, &input).0), [&HEARTBEAT_V1]);
}

#[test]
fn r20_rescan_finds_the_frame_inside_a_rejected_one() {
    let input = [&embedded()[..], &HEARTBEAT_V1].concat();
    let (pieces, rest) = scan(Resync::Rescan, &input);
    assert_eq!(frames(&pieces), [&HEARTBEAT_V2[..], &HEARTBEAT_V1]);
    assert_eq!(pieces[0], (None, input[..10].to_vec()));
    assert!(rest.is_empty());
}

#[test]
fn r20_never_inside_a_good_frame_of_known_or_unknown_id() {
    for msgid in [110, 70_000] {
        let carrier = encode(header(V2, msgid, 9), &HEARTBEAT_V2);
        let input = [&HEARTBEAT_V1[..], &carrier, &HEARTBEAT_V1].concat();
        let (pieces, _) = scan(Resync::Rescan, &input);
        assert_eq!(frames(&pieces), [&HEARTBEAT_V1[..], &carrier, &HEARTBEAT_V1]);
    }
}

#[test]
fn r16_an_unknown_id_needs_a_checksum_that_some_definition_explains() {
    let mut frame = encode(header(V2, 70_000, 1), &[7; 30]);
    let entry_of = |frame: &[u8], policy| match Scanner::new(policy).next(frame, &registry()) {
        Found::Frame { entry, .. } => Some(entry),
        _ => None,
    };
    assert_eq!(entry_of(&frame, Resync::Rescan), Some(None));
    let last = frame.len() - 1;
    frame[last] ^= 0x10;
    assert_eq!(entry_of(&frame, Resync::Rescan), None, "no crc_extra explains it");
    assert_eq!(entry_of(&frame, Resync::Skip), Some(None), "as pymavlink");
}

#[test]
fn r16_behind_junk_an_unknown_id_must_have_been_met_before() {
    let unknown = encode(header(V2, 70_000, 1), &[7; 30]);
    let next = encode(header(V2, 70_000, 2), &[7; 30]);
    let twice = [&b"\x01"[..], &unknown, &HEARTBEAT_V2, b"\x02", &unknown, b"\x03"].concat();
    assert_eq!(frames(&scan(Resync::Rescan, &twice).0), [&HEARTBEAT_V2]);
    let (pieces, rest) = scan(Resync::Rescan, &[&twice[..], &next].concat());
    assert_eq!(frames(&pieces), [&HEARTBEAT_V2[..], &next]);
    assert!(rest.is_empty());
}

#[test]
fn good_frames_kept_after_one_stray_stx() {
    let beats: Vec<Vec<u8>> = (0..100).map(|n| encode(header(V2, 0, n), &[3; 9])).collect();
    let input = [vec![0xFD], beats.concat()].concat();
    assert!(frames(&scan(Resync::Rescan, &input).0).len() >= 99);
    assert!(frames(&scan(Resync::Skip, &input).0).len() < 99, "what skipping costs");
}

#[test]
fn good_frames_kept_with_a_false_header_before_each() {
    let mut input = Vec::new();
    for n in 0..1000 {
        input.extend([0xFD, 0xFF, 0x01]);
        input.extend(encode(header(V2, 0, n as u8), &[3; 9]));
    }
    let mut scanner = Scanner::new(Resync::Rescan);
    let (pieces, mut rest) = scan_with(&mut scanner, &input, 1000);
    let mut kept = frames(&pieces).len();
    while !rest.is_empty() {
        match scanner.next_at_end(&rest, &registry()) {
            Found::Frame { len, .. } => {
                kept += 1;
                rest.drain(..len);
            }
            Found::Noise { len } | Found::Rejected { len, .. } => drop(rest.drain(..len)),
            Found::Incomplete { .. } => panic!("nothing is incomplete at the end"),
        }
    }
    assert_eq!(kept, 1000);
}

/// One byte in a hundred is lost; every frame that lost none should come out.
#[test]
fn intact_frames_kept_at_one_percent_byte_loss() {
    let dice = noise(2_000_000, 42);
    let (mut input, mut intact, mut at) = (Vec::new(), 0, 0);
    for frame in traffic(13_330) {
        let before = input.len();
        for &byte in &frame {
            at += 2;
            if u16::from_le_bytes([dice[at % 2_000_000], dice[(at + 1) % 2_000_000]]) >= 655 {
                input.push(byte);
            }
        }
        intact += usize::from(input.len() - before == frame.len());
    }
    let kept = frames(&scan(Resync::Rescan, &input).0).len();
    assert!(kept + 5 >= intact, "{kept} of {intact}");
}

#[test]
fn r22_any_chunking_gives_the_same_result() {
    let mut input = traffic(60).concat();
    for n in (0..input.len()).step_by(97) {
        input[n] ^= 0x41;
    }
    input.extend(noise(700, 3));
    input.extend([0xFE; 600]);
    input.extend(traffic(5).concat());
    for policy in [Resync::Skip, Resync::Rescan] {
        let whole = scan(policy, &input);
        for chunk in (1..=300).chain([1000, 5000]) {
            let (pieces, rest) = scan_with(&mut Scanner::new(policy), &input, chunk);
            assert!(frames(&pieces) == frames(&whole.0), "{policy:?} in chunks of {chunk}");
            let bytes: usize = pieces.iter().map(|(_, bytes)| bytes.len()).sum();
            assert_eq!(bytes + rest.len(), input.len());
            assert!(rest.len() < MAX_FRAME_LEN);
        }
    }
}

#[test]
fn policies_agree_on_clean_input() {
    let traffic = traffic(400);
    let input = traffic.concat();
    let (skip, rescan) = (scan(Resync::Skip, &input), scan(Resync::Rescan, &input));
    assert_eq!(frames(&skip.0), traffic);
    assert_eq!(skip, rescan);
}

/// The naive way costs 265 checked bytes per input byte on these.
#[test]
fn r21_linear_work_on_hostile_input() {
    let len = 200_000;
    let repeat = |pattern: &[u8]| pattern.iter().copied().cycle().take(len).collect::<Vec<u8>>();
    let inputs = [
        repeat(&[0xFE]),
        repeat(&[0xFD]),
        repeat(&[0xFD, 0xFF, 0x01]),
        repeat(&[0xFD, 0xFF, 0x00]),
        repeat(&[0xFE, 0xFF, 0, 0, 0, 0]),
        repeat(&[0xFE, 0xFE, 0xFE, 0xFE, 0xFE, 0x00]),
        noise(len, 1),
        noise(len, 2).iter().map(|b| b | 0xFC).collect(),
        traffic(1500).concat(),
    ];
    for (n, input) in inputs.iter().enumerate() {
        for chunk in [1, 7, 300, 4096, input.len()] {
            let mut scanner = Scanner::new(Resync::Rescan);
            scan_with(&mut scanner, input, chunk);
            let per_byte = scanner.window.work.get() as f64 / input.len() as f64;
            assert!(per_byte <= 3.0, "input {n}, chunks of {chunk}: {per_byte} per byte");
            assert!(scanner.window.covered() < 2048, "memory");
        }
    }
}

proptest::proptest! {
    #[test]
    fn mutated_streams_lose_no_byte_and_do_not_depend_on_chunking(
        cuts in proptest::collection::vec((0usize..6000, proptest::num::u8::ANY, 0u8..3), 0..40),
        chunk in 1usize..600,
    ) {
        let mut input = traffic(50).concat();
        for (at, value, kind) in cuts {
            let at = at % input.len();
            match kind {
                0 => input[at] = value,
                1 => drop(input.remove(at)),
                _ => input.insert(at, value),
            }
        }
        for policy in [Resync::Skip, Resync::Rescan] {
            let whole = scan(policy, &input);
            let (pieces, rest) = scan_with(&mut Scanner::new(policy), &input, chunk);
            let mut bytes: Vec<u8> = pieces.iter().flat_map(|(_, b)| b.clone()).collect();
            bytes.extend(&rest);
            proptest::prop_assert!(bytes == input, "{policy:?} lost bytes");
            proptest::prop_assert!(frames(&pieces) == frames(&whole.0), "{policy:?} by chunking");
        }
    }

    #[test]
    fn arbitrary_bytes_never_panic(input in proptest::collection::vec(
        proptest::prop_oneof![proptest::num::u8::ANY, 0xFCu8..=0xFF, 0u8..3], 0..2000
    )) {
        for policy in [Resync::Skip, Resync::Rescan] {
            let (pieces, rest) = scan(policy, &input);
            let bytes: usize = pieces.iter().map(|(_, bytes)| bytes.len()).sum();
            proptest::prop_assert_eq!(bytes + rest.len(), input.len());
        }
    }
}

/// Lengths and definitions of all good known frames and the lengths of everything else; `ask` asks for good frames first.
fn outcomes(policy: Resync, input: &[u8], ask: bool) -> Vec<(usize, Option<Entry>)> {
    let (registry, mut scanner) = (registry(), Scanner::new(policy));
    let (mut found, mut start) = (Vec::new(), 0);
    loop {
        let unread = &input[start..];
        let good = ask.then(|| scanner.next_good(unread, &registry)).flatten();
        let (len, entry) = match good {
            Some((len, entry)) => (len, Some(entry)),
            None => match scanner.next(unread, &registry) {
                Found::Frame { len, entry, .. } => (len, entry),
                Found::Noise { len } | Found::Rejected { len, .. } => (len, None),
                Found::Incomplete { .. } => return found,
            },
        };
        found.push((len, entry));
        start += len;
    }
}

#[test]
fn asking_for_good_frames_first_changes_nothing() {
    let mut input = Vec::new();
    for (n, mut frame) in traffic(400).into_iter().enumerate() {
        match n % 9 {
            3 => frame[n % 11] ^= 0x40,
            5 => frame.truncate(frame.len() / 2),
            7 => frame.extend_from_slice(&[0xFD, 0x33, 0xFE]),
            _ => {}
        }
        input.extend_from_slice(&frame);
    }
    for policy in [Resync::Skip, Resync::Rescan] {
        let plain = outcomes(policy, &input, false);
        assert_eq!(outcomes(policy, &input, true), plain, "{policy:?}");
        assert!(plain.iter().filter(|(_, entry)| entry.is_some()).count() > 100);
        assert!(plain.iter().filter(|(_, entry)| entry.is_none()).count() > 50);
    }
}
