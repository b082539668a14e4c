//! Frames without what tells who flew where: positions are shifted, identifiers emptied, signatures and keys removed.
//!
//! What a message's fields are is told by their units and names in the definitions. Messages that carry bytes of any
//! meaning are left out, and so are those that the dialect does not have: nobody can say what is in them.

use std::collections::HashMap;

use mavwire_schema::{Dialect, EnumEntry, Field, FieldType, Message, WireVersion};

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

/// Words of the names of parameters that are identifiers or secrets; those with STA are of Wi-Fi bridges.
const IDENTIFYING_WORDS: &[&str] = &[
    "CALLSIGN",
    "DEVID",
    "GATEWAYSTA",
    "GWADDR",
    "ICAO",
    "IP",
    "IPADDR",
    "IPADDRESS",
    "IPSTA",
    "MACADDR",
    "PASSWORD",
    "PWDSTA",
    "SQUAWK",
    "SSID",
    "SSIDSTA",
];
/// Two words of such names, one behind the other.
const IDENTIFYING_PAIRS: &[[&str; 2]] = &[["DEV", "ID"], ["SERIAL", "NUM"], ["SERIAL", "NUMBER"]];

/// First words of the names of parameters of sensors: they hold the sensor's id,
const SENSORS: &[&str] = &["CAL", "COMPASS", "INS", "TC"];
/// where the last word is one of these.
const SENSOR_IDS: &[&str] = &["ID", "PRIME"];

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
    /// Values of a parameter (first), if its name (second) says that it is an identifier or a position.
    Parameter(Vec<Field>, Field),
    /// x and y of a mission item or command, where the frame (last) is global; so many units to the degree.
    Item(Box<[Field; 3]>, f64),
    /// The parameters of a command (last), with their numbers: those that are coordinates.
    Command(Vec<(u8, Field)>, Field),
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
            Edit::Mask(field) => mask(bytes_of(field, payload)),
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
            // Commands and items have degrees or, as definitions and senders differ, degE7 in such a field.
            let is_scaled = kind == FieldType::F32 && here.abs() > 360.0;
            let units = if is_scaled { 1e7 } else { units };
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

/// Which parameters of a command are coordinates: those that are called so, and of one that has a location the 5th and
/// 6th, which not all definitions name, unless they are in a local frame.
fn coordinates_of(command: &EnumEntry) -> Vec<(u8, Axis)> {
    let located = |number: u8| match number {
        5 if command.has_location => Some(Axis::Latitude),
        6 if command.has_location => Some(Axis::Longitude),
        _ => None,
    };
    let coordinate = |number: u8| {
        let param = command.params.iter().find(|param| param.index == number);
        let label = param.and_then(|param| param.label.as_deref()).unwrap_or_default();
        let is_local = param.is_some_and(|param| param.units.as_deref() == Some("m"));
        let named = axis_of(&label.replace([' ', '/'], "_"));
        Some((number, named.or(located(number)).filter(|_| !is_local)?))
    };
    (1..=7).filter_map(coordinate).collect()
}

fn plan(message: &Message) -> Plan {
    let name = message.name.as_str();
    if LEFT_OUT.contains(&name) || name.starts_with(LEFT_OUT_PREFIX) {
        return Plan::LeaveOut;
    }
    let field = |name: &str| message.fields.iter().find(|field| field.name == name).cloned();
    let three = |names: [&str; 3]| {
        let [one, two, three] = names;
        Some(Box::new([field(one)?, field(two)?, field(three)?]))
    };
    let in_frame = three(["x", "y", "frame"]).or_else(|| three(["x", "y", "coordinate_frame"]));
    let special = match name {
        "MISSION_ITEM" => in_frame.map(|fields| Edit::Item(fields, 1.0)),
        "STATUSTEXT" | "STATUSTEXT_LONG" => field("text").map(Edit::Mask),
        "NAMED_VALUE_STRING" => field("value").map(Edit::Mask),
        name if NAMED.contains(&name) => field("name").map(Edit::Empty),
        _ => in_frame
            .filter(|fields| fields[0].field_type == FieldType::I32)
            .map(|fields| Edit::Item(fields, 1e7)),
    };
    let mut edits: Vec<Edit> = message.fields.iter().filter_map(edit_of).collect();
    edits.extend(special);
    let parameters = (1..=7).filter_map(|number| Some((number, field(&format!("param{number}"))?)));
    let parameters: Vec<_> = parameters.collect();
    let command = field("command").filter(|command| command.field_type == FieldType::U16);
    if let Some(command) = command.filter(|_| !parameters.is_empty()) {
        edits.push(Edit::Command(parameters, command));
    }
    // PARAM_MAP_RC has several.
    let values = message.fields.iter().filter(|field| field.name.starts_with("param_value"));
    let values: Vec<Field> = values.cloned().collect();
    if let Some(name) = field("param_id").filter(|_| !values.is_empty()) {
        edits.push(Edit::Parameter(values, name));
    }
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

/// Whether a parameter of this name tells who or where a vehicle is. Words are compared without the numbers behind them:
/// parts of words would be found in names of anything.
fn tells(name: &[u8]) -> bool {
    // Some senders leave what was there before behind the end.
    let name = name.split(|byte| *byte == 0).next().unwrap_or_default();
    let name = String::from_utf8_lossy(name).to_ascii_uppercase();
    let words: Vec<&str> =
        name.split('_').map(|word| word.trim_end_matches(|c: char| c.is_ascii_digit())).collect();
    let is_sensor_id = SENSORS.contains(&words[0]) && SENSOR_IDS.contains(&words[words.len() - 1]);
    is_sensor_id
        || words.iter().any(|word| IDENTIFYING_WORDS.contains(word) || axis_of(word).is_some())
        || words.windows(2).any(|pair| IDENTIFYING_PAIRS.iter().any(|one| one == pair))
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

    fn float(made: &(Message, Vec<u8>), name: &str) -> i32 {
        f32::from_le_bytes(value(made, name)).round() as i32
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
        // Waypoints, a location without labels, arming, and landing at a place in metres.
        for (command, expected) in [(16_u16, 15), (31_000, 15), (201, 15), (400, 5), (23, 5)] {
            let fields =
                [("param5", &5.0_f32.to_le_bytes()[..]), ("command", &command.to_le_bytes())];
            for name in ["COMMAND_LONG", "COMMAND_LONG_STAMPED"] {
                let made = anonymous(name, V2, &fields).expect("a message");
                assert_eq!(float(&made, "param5"), expected, "{name} {command}");
            }
        }
        // Degrees in 1e-7 of them.
        let fields = [
            ("param5", &473_977_418.0_f32.to_le_bytes()[..]),
            ("param6", &85_455_938.0_f32.to_le_bytes()),
            ("command", &30_001_u16.to_le_bytes()),
        ];
        let made = anonymous("COMMAND_LONG", V2, &fields).expect("a message");
        let made = |field| f64::from(f32::from_le_bytes(value(&made, field))) / 1e7;
        assert!((made("param5") - 57.397_741_8).abs() < 1e-5);
        assert!((made("param6") + 91.454_406_2).abs() < 1e-5);
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

    #[test]
    fn coordinates_among_the_first_parameters_are_shifted() {
        for (command, expected) in [(42_006_u16, [3, 14, -95]), (42_004, [3, 4, 5])] {
            let fields = [
                ("param2", &3.0_f32.to_le_bytes()[..]),
                ("param3", &4.0_f32.to_le_bytes()),
                ("param4", &5.0_f32.to_le_bytes()),
                ("command", &command.to_le_bytes()),
            ];
            for name in [
                "COMMAND_INT",
                "COMMAND_INT_STAMPED",
                "COMMAND_LONG",
                "COMMAND_LONG_STAMPED",
                "MISSION_ITEM",
                "MISSION_ITEM_INT",
            ] {
                let made = anonymous(name, V2, &fields).expect("a message");
                let made = ["param2", "param3", "param4"].map(|field| float(&made, field));
                assert_eq!(made, expected, "{name} {command}");
            }
        }
    }

    #[test]
    fn commands_have_no_coordinates_but_the_known_ones() {
        let dialect = builtin::dialect("all", V2).expect("the dialect");
        let commands = dialect.enums.iter().find(|one| one.name == "MAV_CMD").expect("commands");
        for command in &commands.entries {
            let found = coordinates_of(command);
            let expected: &[u8] = match command.name.as_str() {
                "MAV_CMD_FIXED_MAG_CAL_YAW" => &[3, 4],
                "MAV_CMD_NAV_LAND_LOCAL" | "MAV_CMD_NAV_TAKEOFF_LOCAL" => &[],
                _ if command.has_location => &[5, 6],
                _ => &[],
            };
            let numbers: Vec<u8> = found.iter().map(|(number, _)| *number).collect();
            assert_eq!(numbers, expected, "{}", command.name);
            let axes = [Axis::Latitude, Axis::Longitude];
            assert!(
                found.iter().map(|(_, axis)| axis).eq(&axes[..found.len()]),
                "{}",
                command.name
            );
        }
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
            Edit::Parameter(values, _) => values.iter().any(|one| one.name == field.name),
            Edit::Item(all, _) => all[..2].iter().any(|one| one.name == field.name),
            Edit::Command(all, _) => all.iter().any(|(_, one)| one.name == field.name),
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
                let is_parameter = field.name.starts_with("param_value")
                    || (1..=7).any(|number| field.name == format!("param{number}"));
                if is_place || is_angle || is_parameter || is_bytes && !is_known {
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
        let telling = [
            "ADSB_CALLSIGN_1",
            "ADSB_ICAO_ID",
            "ADSB_SQUAWK",
            "AHRS_ORIG_LAT",
            "BARO1_DEVID",
            "BATT_SERIAL_NUM",
            "BCN_LATITUDE",
            "BCN_LONGITUDE",
            "BRD_SERIAL_NUM",
            "CAL_ACC0_ID",
            "CAL_ACC1_ID\0old",
            "CAL_GYRO_PRIME",
            "CAL_MAG_PRIME",
            "COMPASS_DEV_ID",
            "COMPASS_DEV_ID2",
            "COMPASS_PRIO1_ID",
            "INS4_ACC_ID",
            "INS_ACC_ID",
            "LPE_LON",
            "NET2_IPADDR1",
            "NET_GWADDR3",
            "NET_IPADDR0",
            "NET_MACADDR5",
            "NET_P1_IP0",
            "NET_P1_MACADDR10",
            "SIH_LOC_LAT0",
            "SIH_LOC_LON0",
            "SIM_OPOS_LAT",
            "SIM_OPOS_LNG",
            "TC_A0_ID",
            "UXRCE_DDS_AG_IP",
            "WIFI_GATEWAYSTA",
            "WIFI_IPADDRESS",
            "WIFI_IPSTA",
            "WIFI_PASSWORD1",
            "WIFI_PWDSTA4",
            "WIFI_SSID1",
            "WIFI_SSIDSTA2",
        ];
        let others = [
            "ADSB_EMIT_TYPE",
            "CAL_MAG0_PRIO",
            "CLONE_X",
            "COMPASS_OFS_X",
            "COMPASS_PRIMARY",
            "FLTMODE1",
            "FRAME_CLASS",
            "INS_GYR_CAL",
            "LATENCY",
            "MAV_SYS_ID",
            "NET_DHCP",
            "PLATFORM",
            "PLND_LAG",
            "RC1_MIN",
            "RLL2SRV_TCONST",
            "RLL_RATE_P",
            "SERIAL1_BAUD",
            "SERIAL_PASS2",
            "SLIP_RATIO",
            "SYSID_THISMAV",
            "TELEM_DELAY",
            "TIP_ICAOS",
            "WIFI_CHANNEL",
            "WPNAV_SPEED",
        ];
        let telling = telling.into_iter().map(|name| (name, 0));
        for (name, expected) in telling.chain(others.into_iter().map(|name| (name, 5))) {
            for (message, values) in [
                ("PARAM_VALUE", &["param_value"][..]),
                ("PARAM_SET", &["param_value"]),
                ("PARAM_MAP_RC", &["param_value0", "param_value_min", "param_value_max"]),
            ] {
                let mut fields = vec![("param_id", name.as_bytes())];
                fields.extend(values.iter().map(|value| (*value, &[5, 0, 0, 0][..])));
                let made = anonymous(message, V2, &fields).expect("a message");
                for field in values {
                    assert_eq!(value(&made, field), [expected, 0, 0, 0], "{message} {name}");
                }
            }
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
