"""The traffic generator: deterministic, realistic, and honest about what it damages."""

from __future__ import annotations

import importlib
from collections import Counter
from itertools import pairwise
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from mavwire import traffic
from mavwire.traffic.flight import Flight
from mavwire.traffic.telemetry import GROUND_STATION, VEHICLE


@pytest.fixture(scope="module")
def dialect(subject: str) -> ModuleType:
    return importlib.import_module(f"{subject}.dialects.v20.ardupilotmega")


def parsed(dialect: ModuleType, options: traffic.Options, **attributes: Any) -> list[Any]:
    mav = dialect.MAVLink(None)
    mav.robust_parsing = True
    for name, value in attributes.items():
        setattr(mav.signing, name, value)
    stream = b"".join(frame for _, frame, _ in traffic.records(options, dialect))
    found: list[Any] = mav.parse_buffer(stream)
    return found


def test_the_mix_is_that_of_a_copter(dialect: ModuleType) -> None:
    messages = parsed(dialect, traffic.Options(20_000))
    types = Counter(msg.get_type() for msg in messages)
    size = sum(len(msg.get_msgbuf()) for msg in messages) / len(messages)
    fields = sum(len(msg.get_fieldnames()) for msg in messages) / len(messages)
    assert len(messages) == 20_000
    assert len(types) >= 35
    assert 33 < size < 38
    assert 7.5 < fields < 9.5
    sources = Counter((msg.get_srcSystem(), msg.get_srcComponent()) for msg in messages)
    assert sources.keys() == {(1, 1), (255, 190)}
    assert sources[1, 1] > 0.9 * len(messages)


def test_values_are_smooth_and_plausible(dialect: ModuleType) -> None:
    messages = parsed(dialect, traffic.Options(30_000))
    attitude = [msg for msg in messages if msg.get_type() == "ATTITUDE"]
    assert all(abs(msg.roll) < 0.6 and abs(msg.pitch) < 0.6 for msg in attitude)
    jumps = [abs(b.roll - a.roll) for a, b in pairwise(attitude)]
    assert max(jumps) < 0.1
    places = [msg for msg in messages if msg.get_type() == "GLOBAL_POSITION_INT"]
    assert max(msg.relative_alt for msg in places) > 25_000
    assert len({msg.lat for msg in places}) > len(places) // 2


def test_the_seed_decides_every_byte(dialect: ModuleType, tmp_path: Path) -> None:
    paths = [tmp_path / name for name in ("a", "b", "c")]
    for path, seed in zip(paths, (1, 1, 2), strict=True):
        traffic.generate(
            path, 2_000, seed=seed, systems=3, loss=0.1, corruption=0.1, dialect=dialect
        )
    assert paths[0].read_bytes() == paths[1].read_bytes() != paths[2].read_bytes()


def test_records_are_those_of_a_tlog_in_order_of_time(dialect: ModuleType, tmp_path: Path) -> None:
    path = tmp_path / "flight.tlog"
    written = traffic.generate(path, 3_000, dialect=dialect)
    data, at, times = path.read_bytes(), 0, []
    assert written.bytes == len(data)
    while at < len(data):
        times.append(int.from_bytes(data[at : at + 8], "big"))
        at += 8 + data[at + 9] + 12
    assert len(times) == written.messages == 3_000
    assert times == sorted(times)
    assert not any(stamp & 3 for stamp in times)
    assert written.seconds == pytest.approx((times[-1] - times[0]) / 1e6)


def test_losses_leave_gaps_in_the_sequence(dialect: ModuleType) -> None:
    expected: dict[tuple[int, int], int] = {}
    lost = 0
    for msg in parsed(dialect, traffic.Options(10_000, loss=0.05)):
        source = (msg.get_srcSystem(), msg.get_srcComponent())
        lost += (msg.get_seq() - expected.get(source, msg.get_seq())) & 255
        expected[source] = (msg.get_seq() + 1) & 255
    assert 350 < lost < 700


def test_damaged_frames_are_counted_and_rejected(dialect: ModuleType) -> None:
    options = traffic.Options(5_000, corruption=0.02)
    damaged = sum(flag for _, _, flag in traffic.records(options, dialect))
    bad = [msg for msg in parsed(dialect, options) if msg.get_type() == "BAD_DATA"]
    assert 50 < damaged < 200
    assert len(bad) == damaged


def test_signed_traffic_verifies(dialect: ModuleType) -> None:
    key = bytes(range(32))
    messages = parsed(dialect, traffic.Options(500, signing_key=key), secret_key=key)
    assert [msg.get_signed() for msg in messages] == [True] * 500


def test_version_1_traffic(dialect: ModuleType) -> None:
    messages = parsed(dialect, traffic.Options(2_000, version=1))
    framed = {msg.get_msgbuf()[0] for msg in messages}
    assert framed == {0xFE}


@pytest.mark.parametrize(
    ("options", "named"),
    [
        ({"messages": -1}, "messages"),
        ({"systems": 0}, "systems"),
        ({"loss": 1.0}, "loss"),
        ({"corruption": -0.1}, "corruption"),
        ({"version": 3}, "version"),
        ({"signing_key": b"short"}, "key"),
        ({"signing_key": bytes(32), "version": 1}, "MAVLink 2"),
    ],
)
def test_options_out_of_range_are_named(options: dict[str, Any], named: str) -> None:
    with pytest.raises(ValueError, match=named):
        traffic.Options(**options)


def test_a_flight_of_two_months_fits_its_fields(dialect: ModuleType) -> None:
    """A log of 10 GB takes a month; the clock since boot starts anew, batteries are changed."""
    flight = Flight(seed=0)
    mav = dialect.MAVLink(None)
    for seconds in range(0, 60 * 24 * 3600, 1777):
        flight.advance(float(seconds))
        assert flight.voltage > 14 and 0 < flight.remaining <= 100
        for name, _period, values in (*VEHICLE, *GROUND_STATION):
            getattr(dialect, f"MAVLink_{name.lower()}_message")(*values(flight)).pack(mav)
