//! The interpreter as every part needs it: calls, interned names, numbers, lists and errors.

pub(crate) mod calling;
pub(crate) mod collector;
pub(crate) mod error;
pub(crate) mod instance_dict;
#[macro_use]
pub(crate) mod intern;
pub(crate) mod lists;
#[macro_use]
pub(crate) mod new;
pub(crate) mod number;
pub(crate) mod own_methods;
#[macro_use]
pub(crate) mod properties;
pub(crate) mod raw_function;
