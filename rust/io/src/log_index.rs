//! Where the messages of each type stand in a log: pymavlink's index, which hops from record to record by their lengths
//! and checks no checksums. Under `Rescan` it holds the good records, and all of them.

use std::collections::{HashSet, TryReserveError};
use std::io;
use std::sync::Arc;

use crate::records::RecordFinder;
use crate::window::FileWindow;
use mavwire_core::codec::read;
use mavwire_core::frame::{
    CHECKSUM_LEN, HEADER_LEN_V1, HEADER_LEN_V2, Header, IFLAG_SIGNED, SIGNATURE_LEN, STX_V1, STX_V2,
};
use mavwire_core::log::tlog::{FoundRecord, STAMP_LEN};
use mavwire_core::registry::Registry;
use mavwire_core::scan::distance_to_stx;
use mavwire_core::schema::Message as Definition;
use mavwire_core::text::write_bytes_text;

/// Longest time stamp and header.
const LOOK: usize = STAMP_LEN + HEADER_LEN_V2;

/// A record that the index found.
pub struct Indexed {
    /// Where the record begins.
    pub offset: u64,
    /// Where the next record is looked for.
    pub next: u64,
    /// The header of its frame.
    pub header: Header,
    /// Where the payload begins.
    pub payload: u64,
}

/// The record at or behind `offset`, or `None` at the end of the log.
///
/// # Errors
/// Those of reading the log.
pub fn find_record(
    window: &mut FileWindow,
    mut offset: u64,
    size: u64,
) -> io::Result<Option<Indexed>> {
    while offset + ((STAMP_LEN + HEADER_LEN_V1) as u64) < size {
        let bytes = window.at(offset, LOOK)?;
        let Some(rest) = bytes.get(STAMP_LEN..) else { return Ok(None) };
        let junk = distance_to_stx(rest);
        if junk > 0 {
            offset += junk as u64;
            continue;
        }
        let Some(header) = Header::parse(rest) else { return Ok(None) };
        let start = offset + STAMP_LEN as u64;
        return Ok(Some(Indexed {
            offset,
            next: start + header.frame_len() as u64,
            header,
            payload: start + header.len() as u64,
        }));
    }
    Ok(None)
}

/// The first good record at or behind `offset`, or `None` at the end of the log.
fn find_good(
    finder: &mut RecordFinder,
    window: &mut FileWindow,
    mut offset: u64,
    registry: &Registry,
) -> io::Result<Option<Indexed>> {
    loop {
        match finder.look(window, offset, registry)? {
            FoundRecord::Junk { len } => offset += len as u64,
            FoundRecord::Incomplete { .. } => return Ok(None),
            FoundRecord::Record { len, header, .. } => {
                let payload = offset + (STAMP_LEN + header.len()) as u64;
                return Ok(Some(Indexed { offset, next: offset + len as u64, header, payload }));
            }
        }
    }
}

/// Where a payload says which instance it is about.
#[derive(Clone, Copy)]
struct InstancePlace {
    offset: u8,
    /// Bytes of a text; 0 for a number, of which the index reads the lowest byte.
    text_len: u8,
}

impl InstancePlace {
    fn of(definition: &Definition) -> Option<Self> {
        let field = &definition.fields[usize::from(definition.instance_field?)];
        Some(Self { offset: field.offset, text_len: field.array_length })
    }

    /// The lowest byte of a number.
    fn byte(self, payload: &[u8]) -> u8 {
        read::<1>(payload, usize::from(self.offset))[0]
    }

    /// The instance's text between the brackets in `messages["TYPE[instance]"]`, as pymavlink's index reads it from the
    /// raw bytes: text up to the first NUL, of anything else the lowest byte, signed.
    fn text(self, payload: &[u8]) -> String {
        if self.text_len == 0 {
            return self.byte(payload).cast_signed().to_string();
        }
        let offset = usize::from(self.offset);
        let end = (offset + usize::from(self.text_len)).min(payload.len());
        let mut text = String::new();
        write_bytes_text(&mut text, payload.get(offset..end).unwrap_or_default());
        text
    }
}

/// Why [`LogIndex::extend`] stopped.
pub enum Stop {
    /// The log is at its end; the last record ends here.
    End {
        /// The end of the last record.
        next: u64,
    },
    /// So far nothing to note; go on here.
    Limit {
        /// Where to go on.
        next: u64,
    },
    /// The first record of a type, which is not added yet.
    FirstOfType {
        /// Index of the message type.
        index: u16,
        /// The record.
        record: Indexed,
    },
    /// A record of an instance that was not seen before.
    NewInstance {
        /// Index of the message type.
        index: u16,
        /// The instance as text.
        instance: String,
        /// Where to go on.
        next: u64,
    },
}

/// A record of the index, in half the memory that its offset would take: most of the time of building an index goes
/// into memory that nobody has touched before.
#[derive(Clone, Copy)]
struct Step {
    /// Index of the message; `NO_MESSAGE` for a piece of a gap that is longer than a step.
    index: u16,
    /// Bytes between the beginnings of this record and of the one before it.
    gap: u16,
}

/// No dialect has so many messages.
const NO_MESSAGE: u16 = u16::MAX;
const LONGEST_STEP: u64 = u16::MAX as u64;
/// Bytes of the shortest record: a time stamp and a frame of version 1 without payload.
const SHORTEST: usize = STAMP_LEN + HEADER_LEN_V1 + CHECKSUM_LEN;

/// The index's facts about a message.
#[derive(Clone, Copy)]
struct Kind {
    /// Its records.
    count: usize,
    instance: Option<InstancePlace>,
}

impl Kind {
    fn of(definition: &Definition) -> Self {
        Self { count: 0, instance: InstancePlace::of(definition) }
    }
}

/// The records by message index, in the order of the log. It keeps the registry that it was built with, because the
/// dialect of a link can change while the index stays.
pub struct LogIndex {
    /// The definitions that the index was built with.
    pub registry: Arc<Registry>,
    steps: Vec<Step>,
    /// Where the record of the last step begins.
    last: u64,
    /// By message index.
    kinds: Vec<Kind>,
    /// Instances already shown to Python, until the table they were put into may be another one.
    seen: HashSet<(u16, String)>,
    /// Those of numbers by their bytes, by message index.
    seen_bytes: Vec<Option<Box<[bool; 256]>>>,
    /// Message indices in the order in which they first appear.
    order: Vec<u16>,
}

impl LogIndex {
    /// An empty index.
    pub fn new(registry: Arc<Registry>) -> Self {
        let messages = &registry.dialect().messages;
        Self {
            steps: Vec::new(),
            last: 0,
            kinds: messages.iter().map(Kind::of).collect(),
            seen: HashSet::new(),
            seen_bytes: vec![None; messages.len()],
            order: Vec::new(),
            registry,
        }
    }

    /// `(message id, name, records)` of each type, in the order in which they first appear.
    pub fn counts(&self) -> Vec<(u32, String, usize)> {
        let row = |&index: &u16| {
            let message = self.registry.message(index);
            (message.id, message.name.clone(), self.kinds[usize::from(index)].count)
        };
        self.order.iter().map(row).collect()
    }

    /// `(message id, offsets of its records)` of each type, in the order in which they first appear.
    ///
    /// # Errors
    /// There is no memory for them.
    pub fn by_type(&self) -> Result<Vec<(u32, Vec<u64>)>, TryReserveError> {
        let mut by_index = vec![Vec::new(); self.kinds.len()];
        for (offsets, kind) in by_index.iter_mut().zip(&self.kinds) {
            offsets.try_reserve_exact(kind.count)?;
        }
        for (index, offset) in self.records() {
            by_index[usize::from(index)].push(offset);
        }
        let row = |&index: &u16| {
            (self.registry.message(index).id, std::mem::take(&mut by_index[usize::from(index)]))
        };
        Ok(self.order.iter().map(row).collect())
    }

    /// Message ids of the names that are in the index, each once, and the offsets of all their records, ascending.
    ///
    /// # Errors
    /// There is no memory for them.
    pub fn select(&self, names: &[String]) -> Result<(Vec<u32>, Vec<u64>), TryReserveError> {
        let mut chosen: Vec<u16> = Vec::new();
        for name in names {
            let matches = |&&index: &&u16| self.registry.message(index).name == *name;
            if let Some(&index) = self.order.iter().find(matches)
                && !chosen.contains(&index)
            {
                chosen.push(index);
            }
        }
        let ids = chosen.iter().map(|&index| self.registry.message(index).id).collect();
        let (mut is_chosen, mut count) = (vec![false; self.kinds.len()], 0);
        for index in chosen.into_iter().map(usize::from) {
            is_chosen[index] = true;
            count += self.kinds[index].count;
        }
        let mut offsets = Vec::new();
        offsets.try_reserve_exact(count)?;
        let wanted = self.records().filter(|&(index, _)| is_chosen[usize::from(index)]);
        offsets.extend(wanted.map(|(_, offset)| offset));
        Ok((ids, offsets))
    }

    /// Message index and offset of each record.
    fn records(&self) -> impl Iterator<Item = (u16, u64)> + '_ {
        let located = self.steps.iter().scan(0, |offset, step| {
            *offset += u64::from(step.gap);
            Some((step.index, *offset))
        });
        located.filter(|&(index, _)| index != NO_MESSAGE)
    }

    /// Whether the index has a record of this type.
    pub fn knows(&self, index: u16) -> bool {
        self.kinds[usize::from(index)].count > 0
    }

    /// Adds a record behind all that are there.
    ///
    /// # Errors
    /// `OutOfMemory`
    pub fn add(&mut self, index: u16, offset: u64) -> io::Result<()> {
        let mut gap = offset.saturating_sub(self.last);
        while gap > LONGEST_STEP {
            self.steps.try_reserve(1)?;
            self.steps.push(Step { index: NO_MESSAGE, gap: u16::MAX });
            gap -= LONGEST_STEP;
            self.last += LONGEST_STEP;
        }
        self.steps.try_reserve(1)?;
        self.steps.push(Step { index, gap: gap as u16 });
        self.last = offset;
        let kind = &mut self.kinds[usize::from(index)];
        if kind.count == 0 {
            self.order.push(index);
        }
        kind.count += 1;
        Ok(())
    }

    /// Forgets which instances were shown.
    pub fn forget_instances(&mut self) {
        self.seen.clear();
        self.seen_bytes.fill(None);
    }

    /// The instance of a record, if it has one and is the first of it.
    ///
    /// # Errors
    /// Those of reading the log.
    pub fn new_instance(
        &mut self,
        window: &mut FileWindow,
        index: u16,
        record: &Indexed,
    ) -> io::Result<Option<String>> {
        let Some(place) = self.kinds[usize::from(index)].instance else { return Ok(None) };
        let len = usize::from(record.header.payload_len);
        let bytes = window.at(record.payload, len)?;
        let payload = &bytes[..len.min(bytes.len())];
        if self.has_seen(usize::from(index), place, payload) {
            return Ok(None);
        }
        if place.text_len == 0 {
            let seen = &mut self.seen_bytes[usize::from(index)];
            seen.get_or_insert_with(|| Box::new([false; 256]))[usize::from(place.byte(payload))] =
                true;
        }
        let text = place.text(payload);
        Ok(self.seen.insert((index, text.clone())).then_some(text))
    }

    /// Adds the records at the front of `bytes`, which stand at `offset` in the log, as long as there is nothing special
    /// about them; returns the bytes of these records.
    fn hop(&mut self, bytes: &[u8], offset: u64, registry: &Registry) -> usize {
        if self.steps.try_reserve(bytes.len() / SHORTEST + 1).is_err() {
            return 0;
        }
        let mut at = 0;
        while let Some(look) = bytes.get(at..).and_then(<[u8]>::first_chunk::<LOOK>) {
            let frame: &[u8; HEADER_LEN_V2] = look.last_chunk().expect("LOOK is longer");
            let (msgid, header_len) = match frame[0] {
                STX_V2 => (u32::from_le_bytes([frame[7], frame[8], frame[9], 0]), HEADER_LEN_V2),
                STX_V1 => (u32::from(frame[5]), HEADER_LEN_V1),
                _ => break,
            };
            let payload_len = usize::from(frame[1]);
            let mut len = STAMP_LEN + header_len + payload_len + CHECKSUM_LEN;
            if frame[0] == STX_V2 && frame[2] & IFLAG_SIGNED != 0 {
                len += SIGNATURE_LEN;
            }
            if let Some(entry) = registry.lookup(msgid) {
                let index = usize::from(entry.index);
                let here = offset + at as u64;
                let Ok(gap) = u16::try_from(here - self.last) else { break };
                let kind = self.kinds[index];
                if kind.count == 0 {
                    break;
                }
                if let Some(place) = kind.instance {
                    let payload = at + STAMP_LEN + header_len;
                    let seen = bytes
                        .get(payload..payload + payload_len)
                        .is_some_and(|payload| self.has_seen(index, place, payload));
                    if !seen {
                        break;
                    }
                }
                self.kinds[index].count = kind.count + 1;
                self.steps.push(Step { index: entry.index, gap });
                self.last = here;
            }
            at += len;
        }
        at
    }

    /// A number's instance that was seen before.
    fn has_seen(&self, index: usize, place: InstancePlace, payload: &[u8]) -> bool {
        let seen = self.seen_bytes[index].as_ref();
        place.text_len == 0 && seen.is_some_and(|seen| seen[usize::from(place.byte(payload))])
    }

    /// Adds records from `offset` on, up to one that needs a closer look or begins behind `limit`; with a `finder` only
    /// the good ones.
    ///
    /// # Errors
    /// Those of reading the log, and `OutOfMemory`.
    pub fn extend(
        &mut self,
        window: &mut FileWindow,
        mut offset: u64,
        limit: u64,
        size: u64,
        mut finder: Option<&mut RecordFinder>,
    ) -> io::Result<Stop> {
        let registry = &*Arc::clone(&self.registry);
        while offset <= limit {
            let found = if let Some(finder) = &mut finder {
                find_good(finder, window, offset, registry)?
            } else {
                let bytes = window.at(offset, LOOK)?;
                let bytes = &bytes[..bytes.len().min((limit - offset) as usize + LOOK)];
                let hopped = self.hop(bytes, offset, registry) as u64;
                offset += hopped;
                if hopped > 0 && offset > limit {
                    break;
                }
                find_record(window, offset, size)?
            };
            let Some(record) = found else { return Ok(Stop::End { next: offset }) };
            offset = record.next;
            let Some(entry) = registry.lookup(record.header.msgid) else { continue };
            let index = entry.index;
            if !self.knows(index) {
                return Ok(Stop::FirstOfType { index, record });
            }
            if self.kinds[usize::from(index)].instance.is_none() {
                self.add(index, record.offset)?;
            } else if record.payload + u64::from(record.header.payload_len) <= size {
                // Of a type with instances a payload that the file cuts off is not indexed.
                self.add(index, record.offset)?;
                if let Some(instance) = self.new_instance(window, index, &record)? {
                    return Ok(Stop::NewInstance { index, instance, next: offset });
                }
            }
        }
        Ok(Stop::Limit { next: offset })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mavwire_core::builtin;
    use mavwire_core::frame::FrameBuffer;
    use mavwire_core::log::tlog::Stamp;
    use mavwire_core::schema::WireVersion::V2;

    #[test]
    fn an_index_knows_the_place_of_each_record() {
        let registry = Arc::new(Registry::new(builtin::dialect("minimal", V2).expect("built in")));
        let entry = registry.lookup(0).expect("HEARTBEAT");
        let mut log = Vec::new();
        for seq in 0..3 {
            log.extend(Stamp::encode(1_700_000_000_000_000, 0));
            let mut frame = FrameBuffer::default();
            frame.encode(Header::new(V2, seq, 1, 1, 0), &[1; 9], entry.crc_extra).expect("it fits");
            log.extend(frame.iter());
        }
        let path = std::env::temp_dir().join(format!("mavwire-index-{}", std::process::id()));
        std::fs::write(&path, &log).expect("a temporary file");
        let (size, third) = (log.len() as u64, log.len() as u64 / 3);
        let mut window = FileWindow::open(&path).expect("the file");
        let mut index = LogIndex::new(registry);
        let first = index.extend(&mut window, 0, size, size, None).expect("readable");
        let Stop::FirstOfType { index: kind, record } = first else { panic!("a first record") };
        index.add(kind, record.offset).expect("memory");
        let end = index.extend(&mut window, record.next, size, size, None).expect("readable");
        std::fs::remove_file(&path).expect("removed");
        assert!(matches!(end, Stop::End { next } | Stop::Limit { next } if next == size));
        assert_eq!(index.counts(), [(0, "HEARTBEAT".to_owned(), 3)]);
        assert_eq!(index.by_type().expect("memory"), [(0, vec![0, third, 2 * third])]);
    }
}
