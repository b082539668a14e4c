//! The bytes of one frame inside a message object.
//!
//! Nearly all telemetry frames, signed ones too, are shorter than 63 bytes and lie in the object itself, which spares an
//! allocation for each message; longer ones are on the heap.

use std::ops::Deref;

/// Longest frame that fits into the object: tag, length and bytes fill 64.
const INLINE: usize = 62;

/// A frame's bytes, owned.
#[derive(Clone)]
pub enum FrameBytes {
    /// In the object itself. Only the first `len` bytes have a meaning.
    Inline {
        /// Bytes of the frame.
        len: u8,
        /// The frame, and bytes behind it.
        bytes: [u8; INLINE],
    },
    /// In memory of its own.
    Heap(Box<[u8]>),
}

impl FrameBytes {
    /// No bytes.
    pub const fn empty() -> Self {
        Self::Inline { len: 0, bytes: [0; INLINE] }
    }

    /// The first `len` bytes of a stream, if they fit and enough bytes follow: a copy of fixed size is quicker.
    #[inline(always)] // so that the bytes are copied to where they stay
    pub fn inline(stream: &[u8], len: usize) -> Option<Self> {
        let bytes = *stream.first_chunk::<INLINE>()?;
        (len <= INLINE).then_some(Self::Inline { len: len as u8, bytes })
    }
}

impl From<&[u8]> for FrameBytes {
    #[inline]
    fn from(frame: &[u8]) -> Self {
        if frame.len() > INLINE {
            return Self::Heap(frame.into());
        }
        let mut bytes = [0; INLINE];
        bytes[..frame.len()].copy_from_slice(frame);
        Self::Inline { len: frame.len() as u8, bytes }
    }
}

impl Deref for FrameBytes {
    type Target = [u8];

    #[inline]
    fn deref(&self) -> &[u8] {
        match self {
            Self::Inline { len, bytes } => &bytes[..usize::from(*len)],
            Self::Heap(bytes) => bytes,
        }
    }
}
