//! The plan of changes to the messages of each type, made from the names and units of their fields.

use mavwire_schema::{EnumEntry, Field, FieldType, Message};

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

/// Fields that are emptied in one message: elsewhere they tell what a value means.
const IDENTIFIERS_OF: &[(&str, &str)] =
    &[("AIS_VESSEL", "name"), ("COLLISION", "id"), ("VIDEO_STREAM_INFORMATION", "name")];

/// A coordinate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Axis {
    Latitude,
    Longitude,
}

/// One change to the fields of a message.
#[derive(Debug, Clone)]
pub(super) enum Edit {
    /// A coordinate, with its axis and its units per degree.
    Move(Field, Axis, f64),
    /// An identifier, which is emptied.
    Empty(Field),
    /// A text, in which words like identifiers are masked. It is a part of a longer text if the other field is not 0.
    Mask(Field, Option<Field>),
    /// Values of a parameter (first), emptied if its name (second) is that of an identifier or a position.
    Parameter(Vec<Field>, Field),
    /// x and y of a mission item or command, if its coordinate frame (last) is global; their units per degree.
    Item(Box<[Field; 3]>, f64),
    /// The parameters of a command (last) with their numbers. Those that are coordinates are shifted.
    Command(Vec<(u8, Field)>, Field),
}

/// The treatment of all messages of a type: they are left out or edited.
#[derive(Debug, Clone)]
pub(super) enum Plan {
    LeaveOut,
    Edit(Vec<Edit>),
}

/// The parameters of a command that are coordinates: those with such a label, and the 5th and 6th of a command with a
/// location, which not all definitions label. Parameters in metres do not count.
pub(super) fn coordinates_of(command: &EnumEntry) -> Vec<(u8, Axis)> {
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

pub(super) fn plan(message: &Message) -> Plan {
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
        "STATUSTEXT" | "STATUSTEXT_LONG" => field("text").map(|text| Edit::Mask(text, field("id"))),
        "NAMED_VALUE_STRING" => field("value").map(|value| Edit::Mask(value, None)),
        _ => in_frame
            .filter(|fields| fields[0].field_type == FieldType::I32)
            .map(|fields| Edit::Item(fields, 1e7)),
    };
    let mut edits: Vec<Edit> = message.fields.iter().filter_map(edit_of).collect();
    edits.extend(special);
    let of_message = IDENTIFIERS_OF.iter().filter(|(message, _)| *message == name);
    edits.extend(of_message.filter_map(|(_, one)| field(one).map(Edit::Empty)));
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

/// The treatment of a field in any message.
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
pub(super) fn axis_of(name: &str) -> Option<Axis> {
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
