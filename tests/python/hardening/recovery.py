"""How much of a damaged log is found: of the records that lost no byte, the percentage that a reader gives."""

from __future__ import annotations

import importlib
import tempfile
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Any

from dataflash_writer import Log
from dataflash_writer import record as dataflash_record
from encoder import attitude, frame, record

from hardening.tools import T0, mavutil_of, silence

BLOCK = 512
Name = tuple[str, int]
"""What a record is known by: its type, and a number that no other has."""


@dataclass(frozen=True)
class Damaged:
    """A log, and the names of the records in it that lost no byte."""

    data: bytes
    intact: frozenset[Name]


@dataclass(frozen=True)
class Source:
    """A log in its pieces: what is never damaged, and records with their names."""

    head: bytes
    records: list[tuple[Name, bytes]]

    def damaged(self, gone: Iterable[range], change: Callable[[bytearray, range], None]) -> Damaged:
        """`change` is applied to ranges of the bytes behind the head, from the last to the first."""
        ranges = sorted(gone, key=lambda one: one.start)
        intact, at, waiting = set(), 0, list(reversed(ranges))
        for name, one in self.records:
            while waiting and waiting[-1].stop <= at:
                waiting.pop()
            if not waiting or waiting[-1].start >= at + len(one):
                intact.add(name)
            at += len(one)
        data = bytearray(b"".join(one for _, one in self.records))
        for where in reversed(ranges):
            change(data, where)
        return Damaged(self.head + bytes(data), frozenset(intact))

    def size(self) -> int:
        return sum(len(one) for _, one in self.records)


def telemetry(count: int, first: int = 0) -> Source:
    """Records of 36 to 74 bytes, 100 a second."""
    records = []
    for n in range(first, first + count):
        name = ("STATUSTEXT", n) if n % 5 == 0 else ("ATTITUDE", n)
        text = bytes([6]) + f"{n} says something".encode().ljust(50, b"\0")
        one = (
            frame(253, text, n % 256)
            if n % 5 == 0
            else frame(30, attitude(n, 0.1, -0.2, 3, 0, 0, 1), n % 256)
        )
        records.append((name, record(one, T0 + 10_000 * n)))
    return Source(b"", records)


def dataflash(count: int, first: int = 0) -> Source:
    """Records of 17 to 75 bytes behind their descriptions, 100 a second."""
    head = (
        Log()
        .define("ATT", "QccC", "TimeUS,Roll,Pitch,Yaw", 5)
        .define("MSG", "QZ", "TimeUS,Message", 8)
    )
    records = []
    for n in range(first, first + count):
        time = 1_000_000 + 10_000 * n
        name = ("MSG", time) if n % 5 == 0 else ("ATT", time)
        one = (
            dataflash_record(8, "QZ", time, "a text of some length")
            if n % 5 == 0
            else dataflash_record(5, "QccC", time, n % 9000, -(n % 9000), n % 36000)
        )
        records.append((name, one))
    return Source(bytes(head.data), records)


def blocks(size: int, share: float, seed: int) -> list[range]:
    """So many of the blocks of a disk."""
    rand = Random(seed)
    return [
        range(start, min(start + BLOCK, size))
        for start in range(0, size, BLOCK)
        if rand.random() < share
    ]


def flip(data: bytearray, where: range) -> None:
    data[where.start] ^= 1 << where.start % 8


def zero(data: bytearray, where: range) -> None:
    data[where.start : where.stop] = bytes(len(where))


def remove(data: bytearray, where: range) -> None:
    del data[where.start : where.stop]


def bits_flipped(source: Source, bytes_each: int = 1000) -> Damaged:
    rand = Random(1)
    where = rand.sample(range(source.size()), source.size() // bytes_each)
    return source.damaged((range(at, at + 1) for at in where), flip)


def blocks_lost(source: Source) -> Damaged:
    return source.damaged(blocks(source.size(), 0.05, 2), remove)


def blocks_zeroed(source: Source) -> Damaged:
    return source.damaged(blocks(source.size(), 0.05, 3), zero)


def cut_at_both_ends(source: Source) -> Damaged:
    size = source.size()
    return source.damaged([range(1000), range(size - 1001, size)], remove)


def joined(source: Source, other: Source) -> Damaged:
    """A log that ends in the middle of a record, and another one behind it that begins so."""
    size = source.size()
    one = source.damaged([range(size - 1013, size)], remove)
    two = other.damaged([range(997)] if not other.head else [], remove)
    return Damaged(one.data + two.data, one.intact | two.intact)


DAMAGE: dict[str, Callable[[Source], Damaged]] = {
    "a bit flipped in 1,000 bytes": bits_flipped,
    "a bit flipped in 50 bytes": lambda source: bits_flipped(source, 50),
    "5% of 512-byte blocks lost": blocks_lost,
    "5% of 512-byte blocks zeros": blocks_zeroed,
    "both ends cut": cut_at_both_ends,
}


def name_of(msg: Any) -> Name | None:
    """What a message was made with."""
    kind = msg.get_type()
    if kind == "ATTITUDE":
        return kind, msg.time_boot_ms
    if kind == "STATUSTEXT":
        number = str(msg.text).partition(" ")[0]
        return (kind, int(number)) if number.isdecimal() else None
    return (kind, msg.TimeUS) if kind in ("ATT", "MSG") else None


def by_mavutil(package: str, **options: Any) -> Callable[[str], set[Name | None]]:
    """All that `mavlink_connection` gives until it ends, or raises."""

    def read(path: str) -> set[Name | None]:
        found: set[Name | None] = set()
        try:
            log = mavutil_of(package).mavlink_connection(path, **options)
            while (msg := log.recv_msg()) is not None:
                found.add(name_of(msg))
        except Exception:
            return found
        return found

    return read


def by_open_log(path: str) -> set[Name | None]:
    return {name_of(msg) for msg in importlib.import_module("mavwire").open_log(path)}


def by_tables(path: str) -> set[Name | None]:
    found: set[Name | None] = set()
    tables = importlib.import_module("mavwire").read(path)
    columns = {"ATTITUDE": "time_boot_ms", "ATT": "TimeUS", "MSG": "TimeUS"}
    for kind in columns.keys() & tables.keys():
        found |= {(kind, int(value)) for value in tables[kind][columns[kind]]}
    if "STATUSTEXT" in tables:
        texts = (str(one).partition(" ")[0] for one in tables["STATUSTEXT"]["text"])
        found |= {("STATUSTEXT", int(one)) for one in texts if one.isdecimal()}
    return found


def percent(found: set[Name | None], damaged: Damaged) -> float:
    """Never 100 where one is missing."""
    share = 100 * len(found & damaged.intact) / len(damaged.intact)
    return min(round(share, 2), 99.99) if damaged.intact - found else 100.0


def rates(package: str, short: bool, kind: str) -> dict[str, Any]:
    """The least of what the readers of a package give that promise every intact record."""
    make, count = {"tlog": telemetry, "bin": dataflash}[kind], 2_000 if short else 40_000
    source, other = make(count), make(count // 2, count)
    readers = [by_mavutil(package)]
    if package == "mavwire":
        readers = [by_open_log, by_tables]
        readers += (
            [by_mavutil(package, resync="rescan")] if kind == "tlog" else [by_mavutil(package)]
        )
    found = {}
    logs = {name: damage(source) for name, damage in DAMAGE.items()}
    logs["two logs joined in a record"] = joined(source, other)
    with tempfile.TemporaryDirectory() as folder, silence():
        path = Path(folder) / f"damaged.{kind}"
        for name, damaged in logs.items():
            path.write_bytes(damaged.data)
            found[name] = min(percent(read(str(path)), damaged) for read in readers)
    return found


def of_telemetry(package: str, short: bool) -> dict[str, Any]:
    """Telemetry logs."""
    return rates(package, short, "tlog")


def of_dataflash(package: str, short: bool) -> dict[str, Any]:
    """Dataflash logs."""
    return rates(package, short, "bin")
