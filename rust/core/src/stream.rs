//! A byte stream that arrives in pieces: a scanner with just enough buffer.
//!
//! [`FrameStream::feed`] scans a caller's chunk in place. Only the frame that straddles two chunks is copied, so that the
//! memory kept between chunks is at most one frame's worth of bytes.

use crate::registry::Registry;
use crate::scan::{Found, Resync, Scanner};

/// An outcome of the scanner with its bytes. `found` is never [`Found::Incomplete`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Piece<'a> {
    /// The bytes that the outcome is about.
    pub bytes: &'a [u8],
    /// The scanner's outcome for these bytes.
    pub found: Found,
}

/// A scanner and its unread bytes.
#[derive(Debug, Clone)]
pub struct FrameStream {
    scanner: Scanner,
    buffer: Vec<u8>,
    /// `buffer[start..]` is unread.
    start: usize,
}

impl FrameStream {
    /// An empty stream.
    pub fn new(policy: Resync) -> Self {
        Self { scanner: Scanner::new(policy), buffer: Vec::new(), start: 0 }
    }

    /// See [`Scanner::accept_unverified`].
    #[must_use]
    pub fn with_unverified(mut self, accept: bool) -> Self {
        self.scanner.accept_unverified = accept;
        self
    }

    /// The next piece where no more bytes will come (see [`Scanner::next_at_end`]).
    pub fn next_at_end(&mut self, registry: &Registry) -> Option<Piece<'_>> {
        let found = self.scanner.next_at_end(&self.buffer[self.start..], registry);
        self.take(found)
    }

    /// Scans `chunk` in place behind the buffered bytes. Dropping the result buffers what it has not handed out.
    pub fn feed<'a>(&'a mut self, chunk: &'a [u8]) -> Feed<'a> {
        if self.start > 0 {
            self.buffer.drain(..self.start);
            self.start = 0;
        }
        let carried = self.buffer.len();
        Feed { stream: self, chunk, at: 0, carried }
    }

    /// Number of unread bytes.
    pub fn buffered(&self) -> usize {
        self.buffer.len() - self.start
    }

    /// The unread bytes.
    pub fn unread(&self) -> &[u8] {
        &self.buffer[self.start..]
    }

    /// Forgets unread bytes. The definitions that senders use are still known.
    pub fn clear(&mut self) {
        self.scanner.restart();
        self.buffer = Vec::new();
        self.start = 0;
    }

    fn take(&mut self, found: Found) -> Option<Piece<'_>> {
        let from = self.start;
        self.start += consumed(&found)?;
        Some(Piece { bytes: &self.buffer[from..self.start], found })
    }
}

/// Bytes that an outcome takes off the stream; `None` for none.
fn consumed(found: &Found) -> Option<usize> {
    match *found {
        Found::Frame { len, .. } | Found::Noise { len } | Found::Rejected { len, .. } => Some(len),
        Found::Incomplete { .. } => None,
    }
}

/// A chunk being scanned in place.
#[derive(Debug)]
pub struct Feed<'a> {
    stream: &'a mut FrameStream,
    chunk: &'a [u8],
    /// `chunk[..at]` is handed out or copied into the stream's buffer.
    at: usize,
    /// Length of the buffer's part that came before this chunk.
    carried: usize,
}

impl Feed<'_> {
    /// The next piece; `None` when the chunk is used up.
    pub fn next(&mut self, registry: &Registry) -> Option<Piece<'_>> {
        loop {
            let stream = &mut *self.stream;
            if stream.start >= self.carried {
                // The rest of the buffer was copied from the chunk: continue in the chunk there.
                self.at -= stream.buffered();
                stream.buffer.clear();
                (stream.start, self.carried) = (0, 0);
                let found = stream.scanner.next(&self.chunk[self.at..], registry);
                let from = self.at;
                self.at += consumed(&found)?;
                return Some(Piece { bytes: &self.chunk[from..self.at], found });
            }
            let found = stream.scanner.next(&stream.buffer[stream.start..], registry);
            if let Found::Incomplete { needed } = found {
                let missing = needed.saturating_sub(stream.buffered()).max(1);
                let end = self.chunk.len().min(self.at + missing);
                if end == self.at {
                    return None;
                }
                stream.buffer.extend_from_slice(&self.chunk[self.at..end]);
                self.at = end;
            } else {
                return self.stream.take(found);
            }
        }
    }
}

impl Drop for Feed<'_> {
    fn drop(&mut self) {
        self.stream.buffer.extend_from_slice(&self.chunk[self.at..]);
        self.at = self.chunk.len();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{HEARTBEAT_V1, HEARTBEAT_V2, noise, registry};

    fn input() -> Vec<u8> {
        let mut input = Vec::new();
        for n in 0..200_u8 {
            input.extend_from_slice(if n % 2 == 0 { &HEARTBEAT_V2 } else { &HEARTBEAT_V1 });
            input.extend(noise(usize::from(n % 7), n.into()));
            if n % 31 == 0 {
                input.extend([0xFE; 300]);
            }
        }
        input
    }

    type Collected = (Vec<Vec<u8>>, Vec<u8>);

    /// Frames, and all bytes that came out.
    fn collect((frames, bytes): &mut Collected, piece: Piece<'_>) {
        bytes.extend_from_slice(piece.bytes);
        if matches!(piece.found, Found::Frame { .. }) {
            frames.push(piece.bytes.to_vec());
        }
    }

    fn run(policy: Resync, input: &[u8], chunk: usize) -> Collected {
        let registry = registry();
        let mut stream = FrameStream::new(policy);
        let mut collected = Collected::default();
        for chunk in input.chunks(chunk) {
            let mut feed = stream.feed(chunk);
            while let Some(piece) = feed.next(&registry) {
                collect(&mut collected, piece);
            }
            drop(feed);
            assert!(stream.buffered() < 280);
        }
        collected.1.extend_from_slice(stream.unread());
        collected
    }

    #[test]
    fn r22_any_chunks_give_the_same_frames() {
        let input = input();
        for policy in [Resync::Skip, Resync::Rescan] {
            let whole = run(policy, &input, input.len());
            assert!(whole.0.len() > 100);
            for chunk in (1..80).chain([279, 280, 281, 1000]) {
                let (frames, bytes) = run(policy, &input, chunk);
                assert!(frames == whole.0, "{policy:?} chunk {chunk}");
                assert!(bytes == input, "{policy:?} chunk {chunk}");
            }
        }
    }

    #[test]
    fn a_feed_dropped_early_keeps_the_rest() {
        let registry = registry();
        let mut stream = FrameStream::new(Resync::Skip);
        drop(stream.feed(&HEARTBEAT_V2[..5]));
        let chunk = [&HEARTBEAT_V2[5..], &HEARTBEAT_V1, &HEARTBEAT_V2].concat();
        let mut feed = stream.feed(&chunk);
        assert_eq!(feed.next(&registry).map(|p| p.bytes.to_vec()), Some(HEARTBEAT_V2.to_vec()));
        drop(feed);
        let mut feed = stream.feed(&[]);
        assert_eq!(feed.next(&registry).map(|p| p.bytes.to_vec()), Some(HEARTBEAT_V1.to_vec()));
        assert_eq!(feed.next(&registry).map(|p| p.bytes.to_vec()), Some(HEARTBEAT_V2.to_vec()));
        assert_eq!(feed.next(&registry), None);
    }

    #[test]
    fn r21_memory_between_chunks_is_bounded() {
        let registry = registry();
        for policy in [Resync::Skip, Resync::Rescan] {
            let mut stream = FrameStream::new(policy);
            let big = HEARTBEAT_V2.repeat(400_000);
            for chunk in big.chunks(1_000_003) {
                let mut feed = stream.feed(chunk);
                while feed.next(&registry).is_some() {}
                drop(feed);
                assert!(stream.buffer.capacity() <= 1024);
                assert!(stream.buffered() < 21);
            }
        }
    }

    #[test]
    fn the_end_of_a_stream_frees_frames_behind_a_false_stx() {
        let registry = registry();
        let mut stream = FrameStream::new(Resync::Rescan);
        assert_eq!(
            stream.feed(&[&[0xFE, 200, 0], &HEARTBEAT_V2[..]].concat()).next(&registry),
            None
        );
        let junk = stream.next_at_end(&registry).map(|piece| piece.bytes.to_vec());
        assert_eq!(junk, Some(vec![0xFE, 200, 0]));
        assert_eq!(stream.next_at_end(&registry).map(|p| p.bytes), Some(&HEARTBEAT_V2[..]));
        assert_eq!(stream.next_at_end(&registry), None);
        stream.clear();
        assert_eq!(stream.buffered(), 0);
    }
}
