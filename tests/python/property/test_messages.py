"""Properties that hold for every message, whatever its values: round trips, independence of
chunking, faithful copies.
"""

from __future__ import annotations

import copy
import importlib
import math
import pickle
from itertools import pairwise
from types import ModuleType
from typing import Any

import pytest
from differential.frames import FrameMaker, Framing, Layout, layouts
from hypothesis import given, settings
from hypothesis import strategies as st

PROFILE = settings(max_examples=300, deadline=None)
LIMITS = {
    "uint8_t": (0, 2**8 - 1),
    "int8_t": (-(2**7), 2**7 - 1),
    "uint16_t": (0, 2**16 - 1),
    "int16_t": (-(2**15), 2**15 - 1),
    "uint32_t": (0, 2**32 - 1),
    "int32_t": (-(2**31), 2**31 - 1),
    "uint64_t": (0, 2**64 - 1),
    "int64_t": (-(2**63), 2**63 - 1),
}


@pytest.fixture(scope="module", params=["v20.all", "v10.all"])
def dialect(request: pytest.FixtureRequest, subject: str) -> ModuleType:
    return importlib.import_module(f"{subject}.dialects.{request.param}")


def element(kind: str) -> st.SearchStrategy[Any]:
    """Values that a field of this type can carry without change."""
    if kind in LIMITS:
        return st.integers(*LIMITS[kind])
    return st.floats(width=32 if kind == "float" else 64)


def field(cls: Any, name: str) -> st.SearchStrategy[Any]:
    """Values for a field of a message class."""
    kind = cls.fieldtypes[cls.fieldnames.index(name)]
    length = cls.array_lengths[cls.ordered_fieldnames.index(name)]
    if kind == "char":
        size = max(length, 1)
        return st.binary(min_size=int(not length), max_size=size).map(_storable)
    return st.lists(element(kind), min_size=length, max_size=length) if length else element(kind)


def _storable(text: bytes) -> bytes:
    return text.replace(b"\0", b"0")


def arguments(dialect: ModuleType) -> st.SearchStrategy[tuple[Any, dict[str, Any]]]:
    """A message class with values for all of its fields."""
    classes = [dialect.mavlink_map[key] for key in sorted(dialect.mavlink_map)]
    return st.sampled_from(classes).flatmap(
        lambda cls: st.tuples(
            st.just(cls),
            st.fixed_dictionaries({name: field(cls, name) for name in cls.fieldnames}),
        )
    )


def same(left: Any, right: Any) -> bool:
    """Equal, NaN equal to NaN."""
    if isinstance(left, float) and isinstance(right, float) and math.isnan(left):
        return math.isnan(right)
    if isinstance(left, list):
        return len(left) == len(right) and all(map(same, left, right))
    return bool(left == right)


def expected(cls: Any, name: str, value: Any) -> Any:
    """What a decoded field shows for a value that was sent."""
    if cls.fieldtypes[cls.fieldnames.index(name)] == "char":
        return value.decode("ascii", "replace")
    return value


@PROFILE
@given(data=st.data())
def test_every_value_survives_the_wire(dialect: ModuleType, data: st.DataObject) -> None:
    cls, values = data.draw(arguments(dialect))
    mav = dialect.MAVLink(None, srcSystem=3, srcComponent=4)
    frame = cls(**values).pack(mav)
    decoded = dialect.MAVLink(None).decode(bytearray(frame))
    assert type(decoded) is cls
    for name, value in values.items():
        assert same(expected(cls, name, value), getattr(decoded, name)), name
    assert decoded.pack(mav) == frame
    assert (decoded.get_srcSystem(), decoded.get_srcComponent()) == (3, 4)


@PROFILE
@given(data=st.data())
def test_copies_are_equal_and_independent(dialect: ModuleType, data: st.DataObject) -> None:
    cls, values = data.draw(arguments(dialect))
    frame = bytearray(cls(**values).pack(dialect.MAVLink(None)))
    message = dialect.MAVLink(None).decode(frame)
    first = message.get_fieldnames()[0]
    for duplicate in (
        copy.copy(message),
        copy.deepcopy(message),
        pickle.loads(pickle.dumps(message)),
    ):
        assert type(duplicate) is type(message)
        assert str(duplicate) == str(message)
        assert duplicate.get_msgbuf() == message.get_msgbuf()
        assert vars(duplicate.get_header()) == vars(message.get_header())
        assert duplicate == message or "nan" in str(message)
        before = repr(getattr(message, first))
        setattr(duplicate, first, "changed")
        assert repr(getattr(message, first)) == before
        assert duplicate != message


@PROFILE
@given(
    seed=st.integers(0, 2**32),
    cuts=st.lists(st.integers(0, 3000), max_size=30),
    keyed=st.booleans(),
)
def test_chunking_changes_nothing(
    dialect: ModuleType, seed: int, cuts: list[int], keyed: bool
) -> None:
    maker = FrameMaker(seed, Framing(2, bytes(32) if keyed else None))
    every: list[Layout] = layouts(dialect)
    stream = b"".join(maker.frame(maker.random.choice(every)) for _ in range(12))
    edges = sorted({0, len(stream), *(cut for cut in cuts if cut < len(stream))})
    whole, pieces = dialect.MAVLink(None), dialect.MAVLink(None)
    if keyed:
        whole.signing.secret_key = pieces.signing.secret_key = bytes(32)
    at_once = [str(msg) for msg in whole.parse_buffer(stream)]
    in_parts: list[str] = []
    for start, end in pairwise(edges):
        in_parts += [str(msg) for msg in pieces.parse_buffer(stream[start:end]) or []]
    assert in_parts == at_once
    assert len(at_once) == 12
    assert whole.total_bytes_received == pieces.total_bytes_received == len(stream)
