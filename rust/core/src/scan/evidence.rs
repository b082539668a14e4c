//! Re-scanning and frames whose checksum proves nothing: the dialect does not define their id, or another definition
//! made their checksum.
//!
//! A checksum is right for one `crc_extra`, or for none. A damaged frame's is right for a certain one in 1 of 65,536 cases.
//! So frames that agree on one `crc_extra` are evidence for its definition, and are believed when there are enough:
//!
//! | the frame | how many must agree, without another in between |
//! |---|---|
//! | a layout of a dialect that was merged into this one, as its user asked | 1 |
//! | an id that the dialect lacks, directly behind a good frame or at the start, with a sane header | 1 |
//! | such an id anywhere else: inside or behind junk, flags that nobody defined, system 0 | 2 of its id and sender |
//! | another layout that the dialect knows beside the id's own ([`Registry::other`](crate::registry::Registry::other)) | 2 of its sender |
//! | an id that the dialect defines, with a `crc_extra` that it does not know | 4 of its id and sender |
//!
//! The same bytes again are no new evidence. A definition that was believed stays believed until frames agree on another one:
//! forged frames cannot shut out genuine ones. All of it depends on the bytes alone and not on how they arrive.

use std::collections::BTreeMap;

use mavwire_schema::WireVersion;

use crate::frame::Header;
use crate::registry::Entry;

/// Ids with senders that are remembered.
const MOST: usize = 4096;
/// In place of an id: the layouts that the dialect knows, of all ids of a sender.
const LAYOUTS: u32 = 1 << 24;

/// The kind of message that a frame is if its checksum is right.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Claim {
    /// A message of an id that is not defined.
    UnknownId,
    /// A message by a layout that the dialect has beside the id's own.
    KnownLayout,
    /// A message of a defined id, by a definition that nobody knows.
    OtherDefinition,
}

/// The `crc_extra` on which the frames of an id and sender agree.
#[derive(Debug, Clone, Copy, Default)]
struct Sighting {
    believed: Option<u8>,
    /// The `crc_extra` and the checksum of the last frame, and how many agree.
    extra: u8,
    checksum: u16,
    agreeing: u8,
}

/// The frames met lately. Message id and sender make the key.
#[derive(Debug, Clone, Default)]
pub(super) struct Evidence {
    met: BTreeMap<(u32, u8, u8), Sighting>,
}

impl Evidence {
    /// Whether a frame is what it claims. `extra` is the `crc_extra` that its `checksum` implies.
    pub(super) fn believe(
        &mut self,
        header: &Header,
        claim: Claim,
        extra: Option<u8>,
        checksum: u16,
        in_sync: bool,
    ) -> bool {
        let Header { msgid, compat_flags, sysid, compid, .. } = *header;
        let is_sane = in_sync && compat_flags == 0 && sysid != 0;
        let (id, enough) = match claim {
            Claim::UnknownId => (msgid, if is_sane { 1 } else { 2 }),
            Claim::KnownLayout => (LAYOUTS, 2),
            Claim::OtherDefinition => {
                self.contradict((LAYOUTS, sysid, compid));
                (msgid, 4)
            }
        };
        let key = (id, sysid, compid);
        let Some(extra) = extra else {
            self.contradict(key);
            return false;
        };
        self.make_room();
        let met = self.met.entry(key).or_default();
        let extra = if id == LAYOUTS { 0 } else { extra };
        if met.believed == Some(extra) {
            return true;
        }
        let is_new = met.agreeing == 0 || met.checksum != checksum;
        let agreeing = if met.extra == extra { met.agreeing } else { 0 } + u8::from(is_new);
        *met = Sighting { extra, checksum, agreeing, ..*met };
        if agreeing >= enough {
            *met = Sighting { believed: Some(extra), agreeing: 0, ..*met };
        }
        agreeing >= enough
    }

    /// A frame that agrees with no other came in between.
    fn contradict(&mut self, key: (u32, u8, u8)) {
        if let Some(met) = self.met.get_mut(&key) {
            met.agreeing = 0;
        }
    }

    /// Junk and forged frames leave many keys. Those that are believed stay if they are not most of them.
    fn make_room(&mut self) {
        if self.met.len() >= MOST {
            self.met.retain(|_, met| met.believed.is_some());
            if self.met.len() > MOST / 2 {
                self.met.clear();
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
    use crate::scan::{Found, Resync, Scanner, Window};
    use crate::testing::{encode, header, message, noise, registry};
    use crate::x25;
    use mavwire_schema::{Dialect, FieldType};

    /// A frame of a sender with the checksum of another definition.
    fn foreign(msgid: u32, sender: u8, number: u8, crc_extra: u8) -> Vec<u8> {
        let header = Header { sysid: sender, ..header(WireVersion::V2, msgid, number) };
        let mut frame = encode(header, &noise(28, number.into()));
        let body_end = frame.len() - 2;
        let checksum = x25::push(x25::checksum(&frame[1..body_end]), crc_extra);
        frame[body_end..].copy_from_slice(&checksum.to_le_bytes());
        frame
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

    /// The test registry with a former layout of ATTITUDE.
    fn with_former_layout() -> Registry {
        let fields: Vec<_> = (0..7).map(|_| ("a", FieldType::U32, 0)).collect();
        let mut dialect: Dialect = registry().dialect().clone();
        dialect.others = vec![message(30, "OLD_ATTITUDE", 77, &fields, &[])];
        Registry::new(dialect)
    }

    #[test]
    fn frames_that_agree_on_another_crc_extra_are_frames() {
        let bytes = (0..20).flat_map(|number| foreign(30, 1, number, 77)).collect::<Vec<_>>();
        assert_eq!(bytes[0], STX_V2);
        let (found, bad) = scan(&bytes, &registry());
        assert_eq!(found, vec![None; 17]);
        assert_eq!(bad, 3 * bytes.len() / 20);
    }

    #[test]
    fn every_sender_of_a_swarm_counts_by_itself() {
        let frames = (0..20).flat_map(|number| (1..=250).map(move |sender| (sender, number)));
        let bytes: Vec<_> =
            frames.flat_map(|(sender, number)| foreign(30, sender, number, 77)).collect();
        assert_eq!(scan(&bytes, &registry()).0.len(), 17 * 250);
    }

    #[test]
    fn a_sender_with_two_frames_of_known_layouts_has_these_definitions() {
        let bytes = (0..5).flat_map(|number| foreign(30, 1, number, 77)).collect::<Vec<_>>();
        let registry = with_former_layout();
        let (found, bad) = scan(&bytes, &registry);
        let entries = found.iter().flatten();
        let names: Vec<_> = entries.map(|entry| &*registry.message(entry.index).name).collect();
        assert_eq!((names, bad), (vec!["OLD_ATTITUDE"; 4], bytes.len() / 5));
        assert_eq!(registry.lookup(30).map(|entry| entry.crc_extra), Some(39));
    }

    #[test]
    fn the_same_frame_again_is_no_evidence() {
        let bytes = foreign(30, 1, 0, 77).repeat(20);
        assert_eq!(scan(&bytes, &registry()), (vec![], bytes.len()));
        assert_eq!(scan(&bytes, &with_former_layout()), (vec![], bytes.len()));
    }

    #[test]
    fn a_million_damaged_frames_make_no_other_definition() {
        let registry = with_former_layout();
        let mut scanner = Scanner::new(Resync::Rescan);
        let mut damaged = encode(header(WireVersion::V2, 30, 0), &[1; 8]);
        let end = damaged.len() - 8;
        let mut random = 0x2545_F491_4F6C_DD1D_u64;
        let mut others = 0;
        for _ in 0..1_000_000 {
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            damaged[end..].copy_from_slice(&random.to_le_bytes());
            scanner.pass_good(0);
            if let Found::Frame { entry, .. } = scanner.next_at_end(&damaged, &registry) {
                others += u32::from(entry != registry.lookup(30));
            }
            scanner.window = Window::default();
        }
        assert_eq!(others, 0);
    }

    #[test]
    fn a_definition_is_believed_until_frames_agree_on_another() {
        let mut evidence = Evidence::default();
        let header = header(WireVersion::V2, 30, 0);
        let mut ask = |extra, checksum| {
            evidence.believe(&header, Claim::OtherDefinition, extra, checksum, true)
        };
        assert_eq!([1, 2, 3, 4, 5].map(|n| ask(Some(7), n)), [false, false, false, true, true]);
        assert!(!ask(None, 6) && ask(Some(7), 7) && !ask(Some(8), 8) && ask(Some(7), 9));
        assert_eq!([1, 2, 3, 4].map(|n| ask(Some(8), n)), [false, false, true, true]);
        assert!(!ask(Some(7), 10));
    }

    #[test]
    fn memory_is_bounded_and_what_is_believed_stays() {
        let mut evidence = Evidence::default();
        let ask = |evidence: &mut Evidence, msgid, checksum| {
            let header = header(WireVersion::V2, msgid, 0);
            evidence.believe(&header, Claim::OtherDefinition, Some(7), checksum, true)
        };
        assert!((0..4).any(|n| ask(&mut evidence, 30, n)));
        for msgid in 1000..100_000 {
            assert!(!ask(&mut evidence, msgid, 0));
            assert!(evidence.met.len() <= MOST);
        }
        assert!(ask(&mut evidence, 30, 9));
    }
}
