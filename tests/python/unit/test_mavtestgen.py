"""The generator of test traffic: what it writes sends every message, and the fields tell apart."""

from __future__ import annotations

import io
import runpy
from pathlib import Path
from typing import Any

import pytest
from mavwire import mavtestgen
from mavwire.dialects.v20 import common

DEFINITIONS = Path(__file__).parents[3] / "message_definitions" / "v1.0"


def sent(module: Path) -> list[Any]:
    out = io.BytesIO()
    sender = common.MAVLink(out, srcSystem=1, srcComponent=1)
    runpy.run_path(str(module))["generate_outputs"](sender)
    return common.MAVLink(None).parse_buffer(out.getvalue()) or []


def test_every_message_is_sent_and_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    module = tmp_path / "mavtest.py"
    mavtestgen.main([str(DEFINITIONS / "common.xml"), "-o", str(module)])
    messages = sent(module)
    assert capsys.readouterr().out.endswith(f"{module}: {len(messages)} messages\n")
    names = {message.get_type() for message in messages}
    assert len(names) == len(messages) > 200
    (ping,) = [message for message in messages if message.get_type() == "PING"]
    values = [getattr(ping, name) for name in ping.get_fieldnames()]
    assert len(set(values)) == len(values)
    assert 0 not in values


def test_a_wrong_file_is_named(tmp_path: Path) -> None:
    wrong = tmp_path / "wrong.xml"
    wrong.write_text("<html/>")
    with pytest.raises(SystemExit, match=r"mavtestgen: .*wrong\.xml"):
        mavtestgen.main([str(wrong), "-o", str(tmp_path / "out.py")])
    with pytest.raises(SystemExit, match="missing"):
        mavtestgen.main([str(tmp_path / "missing.xml"), "-o", str(tmp_path / "out.py")])


@pytest.mark.parametrize(
    ("message", "field"),
    [("FOO", "x=0);print('PWNED')#"), ("A;x", "x"), ("FOO", "class")],
)
def test_names_do_not_become_code(message: str, field: str, tmp_path: Path) -> None:
    definition = tmp_path / "hostile.xml"
    definition.write_text(
        f'<mavlink><messages><message id="9" name="{message}"><description/>'
        f'<field type="uint8_t" name="{field}"/></message></messages></mavlink>'
    )
    module = tmp_path / "out.py"
    with pytest.raises(SystemExit, match=r"hostile\.xml:1:\d+: .* is (not a name|a reserved word)"):
        mavtestgen.main([str(definition), "-o", str(module)])
    assert not module.exists()


def test_values_are_what_the_fields_can_hold(tmp_path: Path) -> None:
    definition = tmp_path / "own.xml"
    kinds = ("uint8_t", "int8_t", "uint64_t", "float", "char[4]", "int16_t[2]")
    fields = "".join(
        f'<field type="{kind}" name="f{number}"/>' for number, kind in enumerate(kinds)
    )
    definition.write_text(
        '<mavlink><messages><message id="9" name="OWN"><description/>'
        f"{fields}</message></messages></mavlink>"
    )
    module = tmp_path / "out.py"
    assert mavtestgen.generate([str(definition)], str(module)) == 1
    given: dict[str, Any] = {}

    class Sender:
        """Keeps what it is to send."""

        own_send = staticmethod(given.update)

    runpy.run_path(str(module))["generate_outputs"](Sender)
    assert list(given) == [f"f{number}" for number in range(len(kinds))]
    assert 0 <= given["f0"] < 1 << 8
    assert -1 << 7 <= given["f1"] < 1 << 7
    assert 0 <= given["f2"] < 1 << 64
    assert isinstance(given["f3"], float)
    assert isinstance(given["f4"], bytes)
    assert len(given["f4"]) <= 4
    assert len(given["f5"]) == 2
    assert all(-1 << 15 <= value < 1 << 15 for value in given["f5"])
