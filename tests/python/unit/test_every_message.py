"""A frame of every message that upstream defines, and of every layout that an id had, is a message everywhere."""

from __future__ import annotations

import json
import os
import re
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import mavwire
import pytest
from mavwire import Bridge, cli, dialects
from mavwire.bridge.inspector_tables import View
from mavwire.logs.manifest import MANIFEST
from unit.bridge_tools import wait_until

DEFINITIONS = Path(__file__).parents[3] / "message_definitions" / "upstream"
REPEATS = 3
Frame = tuple[str, bytes]


def frames(name: str, text: str, version: int, repeats: int = 1) -> Iterator[Any]:
    """The name and frames of each message of a definition file, made from its text alone."""
    module = dialects.load(text, name=name)
    mav = module.MAVLink(None, srcSystem=1, srcComponent=1)
    for kind in module.mavlink_map.values():
        if version == 1 and kind.id > 255:
            continue
        types = dict(zip(kind.fieldnames, kind.fieldtypes, strict=True))
        lengths = dict(zip(kind.ordered_fieldnames, kind.array_lengths, strict=True))
        fields = [_value(types[field], lengths[field]) for field in kind.fieldnames]
        made = []
        for mav.seq in range(repeats):
            made.append(bytes(kind(*fields).pack(mav, force_mavlink1=version == 1)))
        yield kind.msgname, *made


def _value(type_name: str, length: int) -> Any:
    """Ones, as payloads of version 2 end at their last byte that is not zero."""
    if type_name == "char":
        return b"x" * max(length, 1)
    return [1] * length if length else 1


@pytest.fixture(params=[1, 2], ids=["version 1", "version 2"])
def log(request: pytest.FixtureRequest, tmp_path: Path) -> tuple[Path, list[Frame]]:
    """A log with a frame of each message of `upstream`."""
    text = (DEFINITIONS / "upstream.xml").read_text()
    made = list(frames("every", text, request.param))
    return write(tmp_path / "every.tlog", [frame for _, frame in made]), made


def write(path: Path, made: list[bytes]) -> Path:
    stamps = (1_700_000_000_000_000 + 1000 * place for place in range(len(made)))
    path.write_bytes(
        b"".join(t.to_bytes(8, "big") + one for t, one in zip(stamps, made, strict=True))
    )
    return path


def test_no_message_of_upstream_is_unknown(
    log: tuple[Path, list[Frame]], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, made = log
    names = Counter(name for name, _ in made)
    assert len(names) == len(made) in (198, 394)
    info = mavwire.open_log(path).info()
    assert {name: row.messages for name, row in info.types.items()} == names
    assert (info.unknown, info.bad_bytes) == ({}, 0)
    out = tmp_path / "out"
    assert cli.main(["convert", str(path), "-o", str(out)]) == 0
    (row,) = json.loads((out / MANIFEST).read_text())["logs"]
    assert (row["unknown"], row["bad_bytes"]) == ([], 0)
    capsys.readouterr()
    assert cli.main(["dump", "--dialect", "upstream", "--format", "json", str(path)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert Counter(json.loads(line)["meta"]["type"] for line in lines) == names


@pytest.mark.skipif(
    "MAVWIRE_UPSTREAM" not in os.environ, reason="needs both upstreams' definitions"
)
def test_no_message_of_both_upstreams_is_unknown(tmp_path: Path) -> None:
    """Made from the upstreams' own files. Files that are not meant to be used together share 25 ids."""
    made: dict[tuple[str | None, str], bytes] = {}
    for path in sorted(Path(os.environ["MAVWIRE_UPSTREAM"]).rglob("*.xml")):
        for message in ET.fromstring(path.read_text(encoding="utf-8-sig")).iter("message"):
            for field in message.iter("field"):
                field.attrib.pop("enum", None)
            one = f"<mavlink><messages>{ET.tostring(message, 'unicode')}</messages></mavlink>"
            version = 1 if int(message.attrib["id"]) < 256 else 2
            ((name, frame),) = frames(f"one_{len(made)}", one, version)
            made[message.get("id"), name] = frame
    ids = {id_ for id_, _ in made}
    assert (len(ids), len(made)) == (394, 424)
    info = mavwire.open_log(write(tmp_path / "upstreams.tlog", list(made.values()))).info()
    # The first frame of a layout that is not the id's own is the evidence for the others.
    assert (info.unknown, info.count.messages) == ({}, len(made) - 1)


def test_a_bridge_and_its_inspector_name_every_message(log: tuple[Path, list[Frame]]) -> None:
    _, made = log
    names = {name for name, _ in made} - {"SETUP_SIGNING"}  # which goes nowhere: it has a key
    with Bridge() as bridge:
        for _, frame in made:
            bridge.send(frame)
        wait_until("all", lambda: len(bridge.kinds()) == len(names))
        assert {kind.name for kind in bridge.kinds()} == names
        shown = json.loads(View(bridge).tables())["types"].values()
    assert {kind["name"] for kind in shown} == names


def test_every_layout_of_the_past_is_named(tmp_path: Path) -> None:
    """Each is a log of its own: a sender has one layout at a time. The first frame is the evidence for the others."""
    text = (DEFINITIONS / "history.xml").read_text()
    comments = re.findall(r"<!-- CRC_EXTRA (\d+),", text)
    messages = list(ET.fromstring(text).iter("message"))
    assert len(comments) == len(messages) > 250
    named, ids = 0, set()
    for crc_extra, message in zip(comments, messages, strict=True):
        one = f"<mavlink><messages>{ET.tostring(message, 'unicode')}</messages></mavlink>"
        version = 1 if int(message.attrib["id"]) < 256 else 2
        ((name, *made),) = frames(f"old_{len(ids)}_{named}", one, version, REPEATS)
        path = write(tmp_path / "old.tlog", made)
        ((found, table),) = mavwire.read(path).items()
        assert found in (name, f"{name}_CRC{crc_extra}")
        assert len(table) == REPEATS - 1
        named += 1
        ids.add(message.attrib["id"])
    assert (named, len(ids)) == (292, 166)
