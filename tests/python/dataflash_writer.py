"""Writes dataflash logs for tests, from the format's description alone and without mavwire."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

CODES = {
    "a": "64s", "b": "b", "B": "B", "g": "e", "h": "h", "H": "H", "i": "i", "I": "I", "f": "f",
    "n": "4s", "N": "16s", "Z": "64s", "c": "h", "C": "H", "e": "i", "E": "I", "L": "i",
    "d": "d", "M": "b", "q": "q", "Q": "Q",
}  # fmt: skip
HEAD = b"\xa3\x95"
FMT_TYPE = 128


def struct_of(format: str) -> str:
    """The struct format of a record's body."""
    return "<" + "".join(CODES[character] for character in format)


def encoded(value: Any) -> Any:
    """Texts as bytes."""
    return value.encode() if isinstance(value, str) else value


def record(type_id: int, format: str, *values: Any) -> bytes:
    """A record from stored values."""
    body = struct.pack(struct_of(format), *map(encoded, values))
    return HEAD + bytes([type_id]) + body


def fmt(
    type_id: int, name: str | bytes, format: str, columns: str | bytes, length: int | None = None
) -> bytes:
    """A FMT record; the length is the right one unless it is given."""
    if length is None:
        length = struct.calcsize(struct_of(format)) + 3
    texts = (encoded(name), encoded(format), encoded(columns))
    return HEAD + bytes([FMT_TYPE]) + struct.pack("<BB4s16s64s", type_id, length, *texts)


FMT = fmt(FMT_TYPE, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns")


class Log:
    """A log in the making."""

    def __init__(self) -> None:
        self.data = bytearray(FMT)
        self.types: dict[str, tuple[int, str]] = {}

    def define(self, name: str, format: str, columns: str, type_id: int | None = None) -> Log:
        """Add a record type."""
        type_id = len(self.types) + 1 if type_id is None else type_id
        self.types[name] = (type_id, format)
        self.data += fmt(type_id, name, format, columns)
        return self

    def add(self, name: str, *values: Any) -> Log:
        """Add a record of a type that was defined."""
        type_id, format = self.types[name]
        self.data += record(type_id, format, *values)
        return self

    def raw(self, data: bytes) -> Log:
        """Add any bytes."""
        self.data += data
        return self

    def write(self, path: Path | str) -> str:
        """Write the log and return its path."""
        Path(path).write_bytes(self.data)
        return str(path)


def sample() -> Log:
    """A short flight: units, parameters, modes, two IMUs and one GPS fix. 1383 bytes."""
    log = Log()
    log.define("UNIT", "QbZ", "TimeUS,Id,Label", 150)
    log.define("MULT", "Qbd", "TimeUS,Id,Mult", 151)
    log.define("FMTU", "QBNN", "TimeUS,FmtType,UnitIds,MultIds", 152)
    log.define("GPS", "QBBIHL", "TimeUS,I,Status,GMS,GWk,Lat", 160)
    log.define("PARM", "QNff", "TimeUS,Name,Value,Default", 161)
    log.define("IMU", "QBfh", "TimeUS,I,AccX,Raw", 162)
    log.define("MODE", "QMBB", "TimeUS,Mode,ModeNum,Rsn", 163)
    log.define("MSG", "QZ", "TimeUS,Message", 164)
    for unit_id, label in ("s", "s"), ("#", "instance"), ("o", "m/s/s"):
        log.add("UNIT", 1, ord(unit_id), label)
    for mult_id, factor in ("F", 1e-6), ("-", 0.0), ("G", 60.0):
        log.add("MULT", 1, ord(mult_id), factor)
    log.add("FMTU", 2, 162, "s#oo", "F--G").add("MSG", 1000, "ArduCopter V4.5")
    log.add("PARM", 2000, "RC1_MIN", 1100, 1000)
    log.add("PARM", 2001, "RC1_MAX", 1900, float("nan"))
    log.add("MODE", 3000, 5, 5, 1)
    log.add("IMU", 4000, 0, 1.5, 7).add("IMU", 4001, 1, 2.5, -7)
    log.add("GPS", 5_000_000, 0, 3, 100_000, 2200, -353_632_620)
    log.add("IMU", 6_000_000, 0, float("nan"), 1).add("MODE", 7_000_000, 4, 4, 1)
    return log


def flight(seconds: int = 20) -> Log:
    """A flight with the record types that the documentation speaks of, at 10 Hz, in two modes."""
    log = sample().define("ATT", "Qff", "TimeUS,Roll,Pitch", 165)
    log.define("ACC", "QBfff", "TimeUS,I,AccX,AccY,AccZ", 166)
    log.data[:] = log.data.replace(b"IMU\0", b"OLD\0").replace(b"ACC\0", b"IMU\0")
    log.add("FMTU", 3, 166, "s#ooo", "F----").add("PARM", 2002, "ATC_RAT_RLL_P", 0.135, 0.135)
    for tick in range(seconds * 10):
        time = 8_000_000 + tick * 100_000
        log.add("ATT", time, tick % 30, -tick % 20)
        log.add("ACC", time + 1, 0, 0.1, 0.2, -9.8).add("ACC", time + 2, 1, 0.1, 0.2, -9.7)
        log.add("GPS", time + 3, 0, 3, 103_000 + tick * 100, 2200, -353_632_620 + tick)
    return log
