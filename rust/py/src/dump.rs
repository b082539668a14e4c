//! Telemetry logs as text.

pub(crate) mod line;
pub(crate) mod log_dump;
