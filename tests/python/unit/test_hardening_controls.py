"""`make hardening` does not pass where nothing was measured: its controls notice what does not work at all."""

from __future__ import annotations

import subprocess
import sys
from types import SimpleNamespace
from typing import Any

import hardening.__main__ as table
import pytest
from hardening import code, kills, links, logs, wire
from hardening.rows import FIGURES, Figure, exactly


def figure(title: str) -> Figure:
    return next(one for one in FIGURES if one.title == title)


def met(title: str, answers: dict[str, Any]) -> list[bool]:
    """Of each row whether it is met, in the short form."""
    rows = table.rows(figure(title), answers, {})
    return [table.is_met(value, goal, short=True) for _, _, value, goal in rows]


def test_a_title_that_no_figure_has_is_an_error(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["hardening", "--only", "nothing like it"])
    with pytest.raises(SystemExit) as ended:
        table.main()
    assert ended.value.code == 2
    assert "no figure to measure has 'nothing like it'" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("returncode", "stdout", "expected"),
    [
        (0, '{"lost": 0}', {"lost": 0}),
        (-11, '{"lost": 0}', {"": "exit code -11"}),
        (0, "{}", {"": "exit code 0"}),
        (0, "", {"": "exit code 0"}),
    ],
)
def test_a_measurement_that_crashes_or_says_nothing_is_not_met(
    returncode: int, stdout: str, expected: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    done = subprocess.CompletedProcess([], returncode, stdout, "")
    monkeypatch.setattr(subprocess, "run", lambda *_, **__: done)
    found = table.measure(0, "mavwire", short=True)
    assert found == expected
    one = Figure("any", lambda *_: {}, (exactly(0),))
    ((*_, value, goal),) = table.rows(one, found, {})
    assert table.is_met(value, goal, short=True) == (expected == {"lost": 0})


def test_senders_that_send_nothing_break_no_sequence_and_are_not_met(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    silent = SimpleNamespace(signing=SimpleNamespace(), heartbeat_send=lambda *_: None)
    dialect = SimpleNamespace(MAVLink=lambda *_: silent)
    monkeypatch.setattr(links, "dialect_of", lambda _: dialect)
    interval = sys.getswitchinterval()
    try:
        answers = links.senders("mavwire", short=True)
    finally:
        sys.setswitchinterval(interval)
    assert met("four senders on one link", answers) == [False, False]


def test_tables_that_nothing_comes_to_are_not_met(monkeypatch: pytest.MonkeyPatch) -> None:
    deaf = SimpleNamespace(rx=bytearray(), recv_msg=lambda: None, setup_signing=lambda *_, **__: 0)
    monkeypatch.setattr(links, "capture_of", lambda _: deaf)
    monkeypatch.setattr(links, "peers", lambda _: {})
    # In the numbers of pymavlink, which are small.
    answers = links.tables("pymavlink", short=True)
    assert met("bytes for a made-up key", answers) == [False] * 5


def test_a_parser_that_reads_nothing_keeps_nothing_and_is_not_met(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    blind = SimpleNamespace(parse_buffer=lambda _: None)
    monkeypatch.setattr(wire, "parser_of", lambda *_: blind)
    answers = wire.unaligned("mavwire", short=True)
    assert met("kept after 8 MB unaligned", answers) == [False, False]


def test_a_parser_that_refuses_all_definitions_is_not_met(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(_package: str, _xml: str) -> None:
        raise ValueError

    assert met("hostile definitions", code.bombs("mavwire", short=True)) == [True] * 4
    monkeypatch.setattr(code, "parse_xml", refuse)
    assert met("hostile definitions", code.bombs("mavwire", short=True)) == [False] * 4


def test_a_reader_that_reads_no_dataflash_log_is_not_met(monkeypatch: pytest.MonkeyPatch) -> None:
    empty = SimpleNamespace(recv_msg=lambda: None)
    reader = SimpleNamespace(DFReader_binary=lambda _: empty, DFReader_text=lambda _: empty)
    monkeypatch.setattr(logs.importlib, "import_module", lambda _: reader)
    assert met("damaged dataflash logs", logs.mutated("mavwire", short=True)) == [False] * 4


def test_commands_that_fail_are_no_measure_of_kills(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kills, "COMMANDS", {"none": ("no-such-command", "LOG")})
    with pytest.raises(RuntimeError, match="no-such-command ended with 2"):
        kills.sweep("mavwire", short=True)
