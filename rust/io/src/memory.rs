//! Memory that was freed and that the allocator keeps.

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Gives freed memory back to the system. glibc has a heap for each thread, and keeps most of what is freed in one by another
/// thread. Code that frees large spans again and again calls this now and then. Elsewhere nothing is done.
fn give_back() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: it takes no pointer, and locks each heap while it looks at it.
    unsafe {
        libc::malloc_trim(0);
    }
}

/// Bytes that are freed before memory is given back: often enough for what is kept to be little.
const KEPT_BYTES: usize = 64 << 20;

/// Gives memory back each time that much of it was freed.
#[derive(Debug, Default)]
pub struct Freed(AtomicUsize);

impl Freed {
    /// So many bytes more were freed.
    pub fn add(&self, bytes: usize) {
        if self.0.fetch_add(bytes, Relaxed) + bytes > KEPT_BYTES {
            give_back();
            self.0.store(0, Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    #[test]
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    fn freed_memory_is_not_kept() {
        const SPANS: usize = 2000;
        const SPAN: usize = 50_000; // less than what is given back by itself
        let held_kb = || {
            let status = std::fs::read_to_string("/proc/self/status").expect("a status");
            let line = status.lines().find(|line| line.starts_with("VmRSS:")).expect("a size");
            line.split_whitespace().nth(1).and_then(|kb| kb.parse::<usize>().ok()).expect("kB")
        };
        let mut spans: Vec<Vec<u8>> = (0..SPANS).map(|_| vec![1; SPAN]).collect();
        let last = spans.pop(); // which the others cannot be given back over
        drop(spans);
        let before = held_kb();
        super::give_back();
        assert!(held_kb() < before - SPANS * SPAN / 2048, "{before} kB before");
        drop(last);
    }
}
