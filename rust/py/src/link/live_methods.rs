//! Receiving from a `LiveLink`, and its other Python methods.

use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::{Duration, Instant};

use mavwire_io::readiness;
use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList, PyString, PyTuple, PyType};

use crate::link::filter::Filter;
use crate::link::live_failure::Failure;
use crate::link::live_link::{LiveLink, QUICK_METHODS};
use crate::link::live_receive;
use crate::link::live_receive::Received;
use crate::link::live_source::{LiveSource, Transport};
use crate::link::peers::{from_python, to_python};
use crate::link::state::{Link, overrides, set_attr};
use crate::message::object::{Message, Origin};
use crate::protocol::mavlink::MAVLink;
use crate::python::calling::{Calling, truth};
use crate::sync::gil_yield::GilYield;
use crate::sync::lock::Lock;
use crate::sync::slot::Slot;

/// Messages that do not match between two looks whether others should have a turn.
const TURN_INTERVAL: u64 = 256;
/// How long one wait may last before the user's signals are looked at: those that another thread received end no wait.
const WAIT_SLICE: Duration = Duration::from_millis(200);

/// How often an idle link does what Python has to do for it.
const TEND_INTERVAL: Duration = Duration::from_secs(1);

impl LiveLink {
    pub(crate) fn next_message<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<Option<Bound<'py, Message>>> {
        if Self::is_quick(slf) {
            let received = live_receive::next_message(slf);
            if is_silence_or_garbage(&received) {
                Self::tend(slf)?;
            }
            if let Some(message) = received?.message() {
                return Ok(message);
            }
        }
        let message = slf.invoke_method0(intern!(slf.py(), "_recv_msg_slowly"))?;
        if message.is_none() { Ok(None) } else { Ok(Some(message.cast_into::<Message>()?)) }
    }

    /// Now and then lets Python flush the log and see whether somebody waits for a client that says nothing sensible.
    fn tend(slf: &Bound<'_, Self>) -> PyResult<()> {
        let records = slf.as_super().get().state().records_messages();
        if slf.get().source().is_time_to_tend(records, Instant::now(), TEND_INTERVAL) {
            slf.invoke_method0(intern!(slf.py(), "_tend"))?;
        }
        Ok(())
    }

    /// Waits until data may be there, `deadline` has come or the idle hooks are due.
    fn wait(
        slf: &Bound<'_, Self>,
        timeout: Option<f64>,
        deadline: Option<Instant>,
    ) -> PyResult<()> {
        let py = slf.py();
        let hooks = slf.attribute(intern!(py, "idle_hooks"))?;
        let has_hooks = hooks.cast::<PyList>().map_or(true, |hooks| !hooks.is_empty());
        let fd = slf.attribute(intern!(py, "fd"))?.extract::<i32>().ok();
        let Some(fd) = fd.filter(|_| !has_hooks) else {
            let remaining = deadline
                .map(|deadline| deadline.saturating_duration_since(Instant::now()).as_secs_f64());
            slf.invoke_method1(intern!(py, "_idle_for"), (timeout, remaining))?;
            return Ok(());
        };
        let mut slice = WAIT_SLICE;
        if let Some(deadline) = deadline {
            slice = slice.min(deadline.saturating_duration_since(Instant::now()));
        }
        let writable = slf.get().source().has_unsent;
        let ready = if slice.is_zero() {
            readiness::ready(fd, writable, slice)
        } else {
            py.detach(|| readiness::ready(fd, writable, slice))
        };
        py.check_signals()?;
        match ready {
            // The next read says whether there is anything.
            Ok(true) => slf.get().source().drained = false,
            Err(error) if error.kind() != std::io::ErrorKind::Interrupted => {
                slf.get().source().drained = false;
                py.detach(|| std::thread::sleep(slice.min(Duration::from_millis(10))));
            }
            _ => {}
        }
        Ok(())
    }
}

#[pymethods]
impl LiveLink {
    #[classattr]
    const _QUICK_METHODS: [&'static str; 11] = QUICK_METHODS;

    #[new]
    #[classmethod]
    #[pyo3(signature = (*_args, **_kwargs))]
    fn new(
        cls: &Bound<'_, PyType>,
        _args: &Bound<'_, PyTuple>,
        _kwargs: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<PyClassInitializer<Self>> {
        let link = Self {
            source: Lock::new(LiveSource::new()),
            failure: Failure::none(),
            plain_port: Slot::new(),
            quick: AtomicBool::new(cfg!(unix) && !overrides(cls)?),
        };
        Ok(PyClassInitializer::from(Link::empty()).add_subclass(link))
    }

    fn __setattr__(
        slf: &Bound<'_, Self>,
        name: &Bound<'_, PyString>,
        value: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        set_attr(slf.as_any(), name, value, &QUICK_METHODS, &slf.get().quick)
    }

    fn __delattr__(slf: &Bound<'_, Self>, name: &Bound<'_, PyString>) -> PyResult<()> {
        slf.set_generic_attribute(name, None)
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        self.failure.traverse(&visit)?;
        self.plain_port.traverse(visit)
    }

    fn __clear__(&self) {
        self.failure.clear();
        self.plain_port.set(None);
    }

    /// From now on `port` may be read natively, as a stream. Servers for one client at a time look after it while nothing
    /// arrives.
    #[pyo3(signature = (serves_one = false))]
    fn _read_stream(&self, serves_one: bool) {
        let mut source = self.source();
        source.transport = Transport::Stream;
        source.serves_one = serves_one;
    }

    /// From now on `port` may be read natively, as datagrams. Those from `own` address are left out.
    #[pyo3(signature = (own = None))]
    fn _read_datagrams(&self, own: Option<&Bound<'_, PyAny>>) {
        let own = own.and_then(from_python);
        self.source().transport = Transport::Datagrams(own);
    }

    /// Raises the error with which reading `port` natively ended; the system does not say it again.
    fn _raise_read_error(&self, port: &Bound<'_, PyAny>) -> PyResult<()> {
        self.failure.raise(port)
    }

    /// Bytes wait to be sent, so that receiving has to go through Python, which sends them.
    #[getter(_has_unsent)]
    fn get_has_unsent(&self) -> bool {
        self.source().has_unsent
    }
    #[setter(_has_unsent)]
    fn set_has_unsent(&self, value: bool) {
        self.source().has_unsent = value;
    }

    /// Peers that had to make room for others.
    #[getter]
    fn peers_forgotten(&self) -> u64 {
        self.source().peers.forgotten
    }

    /// Whether data that was read ahead is buffered. The descriptor does not show such data.
    #[getter]
    fn _has_read_ahead(slf: &Bound<'_, Self>) -> bool {
        let state = slf.as_super().get().state();
        let waits = |mav: &Py<MAVLink>| mav.get().parser().may_hold_frame();
        !slf.get().source().inbox.is_empty() || state.native_mav.as_ref().is_some_and(waits)
    }

    /// A datagram that was read ahead, or the rest of one, with its sender; None if there is none.
    fn _take_datagram<'py>(
        slf: &Bound<'py, Self>,
    ) -> PyResult<Option<(Bound<'py, PyBytes>, Bound<'py, PyTuple>)>> {
        let py = slf.py();
        let Some((bytes, from)) =
            slf.get().source().inbox.front().map(|(bytes, from)| (bytes.to_vec(), from))
        else {
            return Ok(None);
        };
        slf.get().source().inbox.advance(bytes.len());
        Ok(Some((PyBytes::new(py, &bytes), to_python(py, from)?)))
    }

    /// What is parsed next comes from `address`: bytes of another peer's frame are put aside.
    fn _switch_peer(slf: &Bound<'_, Self>, address: &Bound<'_, PyAny>) {
        let Some(from) = from_python(address) else { return };
        let state = slf.as_super().get().state();
        if let Some(mav) = &state.native_mav {
            let mut source = slf.get().source();
            source.peers.switch(&mut mav.get().parser(), from);
        }
    }

    /// The next message, BAD_DATA and UNKNOWN included; None when nothing has arrived.
    fn recv_msg<'py>(slf: &Bound<'py, Self>) -> PyResult<Option<Bound<'py, Message>>> {
        Self::next_message(slf)
    }

    /// The next message of a `type` (name, list or set) for which `condition` holds.
    ///
    /// Messages that do not match are consumed, but have updated the state. Returns None when nothing is there, or when
    /// blocking, after `timeout` seconds.
    #[pyo3(signature = (condition = None, r#type = None, blocking = false, timeout = None))]
    fn recv_match<'py>(
        slf: &Bound<'py, Self>,
        condition: Option<&Bound<'py, PyAny>>,
        r#type: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = truth)] blocking: bool,
        timeout: Option<f64>,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        let py = slf.py();
        if !slf.get().quick.load(Relaxed) {
            let arguments = (condition, r#type, blocking, timeout);
            let slowly = intern!(py, "_recv_match_slowly");
            let message = slf.invoke_method1(slowly, arguments)?;
            return Ok((!message.is_none()).then_some(message));
        }
        let filter = Filter::new(r#type, false)?;
        let deadline = deadline_after(timeout);
        let (mut seen, mut gil_yield): (u64, _) = (0, GilYield::new());
        if blocking && Self::is_drained(slf) {
            Self::wait(slf, timeout, deadline)?;
        }
        loop {
            let message = Self::next_message(slf)?;
            let is_idle = message.is_none();
            if let Some(message) = message {
                if filter.wants(&message)?
                    && condition.map_or(Ok(true), |condition| {
                        let holds = intern!(py, "_condition_holds");
                        slf.invoke_method1(holds, (condition, &message))?.truth()
                    })?
                {
                    return Ok(Some(message.into_any()));
                }
                seen += 1;
                if seen.is_multiple_of(TURN_INTERVAL) {
                    gil_yield.give_way(py)?;
                }
            } else if !blocking {
                return Ok(None);
            }
            if deadline.is_some_and(|deadline| Instant::now() >= deadline) {
                return Ok(None);
            }
            if is_idle {
                Self::wait(slf, timeout, deadline)?;
            }
        }
    }
}

/// When a timeout in seconds ends; `None` for one that is beyond counting.
fn deadline_after(timeout: Option<f64>) -> Option<Instant> {
    let wait = timeout.map(|seconds| Duration::try_from_secs_f64(seconds.max(0.0)));
    Instant::now().checked_add(wait?.ok()?)
}

/// What came lets nobody say that the client is alive: nothing, or bytes that are no message.
fn is_silence_or_garbage(received: &PyResult<Received<'_>>) -> bool {
    match received {
        Ok(Received::Message(message)) => message.get().origin == Origin::Bad,
        Ok(Received::Nothing) | Err(_) => true,
        Ok(Received::Trouble) => false,
    }
}
