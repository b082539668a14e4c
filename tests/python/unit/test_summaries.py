"""mavwire's own lines on common messages, commands and enums: about things that exist, short, in its
own words, and where people look.
"""

from __future__ import annotations

import itertools
import re
import xml.etree.ElementTree as ET
from importlib import metadata
from pathlib import Path
from typing import Any

import pytest
from mavwire import cli, dialects
from mavwire.dialects import _descriptions
from mavwire.dialects.v20 import ardupilotmega as mavlink

WORDS_IN_COMMON = 6  # in a row; shorter runs are how one speaks of the thing


@pytest.fixture
def plain(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> str:
    """A dialect for which no XML with descriptions is at hand, and which no other test has used."""
    monkeypatch.setattr(_descriptions, "_folders", lambda: iter(()))
    path = tmp_path / "plain.xml"
    path.write_text("<mavlink><include>ardupilotmega.xml</include></mavlink>")
    return str(path)


def test_they_are_about_what_there_is() -> None:
    lines = _descriptions.summaries()
    assert set(lines) == {"messages", "commands", "enums"}
    assert not set(lines["messages"]) - {cls.msgname for cls in mavlink.mavlink_map.values()}
    assert not set(lines["commands"]) - {e.name for e in mavlink.enums["MAV_CMD"].values()}
    assert not set(lines["enums"]) - set(mavlink.enums)
    assert len(lines["messages"]) >= 120
    assert len(lines["commands"]) >= 80
    assert len(lines["enums"]) >= 40


def test_they_are_single_short_lines() -> None:
    for name, line in all_lines():
        assert line == " ".join(line.split()), name
        assert 4 <= len(line) <= 100 and not line.endswith("."), name


def all_lines() -> list[tuple[str, str]]:
    return [item for lines in _descriptions.summaries().values() for item in lines.items()]


def words(text: str) -> list[str]:
    return re.findall(r"[a-z0-9]+", text.lower())


def runs(text: str) -> set[tuple[str, ...]]:
    """All rows of words of a text."""
    found = words(text)
    return set(
        zip(*(itertools.islice(found, at, None) for at in range(WORDS_IN_COMMON)), strict=False)
    )


def test_they_are_in_our_own_words() -> None:
    """None repeats the description that upstream's definitions have, where these are installed."""
    try:
        folder = Path(str(metadata.distribution("pymavlink").locate_file("pymavlink/dialects/v20")))
    except metadata.PackageNotFoundError:
        pytest.skip("pymavlink is not installed: pip install -r requirements/test.txt")
    upstream: dict[str, str] = {}
    for path in sorted(folder.glob("*.xml")):
        for element in ET.parse(path).getroot().iter():
            if element.tag in ("message", "enum", "entry"):
                text = element.findtext("description") or ""
                upstream[element.get("name", "")] = text
    assert len(upstream) > 1000
    for name, line in all_lines():
        theirs = upstream.get(name, "")
        assert words(line) != words(theirs), name
        assert not runs(line) & runs(theirs), name


def test_they_stand_in_for_descriptions(plain: str) -> None:
    texts = _descriptions.Texts("plain")
    assert texts.message("HEARTBEAT") == (_descriptions.summary("messages", "HEARTBEAT"), {})
    assert texts.entry("MAV_CMD", "MAV_CMD_NAV_LAND") == "Land at a place, or here"
    assert texts.entry("MAV_TYPE", "MAV_TYPE_QUADROTOR") == ""
    module: Any = dialects.load(plain)
    assert _descriptions.summary("messages", "ATTITUDE") in module.MAVLink_attitude_message.__doc__


def show(capsys: pytest.CaptureFixture[str], name: str, dialect: str) -> list[str]:
    assert cli.main(["definitions", "show", name, "--dialect", dialect]) == 0
    return capsys.readouterr().out.splitlines()


def test_a_message_is_shown(plain: str, capsys: pytest.CaptureFixture[str]) -> None:
    title, summary, empty, *fields = show(capsys, "battery_status", plain)
    assert (title, empty) == ("BATTERY_STATUS (147)", "")
    assert summary == _descriptions.summary("messages", "BATTERY_STATUS")
    assert fields[0].split() == ["id", "uint8_t", "tells", "instances", "apart"]
    assert ["voltages", "uint16_t[10]", "mV"] in [field.split() for field in fields]
    assert fields[-1].split() == ["fault_bitmask", "uint32_t", "MAV_BATTERY_FAULT,", "extension"]


def test_a_layout_that_an_id_had_before_is_shown(
    plain: str, capsys: pytest.CaptureFixture[str]
) -> None:
    shown = show(capsys, "180", "upstream")
    assert shown[0] == "CAMERA_FEEDBACK (180)"
    others = " ".join(shown).partition("Other layouts of id 180: ")[2]
    assert "SCRIPT_ITEM (CRC_EXTRA 231)" in others and others.count("CRC_EXTRA") == 6
    one = next(name for name in others.split() if name.startswith("CAMERA_FEEDBACK_CRC"))
    assert show(capsys, one, "upstream")[0] == f"{one} (180)"
    assert show(capsys, "script_item", "upstream")[0] == "SCRIPT_ITEM (180)"


def test_enums_and_commands_are_shown(plain: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert show(capsys, "MAV_STATE", plain)[:4] == [
        "MAV_STATE", _descriptions.summary("enums", "MAV_STATE"), "", "  0  MAV_STATE_UNINIT",
    ]  # fmt: skip
    assert "values are bits" in show(capsys, "MAV_SYS_STATUS_SENSOR", plain)[1]
    assert not any("ENUM_END" in line for line in show(capsys, "MAV_RESULT", plain))
    command = show(capsys, "NAV_TAKEOFF", plain)
    assert command[:2] == ["MAV_CMD_NAV_TAKEOFF (22 of MAV_CMD)", "Take off and climb to a height"]
    assert command == show(capsys, "mav_cmd_nav_takeoff", plain)
    assert command[3].split() == ["1", "Pitch"]
    assert show(capsys, "MAV_TYPE_QUADROTOR", plain) == ["MAV_TYPE_QUADROTOR (2 of MAV_TYPE)"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["ATITUDE"], "has no message, enum or command 'ATITUDE'; did you mean 'ATTITUDE'?"),
        (["ATTITUDE", "--dialect", "comon"], "did you mean 'common'?"),
    ],
)
def test_what_there_is_not(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["definitions", "show", *arguments]) == 1
    assert said in capsys.readouterr().err
