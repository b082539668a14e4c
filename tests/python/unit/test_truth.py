"""What pymavlink takes by its truth is taken by its truth: 1, None, an empty list."""

from __future__ import annotations

import importlib
import io
import struct
from pathlib import Path
from typing import Any

import pytest
from unit.link_tools import heartbeat

VALUES = [1, 0, None, "", "no", [], [0], 0.0]


class Broken:
    def __bool__(self) -> bool:
        raise ValueError("neither")


def modules(package: str) -> tuple[Any, Any]:
    return (
        importlib.import_module(f"{package}.mavutil"),
        importlib.import_module(f"{package}.dialects.v20.common"),
    )


@pytest.fixture
def log(tmp_path: Path) -> str:
    path = tmp_path / "flight.tlog"
    path.write_bytes(struct.pack(">Q", 1_700_000_000_000_000) + heartbeat())
    return str(path)


def answers(package: str, log: str, value: Any) -> list[Any]:
    """What every call with a flag says to `value`."""
    mavutil, mavlink = modules(package)
    file = io.BytesIO()
    mav = mavlink.MAVLink(file, 1, 1)
    message = mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3)
    seen: list[Any] = [bytes(message.pack(mav, value)).hex()]
    mav.send(message, value)
    mav.send(message, force_mavlink1=value)
    mav.heartbeat_send(2, 3, 81, 4, 4, 3, value)
    seen.append(file.getvalue().hex())
    mav.signing.sign_outgoing = mav.have_prefix_error = mav.robust_parsing = value
    for flag in (mav.signing.sign_outgoing, mav.have_prefix_error, mav.robust_parsing):
        seen.append(bool(flag))
    with_log = mavutil.mavlink_connection(log)
    seen.append(str(with_log.recv_match(type="HEARTBEAT", blocking=value)))
    link = mavutil.mavlink_connection("udpin:127.0.0.1:0")
    seen.append(link.recv_match(blocking=value, timeout=0.01))
    link.first_byte = value
    seen.append(bool(link.first_byte))
    link.close()
    return seen


@pytest.mark.parametrize("value", VALUES, ids=repr)
def test_flags_go_by_the_truth(value: Any, log: str) -> None:
    assert answers("mavwire", log, value) == answers("mavwire", log, bool(value))


@pytest.mark.parametrize("value", [1, None], ids=repr)
def test_flags_are_taken_as_by_pymavlink(value: Any, log: str, oracle: str) -> None:
    assert answers("mavwire", log, value) == answers(oracle, log, value)


def test_an_object_without_truth_says_so() -> None:
    _, mavlink = modules("mavwire")
    mav = mavlink.MAVLink(None, 1, 1)
    message = mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3)
    with pytest.raises(ValueError, match="neither"):
        message.pack(mav, Broken())
    with pytest.raises(ValueError, match="neither"):
        mav.robust_parsing = Broken()
    assert not mav.robust_parsing
