//! Writing a frame: header, payload and checksum.

use super::{FrameError, Header, MAX_FRAME_LEN, MAX_PAYLOAD_LEN, SIGNATURE_LEN, STX_V1, STX_V2};
use crate::x25;
use mavwire_schema::WireVersion;

/// Appends a frame to `out`, without a signature block ([`crate::signing::sign`] adds that).
///
/// `payload` has its full length: version 2 drops its trailing zeros but keeps one byte, version 1 sends all of it.
/// `header.payload_len` is ignored; the flags are written as given, in version 2 only.
///
/// # Errors
/// A message id above 255 in version 1 or above 2^24 - 1 in version 2; a payload of more than 255 bytes. Nothing is
/// appended then.
pub fn encode(
    out: &mut Vec<u8>,
    header: Header,
    payload: &[u8],
    crc_extra: u8,
) -> Result<(), FrameError> {
    let mut frame = FrameBuffer::default();
    frame.encode(header, payload, crc_extra)?;
    out.extend_from_slice(&frame);
    Ok(())
}

/// A frame to send, in memory of its own and without an allocation.
#[derive(Debug, Clone)]
pub struct FrameBuffer {
    bytes: [u8; MAX_FRAME_LEN],
    len: usize,
}

impl Default for FrameBuffer {
    #[inline]
    fn default() -> Self {
        Self { bytes: [0; MAX_FRAME_LEN], len: 0 }
    }
}

impl FrameBuffer {
    /// Makes a frame like [`encode`], with the same errors, in place of the previous one.
    #[inline]
    pub fn encode(
        &mut self,
        header: Header,
        payload: &[u8],
        crc_extra: u8,
    ) -> Result<(), FrameError> {
        if payload.len() > MAX_PAYLOAD_LEN {
            return Err(FrameError::PayloadTooLong(payload.len()));
        }
        let Header { incompat_flags, compat_flags, seq, sysid, compid, msgid, .. } = header;
        let [id0, id1, id2, id3] = msgid.to_le_bytes();
        match header.version {
            WireVersion::V1 if msgid > 0xFF => return Err(FrameError::IdTooLarge(msgid)),
            WireVersion::V2 if id3 != 0 => return Err(FrameError::IdTooLarge(msgid)),
            WireVersion::V1 => {
                let header = [STX_V1, payload.len() as u8, seq, sysid, compid, id0];
                self.assemble(&header, payload, crc_extra);
            }
            WireVersion::V2 => {
                let payload = trim_zeros(payload);
                let (len, flags) = (payload.len() as u8, incompat_flags);
                let header = [STX_V2, len, flags, compat_flags, seq, sysid, compid, id0, id1, id2];
                self.assemble(&header, payload, crc_extra);
            }
        }
        Ok(())
    }

    /// Header, payload and checksum.
    #[inline]
    fn assemble<const N: usize>(&mut self, header: &[u8; N], payload: &[u8], crc_extra: u8) {
        // From the parts and not from what was just written, which the processor would have to wait for.
        let register = x25::accumulate(x25::checksum(&header[1..]), payload);
        let checksum = x25::push(register, crc_extra).to_le_bytes();
        self.len = 0;
        self.extend(header);
        self.extend(payload);
        self.extend(&checksum);
    }

    #[inline]
    fn extend(&mut self, bytes: &[u8]) {
        self.bytes[self.len..self.len + bytes.len()].copy_from_slice(bytes);
        self.len += bytes.len();
    }

    /// Adds the signature block of a frame that was made with [`IFLAG_SIGNED`] and has none yet.
    #[inline]
    pub fn append_signature(&mut self, block: &[u8; SIGNATURE_LEN]) {
        self.extend(block);
    }
}

impl std::ops::Deref for FrameBuffer {
    type Target = [u8];

    #[inline]
    fn deref(&self) -> &[u8] {
        &self.bytes[..self.len]
    }
}

/// `payload` without its trailing zeros, but with its first byte.
#[inline]
pub fn trim_zeros(payload: &[u8]) -> &[u8] {
    let used = payload.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
    &payload[..used.max(1).min(payload.len())]
}
