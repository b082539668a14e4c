//! The work of a bridge for a frame, for counting instructions under callgrind: `forward CASE N` hands about N frames to a
//! bridge and reads them from its other end. `forward` leaves everything out that has to be asked for; `border` adds
//! signatures and heartbeats. The check of what a program sends is in it, one checksum of each frame.

use mavwire_core::builtin;
use mavwire_core::frame::{self, Header};
use mavwire_core::registry::Registry;
use mavwire_core::router::Settings;
use mavwire_core::schema::WireVersion;
use mavwire_core::signing::SecretKey;
use mavwire_io::bridge::{Bridge, Endpoint, LinkSpec, NetKind, PortSpec};
use std::error::Error;
use std::net::{Ipv4Addr, UdpSocket};
use std::sync::Arc;
use std::time::Duration;

/// Frames in one call: as many as a socket holds until they are read.
const BLOCK: usize = 100;
const ATTITUDE: u32 = 30;
const LIMIT: Duration = Duration::from_secs(60);

/// Telemetry frames, each with a number of its own; sent again they are no copies, since they come over the same link.
fn frames(registry: &Registry) -> Result<Vec<u8>, Box<dyn Error>> {
    let entry = registry.lookup(ATTITUDE).ok_or("the dialect lacks ATTITUDE")?;
    let mut bytes = Vec::new();
    for seq in 0..BLOCK as u8 {
        let header = Header::new(WireVersion::V2, seq, 1, 1, ATTITUDE);
        frame::encode(&mut bytes, header, &[seq | 1; 28], entry.crc_extra)?;
    }
    Ok(bytes)
}

fn spec(case: &str, port: u16) -> Result<LinkSpec, Box<dyn Error>> {
    let mut spec = LinkSpec {
        name: "out".into(),
        endpoint: Endpoint::Net {
            kind: NetKind::UdpClient,
            host: Ipv4Addr::LOCALHOST.to_string(),
            port,
        },
        port: PortSpec { queue: 256 << 10, ..PortSpec::default() },
        peer_timeout: LIMIT,
        retry: None,
    };
    match case {
        "forward" => {}
        "border" => {
            spec.port.options.border.key = Some(Arc::new(SecretKey::new(&[7; 32])?));
            spec.port.options.border.sign = true;
            spec.port.automation.heartbeat = Some(LIMIT);
        }
        _ => return Err(format!("there is no case {case}").into()),
    }
    Ok(spec)
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let case = args.next().ok_or("usage: forward CASE N")?;
    let count: usize = args.next().ok_or("how many frames?")?.parse()?;
    let registry = Arc::new(Registry::new(builtin::dialect("ardupilotmega", WireVersion::V2)?));
    let frames = frames(&registry)?;
    let sink = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0))?;
    sink.set_read_timeout(Some(LIMIT))?;
    let bridge = Bridge::start(registry, Settings::new(1), None)?;
    bridge.add(spec(&case, sink.local_addr()?.port())?)?;
    let mut buffer = [0; 300];
    for _ in 0..count / BLOCK {
        bridge.send(&frames)?;
        for _ in 0..BLOCK {
            sink.recv(&mut buffer)?;
        }
    }
    Ok(())
}
