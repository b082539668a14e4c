//! How long frames are in the bridge: a histogram of fixed size, with eight steps for each doubling.

/// Steps in each doubling, as a power of two: a value is known to an eighth.
const STEP_BITS: u32 = 3;
const STEPS: usize = 1 << STEP_BITS;
/// Buckets for all durations that fit 32 bits of microseconds.
const BUCKETS: usize = (u32::BITS - STEP_BITS + 1) as usize * STEPS;

/// Counts of durations in microseconds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Latency(Box<[u64; BUCKETS]>);

impl Default for Latency {
    fn default() -> Self {
        Self(Box::new([0; BUCKETS]))
    }
}

/// The bucket of a value: small ones have their own, larger ones share it with those of the same leading bits.
#[inline]
fn bucket(micros: u32) -> usize {
    let doublings = (micros | (STEPS as u32 - 1)).ilog2() + 1 - STEP_BITS;
    let shift = doublings.saturating_sub(1);
    shift as usize * STEPS + (micros >> shift) as usize
}

/// The largest value of a bucket.
fn largest(bucket: usize) -> u32 {
    let shift = (bucket / STEPS).saturating_sub(1);
    let leading = (bucket - shift * STEPS) as u64;
    ((leading + 1) << shift).saturating_sub(1).min(u32::MAX.into()) as u32
}

impl Latency {
    #[inline]
    pub(super) fn record(&mut self, micros: u32) {
        self.0[bucket(micros)] += 1;
    }

    /// Puts the counts of another one onto these.
    pub(super) fn add(&mut self, other: &Self) {
        for (count, more) in self.0.iter_mut().zip(other.0.iter()) {
            *count += more;
        }
    }

    /// The duration that this part of all did not exceed, rounded up to the end of its step; `None` without any.
    pub(super) fn percentile(&self, part: f64) -> Option<u32> {
        let total: u64 = self.0.iter().sum();
        let wanted = ((total as f64 * part).ceil() as u64).max(1);
        let mut seen = 0;
        let found = self.0.iter().position(|&count| {
            seen += count;
            seen >= wanted
        });
        found.map(largest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn buckets_are_narrow_and_in_order() {
        for micros in (0..100_000).chain((0..32).map(|bits| u32::MAX >> bits)) {
            let largest = largest(bucket(micros));
            assert!(largest >= micros && largest - micros <= micros / 8, "{micros}: {largest}");
        }
        assert!((1..100_000).all(|micros| bucket(micros) - bucket(micros - 1) <= 1));
        assert_eq!((bucket(u32::MAX), largest(BUCKETS - 1)), (BUCKETS - 1, u32::MAX));
    }

    #[test]
    fn percentiles_are_those_of_what_was_recorded() {
        let mut latency = Latency::default();
        assert_eq!(latency.percentile(0.5), None);
        (1..=1_000).for_each(|micros| latency.record(micros));
        let close = |part, exact: u32| {
            let found = latency.percentile(part).expect("there are some");
            found >= exact && found - exact <= exact / 8
        };
        assert!(close(0.5, 500) && close(0.99, 990) && close(0.999, 999) && close(1.0, 1_000));
        assert_eq!(latency.percentile(0.0), Some(1));
        let mut both = latency.clone();
        both.add(&latency);
        assert_eq!(both.percentile(0.5), latency.percentile(0.5));
    }
}
