//! Reading an indexed log only where messages of some types stand.

use pyo3::prelude::*;
use pyo3::types::PyString;

use crate::python::error::Result;
use crate::python::lists::collected;
use mavwire_io::log_index::LogIndex;

/// Always read beside the types that are asked for, because they keep the mode and the parameters current.
const ALWAYS_READ: [&str; 2] = ["HEARTBEAT", "PARAM_VALUE"];

/// Records of the wanted types, and how many of them were visited.
pub(crate) struct Wanted {
    pub(crate) ids: Vec<u32>,
    offsets: Vec<u64>,
    visited: usize,
}

impl Wanted {
    /// The records of the types called `names`; none without an index. `MemoryError` where there is no memory for them.
    pub(crate) fn new(names: &[String], index: Option<&LogIndex>) -> Result<Self> {
        let found = index.map(|index| index.select(names)).transpose();
        let (ids, offsets) = found?.unwrap_or_default();
        Ok(Self { ids, offsets, visited: 0 })
    }

    /// Where the records stand from the next one on, which counts as visited then; `None` behind the last.
    pub(crate) fn advance(&mut self) -> Option<&[u64]> {
        let rest = self.offsets.get(self.visited..).filter(|rest| !rest.is_empty())?;
        self.visited += 1;
        Some(rest)
    }

    /// Where the record begins that was visited last; `None` before the first one.
    pub(crate) fn visited_offset(&self) -> Option<u64> {
        self.offsets.get(self.visited.checked_sub(1)?).copied()
    }
}

/// The names of `types`, a name or an iterable of names, and of what is always read.
pub(crate) fn names(types: &Bound<'_, PyAny>) -> PyResult<Vec<String>> {
    let mut names: Vec<String> = match types.cast::<PyString>() {
        Ok(name) => vec![name.to_string_lossy().into_owned()],
        Err(_) => {
            let text =
                |name: PyResult<Bound<'_, PyAny>>| Ok(name?.str()?.to_string_lossy().into_owned());
            collected(types.try_iter()?.map(text))?
        }
    };
    names.extend(ALWAYS_READ.map(str::to_owned));
    Ok(names)
}
