//! The proof of a sender for bytes that a program does not receive as messages of its link: it parses them itself, or hands
//! them on.

use mavwire_core::frame::FrameRef;
use mavwire_core::scan::{Found, Resync, Scanner};
use pyo3::prelude::*;

use crate::protocol::mavlink::MAVLink;
use crate::protocol::parse::obey_ignore_checksum;

#[pymethods]
impl MAVLink {
    /// Whether `data` holds a message of the dialect that proves its sender: any good one, or with a key a genuine one that is
    /// newer than all that was received or looked at. The look changes nothing for the parser, which may receive it later.
    fn _holds_trusted(slf: &Bound<'_, Self>, data: &[u8]) -> PyResult<bool> {
        obey_ignore_checksum(slf)?;
        let this = slf.get();
        let signing = this.signing(slf.py()).filter(|signing| signing.get().has_key());
        let is_trusted = |bytes: &[u8]| match &signing {
            Some(signing) => FrameRef::parse(bytes).is_ok_and(|frame| signing.get().look(&frame)),
            None => true,
        };
        let mut scanner = Scanner::new(Resync::Skip);
        scanner.ignore_checksum = this.parser().scanner.ignore_checksum;
        let registry = &this.dialect.get().registry;
        let (mut rest, mut found_trusted) = (data, false);
        loop {
            let len = match scanner.next(rest, registry) {
                Found::Frame { len, entry, .. } => {
                    // Each is looked at: what another one sends again is old then.
                    found_trusted |= entry.is_some() && is_trusted(&rest[..len]);
                    len
                }
                Found::Rejected { len, .. } | Found::Noise { len } => len,
                Found::Incomplete { .. } => return Ok(found_trusted),
            };
            rest = &rest[len..];
        }
    }
}
