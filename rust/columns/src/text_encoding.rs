//! Converts text logs of other encodings and line ends to UTF-8 with line feeds.
//!
//! Windows programs put a byte order mark in front of a text log or write UTF-16. Old editors end lines with a carriage
//! return alone. Readers of lines need not know this: the bytes are converted before they get them, in bounded memory.

use std::io::{self, Cursor, Read};

use mavwire_core::log::kind::begins_as_text;

/// The encoding is recognised by so many bytes at the start of a log.
const PROBE: usize = 16_000;
/// Bytes per conversion step.
const CHUNK: usize = 64 << 10;
const BYTE_ORDER_MARK: &str = "\u{feff}";

/// The encoding of the characters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Unit {
    Utf8,
    Utf16Little,
    Utf16Big,
}

impl Unit {
    /// The encoding by the byte order mark, and the length of the mark.
    fn of(head: &[u8]) -> (Self, usize) {
        match head {
            [0xEF, 0xBB, 0xBF, ..] => (Self::Utf8, BYTE_ORDER_MARK.len()),
            [0xFF, 0xFE, ..] => (Self::Utf16Little, 2),
            [0xFE, 0xFF, ..] => (Self::Utf16Big, 2),
            _ => (Self::Utf8, 0),
        }
    }

    /// Appends text as UTF-8. Returns the number of bytes at the end that are the start of a split character.
    fn decode(self, bytes: &[u8], at_end: bool, into: &mut Vec<u8>) -> usize {
        let unit = match self {
            Self::Utf8 => {
                into.extend_from_slice(bytes);
                return 0;
            }
            Self::Utf16Little => u16::from_le_bytes,
            Self::Utf16Big => u16::from_be_bytes,
        };
        let (pairs, rest) = bytes.as_chunks::<2>();
        let is_high = |pair: &[u8; 2]| (0xD800..0xDC00).contains(&unit(*pair));
        let held = usize::from(!at_end && pairs.last().is_some_and(is_high));
        let units = pairs[..pairs.len() - held].iter().map(|pair| unit(*pair));
        let text = char::decode_utf16(units).map(|one| one.unwrap_or(char::REPLACEMENT_CHARACTER));
        into.extend_from_slice(text.collect::<String>().as_bytes());
        2 * held + rest.len()
    }
}

/// The encoding and line ends of a log that needs conversion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Encoding {
    unit: Unit,
    /// Length of the byte order mark.
    mark: usize,
    /// Lines end with a carriage return alone.
    returns: bool,
}

impl Encoding {
    /// Recognises the encoding by the first bytes of a log; `None` if the log needs no conversion.
    fn of(head: &[u8]) -> Option<Self> {
        let head = &head[..head.len().min(PROBE)];
        let (unit, mark) = Unit::of(head);
        if mark == 0 && memchr::memchr(b'\n', head).is_some() {
            return None;
        }
        let mut text = Vec::new();
        unit.decode(&head[mark..], false, &mut text);
        let is_control = |byte: &u8| *byte < b' ' && !matches!(byte, b'\t' | b'\r' | b'\n');
        let returns = text.contains(&b'\r') && !text.contains(&b'\n');
        let is_text = begins_as_text(&text) && !text.iter().any(is_control);
        (is_text && (mark > 0 || returns)).then_some(Self { unit, mark, returns })
    }
}

/// The first bytes of a log, converted if it is a text log that needs it.
pub fn head_to_utf8(head: &[u8]) -> Vec<u8> {
    let mut text = Vec::new();
    // Reading memory does not fail.
    let _ = to_utf8(Box::new(Cursor::new(head.to_vec()))).read_to_end(&mut text);
    text
}

/// A reader of a log, which converts it if it is a text log that needs it.
pub fn to_utf8(mut source: Box<dyn Read + Send>) -> Box<dyn Read + Send> {
    let mut head = Vec::new();
    let rest: Box<dyn Read + Send> = match source.by_ref().take(PROBE as u64).read_to_end(&mut head)
    {
        Ok(_) => source,
        Err(error) => Box::new(FailsOnce(Some(error))),
    };
    let encoding = Encoding::of(&head);
    let mut start = Cursor::new(head);
    let Some(encoding) = encoding else { return Box::new(start.chain(rest)) };
    start.set_position(encoding.mark as u64);
    let (left, ready) = Default::default();
    Box::new(Utf8Reader { inner: start.chain(rest), encoding, left, ready, at: 0 })
}

/// A source that fails at the first read and then ends.
struct FailsOnce(Option<io::Error>);

impl Read for FailsOnce {
    fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
        self.0.take().map_or(Ok(0), Err)
    }
}

/// Converts a text chunk by chunk.
struct Utf8Reader<R> {
    inner: R,
    encoding: Encoding,
    /// The start of a character that the next chunk completes.
    left: Vec<u8>,
    ready: Vec<u8>,
    /// The number of bytes of `ready` that were read.
    at: usize,
}

impl<R: Read> Utf8Reader<R> {
    fn convert(&mut self) -> io::Result<()> {
        let Encoding { unit, returns, .. } = self.encoding;
        let read = self.inner.by_ref().take(CHUNK as u64).read_to_end(&mut self.left)?;
        self.ready.clear();
        self.at = 0;
        let left = unit.decode(&self.left, read == 0, &mut self.ready);
        if returns {
            self.ready.iter_mut().filter(|byte| **byte == b'\r').for_each(|byte| *byte = b'\n');
        }
        self.left.drain(..if read == 0 { self.left.len() } else { self.left.len() - left });
        Ok(())
    }
}

impl<R: Read> Read for Utf8Reader<R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        while self.at == self.ready.len() {
            let before = self.left.len();
            self.convert()?;
            if self.ready.is_empty() && self.left.len() <= before {
                return Ok(0);
            }
        }
        let read = (&self.ready[self.at..]).read(into)?;
        self.at += read;
        Ok(read)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOG: &str = "FMT, 1, 9, MSG, Z, Message\nMSG, Grüße \u{1f681}\nMSG, b\n";

    fn text(bytes: &[u8]) -> String {
        let mut text = String::new();
        let source: Box<dyn Read + Send> = Box::new(Cursor::new(bytes.to_vec()));
        to_utf8(source).read_to_string(&mut text).expect("text");
        text
    }

    fn utf16(text: &str, unit: fn(u16) -> [u8; 2]) -> Vec<u8> {
        text.encode_utf16().flat_map(unit).collect()
    }

    #[test]
    fn utf16_byte_order_marks_and_carriage_returns_are_converted() {
        let marked = format!("{BYTE_ORDER_MARK}{LOG}");
        let logs = [
            marked.as_bytes().to_vec(),
            utf16(&marked, u16::to_le_bytes),
            utf16(&marked, u16::to_be_bytes),
            LOG.replace('\n', "\r").into_bytes(),
            utf16(&marked.replace('\n', "\r"), u16::to_le_bytes),
        ];
        for log in logs {
            assert!(Encoding::of(&log).is_some());
            assert_eq!(text(&log), LOG);
        }
    }

    #[test]
    fn long_texts_are_converted_chunk_by_chunk() {
        let long = format!("{BYTE_ORDER_MARK}{LOG}{}", "MSG, \u{1f681}x\r\n".repeat(40_000));
        assert_eq!(text(&utf16(&long, u16::to_le_bytes)), long[BYTE_ORDER_MARK.len()..]);
        let odd =
            [utf16(&format!("{BYTE_ORDER_MARK}{LOG}"), u16::to_be_bytes), vec![0xD8]].concat();
        assert_eq!(text(&odd), LOG);
    }

    #[test]
    fn other_logs_stay_as_they_are() {
        let frames = [b"\xFE\xFF\0\x01\x01FMT,\r".as_slice(), &[7; 300]].concat();
        for log in [LOG.as_bytes(), &frames, b"\xA3\x95\x80\0FMT,\r", b"", b"\xFF\xFE", b"FMT, 1"] {
            assert!(Encoding::of(log).is_none());
            assert_eq!(head_to_utf8(log), log);
        }
    }

    #[test]
    fn bytes_before_an_error_are_read_first() {
        let failed = FailsOnce(Some(io::ErrorKind::PermissionDenied.into()));
        let source = Cursor::new(LOG.as_bytes()).chain(failed);
        let mut whole = to_utf8(Box::new(source));
        let mut text = Vec::new();
        let error = whole.read_to_end(&mut text).expect_err("the error");
        assert_eq!(
            (text.as_slice(), error.kind()),
            (LOG.as_bytes(), io::ErrorKind::PermissionDenied)
        );
    }
}
