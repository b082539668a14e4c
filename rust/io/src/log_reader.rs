//! Reading a telemetry log record by record, with the outcome pymavlink's readers have, on damaged logs too.
//!
//! A record is a time stamp and a frame. On an intact log the reader looks at the frame where it is. All other bytes
//! go through the link's parser in the portions that pymavlink reads, because what comes out as BAD_DATA
//! depends on them.

use std::io;
use std::path::Path;
use std::sync::Arc;

use crate::records::RecordFinder;
use crate::window::FileWindow;
use mavwire_core::frame::{FrameBytes, MAX_FRAME_LEN};
use mavwire_core::log::tlog::{
    Ahead, Before, Checked, FoundRecord, Framing, MAX_JUMP, Rules, STAMP_LEN, Stamp,
};
use mavwire_core::parser::{Parser, Step};
use mavwire_core::registry::Registry;
use mavwire_core::scan::Resync;
use mavwire_core::telemetry::StreamClock;

/// After damage, a time stamp further than this from the last good one is not believed.
const MAX_JUMP_SECONDS: f64 = MAX_JUMP as f64 / 1e6;

/// Seconds of a time stamp, rounded as pymavlink rounds.
pub fn seconds(stamp: Stamp) -> f64 {
    stamp.micros() as f64 * 1.0e-6
}

/// The time stamp given to a frame of a raw stream.
fn raw_stamp(clock: &mut StreamClock, registry: &Registry, index: u16, frame: &[u8]) -> Stamp {
    Stamp(clock.hear(registry, index, frame).unwrap_or(0))
}

/// Position in a log and what the next record depends on.
pub struct LogReader {
    /// The file.
    pub window: FileWindow,
    finder: RecordFinder,
    ahead: Ahead,
    /// Where the next byte is read.
    pub offset: u64,
    /// Bytes of the file when it was opened.
    pub size: u64,
    /// Whether records have time stamps.
    pub framing: Framing,
    /// The times of a raw stream.
    clock: StreamClock,
    /// A time stamp is read and no message came out of its record yet: perhaps the file ended in between, and has grown
    /// since.
    in_record: bool,
    /// Bytes behind the time stamp were taken.
    pub in_frame: bool,
    /// The message before was BAD_DATA.
    after_damage: bool,
    /// Time of the last message that was not BAD_DATA.
    pub last_good: Option<f64>,
    /// The last good record's stamp in the log, if that was not believed, and the time that the record got instead.
    distrusted: Option<(u64, f64)>,
    /// Number of the link that the record came from.
    pub link: u8,
    /// Time of the record; 0 in a raw stream until its clock shows one.
    pub time: f64,
}

/// A record that is a good frame of a known message.
pub struct Peeked<'a> {
    /// Index of the message type.
    pub index: u16,
    /// Bytes of the frame, and those behind it.
    pub stream: &'a [u8],
    /// Bytes of the frame.
    pub len: usize,
    /// Seconds since 1970.
    pub time: f64,
    /// Number of the link that it came from.
    pub link: u8,
}

impl LogReader {
    /// Opens a log. `now` is the time in seconds since 1970.
    ///
    /// # Errors
    /// Those of opening and reading the file.
    pub fn open(path: &Path, framing: Framing, now: f64) -> io::Result<Self> {
        let window = FileWindow::open(path)?;
        let size = window.size()?;
        let time = if framing == Framing::Stamped { now } else { 0.0 };
        Ok(Self {
            window,
            finder: RecordFinder::new(framing),
            ahead: Ahead::default(),
            offset: 0,
            size,
            framing,
            clock: StreamClock::default(),
            in_record: false,
            in_frame: false,
            after_damage: false,
            last_good: None,
            distrusted: None,
            link: 0,
            time,
        })
    }

    /// Goes on at the record that begins at `offset`.
    pub fn seek(&mut self, offset: u64) {
        self.ahead.clear();
        self.offset = offset;
        self.in_record = false;
        self.after_damage = false;
    }

    /// How far the file is read, 0 to 100.
    #[inline]
    pub fn percent(&self) -> f64 {
        if self.size == 0 { 0.0 } else { 100.0 * self.offset as f64 / self.size as f64 }
    }

    /// Up to `wanted` bytes from the position on.
    pub fn take(&mut self, wanted: usize) -> io::Result<&[u8]> {
        self.ahead.clear();
        let bytes = self.window.at(self.offset, wanted)?;
        let bytes = &bytes[..wanted.min(bytes.len())];
        self.offset += bytes.len() as u64;
        self.in_frame |= !bytes.is_empty();
        Ok(bytes)
    }

    /// Reads the time stamp of the record at the position; false if the file ends before it is complete.
    pub fn begin_record(&mut self) -> io::Result<bool> {
        if self.framing == Framing::Raw || self.in_record {
            return Ok(true);
        }
        let Some(stamp) = Stamp::parse(self.window.at(self.offset, STAMP_LEN)?) else {
            return Ok(false);
        };
        self.offset += STAMP_LEN as u64;
        self.link = stamp.link();
        self.time = if self.after_damage { self.believable(stamp)? } else { seconds(stamp) };
        self.in_record = true;
        self.in_frame = false;
        Ok(true)
    }

    /// The next time stamp is due.
    pub fn leave_record(&mut self) {
        self.in_record = false;
    }

    /// A message came out of the record, perhaps BAD_DATA.
    pub fn end_record(&mut self, bad: bool) {
        self.in_record = false;
        self.after_damage = bad;
        if !bad {
            self.last_good = Some(self.time);
        }
    }

    fn end_step(&mut self, step: &Step, registry: &Registry) {
        if let Step::Frame { bytes, entry: Some(entry), .. } = step {
            self.hear_raw(registry, entry.index, bytes);
        }
        self.end_record(matches!(step, Step::Bad { .. }));
    }

    /// Takes the time from a frame of a raw stream.
    pub fn hear_raw(&mut self, registry: &Registry, index: u16, frame: &[u8]) {
        if self.framing == Framing::Raw {
            self.time = seconds(raw_stamp(&mut self.clock, registry, index, frame));
        }
    }

    /// Slides forward to a time stamp near the last good one.
    pub fn believable(&mut self, mut stamp: Stamp) -> io::Result<f64> {
        loop {
            let time = seconds(stamp);
            if self.last_good.is_none_or(|last| (time - last).abs() < MAX_JUMP_SECONDS) {
                return Ok(time);
            }
            let Some(&next) = self.window.at(self.offset, 1)?.first() else { return Ok(time) };
            self.offset += 1;
            stamp = Stamp(stamp.micros() << 8 | u64::from(next));
        }
    }

    /// The record at the position if it is a good frame of a known message and nothing makes it a special case.
    #[inline]
    pub fn peek(
        &mut self,
        parser: &Parser,
        registry: &Arc<Registry>,
    ) -> io::Result<Option<Peeked<'_>>> {
        if self.in_record || self.after_damage || !parser.unread().is_empty() {
            return Ok(None);
        }
        let rules = self.rules(parser, registry);
        let checked = match self.ahead.get(self.offset, rules) {
            Some(checked) => checked,
            None => match self.look_ahead(rules)? {
                Some(checked) => checked,
                None => return Ok(None),
            },
        };
        let lead = rules.lead;
        let len = usize::from(checked.len);
        let bytes = self.window.at(self.offset, lead + len)?;
        let Some(stream) = bytes.get(lead..).filter(|stream| stream.len() >= len) else {
            return Ok(None);
        };
        let index = checked.index;
        let stamp = match self.framing {
            Framing::Stamped => Stamp::parse(bytes).unwrap_or(Stamp(0)),
            Framing::Raw => raw_stamp(&mut self.clock, registry, index, stream),
        };
        let (time, link) = (seconds(stamp), stamp.link());
        Ok(Some(Peeked { index, stream, len, time, link }))
    }

    fn rules<'a>(&self, parser: &Parser, registry: &'a Arc<Registry>) -> Rules<'a> {
        Rules { registry, ignore_checksum: parser.scanner.ignore_checksum, lead: self.lead() }
    }

    /// Bytes of a record in front of its frame.
    pub fn lead(&self) -> usize {
        self.framing.lead()
    }

    #[inline(never)]
    fn look_ahead(&mut self, rules: Rules<'_>) -> io::Result<Option<Checked>> {
        let bytes = self.window.at(self.offset, rules.lead + MAX_FRAME_LEN)?;
        self.ahead.fill(self.offset, bytes, rules);
        Ok(self.ahead.get(self.offset, rules))
    }

    /// Goes on at the first of the records that begin at `offsets`; the others will be asked for after it.
    #[inline]
    pub fn visit(
        &mut self,
        offsets: &[u64],
        parser: &Parser,
        registry: &Arc<Registry>,
    ) -> io::Result<()> {
        let Some(&first) = offsets.first() else { return Ok(()) };
        if !self.ahead.expects(first) {
            self.seek(first);
            let rules = self.rules(parser, registry);
            self.window.at(first, rules.lead + MAX_FRAME_LEN)?;
            let window = &self.window;
            self.ahead.fill_at(offsets, |offset| window.buffered(offset), rules);
        }
        self.offset = first;
        self.in_record = false;
        self.after_damage = false;
        Ok(())
    }

    /// Goes over the record that `peek` gave.
    #[inline]
    pub fn accept(&mut self, len: usize, time: f64, link: u8) {
        self.offset += (self.lead() + len) as u64;
        self.ahead.advance();
        (self.time, self.link) = (time, link);
        self.last_good = Some(time);
    }

    /// The next thing in the log; `Step::Nothing` at its end. Also says how many bytes went through the parser.
    pub fn next(
        &mut self,
        parser: &mut Parser,
        registry: &Registry,
        robust: bool,
    ) -> io::Result<(Step, usize)> {
        self.ahead.clear();
        if self.framing == Framing::Stamped && parser.resync() == Resync::Rescan {
            return self.next_good(parser, registry);
        }
        let ready = self.begin_record()?;
        if ready && parser.unread().is_empty() {
            let bytes = self.window.at(self.offset, MAX_FRAME_LEN)?;
            if let Some((step, len)) = parser.look(bytes, registry) {
                self.offset += len as u64;
                self.end_step(&step, registry);
                return Ok((step, len));
            }
        }
        let mut fed = 0;
        loop {
            let wanted = if ready { parser.bytes_needed() } else { 0 };
            let bytes = self.take(wanted)?;
            let ended = bytes.is_empty();
            fed += bytes.len();
            parser.push(bytes);
            let mut step = parser.step(registry, robust);
            if ended && matches!(step, Step::Nothing) {
                step = parser.step_at_end(registry, robust);
            }
            match step {
                Step::Nothing if ended => return Ok((Step::Nothing, fed)),
                Step::Nothing => {}
                step => {
                    self.end_step(&step, registry);
                    return Ok((step, fed));
                }
            }
        }
    }

    /// The next good record under `Rescan`, or the bytes in front of it; `Step::Nothing` at the end of the log.
    fn next_good(&mut self, parser: &mut Parser, registry: &Registry) -> io::Result<(Step, usize)> {
        self.unread(parser);
        Ok(match self.next_record(registry)? {
            FoundRecord::Record { len, header, entry, .. } => {
                let len = len - STAMP_LEN;
                let bytes = FrameBytes::from(self.last(len)?);
                (Step::Frame { bytes, header, entry }, len)
            }
            FoundRecord::Junk { len } => {
                let bytes = FrameBytes::from(self.last(len)?);
                (Step::Bad { bytes, error: None }, len)
            }
            FoundRecord::Incomplete { .. } => (Step::Nothing, 0),
        })
    }

    /// Goes over the good record at the position, or over bytes that belong to none.
    #[inline]
    pub fn next_record(&mut self, registry: &Registry) -> io::Result<FoundRecord> {
        let found = self.finder.look(&mut self.window, self.offset, registry)?;
        match found {
            FoundRecord::Record { len, entry, .. } if self.framing == Framing::Raw => {
                let frame = self.window.at(self.offset, len)?;
                self.offset += len as u64;
                if let Some(entry) = entry {
                    let stamp = raw_stamp(&mut self.clock, registry, entry.index, frame);
                    self.time = seconds(stamp);
                }
                self.end_record(false);
            }
            FoundRecord::Record { len, stamp, .. } => {
                self.offset += len as u64;
                let is_believed = self.stamp(stamp);
                self.distrusted = (!is_believed).then_some((stamp.micros(), self.time));
                self.end_record(false);
            }
            FoundRecord::Junk { len } => {
                let stamp = Stamp::parse(self.window.at(self.offset, STAMP_LEN)?);
                self.offset += len as u64;
                self.after_damage = true;
                if self.framing == Framing::Stamped {
                    self.stamp(stamp.unwrap_or(Stamp(0)));
                }
                self.end_record(true);
            }
            FoundRecord::Incomplete { .. } => {}
        }
        Ok(found)
    }

    /// The `len` bytes in front of the position.
    #[inline]
    pub fn last(&mut self, len: usize) -> io::Result<&[u8]> {
        let bytes = self.window.at(self.offset - len as u64, len)?;
        bytes.get(..len).ok_or_else(|| io::ErrorKind::UnexpectedEof.into())
    }

    /// Takes over the time stamp of a record if it is believed, else the time of the last good one.
    fn stamp(&mut self, stamp: Stamp) -> bool {
        self.link = stamp.link();
        let doubted = self
            .last_good
            .filter(|&last| self.after_damage && !self.before(last).believes(stamp.micros()));
        self.time = doubted.unwrap_or_else(|| seconds(stamp));
        doubted.is_none()
    }

    /// The time and the stamp of the last good record, which judge the stamp of one after damage.
    fn before(&self, last: f64) -> Before {
        let time = (last * 1e6).round() as u64;
        // Others may have come since the one that was not believed.
        let said = self.distrusted.filter(|&(_, given)| given.to_bits() == last.to_bits());
        Before { time, stamp: said.map_or(time, |(stamp, _)| stamp) }
    }

    /// Goes back over what was read under `Skip` and not used.
    fn unread(&mut self, parser: &mut Parser) {
        if !parser.unread().is_empty() {
            self.offset = self.offset.saturating_sub(parser.clear() as u64);
        }
        if self.in_record {
            self.offset = self.offset.saturating_sub(STAMP_LEN as u64);
            self.in_record = false;
        }
    }
}
