"""PX4's events in words: definitions, texts, commands and vehicles that offer them."""

from __future__ import annotations

import json
import lzma
import struct
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from mavwire.cli import main
from mavwire.component_metadata import MAX_BYTES, Kind, path_of, uri_of
from mavwire.dialects.v20 import upstream
from mavwire.events import EventDefinitions
from mavwire.sim import Vehicle

ENUMS = {
    "checks_t": {
        "type": "uint8_t", "is_bitfield": True, "separator": ", ",
        "entries": {
            "1": {"name": "gps", "description": "GPS"},
            "2": {"name": "compass", "description": "Compass"},
        },
    },
    "mode_t": {"type": "int16_t", "entries": {"3": {"name": "land", "description": "Land"}}},
}  # fmt: skip


def defined(message: str, *types: str, description: str = "") -> EventDefinitions:
    """Definitions of event 7 of component 1."""
    arguments = [{"type": kind, "name": f"a{place}"} for place, kind in enumerate(types)]
    event = {
        "name": "denied", "message": message, "description": description, "arguments": arguments
    }  # fmt: skip
    groups = {"arming_check": {"events": {"7": event}}}
    component = {"namespace": "px4", "enums": ENUMS, "event_groups": groups}
    return EventDefinitions(json.dumps({"version": 2, "components": {"1": component}}).encode())


def sent(arguments: bytes = b"", id: int = 1 << 24 | 7, log_levels: int = 0x64) -> Any:
    packed = list(arguments.ljust(40, b"\0"))
    return SimpleNamespace(id=id, log_levels=log_levels, arguments=packed)


@pytest.mark.parametrize(
    ("message", "types", "arguments", "text"),
    [
        ("Arming denied", [], b"", "Arming denied"),
        ("{1} {2}", ["uint8_t", "int8_t"], b"\xff\xff", "255 -1"),
        ("{2} {1}", ["uint16_t", "int64_t"], struct.pack("<Hq", 9, -(2**60)), f"{-(2**60)} 9"),
        ("at {1:.1m_v}, {1m/s}", ["float"], struct.pack("<f", 12.34), "at 12.3 m, 12.34 m/s"),
        ("{1:.2C} {2m}", ["float", "uint8_t"], struct.pack("<fB", 1.5, 7), "1.50 C 7 m"),
        ("check {1}", ["checks_t"], b"\x03", "check GPS, Compass"),
        ("check {1}", ["px4::checks_t"], b"\x09", "check GPS, unknown 8"),
        ("{1}/{2}", ["mode_t", "mode_t"], b"\x03\x00\x04\x00", "Land/unknown 4"),
        (r"\{1\} \<a> \\", ["uint8_t"], b"\1", r"{1} <a> " + "\\"),
        ("{2} {0} {x} {1kg} {1", ["uint8_t"], b"\1", "{2} {0} {x} {1kg} {1"),
        ("set <param>COM_{1}</param>", ["uint8_t"], b"\5", "set COM_5"),
        ('<a href="https://x.y">see</a> <a>x.z</a>', [], b"", "see x.z"),
        ('<profile name="dev">a</profile><profile name="!dev">b</profile>', [], b"", "b"),
        ("<future>gone</future><param>open", [], b"", "<param>open"),
        ("{1} {2}", ["other::type_t", "uint8_t"], b"\1\2", "{1} {2}"),
    ],
)
def test_a_text_has_its_arguments(
    message: str, types: list[str], arguments: bytes, text: str
) -> None:
    definitions = defined(message, *types, description=message)
    event = definitions.event(sent(arguments))
    assert (event.text, event.description) == (text, text)
    assert (event.name, event.group, event.level) == ("px4::denied", "arming_check", "warning")


def test_arguments_have_names() -> None:
    packed = struct.pack("<fB", 0.5, 2)
    event = defined("x", "float", "checks_t").event(sent(packed))
    assert event.arguments == {"a0": 0.5, "a1": "Compass"}


def test_an_event_without_a_definition_is_its_number() -> None:
    event = defined("x").event(sent(id=99, log_levels=0xFF))
    assert event == (99, "", "", "disabled", "event 99", "", {})


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"", "not PX4 event definitions"),
        (b"[]", "not PX4 event definitions"),
        (b'{"components": {"x": 5}}', "not PX4 event definitions"),
        (b'{"components": {"x": {"namespace": "a", "event_groups": {"b": {"events": {"c": 1}}}}}}',
         "."),
        (b"[" * 100_000, "not PX4 event definitions"),
        (b"\xfd7zXZ\x00 no", "."),
        (lzma.compress(b" " * 1000)[:-20], "incomplete"),
        (lzma.compress(b" " * (MAX_BYTES + 1)), f"more than {MAX_BYTES} bytes"),
    ],
)  # fmt: skip
def test_wrong_definitions_are_refused(data: bytes, reason: str, tmp_path: Path) -> None:
    path = tmp_path / "events.json"
    path.write_bytes(data)
    with pytest.raises(ValueError, match=rf"^{path}: .*{reason}"):
        EventDefinitions.read(path)


def test_metadata_that_is_elsewhere_is_named() -> None:
    general = json.dumps({"metadataTypes": [{"type": 4, "uri": "https://x.y/e.xz"}]}).encode()
    assert uri_of(lzma.compress(general), Kind.EVENTS) == "https://x.y/e.xz"
    with pytest.raises(LookupError, match="download https://x.y/e.xz"):
        path_of(uri_of(general, Kind.EVENTS))
    offer = {"type": 4, "uri": "https://x.y/e.xz", "uriFallback": "mftp:///etc/e.xz"}
    both = json.dumps({"metadataTypes": [offer]}).encode()
    assert path_of(uri_of(both, Kind.EVENTS)) == "/etc/e.xz"
    with pytest.raises(LookupError, match="no metadata of the kind parameter"):
        uri_of(general, Kind.PARAMETER)
    with pytest.raises(ValueError, match="general metadata"):
        uri_of(b"{}", Kind.EVENTS)
    assert (
        path_of("mftp://[;comp=100]/etc/a.json") == path_of("mftp:///etc/a.json") == "/etc/a.json"
    )


@pytest.fixture
def flight(tmp_path: Path) -> Path:
    """A log of a PX4 vehicle that was armed and disarmed, and its definitions beside it."""
    vehicle = Vehicle("px4")
    (tmp_path / "events.json.xz").write_bytes(
        vehicle.ftp.files.read("/etc/extras/all_events.json.xz", 0) or b""
    )
    vehicle.step(5.0)
    vehicle.say("took_off")
    vehicle.say("landed")
    stamp = struct.Struct(">Q")
    log = tmp_path / "flight.tlog"
    reader = upstream.MAVLink(None)
    messages = reader.parse_buffer(b"".join(vehicle.take())) or []
    log.write_bytes(
        b"".join(
            stamp.pack((1_700_000_000 + second) * 1_000_000) + message.get_msgbuf()
            for second, message in enumerate(messages)
        )
    )
    return log


def test_commands_print_events_in_words(flight: Path, capsys: pytest.CaptureFixture[str]) -> None:
    definitions = str(flight.with_name("events.json.xz"))
    assert main(["events", str(flight), "--event-definitions", definitions]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split(": ", 1)[1] for line in lines] == [
        "1/1 info: Takeoff detected", "1/1 info: Landing detected"
    ]  # fmt: skip
    assert main(["events", str(flight)]) == 0
    captured = capsys.readouterr()
    assert "1/1 info: event 1" in captured.out
    assert "--event-definitions FILE" in captured.err
    arguments = ["dump", str(flight), "--types", "EVENT", "--event-definitions", definitions]
    assert main(arguments) == 0
    assert capsys.readouterr().out.splitlines()[0].endswith("]} info: Takeoff detected")
    assert main([*arguments, "--format", "json"]) == 0
    event = json.loads(capsys.readouterr().out.splitlines()[1])["event"]
    assert (event["name"], event["text"]) == ("px4::landed", "Landing detected")
    assert main(["dump", str(flight), "--event-definitions", str(flight)]) == 1
    assert f"--event-definitions {flight}: " in capsys.readouterr().err
