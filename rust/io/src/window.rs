//! A file read through a moving window.
//!
//! Logs are not mapped into memory: a file that is cut short while it is mapped kills the process, and a copy through a
//! buffer costs a few nanoseconds per message. Memory does not grow with the size of the file.

use std::fs::File;
use std::io;
use std::path::Path;
use std::sync::Arc;

/// Bytes read at a time, unless told otherwise.
pub const CHUNK: usize = 256 * 1024;

/// A file with a buffer that moves over it. The file may grow or shrink while it is read.
#[derive(Debug)]
pub struct FileWindow {
    file: Arc<File>,
    /// As long as it ever had to be: clearing it again for each read near the end of the file would cost more than the
    /// read.
    buffer: Vec<u8>,
    /// Bytes of the buffer that are the file's.
    filled: usize,
    /// Where in the file the buffer begins.
    start: u64,
    /// Bytes read at a time.
    chunk: usize,
}

/// Another window over the same file, still empty.
impl Clone for FileWindow {
    fn clone(&self) -> Self {
        Self {
            file: Arc::clone(&self.file),
            buffer: Vec::new(),
            filled: 0,
            start: 0,
            chunk: self.chunk,
        }
    }
}

impl FileWindow {
    /// Opens a file for reading.
    ///
    /// # Errors
    /// Errors of the operating system.
    pub fn open(path: &Path) -> io::Result<Self> {
        Self::in_chunks(path, CHUNK)
    }

    /// The same with another number of bytes read at a time: over a small file the window moves if that is small.
    ///
    /// # Errors
    /// Errors of the operating system.
    pub fn in_chunks(path: &Path, chunk: usize) -> io::Result<Self> {
        Ok(Self {
            file: Arc::new(File::open(path)?),
            buffer: Vec::new(),
            filled: 0,
            start: 0,
            chunk,
        })
    }

    /// Bytes of the file now.
    ///
    /// # Errors
    /// Errors of the operating system.
    pub fn size(&self) -> io::Result<u64> {
        Ok(self.file.metadata()?.len())
    }

    /// The bytes from `offset` on: `wanted` or more, fewer only where the file ends.
    ///
    /// # Errors
    /// Errors of the operating system; `OutOfMemory` where there is no memory for so many bytes.
    #[inline]
    pub fn at(&mut self, offset: u64, wanted: usize) -> io::Result<&[u8]> {
        if let Some(skip) = offset.checked_sub(self.start)
            && let Ok(skip) = usize::try_from(skip)
            && skip.saturating_add(wanted) <= self.filled
        {
            return Ok(&self.buffer[skip..self.filled]);
        }
        self.refill(offset, wanted)?;
        Ok(&self.buffer[..self.filled])
    }

    /// The bytes from `offset` on that are there without reading; none outside of what was read last.
    #[must_use]
    pub fn buffered(&self, offset: u64) -> &[u8] {
        let skip = offset.checked_sub(self.start).and_then(|skip| usize::try_from(skip).ok());
        skip.and_then(|skip| self.buffer[..self.filled].get(skip..)).unwrap_or_default()
    }

    fn left_from(&self, offset: u64) -> io::Result<usize> {
        Ok(usize::try_from(self.size()?.saturating_sub(offset)).unwrap_or(usize::MAX))
    }

    #[cold]
    fn refill(&mut self, offset: u64, wanted: usize) -> io::Result<()> {
        // No more than there is, because `wanted` may come from a user.
        let wanted = if wanted > self.chunk { wanted.min(self.left_from(offset)?) } else { wanted };
        let wanted = self.chunk.max(wanted);
        if self.buffer.len() < wanted {
            // A program may ask for more of a long log than there is memory for.
            self.buffer.try_reserve_exact(wanted - self.buffer.len())?;
            self.buffer.resize(wanted, 0);
        }
        self.start = offset;
        self.filled = 0;
        while self.filled < wanted {
            let free = &mut self.buffer[self.filled..wanted];
            match read_at(&self.file, free, offset + self.filled as u64) {
                Ok(0) => break,
                Ok(count) => self.filled += count,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => {
                    self.filled = 0;
                    return Err(error);
                }
            }
        }
        Ok(())
    }
}

#[cfg(unix)]
fn read_at(file: &File, buffer: &mut [u8], offset: u64) -> io::Result<usize> {
    std::os::unix::fs::FileExt::read_at(file, buffer, offset)
}

#[cfg(windows)]
fn read_at(file: &File, buffer: &mut [u8], offset: u64) -> io::Result<usize> {
    std::os::windows::fs::FileExt::seek_read(file, buffer, offset)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn file(name: &str, bytes: &[u8]) -> (std::path::PathBuf, File) {
        let path = std::env::temp_dir().join(format!("mavwire-{name}-{}", std::process::id()));
        let mut file = File::create(&path).expect("a temporary file");
        file.write_all(bytes).expect("writing it");
        (path, file)
    }

    #[test]
    fn reads_forwards_backwards_and_past_the_end() {
        let bytes: Vec<u8> = (0..1_000_000u32).map(|i| (i % 251) as u8).collect();
        let (path, _file) = file("window", &bytes);
        let mut window = FileWindow::open(&path).expect("opening");
        for offset in [0usize, 262_100, 262_144, 999_999, 5, 500_000] {
            let got = window.at(offset as u64, 100).expect("reading");
            let wanted = 100.min(bytes.len() - offset);
            assert!(got.len() >= wanted);
            assert_eq!(got[..wanted], bytes[offset..offset + wanted]);
            assert_eq!(window.buffered(offset as u64)[..wanted], bytes[offset..offset + wanted]);
            assert!(window.buffered(1_000_001).is_empty());
        }
        assert!(window.at(1_000_000, 1).expect("reading").is_empty());
        for offset in [0, 999_990, 2_000_000] {
            let got = window.at(offset, usize::MAX).expect("reading").len() as u64;
            assert_eq!(got, 1_000_000_u64.saturating_sub(offset), "all there is");
        }
        std::fs::remove_file(path).expect("removing");
    }

    #[test]
    fn sees_what_is_appended_and_survives_truncation() {
        let (path, mut file) = file("growing", b"abc");
        let mut window = FileWindow::open(&path).expect("opening");
        assert_eq!(window.at(0, 6).expect("reading"), b"abc");
        file.write_all(b"def").expect("writing");
        assert_eq!(window.at(0, 6).expect("reading"), b"abcdef");
        file.set_len(2).expect("truncating");
        assert_eq!(window.at(2, 4).expect("reading"), b"cdef", "still buffered");
        assert!(window.at(3, 300).expect("reading").is_empty());
        std::fs::remove_file(path).expect("removing");
    }
}
