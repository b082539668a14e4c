//! Recognition of a log's kind by its first bytes. Every reader asks here, in Rust and in Python.
//!
//! The verdict is by content alone. Each reader decides itself how it uses the verdict and the name of the file.

use std::sync::LazyLock;

use mavwire_schema::WireVersion;
use memchr::memmem;

use super::dataflash::{Definitions, FMT_LAYOUT_LEN, FMT_TYPE, HEAD};
use super::tlog::{Framing, STAMP_LEN};
use crate::builtin;
use crate::frame::{STX_V1, STX_V2, claimed_len};
use crate::registry::Registry;
use crate::unknown::UnknownKind;

mod headerless;
#[cfg(test)]
mod tests;

/// Bytes that tell what kind of log it is.
pub const WINDOW: usize = 64 << 10;
/// Bytes at the start of a log in which they are looked for.
pub const MOST: usize = 4 * WINDOW;
/// Bytes of 0 or 0xFF in a row that no log begins with. No more bytes than these at the end of a head tell nothing.
const FILLER: usize = 16;
/// The first byte of a time until the year 4253.
const TIME_START: u8 = 0;
/// Whole records at the start of a telemetry log of any messages that identify it.
const STARTING_RECORDS: usize = 3;
/// Whole frames at the start of a raw stream of any messages that identify it.
const STARTING_FRAMES: usize = 4;
/// Bytes at the start of a text log that contain a FMT line.
const TEXT_START: usize = 8000;
/// At most one in this many of these bytes is not text: damage, or a mark of the encoding. A log that begins with a FMT
/// line is a text log in any case.
const TEXT_SHARE: usize = 2;
/// The text at the start of each line of a text log that describes a record type.
const TEXT: &[u8] = b"FMT,";
/// The same in UTF-16 of either byte order, but for a byte.
const UTF16_TEXT: &[u8] = b"F\0M\0T\0,";
/// How binary logs begin: with the description of descriptions.
const BINARY: &[u8] = &[HEAD[0], HEAD[1], FMT_TYPE];
/// Descriptions in a binary log that lacks its first bytes.
const ENOUGH_LAYOUTS: usize = 3;

/// How files of other formats begin.
const OTHERS: [(&[u8], Kind); 12] = [
    (b"\x1F\x8B", Kind::Gzip), // of which the rest of its head is missing
    (b"PK\x03\x04", Kind::Zip),
    (b"PK\x05\x06", Kind::Zip),
    (b"\x7FELF", Kind::Program),
    (b"ULog\x01\x12\x35", Kind::Ulog),
    (b"\x89PNG\r\n\x1A\n", Kind::Png),
    (b"SQLite format 3\0", Kind::Sqlite),
    (b"\xD4\xC3\xB2\xA1", Kind::Pcap),
    (b"\xA1\xB2\xC3\xD4", Kind::Pcap),
    (b"\x4D\x3C\xB2\xA1", Kind::Pcap),
    (b"\xA1\xB2\x3C\x4D", Kind::Pcap),
    (b"\x0A\x0D\x0D\x0A", Kind::Pcap),
];

/// The messages by which telemetry is recognised in any dialect.
static TELEMETRY: LazyLock<Registry> = LazyLock::new(|| {
    Registry::new(
        builtin::dialect(builtin::UPSTREAM, WireVersion::V2).expect("it comes with the crate"),
    )
});

/// A kind of log, or of another file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Nothing, or less than the first record of a log.
    Cut,
    /// Telemetry: records of time stamp and frame.
    Tlog,
    /// Telemetry: frames alone.
    Raw,
    /// A binary dataflash log.
    Dataflash,
    /// A dataflash log as text, in UTF-8 with line feeds.
    DataflashText,
    /// Records of a binary dataflash log that are not described as far as was looked.
    Headerless,
    /// A dataflash log as text in UTF-16, or with carriage returns alone. No reader takes it.
    OtherText,
    /// Compressed with gzip.
    Gzip,
    /// Compressed with zstd.
    Zstd,
    /// A ZIP archive.
    Zip,
    /// A program.
    Program,
    /// A log of PX4.
    Ulog,
    /// An image.
    Png,
    /// A capture of network packets.
    Pcap,
    /// A database.
    Sqlite,
    /// Nothing that is known. A telemetry log that is damaged all over is among these.
    Unknown,
}

/// The kind of a log by its first bytes, and the bytes that prove it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Verdict<'a> {
    /// The kind of log.
    pub kind: Kind,
    /// The bytes that tell: the first ones, but for damage in front.
    pub telling: &'a [u8],
}

impl Kind {
    /// Whether it is a dataflash log.
    pub fn is_dataflash(self) -> bool {
        matches!(self, Self::Dataflash | Self::DataflashText | Self::Headerless)
    }

    /// Whether it is a telemetry log.
    pub fn is_telemetry(self) -> bool {
        matches!(self, Self::Tlog | Self::Raw)
    }

    /// Whether it is a log, which more bytes than [`WINDOW`] do not change.
    pub fn is_log(self) -> bool {
        self.is_dataflash() || self.is_telemetry() || matches!(self, Self::Gzip | Self::Zstd)
    }
}

/// The kind of log that begins with these bytes. [`MOST`] are enough, and [`WINDOW`] where they show a log.
pub fn identify(head: &[u8]) -> Kind {
    Verdict::of(head).kind
}

impl<'a> Verdict<'a> {
    /// See [`identify`].
    pub fn of(head: &'a [u8]) -> Self {
        let head = &head[..head.len().min(MOST)];
        let start = &head[..head.len().min(WINDOW)];
        if let Some(kind) = by_start(head) {
            return Self { kind, telling: start };
        }
        let windows = head[filler(head)..].chunks(WINDOW).enumerate();
        let mut windows = windows.filter(|(n, window)| *n == 0 || window.len() > FILLER);
        let found =
            windows.find_map(|(_, telling)| Some(Self { kind: of_window(telling)?, telling }));
        found.unwrap_or_else(|| Self { kind: of_nothing_found(head), telling: start })
    }

    /// How the records are framed, if it is a telemetry log. Where that is in doubt, the messages of `registry` decide.
    pub fn framing(&self, registry: &Registry) -> Framing {
        match self.kind {
            Kind::Tlog => Framing::Stamped,
            Kind::Raw => Framing::Raw,
            _ => Framing::of(self.telling, registry),
        }
    }
}

/// How a file is compressed.
pub fn compression(head: &[u8]) -> Option<Kind> {
    match head {
        [0x1F, 0x8B, 8, ..] => Some(Kind::Gzip),
        // A frame, or one that is skipped, as of files of pzstd.
        [0x28, 0xB5, 0x2F, 0xFD, ..] | [0x50..=0x5F, 0x2A, 0x4D, 0x18, ..] => Some(Kind::Zstd),
        _ => None,
    }
}

/// The kind of a log whose first bytes are enough.
fn by_start(head: &[u8]) -> Option<Kind> {
    compression(head).or_else(|| {
        if begins_with_records(head) {
            Some(Kind::Tlog)
        } else if is_cut_off(head) {
            Some(Kind::Cut)
        } else {
            head.starts_with(BINARY).then_some(Kind::Dataflash)
        }
    })
}

/// Whether a head begins with whole records by their lengths.
fn begins_with_records(head: &[u8]) -> bool {
    let mut end = 0;
    for _ in 0..STARTING_RECORDS {
        let Some((stamp, frame)) = head[end..].split_at_checked(STAMP_LEN) else { break };
        if frame.len() < STAMP_LEN {
            break;
        }
        match frame_len(frame) {
            Some(len) if stamp[0] == TIME_START => end += STAMP_LEN + len,
            _ => return false,
        }
        if end > head.len() {
            return false;
        }
    }
    end > 0
}

/// Whether a head begins with whole frames, of any definitions, whose checksums some `crc_extra` explains.
fn begins_with_frames(head: &[u8]) -> bool {
    let mut left = head;
    (0..STARTING_FRAMES).all(|_| {
        let is_frame = UnknownKind::of(left).is_some();
        left = frame_len(left).and_then(|len| left.get(len..)).unwrap_or_default();
        is_frame
    })
}

/// Length of a frame, if all its flags are known.
fn frame_len(frame: &[u8]) -> Option<usize> {
    claimed_len(frame).filter(|_| frame[0] == STX_V1 || frame[2] <= 1)
}

/// Whether these bytes end within the first record of a dataflash log.
fn is_cut_off(head: &[u8]) -> bool {
    let is_binary = head.len() < FMT_LAYOUT_LEN && begin_alike(head, BINARY);
    let is_line = || head.len() < TEXT_START && memchr::memchr(b'\n', head).is_none();
    is_binary || begin_alike(head, TEXT) && is_line() && !has_returns(head)
}

fn begin_alike(head: &[u8], start: &[u8]) -> bool {
    let len = head.len().min(start.len());
    head[..len] == start[..len]
}

/// Bytes in front that a card or a file system left there.
fn filler(head: &[u8]) -> usize {
    let first = head.first().copied().unwrap_or_default();
    let alike = head.iter().take_while(|&&byte| byte == first).count();
    if matches!(first, 0 | 0xFF) && alike >= FILLER { alike } else { 0 }
}

/// The kind that these bytes prove. Telemetry is tried before dataflash: it may carry the download of a dataflash log.
fn of_window(window: &[u8]) -> Option<Kind> {
    if window.starts_with(BINARY) {
        return Some(Kind::Dataflash);
    }
    let telemetry = Framing::sure(window, &TELEMETRY).map(|framing| match framing {
        Framing::Stamped => Kind::Tlog,
        Framing::Raw => Kind::Raw,
    });
    telemetry.or_else(|| of_dataflash(window))
}

fn of_dataflash(window: &[u8]) -> Option<Kind> {
    let mut definitions = Definitions::new();
    definitions.collect(window, 0);
    match window {
        _ if definitions.layouts().len() > ENOUGH_LAYOUTS => Some(Kind::Dataflash),
        _ if begins_as_text(window) => {
            Some(if has_returns(window) { Kind::OtherText } else { Kind::DataflashText })
        }
        _ if headerless::is_in(window) => Some(Kind::Headerless),
        _ => None,
    }
}

/// Whether a text log begins with these bytes: with a description, or with text in which one is.
fn begins_as_text(head: &[u8]) -> bool {
    let start = &head[..head.len().min(TEXT_START)];
    let is_other = |byte: &&u8| !matches!(byte, b' '..=b'~' | b'\t' | b'\r' | b'\n');
    start.starts_with(TEXT)
        || memmem::find(start, TEXT).is_some()
            && start.iter().filter(is_other).count() * TEXT_SHARE <= start.len()
}

/// Whether carriage returns alone end the lines of a text.
fn has_returns(text: &[u8]) -> bool {
    let lines = text.strip_suffix(b"\r").unwrap_or(text);
    memchr::memchr(b'\n', lines).is_none() && memchr::memchr(b'\r', lines).is_some()
}

fn is_utf16(head: &[u8]) -> bool {
    memmem::find(&head[..head.len().min(TEXT_START)], UTF16_TEXT).is_some()
}

/// The kind of a file without a sign of a log.
fn of_nothing_found(head: &[u8]) -> Kind {
    let other = OTHERS.iter().find(|(magic, _)| head.starts_with(magic));
    match other {
        Some(&(_, kind)) => kind,
        None if begins_with_frames(head) => Kind::Raw,
        None if is_utf16(head) => Kind::OtherText,
        None if is_within_record(head) => Kind::Cut,
        None => Kind::Unknown,
    }
}

/// Whether a file ends within the first record of a telemetry log, or right behind that, which is damaged.
fn is_within_record(head: &[u8]) -> bool {
    let is_stx = |at: usize| head.get(at).is_none_or(|byte| matches!(*byte, STX_V1 | STX_V2));
    let is_stamped =
        if head.len() > STAMP_LEN { is_stx(STAMP_LEN) } else { head.first() == Some(&TIME_START) };
    let frame = if is_stamped { &head[head.len().min(STAMP_LEN)..] } else { head };
    let is_begun = is_stamped || is_stx(0);
    is_begun && (frame.len() < 3 || frame_len(frame).is_some_and(|len| frame.len() <= len))
}
