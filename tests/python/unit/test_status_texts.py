"""Long status texts come in several STATUSTEXT messages: one text in tables, JSON, aio and the inspector."""

from __future__ import annotations

import asyncio
import json
import time
from pathlib import Path
from typing import Any

import mavwire
import pytest
from mavwire import aio, cli
from mavwire.bridge import Bridge
from mavwire.bridge.inspector_tables import View
from mavwire.dialects.v10 import all as mavlink1
from mavwire.dialects.v20 import all as mavlink
from unit.link_tools import record

LONG = "A long message that is cut into several chunks of fifty bytes each, höhe too, to be joined"
T0 = 1_700_000_000_000_000


def frame(text: bytes, id: int = 0, chunk: int = 0, component: int = 1, seq: int = 0) -> bytes:
    sender = mavlink.MAVLink(None, 1, component)
    sender.seq = seq
    frame: bytes = mavlink.MAVLink_statustext_message(4, text, id, chunk).pack(sender)
    return frame


def parts(text: str, id: int, component: int = 1) -> list[bytes]:
    raw = text.encode()
    chunks = [raw[at : at + 50] for at in range(0, len(raw) + 1, 50)]
    return [frame(part, id, n, component) for n, part in enumerate(chunks)]


def frames() -> list[bytes]:
    """A short text; two long ones that overlap, one of them without its second part; and a start."""
    one, other = parts(LONG, 7), parts(LONG + LONG, 7, component=2)
    return [
        frame(b"short"), one[0], other[0], other[2], *one[1:], *other[3:], parts(LONG, 9)[0],
    ]  # fmt: skip


RAW = (LONG + LONG).encode()
GAP = (RAW[:50] + b"..." + RAW[100:]).decode()
TEXTS = ["short", LONG, GAP, LONG.encode()[:50].decode() + "..."]
"""In the order in which they end."""


@pytest.fixture
def log(tmp_path: Path) -> Path:
    path = tmp_path / "texts.tlog"
    path.write_bytes(b"".join(record(one, T0 + 4 * n) for n, one in enumerate(frames())))
    return path


@pytest.mark.parametrize("how", [{}, {"fields": ["text"]}, {"units": "si", "enums": "names"}])
def test_a_table_has_a_row_for_each_text(log: Path, how: dict[str, Any]) -> None:
    table = mavwire.read(log, "STATUSTEXT", **how)["STATUSTEXT"]
    assert table["text"].tolist() == TEXTS
    if not how:
        assert table["id"].tolist() == [0, 7, 7, 9] and not table["chunk_seq"].any()
        assert table["compid"].tolist() == [1, 1, 2, 1]
        begins = [(int(time) - T0) // 4 for time in table["timestamp"].astype("int64")]
        assert begins == [0, 1, 2, len(frames()) - 1]
    assert mavwire.read(log, "STATUSTEXT", systems=2)["STATUSTEXT"]["text"].tolist() == []


def test_batches_and_blocks_make_no_difference(log: Path) -> None:
    found = [row for table in mavwire.scan(log, batch_rows=1) for row in table["text"].tolist()]
    assert found == TEXTS


def test_a_batch_of_a_bridge_has_a_row_for_each_message() -> None:
    with Bridge() as bridge, bridge.frames(max_batch=1) as batches:
        rows = []
        for part in parts(LONG, 7):
            bridge.send(part)
            table = next(batches).tables()["STATUSTEXT"].to_numpy()
            rows += zip(table["text"], table["id"], table["chunk_seq"], strict=True)
    text = LONG.encode()
    assert rows == [(text[:50].decode(), 7, 0), (text[50:].decode(), 7, 1)]


@pytest.mark.parametrize("options", [[], ["--show-types"], ["--types", "STATUSTEXT"]])
def test_json_has_a_line_for_each_text(
    log: Path, options: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    """By the native loop, and by the ordinary one."""
    assert cli.main(["dump", "--format", "json", *options, str(log)]) == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith("{")]
    ascii = [text.encode().decode("ascii", "replace") for text in TEXTS]
    assert [json.loads(line)["data"]["text"] for line in lines] == ascii
    stamps = [json.loads(line)["meta"]["timestamp"] for line in lines]
    assert stamps[1] == pytest.approx((T0 + 4) / 1e6, abs=1e-6)
    # Text and mavutil stay as pymavlink's.
    assert cli.main(["dump", str(log)]) == 0
    assert len(capsys.readouterr().out.splitlines()) == len(frames())


def test_aio_tells_whole_texts(log: Path) -> None:
    async def heard() -> list[tuple[str, int]]:
        async with aio.connect(str(log)) as link:
            return [(one.text, one.message.severity) async for one in link.texts()]

    assert asyncio.run(heard()) == [(text, 4) for text in TEXTS]


def test_the_inspector_shows_whole_texts() -> None:
    with Bridge() as bridge:
        view = View(bridge)
        view.hear('{"open": [[1, 1, 253], [1, 2, 253]]}')

        def shown() -> dict[str, Any]:
            values = json.loads(view.values() or "{}")["values"]
            return {sender: fields[1][1][0] for sender, fields in values.items()}

        def send(some: list[bytes]) -> None:
            """And wait until the last one has passed."""
            bridge.send(b"".join(some))
            deadline = time.monotonic() + 10
            while time.monotonic() < deadline:
                newest = bridge.latest("STATUSTEXT")
                if newest is not None and bytes(newest.get_msgbuf()) == some[-1]:
                    return

        send(frames()[:-1])
        assert shown() == {"1/1/253": LONG, "1/2/253": GAP}
        send(frames()[-1:])  # the start of another one
        assert shown()["1/1/253"] == LONG
        assert bridge.latest_text(3, 3) is None


@pytest.mark.parametrize("more", [[], ["--verbose"]])
def test_texts_of_mavlink_1_have_no_parts(
    more: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sender = mavlink1.MAVLink(None, 1, 1)
    frames = [mavlink1.MAVLink_statustext_message(4, text).pack(sender) for text in (b"a", b"b")]
    path = tmp_path / "v1.tlog"
    path.write_bytes(b"".join(record(one, T0 + n) for n, one in enumerate(frames)))
    assert cli.main(["dump", "--mav10", "--format", "json", *more, str(path)]) == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if '"text"' in line]
    assert [json.loads(line)["data"]["text"] for line in lines] == ["a", "b"]
