//! Sequence numbers and the gaps between them.

/// Last sequence number of each source: a row of components for each system that was heard.
pub(crate) struct Sequences {
    systems: [Option<Box<[Option<u8>; 256]>>; 256],
    /// Sources in the order in which they were first heard.
    order: Vec<(u8, u8)>,
}

impl Default for Sequences {
    fn default() -> Self {
        Self { systems: [const { None }; 256], order: Vec::new() }
    }
}

impl Sequences {
    /// Notes a sequence number and returns how many were left out; a repeated number counts as 255.
    pub(crate) fn gap(&mut self, sysid: u8, compid: u8, seq: u8) -> u8 {
        let components =
            self.systems[usize::from(sysid)].get_or_insert_with(|| Box::new([None; 256]));
        match components[usize::from(compid)].replace(seq) {
            Some(last) => seq.wrapping_sub(last).wrapping_sub(1),
            None => {
                self.order.push((sysid, compid));
                0
            }
        }
    }

    /// `((sysid, compid), last sequence number)` of each source.
    pub(crate) fn rows(&self) -> Vec<((u8, u8), u8)> {
        let last = |&(sysid, compid): &(u8, u8)| {
            let seq = self.systems[usize::from(sysid)].as_ref()?[usize::from(compid)]?;
            Some(((sysid, compid), seq))
        };
        self.order.iter().filter_map(last).collect()
    }
}
