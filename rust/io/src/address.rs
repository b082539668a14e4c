//! The address of a datagram's sender.

use std::net::{IpAddr, SocketAddr, SocketAddrV4, SocketAddrV6};
#[cfg(unix)]
use std::net::{Ipv4Addr, Ipv6Addr};

/// Where a datagram came from. Its flow information is a number, as in Python's tuples; the operating system and the standard
/// library have it in the order of bytes of the network.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Address(SocketAddr);

impl From<SocketAddr> for Address {
    fn from(address: SocketAddr) -> Self {
        Self(with_flow(address, u32::from_be))
    }
}

fn with_flow(address: SocketAddr, change: fn(u32) -> u32) -> SocketAddr {
    match address {
        SocketAddr::V4(_) => address,
        SocketAddr::V6(mut address) => {
            address.set_flowinfo(change(address.flowinfo()));
            SocketAddr::V6(address)
        }
    }
}

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

    /// The address for the operating system, and how long it is.
    #[cfg(target_os = "linux")]
    pub fn to_os(self) -> (libc::sockaddr_storage, libc::socklen_t) {
        // SAFETY: all zero is a valid address of no family.
        let mut storage: libc::sockaddr_storage = unsafe { std::mem::zeroed() };
        let start = &raw mut storage;
        let len = match self.0 {
            SocketAddr::V4(address) => {
                let name = libc::sockaddr_in {
                    sin_family: libc::AF_INET as libc::sa_family_t,
                    sin_port: address.port().to_be(),
                    sin_addr: libc::in_addr { s_addr: u32::from(*address.ip()).to_be() },
                    sin_zero: [0; 8],
                };
                // SAFETY: `sockaddr_storage` is large enough and aligned for the addresses of all families.
                unsafe { start.cast::<libc::sockaddr_in>().write(name) };
                size_of::<libc::sockaddr_in>()
            }
            SocketAddr::V6(address) => {
                let name = libc::sockaddr_in6 {
                    sin6_family: libc::AF_INET6 as libc::sa_family_t,
                    sin6_port: address.port().to_be(),
                    sin6_flowinfo: address.flowinfo().to_be(),
                    sin6_addr: libc::in6_addr { s6_addr: address.ip().octets() },
                    sin6_scope_id: address.scope_id(),
                };
                // SAFETY: as above.
                unsafe { start.cast::<libc::sockaddr_in6>().write(name) };
                size_of::<libc::sockaddr_in6>()
            }
        };
        (storage, len as libc::socklen_t)
    }

    /// The address as the standard library has it.
    pub fn socket_addr(&self) -> SocketAddr {
        with_flow(self.0, u32::to_be)
    }

    /// The address that the operating system wrote; `None` for addresses of other families than IPv4 and IPv6.
    #[cfg(unix)]
    pub fn from_os(name: &libc::sockaddr_storage) -> Option<Self> {
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

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn the_system_gives_back_the_address_that_it_got() {
        for host in ["127.0.0.1", "::1", "fe80::1:2", "::ffff:1.2.3.4"] {
            let address = Address::new(host, 14550, 0x1_2345, 3).expect("a numeric address");
            assert_eq!(Address::from_os(&address.to_os().0), Some(address), "{host}");
            assert_eq!(Address::from(address.socket_addr()), address, "{host}");
            assert_eq!(address.flow_and_scope().is_some(), host.contains(':'));
        }
    }
}
