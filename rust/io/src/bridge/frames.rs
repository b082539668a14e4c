//! Frames as the program around a bridge gets them.

/// A frame among others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FrameInfo {
    /// Bytes of the frame.
    pub len: u16,
    /// Microseconds since 1970.
    pub time: u64,
    /// Number of the link that it came over; see [`Hub::link_name`].
    pub link: u32,
    /// System that sent it.
    pub sysid: u8,
    /// Component that sent it.
    pub compid: u8,
    /// Message id.
    pub msgid: u32,
    /// Index of the message in the dialect; `None` for an unknown id.
    pub index: Option<u16>,
}

/// Frames one behind the other.
#[derive(Debug, Clone, Default)]
pub struct Frames {
    /// Their bytes.
    pub bytes: Vec<u8>,
    /// Their descriptions.
    pub infos: Vec<FrameInfo>,
}

impl Frames {
    #[inline]
    pub(super) fn push(&mut self, frame: &[u8], info: FrameInfo) {
        self.bytes.extend_from_slice(frame);
        self.infos.push(info);
    }

    pub(super) fn clear(&mut self) {
        self.bytes.clear();
        self.infos.clear();
    }

    /// Each with its bytes.
    pub fn iter(&self) -> impl Iterator<Item = (&FrameInfo, &[u8])> {
        let mut at = 0;
        self.infos.iter().map(move |info| {
            let from = at;
            at += usize::from(info.len);
            (info, &self.bytes[from..at])
        })
    }
}

#[cfg(test)]
pub(super) mod testing {
    use super::*;

    /// A frame of each id, of 20 bytes; the dialect knows those below 1,000.
    pub(in crate::bridge) fn frames(msgids: impl IntoIterator<Item = u32>) -> Frames {
        let mut frames = Frames::default();
        for (n, msgid) in msgids.into_iter().enumerate() {
            let (time, index) = (n as u64, (msgid < 1_000).then_some(0));
            let info = FrameInfo { len: 20, time, link: 1, sysid: 1, compid: 1, msgid, index };
            frames.push(&[msgid as u8; 20], info);
        }
        frames
    }
}
