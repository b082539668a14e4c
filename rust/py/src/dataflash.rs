//! Dataflash logs as Python objects: `DFMessage`, what makes it cheap, and the reader below `DFReader`'s classes.

pub(crate) mod clock;
pub(crate) mod message;
mod message_methods;
pub(crate) mod reader;
mod render;
pub(crate) mod shape;
mod shape_methods;
mod state;
mod value;
