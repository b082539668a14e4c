"""Logs for the tests of tables, and how a table is compared with message objects."""

from __future__ import annotations

import math
from pathlib import Path
from random import Random
from typing import Any

import mavwire
from mavwire.dialects.v20 import all as mavlink

HEADER = ("timestamp", "sysid", "compid", "seq")


def log_of_every_type(path: Path, each: int = 3, seed: int = 1) -> None:
    """A log with `each` messages of every type of the dialect, all bytes of the payload random."""
    random = Random(seed)
    out = bytearray()
    stamp = 1_600_000_000_000_000
    for _ in range(each):
        for msgid, cls in mavlink.mavlink_map.items():
            stamp += random.randrange(100_000)
            length = random.choice([cls._info.max_len, random.randrange(1, cls._info.max_len + 1)])
            payload = random.randbytes(length)
            body = bytes([length, 0, 0, random.randrange(256), 1, random.randrange(3)])
            body += msgid.to_bytes(3, "little") + payload
            checksum = mavlink.x25crc(body + bytes([cls._info.crc_extra])).crc
            out += stamp.to_bytes(8, "big") + b"\xfd" + body + checksum.to_bytes(2, "little")
    path.write_bytes(out)


def column_name(field: str) -> str:
    """The column of a field."""
    return f"{field}_" if field in HEADER else field


def same(column: Any, value: Any) -> bool:
    """Whether a value of a table is that of a message."""
    if isinstance(value, float):
        return column == value or (math.isnan(column) and math.isnan(value))
    if isinstance(value, list):
        return len(column) == len(value) and all(map(same, column.tolist(), value))
    if isinstance(value, str):
        # The message shows each byte that is not ASCII as U+FFFD, the table UTF-8 as text.
        return column == value or not value.isascii()
    return bool(column == value)


def raw_of(text: str, raw: bytes | None) -> bytes:
    """The bytes of a text field, trailing NULs removed."""
    return text.encode() if raw is None else raw


def compare_with_messages(path: Path | str, tables: dict[str, Any] | None = None) -> int:
    """Assert that tables hold what the messages say; how many messages that were."""
    tables = mavwire.read(path) if tables is None else tables
    arrays = {name: table.to_numpy() for name, table in tables.items()}
    rows = dict.fromkeys(arrays, 0)
    for msg in mavwire.open_log(path):
        kind = msg.get_type()
        if kind.startswith("UNKNOWN"):
            continue
        columns, row = arrays[kind], rows[kind]
        rows[kind] += 1
        header = (msg.get_srcSystem(), msg.get_srcComponent(), msg.get_seq())
        assert tuple(columns[name][row] for name in HEADER[1:]) == header
        assert columns["timestamp"][row].astype("int64") * 1e-6 == msg._timestamp
        for field in msg.get_fieldnames():
            name = column_name(field)
            value = getattr(msg, field)
            assert same(columns[name][row], value), (kind, field, columns[name][row], value)
            if isinstance(value, str):
                raw = columns.get(f"{name}_raw")
                found = raw_of(columns[name][row], None if raw is None else raw[row])
                assert found == getattr(msg, f"_{field}_raw", found), (kind, field)
    assert rows == {name: len(table) for name, table in tables.items()}
    return sum(rows.values())
