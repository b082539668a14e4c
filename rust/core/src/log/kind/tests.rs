//! A made log of each kind, whole, cut off, and behind damage.

use super::*;
use crate::testing::{HEARTBEAT_V1, encode, header, noise};
use mavwire_schema::WireVersion::{V1, V2};

const TIME: u64 = 1_600_000_000_000_000;

fn frame(version: WireVersion, number: usize) -> Vec<u8> {
    let mut payload = noise(9, number as u32);
    payload.resize(if version == V1 { 9 } else { 1 + number % 9 }, 1);
    encode(header(version, 0, number as u8), &payload)
}

fn raw(version: WireVersion, count: usize) -> Vec<u8> {
    (0..count).flat_map(|number| frame(version, number)).collect()
}

fn tlog(version: WireVersion, count: usize) -> Vec<u8> {
    let record = |number: usize| {
        [&(TIME + 9 * number as u64).to_be_bytes()[..], &frame(version, number)].concat()
    };
    (0..count).flat_map(record).collect()
}

/// A record that describes a type.
fn description(type_id: u8) -> Vec<u8> {
    let mut record = [BINARY, &[type_id, 23, b'A', b'B', b'C', type_id]].concat();
    record.extend(b"QHHHHHH");
    record.resize(FMT_LAYOUT_LEN - 64, 0);
    record.extend(b"TimeUS,B,C,D,E,F,G");
    record.resize(FMT_LAYOUT_LEN, 0);
    record
}

fn records(count: usize) -> Vec<u8> {
    let of = |n: usize| [&HEAD[..], &[b'A' + (n % 3) as u8], &noise(20, n as u32)[..]].concat();
    (0..count).flat_map(of).collect()
}

fn dataflash() -> Vec<u8> {
    let mut log: Vec<u8> = (b'A'..=b'H').flat_map(description).collect();
    log.extend(records(300));
    log
}

fn text() -> Vec<u8> {
    b"FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\nFMT, 1, 9, MSG, Z, Message\n"
        .repeat(20)
}

#[test]
fn whole_logs_are_told_apart() {
    for version in [V1, V2] {
        for count in [1, 2, 3, 300] {
            assert_eq!(identify(&tlog(version, count)), Kind::Tlog, "{version:?} {count}");
            assert_eq!(identify(&raw(version, count)), Kind::Raw, "{version:?} {count}");
        }
    }
    assert_eq!(identify(&dataflash()), Kind::Dataflash);
    assert_eq!(identify(&text()), Kind::DataflashText);
    assert_eq!(identify(&records(300)), Kind::Headerless);
}

#[test]
fn frames_of_other_definitions_are_a_raw_stream() {
    let other = |seq: u8| {
        let mut body = vec![3, seq, 1, 1, 180, seq, 0, 60];
        let checksum = crate::x25::checksum(&[&body[..], &[5]].concat());
        body.extend(checksum.to_le_bytes());
        [&[STX_V1], &body[..]].concat()
    };
    let stream: Vec<u8> = (0..20).flat_map(other).collect();
    assert_eq!(identify(&stream), Kind::Raw);
    assert_eq!(identify(&stream[..4 * 11]), Kind::Raw);
    assert_eq!(identify(&stream[..4 * 11 - 1]), Kind::Unknown);
}

#[test]
fn texts_that_no_reader_takes_are_told_apart() {
    let text = String::from_utf8(text()).expect("a text");
    let utf16: Vec<u16> = format!("\u{feff}{text}").encode_utf16().collect();
    let logs = [
        text.replace('\n', "\r").into_bytes(),
        utf16.iter().flat_map(|unit| unit.to_le_bytes()).collect(),
        utf16.iter().flat_map(|unit| unit.to_be_bytes()).collect(),
    ];
    for log in logs {
        assert_eq!(identify(&log), Kind::OtherText);
    }
    assert_eq!(identify(format!("\u{feff}{text}").as_bytes()), Kind::DataflashText);
}

#[test]
fn damage_in_front_changes_no_kind() {
    let logs = [
        (tlog(V1, 3000), Kind::Tlog),
        (tlog(V2, 3000), Kind::Tlog),
        (raw(V1, 3000), Kind::Raw),
        (raw(V2, 3000), Kind::Raw),
        (dataflash(), Kind::Dataflash),
        (records(3000), Kind::Headerless),
    ];
    for (log, kind) in logs {
        for len in [1, 5, 40, 3000, WINDOW, WINDOW + 70, 2 * WINDOW] {
            assert_eq!(identify(&[&noise(len, 7)[..], &log].concat()), kind, "{len} of noise");
            for filler in [0, 0xFF] {
                let log = [&vec![filler; len][..], &log].concat();
                assert_eq!(identify(&log), kind, "{len} of {filler}");
            }
        }
    }
}

#[test]
fn a_log_that_ends_within_its_first_record_is_no_other_file() {
    let logs = [tlog(V1, 1), tlog(V2, 1), raw(V1, 1), raw(V2, 1), description(b'A')];
    for log in logs {
        for len in 0..log.len() {
            assert_eq!(identify(&log[..len]), Kind::Cut, "{len} of {:X?}", &log[..10]);
        }
    }
    let line = text().iter().position(|&byte| byte == b'\n').unwrap_or_default();
    for len in 0..=line {
        assert_eq!(identify(&text()[..len]), Kind::Cut, "{len} of a text");
    }
    for (log, kind) in [(tlog(V2, 3), Kind::Tlog), (raw(V2, 3), Kind::Raw)] {
        for len in 40..log.len() {
            assert_eq!(identify(&log[..len]), kind, "{len}");
        }
    }
}

#[test]
fn other_files_are_named_unless_a_log_is_in_them() {
    for (magic, kind) in OTHERS {
        assert_eq!(identify(&[magic, &noise(900, 3)].concat()), kind);
        assert_eq!(identify(&[magic, &tlog(V2, 90)].concat()), Kind::Tlog);
    }
    assert_eq!(identify(b"\x1F\x8B\x08\0"), Kind::Gzip);
    assert_eq!(identify(b"\x28\xB5\x2F\xFD"), Kind::Zstd);
    assert_eq!(identify(b"\x51\x2A\x4D\x18"), Kind::Zstd);
    for unknown in [&b"hello\n"[..], b"x", &noise(3000, 9), &[0xFD; 3000], &[0xFE; 3000]] {
        assert_eq!(identify(unknown), Kind::Unknown, "{:X?}", &unknown[..1]);
    }
}

#[test]
fn the_messages_of_the_reader_decide_where_no_others_do() {
    let whole = raw(V1, 90);
    let registry = crate::testing::registry();
    assert_eq!(Verdict::of(&whole).framing(&registry), Framing::Raw);
    assert_eq!(Verdict::of(&noise(3000, 9)).framing(&registry), Framing::Stamped);
    assert_eq!(identify(&HEARTBEAT_V1), Kind::Raw);
}

proptest::proptest! {
    #[test]
    fn noise_is_no_log(noise in proptest::collection::vec(proptest::num::u8::ANY, 20..5000)) {
        proptest::prop_assert!(matches!(identify(&noise), Kind::Unknown | Kind::Cut));
    }
}
