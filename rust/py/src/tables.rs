//! Logs as tables, files and other logs.

pub(crate) mod align;
pub(crate) mod column_view;
pub(crate) mod columns;
pub(crate) mod convert;
pub(crate) mod dataflash;
pub(crate) mod dates;
pub(crate) mod decompress;
pub(crate) mod identify;
pub(crate) mod lake_file;
pub(crate) mod open_log;
pub(crate) mod rewrite;
pub(crate) mod source;
pub(crate) mod table;
