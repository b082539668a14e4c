//! Reading byte streams (TCP, serial ports, pipes) without waiting.

use std::io;

/// Bytes that one read takes at most.
pub const READ_SIZE: usize = 64 * 1024;

/// The flag of a send by which the end of a connection is an error, even in a program that restored SIGPIPE. Systems
/// without it have 0.
#[cfg(target_os = "linux")]
pub const NO_SIGNAL: i32 = libc::MSG_NOSIGNAL;
#[cfg(not(target_os = "linux"))]
pub const NO_SIGNAL: i32 = 0;

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

/// Reads `limit` bytes at most, from a descriptor in non-blocking mode.
///
/// # Errors
/// `WouldBlock` if nothing is there, `Interrupted` if a signal came, else what the operating system says.
pub fn read_some(fd: i32, limit: usize) -> io::Result<Vec<u8>> {
    let mut bytes = vec![0; limit.min(READ_SIZE)];
    let len = read(fd, &mut bytes)?;
    bytes.truncate(len);
    Ok(bytes)
}

/// Writes what there is room for to a descriptor in non-blocking mode; returns how much that was.
///
/// # Errors
/// `WouldBlock` if there is no room, `Interrupted` if a signal came, else what the operating system says.
#[cfg(unix)]
pub fn write_some(fd: i32, bytes: &[u8]) -> io::Result<usize> {
    // SAFETY: the buffer is valid for reads of its length, and nothing keeps the pointer.
    let len = unsafe { libc::write(fd, bytes.as_ptr().cast(), bytes.len()) };
    usize::try_from(len).map_err(|_| io::Error::last_os_error())
}

/// Not on this system.
///
/// # Errors
/// `Unsupported`.
#[cfg(not(unix))]
pub fn write_some(_: i32, _: &[u8]) -> io::Result<usize> {
    Err(io::ErrorKind::Unsupported.into())
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
    fn writes_what_there_is_room_for_and_reads_no_more_than_asked() {
        let (here, there) = UnixStream::pair().unwrap();
        there.set_nonblocking(true).unwrap();
        here.set_nonblocking(true).unwrap();
        assert_eq!(write_some(there.as_raw_fd(), b"telemetry").unwrap(), 9);
        assert_eq!(read_some(here.as_raw_fd(), 4).unwrap(), b"tele");
        assert_eq!(read_some(here.as_raw_fd(), 100).unwrap(), b"metry");
        assert_eq!(read_some(here.as_raw_fd(), 1).unwrap_err().kind(), io::ErrorKind::WouldBlock);
        let full = loop {
            if let Err(error) = write_some(there.as_raw_fd(), &[0; 4096]) {
                break error;
            }
        };
        assert_eq!(full.kind(), io::ErrorKind::WouldBlock);
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
