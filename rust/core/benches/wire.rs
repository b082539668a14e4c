//! The core's cost per frame, beside memcpy of the same bytes and beside a checksum with one table lookup per byte.
//!
//! The corpus is a telemetry mix as an autopilot sends it: [`FRAMES`] frames of 37 bytes in the mean, MAVLink 2, trailing
//! zeros dropped. Times of the first group are for the whole corpus, all others for one frame.

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use mavwire_core::frame::{self, FrameRef, Header, IFLAG_SIGNED};
use mavwire_core::log::tlog::{FoundRecord, RecordScanner, Stamp};
use mavwire_core::registry::Registry;
use mavwire_core::scan::{Found, Resync, Scanner};
use mavwire_core::schema::WireVersion;
use mavwire_core::signing::{SecretKey, SigningState, Verdict};
use mavwire_core::{builtin, codec, text, x25};
use std::hint::black_box;

const FRAMES: usize = 10_000;

/// Message id, payload bytes after zero truncation, share in the mix.
const MIX: [(u32, usize, usize); 12] = [
    (30, 28, 5),  // ATTITUDE
    (33, 28, 5),  // GLOBAL_POSITION_INT
    (74, 20, 4),  // VFR_HUD
    (1, 31, 2),   // SYS_STATUS
    (62, 26, 2),  // NAV_CONTROLLER_OUTPUT
    (36, 21, 2),  // SERVO_OUTPUT_RAW
    (65, 42, 2),  // RC_CHANNELS
    (24, 30, 2),  // GPS_RAW_INT
    (27, 26, 4),  // RAW_IMU
    (2, 11, 2),   // SYSTEM_TIME
    (0, 9, 1),    // HEARTBEAT
    (193, 22, 2), // EKF_STATUS_REPORT
];

fn registry() -> Registry {
    Registry::new(builtin::dialect("ardupilotmega", WireVersion::V2).expect("it is built in"))
}

/// Bytes without pattern, the same on every run.
fn noise(len: usize) -> Vec<u8> {
    let mut state = 0x2545_F491_u32;
    let next = |_| {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        (state >> 11) as u8
    };
    (0..len).map(next).collect()
}

fn header(msgid: u32, seq: u8) -> Header {
    Header::new(WireVersion::V2, seq, 1, 1, msgid)
}

fn corpus(registry: &Registry) -> Vec<Vec<u8>> {
    let kinds: Vec<(u32, usize)> =
        MIX.iter().flat_map(|&(msgid, len, share)| vec![(msgid, len); share]).collect();
    let dice = noise(3 * FRAMES);
    let frame = |n: usize| {
        let (msgid, len) = kinds[usize::from(dice[3 * n]) * kinds.len() / 256];
        let start = usize::from(dice[3 * n + 1]) << 4;
        let mut payload = dice[start..start + len].to_vec();
        payload[len - 1] |= 1;
        let entry = registry.lookup(msgid).expect("it is in the dialect");
        let mut out = Vec::new();
        frame::encode(&mut out, header(msgid, n as u8), &payload, entry.crc_extra)
            .expect("the header is valid");
        out
    };
    (0..FRAMES).map(frame).collect()
}

fn scan_all(bytes: &[u8], policy: Resync, registry: &Registry) -> usize {
    let mut scanner = Scanner::new(policy);
    let (mut at, mut count) = (0, 0);
    while let Found::Frame { len, entry, .. } = scanner.next(&bytes[at..], registry) {
        at += len;
        count += usize::from(entry.is_some());
    }
    assert_eq!(at, bytes.len(), "every byte belongs to a good frame");
    count
}

fn records(log: &[u8], registry: &Registry) -> usize {
    let mut scanner = RecordScanner::default();
    let (mut at, mut count) = (0, 0);
    while let FoundRecord::Record { len, .. } = scanner.next(&log[at..], registry, true) {
        at += len;
        count += 1;
    }
    count
}

fn hop(bytes: &[u8], mut each: impl FnMut(&[u8])) {
    let mut at = 0;
    while let Some(len) = frame::claimed_len(&bytes[at..]) {
        each(&bytes[at..at + len]);
        at += len;
    }
    assert_eq!(at, bytes.len());
}

/// The checksum with the table of one byte, the usual way.
fn bytewise(bytes: &[u8]) -> u16 {
    bytes.iter().fold(x25::INIT, |crc, &byte| x25::push(crc, byte))
}

fn scanning(c: &mut Criterion) {
    let registry = registry();
    let frames = corpus(&registry);
    let bytes = frames.concat();
    let log: Vec<u8> =
        frames.iter().flat_map(|f| [&Stamp::encode(1 << 50, 0)[..], f].concat()).collect();
    let mut group = c.benchmark_group(format!("scan {FRAMES} frames"));
    group.throughput(Throughput::Bytes(bytes.len() as u64));
    let mut target = vec![0; bytes.len()];
    group.bench_function("memcpy", |b| b.iter(|| target.copy_from_slice(black_box(&bytes))));
    group.bench_function("hop by length", |b| b.iter(|| hop(black_box(&bytes), |_| ())));
    group.bench_function("bytewise checksum", |b| {
        b.iter(|| {
            let mut sum = 0;
            hop(black_box(&bytes), |frame| sum ^= bytewise(&frame[1..frame.len() - 2]));
            sum
        });
    });
    for policy in [Resync::Skip, Resync::Rescan] {
        group.bench_function(format!("scan and checksum, {policy:?}"), |b| {
            b.iter(|| assert_eq!(scan_all(black_box(&bytes), policy, &registry), FRAMES));
        });
    }
    group.bench_function("tlog records", |b| {
        b.iter(|| assert_eq!(records(black_box(&log), &registry), FRAMES));
    });
    group.finish();
}

/// Per frame: ATTITUDE, seven fields.
fn one_frame(c: &mut Criterion) {
    let registry = registry();
    let entry = registry.lookup(30).expect("ATTITUDE is in the dialect");
    let message = registry.message(entry.index);
    let payload: Vec<u8> = [0.5_f32, 0.01, -0.02, 1.5, 0.001, -0.003, 0.25]
        .iter()
        .flat_map(|f| f.to_le_bytes())
        .collect();
    let mut group = c.benchmark_group("ATTITUDE");
    group.bench_function("decode numbers", |b| {
        b.iter(|| {
            for field in &message.fields {
                black_box(codec::number(
                    field.field_type,
                    black_box(&payload),
                    field.offset.into(),
                ));
            }
        });
    });
    group.bench_function("encode frame from payload", |b| {
        let mut out = Vec::with_capacity(300);
        b.iter(|| {
            out.clear();
            frame::encode(&mut out, header(30, 1), black_box(&payload), entry.crc_extra)
        });
    });
    let mut out = String::new();
    group.bench_function("str", |b| {
        b.iter(|| {
            out.clear();
            text::write_text(&mut out, message, black_box(&payload));
        });
    });
    group.bench_function("json", |b| {
        b.iter(|| {
            out.clear();
            text::write_json(&mut out, message, black_box(&payload));
        });
    });
    group.finish();
}

fn signing(c: &mut Criterion) {
    let mut state = SigningState::default();
    state.set_key(SecretKey::new(&[7; 32]).ok());
    let mut group = c.benchmark_group("sign");
    let mut frame = Vec::new();
    let signed = Header { incompat_flags: IFLAG_SIGNED, ..header(30, 1) };
    frame::encode(&mut frame, signed, &[5; 28], 39).expect("the header is valid");
    group.bench_function("make a signature", |b| b.iter(|| state.sign(&frame, 1, None)));
    let (_, block) = state.sign(&frame, 1, None).expect("a key is set");
    frame.extend_from_slice(&block);
    let frame = FrameRef::parse(&frame).expect("it is a whole frame");
    group.bench_function("verify", |b| {
        b.iter_batched_ref(
            || {
                let mut fresh = SigningState::default();
                fresh.set_key(SecretKey::new(&[7; 32]).ok());
                fresh
            },
            |fresh| {
                let verdict = fresh.check(black_box(&frame), None);
                assert!(matches!(verdict, Verdict::Good { .. }));
            },
            BatchSize::SmallInput,
        );
    });
    group.finish();
}

criterion_group!(benches, scanning, one_frame, signing);
criterion_main!(benches);
