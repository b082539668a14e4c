//! Log formats, without files: bytes in, records out. Reading, mapping and following files is the link crate's.

pub mod dataflash;
pub mod tlog;
