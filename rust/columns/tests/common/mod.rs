//! Logs made up for tests.

use std::sync::Arc;

use mavwire_core::builtin;
use mavwire_core::frame::{self, Header, SIGNATURE_LEN};
use mavwire_core::registry::Registry;
use mavwire_schema::WireVersion;

/// The dialect of the tests.
pub(crate) fn registry() -> Arc<Registry> {
    Arc::new(Registry::new(builtin::dialect("common", WireVersion::V2).expect("the dialect")))
}

/// Numbers that look random and are the same each time.
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    /// The next number below `end`.
    pub(crate) fn below(&mut self, end: u64) -> u64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % end
    }

    /// So many bytes.
    pub(crate) fn bytes(&mut self, count: usize) -> Vec<u8> {
        (0..count).map(|_| self.below(256) as u8).collect()
    }
}

/// A frame of HEARTBEAT, ATTITUDE, STATUSTEXT or an id that nobody has, perhaps signed.
pub(crate) fn frame_of(registry: &Registry, noise: &mut Noise, seq: u8) -> Vec<u8> {
    let msgid = [0, 30, 253, 0xABCD][noise.below(4) as usize];
    let version =
        if msgid < 256 && noise.below(4) == 0 { WireVersion::V1 } else { WireVersion::V2 };
    let signed = version == WireVersion::V2 && noise.below(3) == 0;
    let header = Header {
        version,
        payload_len: 0,
        incompat_flags: signed.into(),
        compat_flags: 0,
        seq,
        sysid: 1 + noise.below(3) as u8,
        compid: 1,
        msgid,
    };
    let entry = registry.lookup(msgid);
    let payload = noise.bytes(entry.map_or(9, |entry| entry.max_len.into()));
    let mut out = Vec::new();
    let payload = if version == WireVersion::V1 {
        &payload[..entry.map_or(9, |entry| entry.min_len.into())]
    } else {
        &payload[..]
    };
    frame::encode(&mut out, header, payload, entry.map_or(77, |e| e.crc_extra)).expect("a frame");
    if signed {
        out.extend(noise.bytes(SIGNATURE_LEN));
    }
    out
}

/// A log of so many records; `lead` is 8 for time stamps and 0 for none.
pub(crate) fn log(registry: &Registry, seed: u64, records: usize, lead: usize) -> Vec<u8> {
    let mut noise = Noise(seed);
    let mut log = Vec::new();
    for n in 0..records {
        let stamp = 1_600_000_000_000_000 + 0xFD_FE * n as u64;
        log.extend_from_slice(&stamp.to_be_bytes()[..lead]);
        log.extend(frame_of(registry, &mut noise, n as u8));
    }
    log
}

/// Damages a log in so many places: bytes changed, lost, repeated, or replaced by false starts of frames.
pub(crate) fn damage(log: &mut Vec<u8>, seed: u64, places: usize) {
    let mut noise = Noise(seed);
    for _ in 0..places {
        if log.is_empty() {
            return;
        }
        let at = noise.below(log.len() as u64) as usize;
        let end = (at + 1 + noise.below(40) as usize).min(log.len());
        match noise.below(4) {
            0 => log[at] ^= 1 << noise.below(8),
            1 => drop(log.drain(at..end)),
            2 => drop(log.splice(at..at, noise.bytes(30))),
            _ => log[at..end].fill([0xFD, 0xFE][noise.below(2) as usize]),
        }
    }
}
