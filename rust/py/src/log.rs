//! Telemetry logs, read record by record.

pub(crate) mod reader;
