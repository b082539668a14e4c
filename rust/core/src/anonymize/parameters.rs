//! Which parameters tell who or where a vehicle is.

use super::plan::axis_of;

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

/// Whether a parameter of this name tells who or where a vehicle is. Words are compared without the numbers behind them:
/// parts of words would be found in names of anything.
pub(super) fn tells(name: &[u8]) -> bool {
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
