//! Waiting for a descriptor.

use std::io;
use std::time::Duration;

/// True if `fd` can be read, is at its end or is broken before `timeout` is over: reading it says which. With `writable`
/// also if it takes bytes again.
///
/// Takes descriptors of any number, unlike `select`: a bridge may hold many links.
///
/// # Errors
/// `Interrupted` if a signal arrived; what the operating system says for a descriptor that is none.
#[cfg(unix)]
pub fn ready(fd: i32, writable: bool, timeout: Duration) -> io::Result<bool> {
    let events = if writable { libc::POLLIN | libc::POLLOUT } else { libc::POLLIN };
    let mut watched = libc::pollfd { fd, events, revents: 0 };
    match poll(std::slice::from_mut(&mut watched), timeout)? {
        0 => Ok(false),
        _ if watched.revents & libc::POLLNVAL != 0 => Err(io::ErrorKind::NotFound.into()),
        _ => Ok(true),
    }
}

/// Waits for several descriptors at a time; says how many of them have something in `revents`.
///
/// # Errors
/// `Interrupted` if a signal arrived.
#[cfg(unix)]
pub(crate) fn poll(watched: &mut [libc::pollfd], timeout: Duration) -> io::Result<usize> {
    // Rounded up: a poll that ends early would be asked again and again for the rest of a millisecond.
    let milliseconds = timeout.as_micros().div_ceil(1000).min(i32::MAX as u128) as i32;
    let count = watched.len() as libc::nfds_t;
    // SAFETY: the entries are as many as the call is told, and live until it returns.
    let ready = unsafe { libc::poll(watched.as_mut_ptr(), count, milliseconds) };
    usize::try_from(ready).map_err(|_| io::Error::last_os_error())
}

/// Not on this system.
///
/// # Errors
/// `Unsupported`.
#[cfg(not(unix))]
pub fn ready(_: i32, _: bool, _: Duration) -> io::Result<bool> {
    Err(io::ErrorKind::Unsupported.into())
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::io::Write as _;
    use std::os::fd::AsRawFd as _;
    use std::os::unix::net::UnixStream;

    #[test]
    fn tells_data_and_the_end_from_nothing() {
        let (here, mut there) = UnixStream::pair().unwrap();
        let fd = here.as_raw_fd();
        assert!(!ready(fd, false, Duration::ZERO).unwrap());
        assert!(ready(fd, true, Duration::ZERO).unwrap());
        there.write_all(b"x").unwrap();
        assert!(ready(fd, false, Duration::from_secs(5)).unwrap());
        drop(there);
        assert!(ready(fd, false, Duration::from_secs(5)).unwrap());
    }

    #[test]
    fn a_closed_descriptor_is_an_error() {
        assert_eq!(
            ready(999_999, false, Duration::ZERO).unwrap_err().kind(),
            io::ErrorKind::NotFound
        );
    }
}
