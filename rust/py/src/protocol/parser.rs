//! The parser of a link together with the link's signing, behind one lock.

use std::ops::{Deref, DerefMut};

use mavwire_core::parser::Parser;
use pyo3::Py;

use crate::protocol::signing::Signing;

/// What a link has received and not parsed yet, and what verifies it.
pub(crate) struct LinkParser {
    parser: Parser,
    /// Here because every frame that leaves the parser needs it.
    pub(crate) signing: Option<Py<Signing>>,
}

impl LinkParser {
    pub(crate) fn new() -> Self {
        Self { parser: Parser::new(), signing: None }
    }

    /// Frames have to be shown to signing.
    pub(crate) fn checks_signatures(&self) -> bool {
        self.signing.as_ref().is_some_and(|signing| signing.get().has_key())
    }
}

impl Deref for LinkParser {
    type Target = Parser;

    fn deref(&self) -> &Parser {
        &self.parser
    }
}

impl DerefMut for LinkParser {
    fn deref_mut(&mut self) -> &mut Parser {
        &mut self.parser
    }
}
