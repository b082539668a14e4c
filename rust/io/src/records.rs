//! The good records of a telemetry log file, damaged or not.
//!
//! Puts the core's record scanner to work on a file that may still be growing: the rest of a record that is not all
//! there yet is waited for, unless good records follow it.

use std::io;

use mavwire_core::frame::MAX_FRAME_LEN;
use mavwire_core::log::tlog::{FoundRecord, Framing, RecordScanner, STAMP_LEN};
use mavwire_core::registry::Registry;

use crate::window::FileWindow;

/// Finds records. It remembers its position, but may be asked to look anywhere.
#[derive(Debug, Clone, Default)]
pub struct RecordFinder {
    scanner: RecordScanner,
    offset: u64,
}

impl RecordFinder {
    /// A finder at the start of a log.
    pub fn new(framing: Framing) -> Self {
        Self { scanner: framing.scanner(), offset: 0 }
    }

    /// Looks at `offset`. The next look should be `len` bytes further. `Incomplete` is the end of the file, perhaps with the
    /// start of a record.
    ///
    /// # Errors
    /// Errors of the operating system.
    #[inline]
    pub fn look(
        &mut self,
        window: &mut FileWindow,
        offset: u64,
        registry: &Registry,
    ) -> io::Result<FoundRecord> {
        if self.offset != offset {
            self.scanner.restart();
            self.offset = offset;
        }
        let mut wanted = STAMP_LEN + MAX_FRAME_LEN;
        loop {
            let bytes = window.at(offset, wanted)?;
            match self.scanner.next(bytes, registry, false) {
                FoundRecord::Incomplete { needed } if bytes.len() >= wanted => wanted = needed,
                FoundRecord::Incomplete { .. } => return Ok(self.look_behind(bytes, registry)),
                found @ (FoundRecord::Record { len, .. } | FoundRecord::Junk { len }) => {
                    self.offset += len as u64;
                    return Ok(found);
                }
            }
        }
    }

    /// The file ends within what looks like a record, or in what may follow a signed one. Good records behind its start
    /// show that it is none.
    fn look_behind(&mut self, bytes: &[u8], registry: &Registry) -> FoundRecord {
        let mut scanner = self.scanner.clone();
        let mut junk = 0;
        loop {
            // Reading goes on with what the scanner knows there: what was in front tells whether unknown ids are believed.
            let there = scanner.clone();
            match scanner.next(&bytes[junk..], registry, true) {
                FoundRecord::Junk { len } => junk += len,
                FoundRecord::Record { .. } if junk > 0 => {
                    (self.scanner, self.offset) = (there, self.offset + junk as u64);
                    return FoundRecord::Junk { len: junk };
                }
                found @ FoundRecord::Record { len, .. } => {
                    (self.scanner, self.offset) = (scanner, self.offset + len as u64);
                    return found;
                }
                end @ FoundRecord::Incomplete { .. } => return end,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mavwire_core::builtin;
    use mavwire_schema::WireVersion::V2;
    use std::io::Write;

    /// HEARTBEAT, MAVLink 1, good checksum for `crc_extra` 50.
    fn heartbeat(seq: u8) -> Vec<u8> {
        let body = [9, seq, 1, 1, 0, 4, 0, 0, 0, 2, 3, 81, 4, 3];
        let checksum = mavwire_core::x25::push(mavwire_core::x25::checksum(&body), 50);
        [&[0xFE], &body[..], &checksum.to_le_bytes()].concat()
    }

    fn record(seq: u8) -> Vec<u8> {
        [&(1_600_000_000_000_000 + u64::from(seq)).to_be_bytes()[..], &heartbeat(seq)].concat()
    }

    struct Log {
        path: std::path::PathBuf,
        finder: RecordFinder,
        window: FileWindow,
        offset: u64,
    }

    impl Log {
        fn new(name: &str, bytes: &[u8]) -> Self {
            let path = std::env::temp_dir().join(format!("mavwire-{name}-{}", std::process::id()));
            std::fs::write(&path, bytes).expect("a temporary file");
            let window = FileWindow::open(&path).expect("opening it");
            Self { path, finder: RecordFinder::default(), window, offset: 0 }
        }

        fn append(&self, bytes: &[u8]) {
            let mut file =
                std::fs::OpenOptions::new().append(true).open(&self.path).expect("opening");
            file.write_all(bytes).expect("writing");
        }

        /// Sequence numbers of the records up to the end.
        fn drain(&mut self) -> Vec<u8> {
            let registry = Registry::new(builtin::dialect("minimal", V2).expect("the dialect"));
            let mut found = Vec::new();
            loop {
                let len = match self.finder.look(&mut self.window, self.offset, &registry) {
                    Ok(FoundRecord::Record { len, stamp, header, .. }) => {
                        let expected = 1_600_000_000_000_000 + u64::from(header.seq);
                        assert_eq!(stamp.micros(), expected);
                        found.push(header.seq);
                        len
                    }
                    Ok(FoundRecord::Junk { len }) => len,
                    Ok(FoundRecord::Incomplete { .. }) => return found,
                    Err(error) => panic!("{error}"),
                };
                assert!(len > 0);
                self.offset += len as u64;
            }
        }
    }

    impl Drop for Log {
        fn drop(&mut self) {
            let _ = std::fs::remove_file(&self.path);
        }
    }

    #[test]
    fn waits_for_the_rest_of_a_record() {
        for cut in 1..record(1).len() {
            let mut log = Log::new("wait", &record(0));
            log.append(&record(1)[..cut]);
            assert_eq!(log.drain(), [0], "{cut}");
            assert_eq!(log.drain(), [0u8; 0], "{cut}");
            log.append(&record(1)[cut..]);
            log.append(&record(2));
            assert_eq!(log.drain(), [1, 2], "{cut}");
        }
    }

    #[test]
    fn a_false_frame_at_the_end_hides_nothing() {
        let junk = [0xFD, 0xFF, 0, 0, 0, 1, 1, 0, 0, 0, 7];
        for extra in [&[][..], &[1, 2, 3], &record(9)[..20]] {
            let log = [&record(0)[..], &[0; 8], &junk, &record(1), &record(2), extra].concat();
            assert_eq!(Log::new("end", &log).drain(), [0, 1, 2], "{extra:?}");
        }
    }

    /// A frame of system 0 with an unknown id, which is believed when the id was met before.
    fn doubtful(seq: u8) -> Vec<u8> {
        let body = [1, seq, 0, 1, 200, seq];
        let checksum = mavwire_core::x25::push(mavwire_core::x25::checksum(&body), 7);
        let stamp = (1_600_000_000_000_000 + u64::from(seq)).to_be_bytes();
        [&stamp[..], &[0xFE], &body, &checksum.to_le_bytes()].concat()
    }

    #[test]
    fn what_was_met_is_remembered_behind_a_false_frame_at_the_end() {
        let junk = [0xFD, 0xFF, 0, 0, 0, 1, 1, 0, 0, 0, 7];
        let before = [record(0), doubtful(1), doubtful(2)].concat();
        let log = [&before[..], &[0; 8], &junk, &doubtful(3), &record(4)].concat();
        assert_eq!(Log::new("met", &log).drain(), [0, 2, 3, 4]);
    }

    #[test]
    fn looking_elsewhere_starts_afresh() {
        let bytes: Vec<u8> = (0..5).flat_map(record).collect();
        let mut log = Log::new("seek", &bytes);
        assert_eq!(log.drain(), [0, 1, 2, 3, 4]);
        log.offset = 3 * record(0).len() as u64;
        assert_eq!(log.drain(), [3, 4]);
        log.offset = 1;
        assert_eq!(log.drain(), [1, 2, 3, 4]);
    }
}
