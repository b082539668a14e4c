//! Reading byte streams (TCP, serial ports, pipes) without waiting.

use std::io;

/// What one read takes at most.
pub const READ_SIZE: usize = 64 * 1024;

thread_local! {
    static SCRATCH: std::cell::RefCell<Vec<u8>> = const { std::cell::RefCell::new(Vec::new()) };
}

/// Reads what is there and hands it to `take`; returns how much that was, 0 at the end of the stream.
///
/// Descriptors that are no sockets have to be in non-blocking mode.
///
/// # Errors
/// `WouldBlock` if nothing is there, else what the operating system says.
pub fn read_available(fd: i32, take: impl FnOnce(&[u8])) -> io::Result<usize> {
    SCRATCH.with_borrow_mut(|scratch| {
        scratch.resize(READ_SIZE, 0);
        let len = read(fd, scratch)?;
        take(&scratch[..len]);
        Ok(len)
    })
}

#[cfg(not(unix))]
fn read(_: i32, _: &mut [u8]) -> io::Result<usize> {
    Err(io::ErrorKind::Unsupported.into())
}

#[cfg(unix)]
fn read(fd: i32, into: &mut [u8]) -> io::Result<usize> {
    let start = into.as_mut_ptr().cast();
    // SAFETY: the buffer is valid for writes of its length, and nothing keeps the pointer.
    let mut len = unsafe { libc::recv(fd, start, into.len(), libc::MSG_DONTWAIT) };
    if len < 0 && io::Error::last_os_error().raw_os_error() == Some(libc::ENOTSOCK) {
        // SAFETY: as above.
        len = unsafe { libc::read(fd, start, into.len()) };
    }
    usize::try_from(len).map_err(|_| io::Error::last_os_error())
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::io::Write as _;
    use std::os::fd::AsRawFd as _;
    use std::os::unix::net::UnixStream;

    fn available(stream: &UnixStream) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        read_available(stream.as_raw_fd(), |read| bytes.extend_from_slice(read)).map(|_| bytes)
    }

    #[test]
    fn reads_what_is_there_and_never_waits() {
        let (here, mut there) = UnixStream::pair().unwrap();
        assert_eq!(available(&here).unwrap_err().kind(), io::ErrorKind::WouldBlock);
        there.write_all(b"telemetry").unwrap();
        assert_eq!(available(&here).unwrap(), b"telemetry");
        drop(there);
        assert_eq!(available(&here).unwrap(), b"");
    }
}
