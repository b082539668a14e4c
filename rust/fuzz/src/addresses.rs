//! Addresses of peers and places where links lead: as text, and as the operating system has them.

use mavwire_io::address::Address;
use mavwire_io::bridge::{Endpoint, NetKind};

use crate::input::Input;

/// Any text as a host or a device.
pub fn endpoint(data: &[u8]) {
    let mut input = Input::new(data);
    let (kind, port) = (input.byte(), input.number());
    let (flow, scope) = (input.long() as u32, input.long() as u32);
    let text = String::from_utf8_lossy(input.rest()).into_owned();
    if let Some(address) = Address::new(&text, port, flow, scope) {
        numeric(&address);
    }
    shown(kind, &text, port, flow);
}

/// An address can be made again from its own parts, and from the operating system's form of it.
fn numeric(address: &Address) {
    let (flow, scope) = address.flow_and_scope().unwrap_or_default();
    assert_eq!(address.flow_and_scope().is_some(), address.host().contains(':'));
    let again = Address::new(&address.host(), address.port(), flow, scope);
    assert_eq!(again, Some(*address));
    assert_eq!(Address::from(address.socket_addr()), *address);
    #[cfg(target_os = "linux")]
    {
        let (name, len) = address.to_os();
        assert!(len as usize <= size_of_val(&name));
        assert_eq!(Address::from_os(&name), Some(*address));
    }
}

/// An endpoint as text can be taken apart again.
fn shown(kind: u8, text: &str, port: u16, baud: u32) {
    let host = text.to_owned();
    let endpoint = match kind % 6 {
        0 => Endpoint::Net { kind: NetKind::UdpClient, host, port },
        1 => Endpoint::Net { kind: NetKind::UdpServer, host, port },
        2 => Endpoint::Net { kind: NetKind::UdpBroadcast, host, port },
        3 => Endpoint::Net { kind: NetKind::TcpClient, host, port },
        4 => Endpoint::Net { kind: NetKind::TcpServer, host, port },
        _ => Endpoint::Serial { path: text.into(), baud, flow_control: false },
    };
    let words = ["udpout", "udpin", "udpbcast", "tcp", "tcpin", "serial"];
    let shown = endpoint.to_string();
    let (word, rest) = shown.split_once(':').expect("a word in front");
    let (place, number) = rest.rsplit_once(':').expect("a number behind");
    assert_eq!(word, words[usize::from(kind % 6)]);
    if kind % 6 == 5 {
        assert_eq!((place, number.parse()), (text, Ok(baud)));
    } else {
        let in_brackets = place.strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
        let host = in_brackets.filter(|host| host.contains(':')).unwrap_or(place);
        assert_eq!((host, number.parse()), (text, Ok(port)));
    }
}
