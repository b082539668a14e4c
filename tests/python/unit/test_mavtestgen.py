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
