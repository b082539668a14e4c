//! The union of definition files that are not written for each other: those of both upstreams, and a newer set beside them.

use std::collections::{BTreeSet, HashMap, HashSet};

use crate::definitions::{Definitions, Enum, MessageDef};
use crate::layout::Layout;
use crate::parse::dialect_name;
use crate::resolve::free_name;

/// The dialect that includes all others of a set that may be used together.
const ALL: &str = "all";

/// Sets of files as one file, and the layouts that it has no place for.
///
/// The first definition counts: an id or an enum value that is taken stays as it is. Of two messages that differ in extension
/// fields alone the longer one counts. A message whose name is taken gets a suffix, and keeps its `crc_extra`.
#[derive(Debug, Default)]
pub struct Union {
    own: Definitions,
    others: Vec<MessageDef>,
    /// Where `own` has the message of an id.
    by_id: HashMap<u32, usize>,
    names: BTreeSet<String>,
    /// The ids with `crc_extra` of `own` and `others`.
    keys: HashSet<(u32, u8)>,
    enums: HashMap<String, KnownEnum>,
}

/// Where the union has an enum, and what is taken there.
#[derive(Debug)]
struct KnownEnum {
    index: usize,
    names: HashSet<String>,
    values: HashSet<i128>,
}

impl Union {
    /// Adds a set. Within it the files that `all.xml` includes come first.
    pub fn add(&mut self, files: Vec<Definitions>) {
        for file in in_order(files) {
            self.own.version = self.own.version.max(file.version);
            for definition in file.enums {
                self.add_enum(definition);
            }
            for message in file.messages {
                self.add_message(message);
            }
        }
    }

    /// Adds layouts that ids have in other definitions.
    pub fn add_others(&mut self, messages: impl IntoIterator<Item = MessageDef>) {
        let new = messages.into_iter().filter(|message| self.keys.insert(key(message)));
        self.others.extend(new);
    }

    /// The union under a name, and the layouts of ids that are taken.
    pub fn finish(self, name: &str) -> (Definitions, Definitions) {
        let own = Definitions { name: name.to_owned(), ..self.own };
        let (name, version) = (own.name.clone(), own.version);
        (own, Definitions { name, version, messages: self.others, ..Definitions::default() })
    }

    fn add_message(&mut self, mut message: MessageDef) {
        let key = key(&message);
        match self.by_id.get(&message.id) {
            Some(&index) if self::key(&self.own.messages[index]) == key => {
                let known = &mut self.own.messages[index];
                if message.fields.len() > known.fields.len() {
                    message.name = std::mem::take(&mut known.name);
                    message.crc_extra = known.crc_extra;
                    *known = message;
                }
            }
            None => {
                let name = message.name.to_ascii_uppercase();
                let free = free_name(name.clone(), message.id, key.1, &mut self.names);
                if free != name {
                    (message.name, message.crc_extra) = (free, Some(key.1));
                }
                self.keys.insert(key);
                self.by_id.insert(message.id, self.own.messages.len());
                self.own.messages.push(message);
            }
            Some(_) => self.add_others([message]),
        }
    }

    fn add_enum(&mut self, definition: Enum) {
        let known = self.enums.entry(definition.name.clone()).or_insert_with(|| {
            self.own.enums.push(Enum { entries: Vec::new(), ..definition.clone() });
            let index = self.own.enums.len() - 1;
            KnownEnum { index, names: HashSet::new(), values: HashSet::new() }
        });
        for entry in definition.entries {
            if !known.values.contains(&entry.value) && known.names.insert(entry.name.clone()) {
                known.values.insert(entry.value);
                self.own.enums[known.index].entries.push(entry);
            }
        }
    }
}

/// The part of a message's definition that its frames prove. The name is part of it, since `crc_extra` covers it.
fn key(message: &MessageDef) -> (u32, u8) {
    (message.id, Layout::of(message).crc_extra)
}

/// `all` and the files that it includes, breadth-first, then the others.
fn in_order(mut files: Vec<Definitions>) -> Vec<Definitions> {
    files.sort_by(|a, b| a.name.cmp(&b.name));
    let mut ordered = Vec::new();
    let mut wanted = vec![ALL.to_owned()];
    let mut next = 0;
    while let Some(name) = wanted.get(next) {
        next += 1;
        if let Some(index) = files.iter().position(|file| file.name == *name) {
            let file = files.remove(index);
            wanted.extend(file.includes.iter().map(|path| dialect_name(path).to_owned()));
            ordered.push(file);
        }
    }
    ordered.extend(files);
    ordered
}
