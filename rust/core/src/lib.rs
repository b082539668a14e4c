//! MAVLink without I/O: bytes to frames to values and back.
//!
//! Nothing here opens a file, reads a clock, starts a thread or knows Python; time and randomness are arguments. Every
//! function takes bytes and gives back an outcome, so that links, log readers, the bridge and the Python extension share
//! one implementation of the protocol.
//!
//! The path of a received byte: [`scan::Scanner`] finds frames in a byte stream ([`stream::FrameStream`] when it arrives
//! in pieces), [`registry::Registry`] knows the messages of a dialect, [`signing`] says whether a frame is genuine,
//! [`router`] where it goes, [`border`] what it goes through there, and [`codec`] turns a payload into values.

#![deny(unsafe_code)]

pub mod anonymize;
pub mod border;
pub mod builtin;
pub mod codec;
pub mod dump_line;
pub mod frame;
pub mod kind_hash;
pub mod log;
pub mod parser;
pub mod peer_slots;
pub mod pyfloat;
pub mod registry;
pub mod router;
pub mod scan;
pub mod sequence;
pub mod signing;
pub mod stream;
pub mod telemetry;
pub mod text;
pub mod unknown;
pub mod x25;

#[cfg(test)]
mod testing;

pub use mavwire_schema as schema;
