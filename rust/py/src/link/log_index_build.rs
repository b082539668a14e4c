//! Building a log's index: Rust runs over the records, Python is asked about the first of each type and each instance.

use mavwire_core::frame::{STX_V1, STX_V2};
use mavwire_core::scan::Resync;
use mavwire_io::records::RecordFinder;
use mavwire_schema::WireVersion;
use pyo3::prelude::*;

use crate::link::log_link::LogLink;
use crate::link::log_receive;
use crate::python::calling::Calling;
use crate::python::error::Error;
use crate::sync::gil_yield::GilYield;
use mavwire_io::log_index::{Indexed, LogIndex, Stop, find_record};

/// Bytes between two looks whether others should have a turn.
const STRETCH: u64 = 4 * 1024 * 1024;

/// Indexes a log; `progress` gets each new whole percent. The first record of each type is read for real.
pub(crate) fn build(
    log: &Bound<'_, LogLink>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<LogIndex> {
    let size = log.as_super().get().with_reader(|reader| Ok(reader.size))?.unwrap_or(0);
    detect_version(log, size)?;
    let mav = log.as_super().get().mav(log.py())?;
    let registry = mav.get().dialect.get().registry.clone();
    let mut index = LogIndex::new(registry.clone());
    let mut reports = Progress { callback: progress, percent: 0, size };
    let (mut finder, mut gil_yield) = (None, GilYield::new());
    if mav.get().parser().resync() == Resync::Rescan {
        finder = Some(RecordFinder::default());
    }
    let mut offset = 0;
    loop {
        let limit = reports.limit(offset);
        let stop = log.as_super().get().with_reader(|reader| {
            index.extend(&mut reader.window, offset, limit, size, finder.as_mut())
        })?;
        offset = match stop {
            None => break,
            Some(Stop::End { next }) => {
                reports.report(next)?;
                break;
            }
            Some(Stop::Limit { next }) => next,
            Some(Stop::FirstOfType { index: found, record }) => {
                let name = &registry.message(found).name;
                add_first(log, &mut index, found, &record, name)?;
                record.next
            }
            Some(Stop::NewInstance { index: found, instance, next }) => {
                let name = &registry.message(found).name;
                log.invoke_method1("_index_instance", (name, instance))?;
                next
            }
        };
        reports.report(offset)?;
        gil_yield.give_way(log.py())?;
    }
    Ok(index)
}

/// Shows the marker of the first record to `auto_mavlink_version`, which may change the dialect.
fn detect_version(log: &Bound<'_, LogLink>, size: u64) -> PyResult<()> {
    if log.as_super().get().state().knows_version {
        return Ok(());
    }
    let first =
        log.as_super().get().with_reader(|reader| find_record(&mut reader.window, 0, size))?;
    let Some(Some(record)) = first else { return Ok(()) };
    let marker = match record.header.version {
        WireVersion::V1 => STX_V1,
        WireVersion::V2 => STX_V2,
    };
    log_receive::show_first_byte(log.as_super(), marker)
}

/// Reads the first record of a type and adds it, unless it is cut off.
fn add_first(
    log: &Bound<'_, LogLink>,
    index: &mut LogIndex,
    found: u16,
    record: &Indexed,
    name: &str,
) -> PyResult<()> {
    LogLink::seek_to(log, record.offset)?;
    let message = log.invoke_method0("recv_msg")?;
    index.forget_instances();
    if message.is_none() {
        return Ok(());
    }
    log.invoke_method1("_index_first", (name, message))?;
    index.add(found, record.offset).map_err(Error::from)?;
    let instance = log
        .as_super()
        .get()
        .with_reader(|reader| index.new_instance(&mut reader.window, found, record))?;
    if let Some(Some(instance)) = instance {
        log.invoke_method1("_index_instance", (name, instance))?;
    }
    Ok(())
}

/// Tells the callback how far the run is.
struct Progress<'a, 'py> {
    callback: Option<&'a Bound<'py, PyAny>>,
    percent: u64,
    size: u64,
}

impl Progress<'_, '_> {
    /// How far to go before there is something to report.
    fn limit(&self, offset: u64) -> u64 {
        match self.callback {
            // Small logs report after every record, as their percentages jump.
            Some(_) if self.size < 100_000 => offset,
            Some(_) => offset.saturating_add((self.size / 100).min(STRETCH)),
            None => offset.saturating_add(STRETCH),
        }
    }

    fn report(&mut self, offset: u64) -> PyResult<()> {
        let percent = 100 * offset.min(self.size) / self.size.max(1);
        if percent != self.percent {
            self.percent = percent;
            if let Some(callback) = self.callback {
                callback.invoke1((percent,))?;
            }
        }
        Ok(())
    }
}
