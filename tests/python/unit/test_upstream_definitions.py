"""The dialect `upstream` has every message of both upstreams and contradicts no dialect of pymavlink."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

import definition_sources
import definitions_check
import mavwire
import pytest
import union_definitions
from mavwire._native import Dialect
from mavwire.cli.dev._definition_facts import definition_files
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
    accepted = {one.id for one in definition_sources.accepted()}
    for msgid, old in drop_in.mavlink_map.items():
        if msgid in accepted:
            continue
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


MESSAGE = '<message id="{}" name="{}"><field type="{}" name="a"/></message>'


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The files that the tool writes, in a folder of their own."""
    for name in ("UNION", "HISTORY", "SOURCES"):
        path: Path = getattr(definition_sources, name)
        shutil.copy(path, tmp_path / path.name)
        for module in (definition_sources, definitions_check, union_definitions):
            if hasattr(module, name):
                monkeypatch.setattr(module, name, tmp_path / path.name)
    monkeypatch.setattr(definition_sources, "DEFINITIONS", tmp_path)
    for function in (definition_sources.load, definition_sources.accepted):
        monkeypatch.setattr(function, "__defaults__", (tmp_path / "sources.toml",))
    for function in (definition_sources.save, definition_sources.save_written):
        monkeypatch.setattr(function, "__kwdefaults__", {"path": tmp_path / "sources.toml"})
    return tmp_path


def imported(files: Path, *messages: tuple[int, str, str], enums: str = "") -> None:
    """Import a checkout of these messages."""
    folder = files / "checkout"
    folder.mkdir(exist_ok=True)
    text = "".join(MESSAGE.format(*one) for one in messages)
    content = f"<enums>{enums}</enums><messages>{text}</messages>"
    (folder / "a.xml").write_text(f"<mavlink>{content}</mavlink>")
    pin = ["--pin", "mavlink/mavlink", "abcdef", "2026-11-01"]
    assert union_definitions.main([str(folder), *pin]) == 0


def test_additions_come_while_a_change_is_held_back(
    files: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    imported(files, (54000, "WIP", "float"))
    imported(files, (54000, "WIP", "double"), (54001, "NEW", "float"))
    printed = capsys.readouterr().out
    assert "a.xml: additive: message NEW (54001); changed CRC_EXTRA: WIP (54000) " in printed
    union = (files / "upstream.xml").read_text()
    assert '"NEW"' in union and '"WIP">\n      <description/>\n      <field type="float"' in union
    with (files / "sources.toml").open("a") as sources:
        sources.write(printed[printed.index("[[accepted]]") :].replace('""', '"is -- wip"'))
    before = (files / "history.xml").read_text()
    imported(files, (54000, "WIP", "double"), (54001, "NEW", "float"))
    union = (files / "upstream.xml").read_text()
    assert '"WIP">\n      <description/>\n      <field type="double"' in union
    added = (files / "history.xml").read_text().replace(before.partition("  </messages>")[0], "")
    assert ", replaced: is - wip -->" in added and '<field type="float" name="a"/>' in added
    (one,) = definition_sources.accepted()
    assert (one.id, one.reason) == (54000, "is -- wip")


def test_messages_that_upstream_removes_stay(files: Path) -> None:
    imported(files, (54000, "OLD", "float"))
    imported(files, (54001, "NEW", "float"))
    union = (files / "upstream.xml").read_text()
    assert 'name="OLD"' in union and 'name="NEW"' in union


def test_entries_without_a_value_and_those_of_other_files_are_kept(files: Path) -> None:
    enums = '<enum name="MAV_STATE"><entry name="MAV_STATE_BOOT" value="0x01"/><entry name="S_A" value="90"/>'
    imported(files, enums=f'{enums}<entry name="S_B"/></enum>')
    union = (files / "upstream.xml").read_text()
    assert '<entry value="90" name="S_A"/>\n      <entry value="91" name="S_B"/>' in union
    assert "MAV_CMD_PREFLIGHT_STORAGE_ADVANCED" in union


def test_an_entry_with_another_value_is_held_back(
    files: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    enums = '<enum name="MAV_STATE"><entry name="MAV_STATE_BOOT" value="0x10"/></enum>'
    imported(files, enums=enums)
    assert "enum values changed: MAV_STATE_BOOT 1 -> 16" in capsys.readouterr().out
    assert '<entry value="1" name="MAV_STATE_BOOT"/>' in (files / "upstream.xml").read_text()


@pytest.mark.skipif(
    "MAVWIRE_UPSTREAM" not in os.environ, reason="needs both upstreams' definitions"
)
def test_the_union_has_every_id_of_both_upstreams() -> None:
    folders = [Path(os.environ["MAVWIRE_UPSTREAM"], name) for name in ("mavlink", "ardupilot")]
    known = {msgid for _, msgid in Dialect.builtin(UPSTREAM, "2.0").messages()}
    command = [sys.executable, TOOL, *folders, "--check"]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    for path in (path for folder in folders for path in definition_files(folder)):
        ids = {int(one.get("id", "")) for one in ET.parse(path).iter("message")}
        held_back = {one for one in ids - known if f"and {one}" in done.stdout}
        assert known | held_back >= ids
