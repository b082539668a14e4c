//! Dataflash logs, which ArduPilot writes on board: records that the log itself describes.
//!
//! A binary record is `A3 95 TYPE` and a body of fixed length. FMT records say which name, fields and length a type has;
//! UNIT, MULT and FMTU records say what the fields are measured in and which of them tells instances apart. There are no
//! checksums. The text form has one line for each record, `NAME, VALUE, VALUE`, and the same FMT lines.
//!
//! Reading takes two steps, both pure functions over slices, so that stretches of a log can be worked on side by side:
//! [`Definitions::collect`] finds the layouts, [`index`] the records. [`value`] decodes a field of a record.

mod clock;
mod definitions;
mod field;
mod layout;
mod record;
mod records;
pub mod text;
mod units;

pub use clock::{Clock, ClockFinder, ClockUnit, TimeRule, Told, gps_time};
pub use definitions::{Definitions, MAX_DEFINITIONS};
pub use field::{ARRAY_LEN, FieldKind, Value, half, value};
pub use layout::{
    FMT_LAYOUT_LEN, Field, Layout, LayoutError, TimeUnit, log_text, whole, write_float,
};
pub use record::Record;
pub use records::{Found, LOOK_LEN, RecordEntry, index, look, pass};
pub use units::Units;

/// The first two bytes of each binary record.
pub const HEAD: [u8; 2] = [0xA3, 0x95];

/// Bytes of a record in front of its body: [`HEAD`] and the type.
pub const HEAD_LEN: usize = 3;

/// The type of the records that describe types.
pub const FMT_TYPE: u8 = 0x80;

/// Bytes of the longest record.
pub const MAX_RECORD_LEN: usize = 255;

#[cfg(test)]
mod tests;
