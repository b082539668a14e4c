//! Everything of mavwire that touches the operating system.
//!
//! Protocol logic stays in `mavwire-core`, which takes slices; this crate is where the slices come from. Sockets and serial ports
//! are read here on systems with POSIX descriptors; elsewhere that is `Unsupported`, and Python reads them.

pub mod address;
#[cfg(unix)]
pub mod bridge;
pub mod bytes;
pub mod clock;
pub mod dataflash;
pub mod dataflash_log;
pub mod datagrams;
pub mod error_text;
pub mod files;
pub mod live_source;
mod log_contents;
pub mod log_index;
pub mod log_reader;
pub mod memory;
pub mod peers;
pub mod readiness;
pub mod records;
pub mod text_log;
pub mod window;
