//! Telemetry logs as text.

pub(crate) mod log_dump;
