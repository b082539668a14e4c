//! An open dataflash log, binary or text.

use std::io;
use std::path::Path;
use std::sync::Arc;

use mavwire_core::log::dataflash::text::Delimiter;
use mavwire_core::log::dataflash::{ClockFinder, HEAD_LEN, Layout, Record, Units};

use crate::dataflash::DataflashFile;
use crate::log_contents::LogContents;
use crate::text_log::TextLogFile;

pub use crate::log_contents::{Contents, Entry};

/// Records between two looks at whether the user wishes to stop.
pub const BUDGET: u32 = 1 << 16;

/// Bytes between two calls of `progress`.
const PROGRESS: u64 = 64 * 1024;

/// A log.
#[derive(Debug, Clone)]
pub enum DataflashLog {
    /// A `.BIN` file.
    Binary(Box<DataflashFile>),
    /// A `.log` file.
    Text(Box<TextLogFile>),
}

/// How a search for a record ended.
#[derive(Debug, Clone, Copy)]
pub enum Step<T> {
    /// With a record of a wanted layout.
    Found(T),
    /// After as many other records as it may pass.
    Paused,
    /// At the end of the log.
    End,
}

impl DataflashLog {
    /// Opens a file and reads its FMT records.
    ///
    /// # Errors
    /// The error of the operating system.
    pub fn open(path: &Path, text: bool) -> io::Result<Self> {
        Ok(if text {
            Self::Text(Box::new(TextLogFile::open(path)?))
        } else {
            Self::Binary(Box::new(DataflashFile::open(path)?))
        })
    }

    /// Bytes of the file when it was opened.
    pub fn size(&self) -> u64 {
        match self {
            Self::Binary(file) => file.size(),
            Self::Text(file) => file.size(),
        }
    }

    /// The text between the values of a text log.
    pub fn delimiter(&self) -> Option<Delimiter> {
        match self {
            Self::Binary(_) => None,
            Self::Text(file) => Some(file.delimiter()),
        }
    }

    /// The layouts of the records.
    pub fn layouts(&self) -> &[Arc<Layout>] {
        match self {
            Self::Binary(file) => file.definitions().layouts(),
            Self::Text(file) => file.layouts(),
        }
    }

    /// Goes through the whole log. `progress` gets the offset now and then, and ends the run with false.
    ///
    /// # Errors
    /// The error of the operating system. `Interrupted` if `progress` ended the run.
    pub fn contents(&mut self, progress: &mut dyn FnMut(u64) -> bool) -> io::Result<Contents> {
        let (contents, late) = self.contents_with(Units::default(), progress)?;
        if !late {
            return Ok(contents);
        }
        // Units behind what they describe: a second run finds the instances of that.
        Ok(self.contents_with(contents.units, progress)?.0)
    }

    fn contents_with(
        &mut self,
        units: Units,
        progress: &mut dyn FnMut(u64) -> bool,
    ) -> io::Result<(Contents, bool)> {
        let (layouts, delimiter) = (self.layouts().to_vec(), self.delimiter());
        let is_time = |column: &String| matches!(column.as_str(), "TimeUS" | "TimeMS");
        let is_timed = |layout: &Arc<Layout>| layout.columns.iter().any(is_time);
        let timed: Vec<bool> = layouts.iter().map(is_timed).collect();
        let wanted = |clock: &ClockFinder| -> Vec<bool> {
            layouts.iter().map(|layout| !clock.is_settled() && clock.wants(layout)).collect()
        };
        let mut tally = LogContents::new(&layouts, units);
        let (mut record_bytes, mut last_timed) = (0, None);
        let mut clock = ClockFinder::default();
        let mut telling = wanted(&clock);
        self.each(progress, |entry, bytes| {
            record_bytes += entry.next - entry.offset;
            if timed[entry.layout] {
                last_timed = Some(entry.offset);
            }
            if telling[entry.layout] {
                let layout = &*layouts[entry.layout];
                let record = Record { layout, bytes, delimiter };
                if clock.add(layout, entry.offset, |index| record.number(index)) {
                    telling = wanted(&clock);
                }
            }
            tally.add(entry, bytes, delimiter);
        })?;
        match delimiter {
            None => tally.contents.junk = self.size() - record_bytes,
            Some(_) => tally.contents.last = last_timed.or(tally.contents.last),
        }
        tally.contents.clock = clock;
        Ok(tally.finish())
    }

    fn each(
        &mut self,
        progress: &mut dyn FnMut(u64) -> bool,
        mut record: impl FnMut(Entry, &[u8]),
    ) -> io::Result<()> {
        let (mut at, mut told) = (0, 0);
        while let Some(entry) = self.entry_at(at)? {
            at = entry.next;
            record(entry, self.bytes(entry));
            if at - told > PROGRESS {
                told = at;
                tell(progress, at)?;
            }
        }
        tell(progress, self.size())
    }

    /// Offsets of all records, by layout. `progress` is that of [`Self::contents`].
    ///
    /// # Errors
    /// Those of [`Self::contents`].
    pub fn offsets(&mut self, progress: &mut dyn FnMut(u64) -> bool) -> io::Result<Vec<Vec<u64>>> {
        let mut offsets = vec![Vec::new(); self.layouts().len()];
        self.each(progress, |entry, _| offsets[entry.layout].push(entry.offset))?;
        Ok(offsets)
    }

    /// The first record at or behind `offset`.
    ///
    /// # Errors
    /// The error of the operating system.
    #[inline]
    pub fn entry_at(&mut self, offset: u64) -> io::Result<Option<Entry>> {
        match self {
            Self::Binary(file) => file.entry_at(offset),
            Self::Text(file) => file.entry_at(offset),
        }
    }

    /// Finds the next record, of the `wanted` layouts if these are given, and moves `at` behind it. `budget` counts down the
    /// other records.
    ///
    /// # Errors
    /// The error of the operating system.
    #[inline]
    pub fn step(
        &mut self,
        at: &mut u64,
        wanted: Option<&[bool]>,
        budget: &mut u32,
    ) -> io::Result<Step<Entry>> {
        loop {
            if let (Self::Binary(file), Some(wanted)) = (&mut *self, wanted) {
                let passed;
                (*at, passed) = file.pass(*at, wanted, *budget)?;
                *budget -= passed;
            }
            if *budget == 0 {
                return Ok(Step::Paused);
            }
            let Some(entry) = self.entry_at(*at)? else { return Ok(Step::End) };
            *at = entry.next;
            if wanted.is_none_or(|wanted| wanted[entry.layout]) {
                return Ok(Step::Found(entry));
            }
            *budget -= 1;
        }
    }

    /// The body, or the line, of the record that was found last.
    #[inline]
    pub fn bytes(&self, entry: Entry) -> &[u8] {
        match self {
            Self::Binary(file) => file.bytes_at(entry.offset, entry.len).get(HEAD_LEN..),
            Self::Text(file) => Some(file.bytes_at(entry.offset, entry.len)),
        }
        .unwrap_or_default()
    }
}

fn tell(progress: &mut dyn FnMut(u64) -> bool, at: u64) -> io::Result<()> {
    if progress(at) { Ok(()) } else { Err(io::ErrorKind::Interrupted.into()) }
}

#[cfg(test)]
mod tests {
    use mavwire_core::log::dataflash::ClockUnit;

    use super::*;

    const TEXT: &str = "FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n\
        FMT, 1, 30, GPS, QHI, TimeUS,GWk,GMS\nFMT, 2, 30, ATT, QB, TimeUS,I\n\
        ATT, 4000, 3\nGPS, 5000, 0, 1\nATT, 6000, x\nGPS, 7000, 1800, 1000\nGPS, 8000, 1801, 1\n";

    fn log(name: &str) -> DataflashLog {
        let path = std::env::temp_dir().join(format!("mavwire-{}-{name}.log", std::process::id()));
        std::fs::write(&path, TEXT).expect("a file");
        let log = DataflashLog::open(&path, true).expect("a log");
        std::fs::remove_file(&path).expect("a file");
        log
    }

    #[test]
    fn the_clock_is_that_of_the_first_record_that_tells_it() {
        let clock = log("clock").contents(&mut |_| true).expect("a log").clock;
        let told = clock.told().expect("a record");
        let at = TEXT.find("GPS, 7000").expect("the record") as u64;
        assert_eq!((told.unit, told.at), (ClockUnit::Micros, at));
        let clock = clock.finish().expect("a clock");
        assert_eq!(clock.first - clock.base, 4000);
    }

    #[test]
    fn a_step_passes_unwanted_records_and_counts_them() {
        let mut log = log("steps");
        let wanted: Vec<bool> = log.layouts().iter().map(|layout| layout.name == "ATT").collect();
        let (mut at, mut texts) = (0, Vec::new());
        let mut budget = 5;
        while let Step::Found(entry) = log.step(&mut at, Some(&wanted), &mut budget).expect("a log")
        {
            let layout = log.layouts()[entry.layout].clone();
            texts.push(
                Record { layout: &layout, bytes: log.bytes(entry), delimiter: log.delimiter() }
                    .text(1),
            );
        }
        assert_eq!((texts, budget), (vec![Some("3".to_owned()), None], 0));
        let step = log.step(&mut at, Some(&wanted), &mut 5).expect("a log");
        assert!(matches!(step, Step::End));
    }
}
