//! The hot paths of the core, one at a time. `hot_paths CASE N` handles about N frames, for counting instructions under
//! callgrind; `hot_paths time` prints nanoseconds per frame of all of them.
//!
//! The frames are ten messages of a copter's telemetry with fixed values, 36 bytes on average.

use mavwire_core::codec::{number, text_bytes};
use mavwire_core::frame::{self, FrameRef, Header, IFLAG_SIGNED};
use mavwire_core::registry::Registry;
use mavwire_core::router::{Fate, LinkId, LinkOptions, Router, Settings};
use mavwire_core::scan::{Found, Resync, Scanner};
use mavwire_core::schema::{Message, WireVersion};
use mavwire_core::signing::{self, SecretKey, SigningState};
use mavwire_core::{builtin, text};
use std::cell::RefCell;
use std::error::Error;
use std::hint::black_box;
use std::io::Write;
use std::time::Instant;

const BLOCK: usize = 1000;
const CASES: [&str; 8] =
    ["scan", "scan-rescan", "route", "decode", "encode", "verify", "text", "json"];
/// Message ids, with how many payload bytes are left after the zeros were cut.
const MIX: [(u32, u8); 10] = [
    (30, 28),
    (33, 28),
    (74, 20),
    (27, 29),
    (24, 31),
    (29, 14),
    (65, 42),
    (36, 21),
    (0, 9),
    (241, 20),
];

/// Frames behind each other, and where each ends.
struct Frames {
    bytes: Vec<u8>,
    ends: Vec<usize>,
}

impl Frames {
    /// A block of frames, signed or not; the first timestamp of the signed ones is 1.
    fn new(registry: &Registry, key: Option<&SecretKey>) -> Result<Self, Box<dyn Error>> {
        let (mut bytes, mut ends) = (Vec::new(), Vec::new());
        for n in 0..BLOCK {
            let (msgid, len) = MIX[n % MIX.len()];
            let entry = registry.lookup(msgid).ok_or("the mix has a message the dialect lacks")?;
            let payload: Vec<u8> = (1..=len).map(|at| at.wrapping_mul(37) | 1).collect();
            let header = Header {
                incompat_flags: if key.is_some() { IFLAG_SIGNED } else { 0 },
                ..Header::new(WireVersion::V2, n as u8, 1, 1, msgid)
            };
            let mut frame = Vec::new();
            frame::encode(&mut frame, header, &payload, entry.crc_extra)?;
            if let Some(key) = key {
                signing::sign(&mut frame, key, 1, 1 + n as u64);
            }
            bytes.extend_from_slice(&frame);
            ends.push(bytes.len());
        }
        Ok(Self { bytes, ends })
    }

    /// The frames one by one.
    fn iter(&self) -> impl Iterator<Item = &[u8]> {
        let starts = std::iter::once(0).chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.bytes[start..end])
    }
}

/// Everything the cases need, made before the clock starts.
struct Bench {
    registry: Registry,
    plain: Frames,
    signed: Frames,
    router: RefCell<Router>,
}

impl Bench {
    fn new() -> Result<Self, Box<dyn Error>> {
        let registry = Registry::new(builtin::dialect("ardupilotmega", WireVersion::V2)?);
        let plain = Frames::new(&registry, None)?;
        let signed = Frames::new(&registry, Some(&key()?))?;
        let mut router = Router::new(&registry, Settings::new(1));
        for _ in 0..3 {
            router.add_link(LinkOptions::default()).ok_or("there is room for three")?;
        }
        Ok(Self { registry, plain, signed, router: RefCell::new(router) })
    }

    /// Handles one block of frames.
    fn block(&self, case: &str) -> Result<(), Box<dyn Error>> {
        match case {
            "scan" => self.scan(Resync::Skip),
            "scan-rescan" => self.scan(Resync::Rescan),
            "route" => self.route(),
            "verify" => self.verify(),
            "decode" | "encode" | "text" | "json" => {
                self.plain.iter().try_for_each(|bytes| self.message(case, bytes))
            }
            _ => Err(format!("there is no case {case}").into()),
        }
    }

    fn scan(&self, policy: Resync) -> Result<(), Box<dyn Error>> {
        let mut scanner = Scanner::new(policy);
        let (mut at, mut count) = (0, 0);
        while let Found::Frame { len, entry: Some(_), .. } =
            scanner.next(black_box(&self.plain.bytes[at..]), &self.registry)
        {
            at += len;
            count += 1;
        }
        if count == BLOCK { Ok(()) } else { Err("not every frame was found".into()) }
    }

    /// Decides about frames between three links, which are new to duplicate suppression each time.
    fn route(&self) -> Result<(), Box<dyn Error>> {
        let mut router = self.router.borrow_mut();
        for (n, bytes) in self.plain.iter().enumerate() {
            let header = Header::parse(black_box(bytes)).ok_or("no frame")?;
            let entry = self.registry.lookup(header.msgid);
            let fate = router.route(bytes, &header, entry, LinkId(0), 1_000_000 * n as u64);
            if !matches!(fate, Fate::Forwarded(links) if links.len() == 2) {
                return Err(format!("{fate:?} is not where it should go").into());
            }
        }
        Ok(())
    }

    fn verify(&self) -> Result<(), Box<dyn Error>> {
        let mut state = SigningState::default();
        state.set_key(Some(key()?));
        for bytes in self.signed.iter() {
            if !state.check(&FrameRef::parse(black_box(bytes))?, None).is_verified() {
                return Err("a signature did not verify".into());
            }
        }
        Ok(())
    }

    fn message(&self, case: &str, bytes: &[u8]) -> Result<(), Box<dyn Error>> {
        let frame = FrameRef::parse(black_box(bytes))?;
        let entry = self.registry.lookup(frame.header().msgid).ok_or("unknown message")?;
        let message = self.registry.message(entry.index);
        match case {
            "decode" => decode(message, frame.payload()),
            "text" | "json" => {
                let write = if case == "text" { text::write_text } else { text::write_json };
                let mut out = String::with_capacity(256); // as the Python methods have it
                write(&mut out, message, frame.payload());
                black_box(out);
            }
            _ => {
                let mut again = Vec::new();
                frame::encode(&mut again, *frame.header(), frame.payload(), entry.crc_extra)?;
                if again != bytes {
                    return Err("encoding gave another frame".into());
                }
            }
        }
        Ok(())
    }
}

/// Reads all fields as message objects and texts read them.
fn decode(message: &Message, payload: &[u8]) {
    for field in &message.fields {
        if field.is_char() {
            black_box(text_bytes(field, payload));
            continue;
        }
        for n in 0..field.elements() {
            let offset = usize::from(field.offset) + n * field.field_type.size();
            black_box(number(field.field_type, payload, offset));
        }
    }
}

fn key() -> Result<SecretKey, Box<dyn Error>> {
    Ok(SecretKey::new(&[7; 32])?)
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let case = args.next().ok_or("usage: hot_paths CASE N | hot_paths time")?;
    let bench = Bench::new()?;
    if case != "time" {
        let frames: usize = args.next().ok_or("how many frames?")?.parse()?;
        return (0..frames / BLOCK).try_for_each(|_| bench.block(&case));
    }
    let mut out = std::io::stdout();
    for case in CASES {
        let mut best = f64::INFINITY;
        for _ in 0..300 {
            let began = Instant::now();
            bench.block(case)?;
            best = best.min(began.elapsed().as_nanos() as f64 / BLOCK as f64);
        }
        writeln!(out, "{case} {best:.1}")?;
    }
    Ok(())
}
