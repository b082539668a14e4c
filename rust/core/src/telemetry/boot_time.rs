//! Reads `time_boot_ms`, the time since the start of the sender, from messages.

use mavwire_schema::{Dialect, FieldType, Message};

use crate::codec::read;

/// The offset of `time_boot_ms` in the payload of each message of a dialect.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BootTimes {
    /// By message index.
    offsets: Box<[Option<u8>]>,
}

impl BootTimes {
    /// The offsets in the messages of a dialect.
    pub fn of(dialect: &Dialect) -> Self {
        Self { offsets: dialect.messages.iter().map(offset).collect() }
    }

    /// Milliseconds since the sender's start. 0 is no time: senders leave unknown fields empty.
    #[inline]
    pub fn millis(&self, index: u16, payload: &[u8]) -> Option<u32> {
        let offset = (*self.offsets.get(usize::from(index))?)?;
        let millis = u32::from_le_bytes(read(payload, offset.into()));
        (millis != 0).then_some(millis)
    }
}

fn offset(message: &Message) -> Option<u8> {
    let field = message.fields.iter().find(|field| field.name == "time_boot_ms")?;
    (field.field_type == FieldType::U32 && field.array_length == 0).then_some(field.offset)
}
