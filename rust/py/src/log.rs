//! Telemetry logs, read record by record.

pub(crate) mod ahead;
pub(crate) mod index;
pub(crate) mod reader;
