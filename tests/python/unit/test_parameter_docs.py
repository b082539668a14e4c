"""`mavwire parmdiff --param-docs`: what values of ArduPilot's parameters mean."""

from __future__ import annotations

from pathlib import Path

import pytest
from mavwire import cli
from mavwire.cli.vehicle import _param_docs

DOCS = """<?xml version="1.0" encoding="utf-8"?>
<paramfile><vehicles><parameters name="ArduCopter">
  <param name="ArduCopter:FRAME_CLASS"><values><value code="1">Quad</value>
    <value code="2">Hexa\u009b</value></values></param>
  <param name="ArduCopter:TWICE"><values><value code="1">of the vehicle</value></values></param>
  <param name="ArduCopter:BROKEN"><field name="Bitmask">x:All,1</field></param>
  <param name="ArduCopter:RANGE"><field name="Range">0 1</field></param>
</parameters></vehicles><libraries><parameters name="ARMING_">
  <param name="ARMING_CHECK"><field name="Bitmask">0:All,1:Barometer,3:GPS</field></param>
  <param name="NEW_MASK"><bitmask><bit code="0">Zero</bit></bitmask></param>
  <param name="TWICE"><values><value code="1">of the library</value></values></param>
</parameters></libraries></paramfile>"""


@pytest.fixture
def files(tmp_path: Path) -> list[str]:
    first, second = tmp_path / "one.parm", tmp_path / "two.parm"
    names = "FRAME_CLASS TWICE BROKEN RANGE ARMING_CHECK NEW_MASK".split()
    first.write_text("".join(f"{name} 1\n" for name in names))
    second.write_text("".join(f"{name} 2\n" for name in names) + "ONLY 3\nBIG inf\n")
    return [str(first), str(second)]


def comments(text: str) -> dict[str, str]:
    """Parameter -> what is said of its values."""
    rows = text.rsplit("FILE2\n", maxsplit=1)[-1].splitlines()
    return {row.split()[0]: row.partition(" # ")[2] for row in rows}


def test_meanings(files: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    docs = tmp_path / "apm.pdef.xml"
    docs.write_text(DOCS, encoding="utf-8")
    assert cli.main(["parmdiff", "--param-docs", "--param-xml", str(docs), *files]) == 0
    assert comments(capsys.readouterr().out) == {
        "FRAME_CLASS": "FILE1=Quad FILE2=Hexa\\x9b",
        "TWICE": "FILE1=of the library",
        "BROKEN": "",
        "RANGE": "",
        "ARMING_CHECK": "FILE1=All FILE2=Barometer",
        "NEW_MASK": "FILE1=Zero FILE2=Uknownbit1",
        "ONLY": "",
        "BIG": "",
    }


def test_bits_of_odd_values(tmp_path: Path) -> None:
    docs = tmp_path / "docs.xml"
    docs.write_text(DOCS, encoding="utf-8")
    meaning = _param_docs.ParameterDocs(str(docs)).meaning
    assert meaning("ARMING_CHECK", 0.5) == ""
    assert meaning("ARMING_CHECK", 13.9) == "All|GPS|Uknownbit2"
    assert str(meaning("ARMING_CHECK", -1)).endswith("|Uknownbit30")
    assert meaning("ARMING_CHECK", float("nan")) is None
    assert meaning("FRAME_CLASS", 1e300) is None


def test_the_file_that_mavproxy_keeps(
    files: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.setattr(Path, "home", lambda: tmp_path)
    monkeypatch.delenv("LOCALAPPDATA", raising=False)
    (tmp_path / ".mavproxy").mkdir()
    (tmp_path / ".mavproxy" / "Copter.xml").write_text(DOCS, encoding="utf-8")
    for vehicle in ("Copter", "ArduCopter"):
        assert cli.main(["parmdiff", "--param-docs", "--vehicle", vehicle, *files]) == 0
        assert "FILE1=Quad" in capsys.readouterr().out
    assert cli.main(["parmdiff", "--param-docs", "--vehicle", "Plane", *files]) == 1
    assert "'param download'" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("options", "reason", "code"),
    [
        ([], "needs --vehicle or --param-xml", 2),
        (["--param-xml", "missing.xml"], "missing.xml: No such file", 1),
        (["--param-xml", "two.parm"], "two.parm:1:1: not well-formed", 1),
        (["--param-xml", "bomb.xml"], ": a document type declaration", 1),
    ],
)
def test_documents_that_cannot_be_read(
    options: list[str], reason: str, code: int, files: list[str], tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bomb.xml").write_text('<!DOCTYPE a [<!ENTITY b "c">]><a>&b;</a>')
    assert cli.main(["parmdiff", "--param-docs", *options, *files]) == code
    assert reason in capsys.readouterr().err


def test_as_many_definitions_as_are_published(tmp_path: Path) -> None:
    """More elements than message definitions may have."""
    value = '<value code="1">A</value>'
    many = "".join(f'<param name="P{n}"><values>{value * 20}</values></param>' for n in range(5000))
    docs = tmp_path / "docs.xml"
    docs.write_text(
        f"<paramfile><libraries><parameters>{many}</parameters></libraries></paramfile>"
    )
    assert _param_docs.ParameterDocs(str(docs)).meaning("P4999", 1) == "A"
