//! Frames without what tells who flew where: positions are shifted, identifiers emptied, signatures and keys removed.
//!
//! What a message's fields are is told by their units and names in the definitions. Messages that carry bytes of any
//! meaning are left out, and so are those that the dialect does not have: nobody can say what is in them.

use std::collections::HashSet;

use mavwire_schema::{Dialect, Field, FieldType, Message, WireVersion};

use crate::codec::{read, text_bytes};
use crate::frame::{self, Header, IFLAG_SIGNED};
use crate::log::tlog::recordable;
use crate::registry::Entry;

/// Messages that are left out.
const LEFT_OUT: &[&str] = &[
    "AUTH_KEY",
    "CANFD_FRAME",
    "CAN_FRAME",
    "DATA16",
    "DATA32",
    "DATA64",
    "DATA96",
    "DEVICE_OP_READ_REPLY",
    "DEVICE_OP_WRITE",
    "ENCAPSULATED_DATA",
    "FILE_TRANSFER_PROTOCOL",
    "FRSKY_PASSTHROUGH_ARRAY",
    "GPS_INJECT_DATA",
    "GPS_RTCM_DATA",
    "LOGGING_DATA",
    "LOGGING_DATA_ACKED",
    "LOG_DATA",
    "MEMORY_VECT",
    "PARAM_EXT_ACK",
    "PARAM_EXT_SET",
    "PARAM_EXT_VALUE",
    "PARAM_VALUE_ARRAY",
    "REMOTE_LOG_DATA_BLOCK",
    "RESOURCE_REQUEST",
    "SECURE_COMMAND",
    "SECURE_COMMAND_REPLY",
    "SERIAL_CONTROL",
    "SETUP_SIGNING",
    "TUNNEL",
    "V2_EXTENSION",
];
const LEFT_OUT_PREFIX: &str = "OPEN_DRONE_ID_";

/// Fields that are emptied.
const IDENTIFIERS: &[&str] = &[
    "ICAO",
    "ICAO_address",
    "MMSI",
    "apn",
    "callsign",
    "cam_definition_uri",
    "custom_name",
    "file_url",
    "flight_id",
    "flight_uuid",
    "hw_unique_id",
    "lac",
    "login",
    "mcc",
    "mnc",
    "new_pin",
    "passkey",
    "password",
    "pin",
    "puk",
    "registration",
    "serial",
    "serial_number",
    "serialnumber",
    "squawk",
    "ssid",
    "uas_id",
    "uid",
    "uid2",
    "uri",
];

/// Messages whose field `name` is one as well: elsewhere it tells what a value means.
const NAMED: &[&str] = &["AIS_VESSEL", "VIDEO_STREAM_INFORMATION"];

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

/// A coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Axis {
    Latitude,
    Longitude,
}

/// What to do with a field.
#[derive(Debug, Clone)]
enum Edit {
    /// A position, so many units to the degree.
    Move(Field, Axis, f64),
    /// An identifier.
    Empty(Field),
    /// A text in which somebody may have written one.
    Mask(Field),
    /// The value of a parameter (first), if its name (second) says that it is an identifier or a position.
    Parameter(Field, Field),
    /// x and y of a mission item or command, where the frame (last) is global; so many units to the degree.
    Item([Field; 3], f64),
    /// The 5th and 6th parameter of a command (last), where it has a location.
    Command([Field; 3]),
}

/// What to do with messages of a type.
#[derive(Debug, Clone)]
enum Plan {
    LeaveOut,
    Edit(Vec<Edit>),
}

/// Makes frames anonymous.
#[derive(Debug, Clone)]
pub struct Anonymizer {
    /// By message index.
    plans: Vec<Plan>,
    with_location: HashSet<u32>,
    shift: Shift,
}

impl Anonymizer {
    /// For the messages of a dialect.
    pub fn new(dialect: &Dialect, shift: Shift) -> Self {
        let plans = dialect.messages.iter().map(plan).collect();
        let commands = dialect.enums.iter().find(|one| one.name == "MAV_CMD");
        let entries = commands.iter().flat_map(|commands| &commands.entries);
        let with_location = entries
            .filter(|entry| entry.has_location)
            .filter_map(|entry| u32::try_from(entry.value).ok())
            .collect();
        Self { plans, with_location, shift }
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
            Edit::Mask(field) => mask(bytes_of(field, payload)),
            Edit::Parameter(value, name) => {
                if tells(text_bytes(name, payload)) {
                    bytes_of(value, payload).fill(0);
                }
            }
            Edit::Item([x, y, frame], units) => {
                if GLOBAL_FRAMES.contains(&payload[usize::from(frame.offset)]) {
                    self.shift_field(x, Axis::Latitude, *units, payload);
                    self.shift_field(y, Axis::Longitude, *units, payload);
                }
            }
            Edit::Command([x, y, command]) => {
                let command = u16::from_le_bytes(read(payload, command.offset.into()));
                if self.with_location.contains(&u32::from(command)) {
                    self.shift_field(x, Axis::Latitude, 1.0, payload);
                    self.shift_field(y, Axis::Longitude, 1.0, payload);
                }
            }
        }
    }

    /// Shifts all elements of a field; 0, the largest integer and not-a-number stand for no position and stay.
    fn shift_field(&self, field: &Field, axis: Axis, units: f64, payload: &mut [u8]) {
        let (kind, size) = (field.field_type, field.field_type.size());
        for bytes in bytes_of(field, payload).chunks_exact_mut(size) {
            let here = match kind {
                FieldType::I32 => f64::from(i32::from_le_bytes(read(bytes, 0))),
                FieldType::F32 => f64::from(f32::from_le_bytes(read(bytes, 0))),
                FieldType::F64 => f64::from_le_bytes(read(bytes, 0)),
                _ => continue,
            };
            if here == 0.0
                || !here.is_finite()
                || (kind == FieldType::I32 && here >= 2_147_483_647.0)
            {
                continue;
            }
            let there = self.shifted(here / units, axis) * units;
            match kind {
                FieldType::I32 => bytes.copy_from_slice(&(there.round() as i32).to_le_bytes()),
                FieldType::F32 => bytes.copy_from_slice(&(there as f32).to_le_bytes()),
                _ => bytes.copy_from_slice(&there.to_le_bytes()),
            }
        }
    }

    fn shifted(&self, degrees: f64, axis: Axis) -> f64 {
        match axis {
            Axis::Latitude => (degrees + self.shift.latitude).clamp(-90.0, 90.0),
            Axis::Longitude => (degrees + self.shift.longitude + 180.0).rem_euclid(360.0) - 180.0,
        }
    }
}

fn plan(message: &Message) -> Plan {
    let name = message.name.as_str();
    if LEFT_OUT.contains(&name) || name.starts_with(LEFT_OUT_PREFIX) {
        return Plan::LeaveOut;
    }
    let field = |name: &str| message.fields.iter().find(|field| field.name == name).cloned();
    let three = |names: [&str; 3]| {
        let [one, two, three] = names;
        Some([field(one)?, field(two)?, field(three)?])
    };
    let in_frame = three(["x", "y", "frame"]).or_else(|| three(["x", "y", "coordinate_frame"]));
    let special = match name {
        "MISSION_ITEM" => in_frame.map(|fields| Edit::Item(fields, 1.0)),
        "COMMAND_LONG" => three(["param5", "param6", "command"]).map(Edit::Command),
        "PARAM_VALUE" | "PARAM_SET" => {
            let fields = field("param_value").zip(field("param_id"));
            fields.map(|(value, name)| Edit::Parameter(value, name))
        }
        "STATUSTEXT" | "STATUSTEXT_LONG" => field("text").map(Edit::Mask),
        "NAMED_VALUE_STRING" => field("value").map(Edit::Mask),
        name if NAMED.contains(&name) => field("name").map(Edit::Empty),
        _ => in_frame
            .filter(|[x, ..]| x.field_type == FieldType::I32)
            .map(|fields| Edit::Item(fields, 1e7)),
    };
    let mut edits: Vec<Edit> = message.fields.iter().filter_map(edit_of).collect();
    edits.extend(special);
    Plan::Edit(edits)
}

/// What to do with a field whatever message it is in.
fn edit_of(field: &Field) -> Option<Edit> {
    if IDENTIFIERS.contains(&field.name.as_str()) {
        return Some(Edit::Empty(field.clone()));
    }
    let units = match field.units.as_deref()? {
        "degE7" => 1e7,
        "degE5" => 1e5,
        "deg" => 1.0,
        _ => return None,
    };
    Some(Edit::Move(field.clone(), axis_of(&field.name)?, units))
}

/// The coordinate that a name has among its words, as in `next_lat` and `gpsLon`.
fn axis_of(name: &str) -> Option<Axis> {
    let mut words = name.as_bytes().chunk_by(|before, letter| {
        *before != b'_' && !(before.is_ascii_lowercase() && letter.is_ascii_uppercase())
    });
    words.find_map(|word| {
        let word = word.to_ascii_lowercase();
        match word.strip_suffix(b"_").unwrap_or(&word) {
            b"lat" | b"latitude" => Some(Axis::Latitude),
            b"lon" | b"lng" | b"longitude" => Some(Axis::Longitude),
            _ => None,
        }
    })
}

fn bytes_of<'a>(field: &Field, payload: &'a mut [u8]) -> &'a mut [u8] {
    let start = usize::from(field.offset).min(payload.len());
    let end = (start + field.elements() * field.field_type.size()).min(payload.len());
    &mut payload[start..end]
}

/// Whether a parameter of this name tells who or where a vehicle is.
fn tells(name: &[u8]) -> bool {
    let name = String::from_utf8_lossy(name).to_ascii_uppercase();
    let identifies = ["DEVID", "DEV_ID", "SERIAL_NUM", "ICAO", "CALLSIGN"];
    let sensor = (name.starts_with("INS_") || name.starts_with("CAL_")) && name.ends_with("_ID");
    sensor
        || identifies.iter().any(|part| name.contains(part))
        || ["_LAT", "_LNG", "_LON"].iter().any(|end| name.ends_with(end))
}

/// Overwrites words of many hexadecimal digits.
fn mask(text: &mut [u8]) {
    for word in text.chunk_by_mut(|a, b| a.is_ascii_hexdigit() == b.is_ascii_hexdigit()) {
        let is_word = word[0].is_ascii_hexdigit() && word.iter().any(u8::is_ascii_digit);
        if is_word && word.len() >= IDENTIFIER_DIGITS {
            word.fill(b'x');
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin;
    use crate::frame::FrameRef;
    use crate::registry::Registry;
    use crate::testing::header;
    use mavwire_schema::WireVersion::{V1, V2};

    const SHIFT: Shift = Shift { latitude: 10.0, longitude: -100.0 };

    /// A message with payload bytes set by field, made anonymous; its payload at full length.
    fn anonymous(
        name: &str,
        version: WireVersion,
        fields: &[(&str, &[u8])],
    ) -> Option<(Message, Vec<u8>)> {
        let registry = Registry::new(builtin::dialect("all", V2).expect("the dialect"));
        let message =
            registry.dialect().messages.iter().find(|one| one.name == name).expect(name).clone();
        let len = if version == V1 { message.min_len } else { message.max_len };
        let mut payload = vec![0; len.into()];
        for (name, bytes) in fields {
            let field = message.fields.iter().find(|field| field.name == *name).expect(name);
            payload[field.offset.into()..][..bytes.len()].copy_from_slice(bytes);
        }
        let mut frame = Vec::new();
        frame::encode(&mut frame, header(version, message.id, 7), &payload, message.crc_extra)
            .expect("a frame");
        let anonymizer = Anonymizer::new(registry.dialect(), SHIFT);
        let header = Header::parse(&frame).expect("a header");
        let mut out = Vec::new();
        if !anonymizer.apply(&frame, &header, registry.lookup(message.id), &mut out) {
            return None;
        }
        let made = FrameRef::parse(&out).expect("a frame");
        assert_eq!(made.calculated_checksum(message.crc_extra), made.checksum());
        let mut payload = made.payload().to_vec();
        payload.resize(message.max_len.into(), 0);
        Some((message, payload))
    }

    fn value<const N: usize>(made: &(Message, Vec<u8>), name: &str) -> [u8; N] {
        let field = made.0.fields.iter().find(|field| field.name == name).expect(name);
        read(&made.1, field.offset.into())
    }

    #[test]
    fn positions_are_shifted_together() {
        for version in [V1, V2] {
            let (lat, lon) = (473_977_418_i32.to_le_bytes(), 85_455_938_i32.to_le_bytes());
            let fields = [("lat", &lat[..]), ("lon", &lon[..]), ("eph", &[9, 0])];
            let made = anonymous("GPS_RAW_INT", version, &fields).expect("a message");
            assert_eq!(i32::from_le_bytes(value(&made, "lat")), 573_977_418);
            assert_eq!(i32::from_le_bytes(value(&made, "lon")), 85_455_938 - 1_000_000_000);
            assert_eq!(value::<2>(&made, "eph"), [9, 0]);
        }
        let far = (-1_700_000_000_i32).to_le_bytes();
        let made = anonymous("GPS_RAW_INT", V2, &[("lon", &far)]).expect("a message");
        assert_eq!(i32::from_le_bytes(value(&made, "lon")), 900_000_000, "round the globe");
        assert_eq!(i32::from_le_bytes(value(&made, "lat")), 0, "no position stays none");
    }

    #[test]
    fn items_and_commands_are_shifted_where_they_are_places() {
        for (frame, expected) in [(6, 150_000_000), (1, 50_000_000)] {
            let x = 50_000_000_i32.to_le_bytes();
            let made = anonymous("MISSION_ITEM_INT", V2, &[("x", &x), ("frame", &[frame])]);
            assert_eq!(i32::from_le_bytes(value(&made.expect("a message"), "x")), expected);
        }
        for (command, expected) in [(16_u16, 15.0_f32), (400, 5.0)] {
            let fields =
                [("param5", &5.0_f32.to_le_bytes()[..]), ("command", &command.to_le_bytes())];
            let made = anonymous("COMMAND_LONG", V2, &fields).expect("a message");
            assert_eq!(f32::from_le_bytes(value(&made, "param5")).to_bits(), expected.to_bits());
        }
    }

    #[test]
    fn places_of_any_message_with_a_frame_are_shifted() {
        let (x, y) = (473_977_418_i32.to_le_bytes(), 85_455_938_i32.to_le_bytes());
        for name in ["ORBIT_EXECUTION_STATUS", "COMMAND_INT_STAMPED", "COMMAND_INT"] {
            let made = anonymous(name, V2, &[("x", &x), ("y", &y), ("frame", &[5])]);
            let made = made.expect("a message");
            assert_eq!(i32::from_le_bytes(value(&made, "x")), 573_977_418, "{name}");
            assert_eq!(i32::from_le_bytes(value(&made, "y")), 85_455_938 - 1_000_000_000, "{name}");
        }
        let made = anonymous("UAVIONIX_ADSB_OUT_DYNAMIC", V2, &[("gpsLat", &x), ("gpsLon", &y)]);
        let made = made.expect("a message");
        assert_eq!(i32::from_le_bytes(value(&made, "gpsLat")), 573_977_418);
        assert_eq!(i32::from_le_bytes(value(&made, "gpsLon")), 85_455_938 - 1_000_000_000);
    }

    /// Fields of bytes that stay: what they say is the same for every vehicle of a kind, or is measured.
    const KEPT: &[&str] = &[
        "DEBUG_FLOAT_ARRAY.name",
        "DEBUG_VECT.name",
        "GOPRO_GET_RESPONSE.value",
        "GOPRO_SET_REQUEST.value",
        "NAMED_VALUE_FLOAT.name",
        "NAMED_VALUE_INT.name",
        "NAMED_VALUE_STRING.name",
        "STORAGE_INFORMATION.name",
        "UAVCAN_NODE_INFO.name",
    ];
    const KEPT_ANYWHERE: &[&str] = &[
        "Servo_status",
        "band_str",
        "busname",
        "completion_mask",
        "cpu_combined",
        "cpu_cores",
        "custom_bytes",
        "device_name",
        "flight_custom_version",
        "gpu_combined",
        "gpu_cores",
        "manufacture_date",
        "middleware_custom_version",
        "mode_name",
        "mode_str",
        "model_name",
        "os_custom_version",
        "param_id",
        "rc_raw",
        "satellite_azimuth",
        "satellite_elevation",
        "satellite_prn",
        "satellite_snr",
        "satellite_used",
        "temperature",
        "temperature_core",
        "tune",
        "tune2",
        "vendor_name",
    ];

    /// What a field of bytes or a place must not be left out of: a plan of its message that changes it.
    fn is_changed(message: &Message, field: &Field) -> bool {
        let Plan::Edit(edits) = plan(message) else { return true };
        edits.iter().any(|edit| match edit {
            Edit::Move(one, ..) | Edit::Empty(one) | Edit::Mask(one) => one.name == field.name,
            Edit::Parameter(value, _) => value.name == field.name,
            Edit::Item([x, y, _], _) | Edit::Command([x, y, _]) => {
                [&x.name, &y.name].contains(&&field.name)
            }
        })
    }

    #[test]
    fn every_field_that_may_tell_is_changed_or_known_to_stay() {
        let dialect = builtin::dialect("all", V2).expect("the dialect");
        let mut unknown = Vec::new();
        for message in &dialect.messages {
            for field in message.fields.iter().filter(|field| !is_changed(message, field)) {
                use FieldType::{Char, I8, I32, U8};
                let name = format!("{}.{}", message.name, field.name);
                let is_bytes = field.array_length > 0 && matches!(field.field_type, Char | U8 | I8);
                let is_place = field.field_type == I32
                    && field.units.is_none()
                    && ["x", "y"].contains(&field.name.as_str());
                let is_angle = axis_of(&field.name).is_some()
                    && field.units.as_deref().is_some_and(|units| units.starts_with("deg"));
                let is_known = KEPT.contains(&name.as_str())
                    || KEPT_ANYWHERE.contains(&field.name.as_str())
                    || message.name.contains("TEST");
                if is_place || is_angle || is_bytes && !is_known {
                    unknown.push(name);
                }
            }
        }
        assert!(unknown.is_empty(), "do these tell who flew where? {unknown:#?}");
    }

    #[test]
    fn identifiers_are_emptied() {
        for (name, field) in [
            ("UTM_GLOBAL_POSITION", "uas_id"),
            ("AIRLINK_AUTH", "login"),
            ("VIDEO_STREAM_INFORMATION", "uri"),
            ("VIDEO_STREAM_INFORMATION", "name"),
            ("AIS_VESSEL", "name"),
            ("GIMBAL_DEVICE_INFORMATION", "custom_name"),
            ("CAMERA_IMAGE_CAPTURED", "file_url"),
            ("CAMERA_INFORMATION", "cam_definition_uri"),
        ] {
            let made = anonymous(name, V2, &[(field, b"secret")]).expect("a message");
            assert_eq!(value::<6>(&made, field), [0; 6], "{name}.{field}");
        }
        let made = anonymous("AUTOPILOT_VERSION", V2, &[("uid", &[7; 8]), ("uid2", &[7; 18])]);
        let made = made.expect("a message");
        assert_eq!((value::<8>(&made, "uid"), value::<16>(&made, "uid2")), ([0; 8], [0; 16]));
        let text = b"Cube 0032001F 34375108 ok";
        let made = anonymous("STATUSTEXT", V2, &[("text", text)]).expect("a message");
        assert_eq!(&value::<25>(&made, "text"), b"Cube xxxxxxxx xxxxxxxx ok");
        for (name, expected) in
            [("COMPASS_DEV_ID2", 0), ("INS_ACC_ID", 0), ("SIM_OPOS_LAT", 0), ("RC1_MIN", 5)]
        {
            let fields = [("param_id", name.as_bytes()), ("param_value", &[5, 0, 0, 0][..])];
            let made = anonymous("PARAM_VALUE", V2, &fields).expect("a message");
            assert_eq!(value::<4>(&made, "param_value"), [expected, 0, 0, 0], "{name}");
        }
    }

    #[test]
    fn what_is_longer_than_its_definition_is_cut() {
        let registry = Registry::new(builtin::dialect("all", V2).expect("the dialect"));
        let anonymizer = Anonymizer::new(registry.dialect(), SHIFT);
        for version in [V1, V2] {
            // With an identifier in it, and without anything to change.
            for msgid in [148, 0] {
                let entry = registry.lookup(msgid).expect("it is known");
                let mut payload = vec![1; entry.max_len.into()];
                payload.extend_from_slice(b"who it was");
                let (mut frame, mut out) = (Vec::new(), Vec::new());
                frame::encode(&mut frame, header(version, msgid, 7), &payload, entry.crc_extra)
                    .expect("a frame");
                let header = Header::parse(&frame).expect("a header");
                assert!(anonymizer.apply(&frame, &header, Some(entry), &mut out));
                let made = FrameRef::parse(&out).expect("a frame");
                assert!(made.payload().len() <= entry.max_len.into(), "{version:?} {msgid}");
                assert_eq!(made.calculated_checksum(entry.crc_extra), made.checksum());
            }
        }
    }

    #[test]
    fn what_may_hold_anything_is_left_out() {
        for name in ["SETUP_SIGNING", "FILE_TRANSFER_PROTOCOL", "OPEN_DRONE_ID_BASIC_ID", "TUNNEL"]
        {
            assert!(anonymous(name, V2, &[]).is_none(), "{name}");
        }
    }
}
