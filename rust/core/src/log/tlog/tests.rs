//! Clean, cut and damaged logs.

use super::*;
use crate::testing::{HEARTBEAT_V1, encode, header, noise, registry};
use mavwire_schema::WireVersion::V2;

const START: u64 = 1_600_000_000_000_000;

fn record(stamp: u64, frame: &[u8]) -> Vec<u8> {
    [&stamp.to_be_bytes()[..], frame].concat()
}

/// `count` records whose stamps hold STX bytes now and then.
fn log(count: u64) -> Vec<Vec<u8>> {
    (0..count)
        .map(|n| {
            let payload = noise(1 + n as usize % 40, n as u32);
            let ids = [0, 30, 253, 70_000];
            let frame = encode(header(V2, ids[n as usize % 4], n as u8), &payload);
            record(START + n * 0xFD_FE, &frame)
        })
        .collect()
}

/// Records by [`RecordScanner`], fed in chunks, as (stamp, frame).
fn scan(bytes: &[u8], chunk: usize) -> Vec<(u64, Vec<u8>)> {
    let (registry, mut scanner) = (registry(), RecordScanner::default());
    let (mut found, mut start, mut end, mut total) = (Vec::new(), 0, 0, 0);
    loop {
        end = (end + chunk).min(bytes.len());
        let at_end = end == bytes.len();
        loop {
            let unread = &bytes[start..end];
            let len = match scanner.next(unread, &registry, at_end) {
                FoundRecord::Record { len, stamp, .. } => {
                    found.push((stamp.micros(), unread[STAMP_LEN..len].to_vec()));
                    len
                }
                FoundRecord::Junk { len } => len,
                FoundRecord::Incomplete { needed } => {
                    assert!(needed > unread.len());
                    break;
                }
            };
            assert!(len > 0);
            start += len;
            total += len;
        }
        if at_end {
            assert_eq!(total, bytes.len());
            return found;
        }
    }
}

fn expected(records: &[Vec<u8>]) -> Vec<(u64, Vec<u8>)> {
    let stamp = |record: &[u8]| Stamp::parse(record).map_or(0, Stamp::micros);
    records.iter().map(|record| (stamp(record), record[STAMP_LEN..].to_vec())).collect()
}

#[test]
fn a_stamp_is_a_time_and_a_link() {
    let stamp = Stamp::parse(&record(START + 2, &HEARTBEAT_V1)).expect("eight bytes");
    assert_eq!((stamp.micros(), stamp.link()), (START + 2, 2));
    assert!(Stamp::parse(&[0; 7]).is_none());
    assert_eq!(Stamp::encode(START + 3, 1), (START + 1).to_be_bytes());
}

#[test]
fn clean_logs_give_all_records_in_any_chunking() {
    let records = log(300);
    let bytes = records.concat();
    for chunk in [1, 2, 3, 7, 8, 9, 30, 100, 279, 4096, bytes.len()] {
        assert!(scan(&bytes, chunk) == expected(&records), "chunks of {chunk}");
    }
}

#[test]
fn cut_at_every_offset_every_whole_record_is_returned() {
    let records = log(12);
    let bytes = records.concat();
    for cut in 0..bytes.len() {
        let mut end = 0;
        let whole = records.iter().take_while(|record| {
            end += record.len();
            end <= cut
        });
        let whole: Vec<Vec<u8>> = whole.cloned().collect();
        assert!(scan(&bytes[..cut], 64) == expected(&whole), "scan cut at {cut}");
    }
}

#[test]
fn damage_costs_only_the_damaged_records() {
    let records = log(200);
    let mut bytes = Vec::new();
    let mut intact = Vec::new();
    for (n, record) in records.iter().enumerate() {
        match n % 10 {
            3 => bytes.extend(noise(n % 37, n as u32)),
            5 => {
                // A wrong length byte, which would swallow what follows.
                let mut damaged = record.clone();
                damaged[STAMP_LEN + 1] = 255;
                bytes.extend(damaged);
                continue;
            }
            7 => {
                bytes.extend(&record[..record.len() / 2]);
                continue;
            }
            _ => {}
        }
        bytes.extend(record);
        // Behind junk an unknown id needs to have been met; those are not counted on.
        intact.extend((n % 4 != 3).then(|| record.clone()));
    }
    let found = scan(&bytes, 500);
    let lost = expected(&intact).into_iter().filter(|record| !found.contains(record)).count();
    assert_eq!(lost, 0);
}

/// `count` signed records whose signatures are full of false STX.
fn signed_log(count: u64) -> Vec<Vec<u8>> {
    let frame = |n: u64| {
        let mut header = header(V2, [0, 30, 253][n as usize % 3], n as u8);
        header.incompat_flags = 1;
        let mut frame = encode(header, &noise(1 + n as usize % 40, n as u32));
        frame.extend(noise(13, n as u32).iter().map(|byte| byte | 0xFC));
        frame
    };
    (0..count).map(|n| record(START + n * 0xFD_FE, &frame(n))).collect()
}

#[test]
fn signed_records_are_found_in_any_chunking_and_cut_anywhere() {
    let records = signed_log(12);
    let bytes = records.concat();
    for cut in 0..=bytes.len() {
        let mut end = 0;
        let whole = records.iter().take_while(|record| {
            end += record.len();
            end <= cut
        });
        let whole: Vec<Vec<u8>> = whole.cloned().collect();
        for chunk in [1, 9, 64, 4096] {
            assert!(scan(&bytes[..cut], chunk) == expected(&whole), "cut at {cut} by {chunk}");
        }
    }
}

/// The bytes that are missing are those of the next time stamp: the signed record is whole.
#[test]
fn lost_bytes_of_a_time_stamp_cost_no_signed_record() {
    let records = signed_log(9);
    for lost in 1..=8 {
        for from in 0..=8 - lost {
            let mut damaged = records.clone();
            drop(damaged[5].drain(from..from + lost));
            let found = scan(&damaged.concat(), 4096);
            let mut intact = records.clone();
            drop(intact.remove(5));
            assert!(found == expected(&intact), "{lost} lost from {from}");
        }
    }
}

/// How often each byte goes through a checksum.
fn work_per_byte(bytes: &[u8]) -> f64 {
    let (mut scanner, registry, mut at) = (RecordScanner::default(), registry(), 0);
    loop {
        match scanner.next(&bytes[at..], &registry, true) {
            FoundRecord::Record { len, .. } | FoundRecord::Junk { len } => at += len,
            FoundRecord::Incomplete { .. } => return scanner.work() as f64 / bytes.len() as f64,
        }
    }
}

/// Signatures that look like many frames, each in front of a record of an unknown id, which is no evidence for them; and
/// records in whose place something claims to be a long frame.
#[test]
fn false_frames_behind_signed_ones_cost_linear_work() {
    let (mut within, mut behind) = (Vec::new(), Vec::new());
    for (signed, n) in signed_log(2000).iter().zip(0..) {
        within.extend_from_slice(&signed[..signed.len() - 13]);
        // Some may begin a HEARTBEAT of version 1 that is all there: its id is the first byte of the next time stamp.
        within.extend_from_slice(&[0xFE; 13]);
        within.extend(record(START, &encode(header(V2, 70_000, n as u8), &[n as u8; 9])));
        behind.extend_from_slice(signed);
        behind.extend(record(START, &[0xFE, 0xFF, 0, 1, 1, 0]));
    }
    for bytes in [within, behind] {
        let found = scan(&bytes, 4096);
        assert!(found.len() >= 1999, "{}", found.len());
        let per_byte = work_per_byte(&bytes);
        assert!(per_byte <= 3.0, "{per_byte} per byte");
    }
}

proptest::proptest! {
    #[test]
    fn chunks_change_nothing_about_signed_logs(
        cuts in proptest::collection::vec((0usize..3000, 1usize..14, proptest::num::u8::ANY), 0..8),
        chunk in 1usize..600,
    ) {
        let mut bytes = signed_log(40).concat();
        for (at, lost, byte) in cuts {
            let at = at % bytes.len();
            match byte % 3 {
                0 => bytes[at] = byte,
                1 => drop(bytes.drain(at..(at + lost).min(bytes.len()))),
                _ => bytes.insert(at, byte),
            }
        }
        proptest::prop_assert!(scan(&bytes, chunk) == scan(&bytes, bytes.len()));
    }

    #[test]
    fn arbitrary_bytes_never_panic(
        bytes in proptest::collection::vec(
            proptest::prop_oneof![proptest::num::u8::ANY, 0xFCu8..=0xFF, 0u8..3], 0..1500
        ),
        chunk in 1usize..400,
    ) {
        scan(&bytes, chunk);
    }
}
