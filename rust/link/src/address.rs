//! The address of a datagram's sender.

use std::net::{IpAddr, SocketAddr, SocketAddrV4, SocketAddrV6};
#[cfg(unix)]
use std::net::{Ipv4Addr, Ipv6Addr};

/// Where a datagram came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Address(SocketAddr);

impl Address {
    /// The address with these parts; `None` unless `host` is a numeric address. `flow` and `scope` are IPv6's.
    pub fn new(host: &str, port: u16, flow: u32, scope: u32) -> Option<Self> {
        Some(Self(match host.parse().ok()? {
            IpAddr::V4(ip) => SocketAddr::V4(SocketAddrV4::new(ip, port)),
            IpAddr::V6(ip) => SocketAddr::V6(SocketAddrV6::new(ip, port, flow, scope)),
        }))
    }

    /// The numeric address.
    pub fn host(&self) -> String {
        self.0.ip().to_string()
    }

    /// The port number.
    pub fn port(&self) -> u16 {
        self.0.port()
    }

    /// Flow information and scope of an IPv6 address, `None` for others.
    pub fn flow_and_scope(&self) -> Option<(u32, u32)> {
        match self.0 {
            SocketAddr::V4(_) => None,
            SocketAddr::V6(address) => Some((address.flowinfo(), address.scope_id())),
        }
    }

    /// What the operating system wrote; `None` for addresses of other families.
    #[cfg(unix)]
    pub(crate) fn from_os(name: &libc::sockaddr_storage) -> Option<Self> {
        match i32::from(name.ss_family) {
            libc::AF_INET => {
                // SAFETY: of this family, and `sockaddr_storage` is large enough and aligned for all.
                let name = unsafe { &*(&raw const *name).cast::<libc::sockaddr_in>() };
                let ip = Ipv4Addr::from(u32::from_be(name.sin_addr.s_addr));
                Some(Self(SocketAddr::V4(SocketAddrV4::new(ip, u16::from_be(name.sin_port)))))
            }
            libc::AF_INET6 => {
                // SAFETY: as above.
                let name = unsafe { &*(&raw const *name).cast::<libc::sockaddr_in6>() };
                Some(Self(SocketAddr::V6(SocketAddrV6::new(
                    Ipv6Addr::from(name.sin6_addr.s6_addr),
                    u16::from_be(name.sin6_port),
                    u32::from_be(name.sin6_flowinfo),
                    name.sin6_scope_id,
                ))))
            }
            _ => None,
        }
    }
}
