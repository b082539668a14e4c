//! Re-scanning and frames of other definitions: the id is known, and the checksum is right for another `crc_extra`.
//!
//! * A layout that the dialect knows beside its own ([`Registry::other`]) makes a frame one of that message, if the payload
//!   fits the layout.
//! * Otherwise damage explains a wrong checksum better. One damaged frame in 256 implies some `crc_extra`, but the next
//!   one implies the same in one of 65,536 cases. So frames of one id and sender are believed when [`ENOUGH`] of them in
//!   a row imply one `crc_extra`. The same bytes again are no new evidence. A frame that implies another one, or none,
//!   takes evidence away.

use mavwire_schema::WireVersion;

use crate::frame::Header;
use crate::registry::Entry;

const SLOTS: usize = 64;
/// Frames that have to agree. The test of a million damaged frames finds no false verdict.
const ENOUGH: u8 = 4;
/// The most evidence that is kept. More would delay the end of a definition that is no longer used.
const TRUST: u8 = 8;

/// Frames of one id and sender whose checksum is wrong for the dialect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Sighting {
    key: (u32, u8, u8),
    extra: u8,
    checksum: u16,
    agreeing: u8,
}

/// The ids and senders met lately.
#[derive(Debug, Clone)]
pub(super) struct OtherDefinitions {
    /// At a slot that follows from id and sender; a newer one displaces an older one.
    met: [Option<Sighting>; SLOTS],
}

impl Default for OtherDefinitions {
    fn default() -> Self {
        Self { met: [None; SLOTS] }
    }
}

impl OtherDefinitions {
    /// Whether a frame with a wrong checksum is one of another definition. `extra` is the `crc_extra` that its `checksum`
    /// implies.
    pub(super) fn believe(&mut self, header: &Header, extra: Option<u8>, checksum: u16) -> bool {
        let Header { msgid, sysid, compid, .. } = *header;
        let key = (msgid, sysid, compid);
        let place = msgid ^ u32::from(sysid) << 3 ^ u32::from(compid);
        let slot = &mut self.met[place as usize % SLOTS];
        let met = slot.filter(|met| met.key == key);
        match (met, extra) {
            (Some(met), Some(extra)) if met.extra == extra => {
                let is_new = met.checksum != checksum;
                let agreeing = (met.agreeing + u8::from(is_new)).min(TRUST);
                *slot = Some(Sighting { checksum, agreeing, ..met });
                agreeing >= ENOUGH
            }
            (Some(met), _) if met.agreeing > 1 => {
                *slot = Some(Sighting { agreeing: met.agreeing - 1, ..met });
                false
            }
            (_, extra) => {
                *slot = extra.map(|extra| Sighting { key, extra, checksum, agreeing: 1 });
                false
            }
        }
    }
}

/// Whether a frame's payload can be one of a layout.
pub(super) fn fits(header: &Header, entry: Entry) -> bool {
    match header.version {
        WireVersion::V1 => header.payload_len == entry.min_len,
        WireVersion::V2 => header.payload_len <= entry.max_len,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::STX_V2;
    use crate::registry::Registry;
    use crate::scan::{Found, Resync, Scanner};
    use crate::testing::{encode, header, message, noise, registry};
    use crate::x25;
    use mavwire_schema::{Dialect, FieldType};

    /// ATTITUDE frames with the checksum of another definition.
    fn foreign(crc_extra: u8, count: u8) -> Vec<u8> {
        let frame = |number: u8| {
            let mut frame = encode(header(WireVersion::V2, 30, number), &noise(28, number.into()));
            let body_end = frame.len() - 2;
            let checksum = x25::push(x25::checksum(&frame[1..body_end]), crc_extra);
            frame[body_end..].copy_from_slice(&checksum.to_le_bytes());
            frame
        };
        (0..count).flat_map(frame).collect()
    }

    /// The definitions of the frames found, and the bytes that belong to none.
    fn scan(bytes: &[u8], registry: &Registry) -> (Vec<Option<Entry>>, usize) {
        let (mut scanner, mut at, mut bad) = (Scanner::new(Resync::Rescan), 0, 0);
        let mut found = Vec::new();
        while at < bytes.len() {
            match scanner.next_at_end(&bytes[at..], registry) {
                Found::Frame { len, entry, .. } => {
                    found.push(entry);
                    at += len;
                }
                Found::Noise { len } | Found::Rejected { len, .. } => {
                    bad += len;
                    at += len;
                }
                Found::Incomplete { .. } => unreachable!("the end is known"),
            }
        }
        (found, bad)
    }

    #[test]
    fn frames_that_agree_on_another_crc_extra_are_frames() {
        let bytes = foreign(77, 20);
        assert_eq!(bytes[0], STX_V2);
        let (found, bad) = scan(&bytes, &registry());
        assert_eq!(found, vec![None; 17]);
        assert_eq!(bad, 3 * bytes.len() / 20);
    }

    #[test]
    fn a_layout_that_is_known_makes_the_first_frame_a_message() {
        let fields: Vec<_> = (0..7).map(|_| ("a", FieldType::U32, 0)).collect();
        let mut dialect: Dialect = registry().dialect().clone();
        dialect.others = vec![message(30, "OLD_ATTITUDE", 77, &fields, &[])];
        let registry = Registry::new(dialect);
        let (found, bad) = scan(&foreign(77, 5), &registry);
        let names: Vec<_> = found
            .iter()
            .flatten()
            .map(|entry| registry.message(entry.index).name.as_str())
            .collect();
        assert_eq!((names, bad), (vec!["OLD_ATTITUDE"; 5], 0));
        assert_eq!(registry.lookup(30).map(|entry| entry.crc_extra), Some(39));
    }

    #[test]
    fn the_same_frame_again_is_no_evidence() {
        let bytes = foreign(77, 1).repeat(20);
        assert_eq!(scan(&bytes, &registry()), (vec![], bytes.len()));
    }

    #[test]
    fn a_million_damaged_frames_make_no_other_definition() {
        let mut others = OtherDefinitions::default();
        let mut random = 0x2545_F491_4F6C_DD1D_u64;
        let mut verdicts = 0;
        for number in 0..1_000_000_u32 {
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            let header = header(WireVersion::V2, 30 + number % 3, 0);
            let register = random as u16;
            let extra = x25::implied_extra(register, (random >> 16) as u16);
            verdicts += u32::from(others.believe(&header, extra, (random >> 16) as u16));
        }
        assert_eq!(verdicts, 0);
    }

    #[test]
    fn damage_takes_evidence_away_slowly() {
        let mut others = OtherDefinitions::default();
        let header = header(WireVersion::V2, 30, 0);
        let mut ask = |extra, checksum| others.believe(&header, extra, checksum);
        assert_eq!([1, 2, 3, 4, 5].map(|n| ask(Some(7), n)), [false, false, false, true, true]);
        assert!(!ask(None, 6) && ask(Some(7), 7) && !ask(Some(8), 8) && ask(Some(7), 9));
    }
}
