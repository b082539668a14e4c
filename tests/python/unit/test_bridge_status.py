"""The table of `mavwire bridge --status`, and the values of the command's options."""

from __future__ import annotations

import io
import os
import re
import subprocess
import sys
from argparse import ArgumentTypeError
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, cast

import pytest
from mavwire.cli._values import factor, size
from mavwire.cli.bridge import _bridge_warnings
from mavwire.cli.bridge._bridge_status import component_rows, link_errors, link_rows, unknown
from mavwire.cli.bridge.bridge import _watch, listen_address
from mavwire.dialects.v20 import upstream
from unit.terminal_tools import read_terminal

if TYPE_CHECKING:
    from argparse import Namespace

    from mavwire import Bridge
    from mavwire.bridge.sinks import Sink
    from mavwire.cli.bridge._bridge_warnings import DropWarnings

LINK: dict[str, Any] = {
    "name": "gcs", "peer": None, "state": "up", "error": None, "received": 100, "sent": 50,
    "dropped": 1, "duplicates": 2, "junk_bytes": 3, "overrun": None, "unknown": [],
    "latency": {"p50": 0.001, "p99": 0.0015, "p99.9": None},
}  # fmt: skip
COMPONENT = {
    "system": 1, "component": 1, "frames": 40, "lost": 4, "duplicates": 6, "age": 0.25,
    "links": ["a", "b"],
}  # fmt: skip


NOTHING: dict[str, Any] = {"uptime": 0.0, "links": [], "components": []}


def stats(uptime: float, **changes: Any) -> dict[str, Any]:
    link = {**LINK, **{key: changes[key] for key in changes if key in LINK}}
    component = {**COMPONENT, **{key: changes[key] for key in changes if key in COMPONENT}}
    return {"uptime": uptime, "links": [link], "components": [component]}


def test_rows_show_rates_since_the_last_look() -> None:
    before, now = stats(10.0), stats(12.0, received=300, sent=60, frames=41)
    assert link_rows(now, before) == [["gcs", "up", "100", "5", "1.50", "1", "", "2", "3"]]
    assert component_rows(now, before) == [["1", "1", "0", "4", "6", "0.2 s", "a, b"]]


def test_rows_show_what_is_wrong() -> None:
    now = stats(2.0, peer="10.0.0.1:5", state="connecting", error="Connection refused")
    (row,) = link_rows(now, NOTHING)
    assert row[:4] == ["  10.0.0.1:5", "connecting", "50", "25"]
    assert link_errors(now) == ["gcs 10.0.0.1:5: Connection refused"]


def test_messages_that_the_dialect_does_not_define_are_told() -> None:
    kinds = [
        {"id": 180, "crc_extra": 5, "frames": 17},
        {"id": None, "crc_extra": None, "frames": 2},
    ]
    assert unknown(stats(2.0, unknown=kinds), upstream) == [
        "gcs: 17 messages of id 180 have another definition (CRC_EXTRA 5) than CAMERA_FEEDBACK of upstream: "
        "name the XML file of that one too: `--dialect FILE.xml --dialect upstream`; "
        "2 messages of other kinds are not in the dialect upstream: name a dialect or an XML file that has it"
    ]
    assert unknown(stats(2.0), upstream) == []


def test_brackets_in_names_are_shown(capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("rich", reason="rich is not installed: pip install 'mavwire[cli]'")
    from mavwire import Bridge
    from mavwire.cli.bridge._bridge_status import StatusTable

    names = ["[fd00::2]:14550", "[/x] radio"]
    with Bridge() as bridge:
        for name in names:
            bridge.add("udpin:127.0.0.1:0", name=name)
        StatusTable(bridge).close()
    out = capsys.readouterr().out
    assert all(name in out for name in names)


def test_the_table_is_drawn_where_rich_is(capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("rich", reason="rich is not installed: pip install 'mavwire[cli]'")
    from mavwire import Bridge
    from mavwire.cli.bridge._bridge_status import StatusTable

    with Bridge(["udpin:127.0.0.1:0"]) as bridge:
        lost = {"name": "mqtt://h/x", "failed": 2, "dropped": 5, "error": "no answer"}
        bridge.sinks.append(cast("Sink", SimpleNamespace(stats=lambda: lost)))
        table = StatusTable(bridge)
        table()
        table.close()
        bridge.sinks.clear()
    assert "mqtt://h/x: no answer: 7 frames lost" in capsys.readouterr().out


@pytest.mark.skipif(not hasattr(os, "openpty"), reason="no terminals here")
def test_a_terminal_is_redrawn_and_names_do_not_steer_it(tmp_path: Path) -> None:
    pytest.importorskip("rich", reason="rich is not installed: pip install 'mavwire[cli]'")
    config = tmp_path / "bridge.toml"
    config.write_text('[[link]]\nendpoint = "udpin:127.0.0.1:0"\nname = "radio\\u001b[7m"\n')
    command = [sys.executable, "-m", "mavwire", "bridge", "--config", str(config), "--status"]
    environment = {**os.environ, "COLUMNS": "100", "LINES": "30", "TERM": "xterm"}
    ours, theirs = os.openpty()
    with subprocess.Popen(
        [*command, "--duration", "1.2s"], stdout=theirs, stderr=theirs, env=environment
    ) as bridge:
        os.close(theirs)
        text = read_terminal(ours)
    assert bridge.returncode == 0, text
    tables = text.count("link  ")
    assert tables >= 2
    lines = text.count("\x1b[1A"), text[: text.rindex("link  ")].count("\n")
    assert lines[0] >= lines[1] - 2, "each table takes the place of the one before"
    assert text.count("radio\\x1b[7m") == tables and "\x1b[7m" not in text
    assert text.count("\\x") == tables, "nothing else shows as an escape"
    assert re.search(r"\x1b\[\?25h\s*$", text), "the cursor is back"


@pytest.mark.skipif(not hasattr(os, "openpty"), reason="no terminals here")
def test_warnings_beside_the_table_go_where_standard_error_goes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    pytest.importorskip("rich", reason="rich is not installed: pip install 'mavwire[cli]'")
    from mavwire import Bridge
    from mavwire.cli.bridge._bridge_status import StatusTable

    monkeypatch.setenv("TERM", "xterm")
    ours, theirs = os.openpty()
    log = io.StringIO()
    with open(theirs, "w", encoding="utf-8") as terminal, Bridge() as bridge:
        monkeypatch.setattr(sys, "stdout", terminal)
        monkeypatch.setattr(sys, "stderr", log)
        status = StatusTable(bridge)
        print("a warning", file=sys.stderr)
        status.close()
    assert "a warning" not in read_terminal(ours)
    assert log.getvalue() == "a warning\n"


def table(width: int, rows: list[list[str]]) -> str:
    """The table of links on a terminal."""
    pytest.importorskip("rich", reason="rich is not installed: pip install 'mavwire[cli]'")
    from mavwire.cli.bridge._bridge_status import LINK_COLUMNS, _table
    from rich.console import Console

    out = io.StringIO()
    Console(width=width, file=out).print(_table(LINK_COLUMNS, rows, 2))
    return out.getvalue()


def test_a_narrow_terminal_shows_links_whole_and_no_columns_of_zeros() -> None:
    name = "udpout:192.168.120.200:14550"
    one = stats(2.0, name=name, duplicates=0, junk_bytes=0)
    one["links"].append({**LINK, "peer": "127.0.0.1:40001", "state": "up", "duplicates": 0})
    text = table(80, link_rows(one, NOTHING))
    assert name in text and "  127.0.0.1:40001" in text
    assert "junk" in text and "duplicates" not in text and "overrun" not in text


def test_without_a_terminal_losses_are_told_as_they_come_and_the_table_at_the_end(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("rich", reason="rich is not installed: pip install 'mavwire[cli]'")
    from mavwire import Bridge

    monkeypatch.setenv("FORCE_COLOR", "1")
    name = "a name that is " + "very " * 30 + "long"
    told: list[tuple[bool, bool]] = []

    def warn(at_end: bool = False) -> None:
        told.append((at_end, name in capsys.readouterr().out))

    with Bridge() as bridge:
        bridge.add("udpin:127.0.0.1:0", name=name)
        args = SimpleNamespace(status=True, json=None, duration=0.01)
        _watch(bridge, cast("DropWarnings", warn), cast("Namespace", args))
    assert told[0] == (False, False) and told[-1] == (True, True)


def test_a_link_that_takes_too_little_is_told_of_once_a_second(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    class Told:
        def __init__(self) -> None:
            self.links: list[dict[str, Any]] = []
            self.sinks: list[dict[str, Any]] = []
            self.recording: dict[str, Any] | None = None

        def stats(self) -> dict[str, Any]:
            return {"links": self.links, "recording": self.recording, "sinks": self.sinks}

    now, bridge = [100.0], Told()
    monkeypatch.setattr(_bridge_warnings.time, "monotonic", lambda: now[0])
    warn = _bridge_warnings.DropWarnings(cast("Bridge", bridge))

    def said(after: float, **link: Any) -> str:
        now[0] += after
        bridge.links = [{"name": "radio", "peer": "10.0.0.1:5", "queued_bytes": 9, **link}]
        warn()
        return capsys.readouterr().err

    assert said(0.9, dropped=500) == ""
    assert "warning: radio 10.0.0.1:5: 700 frames dropped" in said(0.2, dropped=700)
    assert said(0.9, dropped=800) == ""
    assert ": 200 frames dropped" in said(0.2, dropped=900)
    assert said(1.1, dropped=900) == ""
    assert said(1.1, dropped=950, queued_bytes=0) == "", "it is down"

    bridge.recording = {"path": "logs/a.tlog", "dropped": 3, "error": "No space"}
    assert "warning: recording logs: No space: 3 records lost" in said(1.1, dropped=950)
    bridge.recording = {"path": "logs/b.tlog", "dropped": 9, "error": "No space"}
    assert said(59.0, dropped=950) == "", "the same again"
    assert "warning: recording logs: No space: 9 records lost" in said(1.1, dropped=950)
    bridge.sinks = [{"name": "mqtt://h/x", "failed": 2, "dropped": 5, "error": "no answer"}]
    assert "warning: mqtt://h/x: no answer: 7 frames lost" in said(1.1, dropped=950)
    bridge.sinks[0].update(error=None, dropped=6)
    assert said(1.1, dropped=950) == ""
    warn(at_end=True)
    assert "mqtt://h/x: 8 frames lost\n" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "value"), [("1", 1), ("500k", 500_000), ("100M", 10**8), ("2g", 2 * 10**9)]
)
def test_sizes(text: str, value: int) -> None:
    assert size(text) == value


@pytest.mark.parametrize("text", ["", "0", "-1", "1.5M", "M", "10MB", "9" * 30, "٣"])
def test_wrong_sizes(text: str) -> None:
    with pytest.raises(ArgumentTypeError, match="not a size"):
        size(text)


@pytest.mark.parametrize(
    ("text", "value"),
    [(":9090", ("127.0.0.1", 9090)), ("0.0.0.0:1", ("0.0.0.0", 1)), ("[::1]:80", ("::1", 80))],
)
def test_addresses_to_listen_on(text: str, value: tuple[str, int]) -> None:
    assert listen_address(text) == value


@pytest.mark.parametrize("text", ["", "9090x", ":", ":99999", "host", ":-1"])
def test_wrong_addresses_to_listen_on(text: str) -> None:
    with pytest.raises(ArgumentTypeError, match="not "):
        listen_address(text)


@pytest.mark.parametrize("text", ["0", "-1", "nan", "1e30", "fast"])
def test_wrong_speeds_of_a_replay(text: str) -> None:
    with pytest.raises(ArgumentTypeError, match="must be above 0 and below 1000000"):
        factor(text)
