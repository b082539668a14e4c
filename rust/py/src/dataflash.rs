//! Dataflash logs as Python objects: `DFMessage`, what makes it cheap, and the reader below `DFReader`'s classes.

pub(crate) mod clock;
pub(crate) mod message;
mod message_methods;
mod names;
pub(crate) mod reader;
mod render;
pub(crate) mod shape;
mod state;
mod value;
