//! The state of one connection: parsing, packing, sending and signing.

pub(crate) mod acceptance;
pub(crate) mod mavlink;
mod mavlink_methods;
mod message_methods;
pub(crate) mod pack;
pub(crate) mod parse;
pub(crate) mod peer_check;
pub(crate) mod send;
pub(crate) mod sender;
pub(crate) mod sending;
pub(crate) mod sequence_gaps;
pub(crate) mod signing;
pub(crate) mod status_texts;
pub(crate) mod x25;
