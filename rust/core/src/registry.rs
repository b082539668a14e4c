//! From message id to message definition, fast enough to be asked for every frame.
//!
//! Ids are 24 bits wide but cluster: a directory of pages of 256 ids costs two loads per lookup and a few kilobytes per
//! dialect. Page 0 of the table is the empty page that all unused directory entries point at.

use std::collections::{HashMap, HashSet};
use std::sync::OnceLock;

use mavwire_schema::{Dialect, Message, Reason, SchemaError, with_free_name};

use crate::telemetry::BootTimes;

const PAGE: usize = 256;
const NO_MESSAGE: u16 = u16::MAX;
/// Messages of several dialects together.
const MAX_MERGED: usize = 32_768;

/// The facts about a message that scanning needs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    /// Index into the dialect's messages.
    pub index: u16,
    /// Checksum seed.
    pub crc_extra: u8,
    /// Payload bytes of the base fields.
    pub min_len: u8,
    /// Payload bytes with extension fields.
    pub max_len: u8,
}

impl Entry {
    fn of(message: &Message, index: usize) -> Self {
        Self {
            index: index as u16,
            crc_extra: message.crc_extra,
            min_len: message.min_len,
            max_len: message.max_len,
        }
    }
}

const EMPTY: Entry = Entry { index: NO_MESSAGE, crc_extra: 0, min_len: 0, max_len: 0 };

/// A dialect with an index by message id.
#[derive(Debug, Clone)]
pub struct Registry {
    dialect: Dialect,
    /// How many of the messages are the dialect's own; the layouts of other definitions follow.
    own: usize,
    /// Ids with layouts of other definitions, in order of id and `crc_extra`.
    others: Box<[(u32, Entry)]>,
    /// Those that a dialect defines as its own which was merged into this one: id and `crc_extra`.
    merged_in: HashSet<(u32, u8)>,
    /// `directory[msgid / PAGE]`: number of the page in `entries`.
    directory: Box<[u16]>,
    entries: Box<[Entry]>,
    boot_times: OnceLock<BootTimes>,
}

impl Registry {
    /// Indexes a dialect. Of two messages with one id the later one counts.
    ///
    /// # Panics
    /// Where the dialect has 65,535 messages or more, which the definitions parser does not let through.
    pub fn new(mut dialect: Dialect) -> Self {
        let own = dialect.messages.len();
        dialect.messages.append(&mut dialect.others);
        assert!(dialect.messages.len() < usize::from(NO_MESSAGE), "too many messages in a dialect");
        let others = (own..).zip(&dialect.messages[own..]);
        let mut others: Box<[_]> =
            others.map(|(index, message)| (message.id, Entry::of(message, index))).collect();
        others.sort_unstable_by_key(|(msgid, entry)| (*msgid, entry.crc_extra));
        let own_messages = &dialect.messages[..own];
        let pages = own_messages.iter().map(|m| page_of(m.id) + 1).max().unwrap_or(0);
        let mut directory = vec![0; pages].into_boxed_slice();
        let mut entries = vec![EMPTY; PAGE];
        for (index, message) in own_messages.iter().enumerate() {
            let page = &mut directory[page_of(message.id)];
            if *page == 0 {
                *page = (entries.len() / PAGE) as u16;
                entries.resize(entries.len() + PAGE, EMPTY);
            }
            entries[usize::from(*page) * PAGE + message.id as usize % PAGE] =
                Entry::of(message, index);
        }
        let (entries, boot_times) = (entries.into_boxed_slice(), OnceLock::new());
        let merged_in = HashSet::new();
        Self { dialect, own, others, merged_in, directory, entries, boot_times }
    }

    /// Where its messages say how long their sender has been running.
    pub fn boot_times(&self) -> &BootTimes {
        self.boot_times.get_or_init(|| BootTimes::of(&self.dialect))
    }

    /// The dialect. Its messages are the own ones, and behind them the layouts of other definitions.
    pub fn dialect(&self) -> &Dialect {
        &self.dialect
    }

    /// This dialect with what another one defines beyond it. An id that both define keeps its message. The other layouts of
    /// such ids go beside it. An enum has the entries of both.
    ///
    /// # Errors
    /// There are too many messages.
    pub fn merged(&self, other: &Self) -> Result<Self, SchemaError> {
        let mut dialect = self.dialect.clone();
        let mut others = dialect.messages.split_off(self.own);
        let all = &self.dialect.messages;
        let mut names = all.iter().map(|one| one.name.clone()).collect();
        let mut layouts: HashSet<_> = all.iter().map(|one| (one.id, one.crc_extra)).collect();
        let own = other.own_messages().iter().map(|one| (one.id, one.crc_extra));
        let merged_in = own.chain(self.merged_in.iter().copied()).collect();
        for (n, message) in other.dialect.messages.iter().enumerate() {
            let is_new = n < other.own && self.lookup(message.id).is_none();
            if layouts.insert((message.id, message.crc_extra)) || is_new {
                let message = with_free_name(message.clone(), &mut names);
                (if is_new { &mut dialect.messages } else { &mut others }).push(message);
            }
        }
        if dialect.messages.len() + others.len() > MAX_MERGED {
            let reason = Reason::TooMany { what: "messages", limit: MAX_MERGED };
            return Err(SchemaError::new(&other.dialect.name, reason));
        }
        dialect.others = others;
        let known: HashMap<_, _> =
            self.dialect.enums.iter().enumerate().map(|(index, one)| (&one.name, index)).collect();
        for definition in &other.dialect.enums {
            match known.get(&definition.name) {
                Some(&index) => dialect.enums[index].add(&definition.entries),
                None => dialect.enums.push(definition.clone()),
            }
        }
        Ok(Self { merged_in, ..Self::new(dialect) })
    }

    /// The messages without the layouts of other definitions: each id once.
    pub fn own_messages(&self) -> &[Message] {
        &self.dialect.messages[..self.own]
    }

    /// The layout of a message id in another definition, whose `crc_extra` this is.
    pub fn other(&self, msgid: u32, crc_extra: u8) -> Option<Entry> {
        let key = (msgid, crc_extra);
        let found = self.others.binary_search_by_key(&key, |(id, entry)| (*id, entry.crc_extra));
        Some(self.others[found.ok()?].1)
    }

    /// Whether a dialect that was merged into this one has a layout as its own, which its user expects in frames.
    pub fn is_merged_in(&self, msgid: u32, crc_extra: u8) -> bool {
        self.merged_in.contains(&(msgid, crc_extra))
    }

    /// The message with an id, if the dialect has it.
    #[inline]
    pub fn lookup(&self, msgid: u32) -> Option<Entry> {
        let page = usize::from(*self.directory.get(page_of(msgid))?);
        let entry = *self.entries.get(page * PAGE + msgid as usize % PAGE)?;
        (entry.index != NO_MESSAGE).then_some(entry)
    }

    /// The entry of the message at an index, or `None` beyond the last message.
    pub fn entry(&self, index: u16) -> Option<Entry> {
        let message = self.dialect.messages.get(usize::from(index))?;
        Some(Entry::of(message, index.into()))
    }

    /// The definition behind [`Entry::index`].
    ///
    /// # Panics
    /// Where `index` did not come from this registry.
    #[inline]
    pub fn message(&self, index: u16) -> &Message {
        &self.dialect.messages[usize::from(index)]
    }
}

#[inline]
fn page_of(msgid: u32) -> usize {
    msgid as usize / PAGE
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{message, registry};
    use mavwire_schema::{Enum, EnumEntry, WireVersion};

    #[test]
    fn every_message_is_found_and_nothing_else() {
        let registry = registry();
        let ids: Vec<u32> = registry.dialect().messages.iter().map(|message| message.id).collect();
        for msgid in (0..70_000).chain([1 << 16, (1 << 24) - 1, 1 << 24, u32::MAX]) {
            let found = registry.lookup(msgid);
            assert_eq!(found.is_some(), ids.contains(&msgid), "{msgid}");
            if let Some(entry) = found {
                let message = registry.message(entry.index);
                let facts = (message.id, message.crc_extra, message.min_len, message.max_len);
                assert_eq!(facts, (msgid, entry.crc_extra, entry.min_len, entry.max_len));
            }
        }
    }

    #[test]
    fn extreme_and_repeated_ids() {
        let (name, wire_version) = ("edge".into(), WireVersion::V2);
        let mut dialect =
            Dialect { name, wire_version, messages: vec![], others: vec![], enums: vec![] };
        assert_eq!(Registry::new(dialect.clone()).lookup(0), None);
        let last = (1 << 24) - 1;
        for (id, crc_extra) in [(last, 1), (0, 2), (last, 3)] {
            dialect.messages.push(message(id, "M", crc_extra, &[], &[]));
        }
        let registry = Registry::new(dialect);
        let seed = |msgid| registry.lookup(msgid).map(|entry| entry.crc_extra);
        assert_eq!((seed(last), seed(0), seed(last - 1), seed(1)), (Some(3), Some(2), None, None));
    }

    #[test]
    fn of_several_dialects_the_first_that_knows_an_id_names_it() {
        let dialect = |messages: &[(u32, &str, u8)], others: &[(u32, &str, u8)]| {
            let made = |of: &[(u32, &str, u8)]| {
                of.iter().map(|&(id, name, extra)| message(id, name, extra, &[], &[])).collect()
            };
            let (name, wire_version) = ("some".into(), WireVersion::V2);
            let entries = messages.iter().map(|&(id, name, _)| EnumEntry {
                name: name.into(),
                value: id.into(),
                ..EnumEntry::default()
            });
            let commands =
                Enum { name: "CMD".into(), entries: entries.collect(), ..Enum::default() };
            let (messages, others) = (made(messages), made(others));
            Registry::new(Dialect { name, wire_version, messages, others, enums: vec![commands] })
        };
        let first = dialect(&[(1, "A", 10)], &[(1, "A_CRC11", 11)]);
        let second = dialect(&[(3, "C", 30), (1, "B", 12), (2, "A", 20)], &[(1, "OLD", 11)]);
        let registry = first.merged(&second).expect("they are few");
        let own: Vec<_> = registry.own_messages().iter().map(|m| (m.id, &*m.name)).collect();
        assert_eq!(own, [(1, "A"), (3, "C"), (2, "A_CRC20")]);
        let commands = &registry.dialect().enums[0].entries;
        let commands: Vec<_> = commands.iter().map(|one| (one.value, &*one.name)).collect();
        assert_eq!(commands, [(1, "A"), (3, "C")]);
        let name = |extra| registry.other(1, extra).map(|e| &*registry.message(e.index).name);
        assert_eq!([10, 11, 12].map(name), [None, Some("A_CRC11"), Some("B")]);
        assert_eq!([11, 12].map(|extra| registry.is_merged_in(1, extra)), [false, true]);
        assert_eq!(registry.lookup(1).map(|entry| entry.crc_extra), Some(10));
    }
}
