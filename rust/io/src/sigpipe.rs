//! Writing to who has hung up, in a program that lets SIGPIPE end it.
//!
//! Python ignores the signal; a program whose output goes to `head` may want it back, and means its standard output by that,
//! not the other end of a link.

#[cfg(unix)]
pub use unix::HeldBack;

/// Nothing, on a system without the signal.
#[cfg(not(unix))]
#[derive(Default)]
pub struct HeldBack;

#[cfg(unix)]
mod unix {
    use std::mem::MaybeUninit;

    use libc::{SIG_BLOCK, SIG_SETMASK, SIGPIPE, sigset_t};

    /// While it lives, what this thread writes to who has hung up is an error and no signal.
    pub struct HeldBack {
        before: sigset_t,
    }

    impl Default for HeldBack {
        fn default() -> Self {
            Self { before: change_mask(SIG_BLOCK, &only_sigpipe()) }
        }
    }

    impl Drop for HeldBack {
        fn drop(&mut self) {
            if contains(&self.before) {
                return;
            }
            if is_pending() {
                let (signals, mut taken) = (only_sigpipe(), 0);
                // SAFETY: both are valid; it does not wait for what is pending.
                unsafe { libc::sigwait(&raw const signals, &raw mut taken) };
            }
            change_mask(SIG_SETMASK, &self.before);
        }
    }

    /// The signals that this thread has held back before.
    fn change_mask(how: i32, signals: &sigset_t) -> sigset_t {
        let mut before = MaybeUninit::uninit();
        // SAFETY: a valid set, and room for another; with a valid `how` the call cannot fail, and fills that.
        unsafe {
            libc::pthread_sigmask(how, signals, before.as_mut_ptr());
            before.assume_init()
        }
    }

    fn only_sigpipe() -> sigset_t {
        let mut signals = MaybeUninit::uninit();
        // SAFETY: the first call fills the set, the second one gets a filled one and a valid signal.
        unsafe {
            libc::sigemptyset(signals.as_mut_ptr());
            libc::sigaddset(signals.as_mut_ptr(), SIGPIPE);
            signals.assume_init()
        }
    }

    fn is_pending() -> bool {
        let mut signals = MaybeUninit::uninit();
        // SAFETY: room for a set, which the call fills.
        let signals = unsafe {
            libc::sigpending(signals.as_mut_ptr());
            signals.assume_init()
        };
        contains(&signals)
    }

    fn contains(signals: &sigset_t) -> bool {
        // SAFETY: a filled set and a valid signal.
        unsafe { libc::sigismember(signals, SIGPIPE) == 1 }
    }

    #[cfg(test)]
    mod tests {
        use std::ptr::{null, null_mut};

        use super::*;

        fn is_blocked() -> bool {
            let mut now = MaybeUninit::uninit();
            // SAFETY: without a set nothing is changed, and the present one is filled in.
            let now = unsafe {
                libc::pthread_sigmask(SIG_BLOCK, null(), now.as_mut_ptr());
                now.assume_init()
            };
            contains(&now)
        }

        #[test]
        fn the_signal_is_taken_and_the_mask_as_before() {
            assert!(!is_blocked());
            let held = HeldBack::default();
            assert!(is_blocked());
            // SAFETY: a signal to this thread, which holds it back.
            unsafe { libc::pthread_kill(libc::pthread_self(), SIGPIPE) };
            drop(HeldBack::default()); // leaves to the outer one what is its
            assert!(is_blocked() && is_pending());
            drop(held);
            assert!(!is_blocked() && !is_pending());
            // SAFETY: a valid mask is put back.
            unsafe { libc::pthread_sigmask(SIG_SETMASK, &only_sigpipe(), null_mut()) };
            drop(HeldBack::default());
            assert!(is_blocked());
        }
    }
}
