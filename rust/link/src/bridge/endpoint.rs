//! Where a link leads, and opening it. What opens at once is opened by whoever adds the link, so that a port that is taken
//! is told to them; what has to be waited for is dialled by a thread of its own, so that nobody waits.

use std::fmt;
use std::fs::File;
use std::io::{self, Read as _, Write as _};
use std::net::{SocketAddr, TcpListener, TcpStream, ToSocketAddrs as _, UdpSocket};
use std::os::fd::{AsRawFd, RawFd};
use std::path::PathBuf;
use std::time::Duration;

use mavwire_core::border::BorderOptions;
use mavwire_core::router::LinkOptions;

use super::automation::AutomationOptions;
use super::serial;

/// How long a connection may take to come about.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(5);
/// What a socket is asked to hold of what is not read yet, where the system lets it.
static RECEIVE_BUFFER: libc::c_int = 8 << 20;

/// Where a link leads. A host is a name or a numeric address.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Endpoint {
    /// Datagrams to and from one address.
    UdpClient {
        /// Its host.
        host: String,
        /// Its port.
        port: u16,
    },
    /// Datagrams from anyone; answers go to each peer that sent a good frame.
    UdpServer {
        /// The address to listen on.
        host: String,
        /// The port to listen on; 0 for any that is free.
        port: u16,
    },
    /// Datagrams to a broadcast address; answers come back to the port that they left from.
    UdpBroadcast {
        /// The broadcast address.
        host: String,
        /// The port there.
        port: u16,
    },
    /// A connection to a server, made again whenever it ends.
    TcpClient {
        /// Its host.
        host: String,
        /// Its port.
        port: u16,
    },
    /// Connections from anyone.
    TcpServer {
        /// The address to listen on.
        host: String,
        /// The port to listen on.
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
        let word = match self {
            Self::UdpClient { .. } => "udpout",
            Self::UdpServer { .. } => "udpin",
            Self::UdpBroadcast { .. } => "udpbcast",
            Self::TcpClient { .. } => "tcp",
            Self::TcpServer { .. } => "tcpin",
            Self::Serial { .. } => "serial",
        };
        match self {
            Self::UdpClient { host, port }
            | Self::UdpServer { host, port }
            | Self::UdpBroadcast { host, port }
            | Self::TcpClient { host, port }
            | Self::TcpServer { host, port } => {
                let bare = !host.contains(':');
                let (open, close) = if bare { ("", "") } else { ("[", "]") };
                write!(f, "{word}:{open}{host}{close}:{port}")
            }
            Self::Serial { path, baud, .. } => write!(f, "{word}:{}:{baud}", path.display()),
        }
    }
}

/// A link as a user asks for it.
#[derive(Debug, Clone)]
pub struct LinkSpec {
    /// What it is called; unlike all others.
    pub name: String,
    /// Where it leads.
    pub endpoint: Endpoint,
    /// What each of its peers gets.
    pub port: PortSpec,
    /// A peer of a UDP server is forgotten after this long without a good frame.
    pub peer_timeout: Duration,
    /// Longest pause between two attempts to connect again; `None` gives up after the first connection ends.
    pub retry: Option<Duration>,
}

/// How a link, or each peer of a server, takes part.
#[derive(Debug, Clone, Default)]
pub struct PortSpec {
    /// How it takes part in routing.
    pub options: LinkOptions,
    /// What frames go through there.
    pub border: BorderOptions,
    /// What the bridge sends of its own accord.
    pub automation: AutomationOptions,
    /// Bytes that may wait to leave.
    pub queue: usize,
    /// Frames that wait together share a datagram up to so many bytes; 0 for one frame in each.
    pub datagram: usize,
}

/// A connected stream.
#[derive(Debug)]
pub(super) enum Stream {
    Tcp(TcpStream),
    Serial(File),
}

impl Stream {
    /// A connection as the bridge wants it.
    pub(super) fn tcp(stream: TcpStream) -> io::Result<Self> {
        stream.set_nonblocking(true)?;
        stream.set_nodelay(true)?;
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

impl AsRawFd for Stream {
    fn as_raw_fd(&self) -> RawFd {
        match self {
            Self::Tcp(stream) => stream.as_raw_fd(),
            Self::Serial(file) => file.as_raw_fd(),
        }
    }
}

/// What adding a link opens.
#[derive(Debug)]
pub(super) enum Opened {
    /// A socket with one port of the router behind it.
    Datagrams(UdpSocket),
    /// A socket with a port for each peer.
    DatagramServer(UdpSocket),
    Listener(TcpListener),
    /// To be dialled; a serial port that is there already.
    Dialled(Option<Stream>),
}

impl Opened {
    /// The port that a server listens on.
    fn server_port(&self) -> io::Result<Option<u16>> {
        let address = match self {
            Self::DatagramServer(socket) => socket.local_addr()?,
            Self::Listener(listener) => listener.local_addr()?,
            Self::Datagrams(_) | Self::Dialled(_) => return Ok(None),
        };
        Ok(Some(address.port()))
    }
}

impl Endpoint {
    /// Opens what opens at once. A server that was to listen on any port, 0, has its own from then on.
    pub(super) fn open(&mut self) -> io::Result<Opened> {
        let opened = self.opened()?;
        if let Self::UdpServer { port, .. } | Self::TcpServer { port, .. } = self {
            *port = opened.server_port()?.unwrap_or(*port);
        }
        Ok(opened)
    }

    fn opened(&self) -> io::Result<Opened> {
        match self {
            Self::UdpClient { host, port } => {
                let socket = udp_to(host, *port, UdpSocket::connect)?;
                Ok(Opened::Datagrams(socket))
            }
            Self::UdpBroadcast { host, port } => {
                let allow = |socket: &UdpSocket, _: SocketAddr| socket.set_broadcast(true);
                Ok(Opened::Datagrams(udp_to(host, *port, allow)?))
            }
            Self::UdpServer { host, port } => {
                Ok(Opened::DatagramServer(prepared(UdpSocket::bind((host.as_str(), *port))?)?))
            }
            Self::TcpServer { host, port } => {
                let listener = TcpListener::bind((host.as_str(), *port))?;
                listener.set_nonblocking(true)?;
                Ok(Opened::Listener(listener))
            }
            // A name that nobody knows is a mistake; a server that is not there yet is none.
            Self::TcpClient { host, port } => {
                resolve(host, *port)?;
                Ok(Opened::Dialled(None))
            }
            Self::Serial { .. } => Ok(Opened::Dialled(Some(self.dial()?))),
        }
    }

    /// Connects, however long that takes.
    pub(super) fn dial(&self) -> io::Result<Stream> {
        match self {
            Self::Serial { path, baud, flow_control } => {
                serial::open(path, *baud, *flow_control).map(Stream::Serial)
            }
            Self::TcpClient { host, port } => {
                let mut last = io::ErrorKind::AddrNotAvailable.into();
                for address in (host.as_str(), *port).to_socket_addrs()? {
                    match TcpStream::connect_timeout(&address, CONNECT_TIMEOUT) {
                        Ok(stream) => return Stream::tcp(stream),
                        Err(error) => last = error,
                    }
                }
                Err(last)
            }
            _ => Err(io::ErrorKind::Unsupported.into()),
        }
    }

    /// The address that datagrams go to which have no other.
    pub(super) fn broadcast_address(&self) -> io::Result<Option<SocketAddr>> {
        match self {
            Self::UdpBroadcast { host, port } => resolve(host, *port).map(Some),
            _ => Ok(None),
        }
    }
}

fn resolve(host: &str, port: u16) -> io::Result<SocketAddr> {
    let first = (host, port).to_socket_addrs()?.next();
    first.ok_or_else(|| io::ErrorKind::AddrNotAvailable.into())
}

/// A socket of the family of an address, made ready to send there.
fn udp_to(
    host: &str,
    port: u16,
    ready: impl Fn(&UdpSocket, SocketAddr) -> io::Result<()>,
) -> io::Result<UdpSocket> {
    let to = resolve(host, port)?;
    let any = if to.is_ipv4() { "0.0.0.0" } else { "::" };
    let socket = UdpSocket::bind((any, 0))?;
    ready(&socket, to)?;
    prepared(socket)
}

fn prepared(socket: UdpSocket) -> io::Result<UdpSocket> {
    socket.set_nonblocking(true)?;
    #[cfg(target_os = "linux")]
    let names = [libc::SO_RCVBUFFORCE, libc::SO_RCVBUF];
    #[cfg(not(target_os = "linux"))]
    let names = [libc::SO_RCVBUF];
    for name in names {
        // SAFETY: the pointer is to a number of the length given, which the call only reads.
        let done = unsafe {
            libc::setsockopt(
                socket.as_raw_fd(),
                libc::SOL_SOCKET,
                name,
                (&raw const RECEIVE_BUFFER).cast(),
                size_of_val(&RECEIVE_BUFFER) as libc::socklen_t,
            )
        };
        if done == 0 {
            break;
        }
    }
    Ok(socket)
}
