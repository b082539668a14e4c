//! A dialect put together from one or more files for one wire version: what core, links and Python work with.

use std::collections::HashSet;

use crate::definitions::{Enum, EnumEntry};
use crate::field_type::FieldType;

/// Wire protocol a dialect is laid out for. Version 1 drops ids above 255 and extension fields.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash)]
pub enum WireVersion {
    /// MAVLink 1 (`"1.0"`).
    V1,
    /// MAVLink 2 (`"2.0"`).
    #[default]
    V2,
}

/// Messages and enums of a dialect and its includes: the main file first, then its includes breadth-first.
#[derive(Debug, Clone)]
pub struct Dialect {
    /// Name of the main file.
    pub name: String,
    /// The wire version it was laid out for.
    pub wire_version: WireVersion,
    /// Messages in order.
    pub messages: Vec<Message>,
    /// Layouts that message ids have in other definitions, told apart by `crc_extra`. No two messages have one name.
    pub others: Vec<Message>,
    /// Enums in order, merged over files, without the synthetic `_ENUM_END` entries.
    pub enums: Vec<Enum>,
}

impl Enum {
    /// Adds the entries whose name and value are free.
    pub fn add(&mut self, entries: &[EnumEntry]) {
        let names: HashSet<_> = self.entries.iter().map(|one| one.name.clone()).collect();
        let values: HashSet<_> = self.entries.iter().map(|one| one.value).collect();
        let is_free = |one: &&EnumEntry| !names.contains(&one.name) && !values.contains(&one.value);
        self.entries.extend(entries.iter().filter(is_free).cloned());
        self.entries.sort_by_key(|entry| entry.value);
    }
}

/// A message with its wire layout.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Message {
    /// Message id, 0 to 2^24 - 1.
    pub id: u32,
    /// Upper-case name.
    pub name: String,
    /// Checksum seed of the definition.
    pub crc_extra: u8,
    /// Fields in XML order, extension fields last.
    pub fields: Vec<Field>,
    /// `wire_order[w]` is the index into `fields` of the `w`-th field on the wire.
    pub wire_order: Vec<u8>,
    /// Payload bytes of the base fields.
    pub min_len: u8,
    /// Payload bytes with extension fields.
    pub max_len: u8,
    /// Index into `fields` of the field marked `instance="true"` (the last one in wire order wins).
    pub instance_field: Option<u8>,
    /// Payload offset of `target_system` (`target` in `MANUAL_CONTROL`), if there is such a one-byte field.
    pub target_system_offset: Option<u8>,
    /// Payload offset of `target_component`, if there is such a one-byte field.
    pub target_component_offset: Option<u8>,
    /// Free text; empty for the built-in definitions.
    pub description: String,
}

/// A field with its place on the wire.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Field {
    /// `name`.
    pub name: String,
    /// Element type.
    pub field_type: FieldType,
    /// Elements of an array field; 0 for a scalar.
    pub array_length: u8,
    /// Payload offset in bytes.
    pub offset: u8,
    /// Extension field: zero where a frame does not carry it, never part of `crc_extra`.
    pub is_extension: bool,
    /// For `uint8_t_mavlink_version`: the dialect's version number, the default of the constructor functions.
    pub mavlink_version: Option<u8>,
    /// `units`, without brackets.
    pub units: Option<String>,
    /// `enum`.
    pub enum_name: Option<String>,
    /// `display`; `"bitmask"` where the enum is one.
    pub display: Option<String>,
    /// `invalid`.
    pub invalid: Option<String>,
    /// `multiplier`.
    pub multiplier: Option<String>,
    /// Free text; empty for the built-in definitions.
    pub description: String,
}

impl Message {
    /// The fields in the order they travel, each with its index into `fields`.
    pub fn wire_fields(&self) -> impl Iterator<Item = (usize, &Field)> {
        self.wire_order.iter().map(|&index| (usize::from(index), &self.fields[usize::from(index)]))
    }

    /// Layout of the whole payload as a format of Python's `struct` module, such as `<IB10s`.
    pub fn struct_format(&self) -> String {
        let codes =
            self.wire_fields().map(|(_, field)| match (field.array_length, field.is_char()) {
                (0, _) => field.field_type.struct_code().to_string(),
                (length, true) => format!("{length}s"),
                (length, false) => format!("{length}{}", field.field_type.struct_code()),
            });
        std::iter::once("<".to_owned()).chain(codes).collect()
    }
}

impl Field {
    /// Elements on the wire: 1 for a scalar.
    pub fn elements(&self) -> usize {
        usize::from(self.array_length.max(1))
    }

    /// Bytes on the wire.
    pub fn wire_len(&self) -> usize {
        self.field_type.size() * self.elements()
    }

    /// Text: `char` or `char[n]`.
    #[inline]
    pub fn is_char(&self) -> bool {
        self.field_type == FieldType::Char
    }

    /// An array of numbers (`char[n]` is text, not an array).
    pub fn is_numeric_array(&self) -> bool {
        self.array_length > 0 && !self.is_char()
    }
}
