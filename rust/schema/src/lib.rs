//! MAVLink definitions: from XML text to wire layouts.
//!
//! The same functions serve the built-in dialects (through the build script of `mavwire-core`) and a user's XML at run
//! time, so that there is one code path and nothing to drift apart. Two stages:
//!
//! 1. [`Definitions`] is what one XML file says, includes unresolved ([`parse_definitions`]).
//! 2. [`Dialect`] is a set of files put together for one wire version, with offsets, lengths and `crc_extra`
//!    ([`resolve`]).
//!
//! A [`Library`] holds the encoded built-in files. Every complaint is a [`SchemaError`] with file, line, column and a typed [`Reason`]. There is no I/O: closures answer for files.

#![forbid(unsafe_code)]

mod check;
mod definitions;
mod dialect;
mod error;
mod field_type;
mod guard;
mod includes;
mod invalid;
mod layout;
mod library;
pub mod limits;
mod merge;
mod number;
mod parse;
mod resolve;
mod standalone;
mod union;

pub use check::check_schema;
pub use definitions::{
    CommandParam, Definitions, Deprecation, Enum, EnumEntry, FieldDef, MessageDef, Status,
};
pub use dialect::{Dialect, Field, Message, WireVersion};
pub use error::{Reason, SchemaError};
pub use field_type::FieldType;
pub use invalid::InvalidRule;
pub use layout::{Layout, crc_extra};
pub use library::{Library, decode_blob, encode_blob};
pub use merge::number_behind;
pub use parse::{ParseOptions, Rules, dialect_name, field_type, parse_definitions};
pub use resolve::{resolve, with_free_name};
pub use standalone::standalone;
pub use union::Union;
