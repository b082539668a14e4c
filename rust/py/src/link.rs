//! Links: what mavutil's connections keep of the messages that they receive, live or from a log.

pub(crate) mod filter;
pub(crate) mod instances;
pub(crate) mod live_batch;
pub(crate) mod live_link;
mod live_methods;
pub(crate) mod live_receive;
pub(crate) mod log_index_build;
pub(crate) mod log_link;
mod log_methods;
pub(crate) mod log_receive;
pub(crate) mod log_wanted;
pub(crate) mod message_source;
pub(crate) mod methods;
pub(crate) mod params;
pub(crate) mod plain;
pub(crate) mod receive;
pub(crate) mod replaced;
pub(crate) mod state;
pub(crate) mod system;
pub(crate) mod tracking;
