//! One frame: its header, its parts and how to write it (MAVLink guide, "Serialization").
//!
//! ```text
//! v1  FE len seq sysid compid msgid8                                payload[len] crc16
//! v2  FD len incompat_flags compat_flags seq sysid compid msgid24le payload[len] crc16 [signature13]
//! ```
//!
//! The checksum covers every byte between STX and itself, then `crc_extra`; the signature block follows it.

mod bytes;
mod encode;

pub use bytes::FrameBytes;
pub use encode::{FrameBuffer, encode, trim_zeros};

use crate::x25;
use mavwire_schema::WireVersion;

/// First byte of a MAVLink 1 frame.
pub const STX_V1: u8 = 0xFE;
/// First byte of a MAVLink 2 frame.
pub const STX_V2: u8 = 0xFD;
/// Bytes before the payload of a MAVLink 1 frame, STX included.
pub const HEADER_LEN_V1: usize = 6;
/// Bytes before the payload of a MAVLink 2 frame, STX included.
pub const HEADER_LEN_V2: usize = 10;
/// Bytes of the checksum.
pub const CHECKSUM_LEN: usize = 2;
/// Bytes of the signature block: `link_id`, 48-bit timestamp, 48-bit digest.
pub const SIGNATURE_LEN: usize = 13;
/// Longest payload.
pub const MAX_PAYLOAD_LEN: usize = 255;
/// Longest frame: MAVLink 2, full payload, signed.
pub const MAX_FRAME_LEN: usize = HEADER_LEN_V2 + MAX_PAYLOAD_LEN + CHECKSUM_LEN + SIGNATURE_LEN;
/// Bit of `incompat_flags`: a signature block follows the checksum. The only bit defined so far.
pub const IFLAG_SIGNED: u8 = 0x01;

/// Where the `incompat_flags` of a MAVLink 2 frame stand.
pub(crate) const INCOMPAT_FLAGS_AT: usize = 2;

/// Why bytes are not a valid frame. The texts are those of pymavlink, which programs compare.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum FrameError {
    /// A frame shorter than its header.
    #[error("Unable to unpack MAVLink header: unpack requires a buffer of {needed} bytes")]
    ShortHeader {
        /// Bytes of the header.
        needed: u8,
    },
    /// A whole frame was expected and starts with another byte.
    #[error("invalid MAVLink prefix '{0:#x}'")]
    InvalidStx(u8),
    /// A byte of a stream that starts no frame.
    #[error("invalid MAVLink prefix '{0}'")]
    BadPrefix(u8),
    /// The length byte and the length of the buffer disagree.
    #[error(
        "invalid MAVLink message length. Got {got} expected {expected}, msgId={msgid} headerlen={header_len}"
    )]
    LengthMismatch {
        /// Payload bytes there are; negative where the buffer ends before the checksum.
        got: i64,
        /// The length byte.
        expected: u8,
        /// Message id.
        msgid: u32,
        /// Bytes of the header.
        header_len: u8,
    },
    /// The checksum is wrong.
    #[error("invalid MAVLink CRC in msgID {msgid} 0x{received:04x} should be 0x{calculated:04x}")]
    BadChecksum {
        /// Message id.
        msgid: u32,
        /// Checksum in the frame.
        received: u16,
        /// Checksum of the bytes in the frame.
        calculated: u16,
    },
    /// `incompat_flags` has bits that this protocol version does not define, so that the frame must be dropped.
    #[error("invalid incompat_flags {0:#x} 0xfd 12")]
    IncompatFlags(u8),
    /// The frame is not signed, or not with the key that is set.
    #[error("Invalid signature")]
    InvalidSignature,
    /// An id that the dialect does not define, with a checksum that no `crc_extra`, or not the one seen before, explains.
    /// Only the re-scanning scanner judges unknown ids.
    #[error("implausible frame of unknown msgID {msgid}")]
    ImplausibleUnknown {
        /// Message id.
        msgid: u32,
    },
    /// The input ended inside a frame.
    #[error("incomplete MAVLink frame: {available} of {needed} bytes")]
    Truncated {
        /// Bytes of the whole frame.
        needed: u16,
        /// Bytes there are.
        available: u16,
    },
    /// A message id that MAVLink 1 cannot carry.
    #[error("message id {0} does not fit a MAVLink 1 frame")]
    IdTooLarge(u32),
    /// A payload of more than 255 bytes.
    #[error("payload of {0} bytes is longer than 255")]
    PayloadTooLong(usize),
}

/// The header of either wire version.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Header {
    /// Wire version, from STX.
    pub version: WireVersion,
    /// Payload bytes in the frame.
    pub payload_len: u8,
    /// Flags a receiver must understand; 0 in version 1.
    pub incompat_flags: u8,
    /// Flags a receiver may ignore; 0 in version 1.
    pub compat_flags: u8,
    /// Sequence number.
    pub seq: u8,
    /// Sending system.
    pub sysid: u8,
    /// Sending component.
    pub compid: u8,
    /// Message id: 8 bits in version 1, 24 in version 2.
    pub msgid: u32,
}

impl Header {
    /// A header to encode a frame with: no flags, and a length that is filled in when the payload is known.
    pub const fn new(version: WireVersion, seq: u8, sysid: u8, compid: u8, msgid: u32) -> Self {
        Self {
            version,
            payload_len: 0,
            incompat_flags: 0,
            compat_flags: 0,
            seq,
            sysid,
            compid,
            msgid,
        }
    }

    /// Reads the header at the front of `bytes`; `None` where they are too few or do not start with STX.
    #[inline(always)] // a header that a call returns in memory has to be waited for
    pub fn parse(bytes: &[u8]) -> Option<Self> {
        match bytes.first() {
            Some(&STX_V2) => bytes.first_chunk().map(Self::parse_v2),
            Some(&STX_V1) => bytes.first_chunk().map(Self::parse_v1),
            _ => None,
        }
    }

    #[inline]
    fn parse_v2(b: &[u8; HEADER_LEN_V2]) -> Self {
        Self {
            version: WireVersion::V2,
            payload_len: b[1],
            incompat_flags: b[2],
            compat_flags: b[3],
            seq: b[4],
            sysid: b[5],
            compid: b[6],
            msgid: u32::from_le_bytes([b[7], b[8], b[9], 0]),
        }
    }

    #[inline]
    #[allow(clippy::trivially_copy_pass_by_ref)] // the twin of parse_v2
    fn parse_v1(b: &[u8; HEADER_LEN_V1]) -> Self {
        Self {
            version: WireVersion::V1,
            payload_len: b[1],
            incompat_flags: 0,
            compat_flags: 0,
            seq: b[2],
            sysid: b[3],
            compid: b[4],
            msgid: b[5].into(),
        }
    }

    /// Bytes of the header on the wire, STX included.
    #[inline]
    #[allow(clippy::len_without_is_empty)] // a header is never empty
    pub fn len(&self) -> usize {
        match self.version {
            WireVersion::V1 => HEADER_LEN_V1,
            WireVersion::V2 => HEADER_LEN_V2,
        }
    }

    /// Bytes of the whole frame, signature included.
    #[inline]
    pub fn frame_len(&self) -> usize {
        let signature = if self.is_signed() { SIGNATURE_LEN } else { 0 };
        self.len() + usize::from(self.payload_len) + CHECKSUM_LEN + signature
    }

    /// A signature block follows the checksum.
    #[inline]
    pub fn is_signed(&self) -> bool {
        self.incompat_flags & IFLAG_SIGNED != 0
    }
}

/// Whole length of the frame that starts at the front of `bytes`; `None` where fewer than three bytes are there or the
/// first one is not STX.
#[inline]
pub fn claimed_len(bytes: &[u8]) -> Option<usize> {
    let &[stx, payload_len, flags, ..] = bytes else { return None };
    let fixed = match stx {
        STX_V1 => HEADER_LEN_V1 + CHECKSUM_LEN,
        STX_V2 if flags & IFLAG_SIGNED != 0 => HEADER_LEN_V2 + CHECKSUM_LEN + SIGNATURE_LEN,
        STX_V2 => HEADER_LEN_V2 + CHECKSUM_LEN,
        _ => return None,
    };
    Some(fixed + usize::from(payload_len))
}

/// Pieces of bytes that were sent: frames side by side, and what starts no frame as one piece.
pub fn frames(mut bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    std::iter::from_fn(move || {
        let len = claimed_len(bytes).unwrap_or(bytes.len()).min(bytes.len());
        let (frame, rest) = bytes.split_at(len);
        bytes = rest;
        (!frame.is_empty()).then_some(frame)
    })
}

/// The signature block of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SignatureRef<'a> {
    /// Link of the sender.
    pub link_id: u8,
    /// Units of 10 microseconds since 2015-01-01 00:00 UTC, 48 bits.
    pub timestamp: u64,
    /// First six bytes of the SHA-256 digest.
    pub digest: &'a [u8; 6],
}

/// A complete frame in someone else's buffer. Its length is right; whether checksum and signature are is not implied.
#[derive(Debug, Clone, Copy)]
pub struct FrameRef<'a> {
    bytes: &'a [u8],
    header: Header,
}

impl<'a> FrameRef<'a> {
    /// Takes `bytes` as exactly one frame.
    ///
    /// # Errors
    /// Not STX, shorter than the header, or not as long as the length byte says.
    #[inline]
    pub fn parse(bytes: &'a [u8]) -> Result<Self, FrameError> {
        // A buffer that starts with neither STX is measured as version 2, and refused for its length before its STX.
        let v1 = bytes.first() == Some(&STX_V1);
        let header_len = if v1 { HEADER_LEN_V1 } else { HEADER_LEN_V2 };
        if bytes.len() < header_len {
            return Err(FrameError::ShortHeader { needed: header_len as u8 });
        }
        let header = Header::parse(bytes).ok_or(FrameError::InvalidStx(bytes[0]))?;
        if header.frame_len() != bytes.len() {
            let surplus = bytes.len() as i64 - header.frame_len() as i64;
            return Err(FrameError::LengthMismatch {
                got: i64::from(header.payload_len) + surplus,
                expected: header.payload_len,
                msgid: header.msgid,
                header_len: header_len as u8,
            });
        }
        Ok(Self { bytes, header })
    }

    /// The whole frame, as received.
    #[inline]
    pub fn bytes(&self) -> &'a [u8] {
        self.bytes
    }

    /// The header.
    #[inline]
    pub fn header(&self) -> &Header {
        &self.header
    }

    #[inline]
    fn payload_end(&self) -> usize {
        self.header.len() + usize::from(self.header.payload_len)
    }

    /// The payload, as long as it was sent (trailing zeros may be missing).
    #[inline]
    pub fn payload(&self) -> &'a [u8] {
        &self.bytes[self.header.len()..self.payload_end()]
    }

    /// The checksum in the frame.
    #[inline]
    pub fn checksum(&self) -> u16 {
        let end = self.payload_end();
        u16::from_le_bytes([self.bytes[end], self.bytes[end + 1]])
    }

    /// The bytes that the checksum covers, to be followed by `crc_extra`.
    #[inline]
    pub fn crc_region(&self) -> &'a [u8] {
        &self.bytes[1..self.payload_end()]
    }

    /// The checksum that the frame should carry.
    #[inline]
    pub fn calculated_checksum(&self, crc_extra: u8) -> u16 {
        x25::push(x25::checksum(self.crc_region()), crc_extra)
    }

    /// The signature block, where the frame has one.
    pub fn signature(&self) -> Option<SignatureRef<'a>> {
        if !self.header.is_signed() {
            return None;
        }
        let (&[link_id, t0, t1, t2, t3, t4, t5], digest) =
            self.bytes.last_chunk::<SIGNATURE_LEN>()?.split_first_chunk()?;
        let timestamp = u64::from_le_bytes([t0, t1, t2, t3, t4, t5, 0, 0]);
        Some(SignatureRef { link_id, timestamp, digest: digest.first_chunk()? })
    }
}

#[cfg(test)]
mod tests;
