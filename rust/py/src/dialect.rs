//! Dialects: the registry that scans frames, and the Python class of each message.

pub(crate) mod definition_file;
pub(crate) mod describe;
pub(crate) mod registry;
