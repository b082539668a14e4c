//! The last timestamp of every verified stream.
//!
//! Only genuine frames get in, and only so many: peers choose `link_id`, `sysid` and `compid` themselves.

/// Streams a table holds unless told otherwise.
const DEFAULT_CAPACITY: usize = 1024;

/// Whose timestamps belong together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct StreamId {
    /// Link of the sender.
    pub link_id: u8,
    /// Sending system.
    pub sysid: u8,
    /// Sending component.
    pub compid: u8,
}

/// Last timestamps by stream, sorted.
#[derive(Debug, Clone)]
pub struct StreamTable {
    streams: Vec<(StreamId, u64)>,
    capacity: usize,
}

impl Default for StreamTable {
    fn default() -> Self {
        Self::with_capacity(DEFAULT_CAPACITY)
    }
}

impl StreamTable {
    /// A table for at most `capacity` streams.
    pub fn with_capacity(capacity: usize) -> Self {
        Self { streams: Vec::new(), capacity }
    }

    /// Where a stream stands, or else where it would.
    #[inline]
    pub(super) fn find(&self, id: StreamId) -> Result<usize, usize> {
        // As one number, which is one comparison.
        let number =
            |StreamId { link_id, sysid, compid }| u32::from_be_bytes([0, link_id, sysid, compid]);
        self.streams.binary_search_by_key(&number(id), |&(id, _)| number(id))
    }

    /// The last timestamp of a stream.
    #[inline]
    pub fn get(&self, id: StreamId) -> Option<u64> {
        self.find(id).ok().map(|at| self.timestamp(at))
    }

    /// The last timestamp of the stream that stands at a place.
    #[inline]
    pub(super) fn timestamp(&self, at: usize) -> u64 {
        self.streams[at].1
    }

    /// Sets the last timestamp of a stream; `false` where it is new and the table is full.
    pub fn set(&mut self, id: StreamId, timestamp: u64) -> bool {
        self.put(self.find(id), id, timestamp)
    }

    /// The same, unless the stream is further already.
    pub fn raise(&mut self, id: StreamId, timestamp: u64) -> bool {
        let place = self.find(id);
        place.is_ok_and(|at| self.timestamp(at) >= timestamp) || self.put(place, id, timestamp)
    }

    /// Sets the last timestamp of a stream that was looked for.
    #[inline]
    pub(super) fn put(&mut self, at: Result<usize, usize>, id: StreamId, timestamp: u64) -> bool {
        match at {
            Ok(at) => self.streams[at].1 = timestamp,
            Err(_) if self.streams.len() >= self.capacity => return false,
            Err(at) => self.streams.insert(at, (id, timestamp)),
        }
        true
    }

    /// Forgets a stream; returns its timestamp.
    pub fn remove(&mut self, id: StreamId) -> Option<u64> {
        self.find(id).ok().map(|at| self.streams.remove(at).1)
    }

    /// Forgets all streams.
    pub fn clear(&mut self) {
        self.streams.clear();
    }

    /// Number of streams.
    pub fn len(&self) -> usize {
        self.streams.len()
    }

    /// No streams.
    pub fn is_empty(&self) -> bool {
        self.streams.is_empty()
    }

    /// All streams with their last timestamps, in order.
    pub fn iter(&self) -> impl Iterator<Item = (StreamId, u64)> + '_ {
        self.streams.iter().copied()
    }
}
