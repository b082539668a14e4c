"""CRC-16/MCRF4XX as the MAVLink wire uses it, under the generator's names.

``x25crc_fast`` and ``x25crc_slow`` are the same native checksum: scripts choose between the two by name.
"""

from __future__ import annotations

from mavwire.dialects import _x25

CRC_INIT = 0xFFFF


class x25crc_fast(_x25._x25crc_fast):
    """A running checksum; ``crc`` is the sum so far, 0 to 0xFFFF."""

    def accumulate_str(self, buf: object) -> None:
        """The same as :meth:`accumulate`."""
        self.accumulate(buf)


class x25crc_slow(x25crc_fast):
    """The same checksum."""


x25crc = x25crc_fast
