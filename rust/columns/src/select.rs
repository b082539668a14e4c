//! Which records are wanted, and the wanted ones by message type.

use mavwire_core::log::tlog::Located;

use crate::scan::{Framing, Scanned, UNKNOWN, header_at};

/// Which records are wanted.
#[derive(Debug, Clone)]
pub struct Wanted {
    /// By message index; `None` for all.
    pub types: Option<Vec<bool>>,
    /// By system id; `None` for all.
    pub systems: Option<Box<[bool; 256]>>,
    /// Seconds since 1970: the first that is wanted.
    pub start: f64,
    /// The first that is not any more.
    pub end: f64,
}

impl Default for Wanted {
    fn default() -> Self {
        Self { types: None, systems: None, start: f64::NEG_INFINITY, end: f64::INFINITY }
    }
}

impl Wanted {
    #[inline]
    fn wants_type(&self, index: u16) -> bool {
        index != UNKNOWN && self.types.as_ref().is_none_or(|types| types[usize::from(index)])
    }

    /// Whether a record is wanted; one of an unknown id is if all types are.
    pub(crate) fn wants(
        &self,
        block: &[u8],
        lead: usize,
        scanned: &Scanned,
        record: Located,
    ) -> bool {
        let by_type = self.types.is_none() || self.wants_type(record.index);
        by_type && (self.by_type_alone() || self.wants_record(block, lead, scanned, record))
    }

    /// Whether a look at the type settles it.
    fn by_type_alone(&self) -> bool {
        self.systems.is_none() && self.start == f64::NEG_INFINITY && self.end == f64::INFINITY
    }

    fn wants_record(&self, block: &[u8], lead: usize, scanned: &Scanned, record: Located) -> bool {
        let from =
            |sysid: u8| self.systems.as_ref().is_none_or(|wanted| wanted[usize::from(sysid)]);
        let time = seconds(scanned.time(block, record.at) as f64);
        let in_time = lead == 0 || (time >= self.start && time < self.end);
        in_time && header_at(block, record.at, lead).is_some_and(|header| from(header.sysid))
    }
}

/// Seconds of a time in microseconds, rounded as those of messages are.
#[inline]
pub(crate) fn seconds(micros: f64) -> f64 {
    micros * 1.0e-6
}

/// The wanted records of a block by message type, in the order of the log.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Grouped {
    /// `at[starts[index]..starts[index + 1]]` are the records of a type.
    starts: Vec<u32>,
    at: Vec<u32>,
}

impl Grouped {
    /// Sorts the records of a block by type; `types` is the number of types there are.
    pub fn new(
        block: &[u8],
        framing: Framing,
        scanned: &Scanned,
        wanted: &Wanted,
        types: usize,
    ) -> Self {
        let lead = framing.lead();
        let simple = wanted.by_type_alone();
        let wants = |record: &&Located| {
            wanted.wants_type(record.index)
                && (simple || wanted.wants_record(block, lead, scanned, **record))
        };
        let chosen: Vec<&Located> = scanned.records.iter().filter(wants).collect();
        let mut starts = vec![0; types + 1];
        for record in &chosen {
            starts[usize::from(record.index) + 1] += 1;
        }
        for index in 0..types {
            starts[index + 1] += starts[index];
        }
        let mut next = starts.clone();
        let mut at = vec![0; chosen.len()];
        for record in chosen {
            let place = &mut next[usize::from(record.index)];
            at[*place as usize] = record.at;
            *place += 1;
        }
        Self { starts, at }
    }

    /// The records of a type.
    pub fn of(&self, index: usize) -> &[u32] {
        &self.at[self.starts[index] as usize..self.starts[index + 1] as usize]
    }
}
