//! MAVLink logs as Arrow tables, one for each message type, and from there to Parquet, CSV, JSON lines, Arrow
//! and MCAP files.
//!
//! A log is read in blocks of bounded size ([`input`]). Each is searched for records on all processors ([`scan`]), with
//! exactly the outcome of one [`mavwire_core::log::tlog::RecordScanner`] over the whole log. The records are then laid
//! side by side by message type, and appended to its table ([`table`]), a gather for each field. [`layout`] has the
//! name, type and metadata of each column. [`reader`] puts all that together; [`summary`] counts instead.
//!
//! Nothing here opens a file: logs are `Read`, outputs `Write`. [`dataflash`] reads the logs that ArduPilot writes on board.

pub mod align;
pub mod column;
pub mod common_schema;
pub mod convert;
pub mod dataflash;
pub mod dates;
mod decoder;
pub mod enums;
pub mod error;
pub mod fit;
pub mod gather;
pub mod gathered;
pub mod input;
pub mod instances;
pub mod layout;
pub mod mcap;
pub mod output;
pub mod pool;
pub mod reader;
pub mod rewrite;
mod row_block;
mod row_groups;
pub mod scan;
pub mod select;
mod sequence;
pub mod summary;
pub mod table;
mod tables;
pub mod units;
pub mod unknown;
pub mod unknown_table;

pub use arrow;
pub use error::Error;
