"""Damaged streams give the same answers as pymavlink's parser gives, in every chunking and every
set-up.
"""

from __future__ import annotations

import importlib
from types import ModuleType

import pytest
from differential.frames import layouts
from differential.streams import CHUNKS, Receiver, compare, stream
from hypothesis import given, settings
from hypothesis import strategies as st

RECEIVERS = {
    "robust": Receiver(),
    "strict": Receiver(robust=False),
    "keyed": Receiver(keyed=True),
    "keyed-accepting": Receiver(keyed=True, accept_unsigned=True),
    "keyed-refusing": Receiver(robust=False, keyed=True, accept_unsigned=False),
}


@pytest.fixture(scope="module", params=["v20.ardupilotmega", "v10.common"])
def modules(request: pytest.FixtureRequest, subject: str, oracle: str) -> list[ModuleType]:
    return [importlib.import_module(f"{one}.dialects.{request.param}") for one in (subject, oracle)]


@pytest.mark.parametrize("buffered", [True, False], ids=["parse_buffer", "parse_char"])
@pytest.mark.parametrize("receiver", RECEIVERS.values(), ids=RECEIVERS)
def test_damaged_streams(modules: list[ModuleType], receiver: Receiver, buffered: bool) -> None:
    every = layouts(modules[1])
    answers = 0
    for seed in range(28):
        data = stream(seed, every, 30, receiver.keyed or seed % 5 == 0)
        size = CHUNKS[seed % len(CHUNKS)]
        ours, theirs = (receiver.make(module) for module in modules)
        answers += compare(ours, theirs, data, size, buffered)
    assert answers > 300, "the streams were left too early for the comparison to mean much"


@pytest.mark.parametrize("buffered", [True, False], ids=["parse_buffer", "parse_char"])
@pytest.mark.parametrize("receiver", RECEIVERS.values(), ids=RECEIVERS)
def test_every_chunk_size(modules: list[ModuleType], receiver: Receiver, buffered: bool) -> None:
    data = stream(77, layouts(modules[1]), 25, receiver.keyed)
    for size in (*range(1, 65), -5, -40, 280):
        ours, theirs = (receiver.make(module) for module in modules)
        assert compare(ours, theirs, data, size, buffered) > 0


@given(data=st.binary(max_size=400), size=st.integers(1, 50), robust=st.booleans())
@settings(max_examples=150, deadline=None)
def test_any_bytes(modules: list[ModuleType], data: bytes, size: int, robust: bool) -> None:
    markers = data.replace(b"\x01", b"\xfd").replace(b"\x02", b"\xfe")
    receiver = Receiver(robust=robust)
    ours, theirs = (receiver.make(module) for module in modules)
    compare(ours, theirs, markers, size, False)
