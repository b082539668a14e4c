//! Checks that logs for others hold no identities, no places, no signatures and no keys.
//!
//! Each frame gets a twin with other secrets: both have to become the same.

use std::sync::LazyLock;

use mavwire_core::anonymize::{Anonymizer, Shift};
use mavwire_core::codec::read;
use mavwire_core::frame::{FrameRef, Header};
use mavwire_core::log::tlog;
use mavwire_schema::{Field, FieldType, Message, WireVersion};

use crate::dialects::{ALL, any_frame, any_message, frame_of, signed};
use crate::input::Input;

/// Fields that tell who a vehicle or its owner is.
const WHO: [&str; 16] = [
    "uid",
    "uid2",
    "serial_number",
    "ssid",
    "password",
    "login",
    "callsign",
    "ICAO_address",
    "flight_id",
    "uas_id",
    "hw_unique_id",
    "uri",
    "MMSI",
    "registration",
    "squawk",
    "secret_key",
];

fn is_who(field: &Field) -> bool {
    WHO.contains(&field.name.as_str())
}

/// Messages that tell who or where somebody is.
static TELLING: LazyLock<Vec<&Message>> = LazyLock::new(|| {
    let tells = |field: &Field| is_who(field) || ["lat", "lon"].contains(&field.name.as_str());
    ALL.dialect().messages.iter().filter(|message| message.fields.iter().any(tells)).collect()
});

/// Shifts, and what shifts by them: making it takes longer than using it.
pub(crate) static ANONYMIZERS: LazyLock<[(Shift, Anonymizer); 4]> = LazyLock::new(|| {
    [(10.0, -100.0), (0.0, 1.0), (89.0, 179.0), (-30.0, 90.0)].map(|(latitude, longitude)| {
        let shift = Shift { latitude, longitude };
        (shift, Anonymizer::new(ALL.dialect(), shift))
    })
});

const SETUP_SIGNING: u32 = 256;
const KEY: std::ops::Range<usize> = 10..42;

/// Any frame of any message, longer and shorter than its definition.
pub fn anonymize(data: &[u8]) {
    let mut input = Input::new(data);
    let flags = input.byte();
    let message = match flags & 4 {
        0 => any_message(&mut input),
        _ => TELLING[usize::from(input.number()) % TELLING.len()],
    };
    let len = input.byte();
    let v1 = flags & 1 != 0 && message.id < 256;
    let version = if v1 { WireVersion::V1 } else { WireVersion::V2 };
    let (shift, anonymizer) = &ANONYMIZERS[usize::from(input.byte()) % ANONYMIZERS.len()];
    let header = Header::new(version, input.byte(), input.byte(), input.byte(), message.id);
    let mut payload = [0; 255];
    let some = input.bytes(255);
    payload[..some.len()].copy_from_slice(some);
    let mut twin = payload;
    for field in message.fields.iter().filter(|field| is_who(field)) {
        twin[usize::from(field.offset)..][..field.wire_len()].fill(0xA5);
    }
    // Bytes beyond the definition have no known meaning, so they may be secrets too.
    twin[message.max_len.into()..].fill(0x5A);
    let [frame, twin] = [payload, twin].map(|all| frame_of(header, &all, len, message.crc_extra));
    let twin = if flags & 2 != 0 { signed(&twin, 3, flags, 1 << 40) } else { twin };
    let [made, made_of_twin] = [&frame, &twin].map(|one| anonymous(anonymizer, one));
    assert_eq!(made, made_of_twin, "{} tells who it was", message.name);
    let Some(made) = made else { return };
    let whole = FrameRef::parse(&made).expect("a frame");
    assert_eq!(whole.checksum(), whole.calculated_checksum(message.crc_extra));
    assert!(!whole.header().is_signed() && header.msgid != SETUP_SIGNING);
    let unlike = Header { payload_len: whole.header().payload_len, ..header };
    assert_eq!(*whole.header(), unlike, "what is in front of the payload stays");
    assert!(whole.payload().len() <= message.max_len.into());
    let before = FrameRef::parse(&frame).expect("a frame").payload();
    moved(message, version, [before, whole.payload()], *shift);
}

fn anonymous(anonymizer: &Anonymizer, frame: &[u8]) -> Option<Vec<u8>> {
    let header = Header::parse(frame).expect("a header");
    let mut out = b"in front".to_vec();
    let kept = anonymizer.apply(frame, &header, ALL.lookup(header.msgid), &mut out);
    assert!(out.starts_with(b"in front"), "what stood there stays");
    kept.then(|| out.split_off(8))
}

/// No place stays where it was.
fn moved(message: &Message, version: WireVersion, [before, after]: [&[u8]; 2], shift: Shift) {
    for field in &message.fields {
        let degrees = match field.name.as_str() {
            "lat" => shift.latitude,
            "lon" => shift.longitude,
            _ => continue,
        };
        let is_place = field.field_type == FieldType::I32
            && field.array_length == 0
            && field.units.as_deref() == Some("degE7");
        let place = |payload| i64::from(i32::from_le_bytes(read(payload, field.offset.into())));
        let (from, to) = (place(before), place(after));
        let turn = 3_600_000_000;
        // Version 1 may end within a field, and ends there afterwards.
        let is_whole = version == WireVersion::V2 || usize::from(field.offset) + 4 <= before.len();
        if is_place && is_whole && from != 0 && from != i64::from(i32::MAX) {
            let wanted = from + (degrees * 1e7) as i64;
            let is_clamped = field.name == "lat" && to.abs() == 900_000_000;
            assert!((wanted - to) % turn == 0 || is_clamped, "{from} {to} {}", message.name);
        }
    }
}

/// Any frame, and any bytes, as a recorder writes them.
pub fn recordable(data: &[u8]) {
    let mut input = Input::new(data);
    let flags = input.byte();
    if flags & 1 != 0 {
        let bytes = input.rest();
        return check(bytes);
    }
    let frame = if flags & 2 == 0 { any_frame(&mut input) } else { any_setup(&mut input) };
    let stamp = input.long();
    let mut frame = if flags & 4 == 0 { frame } else { signed(&frame, 1, flags, stamp) };
    if flags & 8 != 0 {
        let (at, bit) = (usize::from(input.number()) % frame.len(), input.byte() % 8);
        frame[at] ^= 1 << bit;
    }
    check(&frame);
}

/// `SETUP_SIGNING` with any payload, of any length.
fn any_setup(input: &mut Input<'_>) -> Vec<u8> {
    let entry = ALL.lookup(SETUP_SIGNING).expect("it has one");
    let header =
        Header::new(WireVersion::V2, input.byte(), input.byte(), input.byte(), SETUP_SIGNING);
    let len = input.byte();
    frame_of(header, input.bytes(len.into()), len, entry.crc_extra)
}

fn check(frame: &[u8]) {
    let written = tlog::recordable(frame);
    let Ok(before) = FrameRef::parse(frame) else { return assert_eq!(*written, *frame) };
    let after = FrameRef::parse(&written).expect("a frame stays a frame");
    assert!(!after.header().is_signed() || !before.header().is_signed());
    if before.header().msgid == SETUP_SIGNING && before.header().version == WireVersion::V2 {
        return without_key(&before, &after);
    }
    assert_eq!(after.payload(), before.payload());
    let difference = |one: &FrameRef<'_>| one.checksum() ^ one.calculated_checksum(7);
    assert_eq!(difference(&after), difference(&before), "as good as before");
    let signature = if before.header().is_signed() { 13 } else { 0 };
    assert_eq!(written.len(), frame.len() - signature);
}

/// The outcome is the same, and as long, for every key, whole or cut.
fn without_key(before: &FrameRef<'_>, after: &FrameRef<'_>) {
    assert_eq!(after.payload().len(), KEY.end);
    assert!(after.payload()[KEY].iter().all(|&byte| byte == 0xFF));
    let known = before.payload().len().min(KEY.start);
    assert_eq!(after.payload()[..known], before.payload()[..known]);
    let entry = ALL.lookup(SETUP_SIGNING).expect("it has one");
    assert_eq!(after.checksum(), after.calculated_checksum(entry.crc_extra));
    let mut twin = before.bytes().to_vec();
    let end = before.header().len() + before.payload().len();
    let key = (before.header().len() + KEY.start).min(end)..end;
    twin[key].iter_mut().for_each(|byte| *byte ^= 0x3C);
    assert_eq!(*tlog::recordable(&twin), *after.bytes(), "it depends on the key");
}
