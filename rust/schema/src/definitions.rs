//! What one XML file says, includes unresolved. Plain data, written by the build script into the blob of built-in
//! dialects and made at run time from a user's XML.

use serde::{Deserialize, Serialize};

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
    pub enums: Vec<EnumDef>,
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

/// An `<enum>` as written; entries of equally named enums are merged when a dialect is resolved.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct EnumDef {
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
    /// Entries in file order.
    pub entries: Vec<EnumEntryDef>,
}

/// An `<entry>` of an enum.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct EnumEntryDef {
    /// `name`.
    pub name: String,
    /// Line in the file, from 1.
    pub line: u32,
    /// Status marks.
    pub status: Status,
    /// `value`, from -2^63 to 2^64 - 1; `None` means the highest value of the file so far plus one.
    pub value: Option<i128>,
    /// `hasLocation="true"`.
    pub has_location: bool,
    /// `isDestination="true"`.
    pub is_destination: bool,
    /// Free text; empty for the built-in definitions.
    pub description: String,
    /// `<param>` elements of a command.
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
    /// Stands after `<extensions/>`.
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

/// Element type of a field. The discriminants are the `MAVLINK_TYPE_*` numbers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[repr(u8)]
pub enum FieldType {
    /// `char`
    #[serde(rename = "char")]
    Char = 0,
    /// `uint8_t`
    #[serde(rename = "uint8_t")]
    #[default]
    U8 = 1,
    /// `int8_t`
    #[serde(rename = "int8_t")]
    I8 = 2,
    /// `uint16_t`
    #[serde(rename = "uint16_t")]
    U16 = 3,
    /// `int16_t`
    #[serde(rename = "int16_t")]
    I16 = 4,
    /// `uint32_t`
    #[serde(rename = "uint32_t")]
    U32 = 5,
    /// `int32_t`
    #[serde(rename = "int32_t")]
    I32 = 6,
    /// `uint64_t`
    #[serde(rename = "uint64_t")]
    U64 = 7,
    /// `int64_t`
    #[serde(rename = "int64_t")]
    I64 = 8,
    /// `float`
    #[serde(rename = "float")]
    F32 = 9,
    /// `double`
    #[serde(rename = "double")]
    F64 = 10,
}

impl FieldType {
    /// Every type, in the order of the `MAVLINK_TYPE_*` numbers.
    pub const ALL: [Self; 11] = [
        Self::Char,
        Self::U8,
        Self::I8,
        Self::U16,
        Self::I16,
        Self::U32,
        Self::I32,
        Self::U64,
        Self::I64,
        Self::F32,
        Self::F64,
    ];

    /// Bytes of one element.
    pub const fn size(self) -> usize {
        match self {
            Self::Char | Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }

    /// The name in XML and in `crc_extra`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Char => "char",
            Self::U8 => "uint8_t",
            Self::I8 => "int8_t",
            Self::U16 => "uint16_t",
            Self::I16 => "int16_t",
            Self::U32 => "uint32_t",
            Self::I32 => "int32_t",
            Self::U64 => "uint64_t",
            Self::I64 => "int64_t",
            Self::F32 => "float",
            Self::F64 => "double",
        }
    }

    /// Letter of Python's `struct` module.
    pub const fn struct_code(self) -> char {
        match self {
            Self::Char => 'c',
            Self::U8 => 'B',
            Self::I8 => 'b',
            Self::U16 => 'H',
            Self::I16 => 'h',
            Self::U32 => 'I',
            Self::I32 => 'i',
            Self::U64 => 'Q',
            Self::I64 => 'q',
            Self::F32 => 'f',
            Self::F64 => 'd',
        }
    }
}
