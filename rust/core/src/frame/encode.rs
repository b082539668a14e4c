//! Writing a frame: header, payload and checksum.

use super::{
    FrameError, HEADER_LEN_V2, Header, MAX_FRAME_LEN, MAX_PAYLOAD_LEN, SIGNATURE_LEN, STX_V1,
    STX_V2,
};
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
///
/// The payload is written first. Header, checksum and signature go around it, so nothing is moved.
#[derive(Debug, Clone)]
pub struct FrameBuffer {
    bytes: [u8; MAX_FRAME_LEN],
    start: usize,
    end: usize,
}

/// Where the payload begins. A header of version 1 leaves the bytes in front of it unused.
const PAYLOAD_AT: usize = HEADER_LEN_V2;

impl Default for FrameBuffer {
    #[inline]
    fn default() -> Self {
        Self { bytes: [0; MAX_FRAME_LEN], start: 0, end: 0 }
    }
}

impl FrameBuffer {
    /// Room for the longest payload: zeros, or the previous one.
    #[inline]
    pub fn payload_mut(&mut self) -> &mut [u8] {
        &mut self.bytes[PAYLOAD_AT..PAYLOAD_AT + MAX_PAYLOAD_LEN]
    }

    /// Makes a frame like [`encode`], with the same errors, in place of the previous one.
    #[inline]
    pub fn encode(
        &mut self,
        header: Header,
        payload: &[u8],
        crc_extra: u8,
    ) -> Result<(), FrameError> {
        if let Some(room) = self.payload_mut().get_mut(..payload.len()) {
            room.copy_from_slice(payload);
        }
        self.finish(header, payload.len(), crc_extra)
    }

    /// Makes a frame of the `len` bytes that were written to [`Self::payload_mut`], like [`encode`] and with the same errors.
    #[inline]
    pub fn finish(&mut self, header: Header, len: usize, crc_extra: u8) -> Result<(), FrameError> {
        if len > MAX_PAYLOAD_LEN {
            return Err(FrameError::PayloadTooLong(len));
        }
        let Header { incompat_flags, compat_flags, seq, sysid, compid, msgid, .. } = header;
        let [id0, id1, id2, id3] = msgid.to_le_bytes();
        match header.version {
            WireVersion::V1 if msgid > 0xFF => return Err(FrameError::IdTooLarge(msgid)),
            WireVersion::V2 if id3 != 0 => return Err(FrameError::IdTooLarge(msgid)),
            WireVersion::V1 => {
                let header = [STX_V1, len as u8, seq, sysid, compid, id0];
                self.surround(&header, len, crc_extra);
            }
            WireVersion::V2 => {
                let len = trim_zeros(&self.bytes[PAYLOAD_AT..PAYLOAD_AT + len]).len();
                let (short, flags) = (len as u8, incompat_flags);
                let header =
                    [STX_V2, short, flags, compat_flags, seq, sysid, compid, id0, id1, id2];
                self.surround(&header, len, crc_extra);
            }
        }
        Ok(())
    }

    /// Puts header and checksum around the payload.
    #[inline]
    fn surround<const N: usize>(&mut self, header: &[u8; N], len: usize, crc_extra: u8) {
        let checksum_at = PAYLOAD_AT + len;
        // Of the header by itself: the processor would have to wait for what was just written.
        let register = x25::checksum(&header[1..]);
        let register = x25::accumulate(register, &self.bytes[PAYLOAD_AT..checksum_at]);
        (self.start, self.end) = (PAYLOAD_AT - N, checksum_at);
        self.bytes[self.start..PAYLOAD_AT].copy_from_slice(header);
        self.append(&x25::push(register, crc_extra).to_le_bytes());
    }

    #[inline]
    fn append<const N: usize>(&mut self, bytes: &[u8; N]) {
        self.bytes[self.end..self.end + N].copy_from_slice(bytes);
        self.end += N;
    }

    /// Adds the signature block of a frame that was made with [`IFLAG_SIGNED`] and has none yet.
    #[inline]
    pub fn append_signature(&mut self, block: &[u8; SIGNATURE_LEN]) {
        self.append(block);
    }
}

impl std::ops::Deref for FrameBuffer {
    type Target = [u8];

    #[inline]
    fn deref(&self) -> &[u8] {
        &self.bytes[self.start..self.end]
    }
}

/// `payload` without its trailing zeros, but with its first byte.
#[inline]
pub fn trim_zeros(payload: &[u8]) -> &[u8] {
    let used = payload.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
    &payload[..used.max(1).min(payload.len())]
}
