//! Socket options that the standard library does not have.

use std::io;
use std::net::{TcpStream, UdpSocket};
use std::os::fd::AsRawFd;
use std::time::Duration;

/// Bytes that a socket is asked to hold until they are read. The system may allow less.
const RECEIVE_BUFFER: libc::c_int = 8 << 20;

fn set(
    socket: &impl AsRawFd,
    level: libc::c_int,
    name: libc::c_int,
    value: libc::c_int,
) -> io::Result<()> {
    let len = size_of_val(&value) as libc::socklen_t;
    // SAFETY: the pointer is to a number of the length given, which the call only reads.
    let done = unsafe {
        libc::setsockopt(socket.as_raw_fd(), level, name, (&raw const value).cast(), len)
    };
    if done == 0 { Ok(()) } else { Err(io::Error::last_os_error()) }
}

/// Asks for a large receive buffer; less will do.
pub(super) fn enlarge(socket: &UdpSocket) {
    #[cfg(target_os = "linux")]
    let names = [libc::SO_RCVBUFFORCE, libc::SO_RCVBUF];
    #[cfg(not(target_os = "linux"))]
    let names = [libc::SO_RCVBUF];
    let _ = names.iter().find(|&&name| set(socket, libc::SOL_SOCKET, name, RECEIVE_BUFFER).is_ok());
}

/// Ends a connection whose other side acknowledges nothing for `patience`, whether there is something to send or not: a
/// host that vanished says no goodbye.
///
/// # Errors
/// Errors of the operating system.
#[cfg(target_os = "linux")]
pub(super) fn limit_silence(stream: &TcpStream, patience: Duration) -> io::Result<()> {
    let whole = |time: Duration| i32::try_from(time.as_secs()).unwrap_or(i32::MAX).clamp(1, 32_767);
    set(stream, libc::SOL_SOCKET, libc::SO_KEEPALIVE, 1)?;
    set(stream, libc::IPPROTO_TCP, libc::TCP_KEEPIDLE, whole(patience / 2))?;
    set(stream, libc::IPPROTO_TCP, libc::TCP_KEEPINTVL, whole(patience / 6))?;
    let milliseconds = i32::try_from(patience.as_millis()).unwrap_or(i32::MAX).max(1);
    set(stream, libc::IPPROTO_TCP, libc::TCP_USER_TIMEOUT, milliseconds)
}

/// The same with the times of the system.
///
/// # Errors
/// Errors of the operating system.
#[cfg(not(target_os = "linux"))]
pub(super) fn limit_silence(stream: &TcpStream, _: Duration) -> io::Result<()> {
    set(stream, libc::SOL_SOCKET, libc::SO_KEEPALIVE, 1)
}

/// Datagrams that the system dropped because they were not read in time.
#[cfg(target_os = "linux")]
pub(super) fn overrun(socket: &UdpSocket) -> Option<u64> {
    /// Numbers that tell of a socket's memory (`SK_MEMINFO_VARS`), the last of which counts what was dropped.
    const COUNT: usize = 9;
    let mut numbers = [0_u32; COUNT];
    let mut len = size_of_val(&numbers) as libc::socklen_t;
    // SAFETY: the pointers are to so many bytes, and to their number, both of which the call may write.
    let done = unsafe {
        libc::getsockopt(
            socket.as_raw_fd(),
            libc::SOL_SOCKET,
            libc::SO_MEMINFO,
            numbers.as_mut_ptr().cast(),
            &raw mut len,
        )
    };
    (done == 0 && len as usize == size_of_val(&numbers)).then(|| numbers[COUNT - 1].into())
}

#[cfg(not(target_os = "linux"))]
pub(super) fn overrun(_: &UdpSocket) -> Option<u64> {
    None
}
