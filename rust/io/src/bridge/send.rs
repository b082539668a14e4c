//! Sending datagrams many at a time.

use std::io;
use std::net::UdpSocket;

use crate::address::Address;

/// Datagrams that one call sends at most.
pub(super) const BATCH: usize = 64;

/// Bytes that may leave together: the room of a datagram.
#[cfg(target_os = "linux")]
const MAX_GROUP_LEN: usize = 65_000;
/// Datagrams that may leave together: more than Linux takes before 6.9 are refused.
#[cfg(target_os = "linux")]
const MAX_SEGMENTS: usize = 64;

/// Memory for one call. Each header describes datagrams of one length that lie side by side, the last of which may be
/// shorter: the system takes them through its network stack as one (UDP segmentation offload) and cuts them apart at
/// its end, which costs a fraction of sending them one by one.
#[cfg(target_os = "linux")]
struct Batch {
    headers: [libc::mmsghdr; BATCH],
    parts: [libc::iovec; BATCH],
    lengths: [SegmentLength; BATCH],
    segments: [usize; BATCH],
    used: usize,
}

/// A control message with the length of the datagrams.
#[cfg(target_os = "linux")]
#[repr(C)]
#[derive(Clone, Copy)]
struct SegmentLength {
    header: libc::cmsghdr,
    len: u16,
}

#[cfg(target_os = "linux")]
impl Batch {
    fn new() -> Self {
        // SAFETY: all zero is a valid value for these structures.
        unsafe { std::mem::zeroed() }
    }

    /// Puts a datagram behind the others.
    fn push(&mut self, datagram: &[u8], grouped: bool) {
        let at = self.used;
        if grouped && at > 0 && self.joins(at - 1, datagram) {
            self.parts[at - 1].iov_len += datagram.len();
            self.segments[at - 1] += 1;
            return;
        }
        let start = datagram.as_ptr().cast_mut().cast();
        self.parts[at] = libc::iovec { iov_base: start, iov_len: datagram.len() };
        self.lengths[at].len = datagram.len() as u16;
        self.segments[at] = 1;
        self.used += 1;
    }

    /// Whether a datagram can be the next one of a group: it lies behind it, and is not longer than those before, which
    /// are all of one length.
    fn joins(&self, group: usize, datagram: &[u8]) -> bool {
        let (part, len) = (&self.parts[group], usize::from(self.lengths[group].len));
        let segments = self.segments[group];
        part.iov_len == len * segments
            && datagram.len() <= len
            && segments < MAX_SEGMENTS
            && part.iov_len + datagram.len() <= MAX_GROUP_LEN
            && part.iov_base.cast_const().cast::<u8>().wrapping_add(part.iov_len)
                == datagram.as_ptr()
    }

    /// Lets the headers point to the rest, and to `name`; it must not be moved from then on.
    fn finish(&mut self, name: Option<&mut (libc::sockaddr_storage, libc::socklen_t)>) {
        let (name, name_len) = match name {
            Some((name, len)) => ((&raw mut *name).cast(), *len),
            None => (std::ptr::null_mut(), 0),
        };
        for n in 0..self.used {
            let header = &mut self.headers[n].msg_hdr;
            header.msg_iov = &raw mut self.parts[n];
            header.msg_iovlen = 1;
            (header.msg_name, header.msg_namelen) = (name, name_len);
            if self.segments[n] > 1 {
                let length = &mut self.lengths[n];
                length.header.cmsg_level = libc::SOL_UDP;
                length.header.cmsg_type = libc::UDP_SEGMENT;
                // SAFETY: arithmetic with a length.
                length.header.cmsg_len = unsafe { libc::CMSG_LEN(size_of::<u16>() as u32) } as _;
                header.msg_control = (&raw mut *length).cast();
                header.msg_controllen = size_of::<SegmentLength>() as _;
            }
        }
    }
}

/// Sends each piece as a datagram, to the socket's peer if there is no `to`; how many were taken, [`BATCH`] at most. If
/// they are `grouped`, those of one length that lie side by side in memory leave together.
///
/// # Errors
/// `WouldBlock` if the socket takes none now, else what the operating system says of the first one.
#[cfg(target_os = "linux")]
pub(super) fn send_batch(
    socket: &UdpSocket,
    datagrams: &mut dyn Iterator<Item = &[u8]>,
    to: Option<Address>,
    grouped: bool,
) -> io::Result<usize> {
    use std::os::fd::AsRawFd as _;

    let mut name = to.map(Address::to_os);
    let mut batch = Batch::new();
    datagrams.take(BATCH).for_each(|datagram| batch.push(datagram, grouped));
    batch.finish(name.as_mut());
    let (headers, count) = (batch.headers.as_mut_ptr(), batch.used as libc::c_uint);
    let (socket, flags) = (socket.as_raw_fd(), libc::MSG_DONTWAIT as _); // musl takes it unsigned
    // SAFETY: the first `count` headers point to a part each, which points to bytes that the caller lends, to one name,
    // and some to a control message of the length given; all of them live until the call returns, which keeps none and
    // writes to the headers only.
    let sent = unsafe { libc::sendmmsg(socket, headers, count, flags) };
    let sent = usize::try_from(sent).map_err(|_| io::Error::last_os_error())?;
    Ok(batch.segments[..sent].iter().sum())
}

/// Whether an error says that datagrams cannot leave together: the system, the device or the way there does not know
/// that, or they are too long for it.
#[cfg(target_os = "linux")]
pub(super) fn cannot_group(error: &io::Error) -> bool {
    let codes = [libc::EINVAL, libc::EIO, libc::EMSGSIZE, libc::EOPNOTSUPP, libc::ENOPROTOOPT];
    error.raw_os_error().is_some_and(|code| codes.contains(&code))
}

/// As above, a call for each.
#[cfg(not(target_os = "linux"))]
pub(super) fn send_batch(
    socket: &UdpSocket,
    datagrams: &mut dyn Iterator<Item = &[u8]>,
    to: Option<Address>,
    _grouped: bool,
) -> io::Result<usize> {
    let mut sent = 0;
    for datagram in datagrams.take(BATCH) {
        let result = match to {
            Some(to) => socket.send_to(datagram, to.socket_addr()),
            None => socket.send(datagram),
        };
        match result {
            Ok(_) => sent += 1,
            Err(error) if sent == 0 => return Err(error),
            Err(_) => break,
        }
    }
    Ok(sent)
}

/// Here they never do.
#[cfg(not(target_os = "linux"))]
pub(super) fn cannot_group(_: &io::Error) -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::net::Ipv4Addr;
    use std::time::Duration;

    /// Sends adjacent datagrams of these lengths: the number of calls, and the datagrams as they arrived.
    fn sent(
        host: &str,
        lens: &[usize],
        connected: bool,
        grouped: bool,
    ) -> Option<(usize, Vec<Vec<u8>>)> {
        let (here, there) = (UdpSocket::bind((host, 0)), UdpSocket::bind((host, 0)));
        let (Ok(here), Ok(there)) = (here, there) else { return None }; // no IPv6 here
        there.set_read_timeout(Some(Duration::from_secs(30))).unwrap();
        let to = there.local_addr().unwrap();
        if connected {
            here.connect(to).unwrap();
        }
        let bytes: Vec<u8> = (0..lens.iter().sum::<usize>()).map(|n| (n % 251) as u8).collect();
        let (mut done, mut at, mut calls, mut arrived) = (0, 0, 0, Vec::new());
        while done < lens.len() {
            let mut start = at;
            let mut datagrams = lens[done..].iter().map(|len| {
                start += len;
                &bytes[start - len..start]
            });
            let to = (!connected).then(|| to.into());
            let taken = send_batch(&here, &mut datagrams, to, grouped).unwrap();
            for len in &lens[done..done + taken] {
                let mut buffer = [0; 2_000];
                let received = there.recv(&mut buffer).unwrap();
                assert_eq!((received, &buffer[..received]), (*len, &bytes[at..at + len]));
                arrived.push(buffer[..received].to_vec());
                at += len;
            }
            (done, calls) = (done + taken, calls + 1);
        }
        Some((calls, arrived))
    }

    #[test]
    fn each_arrives_as_a_datagram_of_its_own() {
        let even = vec![36; 150];
        let odd: Vec<usize> = (1..=150).collect();
        let falling: Vec<usize> = (1..=150).rev().map(|n| n / 3 + 1).collect();
        let long = [vec![1_400; 60], vec![280; 60], vec![1_300; 30]].concat();
        for lens in [even, odd, falling, long] {
            for host in ["127.0.0.1", "::1"] {
                for (connected, grouped) in [(false, false), (false, true), (true, true)] {
                    let Some((calls, arrived)) = sent(host, &lens, connected, grouped) else {
                        continue;
                    };
                    assert_eq!((calls, arrived.len()), (lens.len().div_ceil(BATCH), lens.len()));
                }
            }
        }
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn those_of_one_length_leave_together_and_one_that_is_shorter() {
        let bytes = [0; 4_000];
        let groups = |lens: &[usize], grouped| {
            let mut batch = Batch::new();
            let mut at = 0;
            for len in lens {
                batch.push(&bytes[at..at + len], grouped);
                at += len;
            }
            batch.segments[..batch.used].to_vec()
        };
        assert_eq!(groups(&[36; 64], true), [64]);
        assert_eq!(groups(&[36; 64], false), [1; 64]);
        assert_eq!(groups(&[36, 36, 20, 20, 20, 36, 37, 1, 1], true), [3, 2, 1, 2, 1]);
        let mut batch = Batch::new();
        for place in [0..36, 72..108] {
            batch.push(&bytes[place], true);
        }
        assert_eq!(batch.used, 2, "they do not lie side by side");
    }

    #[test]
    fn what_cannot_leave_together_leaves_one_by_one() {
        let here = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        here.connect(here.local_addr().unwrap()).unwrap();
        let refused = here.send(&vec![0; 70_000]).unwrap_err();
        assert_eq!(cannot_group(&refused), cfg!(target_os = "linux"));
        assert!(!cannot_group(&io::ErrorKind::WouldBlock.into()));
    }
}
