//! The contents of a dataflash log, added up record by record.

use std::collections::HashSet;
use std::sync::Arc;

use mavwire_core::log::dataflash::text::Delimiter;
use mavwire_core::log::dataflash::{ClockFinder, Layout, Record, Units};

/// Instances whose first record is remembered at most.
const MAX_INSTANCES: usize = 8192;

/// Where a record is.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// The record starts here.
    pub offset: u64,
    /// Index of its layout.
    pub layout: usize,
    /// Bytes of the record, or of the line.
    pub len: usize,
    /// The next record is at or behind this offset.
    pub next: u64,
}

/// The contents of a log.
#[derive(Debug, Clone)]
pub struct Contents {
    /// Records of each layout.
    pub counts: Vec<u64>,
    /// Offset of the first record of each layout.
    pub first: Vec<Option<u64>>,
    /// Offset of the first record of each instance, in the order of the log.
    pub instances: Vec<u64>,
    /// Offset of the last record. In a text log it is the last one with a time, if there is one.
    pub last: Option<u64>,
    /// Bytes that belong to no record.
    pub junk: u64,
    /// The units of the fields.
    pub units: Units,
    /// The clock, as far as the records tell it.
    pub clock: ClockFinder,
}

/// Adds up.
pub(crate) struct LogContents<'a> {
    layouts: &'a [Arc<Layout>],
    pub(crate) contents: Contents,
    /// How often what is known of a type's fields changed.
    changes: [u64; 256],
    /// Instance field of each layout, and after how many changes it was looked up. One that is looked up when its next
    /// record comes costs the same however many layouts a log has.
    instance: Vec<(Option<usize>, u64)>,
    seen: HashSet<(usize, Vec<u8>)>,
    /// Units came behind records that they describe.
    late: bool,
}

impl<'a> LogContents<'a> {
    pub(crate) fn new(layouts: &'a [Arc<Layout>], units: Units) -> Self {
        let contents = Contents {
            counts: vec![0; layouts.len()],
            first: vec![None; layouts.len()],
            instances: Vec::new(),
            last: None,
            junk: 0,
            units,
            clock: ClockFinder::default(),
        };
        let field = |layout: &Arc<Layout>| (contents.units.instance_field(layout), 0);
        let instance = layouts.iter().map(field).collect();
        Self { layouts, contents, changes: [0; 256], instance, seen: HashSet::new(), late: false }
    }

    /// Instance field of a layout.
    #[inline]
    fn instance_field(&mut self, index: usize) -> Option<usize> {
        let layout = &self.layouts[index];
        let (before, changes) = self.instance[index];
        let changes_now = self.changes[usize::from(layout.type_id)];
        if changes == changes_now {
            return before;
        }
        let now = self.contents.units.instance_field(layout);
        self.instance[index] = (now, changes_now);
        self.late |= self.contents.counts[index] > 0 && before.is_none() && now.is_some();
        now
    }

    /// The contents, and whether units came after records that they describe.
    pub(crate) fn finish(mut self) -> (Contents, bool) {
        for index in 0..self.layouts.len() {
            self.instance_field(index);
        }
        (self.contents, self.late)
    }

    /// Counts a record.
    #[inline]
    pub(crate) fn add(&mut self, entry: Entry, bytes: &[u8], delimiter: Option<Delimiter>) {
        let index = entry.layout;
        let layout = &*self.layouts[index];
        let record = Record { layout, bytes, delimiter };
        let field = self.instance_field(index);
        self.contents.counts[index] += 1;
        self.contents.last = Some(entry.offset);
        if self.contents.first[index].is_none() {
            self.contents.first[index] = Some(entry.offset);
        }
        if let Some(field) = field {
            self.add_instance(entry, record.stored(field).unwrap_or_default());
        }
        // UNIT, MULT and FMTU.
        if layout.name.len() == 4
            && let Some(type_id) = record.tell_units(&mut self.contents.units)
        {
            self.changes[usize::from(type_id)] += 1;
        }
    }

    fn add_instance(&mut self, entry: Entry, instance: &[u8]) {
        if self.seen.len() < MAX_INSTANCES && self.seen.insert((entry.layout, instance.to_vec())) {
            self.contents.instances.push(entry.offset);
        }
    }
}
