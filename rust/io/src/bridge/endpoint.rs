//! Where a link leads, and opening it. Sockets and files open on the caller's thread, so that a port that is taken is an
//! error of the call. Connections that take time are dialled by a thread of their own.

use std::fmt;
use std::fs::File;
use std::io::{self, Read as _, Write as _};
use std::net::{SocketAddr, TcpListener, TcpStream, ToSocketAddrs as _, UdpSocket};
use std::os::fd::{AsRawFd, RawFd};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use mavwire_core::router::LinkOptions;

use super::automation::AutomationOptions;
use super::{serial, socket_options};
use crate::address::Address;

/// How long a connection may take to come about.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(5);

/// A kind of network endpoint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NetKind {
    /// Datagrams to and from one address.
    UdpClient,
    /// Datagrams from anyone; answers go to each peer that sent a good frame.
    UdpServer,
    /// Datagrams to a broadcast address; answers come back to the port that they left from.
    UdpBroadcast,
    /// A connection to a server, made again whenever it ends.
    TcpClient,
    /// Connections from anyone.
    TcpServer,
}

/// How users call each kind.
const WORDS: [(NetKind, &str); 5] = [
    (NetKind::UdpClient, "udpout"),
    (NetKind::UdpServer, "udpin"),
    (NetKind::UdpBroadcast, "udpbcast"),
    (NetKind::TcpClient, "tcp"),
    (NetKind::TcpServer, "tcpin"),
];

impl NetKind {
    /// The kind that users call by a word.
    pub fn from_word(word: &str) -> Option<Self> {
        WORDS.iter().find(|row| row.1 == word).map(|row| row.0)
    }
}

/// Where a link leads.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Endpoint {
    /// A network address.
    Net {
        /// Whether to listen, to connect or to send there.
        kind: NetKind,
        /// A name or a numeric address; of a server, the address to listen on.
        host: String,
        /// The port; a server with 0 listens on any that is free.
        port: u16,
    },
    /// A serial port, opened again when it comes back.
    Serial {
        /// The device.
        path: PathBuf,
        /// Bits a second.
        baud: u32,
        /// Hardware flow control.
        flow_control: bool,
    },
}

impl fmt::Display for Endpoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Net { kind, host, port } => {
                let word = WORDS.iter().find(|row| row.0 == *kind).map_or("", |row| row.1);
                let (open, close) = if host.contains(':') { ("[", "]") } else { ("", "") };
                write!(f, "{word}:{open}{host}{close}:{port}")
            }
            Self::Serial { path, baud, .. } => write!(f, "serial:{}:{baud}", path.display()),
        }
    }
}

/// A link as a user asks for it.
#[derive(Debug, Clone)]
pub struct LinkSpec {
    /// Its name, which no other link has.
    pub name: String,
    /// Where it leads.
    pub endpoint: Endpoint,
    /// The settings of each of its peers in the router.
    pub port: PortSpec,
    /// Idle timeout. A UDP server drops a peer that sends no valid frame for this long. A connection that acknowledges
    /// nothing for this long is closed.
    pub peer_timeout: Duration,
    /// Longest pause between two attempts to connect again; `None` gives up after the first connection ends.
    pub retry: Option<Duration>,
}

/// How a link, or each peer of a server, takes part.
#[derive(Debug, Clone, Default)]
pub struct PortSpec {
    /// How it takes part in routing.
    pub options: LinkOptions,
    /// Frames that the bridge itself sends.
    pub automation: AutomationOptions,
    /// Bytes that may wait to leave.
    pub queue: usize,
    /// Frames that wait together share a datagram up to so many bytes; 0 for one frame in each.
    pub datagram: usize,
    /// Forward arriving frames of known ids whose checksum is that of another definition.
    pub forward_unverified: bool,
}

/// A connected stream.
#[derive(Debug)]
pub(super) enum Stream {
    Tcp(TcpStream),
    Serial(File),
}

impl Stream {
    /// A connection as the bridge wants it, which ends when the other side acknowledges nothing for `patience`.
    pub(super) fn tcp(stream: TcpStream, patience: Duration) -> io::Result<Self> {
        stream.set_nonblocking(true)?;
        stream.set_nodelay(true)?;
        socket_options::limit_silence(&stream, patience)?;
        Ok(Self::Tcp(stream))
    }

    pub(super) fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Tcp(stream) => stream.write(bytes),
            Self::Serial(file) => file.write(bytes),
        }
    }

    pub(super) fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Tcp(stream) => stream.read(into),
            Self::Serial(file) => file.read(into),
        }
    }

    pub(super) fn peer(&self) -> Option<SocketAddr> {
        match self {
            Self::Tcp(stream) => stream.peer_addr().ok(),
            Self::Serial(_) => None,
        }
    }
}

/// The transport of a port's frames.
#[derive(Debug)]
pub(super) enum Wire {
    /// Nothing now.
    Down,
    Stream(Stream),
    /// A socket, and the peer's address if the socket has no peer of its own; one that has is dialled again.
    Datagrams(Arc<UdpSocket>, Option<Address>),
    /// Nowhere: frames of the program around the bridge come in here.
    Program,
}

impl AsRawFd for Stream {
    fn as_raw_fd(&self) -> RawFd {
        match self {
            Self::Tcp(stream) => stream.as_raw_fd(),
            Self::Serial(file) => file.as_raw_fd(),
        }
    }
}

/// A link's sockets and files after opening.
#[derive(Debug)]
pub(super) enum Opened {
    /// A socket with a port of the router for each peer.
    DatagramServer(Arc<UdpSocket>),
    Listener(TcpListener),
    /// One port of the router, which is dialled again, and its transport now.
    Dialled(Wire),
}

impl Endpoint {
    /// Opens the link as far as that takes no time. A server with port 0 has its own port from then on.
    pub(super) fn open(&mut self) -> io::Result<Opened> {
        let (kind, host, port) = match self {
            Self::Net { kind, host, port } => (*kind, host.as_str(), port),
            Self::Serial { path, baud, flow_control } => {
                let file = serial::open(path, *baud, *flow_control)?;
                return Ok(Opened::Dialled(Wire::Stream(Stream::Serial(file))));
            }
        };
        Ok(match kind {
            NetKind::UdpClient => match connect_datagrams(host, *port) {
                // A network that is not there yet is no mistake.
                Err(error) if is_way_gone(&error) => Opened::Dialled(Wire::Down),
                done => Opened::Dialled(done?),
            },
            NetKind::UdpBroadcast => {
                let to = resolve(host, *port)?[0];
                let socket = prepared(UdpSocket::bind(any(to))?)?;
                socket.set_broadcast(true)?;
                Opened::Dialled(Wire::Datagrams(Arc::new(socket), Some(to.into())))
            }
            NetKind::UdpServer => {
                let socket = prepared(UdpSocket::bind((host, *port))?)?;
                *port = socket.local_addr()?.port();
                Opened::DatagramServer(Arc::new(socket))
            }
            NetKind::TcpServer => {
                let listener = TcpListener::bind((host, *port))?;
                listener.set_nonblocking(true)?;
                *port = listener.local_addr()?.port();
                Opened::Listener(listener)
            }
            // A name that nobody knows is a mistake; a server that is not there yet is none.
            NetKind::TcpClient => resolve(host, *port).map(|_| Opened::Dialled(Wire::Down))?,
        })
    }

    /// Connects, however long that takes; `patience` as for [`Stream::tcp`].
    pub(super) fn dial(&self, patience: Duration) -> io::Result<Wire> {
        match self {
            Self::Serial { path, baud, flow_control } => serial::open(path, *baud, *flow_control)
                .map(|file| Wire::Stream(Stream::Serial(file))),
            Self::Net { kind: NetKind::TcpClient, host, port } => {
                first_of(host, *port, |address| {
                    let stream = TcpStream::connect_timeout(&address, CONNECT_TIMEOUT)?;
                    Stream::tcp(stream, patience).map(Wire::Stream)
                })
            }
            Self::Net { host, port, .. } => connect_datagrams(host, *port),
        }
    }
}

/// The addresses of a host, one at least. Those of IPv4 come first, which is what MAVLink programs listen on.
fn resolve(host: &str, port: u16) -> io::Result<Vec<SocketAddr>> {
    let mut addresses: Vec<SocketAddr> = (host, port).to_socket_addrs()?.collect();
    addresses.sort_by_key(SocketAddr::is_ipv6);
    if addresses.is_empty() { Err(io::ErrorKind::AddrNotAvailable.into()) } else { Ok(addresses) }
}

/// Tries the addresses of a host in turn: the first successful result, or the error of the last address.
fn first_of<T>(
    host: &str,
    port: u16,
    connect: impl Fn(SocketAddr) -> io::Result<T>,
) -> io::Result<T> {
    let mut last = io::ErrorKind::AddrNotAvailable.into();
    for address in resolve(host, port)? {
        match connect(address) {
            Ok(done) => return Ok(done),
            Err(error) => last = error,
        }
    }
    Err(last)
}

fn connect_datagrams(host: &str, port: u16) -> io::Result<Wire> {
    first_of(host, port, |to| {
        let socket = prepared(UdpSocket::bind(any(to))?)?;
        socket.connect(to)?;
        Ok(Wire::Datagrams(Arc::new(socket), None))
    })
}

/// Whether an error says that no datagram leaves by this socket any more: the address that it has is no longer one of
/// this machine, or no network leads there. A new socket may find another way.
pub(super) fn is_way_gone(error: &io::Error) -> bool {
    let codes = [libc::EINVAL, libc::EADDRNOTAVAIL, libc::ENETUNREACH, libc::ENETDOWN];
    error.raw_os_error().is_some_and(|code| codes.contains(&code))
}

/// Any address of the same family, and any port.
fn any(like: SocketAddr) -> (&'static str, u16) {
    (if like.is_ipv4() { "0.0.0.0" } else { "::" }, 0)
}

fn prepared(socket: UdpSocket) -> io::Result<UdpSocket> {
    socket.set_nonblocking(true)?;
    socket_options::enlarge(&socket);
    Ok(socket)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use std::net::Ipv4Addr;

    #[test]
    fn a_connection_ends_that_nobody_acknowledges() {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let port = listener.local_addr().unwrap().port();
        let endpoint = Endpoint::Net { kind: NetKind::TcpClient, host: "127.0.0.1".into(), port };
        for (patience, expected) in [(60_000, [60_000, 30, 10]), (250, [250, 1, 1])] {
            let connection = endpoint.dial(Duration::from_millis(patience)).unwrap();
            let Wire::Stream(stream) = connection else { panic!("{connection:?}") };
            let option = |name| {
                let (mut value, mut len) = (0, size_of::<libc::c_int>() as libc::socklen_t);
                let place: *mut libc::c_int = &raw mut value;
                let fd = stream.as_raw_fd();
                // SAFETY: the pointers are to a number and to its length, which the call may write.
                let done = unsafe {
                    libc::getsockopt(fd, libc::IPPROTO_TCP, name, place.cast(), &raw mut len)
                };
                assert_eq!(done, 0);
                value
            };
            let names = [libc::TCP_USER_TIMEOUT, libc::TCP_KEEPIDLE, libc::TCP_KEEPINTVL];
            assert_eq!(names.map(option), expected);
        }
    }
}
