//! Positions, identifiers and what else tells who flew where.

use super::plan::axis_of;
use super::*;
use crate::builtin;
use crate::frame::FrameRef;
use crate::registry::Registry;
use crate::testing::header;
use mavwire_schema::Message;
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
        let fields = [("param5", &5.0_f32.to_le_bytes()[..]), ("command", &command.to_le_bytes())];
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
        assert!(found.iter().map(|(_, axis)| axis).eq(&axes[..found.len()]), "{}", command.name);
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

/// Whether the plan of a message changes this field, or leaves the message out.
fn is_changed(message: &Message, field: &Field) -> bool {
    let Plan::Edit(edits) = plan(message) else { return true };
    edits.iter().any(|edit| match edit {
        Edit::Move(one, ..) | Edit::Empty(one) | Edit::Mask(one, _) => one.name == field.name,
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
    let made = anonymous("COLLISION", V2, &[("id", &[0xEF, 0xCD, 0xAB, 0])]).expect("a message");
    assert_eq!(value::<4>(&made, "id"), [0; 4]);
}

#[test]
fn long_numbers_in_texts_are_masked() {
    let text = b"Cube 0032001F 34375108 ok";
    let made = anonymous("STATUSTEXT", V2, &[("text", text)]).expect("a message");
    assert_eq!(&value::<25>(&made, "text"), b"Cube xxxxxxxx xxxxxxxx ok");
    let part = b"Cafe 0032001F 34375108: 50 bytes of a text .. 0032";
    for (id, first, last) in [(0, b"Cafe", b"0032"), (1, b"xxxx", b"xxxx")] {
        let made = anonymous("STATUSTEXT", V2, &[("text", part), ("id", &[id, 0])]);
        let made: [u8; 50] = value(&made.expect("a message"), "text");
        assert_eq!((&made[..4], &made[46..]), (&first[..], &last[..]));
        assert_eq!(&made[5..22], b"xxxxxxxx xxxxxxxx");
    }
}

#[test]
fn telling_parameters_are_emptied() {
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
    for name in ["SETUP_SIGNING", "FILE_TRANSFER_PROTOCOL", "OPEN_DRONE_ID_BASIC_ID", "TUNNEL"] {
        assert!(anonymous(name, V2, &[]).is_none(), "{name}");
    }
}
