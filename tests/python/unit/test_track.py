"""The length of a way."""

from __future__ import annotations

from itertools import pairwise
from math import nan, radians

import pytest
from mavwire._native import Track
from mavwire._sphere import great_circle

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
