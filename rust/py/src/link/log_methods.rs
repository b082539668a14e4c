//! The Python methods of `LogLink`.

use std::path::PathBuf;

use mavwire_core::log::tlog::{Framing, Stamp};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::link::log_index_build;
use crate::link::log_link::LogLink;
use crate::link::log_wanted::Wanted;
use crate::link::state::Link;
use crate::link::tracking;
use crate::protocol::mavlink::MAVLink;
use crate::python::error::Result;
use crate::sync::lock::Lock;
use mavwire_io::log_index::LogIndex;
use mavwire_io::log_reader::{LogReader, seconds};

new! {
    LogLink: |cls| -> PyResult<PyClassInitializer<Self>> {
        let log = Self { index: Lock::new(None), wanted: Lock::new(None) };
        Ok(PyClassInitializer::from(Link::of_class(cls)?).add_subclass(log))
    }
}

#[pymethods]
impl LogLink {
    /// How much of the log is read, 0 to 100.
    #[getter(percent)]
    fn get_percent(slf: &Bound<'_, Self>) -> f64 {
        slf.as_super().get().state().percent
    }
    #[setter(percent)]
    fn set_percent(slf: &Bound<'_, Self>, value: f64) {
        slf.as_super().get().state().percent = value;
    }

    /// Opens the file for reading; `stamped` says that its records have time stamps, `now` is the clock.
    fn _open_reader(slf: &Bound<'_, Self>, path: PathBuf, stamped: bool, now: f64) -> PyResult<()> {
        let framing = if stamped { Framing::Stamped } else { Framing::Raw };
        let reader = LogReader::open(&path, framing, now)?;
        let mut state = slf.as_super().get().state();
        state.reception.record_time = Some(reader.time);
        state.reader = Some(Box::new(reader));
        Ok(())
    }

    /// Closes the file; from then on the log is at its end.
    fn _close_reader(slf: &Bound<'_, Self>) {
        slf.as_super().get().state().reader = None;
    }

    /// Position in the file.
    fn _tell(slf: &Bound<'_, Self>) -> PyResult<u64> {
        Ok(slf.as_super().get().with_reader(|reader| Ok(reader.offset))?.unwrap_or(0))
    }

    /// Reads from the start again, of any types.
    fn _restart(slf: &Bound<'_, Self>) -> PyResult<()> {
        *slf.get().wanted.lock(slf.py()) = None;
        Self::seek_to(slf, 0)
    }

    /// Reads the time stamp of the next record, unless the frame of the last one is still incomplete.
    fn pre_message(slf: &Bound<'_, Self>) -> PyResult<()> {
        let mut guard = slf.as_super().get().state();
        let state = &mut *guard;
        if let Some(reader) = state.reader.as_mut() {
            state.percent = reader.percent();
            // Programs that parse by themselves need not call `post_message`.
            let is_used = |mav: &Py<MAVLink>| mav.get().parser().unread().is_empty();
            if reader.in_frame && state.native_mav.as_ref().is_some_and(is_used) {
                reader.leave_record();
            }
            reader.begin_record()?;
            state.reception.record_time = Some(reader.time);
        }
        Ok(())
    }

    /// The time stamp `tbuf`, or the first one behind it that is within three days of the last good message. Moves the
    /// position over what it skips.
    fn scan_timestamp(slf: &Bound<'_, Self>, tbuf: &[u8]) -> PyResult<f64> {
        let (Some(stamp), 8) = (Stamp::parse(tbuf), tbuf.len()) else {
            return Err(PyValueError::new_err(format!(
                "a time stamp has 8 bytes, not {}",
                tbuf.len()
            )));
        };
        let time = slf.as_super().get().with_reader(|reader| reader.believable(stamp))?;
        Ok(time.unwrap_or_else(|| seconds(stamp)))
    }

    /// The last message that was read, None before the first. Of a type with instances this is an equal copy.
    #[getter]
    fn _last_message<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let py = slf.py();
        let fresh = slf.as_super().get().state().last_fresh;
        let Some((sysid, index)) = fresh else {
            let state = slf.as_super().get().state();
            return Ok(state.last.as_ref().map(|last| last.bind(py).clone().into_any()));
        };
        let mav = slf.as_super().get().mav(py)?;
        let name = &mav.get().dialect.get().registry.message(index).name;
        tracking::system(slf.as_super(), sysid)?.get().messages(py)?.get_item(name)
    }

    /// Time of the last message that was not BAD_DATA, None before the first.
    #[getter]
    fn _last_timestamp(slf: &Bound<'_, Self>) -> Option<f64> {
        slf.as_super().get().state().reader.as_ref().and_then(|reader| reader.last_good)
    }

    /// Records have time stamps, whether or not messages are stamped with them.
    #[getter]
    fn _stamped(slf: &Bound<'_, Self>) -> bool {
        let state = slf.as_super().get().state();
        state.reader.as_ref().is_none_or(|reader| reader.framing == Framing::Stamped)
    }

    /// Number of the link that the current record came from.
    #[getter]
    fn _link(slf: &Bound<'_, Self>) -> u8 {
        slf.as_super().get().state().reader.as_ref().map_or(0, |reader| reader.link)
    }

    /// Up to `n` bytes of the log; empty at its end.
    #[pyo3(signature = (n = None))]
    fn recv<'py>(slf: &Bound<'py, Self>, n: Option<usize>) -> PyResult<Bound<'py, PyBytes>> {
        let py = slf.py();
        let bytes = slf.as_super().get().with_reader(|reader| {
            if !reader.begin_record()? {
                return Ok(None);
            }
            let bytes = reader.take(n.unwrap_or(usize::from(u16::MAX)))?;
            // Unlike `new`, which panics where there is no memory.
            Ok(Some(PyBytes::new_with(py, bytes.len(), |into| {
                into.copy_from_slice(bytes);
                Ok(())
            })))
        })?;
        bytes.flatten().unwrap_or_else(|| Ok(PyBytes::new(py, b"")))
    }

    /// A message came out of the record: the next time stamp is due, whether or not `post_message` hears of this one.
    fn _end_record(slf: &Bound<'_, Self>) -> Result<()> {
        slf.as_super()
            .get()
            .with_reader(|reader| {
                reader.leave_record();
                Ok(())
            })
            .map(drop)
    }

    /// Indexes the log; `progress_callback` gets each new whole percent. The first record of each type is read for real.
    #[pyo3(signature = (progress_callback = None))]
    fn _build_index(
        slf: &Bound<'_, Self>,
        progress_callback: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let index = log_index_build::build(slf, progress_callback)?;
        *slf.get().index.lock(slf.py()) = Some(index);
        Ok(())
    }

    /// `[(message id, name, count), ...]` in the order in which the types first appear.
    fn _index_counts(&self, py: Python<'_>) -> Vec<(u32, String, usize)> {
        self.index.lock(py).as_ref().map(LogIndex::counts).unwrap_or_default()
    }

    /// Message ids that a filtered read visits; None before the first one.
    fn _wanted_ids(&self, py: Python<'_>) -> Option<Vec<u32>> {
        self.wanted.lock(py).as_ref().map(|wanted| wanted.ids.clone())
    }

    /// Where the record begins that a filtered read visited last, 0 before the first one.
    fn _visited_offset(&self, py: Python<'_>) -> u64 {
        self.wanted.lock(py).as_ref().and_then(Wanted::visited_offset).unwrap_or(0)
    }

    /// `[(message id, offsets of its records), ...]` in the order in which the types first appear.
    fn _index_offsets(&self, py: Python<'_>) -> Result<Vec<(u32, Vec<u64>)>> {
        let offsets = self.index.lock(py).as_ref().map(LogIndex::by_type).transpose();
        Ok(offsets?.unwrap_or_default())
    }
}
