//! Receiving datagrams many at a time.
//!
//! A call of the operating system costs as much as everything else about a small datagram, so one call takes all that the
//! socket holds, up to a limit. Datagrams not parsed yet wait in an [`Inbox`], which is filled only when it is empty:
//! the backlog of a slow consumer stays in the socket, where the system bounds it.

#[cfg(unix)]
use std::cell::RefCell;
use std::io;

use crate::address::Address;

/// Datagrams that one call takes at most.
pub const BATCH: usize = 32;
/// The longest datagram there is.
#[cfg(unix)]
const MAX_LEN: usize = 65536;

#[cfg(unix)]
thread_local! {
    /// Where the system writes. Only the pages that it wrote to take memory: one for each telemetry datagram.
    static SCRATCH: RefCell<Option<Scratch>> = const { RefCell::new(None) };
}

struct Datagram {
    end: usize,
    from: Address,
}

/// Received datagrams in their order.
#[derive(Default)]
pub struct Inbox {
    bytes: Vec<u8>,
    datagrams: Vec<Datagram>,
    /// Datagrams that are used up.
    used: usize,
    /// Bytes that are used up.
    at: usize,
}

impl Inbox {
    /// True if nothing waits.
    pub fn is_empty(&self) -> bool {
        self.used == self.datagrams.len()
    }

    /// The unused rest of the first datagram, and its sender's address.
    #[inline]
    pub fn front(&self) -> Option<(&[u8], Address)> {
        let datagram = self.datagrams.get(self.used)?;
        Some((&self.bytes[self.at..datagram.end], datagram.from))
    }

    /// Uses up bytes of the first datagram.
    #[inline]
    pub fn advance(&mut self, len: usize) {
        if let Some(datagram) = self.datagrams.get(self.used) {
            self.at = (self.at + len).min(datagram.end);
            self.used += usize::from(self.at == datagram.end);
        }
    }

    /// Takes what the socket holds, without waiting; says how many datagrams that was. Datagrams of `own` address and
    /// empty ones are left out. The inbox has to be empty.
    ///
    /// # Errors
    /// `WouldBlock` if nothing is there, else what the operating system says.
    pub fn fill(&mut self, fd: i32, own: Option<Address>) -> io::Result<usize> {
        debug_assert!(self.is_empty());
        self.bytes.clear();
        self.datagrams.clear();
        (self.used, self.at) = (0, 0);
        self.receive(fd, own)
    }

    #[cfg(not(unix))]
    fn receive(&mut self, _: i32, _: Option<Address>) -> io::Result<usize> {
        Err(io::ErrorKind::Unsupported.into())
    }

    #[cfg(unix)]
    fn receive(&mut self, fd: i32, own: Option<Address>) -> io::Result<usize> {
        SCRATCH.with_borrow_mut(|scratch| {
            scratch.get_or_insert_with(Scratch::new).receive(fd, |bytes, from| {
                if !bytes.is_empty() && Some(from) != own {
                    self.bytes.extend_from_slice(bytes);
                    self.datagrams.push(Datagram { end: self.bytes.len(), from });
                }
            })
        })
    }
}

/// Memory for one call, and the headers that point into it.
#[cfg(unix)]
struct Scratch {
    bytes: Box<[u8]>,
    names: Box<[libc::sockaddr_storage]>,
    #[cfg(target_os = "linux")]
    parts: Box<[libc::iovec]>,
    #[cfg(target_os = "linux")]
    headers: Box<[libc::mmsghdr]>,
}

#[cfg(unix)]
const NAME_LEN: libc::socklen_t = size_of::<libc::sockaddr_storage>() as libc::socklen_t;

#[cfg(unix)]
impl Scratch {
    fn new() -> Self {
        // SAFETY: all zero is a valid address of no family, and the same goes for the structures below.
        let names = unsafe { vec![std::mem::zeroed(); BATCH] }.into_boxed_slice();
        Self {
            bytes: vec![0; BATCH * MAX_LEN].into_boxed_slice(),
            names,
            #[cfg(target_os = "linux")]
            // SAFETY: as above.
            parts: unsafe { vec![std::mem::zeroed(); BATCH] }.into_boxed_slice(),
            #[cfg(target_os = "linux")]
            // SAFETY: as above.
            headers: unsafe { vec![std::mem::zeroed(); BATCH] }.into_boxed_slice(),
        }
    }

    fn hand_over(&self, n: usize, len: usize, take: &mut impl FnMut(&[u8], Address)) {
        if let Some(from) = Address::from_os(&self.names[n]) {
            take(&self.bytes[n * MAX_LEN..][..len], from);
        }
    }

    #[cfg(target_os = "linux")]
    fn receive(&mut self, fd: i32, mut take: impl FnMut(&[u8], Address)) -> io::Result<usize> {
        let chunks = self.bytes.chunks_exact_mut(MAX_LEN);
        for (n, chunk) in chunks.enumerate() {
            self.parts[n] =
                libc::iovec { iov_base: chunk.as_mut_ptr().cast(), iov_len: chunk.len() };
            let header = &mut self.headers[n].msg_hdr;
            header.msg_name = (&raw mut self.names[n]).cast();
            header.msg_namelen = NAME_LEN;
            header.msg_iov = &raw mut self.parts[n];
            header.msg_iovlen = 1;
        }
        let (headers, flags) = (self.headers.as_mut_ptr(), libc::MSG_DONTWAIT as _); // musl takes it unsigned
        // SAFETY: each of the BATCH headers points to a name, a part and bytes of its own, all of which `self` owns and
        // nobody else touches before the call returns. The system keeps none of the pointers.
        let received = unsafe {
            libc::recvmmsg(fd, headers, BATCH as libc::c_uint, flags, std::ptr::null_mut())
        };
        let received = usize::try_from(received).map_err(|_| io::Error::last_os_error())?;
        for n in 0..received {
            self.hand_over(n, self.headers[n].msg_len as usize, &mut take);
        }
        Ok(received)
    }

    #[cfg(not(target_os = "linux"))]
    fn receive(&mut self, fd: i32, mut take: impl FnMut(&[u8], Address)) -> io::Result<usize> {
        for n in 0..BATCH {
            let start = self.bytes[n * MAX_LEN..].as_mut_ptr().cast();
            let name = (&raw mut self.names[n]).cast();
            let (mut name_len, flags) = (NAME_LEN, libc::MSG_DONTWAIT);
            // SAFETY: the pointers are valid for writes of the lengths given, and the system keeps none of them.
            let len = unsafe { libc::recvfrom(fd, start, MAX_LEN, flags, name, &raw mut name_len) };
            match usize::try_from(len) {
                Ok(len) => self.hand_over(n, len, &mut take),
                Err(_) if n > 0 => return Ok(n),
                Err(_) => return Err(io::Error::last_os_error()),
            }
        }
        Ok(BATCH)
    }
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::net::UdpSocket;
    use std::os::fd::AsRawFd as _;

    fn sockets(address: &str) -> Option<(UdpSocket, UdpSocket, Address)> {
        let here = UdpSocket::bind((address, 0)).ok()?;
        let there = UdpSocket::bind((address, 0)).ok()?;
        there.connect(here.local_addr().ok()?).ok()?;
        let port = there.local_addr().ok()?.port();
        Some((here, there, Address::new(address, port, 0, 0)?))
    }

    #[test]
    fn takes_everything_in_order_with_senders() {
        let (here, there, from) = sockets("127.0.0.1").unwrap();
        let mut inbox = Inbox::default();
        let fd = here.as_raw_fd();
        assert_eq!(inbox.fill(fd, None).unwrap_err().kind(), io::ErrorKind::WouldBlock);
        for datagram in [&b"first"[..], b"", &vec![7; 60_000], b"last"] {
            there.send(datagram).unwrap();
        }
        assert_eq!(inbox.fill(fd, None).unwrap(), 4);
        assert_eq!(inbox.front(), Some((&b"first"[..], from)));
        inbox.advance(2);
        assert_eq!(inbox.front(), Some((&b"rst"[..], from)));
        inbox.advance(3);
        assert_eq!(inbox.front().unwrap().0.len(), 60_000);
        inbox.advance(usize::MAX / 2);
        assert_eq!(inbox.front(), Some((&b"last"[..], from)));
        inbox.advance(4);
        assert!(inbox.is_empty());
    }

    #[test]
    fn a_batch_is_bounded_and_the_rest_waits_in_the_socket() {
        let (here, there, _) = sockets("127.0.0.1").unwrap();
        for n in 0..40 {
            there.send(&[n]).unwrap();
        }
        let mut inbox = Inbox::default();
        let mut seen = Vec::new();
        while inbox.fill(here.as_raw_fd(), None).is_ok() {
            while let Some((bytes, _)) = inbox.front() {
                seen.push(bytes[0]);
                inbox.advance(1);
            }
        }
        assert_eq!(seen, (0..40).collect::<Vec<_>>());
    }

    #[test]
    fn leaves_out_what_it_sent_itself() {
        let (here, there, own) = sockets("127.0.0.1").unwrap();
        there.send(b"x").unwrap();
        let mut inbox = Inbox::default();
        assert_eq!(inbox.fill(here.as_raw_fd(), Some(own)).unwrap(), 1);
        assert!(inbox.is_empty());
    }

    #[test]
    fn knows_ipv6_senders() {
        let Some((here, there, from)) = sockets("::1") else { return };
        there.send(b"x").unwrap();
        let mut inbox = Inbox::default();
        inbox.fill(here.as_raw_fd(), None).unwrap();
        assert_eq!(inbox.front(), Some((&b"x"[..], from)));
        assert_eq!((from.host().as_str(), from.flow_and_scope()), ("::1", Some((0, 0))));
    }
}
