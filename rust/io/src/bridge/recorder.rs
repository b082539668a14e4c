//! Telemetry logs of the frames that a bridge passes, written by a thread of their own. A slow or full disk costs records,
//! which are counted, and never a frame on a link.
//!
//! A log holds no key material: what carries a key does not come here, and signatures are taken off (R53, R54). It ends
//! with a whole record in any case, and goes on when there is room again.

use std::fs::{File, OpenOptions};
use std::io::{self, Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use mavwire_core::frame::Header;
use mavwire_core::log::tlog::{STAMP_LEN, Stamp, recordable};

use super::frames::Frames;
use crate::clock;
use crate::error_text::in_words;

/// Bytes that wait for the disk at most.
const MAX_PENDING: usize = 16 << 20;
/// More than this is written without waiting for the interval to end.
const EAGER: usize = 256 << 10;
/// Longest wait for the disk at the end of a recording.
const CLOSE_TIME: Duration = Duration::from_millis(1_500);
/// Logs that can be begun in one second.
const MAX_TRIES: u32 = 1_000;

/// How to record.
#[derive(Debug, Clone)]
pub struct Recording {
    /// The directory; made if it is not there.
    pub directory: PathBuf,
    /// A new log is begun when one is this long; bytes.
    pub max_bytes: Option<u64>,
    /// A new log is begun when one is this old.
    pub max_age: Option<Duration>,
    /// Received frames are handed to the operating system after this long at the latest.
    pub flush_interval: Duration,
}

/// The state of a recording: its current log, and counts.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RecordingStats {
    /// The log that is being written.
    pub path: PathBuf,
    /// Logs begun.
    pub files: u64,
    /// Records written.
    pub records: u64,
    /// Their bytes.
    pub bytes: u64,
    /// Records that were not written.
    pub dropped: u64,
    /// Why, for the last of them, or why no new log could be begun; until that works again.
    pub error: Option<String>,
}

#[derive(Debug, Default)]
struct State {
    /// Whole records.
    pending: Vec<u8>,
    records: u64,
    stats: RecordingStats,
    stopping: bool,
    /// Everything has been written.
    ended: bool,
}

impl State {
    /// Makes room if the disk is too slow. The newest records stay: they show how a flight ended.
    fn drop_older_half(&mut self) {
        let (mut len, mut count) = (0, 0);
        for record in lengths(&self.pending) {
            if len >= self.pending.len() / 2 {
                break;
            }
            len += record;
            count += 1;
        }
        self.pending.drain(..len);
        self.records -= count;
        self.stats.dropped += count;
        self.stats.error = Some("the disk is too slow".into());
    }
}

#[derive(Debug, Default)]
struct Shared {
    state: Mutex<State>,
    wake: Condvar,
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A recording under way; dropping it writes what is left, and leaves no log behind that has nothing in it. A disk that has
/// stalled is not waited for: what is left goes to it when it goes on, if the program still runs then.
#[derive(Debug)]
pub(super) struct Recorder {
    shared: Arc<Shared>,
}

impl Recorder {
    /// Begins the first log.
    ///
    /// # Errors
    /// Errors of the operating system, from the directory or the file.
    pub(super) fn start(recording: Recording) -> io::Result<Self> {
        std::fs::create_dir_all(&recording.directory)?;
        let log = Log::begin(&recording.directory)?;
        Self::with_log(recording, log)
    }

    fn with_log(recording: Recording, log: Log) -> io::Result<Self> {
        let shared = Arc::new(Shared::default());
        shared.state().stats =
            RecordingStats { path: log.path.clone(), files: 1, ..Default::default() };
        let writer = Writer { recording, shared: Arc::clone(&shared), log };
        std::thread::Builder::new().name("mavwire-recorder".into()).spawn(move || writer.run())?;
        Ok(Self { shared })
    }

    pub(super) fn append(&self, frames: &Frames) {
        let mut state = self.shared.state();
        for (info, bytes) in frames.iter() {
            if state.pending.len() > MAX_PENDING {
                state.drop_older_half();
            }
            state.pending.extend_from_slice(&Stamp::encode(info.time, 0));
            state.pending.extend_from_slice(&recordable(bytes));
            state.records += 1;
        }
        if state.pending.len() > EAGER {
            self.shared.wake.notify_one();
        }
    }

    pub(super) fn stats(&self) -> RecordingStats {
        self.shared.state().stats.clone()
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        let mut state = self.shared.state();
        state.stopping = true;
        self.shared.wake.notify_all();
        drop(self.shared.wake.wait_timeout_while(state, CLOSE_TIME, |state| !state.ended));
    }
}

#[derive(Debug)]
struct Log {
    path: PathBuf,
    file: File,
    begun: Instant,
    /// Bytes up to the end of the last whole record.
    len: u64,
}

impl Log {
    /// A log that was not there before, named after the time.
    fn begin(directory: &Path) -> io::Result<Self> {
        let name = utc_name(clock::unix_seconds() as libc::time_t);
        for n in 0..MAX_TRIES {
            let suffix = if n == 0 { String::new() } else { format!("-{n}") };
            let path = directory.join(format!("{name}{suffix}.tlog"));
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Ok(file) => return Ok(Self { path, file, begun: Instant::now(), len: 0 }),
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                Err(error) => return Err(error),
            }
        }
        Err(io::ErrorKind::AlreadyExists.into())
    }

    /// Writes records, as far as there is room for whole ones: how many bytes of them, and why not all.
    fn write(&mut self, records: &[u8]) -> (usize, io::Result<()>) {
        let mut written = 0;
        while written < records.len() {
            match self.file.write(&records[written..]) {
                Ok(0) => return self.cut(&records[..written], io::ErrorKind::WriteZero.into()),
                Ok(len) => written += len,
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return self.cut(&records[..written], error),
            }
        }
        self.len += written as u64;
        (written, Ok(()))
    }

    /// Takes half a record off the end again.
    fn cut(&mut self, written: &[u8], error: io::Error) -> (usize, io::Result<()>) {
        let whole = lengths(written).sum();
        self.len += whole as u64;
        let _ = self.file.set_len(self.len);
        let _ = self.file.seek(SeekFrom::Start(self.len));
        (whole, Err(error))
    }

    fn discard_if_empty(&self) {
        if self.len == 0 {
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

/// How long each record is that is whole.
fn lengths(bytes: &[u8]) -> impl Iterator<Item = usize> {
    let mut at = 0;
    std::iter::from_fn(move || {
        let frame = Header::parse(bytes.get(at + STAMP_LEN..)?)?;
        let len = STAMP_LEN + frame.frame_len();
        at += len;
        (at <= bytes.len()).then_some(len)
    })
}

struct Writer {
    recording: Recording,
    shared: Arc<Shared>,
    log: Log,
}

impl Writer {
    fn run(mut self) {
        loop {
            let (records, count, stopping) = self.wait();
            if !records.is_empty() {
                // Where no new log can be begun, the old one goes on, and the next records try again.
                let rotated = self.rotate();
                let (len, written) = self.log.write(&records);
                let kept = if len == records.len() {
                    count
                } else {
                    lengths(&records[..len]).count() as u64
                };
                let stats = &mut self.shared.state().stats;
                stats.path.clone_from(&self.log.path);
                stats.records += kept;
                stats.bytes += len as u64;
                stats.dropped += count - kept;
                stats.error = written.and(rotated).err().map(|error| in_words(&error));
            }
            if stopping {
                self.log.discard_if_empty();
                self.shared.state().ended = true;
                return self.shared.wake.notify_all();
            }
        }
    }

    /// Waits for the end of the interval, or for much to write.
    fn wait(&self) -> (Vec<u8>, u64, bool) {
        let deadline = Instant::now() + self.recording.flush_interval;
        let mut state = self.shared.state();
        while !state.stopping && state.pending.len() <= EAGER {
            let left = deadline.saturating_duration_since(Instant::now());
            if left.is_zero() {
                break;
            }
            let woken = self.shared.wake.wait_timeout(state, left);
            state = woken.unwrap_or_else(PoisonError::into_inner).0;
        }
        let records = std::mem::take(&mut state.pending);
        (records, std::mem::take(&mut state.records), state.stopping)
    }

    /// Begins a new log if this one is long or old enough.
    fn rotate(&mut self) -> io::Result<()> {
        let Recording { max_bytes, max_age, directory, .. } = &self.recording;
        let is_long = max_bytes.is_some_and(|most| self.log.len >= most);
        let is_old = max_age.is_some_and(|most| self.log.begun.elapsed() >= most);
        if self.log.len > 0 && (is_long || is_old) {
            self.log = Log::begin(directory)?;
            self.shared.state().stats.files += 1;
        }
        Ok(())
    }
}

/// A time as part of a file name, such as `20260131-235959`; UTC.
fn utc_name(seconds: libc::time_t) -> String {
    // SAFETY: all zero is a valid value for this structure.
    let mut utc: libc::tm = unsafe { std::mem::zeroed() };
    // SAFETY: both pointers are to values that live until the call returns. It keeps none of them.
    unsafe { libc::gmtime_r(&raw const seconds, &raw mut utc) };
    let (year, month, day) = (utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday);
    let (hour, minute, second) = (utc.tm_hour, utc.tm_min, utc.tm_sec);
    format!("{year:04}{month:02}{day:02}-{hour:02}{minute:02}{second:02}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bridge::frames::FrameInfo;

    /// Frames of version 1 whose sequence numbers count up.
    fn frames(count: usize) -> Frames {
        let mut frames = Frames::default();
        for n in 0..count {
            let mut bytes = [0; 20];
            bytes[..6].copy_from_slice(&[0xFE, 12, n as u8, 1, 1, 0]);
            let info =
                FrameInfo { len: 20, time: 1, link: 1, sysid: 1, compid: 1, msgid: 0, index: None };
            frames.push(&bytes, info);
        }
        frames
    }

    #[test]
    fn a_stalled_disk_costs_the_oldest_records_and_keeps_nobody() {
        let (reader, disk) = io::pipe().expect("a pipe");
        let file = File::from(std::os::fd::OwnedFd::from(disk));
        let log = Log { path: PathBuf::new(), file, begun: Instant::now(), len: 0 };
        let recording = Recording {
            directory: PathBuf::new(),
            max_bytes: None,
            max_age: None,
            flush_interval: Duration::ZERO,
        };
        let recorder = Recorder::with_log(recording, log).expect("a thread");
        let mut given = 0;
        while recorder.stats().dropped == 0 {
            recorder.append(&frames(10_000));
            given += 10_000;
            assert!(given < 10_000_000, "nothing is dropped");
        }
        let state = recorder.shared.state();
        assert!(state.pending.len() <= MAX_PENDING + 256);
        assert_eq!(state.stats.error.as_deref(), Some("the disk is too slow"));
        let last = lengths(&state.pending).last().map(|len| state.pending.len() - len);
        assert_eq!(last.map(|at| state.pending[at + STAMP_LEN + 2]), Some(9_999_u32 as u8));
        drop(state);
        let begun = Instant::now();
        drop(recorder);
        assert!(begun.elapsed() < Duration::from_secs(2));
        drop(reader);
    }

    #[test]
    fn times_are_written_as_utc() {
        for (seconds, name) in [
            (0, "19700101-000000"),
            (951_782_399, "20000228-235959"),
            (951_782_400, "20000229-000000"),
            (1_735_689_599, "20241231-235959"),
            (1_767_225_600, "20260101-000000"),
            (4_107_542_400, "21000301-000000"),
        ] {
            assert_eq!(utc_name(seconds), name);
        }
    }
}
