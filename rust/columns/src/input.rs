//! The bytes of a log in blocks, decompressed, the next block being read while one is worked on.

use std::io::{self, Read};

use flate2::read::MultiGzDecoder;
use mavwire_core::log::kind::{self, Kind, Verdict};
use mavwire_core::registry::Registry;

use crate::pool;
use crate::scan::{Framing, STRETCH};

/// Bytes of a block: large enough for all processors to have a share in it, small enough for the caches.
const BLOCK: usize = 4 << 20;

/// Bytes that the blocks of logs have together that are read side by side, and the least that one of them has.
const SHARED: usize = 8 << 20;
const LEAST_BLOCK: usize = 256 << 10;

/// Room in front of a block for what the block before it left: the start of a record.
const HEADROOM: usize = 4096;

/// Bytes that tell how a log is compressed.
const MAGIC: usize = 4;

/// In what steps a log is gone through. They change nothing about what is found, once the first block shows what kind of log
/// it is; tests make a small log long by small ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Steps {
    /// Bytes of a block.
    pub block: usize,
    /// Bytes of it that one processor searches in one go.
    pub stretch: usize,
}

impl Default for Steps {
    fn default() -> Self {
        Self { block: BLOCK, stretch: STRETCH }
    }
}

impl Steps {
    /// Those of each of some logs that are read side by side: their blocks have room together, and the reading may stop
    /// soon.
    pub fn shared_by(logs: usize) -> Self {
        Self { block: (SHARED / logs.max(1)).clamp(LEAST_BLOCK, BLOCK), ..Self::default() }
    }
}

/// Decompresses gzip and zstd, recognised by their first bytes.
///
/// # Errors
/// Errors of reading.
pub fn decompressed(mut source: Box<dyn Read + Send>) -> io::Result<Box<dyn Read + Send>> {
    let mut magic = Vec::with_capacity(MAGIC);
    source.by_ref().take(MAGIC as u64).read_to_end(&mut magic)?;
    let whole = io::Cursor::new(magic.clone()).chain(source);
    Ok(match kind::compression(&magic) {
        Some(Kind::Gzip) => Box::new(MultiGzDecoder::new(whole)),
        Some(_) => Box::new(zstd::stream::read::Decoder::new(whole)?),
        _ => Box::new(whole),
    })
}

/// As much of the start of a log as tells its kind. On an error, the bytes read before it, if any.
fn head_of(mut source: impl Read) -> io::Result<Vec<u8>> {
    let mut head = Vec::with_capacity(kind::WINDOW);
    let read = source.by_ref().take(kind::WINDOW as u64).read_to_end(&mut head);
    match read {
        Err(error) if head.is_empty() => Err(error),
        Ok(kind::WINDOW) if !kind::identify(&head).is_log() => {
            // Errors further on are reported when the log itself is read.
            let _ = source.take((kind::MOST - kind::WINDOW) as u64).read_to_end(&mut head);
            Ok(head)
        }
        _ => Ok(head),
    }
}

/// The kind of a source's bytes, which are not decompressed first.
///
/// # Errors
/// Errors of reading.
pub fn identify(source: Box<dyn Read + Send>) -> io::Result<Kind> {
    Ok(kind::identify(&head_of(source)?))
}

/// The kind of a log that may be compressed. Damage further on does not change the kind.
///
/// # Errors
/// Errors of reading the file.
pub fn identify_content(source: Box<dyn Read + Send>) -> io::Result<Kind> {
    match decompressed(source).and_then(head_of) {
        Err(error) if error.raw_os_error().is_some() => Err(error),
        read => Ok(kind::identify(&read.unwrap_or_default())),
    }
}

/// How a telemetry log is framed that is not compressed, by its first bytes.
///
/// # Errors
/// Errors of reading.
pub fn framing_of(source: Box<dyn Read + Send>, registry: &Registry) -> io::Result<Framing> {
    Ok(Verdict::of(&head_of(source)?).framing(registry))
}

/// A block that was read, behind its headroom.
#[derive(Default)]
struct Buffer {
    /// Allocated once and never zeroed: what no block reaches is never touched.
    bytes: Vec<u8>,
    /// Where the unread bytes start; they go on to the end.
    start: usize,
}

impl Buffer {
    fn read(&mut self, source: &mut Source, block: usize) -> io::Result<usize> {
        self.bytes.clear();
        self.bytes.reserve_exact(HEADROOM + block);
        self.clear();
        source.fill(&mut self.bytes, block)
    }

    fn unread(&self) -> &[u8] {
        &self.bytes[self.start..]
    }

    fn clear(&mut self) {
        self.bytes.resize(HEADROOM, 0);
        self.start = HEADROOM;
    }

    /// Puts what another buffer left in front.
    fn prepend(&mut self, left: &[u8]) {
        if left.len() > self.start {
            self.bytes.splice(..self.start, left.iter().copied());
            self.start = 0;
        } else {
            self.start -= left.len();
            self.bytes[self.start..self.start + left.len()].copy_from_slice(left);
        }
    }
}

/// Where bytes come from.
struct Source {
    inner: Box<dyn Read + Send>,
    /// Why the next read fails.
    failed: Option<io::Error>,
}

impl Source {
    /// Appends bytes, so many unless the source ends before. An error behind the first byte is kept for the next time.
    fn fill(&mut self, into: &mut Vec<u8>, most: usize) -> io::Result<usize> {
        if let Some(error) = self.failed.take() {
            return Err(error);
        }
        let before = into.len();
        let read = self.inner.by_ref().take(most as u64).read_to_end(into);
        match (read, into.len() - before) {
            (Err(error), 0) => return Err(error),
            (read, _) => self.failed = read.err(),
        }
        Ok(into.len() - before)
    }
}

/// A log being read.
pub struct Blocks {
    source: Source,
    block: usize,
    now: Buffer,
    next: Buffer,
    /// The result of reading ahead; `None` before the first look.
    ahead: Option<io::Result<usize>>,
    damage: Option<String>,
}

impl Blocks {
    /// Blocks of a source, perhaps compressed.
    ///
    /// # Errors
    /// Errors of reading.
    pub fn new(source: Box<dyn Read + Send>) -> io::Result<Self> {
        Ok(Self::of_size(decompressed(source)?, BLOCK))
    }

    /// The same of any size, and without decompressing.
    pub fn of_size(source: Box<dyn Read + Send>, block: usize) -> Self {
        let (now, next) = Default::default();
        let source = Source { inner: source, failed: None };
        Self { source, block, now, next, ahead: None, damage: None }
    }

    /// Blocks of a telemetry log, perhaps compressed, or of one that is known to be framed like this, and plain.
    pub(crate) fn framed(
        source: Box<dyn Read + Send>,
        framing: Option<Framing>,
        registry: &Registry,
        block: usize,
    ) -> io::Result<(Self, Framing)> {
        match framing {
            Some(framing) => Ok((Self::of_size(source, block), framing)),
            None => Self::of_size(decompressed(source)?, block)
                .with_verdict(|verdict| verdict.framing(registry)),
        }
    }

    /// Lets `look` see what kind of log it is.
    ///
    /// # Errors
    /// Errors of reading.
    pub fn with_verdict<T>(mut self, look: impl FnOnce(Verdict<'_>) -> T) -> io::Result<(Self, T)> {
        let filled = self.next.read(&mut self.source, self.block);
        self.ahead = Some(Ok(self.judge(filled)?));
        let seen = look(Verdict::of(self.next.unread()));
        Ok((self, seen))
    }

    /// The damage of a compressed file. Everything before it was read.
    pub fn damage(&self) -> Option<&str> {
        self.damage.as_deref()
    }

    /// Whether the block that was looked at is the whole log, unless that grows.
    pub(crate) fn is_whole(&self) -> bool {
        matches!(self.ahead, Some(Ok(filled)) if filled < self.block)
    }

    /// Hands the next block to `work`, which says how many bytes of it are consumed; at least one, if it can. The flag
    /// says that nothing follows. `None` at the end.
    ///
    /// # Errors
    /// Errors of reading.
    pub fn next<T: Send>(
        &mut self,
        work: impl FnOnce(&[u8], bool) -> (usize, T) + Send,
    ) -> io::Result<Option<T>> {
        let filled = match self.ahead.take() {
            Some(filled) => filled,
            None => self.next.read(&mut self.source, self.block),
        };
        let filled = self.judge(filled)?;
        let left = self.now.unread();
        if filled == 0 && left.is_empty() {
            self.ahead = Some(Ok(0));
            return Ok(None);
        }
        self.next.prepend(left);
        std::mem::swap(&mut self.now, &mut self.next);
        let (now, next, source, block) = (&self.now, &mut self.next, &mut self.source, self.block);
        let at_end = filled == 0;
        // The work first: it need not wait for a second thread to wake.
        let ((consumed, done), ahead) = pool::run(|| {
            rayon::join(
                || work(now.unread(), at_end),
                || if at_end { Ok(0) } else { next.read(source, block) },
            )
        });
        if at_end {
            self.next.clear();
        }
        self.ahead = Some(ahead);
        self.now.start += consumed;
        Ok(Some(done))
    }

    /// A damaged compressed file is one that ends there.
    fn judge(&mut self, filled: io::Result<usize>) -> io::Result<usize> {
        use io::ErrorKind::{InvalidData, InvalidInput, Other, UnexpectedEof};
        match filled {
            Err(error)
                if error.raw_os_error().is_none()
                    && matches!(
                        error.kind(),
                        InvalidData | InvalidInput | Other | UnexpectedEof
                    ) =>
            {
                self.damage = Some(error.to_string());
                Ok(0)
            }
            filled => filled,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gives some bytes and some errors, one by one.
    struct Answers(Vec<io::Result<&'static [u8]>>);

    impl Read for Answers {
        fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
            let bytes = if self.0.is_empty() { &[] } else { self.0.remove(0)? };
            into[..bytes.len()].copy_from_slice(bytes);
            Ok(bytes.len())
        }
    }

    #[test]
    fn what_was_read_before_an_error_is_dealt_with_before_it() {
        use io::ErrorKind::{Interrupted, PermissionDenied};
        let failed = || Err(io::Error::from(PermissionDenied));
        let answers = vec![Ok(&b"one "[..]), Err(Interrupted.into()), Ok(b"two"), failed()];
        let mut blocks = Blocks::of_size(Box::new(Answers(answers)), 100);
        let next = |blocks: &mut Blocks| blocks.next(|block, _| (block.len(), block.to_vec()));
        assert_eq!(next(&mut blocks).expect("the start"), Some(b"one two".to_vec()));
        assert_eq!(next(&mut blocks).expect_err("the error").kind(), PermissionDenied);
        let mut blocks = Blocks::of_size(Box::new(Answers(vec![failed()])), 100);
        assert_eq!(next(&mut blocks).expect_err("the error").kind(), PermissionDenied);
    }

    #[test]
    fn what_no_block_reaches_takes_no_memory() {
        let source = Box::new(io::Cursor::new(vec![7; 100]));
        let blocks = Blocks::of_size(source, BLOCK).with_verdict(|verdict| verdict.telling.len());
        let (blocks, len) = blocks.expect("bytes");
        assert_eq!((len, blocks.next.bytes.len()), (100, HEADROOM + 100));
        assert!(blocks.is_whole() && blocks.next.bytes.capacity() <= HEADROOM + BLOCK);
    }

    #[test]
    fn a_long_rest_lengthens_no_buffer_for_good() {
        const BLOCK: usize = 8192;
        const REST: usize = 6000;
        let bytes: Vec<u8> = (0..40 * BLOCK).map(|n| (n % 251) as u8).collect();
        let mut blocks = Blocks::of_size(Box::new(io::Cursor::new(bytes.clone())), BLOCK);
        let mut read = Vec::new();
        let mut work = |block: &[u8], at_end: bool| {
            let consumed = if at_end { block.len() } else { block.len().saturating_sub(REST) };
            read.extend_from_slice(&block[..consumed]);
            (consumed, ())
        };
        let mut longest = 0;
        while blocks.next(&mut work).expect("reading").is_some() {
            longest = longest.max(blocks.now.bytes.capacity()).max(blocks.next.bytes.capacity());
        }
        assert_eq!(read, bytes);
        // Vectors double.
        assert!(longest <= 2 * (HEADROOM + BLOCK), "{longest}");
    }
}
