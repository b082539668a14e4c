"""CRC-16/MCRF4XX as the MAVLink wire uses it, under the generator's names.

The sum is computed by the native core. ``x25crc_fast`` and ``x25crc_slow`` name the same class:
scripts choose between the two by name, and here there is only the fast one.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeAlias

from mavwire._native import x25_accumulate

CRC_INIT = 0xFFFF

Bytes: TypeAlias = bytes | bytearray | memoryview | str | Iterable[int]


class x25crc_fast:
    """A running checksum; ``crc`` is the sum so far, 0 to 0xFFFF."""

    def __init__(self, buf: Bytes | None = None) -> None:
        self.crc: int = CRC_INIT
        if buf is not None:
            self.accumulate(buf)

    def accumulate(self, buf: Bytes) -> None:
        """Add bytes; text is encoded as UTF-8. Raises TypeError or ValueError for anything that is
        not bytes.
        """
        if isinstance(buf, str):
            buf = buf.encode("utf-8")
        elif isinstance(buf, (bytearray, memoryview, list)):
            buf = bytes(buf)
        self.crc = x25_accumulate(self.crc, buf)  # type: ignore[arg-type]

    def accumulate_str(self, buf: Bytes) -> None:
        """The same as :meth:`accumulate`."""
        self.accumulate(buf)


class x25crc_slow(x25crc_fast):
    """The same checksum; accepts any iterable of byte values."""

    def accumulate(self, buf: Bytes) -> None:
        """Add bytes, text or an iterable of integers 0 to 255."""
        if not isinstance(buf, (str, bytes, bytearray, memoryview)):
            buf = bytes(iter(buf))
        super().accumulate(buf)


x25crc = x25crc_fast
