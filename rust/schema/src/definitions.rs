//! The content of one XML file, with its includes unresolved. Plain data: the build script writes it into the blob of
//! built-in dialects, and a user's XML becomes it at run time.

use serde::{Deserialize, Serialize};

use crate::field_type::FieldType;

/// One XML file.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Definitions {
    /// Base name of the file without `.xml`: the dialect's name.
    pub name: String,
    /// `<version>`: the value of `uint8_t_mavlink_version` fields; `None` where the file does not say.
    pub version: Option<u8>,
    /// `<dialect>` number.
    pub dialect: Option<u16>,
    /// `<include>` texts, in order, as written.
    pub includes: Vec<String>,
    /// Enums in file order.
    pub enums: Vec<Enum>,
    /// Messages in file order.
    pub messages: Vec<MessageDef>,
}

/// A `<deprecated>` or `<superseded>` mark.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Deprecation {
    /// `since`, `YYYY-MM`.
    pub since: String,
    /// `replaced_by`; empty where nothing replaces it.
    pub replaced_by: String,
    /// Free text; empty for the built-in definitions.
    pub explanation: String,
}

/// The status marks an enum, an entry or a message may carry. Few do, and there are thousands of entries: so they are
/// kept apart.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Status {
    /// Marked `<wip/>`.
    pub wip: bool,
    /// Marked `<deprecated/>`.
    pub deprecated: Option<Box<Deprecation>>,
    /// Marked `<superseded/>`.
    pub superseded: Option<Box<Deprecation>>,
}

/// An `<enum>`, as written or with the entries of all enums of its name, which are merged when a dialect is resolved.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Enum {
    /// `name`.
    pub name: String,
    /// Line in the file, from 1.
    pub line: u32,
    /// Status marks.
    pub status: Status,
    /// `bitmask="true"`.
    pub bitmask: bool,
    /// Free text; empty for the built-in facts-only definitions.
    pub description: String,
    /// Entries in file order, in a dialect in ascending order of value.
    pub entries: Vec<EnumEntry>,
}

/// An `<entry>` of an enum.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct EnumEntry {
    /// `name`.
    pub name: String,
    /// Line in the file, from 1.
    pub line: u32,
    /// Status marks.
    pub status: Status,
    /// `value`, from -2^63 to 2^64 - 1. An entry without it has the highest value before it plus one.
    pub value: i128,
    /// There is no `value` in the file.
    pub is_automatic: bool,
    /// `hasLocation="true"`.
    pub has_location: bool,
    /// `isDestination="true"`.
    pub is_destination: bool,
    /// Free text; empty for the built-in definitions.
    pub description: String,
    /// `<param>` elements of a command (may be fewer than 7).
    pub params: Vec<CommandParam>,
}

/// A `<param>` of a `MAV_CMD` entry.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct CommandParam {
    /// 1 to 7.
    pub index: u8,
    /// `label`.
    pub label: Option<String>,
    /// `units`.
    pub units: Option<String>,
    /// `enum`.
    pub enum_name: Option<String>,
    /// `multiplier`.
    pub multiplier: Option<String>,
    /// `minValue`, `maxValue`, `increment` and `default`, as written.
    pub min_value: Option<String>,
    /// See `min_value`.
    pub max_value: Option<String>,
    /// See `min_value`.
    pub increment: Option<String>,
    /// See `min_value`.
    pub default: Option<String>,
    /// `reserved="true"`.
    pub reserved: bool,
    /// Free text; empty for the built-in definitions.
    pub description: String,
}

/// A `<message>` as written.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct MessageDef {
    /// `id`, at most 2^24 - 1.
    pub id: u32,
    /// `name` as written; `crc_extra` covers this spelling, the message's name is upper case.
    pub name: String,
    /// `crc_extra` of a message that has another name than in its file, where a [`Union`](crate::Union) has the name already.
    pub crc_extra: Option<u8>,
    /// Line in the file, from 1.
    pub line: u32,
    /// Status marks.
    pub status: Status,
    /// Free text; empty for the built-in definitions.
    pub description: String,
    /// Fields in file order, extension fields last.
    pub fields: Vec<FieldDef>,
}

/// A `<field>` as written.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct FieldDef {
    /// `name`.
    pub name: String,
    /// Element type.
    pub field_type: FieldType,
    /// Elements of an array field; 0 for a scalar.
    pub array_length: u8,
    /// Declared `uint8_t_mavlink_version`.
    pub is_mavlink_version: bool,
    /// Declared after `<extensions/>`.
    pub is_extension: bool,
    /// `instance="true"`.
    pub is_instance: bool,
    /// `units`, without brackets.
    pub units: Option<String>,
    /// `enum`.
    pub enum_name: Option<String>,
    /// `display`.
    pub display: Option<String>,
    /// `print_format`.
    pub print_format: Option<String>,
    /// `invalid`.
    pub invalid: Option<String>,
    /// `multiplier`.
    pub multiplier: Option<String>,
    /// `minValue`.
    pub min_value: Option<String>,
    /// `maxValue`.
    pub max_value: Option<String>,
    /// `increment`.
    pub increment: Option<String>,
    /// `default`.
    pub default: Option<String>,
    /// Free text; empty for the built-in definitions.
    pub description: String,
}

impl FieldDef {
    /// Bytes on the wire.
    pub fn wire_len(&self) -> usize {
        self.field_type.size() * usize::from(self.array_length.max(1))
    }
}
