//! The reader below `DFReader`'s classes: finds, filters and makes messages; Python is called for the few types that
//! change a vehicle's state.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;

use mavwire_core::log::dataflash::text::Delimiter;
use mavwire_core::log::dataflash::{ClockFinder, ClockUnit};
use mavwire_io::dataflash_log::{BUDGET, Contents, DataflashLog, Step};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyString};
use pyo3::{PyTraverseError, PyVisit};

use super::clock::MicrosClock;
use super::message::DFMessage;
use super::shape;
use super::state::{Kind, State, Taken, closed};
use crate::python::calling::{Calling, truth};
use crate::python::instance_dict::generic_setattr;
use crate::python::lists::list;
use crate::python::own_methods::OwnMethods;
use crate::sync::gil_yield::GilYield;
use crate::sync::lock::Lock;

/// Keys of `messages` beyond which no further instances are added.
const MAX_MESSAGES: usize = 1 << 16;

/// Types whose messages change the state of the vehicle, and are read whichever type is asked for.
const STATE_TYPES: [&str; 6] = ["MODE", "MSG", "PARM", "STAT", "ORGN", "VER"];

/// Base of the readers of dataflash logs.
#[pyclass(frozen, subclass, weakref, module = "mavwire._native")]
pub(crate) struct DataflashReader {
    state: Lock<State>,
    methods: OwnMethods,
}

/// Methods that native code does not call, unless a program replaced one.
const QUICK_METHODS: [&str; 5] =
    ["recv_msg", "_parse_next", "_add_msg", "_set_time", "skip_to_type"];

/// `recv_match`'s argument `type`: names, or `None` for any type.
struct Types<'py>(Option<Vec<Bound<'py, PyString>>>);

impl<'py> Types<'py> {
    fn new(types: Option<&Bound<'py, PyAny>>) -> PyResult<Self> {
        let Some(types) = types else { return Ok(Self(None)) };
        if let Ok(name) = types.cast::<PyString>() {
            return Ok(Self(Some(vec![name.clone()])));
        }
        let Ok(items) = types.try_iter() else {
            return Err(PyTypeError::new_err("type must be a name or a collection of names"));
        };
        let names = items.filter_map(|name| name.map(|name| name.cast_into().ok()).transpose());
        Ok(Self(Some(names.collect::<PyResult<_>>()?)))
    }

    fn has(&self, name: &str) -> bool {
        let is_it = |one: &Bound<'_, PyString>| one.to_str().is_ok_and(|one| one == name);
        self.0.as_ref().is_none_or(|names| names.iter().any(is_it))
    }
}

impl DataflashReader {
    /// The next message, posted; `None` at the end.
    fn next<'py>(slf: &Bound<'py, Self>, latched: bool) -> PyResult<Option<Bound<'py, DFMessage>>> {
        let py = slf.py();
        let mut gil_yield = GilYield::new();
        loop {
            let found = slf.get().state.lock(py).next(slf.as_any(), latched, true, BUDGET)?;
            match found {
                Step::Found(taken) => return Self::post(slf, taken).map(Some),
                Step::Paused => gil_yield.give_way(py)?,
                Step::End => return Ok(None),
            }
        }
    }

    /// Stamps a message and takes it into `messages` and the state.
    fn post<'py>(slf: &Bound<'py, Self>, taken: Taken) -> PyResult<Bound<'py, DFMessage>> {
        let py = slf.py();
        let Taken { message, key, stamped, tracked, .. } = taken;
        let message = Bound::new(py, message)?;
        if !stamped {
            slf.invoke_method1(intern!(py, "_set_time"), (&message,))?;
        }
        Self::keep(slf, &message, key)?;
        if tracked {
            slf.invoke_method1(intern!(py, "_track"), (&message,))?;
        }
        Ok(message)
    }

    /// Makes a message the newest of its type and instance in `messages`.
    fn keep(
        slf: &Bound<'_, Self>,
        message: &Bound<'_, DFMessage>,
        key: Option<Py<PyString>>,
    ) -> PyResult<()> {
        let messages = slf.get().state.lock(slf.py()).messages.bind(slf.py()).clone();
        messages.set_item(&message.get().names.name, message)?;
        if let Some(key) = key
            && (messages.len() < MAX_MESSAGES || messages.contains(&key)?)
        {
            messages.set_item(key, message)?;
        }
        Ok(())
    }

    /// Fixes which layouts filtered reads visit, unless that is fixed already.
    fn latch(&self, py: Python<'_>, types: &Types<'_>, strict: bool) {
        let wants = |kind: &Kind| {
            let name = kind.names.layout.name.as_str();
            (!strict && STATE_TYPES.contains(&name)) || types.has(name)
        };
        let state = &mut *self.state.lock(py);
        state.latched.get_or_insert_with(|| state.kinds.iter().map(wants).collect());
    }

    /// Goes through the log without the global lock. `walk` gets a function to call with its offset. The function calls
    /// `progress` at each new percent, and returns false if that fails or a signal arrives. `ValueError` if the log is closed.
    fn walk<T: Send>(
        &self,
        py: Python<'_>,
        progress: Option<Py<PyAny>>,
        walk: impl Send + FnOnce(&mut DataflashLog, &mut dyn FnMut(u64) -> bool) -> io::Result<T>,
    ) -> PyResult<T> {
        let state = self.state.lock(py);
        let len = state.len.max(1);
        // With its own buffer: other threads and `progress` may read from the log meanwhile.
        let mut log = state.log.clone().ok_or_else(closed)?;
        drop(state);
        let (mut percent, mut failed) = (0, None);
        let result = py.detach(|| {
            walk(&mut log, &mut |at| {
                let now = at * 100 / len;
                let tell = now != percent;
                percent = now;
                let told = Python::attach(|py| {
                    py.check_signals()?;
                    match progress.as_ref().filter(|_| tell) {
                        Some(progress) => progress.bind(py).invoke1((now,)).map(drop),
                        None => Ok(()),
                    }
                });
                told.map_err(|error| failed = Some(error)).is_ok()
            })
        });
        match failed {
            Some(error) => Err(error),
            None => Ok(result?),
        }
    }
}

new! {
    DataflashReader: |cls| -> PyResult<Self> {
        let methods = OwnMethods::of_class(&QUICK_METHODS, cls)?;
        Ok(Self { state: Lock::new(State::new(cls.py())), methods })
    }
}

#[pymethods]
impl DataflashReader {
    #[classattr]
    const _QUICK_METHODS: [&'static str; 5] = QUICK_METHODS;

    fn __setattr__(
        slf: &Bound<'_, Self>,
        name: &Bound<'_, PyString>,
        value: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        slf.get().methods.set_attribute(slf.as_any(), name, value)
    }

    fn __delattr__(slf: &Bound<'_, Self>, name: &Bound<'_, PyString>) -> PyResult<()> {
        generic_setattr(slf, name, None)
    }

    /// Opens a log and returns its layouts: (type, length, name, format, columns) of each.
    fn _open<'py>(
        &self,
        py: Python<'py>,
        path: PathBuf,
        text: bool,
    ) -> PyResult<Bound<'py, PyList>> {
        let log = py.detach(|| DataflashLog::open(&path, text))?;
        let layouts = PyList::empty(py);
        for layout in log.layouts() {
            layouts.append((
                layout.type_id,
                layout.len,
                &layout.name,
                &layout.format,
                &layout.columns,
            ))?;
        }
        let mut state = self.state.lock(py);
        state.len = log.size();
        state.offset = 0;
        state.latched = None;
        let before = std::mem::take(&mut state.kinds);
        state.log = Some(log);
        drop(state);
        drop(before);
        Ok(layouts)
    }

    /// Goes through the log and returns what is in it: `counts` and `first` by layout, offsets of the first message of
    /// each of the `instances`, offset of the `last` record, bytes of `junk`, and the units: `labels`, `multipliers`,
    /// and (unit ids, multiplier ids) of `fields`. `clock` is the unit of the log's clock, the offset of the record that
    /// tells its zero, and the first time in the unit. `progress` is called with each new whole percent.
    fn _contents<'py>(
        &self,
        py: Python<'py>,
        progress: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let progress = progress.map(Bound::unbind);
        as_dict(py, &self.walk(py, progress, |log, tell| log.contents(tell))?)
    }

    /// Sets what messages of each layout need: its `DFFormat` and the index of its instance field.
    fn _set_kinds(
        &self,
        py: Python<'_>,
        #[pyo3(from_py_with = list)] kinds: Vec<(Bound<'_, PyAny>, Option<usize>)>,
    ) -> PyResult<()> {
        let mut made = Vec::new();
        for (format, instance) in kinds {
            let names = shape::of_format(&format)?;
            let name = names.layout.name.as_str();
            let tracked = STATE_TYPES.contains(&name) && name != "ORGN";
            made.push(Kind::new(names, format.unbind(), instance, tracked));
        }
        let before = std::mem::replace(&mut self.state.lock(py).kinds, made);
        drop(before);
        Ok(())
    }

    /// Lets the messages' times come from `clock` without calling Python; None to call `_set_time`.
    fn _set_native_clock(&self, py: Python<'_>, clock: Option<Py<MicrosClock>>) {
        let before = std::mem::replace(&mut self.state.lock(py).clock, clock);
        drop(before);
    }

    /// The text between values of a text log.
    fn _delimiter(&self, py: Python<'_>) -> Option<&'static str> {
        let state = self.state.lock(py);
        state.log.as_ref()?.delimiter().map(Delimiter::text)
    }

    /// The lines of a text log by their first characters, and how many there are at all.
    fn _lines(&self, py: Python<'_>) -> (Vec<(String, u64)>, u64) {
        let state = self.state.lock(py);
        let Some(DataflashLog::Text(file)) = &state.log else { return (Vec::new(), 0) };
        let counts = file.counts().into_iter().map(|(key, count)| (key.to_owned(), count));
        (counts.collect(), file.lines())
    }

    /// Offsets of all records, by layout.
    fn _offsets(&self, py: Python<'_>) -> PyResult<Vec<Vec<u64>>> {
        self.walk(py, None, |log, tell| log.offsets(tell))
    }

    /// Lets go of the file.
    fn _close(&self, py: Python<'_>) {
        self.state.lock(py).log = None;
    }

    /// Reads from the start again, of any types.
    fn _restart(&self, py: Python<'_>) {
        let mut state = self.state.lock(py);
        state.offset = 0;
        state.latched = None;
        state.filtered_offset = 0;
    }

    /// Layouts that filtered reads visit, None before the first after a rewind.
    fn _latched(&self, py: Python<'_>) -> Option<Vec<usize>> {
        let state = self.state.lock(py);
        let wanted = state.latched.as_ref()?;
        Some(wanted.iter().enumerate().filter(|(_, wanted)| **wanted).map(|(n, _)| n).collect())
    }

    /// The newest message of each type and instance, and the reader as `MAV`.
    #[getter]
    fn messages(&self, py: Python<'_>) -> Py<PyDict> {
        self.state.lock(py).messages.clone_ref(py)
    }

    #[setter]
    fn set_messages(&self, messages: Bound<'_, PyDict>) {
        let py = messages.py();
        let before = std::mem::replace(&mut self.state.lock(py).messages, messages.unbind());
        drop(before);
    }

    /// Where the next record is looked for.
    #[getter]
    fn offset(&self, py: Python<'_>) -> u64 {
        self.state.lock(py).offset
    }

    #[setter]
    fn set_offset(&self, py: Python<'_>, offset: u64) {
        self.state.lock(py).offset = offset;
    }

    /// Bytes of the log when it was opened.
    #[getter]
    fn data_len(&self, py: Python<'_>) -> u64 {
        self.state.lock(py).len
    }

    /// The next message, None at the end.
    fn recv_msg<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        if slf.get().methods.are_intact() {
            return Ok(Self::next(slf, false)?.into_pyobject(slf.py())?);
        }
        slf.invoke_method0(intern!(slf.py(), "_parse_next"))
    }

    /// The next message, after `_add_msg` has updated `messages` and the state.
    fn _parse_next<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, DFMessage>>> {
        let py = slf.py();
        let found = slf.get().state.lock(py).next(slf.as_any(), false, false, BUDGET)?;
        let Step::Found(taken) = found else { return Ok(None) };
        let message = Bound::new(py, taken.message)?;
        slf.invoke_method1(intern!(py, "_add_msg"), (&message,))?;
        Ok(Some(message))
    }

    /// Makes a message the newest of its type, and of its instance if it has one.
    fn _keep(slf: &Bound<'_, Self>, message: &Bound<'_, DFMessage>) -> PyResult<()> {
        let (py, this) = (slf.py(), message.get());
        let key = {
            let mut state = slf.get().state.lock(py);
            let kind = state.kinds.iter_mut().find(|kind| Arc::ptr_eq(&kind.names, &this.names));
            kind.and_then(|kind| kind.key(py, &this.bytes, this.delimiter))
        };
        Self::keep(slf, message, key)
    }

    /// The next message of the given types (a name or a collection of names) for which `condition` holds; None at the
    /// end.
    ///
    /// The types of the first call after a rewind are the types that later calls visit. A call with types goes on where the
    /// last such call ended, even if messages were read without types in between. Types with the state of the vehicle are
    /// read as well unless `strict`. `blocking` has no effect.
    #[pyo3(signature = (condition=None, r#type=None, blocking=false, strict=false))]
    fn recv_match<'py>(
        slf: &Bound<'py, Self>,
        condition: Option<Bound<'py, PyAny>>,
        r#type: Option<Bound<'py, PyAny>>,
        #[pyo3(from_py_with = truth)] blocking: bool,
        #[pyo3(from_py_with = truth)] strict: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let _ = blocking;
        let py = slf.py();
        if !slf.get().methods.are_intact() {
            let slowly = intern!(py, "_recv_match_slowly");
            return slf.invoke_method1(slowly, (condition, r#type, strict));
        }
        let types = Types::new(r#type.as_ref())?;
        let filtered = types.0.is_some();
        if filtered {
            slf.get().latch(py, &types, strict);
        }
        while let Some(message) = Self::next(slf, filtered)? {
            if !types.has(&message.get().names.layout.name) {
                continue;
            }
            match &condition {
                None => return Ok(message.into_any()),
                Some(condition) => {
                    let holds = slf.invoke_method1(intern!(py, "check_condition"), (condition,))?;
                    if holds.is_truthy()? {
                        return Ok(message.into_any());
                    }
                }
            }
        }
        Ok(py.None().into_bound(py))
    }

    /// Moves to the next record of a filtered read, or to the end. Filtered reads go on behind it.
    #[pyo3(signature = (r#type, strict=false))]
    fn skip_to_type(
        slf: &Bound<'_, Self>,
        r#type: Bound<'_, PyAny>,
        #[pyo3(from_py_with = truth)] strict: bool,
    ) -> PyResult<()> {
        let (py, this) = (slf.py(), slf.get());
        this.latch(py, &Types::new(Some(&r#type))?, strict);
        let mut gil_yield = GilYield::new();
        loop {
            let found = this.state.lock(py).next(slf.as_any(), true, false, BUDGET)?;
            match found {
                Step::Found(taken) => {
                    this.state.lock(py).offset = taken.offset;
                    return Ok(());
                }
                Step::Paused => gil_yield.give_way(py)?,
                Step::End => return Ok(()),
            }
        }
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        // SAFETY: the garbage collector runs attached.
        let Some(state) = (unsafe { self.state.try_lock() }) else { return Ok(()) };
        visit.call(&state.messages)?;
        visit.call(&state.clock)?;
        for kind in &state.kinds {
            visit.call(&kind.format)?;
        }
        Ok(())
    }
}

fn clock_of(finder: &ClockFinder) -> (&'static str, Option<u64>, f64) {
    let (told, clock) = (finder.told(), finder.clone().finish());
    let unit = told.map(|told| told.unit).or(clock.map(|clock| clock.unit));
    let first = clock.map_or(0, |clock| clock.first.saturating_sub(clock.base)) as f64;
    let (name, first) = match unit {
        Some(ClockUnit::Micros) => ("usec", first),
        Some(ClockUnit::Millis) => ("msec", first / 1e3),
        Some(ClockUnit::Start) => ("px4", first),
        Some(ClockUnit::Rates) | None => ("rates", 0.0),
    };
    (name, told.map(|told| told.at), first)
}

fn as_dict<'py>(py: Python<'py>, contents: &Contents) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("counts", &contents.counts)?;
    dict.set_item("first", &contents.first)?;
    dict.set_item("instances", &contents.instances)?;
    dict.set_item("last", contents.last)?;
    dict.set_item("junk", contents.junk)?;
    dict.set_item("clock", clock_of(&contents.clock))?;
    let units = &contents.units;
    dict.set_item("labels", &units.labels)?;
    dict.set_item("multipliers", &units.multipliers)?;
    dict.set_item("fields", &units.fields)?;
    Ok(dict)
}
