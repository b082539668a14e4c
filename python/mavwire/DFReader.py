"""Readers of ArduPilot's dataflash logs, with the names and behaviour of pymavlink's DFReader.

The work is in `mavwire._dataflash`, on a native reader; this module is the face of it.
"""

from __future__ import annotations

from ._dataflash.binary import DFReader_binary
from ._dataflash.clocks import (
    DFReaderClock,
    DFReaderClock_gps_interpolated,
    DFReaderClock_msec,
    DFReaderClock_px4,
    DFReaderClock_usec,
)
from ._dataflash.formats import (
    FORMAT_TO_STRUCT,
    MULT_TO_PREFIX,
    DFFormat,
    is_quiet_nan,
    null_term,
    to_string,
)
from ._dataflash.metadata import DFMetaData
from ._dataflash.reader import DFReader
from ._dataflash.text import DFReader_is_text_log, DFReader_text
from ._native import DFMessage

__all__ = [
    "FORMAT_TO_STRUCT",
    "MULT_TO_PREFIX",
    "DFFormat",
    "DFMessage",
    "DFMetaData",
    "DFReader",
    "DFReaderClock",
    "DFReaderClock_gps_interpolated",
    "DFReaderClock_msec",
    "DFReaderClock_px4",
    "DFReaderClock_usec",
    "DFReader_binary",
    "DFReader_is_text_log",
    "DFReader_text",
    "is_quiet_nan",
    "null_term",
    "to_string",
]

# An alias of Python 2 that pymavlink's module still has.
long = int
