//! Lost frames, as seen in the gaps of sequence numbers (MAVLink guide, "Packet Loss").
//!
//! Each system and component counts its frames modulo 256. The gap between the number that came and the one expected
//! counts as lost, modulo 256 too, so a duplicate counts 255: pymavlink's arithmetic.

use std::collections::HashMap;

use crate::frame::Header;

/// The last sequence number of each component of a system, if any frame came from it.
type Components = [Option<u8>; 256];

/// Last sequence numbers per system and component. Half a kilobyte per system heard, 128 KiB at most.
#[derive(Debug, Clone)]
pub struct SequenceTracker {
    systems: [Option<Box<Components>>; 256],
    /// Components in the order in which they were first heard.
    order: Vec<(u8, u8)>,
}

impl Default for SequenceTracker {
    fn default() -> Self {
        Self { systems: [const { None }; 256], order: Vec::new() }
    }
}

impl SequenceTracker {
    /// Takes note of a frame; returns the number lost before it, 0 for a component's first.
    #[inline]
    pub fn observe(&mut self, sysid: u8, compid: u8, seq: u8) -> u8 {
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

    /// `((sysid, compid), last sequence number)` of each component, in the order in which they were first heard.
    pub fn last(&self) -> impl Iterator<Item = ((u8, u8), u8)> {
        self.order.iter().filter_map(|&(sysid, compid)| {
            let seq = self.systems[usize::from(sysid)].as_ref()?[usize::from(compid)]?;
            Some(((sysid, compid), seq))
        })
    }
}

/// Messages from one component, all of them or those of one type, and the gaps before them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GapCount {
    /// System id.
    pub sysid: u8,
    /// Component id.
    pub compid: u8,
    /// Message id; `None` where types are not told apart.
    pub msgid: Option<u32>,
    /// Messages.
    pub seen: u64,
    /// Gaps that such a message showed.
    pub gaps: u64,
    /// Messages missing in these gaps.
    pub lost: u64,
    /// How many messages of all kinds were seen up to the first of these gaps; 0 without a gap.
    pub first_gap: u64,
}

/// Counts messages and the gaps before them, by component, or by component and message type.
#[derive(Debug, Default)]
pub struct GapCounts {
    by_type: bool,
    tracker: SequenceTracker,
    seen: u64,
    counts: Vec<GapCount>,
    /// Where a sender's count is in `counts`.
    places: HashMap<(u8, u8, Option<u32>), usize>,
}

impl GapCounts {
    /// Counts of components, or `by_type` of their message types.
    pub fn new(by_type: bool) -> Self {
        Self { by_type, ..Self::default() }
    }

    /// Counts a message.
    pub fn count(&mut self, header: &Header) {
        let &Header { sysid, compid, seq, msgid, .. } = header;
        let lost = self.tracker.observe(sysid, compid, seq);
        self.seen += 1;
        let msgid = self.by_type.then_some(msgid);
        let next = self.counts.len();
        let place = *self.places.entry((sysid, compid, msgid)).or_insert(next);
        if place == next {
            let count = GapCount { sysid, compid, msgid, seen: 0, gaps: 0, lost: 0, first_gap: 0 };
            self.counts.push(count);
        }
        let count = &mut self.counts[place];
        count.seen += 1;
        if lost > 0 {
            count.gaps += 1;
            count.lost += u64::from(lost);
            if count.first_gap == 0 {
                count.first_gap = self.seen;
            }
        }
    }

    /// The counts, in the order in which they were first seen.
    pub fn counts(&self) -> &[GapCount] {
        &self.counts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn r17_gaps_are_counted_modulo_256() {
        let mut tracker = SequenceTracker::default();
        let lost = [5, 6, 9, 9, 8].map(|seq| tracker.observe(1, 1, seq));
        assert_eq!(lost, [0, 0, 2, 255, 254]);
    }

    #[test]
    fn r17_the_counter_wraps_and_components_are_apart() {
        let mut tracker = SequenceTracker::default();
        assert_eq!(tracker.last().next(), None);
        for (sysid, compid, seq) in [(1, 2, 255), (2, 1, 77), (1, 1, 9), (1, 2, 0), (255, 255, 0)] {
            assert_eq!(tracker.observe(sysid, compid, seq), 0);
        }
        let last: Vec<_> = tracker.last().collect();
        assert_eq!(last, [((1, 2), 0), ((2, 1), 77), ((1, 1), 9), ((255, 255), 0)]);
    }

    #[test]
    fn gaps_are_told_by_type() {
        let mut counts = GapCounts::new(true);
        for (msgid, seq) in [(0, 1), (30, 2), (30, 5), (0, 7)] {
            let frame = [0xFD, 0, 0, 0, seq, 1, 1, msgid, 0, 0];
            counts.count(&Header::parse(&frame).unwrap());
        }
        let found =
            counts.counts().iter().map(|one| (one.msgid, one.gaps, one.lost, one.first_gap));
        assert_eq!(found.collect::<Vec<_>>(), [(Some(0), 1, 1, 4), (Some(30), 1, 2, 3)]);
    }
}
