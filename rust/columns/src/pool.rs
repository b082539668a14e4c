//! The threads that logs are read with.
//!
//! Rayon's own pool does not survive a fork: the child has none of its threads, and would wait for them for ever. So each
//! process has a pool of its own, and all uses of rayon are within [`run`].

use std::process;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use rayon::{ThreadPool, ThreadPoolBuilder};

/// The pool of a process, and that of a process that was forked from it. None is ever dropped: a child cannot end
/// threads that only its parent has.
struct Generation {
    process: u32,
    pool: ThreadPool,
    child: OnceLock<&'static Self>,
}

static FIRST: OnceLock<&'static Generation> = OnceLock::new();

/// Runs `work` on the threads of this process, or on the calling one where none can be started now: the next call tries again.
pub(crate) fn run<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    match pool() {
        Some(pool) => pool.install(work),
        None => {
            become_pool();
            work()
        }
    }
}

/// Does both on the threads of this process, and what both hand out to these.
pub fn both<A: Send, B: Send>(
    one: impl FnOnce() -> A + Send,
    other: impl FnOnce() -> B + Send,
) -> (A, B) {
    run(|| rayon::join(one, other))
}

/// How long the caller of [`a_while`] waits. Waking it costs a tenth of what a block does, and what it looks after between
/// two blocks, such as a key that ends the work, need not be looked after more often.
const A_WHILE: Duration = Duration::from_millis(20);

/// Takes steps on the threads of this process until one is the last, or a while has passed; whether there are more.
pub(crate) fn a_while<E: Send>(
    mut step: impl FnMut() -> Result<bool, E> + Send,
) -> Result<bool, E> {
    run(|| {
        let begin = Instant::now();
        while step()? {
            if begin.elapsed() > A_WHILE {
                return Ok(true);
            }
        }
        Ok(false)
    })
}

/// Makes the calling thread one of rayon's, for good, unless it is: where no thread can be started, rayon panics over its own
/// pool. It can still hand work to the other pool, and takes what is left of its own meanwhile.
fn become_pool() {
    if rayon::current_thread_index().is_some() {
        return;
    }
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
                // The loser of a race takes the pool of the winner.
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

    #[test]
    fn a_thread_that_went_on_alone_uses_the_pool_once_there_is_one() {
        let alone = std::thread::spawn(|| {
            become_pool();
            become_pool();
            let nested = rayon::join(|| run(rayon::current_num_threads), || run(current)).1;
            (current(), run(current), nested)
        });
        let (own, used, nested) = alone.join().expect("threads");
        assert!(used != own && nested != own);
    }

    fn current() -> std::thread::ThreadId {
        std::thread::current().id()
    }
}
