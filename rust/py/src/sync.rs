//! Locks, and values that several threads share.

pub(crate) mod exclusive;
pub(crate) mod gil_yield;
pub(crate) mod lock;
pub(crate) mod shared;
pub(crate) mod slot;
pub(crate) mod thread_lock;
pub(crate) mod thread_number;
pub(crate) mod thread_owner;
