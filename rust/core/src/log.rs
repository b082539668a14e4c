//! Log formats, without files: bytes in, records out. Reading, mapping and following files is the io crate's.

pub mod dataflash;
pub mod kind;
pub mod tlog;
