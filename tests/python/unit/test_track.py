"""The length of a way."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from math import nan, radians
from types import SimpleNamespace
from typing import TYPE_CHECKING

import pytest
from mavwire._sphere import great_circle
from mavwire.cli.logs._track import Track
from mavwire.dialects.v20.common import MAVLink, MAVLink_gps_raw_int_message

if TYPE_CHECKING:
    from mavwire._native import Message

PLACES = [(47.0, 8.0), (47.1, 8.1), (-33.0, 179.9), (-33.0, -179.9), (90.0, 0.0)]


def test_the_length_of_a_way() -> None:
    track = Track()
    assert (track.metres, track.start, track.end) == (0.0, None, None)
    for stamp, place in enumerate(PLACES):
        track.add(*place, stamp)
    pairs = pairwise(PLACES)
    metres = sum(great_circle(*map(radians, one), *map(radians, other)) for one, other in pairs)
    assert track.metres == pytest.approx(metres, rel=1e-12)
    assert (track.start, track.end) == (PLACES[0], PLACES[-1])


def test_a_position_with_the_last_stamp_is_the_same_one() -> None:
    track = Track()
    for stamp in (1, 1, 1.0, 2**70, 2**70):
        track.add(float(stamp % 7), 0.0, stamp)
    assert track.start == (1.0, 0.0)
    assert track.end == (2**70 % 7, 0.0)


def test_positions_that_are_none() -> None:
    track = Track()
    track.add(1.0, 2.0, 1)
    track.add(nan, 2.0, 2)
    assert str(track.metres) == "nan"
    with pytest.raises(TypeError):
        track.add("x", 2.0, 3)  # type: ignore[arg-type]


def fix(lat: int, lon: int, usec: int = 1, fix_type: int = 3) -> Message:
    return MAVLink_gps_raw_int_message(usec, fix_type, lat, lon, 0, 0, 0, 0, 0, 0)


def received(message: Message) -> Message:
    """The same, as it comes out of a parser."""
    mav = MAVLink(None)
    parsed = mav.parse_char(message.pack(mav))
    assert parsed is not None
    return parsed


@pytest.mark.parametrize("as_it_came", [received, lambda message: message])
def test_a_way_along_messages(as_it_came: Callable[[Message], Message]) -> None:
    told = [
        fix(0, 85000000), fix(475000000, 0), fix(1, 1, fix_type=2),  # none of these is a position
        fix(475000000, 85000000, 5), fix(1, 2, 5), fix(-475000001, 85000000, 2**63 + 1),
    ]  # fmt: skip
    track, expected = Track(), Track()
    for message in told:
        track.follow(as_it_came(message))
    expected.add(47.5, 8.5, 5)
    expected.add(-47.5000001, 8.5, 6)
    assert (track.start, track.end) == (expected.start, expected.end)
    assert track.metres == expected.metres


def test_a_way_along_what_only_looks_like_messages() -> None:
    track = Track()
    track.follow(SimpleNamespace(lat=475000000.0, lon=85000000, fix_type=3, time_usec="x"))
    assert track.start == (47.5, 8.5)
    changed = received(fix(1, 1, 7))
    changed.lat = 480000000  # type: ignore[attr-defined]
    changed.lon = 90000000  # type: ignore[attr-defined]
    track.follow(changed)
    assert track.end == (48.0, 9.0)
    with pytest.raises(AttributeError, match="lon"):
        track.follow(SimpleNamespace(lat=1))
