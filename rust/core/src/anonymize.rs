//! Frames without what tells who flew where: positions are shifted, identifiers emptied, signatures and keys removed.
//!
//! Units and names in the definitions tell whether a field is a position or an identifier. Messages that carry bytes of
//! any meaning are left out, and so are messages that the dialect does not define.

mod parameters;
mod plan;

use std::collections::HashMap;

use mavwire_schema::{Dialect, Field, FieldType, WireVersion};

use crate::codec::{read, text_bytes};
use crate::frame::{self, Header, IFLAG_SIGNED};
use crate::log::tlog::recordable;
use crate::registry::Entry;

use parameters::tells;
use plan::{Axis, Edit, Plan, coordinates_of, plan};

/// Frames of `MAV_FRAME` whose x and y are latitude and longitude.
const GLOBAL_FRAMES: [u8; 6] = [0, 3, 5, 6, 10, 11];

/// Hexadecimal digits in a row that make an identifier of a word.
const IDENTIFIER_DIGITS: usize = 8;

/// By how much positions are shifted, degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shift {
    /// To the north.
    pub latitude: f64,
    /// To the east.
    pub longitude: f64,
}

/// Makes frames anonymous.
#[derive(Debug, Clone)]
pub struct Anonymizer {
    /// By message index.
    plans: Vec<Plan>,
    /// Which parameters of a command are coordinates, by their numbers.
    coordinates: HashMap<u32, Vec<(u8, Axis)>>,
    shift: Shift,
}

impl Anonymizer {
    /// For the messages of a dialect.
    pub fn new(dialect: &Dialect, shift: Shift) -> Self {
        let plans = dialect.messages.iter().map(plan).collect();
        let commands = dialect.enums.iter().find(|one| one.name == "MAV_CMD");
        let entries = commands.iter().flat_map(|commands| &commands.entries);
        let coordinates = entries
            .filter_map(|entry| Some((u32::try_from(entry.value).ok()?, coordinates_of(entry))))
            .collect();
        Self { plans, coordinates, shift }
    }

    /// Appends what may be left of a whole, good frame; false if that is nothing.
    pub fn apply(
        &self,
        frame: &[u8],
        header: &Header,
        entry: Option<Entry>,
        out: &mut Vec<u8>,
    ) -> bool {
        let Some(entry) = entry else { return false };
        let edits = match &self.plans[usize::from(entry.index)] {
            Plan::LeaveOut => return false,
            Plan::Edit(edits) => edits,
        };
        if edits.is_empty() && usize::from(header.payload_len) <= usize::from(entry.max_len) {
            out.extend_from_slice(&recordable(frame));
            return true;
        }
        let sent = &frame[header.len()..][..usize::from(header.payload_len)];
        // Nobody can say what is in bytes behind the definition's.
        let most = usize::from(entry.max_len);
        let mut payload = sent[..sent.len().min(most)].to_vec();
        let whole = match header.version {
            WireVersion::V1 => payload.len(),
            WireVersion::V2 => most,
        };
        payload.resize(most, 0);
        for edit in edits {
            self.edit(edit, &mut payload);
        }
        payload.truncate(whole);
        let header = Header { incompat_flags: header.incompat_flags & !IFLAG_SIGNED, ..*header };
        frame::encode(out, header, &payload, entry.crc_extra).is_ok()
    }

    fn edit(&self, edit: &Edit, payload: &mut [u8]) {
        match edit {
            Edit::Move(field, axis, units) => self.shift_field(field, *axis, *units, payload),
            Edit::Empty(field) => bytes_of(field, payload).fill(0),
            Edit::Mask(field, id) => {
                let is_set = |id: &Field| bytes_of(id, payload).iter().any(|byte| *byte != 0);
                let is_part = id.as_ref().is_some_and(is_set);
                mask(bytes_of(field, payload), is_part);
            }
            Edit::Parameter(values, name) => {
                if tells(text_bytes(name, payload)) {
                    for value in values {
                        bytes_of(value, payload).fill(0);
                    }
                }
            }
            Edit::Item(fields, units) => {
                let [x, y, frame] = &**fields;
                if GLOBAL_FRAMES.contains(&payload[usize::from(frame.offset)]) {
                    self.shift_field(x, Axis::Latitude, *units, payload);
                    self.shift_field(y, Axis::Longitude, *units, payload);
                }
            }
            Edit::Command(parameters, command) => {
                let command = u16::from_le_bytes(read(payload, command.offset.into()));
                let coordinates = self.coordinates.get(&command.into()).map_or(&[][..], |all| all);
                for (number, field) in parameters {
                    for (_, axis) in coordinates.iter().filter(|(one, _)| one == number) {
                        self.shift_field(field, *axis, 1.0, payload);
                    }
                }
            }
        }
    }

    /// Shifts all elements of a field; 0, the largest integer and not-a-number mean "no position" and stay.
    fn shift_field(&self, field: &Field, axis: Axis, units: f64, payload: &mut [u8]) {
        use FieldType as T;
        let (kind, size) = (field.field_type, field.field_type.size());
        for bytes in bytes_of(field, payload).chunks_exact_mut(size) {
            let (here, put): (f64, fn(f64, &mut [u8])) = match kind {
                T::I32 => (i32::from_le_bytes(read(bytes, 0)).into(), |there, out| {
                    out.copy_from_slice(&(there.round() as i32).to_le_bytes());
                }),
                T::F32 => (f32::from_le_bytes(read(bytes, 0)).into(), |there, out| {
                    out.copy_from_slice(&(there as f32).to_le_bytes());
                }),
                T::F64 => (f64::from_le_bytes(read(bytes, 0)), |there, out| {
                    out.copy_from_slice(&there.to_le_bytes());
                }),
                T::Char | T::U8 | T::I8 | T::U16 | T::I16 | T::U32 | T::U64 | T::I64 => return,
            };
            if here == 0.0 || !here.is_finite() || (kind == T::I32 && here >= 2_147_483_647.0) {
                continue;
            }
            // Commands and items have degrees or, as definitions and senders differ, degE7 in such a field.
            let is_scaled = kind == T::F32 && here.abs() > 360.0;
            let units = if is_scaled { 1e7 } else { units };
            put(self.shifted(here / units, axis) * units, bytes);
        }
    }

    fn shifted(&self, degrees: f64, axis: Axis) -> f64 {
        match axis {
            Axis::Latitude => (degrees + self.shift.latitude).clamp(-90.0, 90.0),
            Axis::Longitude => (degrees + self.shift.longitude + 180.0).rem_euclid(360.0) - 180.0,
        }
    }
}

fn bytes_of<'a>(field: &Field, payload: &'a mut [u8]) -> &'a mut [u8] {
    let start = usize::from(field.offset).min(payload.len());
    let end = (start + field.elements() * field.field_type.size()).min(payload.len());
    &mut payload[start..end]
}

/// Overwrites words of many hexadecimal digits, and those at the ends of a part of a text, which may go on beyond.
fn mask(text: &mut [u8], is_part: bool) {
    let (all, mut end) = (text.len(), 0);
    for word in text.chunk_by_mut(|a, b| a.is_ascii_hexdigit() == b.is_ascii_hexdigit()) {
        let is_first = end == 0;
        end += word.len();
        let is_long = word.len() >= IDENTIFIER_DIGITS && word.iter().any(u8::is_ascii_digit);
        let may_go_on = is_part && (is_first || end == all);
        if word[0].is_ascii_hexdigit() && (is_long || may_go_on) {
            word.fill(b'x');
        }
    }
}

#[cfg(test)]
mod tests;
