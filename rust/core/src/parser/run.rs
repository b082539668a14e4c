//! Good frames of known messages that the parser hands over together.

/// Good frames of known messages that follow each other.
#[derive(Default)]
pub struct Run {
    /// Message index and length of each frame.
    pub(super) frames: Vec<(u16, u16)>,
    /// The frames from `start` on; bytes before and after them are not part of the run.
    pub(super) bytes: Vec<u8>,
    pub(super) start: usize,
    /// Number of signed frames.
    pub signed: u64,
}

impl Run {
    /// Number of frames.
    pub fn len(&self) -> usize {
        self.frames.len()
    }

    /// There are no frames.
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }

    /// Each frame's message index and length, with the bytes from its start on.
    #[inline]
    pub fn iter(&self) -> impl Iterator<Item = (u16, usize, &[u8])> {
        let mut rest = &self.bytes[self.start..];
        self.frames.iter().map(move |&(index, len)| {
            let at = rest;
            rest = &rest[usize::from(len)..];
            (index, usize::from(len), at)
        })
    }

    pub(super) fn clear(&mut self) {
        self.frames.clear();
        self.bytes.clear();
        self.start = 0;
        self.signed = 0;
    }
}
