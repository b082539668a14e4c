//! Serial ports, with the four calls of the system that they take: no list of ports, no other settings than a link needs.

use std::fs::{File, OpenOptions};
use std::io;
use std::os::fd::AsRawFd as _;
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::Path;

/// Opens a port raw: 8 data bits, no parity, one stop bit, nothing waited for.
///
/// # Errors
/// Errors of the operating system; `InvalidInput` for a speed that the port lacks, and for another kind of file.
pub(super) fn open(path: &Path, baud: u32, flow_control: bool) -> io::Result<File> {
    let flags = libc::O_NONBLOCK | libc::O_NOCTTY;
    let file = OpenOptions::new().read(true).write(true).custom_flags(flags).open(path)?;
    match configure(&file, baud, flow_control) {
        // "Inappropriate ioctl for device" tells nobody that the path is wrong.
        Err(error) if error.raw_os_error() == Some(libc::ENOTTY) => {
            Err(io::Error::new(io::ErrorKind::InvalidInput, "this is no serial port"))
        }
        done => done.map(|()| file),
    }
}

fn check(result: libc::c_int) -> io::Result<()> {
    if result < 0 { Err(io::Error::last_os_error()) } else { Ok(()) }
}

/// Any number of bauds, as Linux takes them in its own call.
#[cfg(target_os = "linux")]
fn configure(file: &File, baud: u32, flow_control: bool) -> io::Result<()> {
    // SAFETY: all zero is a valid value for this structure.
    let mut settings: libc::termios2 = unsafe { std::mem::zeroed() };
    // SAFETY: the call writes one such structure.
    check(unsafe { libc::ioctl(file.as_raw_fd(), libc::TCGETS2, &raw mut settings) })?;
    settings.c_iflag = 0;
    settings.c_oflag = 0;
    settings.c_lflag = 0;
    settings.c_cflag = libc::CS8 | libc::CREAD | libc::CLOCAL | libc::BOTHER;
    if flow_control {
        settings.c_cflag |= libc::CRTSCTS;
    }
    (settings.c_ispeed, settings.c_ospeed) = (baud, baud);
    (settings.c_cc[libc::VMIN], settings.c_cc[libc::VTIME]) = (1, 0);
    // SAFETY: the call reads one such structure.
    check(unsafe { libc::ioctl(file.as_raw_fd(), libc::TCSETS2, &raw const settings) })
}

#[cfg(not(target_os = "linux"))]
fn configure(file: &File, baud: u32, flow_control: bool) -> io::Result<()> {
    let fd = file.as_raw_fd();
    // SAFETY: all zero is a valid value for this structure.
    let mut settings: libc::termios = unsafe { std::mem::zeroed() };
    // SAFETY: the call writes one such structure.
    check(unsafe { libc::tcgetattr(fd, &raw mut settings) })?;
    // SAFETY: these calls change the structure that they are lent, and nothing else.
    check(unsafe {
        libc::cfmakeraw(&raw mut settings);
        libc::cfsetspeed(&raw mut settings, libc::speed_t::from(baud))
    })?;
    settings.c_cflag |= libc::CREAD | libc::CLOCAL;
    if flow_control {
        settings.c_cflag |= libc::CRTSCTS;
    }
    (settings.c_cc[libc::VMIN], settings.c_cc[libc::VTIME]) = (1, 0);
    // SAFETY: the call reads one such structure.
    check(unsafe { libc::tcsetattr(fd, libc::TCSANOW, &raw const settings) })
}
