//! Message objects: a frame's bytes and a definition; fields are decoded when they are read.

pub(crate) mod classes;
pub(crate) mod create;
pub(crate) mod descriptors;
pub(crate) mod dict;
pub(crate) mod encode;
pub(crate) mod extra;
pub(crate) mod info;
pub(crate) mod meta;
pub(crate) mod object;
pub(crate) mod text;
pub(crate) mod values;
