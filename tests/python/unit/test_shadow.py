"""Shadow mode notices what differs: parsers and senders that are broken on purpose raise."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from types import ModuleType
from typing import Any

import pytest
from mavwire.shadow import ShadowMismatch

from .shadow_tools import Log, inner_class, shadowed  # noqa: F401

Loader = Callable[[str], ModuleType]
HEARTBEAT = bytes.fromhex("fd0900000001010000000400000002035104037bae")


@pytest.fixture
def module(shadowed: Loader) -> ModuleType:  # noqa: F811
    return shadowed("v20.common")


def broken(module: ModuleType, method: str, monkeypatch: pytest.MonkeyPatch, change: Any) -> None:
    """Lets `change(mav, result)` stand between a method of the parser and its callers."""
    inner = inner_class(module)
    original = getattr(inner, method)

    def replacement(self: Any, *args: Any, **kwargs: Any) -> Any:
        return change(self, original(self, *args, **kwargs))

    monkeypatch.setattr(inner, method, replacement)


def test_right_parser_passes(module: ModuleType) -> None:
    mav = module.MAVLink(None)
    mav.robust_parsing = True
    answers = [mav.parse_char(HEARTBEAT[:5]), mav.parse_char(HEARTBEAT[5:])]
    answers += mav.parse_buffer(b"junk" + HEARTBEAT + HEARTBEAT[:-1] + b"\0")
    assert [one and one.get_type() for one in answers] == [
        *(None, "HEARTBEAT"),
        *("BAD_DATA", "HEARTBEAT", "BAD_DATA"),
    ]
    assert mav.decode(bytearray(HEARTBEAT)).custom_mode == 4


def wrong_field(mav: Any, msg: Any) -> Any:
    msg.custom_mode = 5
    return msg


def test_wrong_field_is_named_with_offset_and_frame(
    module: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    mav = module.MAVLink(None)
    assert mav.parse_char(HEARTBEAT)
    broken(module, "parse_char", monkeypatch, wrong_field)
    with pytest.raises(ShadowMismatch) as caught:
        mav.parse_char(HEARTBEAT)
    error = caught.value
    assert (error.operation, error.part) == ("parse_char", "text")
    assert "custom_mode : 5" in error.ours and "custom_mode : 4" in error.theirs
    assert (error.offset, error.frame) == (len(HEARTBEAT), HEARTBEAT)
    text = str(error)
    assert "parse_char at byte 21 of the stream: text" in text
    assert HEARTBEAT.hex() in text and "custom_mode : 5" in text


def test_mismatch_survives_pickling(module: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    broken(module, "decode", monkeypatch, wrong_field)
    with pytest.raises(ShadowMismatch) as caught:
        module.MAVLink(None).decode(bytearray(HEARTBEAT))
    assert caught.value.offset is None
    again = pickle.loads(pickle.dumps(caught.value))
    assert str(again) == str(caught.value)


def test_lost_message_is_noticed_where_it_was(
    module: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    broken(module, "parse_buffer", monkeypatch, lambda mav, found: found[:-1])
    with pytest.raises(ShadowMismatch) as caught:
        module.MAVLink(None).parse_buffer(HEARTBEAT * 3)
    assert caught.value.ours is None and caught.value.theirs.message_type == "HEARTBEAT"
    assert caught.value.offset == 2 * len(HEARTBEAT)


def test_invented_message_is_noticed(module: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    broken(module, "parse_buffer", monkeypatch, lambda mav, found: [*found, *found])
    with pytest.raises(ShadowMismatch) as caught:
        module.MAVLink(None).parse_buffer(HEARTBEAT)
    assert caught.value.theirs is None


def test_wrong_counter_is_noticed(module: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    def miscount(mav: Any, result: Any) -> Any:
        mav.total_receive_errors += 1
        return result

    broken(module, "parse_char", monkeypatch, miscount)
    with pytest.raises(ShadowMismatch) as caught:
        module.MAVLink(None).parse_char(HEARTBEAT)
    error = caught.value
    assert (error.part, error.ours, error.theirs) == ("total_receive_errors", 1, 0)


def test_swallowed_error_is_noticed(module: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    mav = module.MAVLink(None)
    original = inner_class(module).parse_char

    def lenient(self: Any, data: Any) -> Any:
        try:
            return original(self, data)
        except module.MAVError:
            return None

    monkeypatch.setattr(inner_class(module), "parse_char", lenient)
    with pytest.raises(ShadowMismatch) as caught:
        mav.parse_char(HEARTBEAT[:-1] + b"\0")
    assert caught.value.ours is None and caught.value.theirs.error == "MAVError"


def test_invented_error_is_noticed(module: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(mav: Any, result: Any) -> Any:
        raise module.MAVError("no such luck")

    broken(module, "decode", monkeypatch, fail)
    with pytest.raises(ShadowMismatch, match="no such luck"):
        module.MAVLink(None).decode(bytearray(HEARTBEAT))


@pytest.mark.parametrize("method", ["heartbeat_send", "send"])
def test_wrong_frame_does_not_go_out(
    module: ModuleType, monkeypatch: pytest.MonkeyPatch, method: str
) -> None:
    file = Log()
    mav = module.MAVLink(file, 1, 1)

    def wrong(mav: Any, *_: Any) -> None:
        frame = bytearray(HEARTBEAT)
        frame[4] = 9
        # What the native code writes to: the watched file, not the one that the user sees.
        inner_class(module).file.__get__(mav).write(bytes(frame))

    if method == "send":
        monkeypatch.setattr(inner_class(module), "send", wrong)
    else:
        monkeypatch.setattr("mavwire.dialects._methods.send_values", wrong)
    with pytest.raises(ShadowMismatch) as caught:
        if method == "send":
            mav.send(module.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3))
        else:
            mav.heartbeat_send(2, 3, 81, 4, 4)
    assert caught.value.operation == method and caught.value.theirs == HEARTBEAT
    assert caught.value.frame == HEARTBEAT
    assert not file and mav.seq == 0


def test_frame_not_sent_is_noticed(module: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(inner_class(module), "send", lambda *_: None)
    with pytest.raises(ShadowMismatch) as caught:
        module.MAVLink(Log(), 1, 1).send(module.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3))
    assert caught.value.theirs == HEARTBEAT


def test_sequence_not_advanced_is_noticed(
    module: ModuleType, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stuck(mav: Any, result: Any) -> None:
        mav.seq = 0

    broken(module, "send", monkeypatch, stuck)
    with pytest.raises(ShadowMismatch, match="seq"):
        module.MAVLink(Log(), 1, 1).send(module.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3))
