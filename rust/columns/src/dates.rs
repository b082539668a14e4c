//! Times in the words of messages for users.

use arrow::array::temporal_conversions::timestamp_us_to_datetime;
use mavwire_core::log::tlog::MAX_JUMP;

const YEAR: f64 = 365.2425 * 86_400.0;

/// Calendars end behind it.
const LAST_YEAR: f64 = 9999.0;

/// A time in seconds since 1970 as date and time in UTC. A time without a date in calendars is a year.
pub fn date_text(seconds: f64) -> String {
    let year = 1970.0 + seconds / YEAR;
    let datetime = timestamp_us_to_datetime((seconds * 1e6).round() as i64);
    match datetime.filter(|_| (0.0..LAST_YEAR).contains(&year)) {
        Some(datetime) => datetime.format("%Y-%m-%d %H:%M:%S").to_string(),
        None if year.abs() < 1e9 => format!("year {year:.0}"),
        None => format!("year {year:.3e}"),
    }
}

/// Says that times jump from one second to another, unless these may be those of one flight.
pub fn jump_text(before: f64, after: f64) -> Option<String> {
    (after - before >= MAX_JUMP as f64 * 1e-6).then(|| {
        format!(
            "times jump from {} to {} (`mavwire repair` replaces damaged times of telemetry logs)",
            date_text(before),
            date_text(after),
        )
    })
}
