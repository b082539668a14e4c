"""R67: any bytes, under any name and with any option, are a log to its end or a documented exception."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import pytest
from mavwire import mavutil
from unit.link_tools import heartbeat, record

TLOG = b"".join(record(heartbeat(n), 1_600_000_000_000_000 + n * 100_000) for n in range(20))
CSV = b"t;x\n" + b"".join(b"%d;%d\n" % (n, n) for n in range(20))
TEXT = b"FMT, 128, 89, FMT, BBnNZ, Type,Length,Name,Format,Columns\n"
HEADS = (b"", b"\xa3\x95\x80", TEXT, b"\x1f\x8b", b"\xfd", b"\xfe\xfe\xfe", b'"', b"\0", TLOG, CSV)
NAMES = ("x.tlog", "x.bin", "x.log", "x.px4log", "x.raw", "x.csv", "x")
OPTIONS: tuple[dict[str, Any], ...] = (
    {}, {"append": True}, {"notimestamps": True}, {"zero_time_base": True}, {"resync": "rescan"},
)  # fmt: skip


def damaged(data: bytes, rng: random.Random) -> bytes:
    """`data` with pieces changed, cut out, put in and repeated."""
    found = bytearray(data)
    for _ in range(rng.randrange(1, 20)):
        at = rng.randrange(len(found) + 1)
        piece = rng.choice((rng.randbytes(rng.randrange(20)), found[: rng.randrange(40)]))
        found[at : at + rng.choice((0, len(piece), 30))] = piece
    return bytes(found)


@pytest.mark.parametrize("seed", range(300))
def test_any_bytes_are_read_to_their_end(
    seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """R67."""
    rng = random.Random(seed)
    rest = rng.choice((rng.randbytes(rng.randrange(400)), damaged(TLOG, rng), damaged(CSV, rng)))
    data = rng.choice(HEADS) + rest
    monkeypatch.chdir(tmp_path)
    name = rng.choice(NAMES)
    Path(name).write_bytes(data)
    try:
        log = mavutil.mavlink_connection(rng.choice(("", "csv:")) + name, **rng.choice(OPTIONS))
    except ValueError as error:
        assert str(error).startswith(("cannot mmap an empty file", "no headings in"))
        return
    with log:
        found = 0
        while (msg := log.recv_match()) is not None:
            assert str(msg)
            assert msg.to_dict()["mavpackettype"] == msg.get_type()
            found += 1
            assert found <= len(data)
