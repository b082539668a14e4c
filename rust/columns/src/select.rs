//! Which records are wanted.

use mavwire_core::frame::Header;
use mavwire_core::log::tlog::Located;

use crate::scan::{Scanned, UNKNOWN};

/// Which records are wanted.
#[derive(Debug, Clone)]
pub struct Wanted {
    /// By message index; `None` for all.
    pub types: Option<Vec<bool>>,
    /// Ids that the dialect lacks; `None` for all of them.
    pub unknown: Option<Vec<u32>>,
    /// Names of the record types of a dataflash log; `None` for all.
    pub names: Option<Vec<String>>,
    /// By system id; `None` for all.
    pub systems: Option<Box<[bool; 256]>>,
    /// Seconds since 1970: the first that is wanted.
    pub start: f64,
    /// The first that is not any more.
    pub end: f64,
}

impl Default for Wanted {
    fn default() -> Self {
        Self {
            types: None,
            unknown: None,
            names: None,
            systems: None,
            start: f64::NEG_INFINITY,
            end: f64::INFINITY,
        }
    }
}

impl Wanted {
    /// Whether a record type of a dataflash log is wanted.
    pub(crate) fn wants_name(&self, name: &str) -> bool {
        self.names.as_ref().is_none_or(|names| names.iter().any(|one| one == name))
    }

    /// Whether a record is wanted. A raw stream has no times to choose by.
    #[inline]
    pub(crate) fn wants(
        &self,
        block: &[u8],
        lead: usize,
        scanned: &Scanned,
        record: Located,
    ) -> bool {
        let frame = &block[record.at as usize + lead..];
        let wants_time = || {
            let time = scanned.time(block, record.at);
            lead == 0 || time.is_some_and(|time| self.wants_time(seconds(time as f64)))
        };
        self.wants_type(record.index, frame)
            && (self.by_type_alone() || (wants_time() && self.wants_system(frame)))
    }

    /// Whether the frame at the front of some bytes is wanted. `index` is that of its message, or [`UNKNOWN`], and `time`
    /// is in seconds since 1970.
    #[inline]
    pub fn wants_frame(&self, index: u16, frame: &[u8], time: f64) -> bool {
        self.wants_type(index, frame) && self.wants_time(time) && self.wants_system(frame)
    }

    #[inline]
    fn wants_type(&self, index: u16, frame: &[u8]) -> bool {
        if index == UNKNOWN {
            return is_among(self.unknown.as_ref(), frame, |ids, header| {
                ids.contains(&header.msgid)
            });
        }
        self.types.as_ref().is_none_or(|types| types[usize::from(index)])
    }

    /// Whether the type alone decides.
    fn by_type_alone(&self) -> bool {
        self.systems.is_none() && self.start == f64::NEG_INFINITY && self.end == f64::INFINITY
    }

    #[inline]
    fn wants_time(&self, time: f64) -> bool {
        (self.start..self.end).contains(&time)
    }

    #[inline]
    fn wants_system(&self, frame: &[u8]) -> bool {
        is_among(self.systems.as_ref(), frame, |systems, header| systems[usize::from(header.sysid)])
    }
}

/// Whether a frame is among the chosen ones; all are if none are chosen.
#[inline]
fn is_among<T>(chosen: Option<&T>, frame: &[u8], has: impl FnOnce(&T, Header) -> bool) -> bool {
    chosen.is_none_or(|chosen| Header::parse(frame).is_some_and(|header| has(chosen, header)))
}

/// Seconds of a time in microseconds, rounded as those of messages are.
#[inline]
pub(crate) fn seconds(micros: f64) -> f64 {
    micros * 1.0e-6
}
