//! Ports of the operating system as links use them.

pub(crate) mod peers;
pub(crate) mod ports;
pub(crate) mod recording;
pub(crate) mod stream_queue;
pub(crate) mod stream_writer;
pub(crate) mod tls_port;
