//! What every part needs of the interpreter: calls, interned names, numbers, lists and errors.

pub(crate) mod calling;
pub(crate) mod file_error;
#[macro_use]
pub(crate) mod intern;
pub(crate) mod lists;
pub(crate) mod number;
pub(crate) mod raw_function;
