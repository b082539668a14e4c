//! The threads that logs are read with.
//!
//! Rayon's own pool does not survive a fork: the child has none of its threads, and would wait for them for ever. So there
//! is one for each process, and whoever uses rayon does so within [`run`].

use std::process;
use std::sync::OnceLock;

use rayon::{ThreadPool, ThreadPoolBuilder};

/// The pool of a process, and that of a process that was forked from it. None is ever dropped: a child cannot end
/// threads that only its parent has.
struct Generation {
    process: u32,
    pool: ThreadPool,
    child: OnceLock<&'static Self>,
}

static FIRST: OnceLock<&'static Generation> = OnceLock::new();

/// Runs `work` on the threads of this process; on those that it is called from, if it is called from some of rayon's.
pub(crate) fn run<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    if rayon::current_thread_index().is_some() {
        return work();
    }
    match pool() {
        Some(pool) => pool.install(work),
        None => {
            become_pool();
            work()
        }
    }
}

/// Makes the calling thread one of rayon's, for good: where no thread can be started, rayon panics over its own pool.
fn become_pool() {
    let alone = ThreadPoolBuilder::new().num_threads(1).use_current_thread().build();
    let _: Option<&ThreadPool> = alone.ok().map(|pool| &*Box::leak(Box::new(pool)));
}

/// `None` where no thread can be started now.
fn pool() -> Option<&'static ThreadPool> {
    let process = process::id();
    let mut place = &FIRST;
    loop {
        let generation = match place.get() {
            Some(generation) => generation,
            None => {
                let pool = ThreadPoolBuilder::new().build().ok()?;
                let new = Generation { process, pool, child: OnceLock::new() };
                // Whoever loses a race takes what the winner has made.
                place.get_or_init(|| Box::leak(Box::new(new)))
            }
        };
        if generation.process == process {
            return Some(&generation.pool);
        }
        place = &generation.child;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn there_is_one_pool() {
        let threads: Vec<_> =
            (0..4).map(|_| std::thread::spawn(|| run(rayon::current_num_threads))).collect();
        let counts: Vec<_> = threads.into_iter().map(|one| one.join().expect("a count")).collect();
        assert!(counts.iter().all(|&count| count == counts[0] && count > 0));
        assert!(run(|| run(rayon::current_thread_index)).is_some());
        assert!(rayon::current_thread_index().is_none());
    }
}
