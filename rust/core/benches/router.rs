//! The cost of deciding about a frame: no sockets, no scanning, no copies.
//!
//! One iteration routes a thousand frames. Each has its own sequence number, so that duplicate suppression has
//! a new frame to remember each time, as it does on a link.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use mavwire_core::builtin;
use mavwire_core::frame::{self, Header};
use mavwire_core::registry::{Entry, Registry};
use mavwire_core::router::{
    ByteRate, Fate, Filter, Limits, LinkId, LinkOptions, Part, Router, Settings,
};
use mavwire_core::schema::WireVersion;
use std::hint::black_box;

const FRAMES: usize = 1_000;
const ATTITUDE: u32 = 30;
const COMMAND_LONG: u32 = 76;

struct Frame {
    bytes: Vec<u8>,
    header: Header,
    entry: Option<Entry>,
}

/// Frames of `senders` components in turn; every tenth is a command to another one of them.
fn frames(registry: &Registry, senders: usize) -> Vec<Frame> {
    let address = |n: usize| ((n % 250 + 1) as u8, (n / 250 + 1) as u8);
    let make = |n: usize| {
        let (sysid, compid) = address(n % senders);
        let (msgid, payload) = if n % 10 == 9 {
            let mut payload = [1; 33];
            (payload[30], payload[31]) = address((n + 7) % senders);
            (COMMAND_LONG, payload.to_vec())
        } else {
            (ATTITUDE, vec![(n % 251) as u8 + 1; 28])
        };
        let entry = registry.lookup(msgid);
        let header = Header {
            payload_len: payload.len() as u8,
            ..Header::new(WireVersion::V2, (n / senders) as u8, sysid, compid, msgid)
        };
        let mut bytes = Vec::new();
        frame::encode(&mut bytes, header, &payload, entry.map_or(0, |entry| entry.crc_extra))
            .expect("the header is valid");
        Frame { bytes, header, entry }
    };
    (0..FRAMES).map(make).collect()
}

fn routing(c: &mut Criterion) {
    let dialect = builtin::dialect("ardupilotmega", WireVersion::V2).expect("it is built in");
    let registry = Registry::new(dialect);
    let filtered = LinkOptions {
        outbound: Filter::default().block(Part::Messages, [1, 2, 3]),
        limits: Limits { message_rate: Some(1e9), ..Limits::default() },
        ..LinkOptions::default()
    };
    // One that passes a tenth of what comes, and one that passes everything.
    let bytes = |rate| LinkOptions {
        limits: Limits { bytes_per_second: Some(ByteRate::new(rate)), ..Limits::default() },
        ..LinkOptions::default()
    };
    let (thin, wide) = (bytes(400_000.0), bytes(1e9));
    let mut group = c.benchmark_group(format!("route {FRAMES} frames"));
    group.throughput(Throughput::Elements(FRAMES as u64));
    for (name, links, senders, options) in [
        ("10 components, 2 links", 2, 10, LinkOptions::default()),
        ("10 components, 10 links", 10, 10, LinkOptions::default()),
        ("1,000 components, 10 links", 10, 1_000, LinkOptions::default()),
        ("10 components, 10 links with filters and limits", 10, 10, filtered),
        ("200 components, 2 links", 2, 200, LinkOptions::default()),
        ("200 components, 2 links with few bytes", 2, 200, thin),
        ("200 components, 2 links with bytes enough", 2, 200, wide),
    ] {
        let mut frames = frames(&registry, senders);
        let mut router = Router::new(&registry, Settings::new(1));
        for _ in 0..links {
            router.add_link(options.clone());
        }
        let mut now = 0;
        group.bench_function(name, |b| {
            b.iter(|| {
                let mut copies = 0;
                for (n, frame) in frames.iter_mut().enumerate() {
                    // Only the digest looks at the checksum.
                    let end = frame.bytes.len();
                    frame.bytes[end - 1] = frame.bytes[end - 1].wrapping_add(1);
                    now += 10;
                    let Frame { bytes, header, entry } = &*frame;
                    let source = LinkId((n % senders % links) as u8);
                    if let Fate::Forwarded(links) =
                        router.route(black_box(bytes), header, *entry, source, now)
                    {
                        copies += usize::from(!links.is_empty());
                    }
                }
                copies
            });
        });
    }
    group.finish();
}

criterion_group!(benches, routing);
criterion_main!(benches);
