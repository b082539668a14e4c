//! What a dataflash log holds, added up record by record.

use std::collections::HashSet;
use std::sync::Arc;

use mavwire_core::log::dataflash::{Layout, RecordEntry, Units};

/// Instances whose first record is remembered at most.
const MAX_INSTANCES: usize = 8192;

/// What a log holds.
#[derive(Debug, Clone)]
pub struct Contents {
    /// Records of each layout.
    pub counts: Vec<u64>,
    /// Where the first record of each layout starts.
    pub first: Vec<Option<u64>>,
    /// Where the first record of each instance starts, in the order of the log.
    pub instances: Vec<u64>,
    /// Where the last record starts.
    pub last: Option<u64>,
    /// Bytes that belong to no record.
    pub junk: u64,
    /// What the fields are measured in.
    pub units: Units,
}

/// Adds up.
pub(crate) struct Tally<'a> {
    layouts: &'a [Arc<Layout>],
    pub(crate) contents: Contents,
    /// Instance field of each layout.
    instance: Vec<Option<usize>>,
    seen: HashSet<(u16, Vec<u8>)>,
    /// Units came behind records that they describe.
    pub(crate) late: bool,
}

impl<'a> Tally<'a> {
    pub(crate) fn new(layouts: &'a [Arc<Layout>], units: Units) -> Self {
        let contents = Contents {
            counts: vec![0; layouts.len()],
            first: vec![None; layouts.len()],
            instances: Vec::new(),
            last: None,
            junk: 0,
            units,
        };
        let instance = Vec::new();
        let mut tally = Self { layouts, contents, instance, seen: HashSet::new(), late: false };
        tally.find_instance_fields();
        tally
    }

    fn find_instance_fields(&mut self) {
        let units = &self.contents.units;
        self.instance = self.layouts.iter().map(|layout| units.instance_field(layout)).collect();
    }

    /// Counts a record. `units` takes in what it says about units, `instance` gives the bytes of a field.
    #[inline]
    pub(crate) fn add<'r>(
        &mut self,
        entry: RecordEntry,
        units: impl FnOnce(&mut Units, &Layout) -> bool,
        instance: impl FnOnce(&Layout, usize) -> &'r [u8],
    ) {
        let index = usize::from(entry.layout);
        let layout = &self.layouts[index];
        self.contents.counts[index] += 1;
        self.contents.last = Some(entry.offset);
        if self.contents.first[index].is_none() {
            self.contents.first[index] = Some(entry.offset);
        }
        if let Some(field) = self.instance[index] {
            self.add_instance(entry, instance(layout, field));
        }
        // UNIT, MULT and FMTU.
        if layout.name.len() == 4 && units(&mut self.contents.units, layout) {
            self.late |= self.counted_without_instance();
            self.find_instance_fields();
        }
    }

    /// Records of a type were counted before its instance field was known.
    fn counted_without_instance(&self) -> bool {
        let units = &self.contents.units;
        let mut layouts = self.layouts.iter().zip(&self.instance).zip(&self.contents.counts);
        layouts.any(|((layout, instance), &count)| {
            count > 0 && instance.is_none() && units.instance_field(layout).is_some()
        })
    }

    fn add_instance(&mut self, entry: RecordEntry, instance: &[u8]) {
        if self.seen.len() < MAX_INSTANCES && self.seen.insert((entry.layout, instance.to_vec())) {
            self.contents.instances.push(entry.offset);
        }
    }
}
