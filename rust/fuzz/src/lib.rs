//! What the fuzz targets do. Each takes any bytes, and panics where a promise does not hold.
//!
//! The programs in `fuzz_targets` give them to libFuzzer; `tests/replay.rs` gives them the corpus, on any toolchain. A target
//! that finds something new leaves its input in `corpus`, where it is replayed from then on.

#![forbid(unsafe_code)]

mod dataflash;
mod definitions;
mod dialects;
mod files;
mod input;
mod router;
mod signing;
mod telemetry;
mod wire;

pub use dataflash::{dataflash, dataflash_text};
pub use definitions::xml;
pub use files::log_files;
pub use router::router;
pub use signing::{border, signing};
pub use telemetry::tlog;
pub use wire::{codec, policies, scanner};

/// A target.
pub type Target = fn(&[u8]);

/// All targets, by the names of their programs and folders.
pub const TARGETS: [(&str, Target); 11] = [
    ("border", border),
    ("codec", codec),
    ("dataflash", dataflash),
    ("dataflash_text", dataflash_text),
    ("log_files", log_files),
    ("policies", policies),
    ("router", router),
    ("scanner", scanner),
    ("signing", signing),
    ("tlog", tlog),
    ("xml", xml),
];
