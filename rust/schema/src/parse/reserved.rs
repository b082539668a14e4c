//! Names that a field or an enum entry cannot have, because both become names in Python code.

use crate::error::Reason;

const KEYWORDS: [&str; 35] = [
    "False", "None", "True", "and", "as", "assert", "async", "await", "break", "class", "continue",
    "def", "del", "elif", "else", "except", "finally", "for", "from", "global", "if", "import",
    "in", "is", "lambda", "nonlocal", "not", "or", "pass", "raise", "return", "try", "while",
    "with", "yield",
];
/// Parameters that the functions made for a message have already.
const PARAMETERS: [&str; 2] = ["self", "force_mavlink1"];
/// Methods of message objects.
const METHODS: [&str; 17] = [
    "format_attr",
    "get_crc",
    "get_fieldnames",
    "get_header",
    "get_link_id",
    "get_msgId",
    "get_msgbuf",
    "get_payload",
    "get_seq",
    "get_signed",
    "get_srcComponent",
    "get_srcSystem",
    "get_type",
    "pack",
    "sign_packet",
    "to_dict",
    "to_json",
];
/// Names in every dialect module, besides those of entries and those with one of the `MODULE_PREFIXES`.
const MODULE_NAMES: [&str; 20] = [
    "DIALECT",
    "Enum",
    "EnumEntry",
    "HEADER_LEN_V1",
    "HEADER_LEN_V2",
    "MAVError",
    "MAVLINK_IFLAG_SIGNED",
    "MAVLINK_IGNORE_CRC",
    "MAVLINK_SIGNATURE_BLOCK_LEN",
    "PROTOCOL_MARKER_V1",
    "PROTOCOL_MARKER_V2",
    "WIRE_PROTOCOL_VERSION",
    "_x25crc_fast",
    "_x25crc_slow",
    "enums",
    "logger",
    "mavlink_map",
    "mavlink_msg_deprecated_name_property",
    "mcrf4xx",
    "x25crc",
];
const MODULE_PREFIXES: [&str; 4] = ["__", "MAVLink", "MAVLINK_MSG_ID_", "MAVLINK_TYPE_"];

/// Whether a field may have this name.
pub(super) fn check_field(name: &str) -> Result<(), Reason> {
    let why = if KEYWORDS.contains(&name) || PARAMETERS.contains(&name) {
        "a reserved word"
    } else if METHODS.contains(&name) {
        "a method of messages"
    } else if name.starts_with('_') {
        "no name for a field: the underscore in front marks what messages keep for themselves"
    } else {
        return Ok(());
    };
    Err(Reason::ReservedName { name: name.to_owned(), why })
}

/// Whether an enum entry may have this name.
pub(super) fn check_entry(name: &str) -> Result<(), Reason> {
    let why = if KEYWORDS.contains(&name) {
        "a reserved word"
    } else if MODULE_NAMES.contains(&name)
        || MODULE_PREFIXES.iter().any(|prefix| name.starts_with(prefix))
    {
        "a name that dialect modules have for something else"
    } else {
        return Ok(());
    };
    Err(Reason::ReservedName { name: name.to_owned(), why })
}
