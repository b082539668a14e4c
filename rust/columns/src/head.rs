//! Which of the first bytes of a log tell what kind of log it is, where damage or something else stands in front of it.

use std::io::{self, Read};
use std::sync::LazyLock;

use mavwire_core::builtin;
use mavwire_core::registry::Registry;
use mavwire_schema::WireVersion;

use crate::dataflash::Form;
use crate::scan::Framing;

/// Bytes that tell what kind of log it is.
const WINDOW: usize = 64 << 10;
/// So far into a log they are looked for.
const MOST: usize = 4 * WINDOW;
/// Bytes of zeros or ones in a row that no log begins with.
const FILLER: usize = 16;

/// What tells a telemetry log from another one.
pub(crate) static TELEMETRY: LazyLock<Registry> = LazyLock::new(|| {
    Registry::new(builtin::dialect("all", WireVersion::V2).expect("it comes with the crate"))
});

/// The first of some bytes of a log that are of a kind of log without doubt, or failing that those at the start.
pub(crate) fn telling(head: &[u8]) -> &[u8] {
    let head = &head[..head.len().min(MOST)];
    let unfilled = &head[filler(head)..];
    let found = unfilled.chunks(WINDOW).find(|window| is_sure(window));
    found.unwrap_or(&head[..head.len().min(WINDOW)])
}

/// As much of the start of a log as [`telling`] needs. What was read before an error is given in its place.
///
/// # Errors
/// What reading says before the first byte.
pub(crate) fn read(source: impl Read) -> io::Result<Vec<u8>> {
    let mut source = source.take(MOST as u64);
    let mut head = Vec::with_capacity(WINDOW);
    loop {
        let wanted = WINDOW as u64;
        match source.by_ref().take(wanted).read_to_end(&mut head) {
            Err(error) if head.is_empty() => return Err(error),
            Ok(read) if read == WINDOW && !is_sure(&head[head.len() - WINDOW..]) => {}
            _ => return Ok(head),
        }
    }
}

/// Bytes in front that a card or a file system left there.
fn filler(head: &[u8]) -> usize {
    let first = head.first().copied().unwrap_or_default();
    let alike = head.iter().take_while(|&&byte| byte == first).count();
    if matches!(first, 0 | 0xFF) && alike >= FILLER { alike } else { 0 }
}

/// Whether bytes are of a kind of log without doubt; a few at the end of what was read are none.
fn is_sure(window: &[u8]) -> bool {
    window.len() > FILLER && (Form::of(window).is_some() || Framing::is_in(window, &TELEMETRY))
}
