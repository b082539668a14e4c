//! The work of the fuzz targets. Each takes any bytes, and panics where a promise does not hold.
//!
//! The programs in `fuzz_targets` give them to libFuzzer; `tests/replay.rs` gives them the corpus, on any toolchain. A target
//! that finds something new leaves its input in `corpus`, where it is replayed from then on.

#![forbid(unsafe_code)]

mod addresses;
mod converters;
mod dataflash;
mod dataflash_tables;
mod definitions;
mod dialects;
mod files;
mod input;
mod logs;
mod private;
mod reading;
mod rewriting;
mod router;
mod signing;
mod tables;
mod telemetry;
mod text_tables;
mod wire;

pub use addresses::endpoint;
pub use converters::converters;
pub use dataflash::{dataflash, dataflash_text};
pub use dataflash_tables::dataflash_tables;
pub use definitions::xml;
pub use files::log_files;
pub use private::{anonymize, recordable};
pub use rewriting::rewrite;
pub use router::router;
pub use signing::{border, signing};
pub use tables::tables;
pub use telemetry::tlog;
pub use text_tables::text_tables;
pub use wire::{codec, policies, scanner};

/// A target.
pub type Target = fn(&[u8]);

macro_rules! targets {
    ($($name:ident,)*) => {
        /// All targets, by the names of their programs and folders.
        pub const TARGETS: &[(&str, Target)] = &[$((stringify!($name), $name)),*];
    };
}

targets! {
    anonymize,
    border,
    codec,
    converters,
    dataflash,
    dataflash_tables,
    dataflash_text,
    endpoint,
    log_files,
    policies,
    recordable,
    rewrite,
    router,
    scanner,
    signing,
    tables,
    text_tables,
    tlog,
    xml,
}
