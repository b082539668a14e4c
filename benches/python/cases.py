"""The measured cases: for each row of the table the work, the number of messages it handles, and a
proof that it was done right.

A case is the same code for every package. `run` is timed; what it returns must equal `expect`.
`digest` is not timed: it looks at the same results closely, and the driver compares the packages'
digests with each other.
"""

from __future__ import annotations

import hashlib
import importlib
import os
import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

from corpus import KEY, Corpus, chunks

SOME = 2_000
WANTED = ["ATTITUDE", "GPS_RAW_INT"]


@dataclass(frozen=True)
class Job:
    """One piece of work; `prepare` gives `run` its argument and is not timed."""

    count: int
    run: Callable[[Any], Any]
    expect: Any
    digest: Callable[[], Any]
    prepare: Callable[[], Any] = lambda: None


@dataclass
class Side:
    """One package, its modules imported when a case asks for them."""

    package: str

    @property
    def mavlink(self) -> ModuleType:
        return importlib.import_module(f"{self.package}.dialects.v20.ardupilotmega")

    @property
    def mavutil(self) -> ModuleType:
        return importlib.import_module(f"{self.package}.mavutil")

    def parser(self, key: bytes | None = None) -> Any:
        mav = self.mavlink.MAVLink(None)
        mav.robust_parsing = True
        mav.signing.secret_key = key
        return mav


def parse(mav: Any, pieces: Iterable[bytes]) -> Iterator[Any]:
    """Messages of a stream that arrives in pieces."""
    for piece in pieces:
        yield from mav.parse_buffer(piece) or ()


def fingerprint(messages: Iterable[Any]) -> str:
    """A digest of the messages' texts and bytes."""
    text = "\n".join(f"{bytes(msg.get_msgbuf()).hex()} {msg}" for msg in messages)
    return hashlib.sha256(text.encode()).hexdigest()


def _count(mav: Any, pieces: list[bytes]) -> int:
    count = 0
    for piece in pieces:
        for _msg in mav.parse_buffer(piece) or ():
            count += 1
    return count


def stream(side: Side, data: bytes, size: int, key: bytes | None = None) -> Job:
    """`parse_buffer` over a stream, every message looked at once."""
    pieces = chunks(data, size)
    messages = list(parse(side.parser(key), pieces))
    digest = fingerprint(messages), sum(msg.get_signed() for msg in messages)
    return Job(
        len(messages),
        lambda mav: _count(mav, pieces),
        len(messages),
        lambda: digest,
        lambda: side.parser(key),
    )


def byte_at_a_time(side: Side, corpus: Corpus) -> Job:
    """`parse_char` with single bytes, as over a serial line."""
    pieces = chunks(corpus.raw("stream")[: 36 * corpus.messages // 10], 1)

    def run(mav: Any) -> int:
        count = 0
        for piece in pieces:
            if mav.parse_char(piece) is not None:
                count += 1
        return count

    expect = run(side.parser())
    return Job(expect, run, expect, lambda: expect, side.parser)


def read_to_end(read: Callable[..., Any], wanted: str | Sequence[str] | None) -> int:
    """Reads all messages, or those of the wanted types, by calls as programs spell them: unpacking
    a dict of arguments for each call costs more than to find a message.
    """
    count = 0
    if wanted is None:
        while read() is not None:
            count += 1
    else:
        while read(type=wanted) is not None:
            count += 1
    return count


def log(
    side: Side,
    corpus: Corpus,
    opening: str,
    reading: str,
    wanted: Sequence[str] | None = None,
) -> Job:
    """Reading a log to its end; `count` is all messages in the file, whether they are returned or
    not.
    """
    how = {} if wanted is None else {"type": wanted}

    def opened() -> Any:
        return getattr(side.mavutil, opening)(corpus.tlog)

    def run(one: Any) -> int:
        return read_to_end(getattr(one, reading), wanted)

    def digest() -> str:
        one = opened()
        return fingerprint(iter(lambda: getattr(one, reading)(**how), None))

    return Job(corpus.messages, run, run(opened()), digest, opened)


def iterator(side: Side, corpus: Corpus) -> Job:
    """The messages of a log and nothing around them; pymavlink has `recv_msg` for that."""
    path = corpus.tlog

    def messages() -> Iterator[Any]:
        if side.package == "mavwire":
            return iter(importlib.import_module("mavwire").open_log(path))
        return iter(side.mavutil.mavlogfile(path).recv_msg, None)

    def run(found: Iterator[Any]) -> int:
        return sum(1 for _msg in found)

    return Job(corpus.messages, run, corpus.messages, lambda: fingerprint(messages()), messages)


def index(side: Side, corpus: Corpus) -> Job:
    """Opening a log, which indexes it."""
    path = corpus.tlog
    opened = side.mavutil.mavlink_connection
    counts = dict(sorted(opened(path).counts.items()))
    return Job(corpus.messages, lambda _: opened(path)._count, sum(counts.values()), lambda: counts)


def each(side: Side, corpus: Corpus, use: Callable[[Any], Any]) -> Job:
    """Parse a stream and do something with every message."""
    pieces = chunks(corpus.raw("stream"), 1 << 16)

    def run(mav: Any) -> int:
        count = 0
        for piece in pieces:
            for msg in mav.parse_buffer(piece) or ():
                use(msg)
                count += 1
        return count

    def digest() -> str:
        text = "\n".join(repr(use(msg)) for msg in parse(side.parser(), pieces))
        return hashlib.sha256(text.encode()).hexdigest()

    return Job(corpus.messages, run, corpus.messages, digest, side.parser)


def fields(msg: Any) -> list[Any]:
    """All field values."""
    return [getattr(msg, name) for name in msg.get_fieldnames()]


def attribute(side: Side, corpus: Corpus) -> Job:
    """One attribute of a message that is there already."""
    pieces = chunks(corpus.raw("stream"), 1 << 16)
    messages = [msg for msg in parse(side.parser(), pieces) if msg.get_type() == "ATTITUDE"]
    total = sum(msg.roll for msg in messages)

    def run(_: Any) -> bool:
        for msg in messages:
            msg.roll, msg.pitch, msg.yaw, msg.time_boot_ms  # noqa: B018
        return True

    return Job(4 * len(messages), run, True, lambda: repr(total))


def _raw(msg: Any, name: str) -> Any:
    return getattr(msg, f"_{name}_raw", getattr(msg, name))


def _received(side: Side, corpus: Corpus) -> list[Any]:
    data = corpus.raw("stream")[: 40 * SOME]
    return list(parse(side.parser(), [data]))[:SOME]


class Sink:
    """A transport that counts."""

    def __init__(self) -> None:
        self.bytes = 0

    def write(self, data: bytes) -> int:
        self.bytes += len(data)
        return len(data)


def _sender(side: Side, signed: bool) -> Any:
    mav = side.mavlink.MAVLink(Sink(), srcSystem=7, srcComponent=8)
    if signed:
        mav.signing.secret_key = KEY
        mav.signing.sign_outgoing = True
        mav.signing.timestamp = 1_000_000
    return mav


def pack(side: Side, corpus: Corpus, signed: bool = False) -> Job:
    """`msg.pack(mav)` of messages that a program built."""
    built = [
        type(msg)(*(_raw(msg, name) for name in msg.get_fieldnames()))
        for msg in _received(side, corpus)
    ]

    def run(mav: Any) -> int:
        for msg in built:
            msg.pack(mav)
        return len(built)

    def digest() -> str:
        mav = _sender(side, signed)
        return hashlib.sha256(b"".join(msg.pack(mav) for msg in built)).hexdigest()

    return Job(len(built), run, len(built), digest, lambda: _sender(side, signed))


def send(side: Side, corpus: Corpus, signed: bool = False) -> Job:
    """`mav.attitude_send(...)` and its like, from Python arguments to a transport."""
    calls = [
        (f"{msg.get_type().lower()}_send", [_raw(msg, name) for name in msg.get_fieldnames()])
        for msg in _received(side, corpus)
    ]

    def prepare() -> Any:
        mav = _sender(side, signed)
        return mav, [(getattr(mav, name), values) for name, values in calls]

    def run(state: Any) -> int:
        mav, bound = state
        for call, values in bound:
            call(*values)
        written: int = mav.file.bytes
        return written

    def digest() -> str:
        mav, sent = _sender(side, signed), hashlib.sha256()
        mav.file.write = sent.update
        for name, values in calls:
            getattr(mav, name)(*values)
        return f"{mav.seq} {sent.hexdigest()}"

    return Job(len(calls), run, run(prepare()), digest, prepare)


def columns(side: Side, corpus: Corpus) -> Job:
    """A whole log as columns by type: the way each package offers, a loop into lists where there is
    none.
    """
    return _columns(side, corpus.messages, corpus.tlog, "ATTITUDE", "roll")


def dataflash_columns(side: Side, corpus: Corpus) -> Job:
    """The same of a dataflash log."""
    return _columns(side, corpus.messages, corpus.dataflash, "ATT", "Roll")


def _columns(side: Side, messages: int, path: str, kind: str, field: str) -> Job:
    reader = COLUMN_READERS.get(side.package, _columns_by_loop)

    def one() -> Any:
        values = reader(side, path)[kind][field]
        return len(values), f"{sum(map(float, values)):.3f}"

    return Job(messages, lambda _: bool(reader(side, path)), True, one)


def _columns_by_loop(side: Side, path: str) -> Any:
    one = side.mavutil.mavlink_connection(path)
    kept: dict[str, dict[str, list[Any]]] = {}
    while (msg := one.recv_msg()) is not None:
        kind = msg.get_type()
        if kind not in kept:
            kept[kind] = {name: [] for name in ("timestamp", *msg.get_fieldnames())}
        into = kept[kind]
        into["timestamp"].append(msg._timestamp)
        for name in msg.get_fieldnames():
            into[name].append(getattr(msg, name))
    return kept


def _columns_by_fasttlogparser(_: Side, path: str) -> Any:
    import fasttlogparser

    return fasttlogparser.parse(path)[0]


def _columns_by_pymavlog(_: Side, path: str) -> Any:
    import pymavlog

    one = pymavlog.MavTLog(path)
    one.parse()
    return {kind: {"roll": one.get(kind)["roll"]} for kind in ["ATTITUDE"]}


def _columns_by_mavwire(_: Side, path: str) -> Any:
    import mavwire

    return mavwire.read(path, dialect="ardupilotmega")


def parquet(side: Side, corpus: Corpus) -> Job:
    """A log to a file of zstd Parquet for each type: mavwire by itself, others by pyarrow."""
    import pyarrow.parquet as pq

    folder = tempfile.mkdtemp(prefix=f"parquet-{side.package}-")
    write = _parquet_by_mavwire if side.package == "mavwire" else _parquet_by_loop

    def run(_: Any) -> int:
        return write(side, corpus.tlog, folder)

    def digest() -> str:
        run(None)
        (path,) = Path(folder).glob("ATTITUDE*/**/*.parquet")
        return hashlib.sha256(str(pq.read_table(path)["roll"].to_pylist()).encode()).hexdigest()

    return Job(corpus.messages, run, corpus.messages, digest, lambda: shutil.rmtree(folder))


def _parquet_by_mavwire(_: Side, path: str, folder: str) -> int:
    from mavwire.logs.conversion import convert

    return convert([path], folder, dialect="ardupilotmega")[0].rows


def _parquet_by_loop(side: Side, path: str, folder: str) -> int:
    import pyarrow as pa
    import pyarrow.parquet as pq

    count = 0
    for kind, columns in _columns_by_loop(side, path).items():
        os.makedirs(f"{folder}/{kind}", exist_ok=True)
        table = pa.table(columns)
        pq.write_table(table, f"{folder}/{kind}/log.parquet", compression="zstd")
        count += table.num_rows
    return count


COLUMN_READERS: dict[str, Callable[[Side, str], Any]] = {
    "mavwire": _columns_by_mavwire,
    "fasttlogparser": _columns_by_fasttlogparser,
    "pymavlog": _columns_by_pymavlog,
}


def dataflash(
    side: Side,
    corpus: Corpus,
    look: Callable[[Any], object] | None = None,
    wanted: str | None = None,
) -> Job:
    """Reading a dataflash log to its end, opening it not counted; `look` is called with each
    message.
    """
    how = {} if wanted is None else {"type": wanted}

    def opened() -> Any:
        return side.mavutil.mavlink_connection(corpus.dataflash)

    def run(one: Any) -> int:
        read, count = one.recv_match, 0
        if look is None:
            return read_to_end(read, wanted)
        while (msg := read(**how)) is not None:
            count += 1
            look(msg)
        return count

    def digest() -> str:
        one = opened()
        messages = iter(lambda: one.recv_match(**how), None)
        text = "\n".join(f"{msg._timestamp!r} {msg}" for msg in messages)
        return hashlib.sha256(text.encode()).hexdigest()

    return Job(corpus.messages, run, run(opened()), digest, opened)


def dataflash_open(side: Side, corpus: Corpus) -> Job:
    """Opening a dataflash log: what is in it, its clock, and the first message of each type."""

    def run(_: None) -> int:
        count: int = side.mavutil.mavlink_connection(corpus.dataflash)._count
        return count

    expect = run(None)
    return Job(corpus.messages, run, expect, lambda: expect)


def columns_of(msg: Any) -> list[Any]:
    """All values of a dataflash message."""
    return [getattr(msg, name) for name in msg.get_fieldnames()]


# Name -> how to make the job; the table's rows and goals are in goals.py.
CASES: dict[str, Callable[[Side, Corpus], Job]] = {
    "stream-64k": lambda s, c: stream(s, c.raw("stream"), 1 << 16),
    "stream-280": lambda s, c: stream(s, c.raw("stream"), 280),
    "stream-1": byte_at_a_time,
    "version1": lambda s, c: stream(s, c.raw("version1"), 1 << 16),
    "corrupt": lambda s, c: stream(s, c.raw("corrupt"), 1 << 16),
    "recv_match-mmap": lambda s, c: log(s, c, "mavlink_connection", "recv_match"),
    "recv_match-stream": lambda s, c: log(s, c, "mavlogfile", "recv_match"),
    "recv_msg-mmap": lambda s, c: log(s, c, "mavlink_connection", "recv_msg"),
    "open_log": iterator,
    "fields": lambda s, c: each(s, c, fields),
    "attribute": attribute,
    "to_dict": lambda s, c: each(s, c, lambda msg: msg.to_dict()),
    "to_json": lambda s, c: each(s, c, lambda msg: msg.to_json()),
    "str": lambda s, c: each(s, c, str),
    "filter-mmap": lambda s, c: log(s, c, "mavlink_connection", "recv_match", WANTED),
    "filter-stream": lambda s, c: log(s, c, "mavlogfile", "recv_match", WANTED),
    "index": index,
    "columns": columns,
    "parquet": parquet,
    "bin-open": dataflash_open,
    "bin-recv_match": dataflash,
    "bin-filter": lambda s, c: dataflash(s, c, wanted="ATT"),
    "bin-filter-rare": lambda s, c: dataflash(s, c, wanted="GPS"),
    "bin-columns": dataflash_columns,
    "bin-fields": lambda s, c: dataflash(s, c, columns_of),
    "bin-str": lambda s, c: dataflash(s, c, str),
    "pack": pack,
    "send": send,
    "pack-signed": lambda s, c: pack(s, c, signed=True),
    "send-signed": lambda s, c: send(s, c, signed=True),
    "signed-no-key": lambda s, c: stream(s, c.raw("signed"), 1 << 16),
    "verify": lambda s, c: stream(s, c.raw("signed"), 1 << 16, KEY),
}
