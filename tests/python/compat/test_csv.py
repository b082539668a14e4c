"""CSV files as logs, on both packages: devices, separators, keywords, rows that lack or exceed."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

import pytest

FILES = {
    "plain.csv": 't;x;name\n1;2.5;foo\n2;3;bar\n3;nan;"q;z"\n',
    "comma.csv": "t,x\n1,2\n2,3\n",
    "colon.csv": "t:x\n1:2\n2:3\n",
    "tab.csv": "t\tx\n1\t2\n",
    "long.csv": "t;x\n1;2;7\n1.5;4\n",
    "headings.csv": "t;x\n",
    "crlf.csv": "t;x\r\n1; 2\r\n1e3;0x10\r\n",
}
DEVICES = [
    *[f"csv:{name}" for name in FILES],
    "CSV:plain.csv", "csv:none.csv", "csv:", "csv:.", "comma.csv",
    "csv:comma.csv:separator=,", "csv:colon.csv:separator=:", "csv:tab.csv:separator=\t",
    "csv:colon.csv:separator=::message_type=ROW", "csv:plain.csv:message_type=ROW",
    "csv:plain.csv:timestamp_expression=CSV.t*10", "csv:plain.csv:separator=;:separator=;",
    "csv:plain.csv:separator=ab", "csv:plain.csv:separator=", "csv:plain.csv:unknown=1",
    "csv:plain.csv:filename=comma.csv",
]  # fmt: skip


def transcript(package: str, device: str, arguments: dict[str, Any], **match: Any) -> list[Any]:
    """Everything that can be seen of a log, up to the exception that ends it."""
    mavutil = importlib.import_module(f"{package}.mavutil")
    seen: list[Any] = []
    try:
        log = mavutil.mavlink_connection(device, **arguments)
        seen += [type(log).__name__, log is mavutil.mavfile_global, log._count]
        while (msg := log.recv_match(**match)) is not None:
            seen += [msg.get_type(), msg.get_fieldnames(), str(msg), msg._timestamp]
        seen += [sorted(log.messages), log.percent, log.params]
        seen += [log.flightmode_list(), log.name_to_id("x")]
        log.rewind()
        seen.append(str(log.recv_msg()))
    except Exception as error:
        # Texts of TypeErrors name the class, and with it the package.
        told = "" if isinstance(error, TypeError) else str(error)
        seen.append(f"{type(error).__name__} {told}")
    return seen


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("CSV_SEPARATOR", raising=False)
    for name, text in FILES.items():
        Path(name).write_bytes(text.encode())


@pytest.mark.parametrize("device", DEVICES)
def test_devices(device: str, subject: str, oracle: str) -> None:
    assert transcript(subject, device, {}) == transcript(oracle, device, {})


@pytest.mark.parametrize(
    "arguments",
    [{"separator": ","}, {"separator": ",", "message_type": "ROW"}, {"unknown": 1}, {"write": True},
     {"zero_time_base": True, "progress_callback": print}],
    ids=str,
)  # fmt: skip
def test_keywords(arguments: dict[str, Any], subject: str, oracle: str) -> None:
    for device in ("csv:comma.csv", "csv:comma.csv:separator=;"):
        ours, theirs = (transcript(package, device, arguments) for package in (subject, oracle))
        assert ours == theirs


@pytest.mark.parametrize(
    "match",
    [{"condition": "CSV.x>2.6"}, {"type": "CSV"}, {"type": ["X", "CSV"]}, {"type": "X"},
     {"type": {"CSV"}, "condition": "CSV.t!=2"}],
    ids=str,
)  # fmt: skip
def test_matching(match: dict[str, Any], subject: str, oracle: str) -> None:
    ours, theirs = (transcript(p, "csv:plain.csv", {}, **match) for p in (subject, oracle))
    assert ours == theirs


def test_what_the_reference_refuses_is_read() -> None:
    """Listed in docs/compatibility.md."""
    Path("a:b.csv").write_text("t;x\n1;2\n")
    assert "CSV {t : 1.0, x : 2.0, }" in transcript("mavwire", "csv:a:b.csv", {})
    Path("bytes.csv").write_bytes(b"t;x\n1;\xff\n")
    assert r"CSV {t : 1.0, x : \xff, }" in transcript("mavwire", "csv:bytes.csv", {})
    assert transcript("mavwire", "csv:plain.csv:zero_time_base=1", {})[0] == "CSVReader"
    Path("quote.csv").write_text(f't;x\n1;2\n2;"{"a" * 200_000}\n3;4\n')
    assert "CSV {t : 1.0, x : 2.0, }" in transcript("mavwire", "csv:quote.csv", {})
    Path("quote.csv").write_text('t;x\n1;"' + "a" * 200_000 + '"\n3;4\n')
    assert "CSV {t : 3.0, x : 4.0, }" in transcript("mavwire", "csv:quote.csv", {})
    Path("quote.csv").write_text("t" * 200_000)
    assert transcript("mavwire", "csv:quote.csv", {})[0].startswith("ValueError no headings")
