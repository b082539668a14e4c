//! Lost frames, as seen in the gaps of sequence numbers (MAVLink guide, "Packet Loss").
//!
//! Each system and component counts its frames modulo 256. The gap between the number that came and the one expected
//! counts as lost, modulo 256 too, so a duplicate counts 255: pymavlink's arithmetic.

/// The last sequence number of one component, if any frame came from it.
type Page = [Option<u8>; 256];

/// Last sequence numbers per system and component. Half a kilobyte per system heard, 128 KiB at most.
#[derive(Debug, Clone, Default)]
pub struct SequenceTracker {
    /// By system; empty until the first frame.
    pages: Vec<Option<Box<Page>>>,
    received: u64,
    lost: u64,
}

impl SequenceTracker {
    /// A tracker that has heard nothing.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes note of a frame; returns the number lost before it, 0 for a component's first.
    pub fn observe(&mut self, sysid: u8, compid: u8, seq: u8) -> u8 {
        if self.pages.is_empty() {
            self.pages.resize_with(256, || None);
        }
        let page = self.pages[usize::from(sysid)].get_or_insert_with(|| Box::new([None; 256]));
        let before = page[usize::from(compid)].replace(seq);
        let lost = before.map_or(0, |before| seq.wrapping_sub(before.wrapping_add(1)));
        self.received += 1;
        self.lost += u64::from(lost);
        lost
    }

    /// The last sequence number heard from a component.
    pub fn last(&self, sysid: u8, compid: u8) -> Option<u8> {
        (*self.pages.get(usize::from(sysid))?.as_ref()?)[usize::from(compid)]
    }

    /// Frames observed.
    pub fn received(&self) -> u64 {
        self.received
    }

    /// Frames lost.
    pub fn lost(&self) -> u64 {
        self.lost
    }

    /// Lost frames in percent of all that were sent; 0 where nothing came.
    pub fn loss_percent(&self) -> f64 {
        match self.received + self.lost {
            0 => 0.0,
            sent => 100.0 * self.lost as f64 / sent as f64,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn r17_gaps_are_counted_modulo_256() {
        let mut tracker = SequenceTracker::new();
        let lost: Vec<u8> = [5, 6, 9, 9, 8].map(|seq| tracker.observe(1, 1, seq)).into();
        assert_eq!(lost, [0, 0, 2, 255, 254]);
        assert_eq!((tracker.received(), tracker.lost()), (5, 511));
        assert!((tracker.loss_percent() - 100.0 * 511.0 / 516.0).abs() < 1e-12);
    }

    #[test]
    fn r17_the_counter_wraps_and_components_are_apart() {
        let mut tracker = SequenceTracker::new();
        assert_eq!(tracker.loss_percent().to_bits(), 0);
        for (sysid, compid, seq) in [(1, 1, 255), (2, 1, 77), (1, 2, 9), (1, 1, 0), (255, 255, 0)] {
            assert_eq!(tracker.observe(sysid, compid, seq), 0);
        }
        assert_eq!((tracker.last(1, 1), tracker.last(2, 1)), (Some(0), Some(77)));
        assert_eq!((tracker.last(2, 2), SequenceTracker::new().last(0, 0)), (None, None));
    }
}
