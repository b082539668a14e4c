"""What mavextra does otherwise than pymavlink, on purpose, and what it does where that fails."""

from __future__ import annotations

import math
import sys
from typing import Any

import pytest
from mavwire import mavexpression, mavextra, mavutil
from mavwire.mavextra import state


class Message:
    def __init__(self, **fields: Any) -> None:
        self.__dict__.update(fields)


@pytest.fixture(autouse=True)
def forget() -> None:
    mavextra.reset_state_data()


def test_scaled_positions_are_told_by_their_size() -> None:
    """pymavlink takes the integers of GLOBAL_POSITION_INT for degrees."""
    scaled = Message(lat=-353632620, lon=1491652370, alt=584000)
    degrees = Message(Lat=-35.363262, Lng=149.165237, Alt=584.0)
    assert mavextra.get_lat_lon_alt(scaled) == pytest.approx(mavextra.get_lat_lon_alt(degrees))
    assert mavextra.distance_two(scaled, degrees) == pytest.approx(0, abs=1e-3)
    assert mavextra.distance_from(scaled, -35.363262, 149.165237) == pytest.approx(0, abs=1e-3)


def test_reset_forgets_everything() -> None:
    mavextra.diff(3, "k")
    mavextra.lowpassHz(3, "k", 100, 5)
    mavextra.average(3, "k", 2)
    mavextra.delta(3, "k", 1_000_000)
    mavextra.sum(3, "k")
    mavextra.integral(3, "k", 5)
    mavextra.downsample(3)
    mavextra.distance_home(Message(Status=3, Lat=1.0, Lng=2.0, Alt=3.0))
    assert mavextra.first_fix is not None and mavextra._downsample_N == 1
    mavextra.reset_state_data()
    assert mavextra.first_fix is None and mavextra._downsample_N == 0
    histories = ("average", "derivative", "lowpass", "lowpass_hz")
    for name in (*(f"{history}_data" for history in histories), "last_diff", "last_delta"):
        assert getattr(mavextra, name) == {}
    assert mavextra.last_sum == {} and mavextra.last_integral == {}


def test_without_a_link(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mavutil, "mavfile_global", None)
    with pytest.raises(AttributeError, match="no link or log is open"):
        mavextra.delta(1, "k")
    monkeypatch.setattr(mavutil, "mavfile_global", Message(timestamp=5.0))
    assert mavextra.delta(1, "k") == 0
    mavutil.mavfile_global.timestamp = 5.5
    assert mavextra.delta(2, "k") == 2.0


def test_functions_that_fail_in_pymavlink() -> None:
    assert mavextra.airspeed_ratio(Message(airspeed=20)) == 20.0
    origin = Message(Lat=-35.0, Lng=149.0, Alt=580.0)
    position = Message(Status=3, Lat=-35.001, Lng=149.0, Alt=600.0)
    assert mavextra.distance_home_df(position, origin) == pytest.approx(111.19, abs=0.01)
    assert mavextra.distance_home_df(Message(Status=1), origin) == 0
    sample = {f"{sensor}{axis}": 0.1 for sensor in ("Gyr", "Acc", "Mag") for axis in "XYZ"}
    start = Message(Roll=10.0, Pitch=0.0, Yaw=0.0)
    estimate = mavextra.DCM_update(Message(**sample), start, Message(**sample), None)
    assert estimate.roll == pytest.approx(math.radians(10.0) + 0.1 / 50, rel=1e-3)
    assert mavextra.dcm_state is estimate


def test_clear_errors_instead_of_obscure_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ValueError, match=r"no magnetic field is tabulated for 95, 0"):
        mavextra.expected_earth_field_lat_lon(95, 0)
    with pytest.raises(TypeError, match="without a position"):
        mavextra.distance_from(Message(), 1, 2)
    with pytest.raises(ValueError, match=r"average\(\) over more than 1000000 values"):
        mavextra.average(1.0, "k", 10_000_000)
    monkeypatch.setitem(sys.modules, "MAVProxy", None)
    with pytest.raises(ModuleNotFoundError, match="pip install MAVProxy"):
        mavextra.terrain_height(-35.0, 149.0)


def test_a_distance_that_fails_is_none_and_printed(capsys: pytest.CaptureFixture[str]) -> None:
    assert mavextra.distance_two(Message(), Message()) is None
    assert "without a position" in capsys.readouterr().out


def test_terrain_that_cannot_be_sampled(monkeypatch: pytest.MonkeyPatch) -> None:
    unknown = Message(GetElevation=lambda lat, lon: None)
    monkeypatch.setitem(state.SCALARS, "EleModel", unknown)
    mavextra.terrain_height.cache_clear()
    with pytest.raises(ValueError, match="not known"):
        mavextra.terrain_margin_lat_lon(1, 2, 3, 1.01, 2, 3)
    with pytest.raises(ValueError, match="too long"):
        mavextra.terrain_margin_lat_lon(0, 0, 3, 60, 60, 3)
    flat = Message(GetElevation=lambda lat, lon: 0.0)
    monkeypatch.setitem(state.SCALARS, "EleModel", flat)
    mavextra.terrain_height.cache_clear()
    falling = Message(Lat=1.0, Lng=2.0, Alt=math.inf)
    assert math.isnan(mavextra.radio_margin(falling, 1.001, 2.0, 0))
    mavextra.terrain_height.cache_clear()


def test_mavexpression_holds_the_names() -> None:
    assert mavexpression.sum is mavextra.sum
    assert mavexpression.degrees is math.degrees
    assert mavexpression.intensity_table is mavextra.intensity_table
    with pytest.raises(AttributeError):
        _ = mavexpression.nothing_of_the_kind
