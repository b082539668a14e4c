"""The dialect `upstream` has every message of both upstreams and contradicts no dialect of pymavlink."""

from __future__ import annotations

import os
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import mavwire
import pytest
import union_definitions
from mavwire._native import Dialect
from mavwire.dialects import UPSTREAM
from mavwire.dialects.v20 import all as drop_in
from mavwire.dialects.v20 import upstream

ROOT = Path(__file__).parents[3]
TOOL = ROOT / "tools" / "union_definitions.py"
# Both upstreams gave these values of MAV_TYPE new names.
RENAMED = {"VTOL_DUOROTOR", "VTOL_QUADROTOR", "VTOL_RESERVED2", "VTOL_RESERVED3", "VTOL_RESERVED4"}


@pytest.mark.parametrize("version", ["1.0", "2.0"])
def test_no_message_of_a_drop_in_dialect_is_missing(version: str) -> None:
    names = dict(Dialect.builtin(UPSTREAM, version).messages())
    assert dict(Dialect.builtin("all", version).messages()).items() <= names.items()
    assert len(names) >= {"1.0": 198, "2.0": 394}[version]


def test_messages_of_both_have_the_same_checksum_and_fields() -> None:
    longer = []
    for msgid, old in drop_in.mavlink_map.items():
        new = upstream.mavlink_map[msgid]
        assert (new.msgname, new.crc_extra) == (old.msgname, old.crc_extra)
        assert new.fieldnames[: len(old.fieldnames)] == old.fieldnames
        assert new.native_format.startswith(old.native_format)
        if len(new.fieldnames) > len(old.fieldnames):
            longer.append(new.msgname)
    assert {
        "MISSION_CURRENT",
        "MISSION_COUNT",
        "MISSION_ACK",
        "SET_ATTITUDE_TARGET",
        "TIMESYNC",
        "SERIAL_CONTROL",
        "WIFI_CONFIG_AP",
    } <= set(longer)


def test_no_enum_entry_of_a_drop_in_dialect_is_missing() -> None:
    for enum, entries in drop_in.enums.items():
        for value, entry in entries.items():
            if entry.name.endswith("_ENUM_END"):
                continue
            name = upstream.enums[enum][value].name
            assert name == entry.name or entry.name.removeprefix("MAV_TYPE_") in RENAMED


def test_a_log_of_px4_loses_no_message(tmp_path: Path) -> None:
    path = tmp_path / "px4.tlog"
    mav = upstream.MAVLink(None)
    with path.open("wb") as log:
        for number in range(10):
            for message in (
                upstream.MAVLink_event_message(0, 0, 7, number, number, 0, [0] * 40),
                upstream.MAVLink_heartbeat_message(2, 12, 0, 0, 4, 3),
            ):
                log.write((1_700_000_000_000_000 + number).to_bytes(8, "big"))
                log.write(message.pack(mav))
    assert {name: len(table) for name, table in mavwire.read(path).items()} == {
        "EVENT": 10,
        "HEARTBEAT": 10,
    }


def test_sets_that_contradict_each_other_are_refused(tmp_path: Path) -> None:
    message = '<message id="0" name="{}"><field type="uint8_t" name="a"/></message>'
    text = f"<mavlink><messages>{message.format('OTHER')}</messages></mavlink>"
    (tmp_path / "all.xml").write_text(text)
    done = run(tmp_path)
    assert done.returncode == 2 and "id 0 is OTHER and HEARTBEAT" in done.stderr


def test_messages_that_upstream_removes_stay_unless_told_otherwise(tmp_path: Path) -> None:
    output, checkout = tmp_path / "upstream.xml", tmp_path / "checkout"
    folder = checkout / "message_definitions" / "v1.0"
    folder.mkdir(parents=True)
    text = '<message id="{}" name="{}"><field type="uint8_t" name="a"/></message>'
    for id_, name in ((54000, "OLD"), (54001, "NEW")):
        message = text.format(id_, name)
        (folder / "a.xml").write_text(f"<mavlink><messages>{message}</messages></mavlink>")
        assert union_definitions.main([str(checkout), "--output", str(output)]) == 0
    assert 'name="OLD"' in output.read_text() and 'name="NEW"' in output.read_text()
    assert union_definitions.main([str(checkout), "--output", str(output), "--fresh"]) == 0
    assert 'name="OLD"' not in output.read_text() and 'name="NEW"' in output.read_text()


@pytest.mark.parametrize(
    ("enum", "reason"),
    [
        ('<enum name="MAV_STATE"><entry name="MAV_STATE_BOOT" value="0x10"/></enum>', "16 and 1"),
        ('<enum name="MAV_STATE"><entry name="MAV_STATE_BOOT" value="0x01"/></enum>', ""),
    ],
)
def test_values_are_compared_whatever_way_they_are_written(
    enum: str, reason: str, tmp_path: Path
) -> None:
    (tmp_path / "a.xml").write_text(f"<mavlink><enums>{enum}</enums></mavlink>")
    done = run(tmp_path)
    assert (done.returncode == 2) == bool(reason) and reason in done.stderr


@pytest.mark.skipif(
    "MAVWIRE_UPSTREAM" not in os.environ, reason="needs both upstreams' definitions"
)
def test_the_union_has_every_id_of_both_upstreams() -> None:
    folders = [Path(os.environ["MAVWIRE_UPSTREAM"], name) for name in ("mavlink", "ardupilot")]
    known = {msgid for _, msgid in Dialect.builtin(UPSTREAM, "2.0").messages()}
    for path in (path for folder in folders for path in folder.glob("*.xml")):
        assert known >= {int(one.get("id", "")) for one in ET.parse(path).iter("message")}
    assert run(*folders, "--check").returncode == 0


def run(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, TOOL, *arguments, *([] if "--check" in arguments else ["--check"])],
        check=False, capture_output=True, text=True,
    )  # fmt: skip
