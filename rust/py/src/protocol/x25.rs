//! The checksum, for the `x25crc` classes.

use mavwire_core::x25;
use pyo3::prelude::*;

/// Continues a CRC-16/MCRF4XX from `crc` over `data`.
#[pyfunction]
pub(crate) fn x25_accumulate(crc: u16, data: &[u8]) -> u16 {
    x25::accumulate(crc, data)
}
