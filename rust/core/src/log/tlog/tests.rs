//! Clean, cut and damaged logs.

use super::*;
use crate::testing::{HEARTBEAT_V1, HEARTBEAT_V2, encode, header, noise, registry};
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
    let (registry, mut scanner) = (registry(), RecordScanner::new());
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

fn index(bytes: &[u8], check: bool) -> (Vec<RecordEntry>, ChunkIndex) {
    let mut records = Vec::new();
    let index = index_chunk(bytes, 1000, &registry(), check, &mut records);
    (records, index)
}

#[test]
fn a_record_is_stamp_and_frame() {
    let bytes = record(START + 2, &HEARTBEAT_V1);
    match parse_record(&bytes) {
        Parsed::Record { len: 25, stamp, frame } => {
            assert_eq!((stamp.micros(), stamp.link()), (START + 2, 2));
            assert_eq!(frame.bytes(), HEARTBEAT_V1);
        }
        other => panic!("{other:?}"),
    }
    for len in 0..bytes.len() {
        let Parsed::Incomplete { needed } = parse_record(&bytes[..len]) else { panic!("{len}") };
        assert!(needed > len && needed <= bytes.len(), "{len}");
    }
    assert!(matches!(parse_record(&[0; 20]), Parsed::NoRecord));
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
        assert_eq!(index(&bytes[..cut], true).0.len(), whole.len(), "index cut at {cut}");
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

#[test]
fn the_index_hops_as_pymavlink_does() {
    let heartbeat = record(START, &HEARTBEAT_V2);
    let offsets = |bytes: &[u8]| -> Vec<u64> {
        index(bytes, false).0.iter().map(|record| record.offset - 1000).collect()
    };
    let with = |middle: &[u8]| [&heartbeat, middle, &heartbeat].concat();
    assert_eq!(offsets(&with(&heartbeat)), [0, 29, 58]);
    assert_eq!(offsets(&with(&[1, 2, 3])), [0, 32]);
    assert_eq!(offsets(&with(&[0; 20])), [0, 49]);
    let mut damaged = heartbeat.clone();
    damaged[28] ^= 1;
    assert_eq!(offsets(&with(&damaged)), [0, 29, 58]);
    let checked: Vec<bool> =
        index(&with(&damaged), true).0.iter().map(|record| record.checksum_ok).collect();
    assert_eq!(checked, [true, false, true]);
    let mut signed = heartbeat.clone();
    signed[10] = 1;
    signed.extend([0; 13]);
    assert_eq!(offsets(&with(&signed)), [0, 29, 71]);
}

#[test]
fn the_index_names_what_it_found_and_what_was_cut_off() {
    let unknown = record(START, &encode(header(V2, 70_000, 0), &[1]));
    let bytes = [&unknown[..], &record(START, &HEARTBEAT_V2)].concat();
    let (records, whole) = index(&bytes, true);
    assert_eq!(whole, ChunkIndex { consumed: bytes.len(), cut_off: None });
    assert_eq!((records[0].msgid, records[0].entry), (70_000, None));
    assert_eq!((records[1].msgid, records[1].frame_len), (0, 21));
    assert_eq!(records[1].entry, registry().lookup(0));
    for missing in 1..=21 {
        let (records, cut) = index(&bytes[..bytes.len() - missing], true);
        assert_eq!((records.len(), cut.consumed), (1, unknown.len()));
        let offset = cut.cut_off.map(|record| record.offset);
        let header_is_there = missing <= 11;
        assert_eq!(offset, header_is_there.then_some(1000 + unknown.len() as u64), "{missing}");
    }
}

proptest::proptest! {
    #[test]
    fn arbitrary_bytes_never_panic(
        bytes in proptest::collection::vec(
            proptest::prop_oneof![proptest::num::u8::ANY, 0xFCu8..=0xFF, 0u8..3], 0..1500
        ),
        chunk in 1usize..400,
    ) {
        scan(&bytes, chunk);
        let (records, index) = index(&bytes, true);
        proptest::prop_assert!(index.consumed <= bytes.len());
        proptest::prop_assert!(records.len() <= bytes.len() / 16);
    }
}
