//! The process that a bridge belongs to: a fork must not touch its locks.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// The process that has the bridge's thread. A fork has copies of everything but the thread, and locks that the thread may
/// have held.
#[derive(Debug, Clone, Copy)]
pub(super) struct Home(u32);

impl Home {
    pub(super) fn here() -> Self {
        Self(std::process::id())
    }

    pub(super) fn is_elsewhere(self) -> bool {
        self.0 != std::process::id()
    }
}

/// The lock, also after a panic of a thread that held it.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
