//! The decision whether a received frame may pass.

use std::sync::atomic::Ordering::Relaxed;

use mavwire_core::frame::FrameRef;
use mavwire_core::pyfloat::write_repr;
use mavwire_core::signing::{Stream, Verdict};
use pyo3::exceptions::PyAssertionError;
use pyo3::prelude::*;
use pyo3::types::PyByteArray;

use crate::protocol::mavlink::{MAVLink, overridden};
use crate::protocol::signing::Signing;
use crate::python::calling::Calling;
use crate::sync::shared;

/// Signing timestamps per year, for the log line that pymavlink writes.
const UNITS_PER_YEAR: f64 = 100.0 * 1000.0 * 60.0 * 60.0 * 24.0 * 365.0;

/// The decision about a received frame.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Acceptance {
    /// No key is set, or the application lets it pass.
    Unchecked,
    /// The signature is good.
    Verified,
    Rejected,
}

impl Signing {
    /// Decides about a frame whose checksum is right or, with an unknown id, cannot be checked.
    pub(crate) fn accept(
        &self,
        mav: &Bound<'_, MAVLink>,
        bytes: &[u8],
        known: bool,
    ) -> PyResult<Acceptance> {
        let has_key = self.has_key.load(Relaxed);
        let Ok(frame) = FrameRef::parse(bytes) else {
            return Ok(if has_key { Acceptance::Rejected } else { Acceptance::Unchecked });
        };
        let header = frame.header();
        if header.is_signed() && (known || has_key) {
            shared::add(&self.seen, 1);
        }
        if !has_key {
            return Ok(Acceptance::Unchecked);
        }
        let is_good = if header.is_signed() && mav.get().is_overridden(overridden::SIGNATURE) {
            let arguments = (PyByteArray::new(mav.py(), bytes), header.sysid, header.compid);
            let method = intern!(mav.py(), "check_signature");
            mav.invoke_method1(method, arguments)?.is_truthy()?
        } else {
            let verdict = self.judge(&frame);
            log_verdict(mav, verdict)?;
            match verdict {
                Verdict::NoKey => return Ok(Acceptance::Unchecked),
                Verdict::Unsigned => return self.ask(mav, header.msgid),
                verdict => verdict.is_verified(),
            }
        };
        if is_good {
            shared::add(&self.good, 1);
            self.store_timestamp()?;
            return Ok(Acceptance::Verified);
        }
        shared::add(&self.bad, 1);
        self.ask(mav, header.msgid)
    }

    /// Asks the application about a frame that is not signed, or not well.
    fn ask(&self, mav: &Bound<'_, MAVLink>, msgid: u32) -> PyResult<Acceptance> {
        let Some(callback) = self.allow_unsigned.get(mav.py()) else {
            return Ok(Acceptance::Rejected);
        };
        if callback.invoke1((mav, msgid))?.is_truthy()? {
            shared::add(&self.passed, 1);
            return Ok(Acceptance::Unchecked);
        }
        shared::add(&self.rejected, 1);
        Ok(Acceptance::Rejected)
    }

    /// `mav.check_signature(...)`
    pub(crate) fn check(&self, mav: &Bound<'_, MAVLink>, bytes: &[u8]) -> PyResult<bool> {
        if !self.has_key.load(Relaxed) {
            return Err(PyAssertionError::new_err(()));
        }
        let Ok(frame) = FrameRef::parse(bytes) else { return Ok(false) };
        let verdict = self.judge(&frame);
        log_verdict(mav, verdict)?;
        Ok(verdict.is_verified())
    }
}

/// Writes to the dialect module's logger what pymavlink writes there.
fn log_verdict(mav: &Bound<'_, MAVLink>, verdict: Verdict) -> PyResult<()> {
    let lines: &[&str] = match verdict {
        Verdict::NoKey | Verdict::Unsigned | Verdict::Good { stream: Stream::Known } => {
            return Ok(());
        }
        Verdict::Good { stream: Stream::New } => &["new stream"],
        Verdict::OldTimestamp { .. } => &["old timestamp"],
        Verdict::NewStreamTooOld { timestamp, local } => {
            let mut line = String::from("bad new stream");
            for units in [timestamp, local] {
                line.push(' ');
                write_repr(&mut line, units as f64 / UNITS_PER_YEAR);
            }
            return log(mav, &line);
        }
        Verdict::TooFarAhead { .. } => &["timestamp too far ahead"],
        Verdict::Mismatch { stream: Stream::New } => &["new stream", "sig mismatch"],
        Verdict::Mismatch { stream: Stream::Known } => &["sig mismatch"],
    };
    lines.iter().try_for_each(|line| log(mav, line))
}

fn log(mav: &Bound<'_, MAVLink>, line: &str) -> PyResult<()> {
    let py = mav.py();
    let name = mav.get().dialect.get().global(py, "__name__")?;
    let logging = py.import(intern!(py, "logging"))?;
    let logger = logging.invoke_method1(intern!(py, "getLogger"), (name,))?;
    logger.invoke_method1(intern!(py, "info"), (line,))?;
    Ok(())
}
