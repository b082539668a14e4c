//! Which records are wanted.

use mavwire_core::log::tlog::Located;

use crate::scan::{Scanned, UNKNOWN, header_at};

/// Which records are wanted.
#[derive(Debug, Clone)]
pub struct Wanted {
    /// By message index; `None` for all.
    pub types: Option<Vec<bool>>,
    /// Ids that the dialect lacks; `None` for all of them.
    pub unknown: Option<Vec<u32>>,
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
            systems: None,
            start: f64::NEG_INFINITY,
            end: f64::INFINITY,
        }
    }
}

impl Wanted {
    #[inline]
    fn wants_type(&self, index: u16) -> bool {
        index != UNKNOWN && self.types.as_ref().is_none_or(|types| types[usize::from(index)])
    }

    /// Whether a record is wanted.
    pub(crate) fn wants(
        &self,
        block: &[u8],
        lead: usize,
        scanned: &Scanned,
        record: Located,
    ) -> bool {
        let by_type = match record.index {
            UNKNOWN => self.wants_unknown(block, lead, record),
            index => self.wants_type(index),
        };
        by_type && (self.by_type_alone() || self.wants_record(block, lead, scanned, record))
    }

    /// Whether a record is wanted in a table; one of an unknown id has none.
    #[inline]
    pub(crate) fn wants_row(
        &self,
        block: &[u8],
        lead: usize,
        scanned: &Scanned,
        record: Located,
    ) -> bool {
        self.wants_type(record.index)
            && (self.by_type_alone() || self.wants_record(block, lead, scanned, record))
    }

    fn wants_unknown(&self, block: &[u8], lead: usize, record: Located) -> bool {
        let is_among = |ids: &Vec<u32>| {
            header_at(block, record.at, lead).is_some_and(|header| ids.contains(&header.msgid))
        };
        self.unknown.as_ref().is_none_or(is_among)
    }

    /// Whether a look at the type settles it.
    fn by_type_alone(&self) -> bool {
        self.systems.is_none() && self.start == f64::NEG_INFINITY && self.end == f64::INFINITY
    }

    fn wants_record(&self, block: &[u8], lead: usize, scanned: &Scanned, record: Located) -> bool {
        let from =
            |sysid: u8| self.systems.as_ref().is_none_or(|wanted| wanted[usize::from(sysid)]);
        let is_in_span = |time| (self.start..self.end).contains(&seconds(time as f64));
        let in_time = lead == 0 || scanned.time(block, record.at).is_some_and(is_in_span);
        in_time && header_at(block, record.at, lead).is_some_and(|header| from(header.sysid))
    }
}

/// Seconds of a time in microseconds, rounded as those of messages are.
#[inline]
pub(crate) fn seconds(micros: f64) -> f64 {
    micros * 1.0e-6
}
