//! Sending datagrams many at a time.

use std::io;
use std::net::UdpSocket;

use crate::address::Address;

/// Datagrams that one call sends at most.
pub(super) const BATCH: usize = 64;

/// Sends each piece as a datagram, to the socket's peer if there is no `to`; how many were taken, [`BATCH`] at most.
///
/// # Errors
/// `WouldBlock` if the socket takes none now, else what the operating system says of the first one.
#[cfg(target_os = "linux")]
pub(super) fn send_batch(
    socket: &UdpSocket,
    frames: &mut dyn Iterator<Item = &[u8]>,
    to: Option<Address>,
) -> io::Result<usize> {
    use std::os::fd::AsRawFd as _;

    let mut name = to.map(Address::to_os);
    // SAFETY: all zero is a valid value for these structures.
    let mut parts: [libc::iovec; BATCH] = unsafe { std::mem::zeroed() };
    // SAFETY: as above.
    let mut headers: [libc::mmsghdr; BATCH] = unsafe { std::mem::zeroed() };
    let mut count = 0;
    for ((frame, part), header) in frames.zip(&mut parts).zip(&mut headers) {
        *part = libc::iovec { iov_base: frame.as_ptr().cast_mut().cast(), iov_len: frame.len() };
        header.msg_hdr.msg_iov = part;
        header.msg_hdr.msg_iovlen = 1;
        if let Some((name, len)) = &mut name {
            header.msg_hdr.msg_name = (&raw mut *name).cast();
            header.msg_hdr.msg_namelen = *len;
        }
        count += 1;
    }
    // SAFETY: the first `count` headers point to a part each, which points to a frame that the caller lends, and to
    // one name; all of them live until the call returns, which keeps none and writes to the headers only.
    let sent = unsafe {
        libc::sendmmsg(socket.as_raw_fd(), headers.as_mut_ptr(), count, libc::MSG_DONTWAIT)
    };
    usize::try_from(sent).map_err(|_| io::Error::last_os_error())
}

/// As above, a call for each.
#[cfg(not(target_os = "linux"))]
pub(super) fn send_batch(
    socket: &UdpSocket,
    frames: &mut dyn Iterator<Item = &[u8]>,
    to: Option<Address>,
) -> io::Result<usize> {
    let mut sent = 0;
    for frame in frames.take(BATCH) {
        let result = match to {
            Some(to) => socket.send_to(frame, to.socket_addr()),
            None => socket.send(frame),
        };
        match result {
            Ok(_) => sent += 1,
            Err(error) if sent == 0 => return Err(error),
            Err(_) => break,
        }
    }
    Ok(sent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn frames_arrive_one_in_each_datagram() {
        for host in ["127.0.0.1", "::1"] {
            let (Ok(here), Ok(there)) = (UdpSocket::bind((host, 0)), UdpSocket::bind((host, 0)))
            else {
                continue; // no IPv6 here
            };
            there.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
            let to = there.local_addr().unwrap();
            let frames: Vec<Vec<u8>> = (1..=100_u8).map(|n| vec![n; usize::from(n)]).collect();
            let mut left = frames.iter().map(Vec::as_slice);
            assert_eq!(send_batch(&here, &mut left, Some(to.into())).unwrap(), BATCH);
            here.connect(to).unwrap();
            let mut left = frames[BATCH..].iter().map(Vec::as_slice);
            assert_eq!(send_batch(&here, &mut left, None).unwrap(), 100 - BATCH);
            for frame in &frames {
                let mut buffer = [0; 300];
                let len = there.recv(&mut buffer).unwrap();
                assert_eq!(&buffer[..len], &frame[..]);
            }
        }
    }
}
