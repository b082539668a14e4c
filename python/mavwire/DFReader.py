"""Readers of ArduPilot's dataflash logs, with the names and behaviour of pymavlink's DFReader.

The work is in `mavwire._dataflash`, on a native reader; this module is the face of it.
"""

import sys

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
from ._hooks import IN_STANDARD_MODULE, ReplaceableModule, make_replaceable
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

_CONVERT_TEXTS = "texts are decoded natively: convert the values of the messages that you read"


class _DFReader(ReplaceableModule):
    _users = ("mavwire._dataflash",)
    _not_called = {  # noqa: RUF012
        **dict.fromkeys("array math mmap os platform struct time".split(), IN_STANDARD_MODULE),
        "DFMessage": "messages are native: derive from the reader, and change the result of recv_msg",
        "DFReader_is_text_log": "mavlink_connection recognises logs natively: make a DFReader_text yourself",
        "FORMAT_TO_STRUCT": "formats are decoded natively",
        "dfindexer": "the reader has an index of its own",
        "mavutil": "replace the function in mavwire.mavutil itself",
        "null_term": _CONVERT_TEXTS,
        "to_string": _CONVERT_TEXTS,
    }


make_replaceable(sys.modules[__name__], _DFReader)

# An alias of Python 2 that pymavlink's module still has.
long = int
