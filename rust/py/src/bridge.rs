//! Bridges, which run without the interpreter.

pub(crate) mod batch;
pub(crate) mod core;
pub(crate) mod options;
pub(crate) mod stats;
