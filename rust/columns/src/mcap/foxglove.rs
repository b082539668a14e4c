//! Messages in the form that Foxglove knows: positions on its map, texts in its log.
//!
//! Foxglove documents the schemas: <https://docs.foxglove.dev/docs/visualization/message-schemas/introduction>.

use std::io::Write;

use arrow::array::{Array, Float64Array, StringArray, UInt8Array};
use arrow::compute::cast;
use arrow::datatypes::DataType;
use serde_json::{Value, json};

use crate::reader::Batch;

/// The first value of `fix_type` and `Status` with a position.
const FIX_2D: f64 = 2.0;

/// Messages with positions: latitude, longitude, altitude above the sea, and what says that there is a fix.
const POSITIONS: &[(&str, [&str; 3], Option<&str>)] = &[
    ("GLOBAL_POSITION_INT", ["lat", "lon", "alt"], None),
    ("GPS_RAW_INT", ["lat", "lon", "alt"], Some("fix_type")),
    ("GPS2_RAW", ["lat", "lon", "alt"], Some("fix_type")),
    ("GPS", ["Lat", "Lng", "Alt"], Some("Status")),
    ("GPS2", ["Lat", "Lng", "Alt"], Some("Status")),
    ("POS", ["Lat", "Lng", "Alt"], None),
];

const NO_COVARIANCE: &str =
    r#""position_covariance":[0,0,0,0,0,0,0,0,0],"position_covariance_type":0"#;

/// Level of `foxglove.Log` by severity: emergency, alert, critical, error, warning, notice, info, debug.
const LEVELS: [u8; 8] = [5, 5, 5, 4, 3, 2, 2, 1];
const INFO: u8 = 2;

/// The columns of a batch that become messages of Foxglove's own types.
pub(super) enum Extra {
    /// Degrees and metres, and whether there is a fix.
    Location { lat: Float64Array, lon: Float64Array, alt: Float64Array, fix: Option<Float64Array> },
    /// Texts.
    Log { texts: StringArray, severity: Option<UInt8Array>, senders: Option<[UInt8Array; 2]> },
}

impl Extra {
    /// Of a batch of positions or texts that has the columns for it.
    pub(super) fn of(batch: &Batch) -> Option<Self> {
        match &*batch.message {
            "STATUSTEXT" => Self::log(batch, "text"),
            "MSG" => Self::log(batch, "Message"),
            message => Self::location(batch, message),
        }
    }

    fn location(batch: &Batch, message: &str) -> Option<Self> {
        let (_, [lat, lon, alt], fix) = POSITIONS.iter().find(|(name, ..)| *name == message)?;
        let (lat, lon, alt) = (numbers(batch, lat)?, numbers(batch, lon)?, numbers(batch, alt)?);
        let fix = match fix {
            Some(name) => Some(numbers(batch, name)?),
            None => None,
        };
        Some(Self::Location { lat, lon, alt, fix })
    }

    fn log(batch: &Batch, text: &str) -> Option<Self> {
        let texts = column::<StringArray>(batch, text)?;
        let ids = |name| column::<UInt8Array>(batch, name);
        let senders = ids("sysid").zip(ids("compid")).map(|(one, other)| [one, other]);
        Some(Self::Log { texts, severity: ids("severity"), senders })
    }

    /// The last part of the topic.
    pub(super) fn topic(&self) -> &'static str {
        match self {
            Self::Location { .. } => "location",
            Self::Log { .. } => "log",
        }
    }

    /// The name of the message type in Foxglove.
    pub(super) fn name(&self) -> &'static str {
        match self {
            Self::Location { .. } => "foxglove.LocationFix",
            Self::Log { .. } => "foxglove.Log",
        }
    }

    /// The JSON schema of the messages.
    pub(super) fn schema(&self) -> Value {
        let time = json!({
            "type": "object",
            "title": "time",
            "properties": {"sec": {"type": "integer"}, "nsec": {"type": "integer"}},
        });
        let properties = match self {
            Self::Location { .. } => json!({
                "timestamp": time,
                "frame_id": {"type": "string"},
                "latitude": {"type": "number", "description": "deg"},
                "longitude": {"type": "number", "description": "deg"},
                "altitude": {"type": "number", "description": "m"},
                "position_covariance": {"type": "array", "items": {"type": "number"}},
                "position_covariance_type": {"type": "integer"},
            }),
            Self::Log { .. } => json!({
                "timestamp": time,
                "level": {"type": "integer"},
                "message": {"type": "string"},
                "name": {"type": "string"},
                "file": {"type": "string"},
                "line": {"type": "integer"},
            }),
        };
        json!({"title": self.name(), "type": "object", "properties": properties})
    }

    /// Appends a row as JSON; nothing where there is no position. `time` in microseconds.
    pub(super) fn encode(&self, row: usize, time: i64, out: &mut Vec<u8>) {
        let time = u64::try_from(time).unwrap_or(0);
        let (sec, nsec) = (time / 1_000_000, time % 1_000_000 * 1000);
        let time = format!(r#""timestamp":{{"sec":{sec},"nsec":{nsec}}}"#);
        let written = match self {
            Self::Location { lat, lon, alt, fix } => {
                let (lat, lon, alt) = (value(lat, row), value(lon, row), value(alt, row));
                let has_fix = fix.as_ref().is_none_or(|fix| value(fix, row) >= FIX_2D);
                if !has_fix || !is_place(lat, lon) {
                    return;
                }
                let alt = Value::from(alt); // null for NaN
                write!(
                    out,
                    r#"{{{time},"frame_id":"","latitude":{lat},"longitude":{lon},"altitude":{alt},{NO_COVARIANCE}}}"#
                )
            }
            Self::Log { texts, severity, senders } => {
                let text = Value::from(if texts.is_valid(row) { texts.value(row) } else { "" });
                let level = severity.as_ref().map(|all| usize::from(all.value(row)));
                let level = level.map_or(INFO, |one| LEVELS.get(one).copied().unwrap_or(0));
                let sender = senders.as_ref().map(|[one, two]| (one.value(row), two.value(row)));
                let name = sender.map_or(String::new(), |(one, two)| format!("{one}/{two}"));
                write!(
                    out,
                    r#"{{{time},"level":{level},"message":{text},"name":"{name}","file":"","line":0}}"#
                )
            }
        };
        debug_assert!(written.is_ok(), "a vector takes all");
    }
}

fn column<T: Array + Clone + 'static>(batch: &Batch, name: &str) -> Option<T> {
    batch.rows.column_by_name(name)?.as_any().downcast_ref::<T>().cloned()
}

/// A column of degrees, metres or plain numbers; null where it is none.
fn numbers(batch: &Batch, name: &str) -> Option<Float64Array> {
    let schema = batch.rows.schema();
    let over = match schema.field_with_name(name).ok()?.metadata().get("unit").map(String::as_str) {
        Some("degE7") => 1e7,
        Some("mm") => 1e3,
        _ => 1.0,
    };
    let values = cast(batch.rows.column_by_name(name)?, &DataType::Float64).ok()?;
    let values = values.as_any().downcast_ref::<Float64Array>()?;
    Some(values.unary(|value| value / over))
}

fn value(array: &Float64Array, row: usize) -> f64 {
    if array.is_valid(row) { array.value(row) } else { f64::NAN }
}

/// Whether these are degrees of a place. Senders without a position send 0, 0.
fn is_place(lat: f64, lon: f64) -> bool {
    lat.abs() <= 90.0 && lon.abs() <= 180.0 && (lat != 0.0 || lon != 0.0)
}
