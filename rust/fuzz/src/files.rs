//! Any bytes as a file, through the readers that keep a window on it: the position of the window changes nothing.

use std::fs::{self, File};
use std::io;
use std::os::fd::AsRawFd;
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};
use std::thread;

use mavwire_core::frame::FrameRef;
use mavwire_core::log::dataflash::text::{Delimiter, TextDefinitions, mark_len, trimmed};
use mavwire_core::log::dataflash::{Definitions, RecordEntry, index};
use mavwire_core::log::tlog::{FoundRecord, RecordScanner, STAMP_LEN};
use mavwire_io::dataflash::DataflashFile;
use mavwire_io::dataflash_log::DataflashLog;
use mavwire_io::records::RecordFinder;
use mavwire_io::text_log::TextLogFile;
use mavwire_io::window::FileWindow;

use crate::dialects::ALL;
use crate::input::Input;

/// A file without a name, to be opened as that of its descriptor. It is written again and again: making one takes longer
/// than reading it.
struct Temporary {
    file: File,
    path: PathBuf,
}

impl Temporary {
    fn new() -> io::Result<Self> {
        let memory = PathBuf::from("/dev/shm");
        let folder = if memory.is_dir() { memory } else { std::env::temp_dir() };
        let thread = thread::current().id();
        let named = folder.join(format!("mavwire-fuzz-{}-{thread:?}", std::process::id()));
        let file = File::options().read(true).write(true).create_new(true).open(&named)?;
        fs::remove_file(named)?;
        let path = format!("/dev/fd/{}", file.as_raw_fd()).into();
        Ok(Self { file, path })
    }

    fn write(&self, bytes: &[u8]) -> io::Result<()> {
        self.file.set_len(0)?;
        self.file.write_all_at(bytes, 0)
    }
}

thread_local! {
    static FILE: Temporary = Temporary::new().expect("a temporary file");
}

/// Each reader comes to the end of the file by windows of any size, and finds the records that are in its bytes.
pub fn log_files(data: &[u8]) {
    let mut input = Input::new(data);
    let chunk = usize::from(input.byte()) * 4 + 1;
    let bytes = input.rest();
    FILE.with(|file| {
        file.write(bytes).expect("a temporary file");
        telemetry(&file.path, chunk, bytes);
        binary(&file.path, chunk, bytes);
        text(&file.path, chunk, bytes);
    });
}

fn telemetry(path: &Path, chunk: usize, bytes: &[u8]) {
    let (mut finder, mut offset) = (RecordFinder::default(), 0_u64);
    let mut window = FileWindow::in_chunks(path, chunk).expect("a file");
    let mut found = Vec::new();
    loop {
        let len = match finder.look(&mut window, offset, &ALL).expect("a file") {
            FoundRecord::Record { len, .. } => {
                let start = offset as usize;
                FrameRef::parse(&bytes[start + STAMP_LEN..start + len]).expect("a frame");
                found.push(start..start + len);
                len
            }
            FoundRecord::Junk { len } => len,
            FoundRecord::Incomplete { .. } => break,
        };
        assert!(len > 0);
        offset += len as u64;
        assert!(offset <= bytes.len() as u64);
    }
    // One that may go on is waited for at the end.
    let whole = scanned(bytes);
    assert!(whole.starts_with(&found), "{found:?} of {whole:?}");
    assert!(whole.len() <= found.len() + 1);
}

/// The records by one scanner over all bytes.
fn scanned(bytes: &[u8]) -> Vec<std::ops::Range<usize>> {
    let (mut scanner, mut records, mut at) = (RecordScanner::default(), Vec::new(), 0);
    loop {
        match scanner.next(&bytes[at..], &ALL, true) {
            FoundRecord::Record { len, .. } => {
                records.push(at..at + len);
                at += len;
            }
            FoundRecord::Junk { len } => at += len,
            FoundRecord::Incomplete { .. } => return records,
        }
    }
}

fn binary(path: &Path, chunk: usize, bytes: &[u8]) {
    let mut definitions = Definitions::new();
    definitions.collect(bytes, 0);
    let mut whole: Vec<RecordEntry> = Vec::new();
    let (_, junk) = index(bytes, 0, usize::MAX, &definitions, true, |entry, _| whole.push(entry));
    let mut log = DataflashFile::in_chunks(path, chunk).expect("a file");
    assert_eq!(log.definitions().layouts(), definitions.layouts());
    let (mut found, mut at) = (Vec::new(), 0);
    while let Some(entry) = log.entry_at(at).expect("a file") {
        let record = log.bytes_at(entry.offset, entry.len);
        let start = entry.offset as usize;
        assert_eq!(record, &bytes[start..start + entry.len]);
        at = entry.next;
        let (layout, len) = (entry.layout as u16, entry.len as u8);
        found.push(RecordEntry { offset: entry.offset, layout, len });
    }
    assert_eq!(found, whole);
    let mut log = DataflashLog::Binary(Box::new(log));
    let contents = log.contents(&mut |_| true).expect("a file");
    assert_eq!(contents.counts.iter().sum::<u64>(), whole.len() as u64);
    assert_eq!((contents.junk, contents.last), (junk, whole.last().map(|entry| entry.offset)));
}

/// A place and a line without its end; the bytes are looked at line by line.
fn lines(bytes: &[u8], longest: usize) -> Vec<(u64, &[u8])> {
    let (mut lines, mark) = (Vec::new(), mark_len(bytes));
    let mut at = mark as u64;
    for line in bytes[mark..].split(|&byte| byte == b'\n') {
        let text = trimmed(line);
        if line.len() < longest && !text.is_empty() {
            lines.push((at, text));
        }
        at += line.len() as u64 + 1;
    }
    lines
}

fn text(path: &Path, chunk: usize, bytes: &[u8]) {
    let lines = lines(bytes, chunk);
    let delimiter = Delimiter::of(&bytes[..bytes.len().min(chunk)]);
    // The last line may be cut off if no newline ends it. It is a line, but not a record.
    let rest = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end as u64 + 1);
    let ended = || lines.iter().filter(|&&(at, _)| at < rest);
    let mut definitions = TextDefinitions::new(delimiter);
    for &(at, line) in ended() {
        definitions.collect(line, at);
    }
    let mut log = TextLogFile::in_chunks(path, chunk).expect("a file");
    assert_eq!((log.delimiter(), log.layouts()), (delimiter, definitions.layouts()));
    assert_eq!(log.lines(), lines.len() as u64);
    let is_record = |&(at, line): &(u64, &[u8])| Some((at, definitions.of_line(line, at)?));
    let whole: Vec<_> = ended().filter_map(is_record).collect();
    let (mut found, mut at) = (Vec::new(), 0);
    while let Some(entry) = log.entry_at(at).expect("a file") {
        assert!(bytes[entry.offset as usize..].starts_with(log.bytes_at(entry.offset, entry.len)));
        found.push((entry.offset, entry.layout as u16));
        at = entry.next;
    }
    assert_eq!(found, whole);
    let mut log = DataflashLog::Text(Box::new(log));
    let contents = log.contents(&mut |_| true).expect("a file");
    assert_eq!(contents.counts.iter().sum::<u64>(), whole.len() as u64);
}
