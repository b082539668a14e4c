//! Any bytes as a file, through the readers that keep a window on it.

use std::path::PathBuf;

use mavwire_core::frame::FrameRef;
use mavwire_core::log::tlog::STAMP_LEN;
use mavwire_link::dataflash::DataflashFile;
use mavwire_link::records::{AtOffset, RecordFinder};
use mavwire_link::text_log::TextLogFile;
use mavwire_link::window::FileWindow;

use crate::dialects::ALL;

/// A file that is gone afterwards.
struct Temporary(PathBuf);

impl Temporary {
    fn new(bytes: &[u8]) -> Self {
        let memory = PathBuf::from("/dev/shm");
        let folder = if memory.is_dir() { memory } else { std::env::temp_dir() };
        let thread = std::thread::current().id();
        let path = folder.join(format!("mavwire-fuzz-{}-{thread:?}", std::process::id()));
        std::fs::write(&path, bytes).expect("a temporary file");
        Self(path)
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

/// Each reader comes to the end of the file, and its records stand in their order.
pub fn log_files(data: &[u8]) {
    let file = Temporary::new(data);
    telemetry(&file, data);
    let mut log = DataflashFile::open(&file.0).expect("a file");
    let mut at = 0;
    while let Some((entry, record)) = log.record_at(at).expect("a file") {
        assert!(entry.offset >= at && record.len() == usize::from(entry.len));
        at = entry.offset + u64::from(entry.len);
        assert!(at <= data.len() as u64);
    }
    log.contents(&mut |_| true).expect("a file");
    let mut log = TextLogFile::open(&file.0).expect("a file");
    let (mut at, mut lines) = (0, 0);
    while let Some((entry, _, next)) = log.record_at(at).expect("a file") {
        assert!(entry.offset >= at && next > entry.offset);
        (at, lines) = (next, lines + 1);
    }
    assert!(lines <= log.lines());
    log.contents(&mut |_| true).expect("a file");
    let offsets = log.offsets(&mut |_| true).expect("a file");
    assert!(offsets.iter().map(|(_, places)| places.len() as u64).sum::<u64>() <= log.lines());
}

fn telemetry(file: &Temporary, data: &[u8]) {
    let (mut finder, mut offset) = (RecordFinder::default(), 0_u64);
    let mut window = FileWindow::open(&file.0).expect("a file");
    loop {
        let len = match finder.look(&mut window, offset, &ALL).expect("a file") {
            AtOffset::Record { len, .. } => {
                let start = offset as usize;
                FrameRef::parse(&data[start + STAMP_LEN..start + len]).expect("a frame");
                len
            }
            AtOffset::Junk { len } => len,
            AtOffset::End => return,
        };
        assert!(len > 0);
        offset += len as u64;
        assert!(offset <= data.len() as u64);
    }
}
