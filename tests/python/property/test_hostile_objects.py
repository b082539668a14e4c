"""Objects that a program may pass by mistake, and callbacks that do what they should not: an ordinary
exception, and never a crash, a panic or a parser that is of no more use.
"""

from __future__ import annotations

import io
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import mavwire
import pytest
from encoder import attitude, frame, heartbeat, record
from hypothesis import given
from hypothesis import strategies as st
from mavwire import mavutil
from mavwire.dialects.v20 import common as mavlink
from property.hostile import PROFILE, ordinary
from unit.link_tools import KEY, T0, Capture, drain


class Odd:
    """Answers to every protocol with something wrong."""

    def __index__(self) -> int:
        return 1 << 70

    def __float__(self) -> float:
        raise ValueError("no number")

    def __len__(self) -> int:
        return 1 << 40

    def __iter__(self) -> Any:
        raise OverflowError("no items")

    def __str__(self) -> str:
        raise ValueError("no text")


OBJECTS = st.one_of(
    st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=9), st.binary(max_size=40),
    st.builds(Odd), st.builds(object), st.just(mavlink), st.lists(st.integers(), max_size=4),
    st.sampled_from([1 << 31, 1 << 64, -(1 << 63), float("nan"), 1e308, range(3)]),
    st.binary(max_size=30).map(bytearray), st.binary(max_size=30).map(lambda data: memoryview(data)),
    st.dictionaries(st.text(max_size=3), st.integers(), max_size=2),
)  # fmt: skip
METHODS = (
    "parse_char", "parse_buffer", "decode", "send", "heartbeat_send", "heartbeat_encode",
    "statustext_send", "attitude_encode", "set_callback", "set_send_callback", "check_signature",
)  # fmt: skip
ATTRIBUTES = (
    "robust_parsing",
    "resync",
    "seq",
    "srcSystem",
    "srcComponent",
    "buf",
    "expected_length",
)
SIGNING = (
    "secret_key", "timestamp", "link_id", "sign_outgoing", "allow_unsigned_callback", "stream_timestamps",
)  # fmt: skip


def is_of_use(mav: Any) -> None:
    """Whatever was done to it, a parser that gets plain settings again parses."""
    mav.signing = mavlink.MAVLinkSigning()
    mav.robust_parsing, mav.resync, mav.buf = True, "rescan", bytearray()
    mav.set_callback(None)
    # What was left of a message may swallow some frames, not a message's length of them.
    found = mav.parse_buffer(heartbeat() * 30 + heartbeat(3)) or []
    assert found[-1].get_type() == "HEARTBEAT"
    assert found[-1].get_seq() == 3


@PROFILE
@given(name=st.sampled_from(METHODS), arguments=st.lists(OBJECTS, max_size=7))
def test_any_arguments_of_methods(name: str, arguments: list[Any]) -> None:
    mav = mavlink.MAVLink(io.BytesIO(), 1, 1)
    with ordinary(mavlink.MAVError, struct.error):
        getattr(mav, name)(*arguments)
    is_of_use(mav)


@PROFILE
@given(name=st.sampled_from(ATTRIBUTES + SIGNING), value=OBJECTS)
def test_any_values_of_attributes(name: str, value: Any) -> None:
    mav = mavlink.MAVLink(io.BytesIO(), 1, 1)
    with ordinary():
        setattr(mav.signing if name in SIGNING else mav, name, value)
    for work in (
        lambda: mav.heartbeat_send(2, 3, 81, 4, 4),
        lambda: mav.parse_buffer(b"\xfd\x01" + heartbeat()),
        lambda: repr(mav.signing),
    ):
        # Signing without a key is an AssertionError, as in pymavlink.
        with ordinary(mavlink.MAVError, struct.error, AssertionError):
            work()
    is_of_use(mav)


@PROFILE
@given(
    values=st.lists(OBJECTS, min_size=1, max_size=9),
    field=st.sampled_from(["type", "x", "_timestamp"]),
)
def test_any_fields_of_messages(values: list[Any], field: str) -> None:
    with ordinary():
        msg = mavlink.MAVLink_statustext_message(*values)
        setattr(msg, field, values[0])
        with ordinary(struct.error):
            msg.pack(mavlink.MAVLink(None, 1, 1))
        str(msg)
    (received,) = mavlink.MAVLink(None).parse_buffer(heartbeat()) or []
    with ordinary(struct.error):
        setattr(received, field, values[0])
        received.pack(mavlink.MAVLink(None, 1, 1))


@PROFILE
@given(
    arguments=st.fixed_dictionaries(
        {}, optional=dict.fromkeys(("type", "condition", "blocking", "timeout"), OBJECTS)
    )
)
def test_any_arguments_of_recv_match(arguments: dict[str, Any]) -> None:
    arguments["blocking"] = False
    link = Capture()
    link.rx += heartbeat() + heartbeat(1)
    with ordinary(SyntaxError):
        link.recv_match(**arguments)
    link.rx += heartbeat(2)
    assert drain(link)[-1].get_seq() == 2


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("log") / "flight.tlog"
    frames = [frame(30, attitude(n, 0.1, 0, 0, 0, 0, 0), n) for n in range(50)]
    path.write_bytes(b"".join(record(one, T0 + 1000 * n) for n, one in enumerate(frames)))
    return path


@PROFILE
@given(
    arguments=st.fixed_dictionaries(
        {}, optional=dict.fromkeys(("types", "systems", "start", "end"), OBJECTS)
    ),
    key=OBJECTS,
)
def test_any_arguments_of_open_log(log: Path, arguments: dict[str, Any], key: Any) -> None:
    with mavwire.open_log(log) as opened:
        with ordinary():
            list(opened.messages(**arguments))
        with ordinary():
            opened[key]
        assert len(opened["ATTITUDE"]) == 50


class Stop(Exception):
    """What a callback raises."""


def nested(mav: Any) -> None:
    mav.parse_buffer(heartbeat(9))


def failing(mav: Any) -> None:
    raise Stop


def replacing(mav: Any) -> None:
    mav.set_callback(None)
    mav.signing.allow_unsigned_callback = None


def clearing(mav: Any) -> None:
    mav.buf = bytearray()
    mav.robust_parsing = not mav.robust_parsing


def sending(mav: Any) -> None:
    mav.heartbeat_send(2, 3, 81, 4, 4)


DEEDS: list[Callable[[Any], None]] = [nested, failing, replacing, clearing, sending]


@pytest.mark.parametrize("deed", DEEDS)
@pytest.mark.parametrize("place", ["message", "unsigned", "send"])
def test_callbacks_that_meddle(deed: Callable[[Any], None], place: str) -> None:
    mav = mavlink.MAVLink(io.BytesIO(), 1, 1)
    depth = 0

    def callback(*_: Any) -> bool:
        nonlocal depth
        if depth < 3:
            depth += 1
            deed(mav)
            depth -= 1
        return True

    if place == "message":
        mav.set_callback(callback)
    elif place == "send":
        mav.set_send_callback(callback)
    else:
        mav.signing.secret_key = KEY
        mav.signing.allow_unsigned_callback = callback
    for n in range(5):
        with ordinary(Stop, mavlink.MAVError):
            mav.parse_buffer(heartbeat(n))
        with ordinary(Stop):
            mav.heartbeat_send(2, 3, 81, 4, 4)
    mav.set_callback(None)
    mav.set_send_callback(None)
    mav.signing.secret_key = None
    mav.robust_parsing = True
    found = mav.parse_buffer(heartbeat(7)) or []
    assert [msg.get_seq() for msg in found if msg.get_msgId() == 0][-1:] == [7]


def test_hooks_that_meddle_with_their_link() -> None:
    link = Capture()

    def closing(_link: Any, _msg: Any) -> None:
        link.messages.clear()
        link.message_hooks.clear()

    def failing(_link: Any, _msg: Any) -> None:
        raise Stop

    for hook in (closing, failing):
        link.message_hooks.append(hook)
        link.rx += heartbeat() + heartbeat(1)
        with ordinary(Stop):
            drain(link)
        link.message_hooks.clear()
    link.rx += heartbeat(2)
    assert drain(link)[-1].get_seq() == 2


def test_tables_that_change_while_they_are_gone_through() -> None:
    link = Capture()
    link.rx += heartbeat() + frame(30, attitude(1, 0, 0, 0, 0, 0, 0))
    drain(link)
    seen = 0
    with ordinary(RuntimeError):
        for name in link.messages:
            seen += 1
            assert name
            link.rx += frame(42, b"\1\0", seen % 256) + heartbeat(sysid=1 + seen % 250)
            drain(link)
            if seen > 1000:
                break
    assert seen <= 1000
    assert "MISSION_CURRENT" in link.messages


def test_a_log_that_is_closed_while_it_is_read(log: Path) -> None:
    opened = mavwire.open_log(log)
    messages = opened.messages()
    next(messages)
    opened.close()
    with ordinary():
        list(messages)
    link = mavutil.mavlink_connection(str(log))
    link.recv_msg()
    link.close()
    with ordinary():
        drain(link)
