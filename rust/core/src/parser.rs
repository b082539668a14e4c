//! The parser with pymavlink's behaviour: bytes in, frames, BAD_DATA and errors out, with the state that programs see.

use std::collections::TryReserveError;

use crate::frame::{
    CHECKSUM_LEN, FrameBytes, FrameError, HEADER_LEN_V1, HEADER_LEN_V2, Header, STX_V2,
};
use crate::registry::{Entry, Registry};
use crate::scan::{Found, Resync, Scanner};

/// Capacity that an idle parser keeps.
const KEEP_CAPACITY: usize = 64 * 1024;
/// `bytes_needed` of a fresh parser: the shortest MAVLink 1 frame.
const SHORTEST_FRAME: usize = 8;

/// Bytes received and not parsed yet, with the scanner that finds the frames in them.
pub struct Parser {
    buffer: Vec<u8>,
    /// Bytes of `buffer` that are parsed.
    parsed: usize,
    /// Unread bytes that must be there before another look can say more than the last one.
    awaited: usize,
    /// Finds the frames.
    pub scanner: Scanner,
    /// Unread bytes at the front that the scanner has gone over as noise: strict parsing takes them one at a time.
    noise_left: usize,
    /// pymavlink's attribute of this name: bytes of the frame that begins, as far as is known.
    pub expected_length: usize,
    /// pymavlink's attribute of this name: the byte before was no start of a frame.
    pub have_prefix_error: bool,
}

/// One step of the parser, with the bytes it took.
pub enum Step {
    /// A frame with a good checksum, or with an unknown message id.
    Frame {
        /// The whole frame.
        bytes: FrameBytes,
        /// Its header.
        header: Header,
        /// Its message; `None` if the id is unknown.
        entry: Option<Entry>,
    },
    /// Bytes that are no good frame.
    Bad {
        /// The bytes.
        bytes: FrameBytes,
        /// Why the frame was rejected; `None` for noise between frames.
        error: Option<FrameError>,
    },
    /// Strict parsing: a byte that starts no frame; `Some` if it is the first of its run.
    BadPrefix(Option<u8>),
    /// Nothing is complete.
    Nothing,
}

fn header_len(stx: u8) -> usize {
    if stx == STX_V2 { HEADER_LEN_V2 } else { HEADER_LEN_V1 }
}

impl Default for Parser {
    fn default() -> Self {
        Self {
            buffer: Vec::new(),
            parsed: 0,
            awaited: 1,
            scanner: Scanner::new(Resync::Skip),
            noise_left: 0,
            expected_length: SHORTEST_FRAME,
            have_prefix_error: false,
        }
    }
}

impl Parser {
    /// How parsing goes on after damage.
    pub fn resync(&self) -> Resync {
        self.scanner.policy()
    }

    /// Changes how parsing goes on after damage.
    pub fn set_resync(&mut self, resync: Resync) {
        self.scanner = Scanner::new(resync);
        self.noise_left = 0;
        self.awaited = 1;
    }

    /// Bytes that are not parsed yet.
    pub fn unread(&self) -> &[u8] {
        &self.buffer[self.parsed..]
    }

    /// Puts `bytes` in place of the unread ones.
    pub fn replace(&mut self, bytes: &[u8]) {
        self.buffer = bytes.to_vec();
        self.parsed = 0;
        self.restart();
    }

    /// Goes over unread bytes.
    pub fn skip(&mut self, bytes: usize) {
        self.parsed = self.parsed.saturating_add(bytes).min(self.buffer.len());
        self.restart();
    }

    fn restart(&mut self) {
        self.scanner.reset();
        self.noise_left = 0;
        self.awaited = 1;
    }

    /// Forgets the bytes of a frame whose rest will not come, and returns their number.
    pub fn clear(&mut self) -> usize {
        let dropped = self.unread().len();
        self.replace(b"");
        self.expected_length = SHORTEST_FRAME;
        dropped
    }

    /// pymavlink's `bytes_needed()`: how many bytes to read next.
    pub fn bytes_needed(&self) -> usize {
        self.expected_length.saturating_sub(self.unread().len()).max(1)
    }

    /// As `push`, for input of any length: says so where there is no memory for it.
    pub fn try_push(&mut self, bytes: &[u8]) -> Result<bool, TryReserveError> {
        self.drop_parsed();
        self.buffer.try_reserve(bytes.len())?;
        Ok(self.push(bytes))
    }

    /// Removes the parsed bytes once they are more than half of the buffer, so that each byte is moved once on average.
    #[inline]
    fn drop_parsed(&mut self) {
        if self.parsed > self.buffer.len() / 2 {
            self.buffer.drain(..self.parsed);
            self.parsed = 0;
        }
    }

    /// Takes input; true if it is worth a look now.
    #[inline]
    pub fn push(&mut self, bytes: &[u8]) -> bool {
        self.drop_parsed();
        match bytes {
            &[byte] => self.buffer.push(byte),
            _ => self.buffer.extend_from_slice(bytes),
        }
        self.may_hold_frame()
    }

    /// Whether enough bytes are buffered to go on parsing.
    #[inline]
    pub fn may_hold_frame(&self) -> bool {
        self.buffer.len() - self.parsed >= self.awaited
    }

    /// Lets go of memory that a burst needed.
    pub fn tidy(&mut self) {
        if self.parsed == self.buffer.len() {
            self.buffer.clear();
            self.parsed = 0;
        }
        if self.buffer.capacity() > KEEP_CAPACITY && self.unread().len() < KEEP_CAPACITY / 2 {
            self.buffer = self.unread().to_vec();
            self.parsed = 0;
        }
    }

    fn take(&mut self, len: usize) -> FrameBytes {
        let bytes = FrameBytes::from(&self.unread()[..len]);
        self.parsed += len;
        bytes
    }

    /// The good or rejected frame at the front of bytes outside the parser, with its length. The parser must be empty
    /// and its policy `Skip`. All other bytes have to go through the buffer.
    pub fn look(&mut self, bytes: &[u8], registry: &Registry) -> Option<(Step, usize)> {
        if self.resync() != Resync::Skip {
            return None;
        }
        let &first = bytes.first()?;
        let expected = self.expected_length;
        let (step, len) = match self.scanner.next(bytes, registry) {
            Found::Frame { len, header, entry } => {
                (Step::Frame { bytes: FrameBytes::from(&bytes[..len]), header, entry }, len)
            }
            Found::Rejected { len, error } if len >= expected => {
                (Step::Bad { bytes: FrameBytes::from(&bytes[..len]), error: Some(error) }, len)
            }
            _ => return None,
        };
        self.passed(first);
        Some((step, len))
    }

    /// A frame that begins with `stx` was taken past the parser, which holds no bytes.
    #[inline]
    pub fn passed(&mut self, stx: u8) {
        self.have_prefix_error = false;
        self.expected_length = header_len(stx) + CHECKSUM_LEN;
    }

    /// Takes the good frame of a known message off the front, if there is one: the index of its message, its length,
    /// and the bytes from its start on.
    #[inline]
    pub fn take_good(&mut self, registry: &Registry) -> Option<(u16, usize, &[u8])> {
        // Noise starts no good frame.
        let unread = self.buffer.get(self.parsed..).filter(|_| self.noise_left == 0)?;
        let (len, entry) = self.scanner.next_good(unread, registry)?;
        self.parsed += len;
        self.awaited = 1;
        self.have_prefix_error = false;
        self.expected_length = header_len(unread[0]) + CHECKSUM_LEN;
        Some((entry.index, len, unread))
    }

    /// The next thing in the unread bytes.
    pub fn step(&mut self, registry: &Registry, robust: bool) -> Step {
        let unread = &self.buffer[self.parsed..];
        if unread.is_empty() {
            return Step::Nothing;
        }
        let found = match self.noise_left {
            0 => self.scanner.next(unread, registry),
            len => Found::Noise { len },
        };
        self.take_found(found, robust)
    }

    /// The input is at its end, at least for now, and within a frame. Under `Rescan` a good frame behind its start shows
    /// that it is none; then it is taken off.
    pub fn step_at_end(&mut self, registry: &Registry, robust: bool) -> Step {
        let unread = &self.buffer[self.parsed..];
        if self.resync() == Resync::Skip || unread.is_empty() {
            return Step::Nothing;
        }
        let mut scanner = self.scanner.clone();
        match scanner.next_at_end(unread, registry) {
            found @ Found::Rejected { len, .. } if len < unread.len() => {
                self.scanner = scanner;
                self.take_found(found, robust)
            }
            _ => Step::Nothing,
        }
    }

    /// Takes what was found off the front and keeps the state that users see.
    fn take_found(&mut self, found: Found, robust: bool) -> Step {
        let unread = &self.buffer[self.parsed..];
        let Some(&first) = unread.first() else {
            self.awaited = 1;
            return Step::Nothing;
        };
        self.awaited = if let Found::Incomplete { needed } = found { needed } else { 1 };
        match found {
            Found::Noise { len } => {
                if robust {
                    self.noise_left = 0;
                    self.expected_length = SHORTEST_FRAME;
                    return Step::Bad { bytes: self.take(len), error: None };
                }
                self.parsed += 1;
                self.noise_left = len - 1;
                let first_of_run = !std::mem::replace(&mut self.have_prefix_error, true);
                Step::BadPrefix(first_of_run.then_some(first))
            }
            Found::Incomplete { needed } => {
                self.have_prefix_error = false;
                if unread.len() >= 3 {
                    self.expected_length = needed;
                }
                Step::Nothing
            }
            Found::Rejected { len, error } => {
                self.have_prefix_error = false;
                self.expected_length = header_len(first) + CHECKSUM_LEN;
                Step::Bad { bytes: self.take(len), error: Some(error) }
            }
            Found::Frame { len, header, entry } => {
                self.have_prefix_error = false;
                self.expected_length = header_len(first) + CHECKSUM_LEN;
                Step::Frame { bytes: self.take(len), header, entry }
            }
        }
    }
}
