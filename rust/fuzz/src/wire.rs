//! Frames: finding them, reading them, writing them.

use mavwire_core::codec::{field_bytes, number, payload_extended, text_bytes};
use mavwire_core::frame::{FrameRef, MAX_FRAME_LEN};
use mavwire_core::scan::{Found, Resync, Scanner};
use mavwire_core::stream::FrameStream;
use mavwire_core::text;
use mavwire_schema::WireVersion;

use crate::dialects::{ALL, any_frame};
use crate::input::Input;

const POLICIES: [Resync; 2] = [Resync::Skip, Resync::Rescan];

/// Good frames, and all bytes that came out, in their order.
#[derive(Default, PartialEq, Eq, Debug)]
struct Outcome {
    frames: Vec<Vec<u8>>,
    bytes: Vec<u8>,
}

impl Outcome {
    fn take(&mut self, bytes: &[u8], found: Found) {
        assert!(!bytes.is_empty(), "every outcome moves on");
        self.bytes.extend_from_slice(bytes);
        let Found::Frame { len, header, entry } = found else { return };
        assert_eq!(len, bytes.len());
        let frame = FrameRef::parse(bytes).expect("what is found is a frame");
        assert_eq!(*frame.header(), header);
        if let Some(entry) = entry {
            assert_eq!(frame.checksum(), frame.calculated_checksum(entry.crc_extra));
        }
        self.frames.push(bytes.to_vec());
    }
}

fn scanned(policy: Resync, bytes: &[u8], good_first: bool) -> Outcome {
    let (mut scanner, mut outcome, mut at) = (Scanner::new(policy), Outcome::default(), 0);
    loop {
        let unread = &bytes[at..];
        if good_first && let Some((len, entry)) = scanner.next_good(unread, &ALL) {
            let frame = &unread[..len];
            let header = *FrameRef::parse(frame).expect("a frame").header();
            outcome.take(frame, Found::Frame { len, header, entry: Some(entry) });
            at += len;
            continue;
        }
        let found = scanner.next(unread, &ALL);
        let len = match found {
            Found::Frame { len, .. } | Found::Noise { len } | Found::Rejected { len, .. } => len,
            Found::Incomplete { needed } => {
                assert!(needed > unread.len(), "{needed} bytes are there");
                outcome.bytes.extend_from_slice(unread);
                return outcome;
            }
        };
        outcome.take(&unread[..len], found);
        at += len;
    }
}

/// Chunks of sizes that `sizes` says.
fn streamed(policy: Resync, mut bytes: &[u8], sizes: &[u8]) -> Outcome {
    let (mut stream, mut outcome) = (FrameStream::new(policy), Outcome::default());
    let mut sizes = sizes.iter().cycle();
    while !bytes.is_empty() {
        let size = *sizes.next().unwrap_or(&0);
        let (chunk, rest) = bytes.split_at((usize::from(size) + 1).min(bytes.len()));
        bytes = rest;
        let mut feed = stream.feed(chunk);
        while let Some(piece) = feed.next(&ALL) {
            outcome.take(piece.bytes, piece.found);
        }
        drop(feed);
        assert!(stream.buffered() < MAX_FRAME_LEN, "memory");
    }
    outcome.bytes.extend_from_slice(stream.unread());
    outcome
}

/// Any bytes in any chunks: no byte is lost, and the same frames come out as of the whole.
pub fn scanner(data: &[u8]) {
    let mut input = Input::new(data);
    let count = usize::from(input.byte() % 8);
    let sizes = input.bytes(count);
    let bytes = input.rest();
    for policy in POLICIES {
        let whole = scanned(policy, bytes, false);
        assert_eq!(whole.bytes, bytes);
        assert_eq!(scanned(policy, bytes, true), whole, "asking for good frames first");
        assert_eq!(streamed(policy, bytes, sizes), whole, "{policy:?} by chunking");
    }
}

/// A stream of good frames is the same under both policies, whatever the payloads look like.
pub fn policies(data: &[u8]) {
    let mut input = Input::new(data);
    let mut frames = Vec::new();
    while !input.is_empty() && frames.len() < 64 {
        frames.push(any_frame(&mut input));
    }
    let bytes = frames.concat();
    for policy in POLICIES {
        let outcome = scanned(policy, &bytes, true);
        assert_eq!(outcome.frames, frames, "{policy:?}");
        assert_eq!(streamed(policy, &bytes, data), outcome, "{policy:?} in chunks");
    }
}

/// Encode, parse, encode: the same bytes; and every field can be read and printed.
pub fn codec(data: &[u8]) {
    let frame = any_frame(&mut Input::new(data));
    let whole = FrameRef::parse(&frame).expect("a frame");
    let header = *whole.header();
    let entry = ALL.lookup(header.msgid).expect("a known message");
    assert_eq!(whole.checksum(), whole.calculated_checksum(entry.crc_extra));
    let message = ALL.message(entry.index);
    let (mut space, mut again) = ([0; 255], Vec::new());
    let v1 = header.version == WireVersion::V1;
    let len = if v1 { entry.min_len } else { entry.max_len };
    let payload = payload_extended(whole.payload(), len, &mut space);
    mavwire_core::frame::encode(&mut again, header, payload, entry.crc_extra).expect("it fits");
    assert_eq!(again, frame);
    // Bytes that a truncated payload lacks read as zero: both payloads are the same message.
    let shown = [whole.payload(), payload].map(|payload| {
        let (mut shown, mut json) = (String::new(), String::new());
        text::write_text(&mut shown, message, payload);
        text::write_json(&mut json, message, payload);
        assert!(json.is_ascii() && !json.contains(|one: char| one.is_ascii_control()), "{json}");
        (shown, json)
    });
    assert_eq!(shown[0], shown[1]);
    for field in &message.fields {
        assert_eq!(text_bytes(field, whole.payload()), text_bytes(field, payload));
        assert!(field_bytes(field, payload).starts_with(field_bytes(field, whole.payload())));
        for element in 0..field.elements() {
            let at = usize::from(field.offset) + element * field.field_type.size();
            let values = [whole.payload(), payload].map(|p| number(field.field_type, p, at));
            assert_eq!(format!("{:?}", values[0]), format!("{:?}", values[1]));
        }
    }
}
