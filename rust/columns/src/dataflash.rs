//! Dataflash logs as tables, binary and text: one for each record type, by its name.
//!
//! A log describes its own records, so a [`Survey`] finds the descriptions, the units and the clock. [`reader()`] then hops
//! over the records, sorts them by table, and gathers field by field like the reader of telemetry logs. [`read_whole`] does
//! both in one pass where that gives the same. Values are those of `DFReader`.

mod decoder;
mod layout;
mod lines;
mod reader;
mod record_index;
mod record_times;
mod run;
mod summary;
mod survey;
mod whole;

pub use layout::{TableLayout, table_layout};
pub use reader::reader;
pub use summary::summary;
pub use survey::{Form, Open, Survey};
pub use whole::{Whole, read_whole};
