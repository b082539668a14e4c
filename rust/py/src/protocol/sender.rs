//! The source of outgoing frames: ids, sequence number and signing.

use mavwire_core::frame::{FrameBuffer, Header, IFLAG_SIGNED};
use mavwire_schema::WireVersion;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::protocol::signing::Signing;
use crate::python::calling::Calling;
use crate::python::error::Error;

/// The source of outgoing frames, and how they are signed.
pub(crate) struct Sender<'py> {
    pub(crate) seq: u8,
    pub(crate) sysid: u8,
    pub(crate) compid: u8,
    /// Set if frames shall be signed.
    pub(crate) signing: Option<Bound<'py, Signing>>,
}

impl Sender<'_> {
    /// Makes the frame of the payload that is in it, of `len` bytes.
    pub(crate) fn frame(
        &self,
        frame: &mut FrameBuffer,
        msgid: u32,
        len: usize,
        crc_extra: u8,
        version: WireVersion,
    ) -> PyResult<()> {
        if version == WireVersion::V1 && msgid > 255 {
            Python::attach(|py| header_byte(py, msgid.into()))?; // raises
        }
        let signing = self.signing.as_ref().filter(|_| version == WireVersion::V2);
        let header = Header {
            incompat_flags: if signing.is_some() { IFLAG_SIGNED } else { 0 },
            ..Header::new(version, self.seq, self.sysid, self.compid, msgid)
        };
        frame.finish(header, len, crc_extra).map_err(Error::from)?;
        if let Some(signing) = signing {
            let block = signing.get().sign(frame)?;
            frame.append_signature(&block);
        }
        Ok(())
    }
}

/// An attribute that goes into one header byte.
pub(crate) fn byte(value: &Bound<'_, PyAny>) -> PyResult<u8> {
    match value.extract::<u8>() {
        Ok(byte) => Ok(byte),
        Err(_) => {
            let py = value.py();
            let module = py.import(intern!(py, "struct"))?;
            let packed = module.invoke_method1(intern!(py, "pack"), ("<B", value))?;
            Ok(packed.cast::<PyBytes>()?.as_bytes()[0])
        }
    }
}

/// A number that must fit a byte: the number, or what `struct` says to it.
pub(crate) fn header_byte(py: Python<'_>, value: i64) -> PyResult<u8> {
    u8::try_from(value).or_else(|_| byte(value.into_pyobject(py)?.as_any()))
}
