//! Files to a [`Dialect`]: includes gathered, enums merged, messages laid out, and everything checked that takes more
//! than one file to judge.

use std::collections::{BTreeSet, HashMap};
use std::rc::Rc;

use crate::definitions::{Definitions, MessageDef};
use crate::dialect::{Dialect, Message, WireVersion};
use crate::error::{Reason, SchemaError, excerpt};
use crate::includes::{File, Lookup, collect};
use crate::layout::lay_out;
use crate::limits::MAX_MESSAGES;
use crate::merge::{EnumMerger, Place};
use crate::parse::dialect_name;

/// `<version>` of a file that does not say.
const DEFAULT_VERSION: u8 = 2;

/// Largest message id of a version 1 frame.
const MAX_V1_ID: u32 = 255;

/// Puts a dialect together. `lookup` answers a path with what that file says, or with [`Reason::NotFound`]; it is asked
/// for `main` as given and for each include by its path relative to the main file. Built-in definitions go by
/// [`dialect_name`]`(path)`.
///
/// The order of messages and enums is that of the files: `main`, then its includes breadth-first. Enums of the same name
/// become one, with entries in ascending order. For [`WireVersion::V1`], messages with ids above 255, extension fields,
/// and messages that have no other fields are left out.
///
/// # Errors
/// Errors of `lookup`; includes that are missing, circular, or more than 5 levels deep; ids, names or values used
/// twice; fields with an enum that is not defined.
pub fn resolve(
    main: &str,
    lookup: &mut dyn FnMut(&str) -> Result<Definitions, SchemaError>,
    wire_version: WireVersion,
) -> Result<Dialect, SchemaError> {
    let lookup: &mut Lookup<'_> = lookup;
    let mut files = collect(main, lookup)?;
    let enums = EnumMerger::merge(&mut files)?;
    let mut messages = Messages { wire_version, ..Messages::default() };
    for file in files {
        messages.add_file(file, &enums)?;
    }
    Ok(Dialect {
        name: dialect_name(main).to_owned(),
        wire_version,
        messages: messages.laid_out,
        others: Vec::new(),
        enums: enums.into_enums(),
    })
}

impl Dialect {
    /// Adds layouts that ids have in other definitions. One with a name that is taken gets its `crc_extra` as a suffix, and
    /// its id if that is not enough.
    ///
    /// # Errors
    /// A message that no frame can carry, or too many messages.
    pub fn add_others(&mut self, definitions: Definitions) -> Result<(), SchemaError> {
        let mut names = self.messages.iter().map(|one| one.name.clone()).collect();
        let version = definitions.version.unwrap_or(DEFAULT_VERSION);
        for message in definitions.messages {
            let Some(message) = message.for_version(self.wire_version) else { continue };
            let place = Place { file: definitions.name.as_str().into(), line: message.line };
            if self.others.len() == MAX_MESSAGES {
                let reason = Reason::TooMany { what: "messages", limit: MAX_MESSAGES };
                return Err(place.error(reason));
            }
            let message = lay_out(message, version, &|_| false).map_err(|e| place.error(e))?;
            self.others.push(with_free_name(message, &mut names));
        }
        Ok(())
    }
}

/// A message under a name that is not among `names`. The name is added to them.
pub fn with_free_name(mut message: Message, names: &mut BTreeSet<String>) -> Message {
    message.name = free_name(message.name, message.id, message.crc_extra, names);
    message
}

/// A message's name, with suffixes if it is among `names`. It is added to them.
pub(crate) fn free_name(
    mut name: String,
    id: u32,
    crc_extra: u8,
    names: &mut BTreeSet<String>,
) -> String {
    for suffix in [format!("_CRC{crc_extra}"), format!("_ID{id}")] {
        if names.contains(&name) {
            name += &suffix;
        }
    }
    names.insert(name.clone());
    name
}

impl MessageDef {
    /// The message as frames of a wire version carry it, if they can.
    fn for_version(mut self, wire_version: WireVersion) -> Option<Self> {
        if wire_version == WireVersion::V1 {
            self.fields.retain(|field| !field.is_extension);
        }
        let fits = wire_version == WireVersion::V2 || self.id <= MAX_V1_ID;
        // Nothing is left of a message of extension fields alone.
        (fits && !self.fields.is_empty()).then_some(self)
    }
}

/// The messages so far, and who has which id and name.
#[derive(Default)]
struct Messages {
    wire_version: WireVersion,
    laid_out: Vec<Message>,
    by_id: HashMap<u32, Owner>,
    by_name: HashMap<Rc<str>, Owner>,
}

/// Name and place of a message that has an id or a name, for the error of the next one that wants it.
type Owner = (Rc<str>, Place);

impl Messages {
    fn add_file(&mut self, file: File, enums: &EnumMerger) -> Result<(), SchemaError> {
        let version = file.definitions.version.unwrap_or(DEFAULT_VERSION);
        let path: Rc<str> = file.path.into();
        for message in file.definitions.messages {
            let Some(message) = message.for_version(self.wire_version) else { continue };
            let place = Place { file: Rc::clone(&path), line: message.line };
            let name: Rc<str> = message.name.to_ascii_uppercase().into();
            self.add(message, &name, version, &place, enums)
                .map_err(|reason| place.error(reason).within(format!("message {name}")))?;
        }
        Ok(())
    }

    fn add(
        &mut self,
        message: MessageDef,
        name: &Rc<str>,
        version: u8,
        place: &Place,
        enums: &EnumMerger,
    ) -> Result<(), Reason> {
        let owner = (Rc::clone(name), place.clone());
        if let Some((name, place)) = self.by_id.insert(message.id, owner.clone()) {
            let other = format!("{name} ({place})");
            return Err(Reason::DuplicateMessageId { id: message.id, other });
        }
        if let Some((_, place)) = self.by_name.insert(Rc::clone(name), owner) {
            return Err(Reason::DuplicateMessageName { other: place.to_string() });
        }
        if self.laid_out.len() == MAX_MESSAGES {
            return Err(Reason::TooMany { what: "messages", limit: MAX_MESSAGES });
        }
        let named = message.fields.iter().filter_map(|field| field.enum_name.as_ref());
        if let Some(unknown) = named.into_iter().find(|name| !enums.is_defined(name)) {
            return Err(Reason::UnknownEnum(excerpt(unknown)));
        }
        self.laid_out.push(lay_out(message, version, &|name| enums.is_bitmask(name))?);
        Ok(())
    }
}
