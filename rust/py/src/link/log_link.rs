//! `LogLink`: a telemetry log as a link. `mavutil.mavlogfile` and `mavmmaplog` derive from it.
//!
//! Native code reads the log as long as no program replaced a method of the link or the parser, and nothing is
//! recorded. See [`crate::link::receive`].

use pyo3::prelude::*;

use crate::link::log_wanted::{self, Wanted};
use crate::link::state::Link;
use crate::sync::lock::Lock;
use mavwire_io::log_index::LogIndex;

/// A telemetry log as a link.
#[pyclass(frozen, subclass, extends = Link, module = "mavwire._native")]
pub(crate) struct LogLink {
    pub(super) index: Lock<Option<LogIndex>>,
    pub(super) wanted: Lock<Option<Wanted>>,
}

impl LogLink {
    pub(super) fn is_indexed(slf: &Bound<'_, Self>) -> bool {
        slf.get().index.lock(slf.py()).is_some()
    }

    /// Goes on at the first of the records that begin at `offsets`, not at the place of reading.
    pub(crate) fn visit(slf: &Bound<'_, Self>, offsets: &[u64]) -> PyResult<()> {
        let mut state = slf.as_super().get().state();
        let state = &mut *state;
        let (Some(reader), Some(mav)) = (state.reader.as_mut(), state.native_mav.as_ref()) else {
            return Ok(());
        };
        let native = mav.get();
        let mut parser = native.parser();
        reader.visit(offsets, &parser, &native.dialect.get().registry)?;
        native.drop_unread(&mut parser);
        Ok(())
    }
}

#[pymethods]
impl LogLink {
    /// Continues at the record that begins at `offset`, not at the place of reading.
    #[pyo3(name = "_seek")]
    pub(crate) fn seek_to(slf: &Bound<'_, Self>, offset: u64) -> PyResult<()> {
        slf.as_super().get().mav(slf.py())?;
        Self::visit(slf, &[offset])
    }

    /// Seeks to the next record of the types in `type`, heartbeats or parameters.
    ///
    /// The types of the first call stay in force until `rewind`. Behind the last such record reading goes on record by
    /// record.
    pub(crate) fn skip_to_type(slf: &Bound<'_, Self>, r#type: &Bound<'_, PyAny>) -> PyResult<()> {
        let py = slf.py();
        let this = slf.get();
        if this.wanted.lock(py).is_none() {
            let names = log_wanted::names(r#type)?;
            let wanted = Wanted::new(&names, this.index.lock(py).as_ref())?;
            *this.wanted.lock(py) = Some(wanted);
        }
        let mut wanted = this.wanted.lock(py);
        match wanted.as_mut().and_then(Wanted::advance) {
            Some(rest) => Self::visit(slf, rest),
            None => Ok(()),
        }
    }
}
