"""The MAVLink checksum as pymavlink's dialect modules offer it."""

from mavwire._native import x25_accumulate


class _x25crc_fast:
    """CRC-16/MCRF4XX of bytes, a list of ints or text (as UTF-8); ``crc`` is the value so far."""

    def __init__(self, buf: object = None) -> None:
        self.crc = 0xFFFF
        if buf is not None:
            self.accumulate(buf)

    def accumulate(self, buf: object) -> None:
        """Continues the checksum over ``buf``."""
        if isinstance(buf, str):
            buf = buf.encode()
        if not isinstance(buf, bytes):
            data = bytearray()
            data.extend(buf)  # type: ignore[arg-type]
            buf = bytes(data)
        self.crc = x25_accumulate(self.crc, buf)


class _x25crc_slow(_x25crc_fast):
    """The name pymavlink gives to its variant without a C library; there is one implementation here."""


x25crc = _x25crc_fast


def mcrf4xx(data: bytes, initial: int | None = None) -> int:
    """CRC-16/MCRF4XX of ``data``, continued from ``initial``."""
    return x25_accumulate(0xFFFF if initial is None else initial, data)
