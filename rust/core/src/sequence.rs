//! Lost frames, as seen in the gaps of sequence numbers (MAVLink guide, "Packet Loss").
//!
//! Each system and component counts its frames modulo 256. The gap between the number that came and the one expected
//! counts as lost, modulo 256 too, so a duplicate counts 255: pymavlink's arithmetic.

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
    /// A tracker that has heard nothing.
    pub fn new() -> Self {
        Self::default()
    }

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn r17_gaps_are_counted_modulo_256() {
        let mut tracker = SequenceTracker::new();
        let lost = [5, 6, 9, 9, 8].map(|seq| tracker.observe(1, 1, seq));
        assert_eq!(lost, [0, 0, 2, 255, 254]);
    }

    #[test]
    fn r17_the_counter_wraps_and_components_are_apart() {
        let mut tracker = SequenceTracker::new();
        assert_eq!(tracker.last().next(), None);
        for (sysid, compid, seq) in [(1, 2, 255), (2, 1, 77), (1, 1, 9), (1, 2, 0), (255, 255, 0)] {
            assert_eq!(tracker.observe(sysid, compid, seq), 0);
        }
        let last: Vec<_> = tracker.last().collect();
        assert_eq!(last, [((1, 2), 0), ((2, 1), 77), ((1, 1), 9), ((255, 255), 0)]);
    }
}
