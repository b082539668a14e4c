"""Any bytes as a log: what reads tables, messages and files of it agrees, and says what it is not."""

from __future__ import annotations

import gzip
import os
import tempfile
from contextlib import suppress
from pathlib import Path

import mavwire
from dataflash_writer import sample
from hypothesis import given
from hypothesis import strategies as st
from mavwire import traffic
from mavwire.logs import LogFormatError
from mavwire.logs.conversion import convert
from property.hostile import PROFILE
from watchdog import watched


def _pieces() -> tuple[bytes, bytes, bytes]:
    with tempfile.TemporaryDirectory() as folder:
        telemetry = Path(folder) / "x.tlog"
        traffic.generate(telemetry, 60)
        onboard = Path(sample().write(Path(folder) / "x.BIN"))
        raw = b"".join(msg.get_msgbuf() for msg in mavwire.open_log(telemetry))
        return telemetry.read_bytes(), onboard.read_bytes(), bytes(raw)


TELEMETRY, ONBOARD, RAW = _pieces()
TEXT = (
    b"FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n"
    b"FMT, 200, 19, ABC, QB, TimeUS,Count\nABC, 1000, 1\nABC, 2000, 2\n"
)
HEADS = [b"", b"\xa3\x95\x80", b"\x1f\x8b\x08", b"\x28\xb5\x2f\xfd", b"FMT,", b"\xfd", b"\xfe", b"PK\x03\x04"]  # fmt: skip

whole = st.sampled_from([TELEMETRY, ONBOARD, RAW, TEXT])
cut = st.builds(lambda log, a, b: log[a:b], whole, st.integers(0, 400), st.integers(0, 3000))
piece = st.one_of(whole, cut, st.binary(max_size=60), st.sampled_from(HEADS))
logs = st.builds(
    lambda head, parts, packed: gzip.compress(head + b"".join(parts), 1) if packed else head + b"".join(parts),
    st.sampled_from(HEADS), st.lists(piece, max_size=4), st.booleans(),
)  # fmt: skip


@PROFILE
@given(content=logs)
def test_any_bytes_as_tables(content: bytes) -> None:
    with tempfile.TemporaryDirectory() as folder, watched():
        log = os.path.join(folder, "log")
        Path(log).write_bytes(content)
        try:
            tables = mavwire.read(log)
            rows = {name: len(table) for name, table in tables.items() if len(table)}
        except LogFormatError:
            rows = None
        batches: dict[str, int] = {}
        try:
            for table in mavwire.scan(log):
                batches[table.name] = batches.get(table.name, 0) + len(table)
            assert batches == rows
        except LogFormatError:
            assert rows is None and batches == {}
        with suppress(LogFormatError):  # it believes the first bytes of an archive
            mavwire.open_log(log)
        (row,) = convert([log], os.path.join(folder, "out"), format="jsonl")
        assert row.rows == sum((rows or {}).values())
        assert rows is not None or row.error is not None
