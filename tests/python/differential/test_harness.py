"""The comparisons notice what they are there to notice: each is given two sides that differ in one
small thing.
"""

from __future__ import annotations

import importlib
from typing import Any

import pytest
from differential import observe, streams
from differential.bulk import Difference, compare_batch
from differential.frames import FrameMaker, layouts, x25

FRAMES = 30


class Altered:
    """A parser whose messages differ from the reference's in one method."""

    def __init__(self, mav: Any, method: str, answer: object) -> None:
        self._mav, self._method, self._answer = mav, method, answer

    def __getattr__(self, name: str) -> Any:
        return getattr(self._mav, name)

    def parse_buffer(self, data: bytes) -> list[object]:
        found: list[object] = self._mav.parse_buffer(data)
        cls = type(found[-1])
        altered = type(cls.__name__, (cls,), {self._method: lambda _self, *_: self._answer})
        found[-1].__class__ = altered
        return found


def test_check_value_of_the_checksum() -> None:
    assert x25(b"123456789") == 0x6F91


@pytest.mark.parametrize(
    ("method", "answer"),
    [
        ("__str__", "x"),
        ("to_dict", {}),
        ("to_json", "{}"),
        ("pack", b""),
        ("get_crc", 1),
        ("get_signed", 1),
    ],
)
def test_an_altered_message_is_noticed(oracle: str, method: str, answer: object) -> None:
    dialect = importlib.import_module(f"{oracle}.dialects.v20.common")
    frames = list(FrameMaker(1).frames(layouts(dialect), FRAMES))
    compare_batch("same", frames, dialect.MAVLink(None), dialect.MAVLink(None))
    with pytest.raises(Difference):
        altered = Altered(dialect.MAVLink(None), method, answer)
        compare_batch("altered", frames, altered, dialect.MAVLink(None))


def test_another_treatment_of_damage_is_noticed(oracle: str) -> None:
    dialect = importlib.import_module(f"{oracle}.dialects.v20.common")
    data = streams.stream(3, layouts(dialect), 30, signed=False)
    receivers = streams.Receiver(robust=True), streams.Receiver(robust=False)
    with pytest.raises(AssertionError, match="answer"):
        ours, theirs = (one.make(dialect) for one in receivers)
        streams.compare(ours, theirs, data, 7, True)


def test_another_policy_on_signatures_is_noticed(oracle: str) -> None:
    dialect = importlib.import_module(f"{oracle}.dialects.v20.common")
    data = streams.stream(3, layouts(dialect), 10, signed=True)
    receivers = streams.Receiver(), streams.Receiver(keyed=True)
    with pytest.raises(AssertionError, match="answer"):
        ours, theirs = (one.make(dialect) for one in receivers)
        streams.compare(ours, theirs, data, 7, True)


def test_the_damaged_streams_contain_every_kind_of_answer(oracle: str) -> None:
    dialect = importlib.import_module(f"{oracle}.dialects.v20.common")
    text = ""
    for seed in range(40):
        mav = streams.Receiver(keyed=seed % 2 == 0).make(dialect)
        data = streams.stream(seed, layouts(dialect), 30, signed=True)
        text += repr(list(streams.events(mav, data, 13, True)))
    for kind in (
        "Bad prefix",
        "invalid MAVLink CRC",
        "invalid incompat_flags",
        "Invalid signature",
    ):
        assert kind in text
    assert "'UNKNOWN_" in text
    assert observe.raised(lambda: 1 // 0).startswith("RAISES ZeroDivisionError")
