//! Times in the words of messages for users.

use mavwire_columns::dates;
use pyo3::prelude::*;

/// A time in seconds since 1970 as date and time in UTC. A time without a date in calendars is a year.
#[pyfunction]
pub(crate) fn date_text(seconds: f64) -> String {
    dates::date_text(seconds)
}

/// Says that times jump from one second to another, unless these may be those of one flight.
#[pyfunction]
pub(crate) fn jump_text(before: f64, after: f64) -> Option<String> {
    dates::jump_text(before, after)
}
