"""Lists whose length is a lie or has no end, wherever the native side takes one: an ordinary exception, and no process
that ends for want of memory.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from encoder import record
from mavwire import _native, bridge, mavutil
from mavwire.bridge import options
from mavwire.dialects.v20 import common as mavlink
from mavwire.logs.selection import Selection
from unit.link_tools import T0, heartbeat
from watchdog import watched

ERRORS = (TypeError, ValueError, OverflowError, MemoryError)
HUGE = range(10**12)


class Liar(list[Any]):
    """Says that it has more items than any memory has room for."""

    def __len__(self) -> int:
        return 1 << 60


class Modest(list[Any]):
    """Says that it has few items, and never ends."""

    def __init__(self, item: object) -> None:
        super().__init__([item])

    def __iter__(self) -> Iterator[Any]:
        return itertools.repeat(self[0])


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path: Path = tmp_path_factory.mktemp("lists") / "flight.tlog"
    path.write_bytes(b"".join(record(heartbeat(seq=n), T0 + n) for n in range(9)))
    return path


@pytest.fixture(scope="module")
def dialect() -> Any:
    return mavlink.MAVLink(None)._dialect


@pytest.fixture(scope="module")
def table(log: Path, dialect: Any) -> Any:
    ((_, table),) = itertools.chain(*_native.LogColumns(log, dialect, Selection()))
    return table


@pytest.fixture
def core(dialect: Any) -> Iterator[Any]:
    with bridge.Bridge() as running:
        yield running._core


def refuses(take: Callable[[Any], object], item: object) -> None:
    """Each list of such items is refused."""
    for hostile in (HUGE, Liar([item]), Modest(item)):
        with watched(), pytest.raises(ERRORS):
            take(hostile)


def test_bytes_of_a_parser() -> None:
    mav = mavlink.MAVLink(None)

    def buf(value: Any) -> None:
        mav.buf = value

    refuses(buf, 0)
    buf(list(heartbeat()))
    assert bytes(mav.buf) == heartbeat()
    with pytest.raises(TypeError):
        buf("text")


def test_frames_messages_and_systems_of_a_bridge(core: Any) -> None:
    refuses(core.write, 0)
    refuses(lambda ids: core.tap(ids, None), 1)
    refuses(lambda ids: core.tap(None, ids), 1)
    core.write(bytearray(heartbeat()))
    core.tap({0, 30}, (1,))


@pytest.mark.parametrize(
    ("part", "name", "item"),
    [
        ("border", "key", 1),
        ("border", "unsigned", 1),
        (None, "message_rates", (1, 1.0)),
        (None, "urgent", 1),
        (None, "inbound", (True, "messages", [1])),
        (None, "outbound", (False, "systems", [1])),
    ],
)
def test_options_of_a_link(core: Any, part: str | None, name: str, item: object) -> None:
    link = options.EndpointOptions("a", options.Endpoint("udpin", "127.0.0.1"))

    def add(value: Any) -> None:
        if part is None:
            core.add(replace(link, **{name: value}))
        else:
            core.add(replace(link, **{part: replace(getattr(link, part), **{name: value})}))

    refuses(add, item)


def test_lists_of_a_filter(core: Any) -> None:
    link = options.EndpointOptions("a", options.Endpoint("udpin", "127.0.0.1"))
    refuses(lambda ids: core.add(replace(link, inbound=[(True, "messages", ids)])), 1)


def test_options_as_programs_give_them() -> None:
    for name, item in (("block_systems_out", 1), ("allow_messages_in", "ATTITUDE")):
        for endless in (Modest(item), itertools.repeat(item)):
            with pytest.raises(bridge.ConfigError, match=f"{name} has more than 65,536 items"):
                bridge.Bridge().add("udpin:127.0.0.1:0", **{name: endless})
    with bridge.Bridge() as running:
        with pytest.raises(bridge.ConfigError, match="types has more than"):
            running.frames(types=itertools.repeat("ATTITUDE"))
        with pytest.raises(bridge.ConfigError, match="has no message"):
            running.frames(types=["9" * 5_000])


@pytest.mark.parametrize("name", ["types", "unknown", "systems"])
def test_what_a_run_over_a_log_looks_for(log: Path, dialect: Any, name: str) -> None:
    def scan(value: Any) -> None:
        wanted = Selection()
        setattr(wanted, name, value)
        _native.LogScan(log, dialect, False, wanted)

    refuses(scan, 1)


@pytest.mark.parametrize(
    ("name", "item"), [("types", 0), ("names", "ATT"), ("systems", 1), ("columns", "type")]
)
def test_what_tables_are_made_of(log: Path, dialect: Any, name: str, item: object) -> None:
    def read(value: Any) -> None:
        query = Selection()
        object.__setattr__(query, name, value)
        list(_native.LogColumns(log, dialect, query))

    refuses(read, item)


def test_tables_and_names_of_columns(table: Any) -> None:
    refuses(_native.RecordBatches.joined, table)
    refuses(table.select, "type")
    refuses(lambda tables: _native.align_tables(tables, table, None, "ffill", None), ("a", table))
    assert table.select(["type"]).names == ["type"]


def test_logs_to_merge(log: Path, dialect: Any, tmp_path: Path) -> None:
    # A path that is not there: what is opened meanwhile would be a million files.
    refuses(lambda paths: _native.LogRewrite(paths, dialect, tmp_path / "out"), "/no/log")


def test_shapes_and_values_of_dataflash_records() -> None:
    refuses(lambda columns: _native.DataflashShape(1, "ATT", "f", columns), "Roll")
    shape = _native.DataflashShape(1, "ATT", "f", ["Roll"])
    fmt = type("Format", (), {"_shape": shape})()
    for endless in (HUGE, itertools.repeat(1.0)):
        with watched(), pytest.raises(ERRORS):
            _native.DFMessage(fmt, endless, False, None)


def test_types_of_an_indexed_log(log: Path) -> None:
    with mavutil.mavlink_connection(str(log)) as link:
        for endless in (Modest("ATTITUDE"), itertools.repeat("ATTITUDE")):
            with watched(), pytest.raises(ERRORS):
                link.recv_match(type=endless)
        assert link.recv_match(type={"HEARTBEAT"}) is not None


def test_bytes_to_sign() -> None:
    mav = mavlink.MAVLink(None)
    mav.signing.secret_key = bytes(32)
    msg = mav.heartbeat_encode(6, 8, 0, 0, 0)
    msg.pack(mav)

    def sign(value: Any) -> None:
        msg._msgbuf = value
        msg.sign_packet(mav)

    refuses(sign, 0)
