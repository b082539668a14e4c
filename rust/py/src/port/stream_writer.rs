//! `StreamWriter`: whole frames to a stream that may take only part of one.
//!
//! A frame that was begun is always finished, because half a frame makes the peer drop the next ones. Bytes that the
//! peer does not take are queued up to a bound; beyond it, whole frames are dropped and counted.

use std::sync::atomic::AtomicU64;

use mavwire_core::frame::frames;
use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::port::ports;
use crate::port::stream_queue::StreamQueue;
use crate::python::lists;
use crate::sync::exclusive::Exclusive;
use crate::sync::lock::Lock;
use crate::sync::shared;
use crate::sync::slot::Slot;

/// Bytes that wait at most, unless a writer is made with another bound.
const MAX_UNSENT: usize = 1 << 20;
/// Bytes that one call of the system is offered at most.
const SEND_SIZE: usize = 1 << 16;

/// Outgoing bytes of a non-blocking stream socket, from any number of threads.
///
/// One thread sends at a time and takes along what others put into the queue meanwhile. Nobody waits for it, so that a
/// signal handler that writes in the middle of a write is no deadlock. No handler runs between the return of a native
/// `port.send` and the moment when what it sent leaves the queue.
#[pyclass(frozen, module = "mavwire._native")]
pub(crate) struct StreamWriter {
    max_unsent: usize,
    queue: Lock<StreamQueue>,
    sending: Exclusive,
    dropped_frames: AtomicU64,
    bytes_sent: AtomicU64,
    /// The port that was let go of last, which may still be open.
    ended: Slot,
}

impl StreamWriter {
    /// Forgets, in a forked process, the bytes that a thread of the parent was sending: the parent finishes those. This
    /// process may finish the bytes that merely wait, if the connection is its.
    #[inline]
    fn follow_fork(&self, py: Python<'_>) {
        if self.sending.free_after_fork() {
            self.queue.lock(py).forget();
        }
    }

    fn drop_frames(&self, count: usize) {
        shared::add(&self.dropped_frames, count as u64);
    }

    /// False if there is no room for the frame.
    fn add(&self, py: Python<'_>, frame: &[u8]) -> bool {
        let mut queue = self.queue.lock(py);
        let fits = queue.unsent().len() + frame.len() <= self.max_unsent;
        if fits {
            queue.add(frame);
        }
        fits
    }

    /// Bytes wait to be sent.
    pub(crate) fn is_waiting(&self, py: Python<'_>) -> bool {
        !self.queue.lock(py).unsent().is_empty()
    }

    /// Sends no more to `port`. Drops and counts what is queued. Returns the port before, since other threads may run while
    /// its last reference is dropped.
    #[must_use]
    pub(crate) fn end<'py>(&self, port: &Bound<'py, PyAny>) -> Option<Bound<'py, PyAny>> {
        let before = self.ended.get(port.py());
        self.ended.set(Some(port.clone().unbind()));
        self.clear(port.py());
        before
    }

    fn has_ended(&self, port: &Bound<'_, PyAny>) -> bool {
        self.ended.get(port.py()).is_some_and(|ended| ended.is(port))
    }

    /// Sends from the head of the queue; whether the peer may take more.
    fn send_some(&self, port: &Bound<'_, PyAny>) -> PyResult<bool> {
        let py = port.py();
        let (epoch, data) = {
            let queue = self.queue.lock(py);
            let unsent = queue.unsent();
            if unsent.is_empty() {
                return Ok(true);
            }
            // A copy, because others append to the queue meanwhile.
            (queue.epoch(), PyBytes::new(py, &unsent[..unsent.len().min(SEND_SIZE)]))
        };
        let Some(sent) = ports::send(port, data.as_any())? else { return Ok(false) };
        let sent = sent.extract::<usize>()?;
        self.queue.lock(py).take_off(epoch, sent);
        shared::add(&self.bytes_sent, sent as u64);
        Ok(true)
    }

    fn send(&self, port: &Bound<'_, PyAny>) -> PyResult<()> {
        let py = port.py();
        // The queue may belong to another connection by now.
        while !self.has_ended(port)
            && let Some(turn) = self.sending.take()
        {
            let goes_on = self.send_some(port);
            drop(turn);
            // Looked at after the turn: what came in between is nobody else's.
            if !(goes_on? && self.is_waiting(py)) {
                break;
            }
            py.check_signals()?;
        }
        Ok(())
    }

    fn write_bytes(&self, port: &Bound<'_, PyAny>, bytes: &[u8]) -> PyResult<()> {
        let py = port.py();
        self.follow_fork(py);
        let mut sent = Ok(());
        for frame in frames(bytes) {
            let mut fits = sent.is_ok() && !self.has_ended(port) && self.add(py, frame);
            if sent.is_ok() && !fits {
                sent = self.send(port);
                fits = sent.is_ok() && !self.has_ended(port) && self.add(py, frame);
            }
            if !fits {
                self.drop_frames(1);
            }
        }
        sent.and_then(|()| self.send(port))
    }
}

#[pymethods]
impl StreamWriter {
    #[new]
    #[pyo3(signature = (max_unsent = MAX_UNSENT))]
    fn new(max_unsent: usize) -> Self {
        Self {
            max_unsent,
            queue: Lock::new(StreamQueue::default()),
            sending: Exclusive::free(),
            dropped_frames: AtomicU64::new(0),
            bytes_sent: AtomicU64::new(0),
            ended: Slot::new(),
        }
    }

    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        self.ended.traverse(visit)
    }

    fn __clear__(&self) {
        self.ended.set(None);
    }

    /// The bytes that wait in the queue (a copy).
    #[getter]
    fn unsent<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        self.follow_fork(py);
        PyBytes::new(py, self.queue.lock(py).unsent())
    }

    /// Sends `frame`, or several side by side, after what is queued; `OSError` when the connection is gone, and then
    /// `clear` counts the frames.
    fn write(&self, port: &Bound<'_, PyAny>, frame: &Bound<'_, PyAny>) -> PyResult<()> {
        match frame.cast::<PyBytes>() {
            Ok(frame) => self.write_bytes(port, frame.as_bytes()),
            Err(_) => self.write_bytes(port, &lists::bytes(frame)?),
        }
    }

    /// Sends as much of the queue as the peer takes now.
    fn flush(&self, port: &Bound<'_, PyAny>) -> PyResult<()> {
        self.follow_fork(port.py());
        self.send(port)
    }

    /// Drops and counts what is queued: the connection it was meant for is gone.
    fn clear(&self, py: Python<'_>) {
        self.follow_fork(py);
        let count = self.queue.lock(py).forget();
        self.drop_frames(count);
    }
}

properties! {
    StreamWriter:

    /// Bytes that a port has taken.
    bytes_sent: u64 = |writer| (atomic writer.bytes_sent);
    /// Frames that were not sent.
    dropped_frames, set_dropped_frames: u64 = |writer| (atomic writer.dropped_frames);
}
