//! How far a log is read.

/// How far a log is read. Few programs ask, so that the division waits for them.
#[derive(Debug, Clone, Copy, Default)]
pub struct Progress {
    position: f64,
    size: f64,
}

impl Progress {
    /// At a position of a log of `size` bytes.
    #[inline]
    pub fn at(position: u64, size: u64) -> Self {
        Self { position: position as f64, size: size as f64 }
    }

    /// So many percent.
    pub fn new(percent: f64) -> Self {
        Self { position: percent, size: 100.0 }
    }

    /// 0 to 100.
    pub fn percent(self) -> f64 {
        if self.size == 0.0 { 0.0 } else { 100.0 * self.position / self.size }
    }
}
