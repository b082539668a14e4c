"""The Earth's magnetic field where a vehicle is, and what its compass should read there.

The field comes from tables of 10 degrees (declination and inclination in degrees, intensity in
gauss), interpolated; vectors are in milligauss, north, east, down or in the body's frame.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence
from math import floor, radians
from typing import Any

from mavwire.mavextra import compass, inertial, state
from mavwire.rotmat import Matrix3, Vector3

__all__ = [
    "SAMPLING_MAX_LAT", "SAMPLING_MAX_LON", "SAMPLING_MIN_LAT", "SAMPLING_MIN_LON",
    "SAMPLING_RES", "earth_field_error", "expected_earth_field", "expected_earth_field_lat_lon",
    "expected_mag", "expected_mag_latlon", "expected_mag_yaw", "get_lat_lon_status",
    "get_mag_field_ef", "interpolate_table", "mag_yaw",
]  # fmt: skip

SAMPLING_RES = 10.0
SAMPLING_MIN_LAT = -90.0
SAMPLING_MAX_LAT = 90.0
SAMPLING_MIN_LON = -180.0
SAMPLING_MAX_LON = 180.0

Table = Sequence[Sequence[float]]

TABLES = ("declination_table", "inclination_table", "intensity_table")


@functools.cache
def table(name: str) -> list[list[float]]:
    """One of TABLES: 19 rows from south to north of 37 values from west to east."""
    import json
    from importlib import resources

    text = resources.files("mavwire").joinpath("_data/earth_field.json").read_text("utf-8")
    values: list[list[float]] = json.loads(text)[name.removesuffix("_table")]
    return values


def interpolate_table(table: Table, latitude_deg: float, longitude_deg: float) -> float:
    """The value at a point, bilinear; IndexError outside of the table."""
    row = _cell(latitude_deg, SAMPLING_MIN_LAT)
    column = _cell(longitude_deg, SAMPLING_MIN_LON)
    south_west, south_east = table[row][column], table[row][column + 1]
    north_west, north_east = table[row + 1][column], table[row + 1][column + 1]
    up = (latitude_deg - (SAMPLING_MIN_LAT + row * SAMPLING_RES)) / SAMPLING_RES
    right = (longitude_deg - (SAMPLING_MIN_LON + column * SAMPLING_RES)) / SAMPLING_RES
    south = right * (south_east - south_west) + south_west
    north = right * (north_east - north_west) + north_west
    return up * (north - south) + south


def _cell(angle: float, first: float) -> int:
    index = floor((angle - first) / SAMPLING_RES)
    if index < 0:
        raise IndexError(f"{angle} degrees are outside of the table")
    return index


def get_mag_field_ef(latitude_deg: float, longitude_deg: float) -> list[float] | None:
    """[declination, inclination, intensity] at a point; None outside of the tables."""
    inside = (
        SAMPLING_MIN_LAT <= latitude_deg < SAMPLING_MAX_LAT
        and SAMPLING_MIN_LON <= longitude_deg < SAMPLING_MAX_LON
    )
    if not inside:
        return None
    return [interpolate_table(table(name), latitude_deg, longitude_deg) for name in TABLES]


def expected_earth_field_lat_lon(lat: float, lon: float) -> Vector3:
    """The field at a point, in the earth's frame; ValueError outside of the tables."""
    field = get_mag_field_ef(lat, lon)
    if field is None:
        raise ValueError(f"no magnetic field is tabulated for {lat}, {lon}")
    declination, inclination, intensity = field
    state.SCALARS["earth_declination"] = declination
    direction = Matrix3()
    direction.from_euler(0.0, -radians(inclination), radians(declination))
    return direction * Vector3(intensity * 1000.0, 0.0, 0.0)


def get_lat_lon_status(GPS: Any) -> tuple[float, float, int]:
    """(latitude, longitude, fix) of GPS_RAW_INT or of the dataflash message."""
    if hasattr(GPS, "fix_type"):
        return GPS.lat * 1.0e-7, GPS.lon * 1.0e-7, GPS.fix_type
    return GPS.Lat, GPS.Lng, GPS.Status


def expected_earth_field(GPS: Any) -> Vector3:
    """The field where a GPS is, in the earth's frame; zero without a 3D fix."""
    lat, lon, status = get_lat_lon_status(GPS)
    return Vector3() if status < 3 else expected_earth_field_lat_lon(lat, lon)


def _in_body(field: Vector3, euler: Sequence[float], adjust: Sequence[float]) -> Vector3:
    """An earth field as a compass sees it at this attitude (radians), off by these degrees."""
    attitude = Matrix3()
    attitude.from_euler(*(a + radians(off) for a, off in zip(euler, adjust, strict=True)))
    return attitude.transposed() * field


def expected_mag(
    GPS: Any, ATT: Any, roll_adjust: float = 0, pitch_adjust: float = 0, yaw_adjust: float = 0
) -> Vector3:
    """The expected reading of the compass at this position and attitude, turned by these degrees."""
    adjust = (roll_adjust, pitch_adjust, yaw_adjust)
    return _in_body(expected_earth_field(GPS), inertial.euler(ATT), adjust)


def expected_mag_latlon(
    lat: float,
    lon: float,
    ATT: Any,
    roll_adjust: float = 0,
    pitch_adjust: float = 0,
    yaw_adjust: float = 0,
) -> Vector3:
    """The expected reading of the compass at this point and attitude, turned by these degrees."""
    adjust = (roll_adjust, pitch_adjust, yaw_adjust)
    return _in_body(expected_earth_field_lat_lon(lat, lon), inertial.euler(ATT), adjust)


def mag_yaw(GPS: Any, ATT: Any, MAG: Any) -> float:
    """The heading of the compass with the declination of the tables, degrees."""
    lat, lon, _ = get_lat_lon_status(GPS)
    field = get_mag_field_ef(lat, lon)
    if field is None:
        raise ValueError(f"no magnetic field is tabulated for {lat}, {lon}")
    return compass.mag_heading_df(MAG, ATT, field[0])


def expected_mag_yaw(
    GPS: Any,
    ATT: Any,
    MAG: Any,
    roll_adjust: float = 0,
    pitch_adjust: float = 0,
    yaw_adjust: float = 0,
) -> Vector3:
    """The expected reading of the compass at the yaw that it measures itself. ``yaw_adjust`` is ignored."""
    field = expected_earth_field(GPS)
    euler = radians(ATT.Roll), radians(ATT.Pitch), radians(mag_yaw(GPS, ATT, MAG))
    return _in_body(field, euler, (roll_adjust, pitch_adjust, 0))


def earth_field_error(GPS: Any, NKF2: Any) -> Vector3:
    """The field that the EKF has learned less the one of the tables."""
    return Vector3(NKF2.MN, NKF2.ME, NKF2.MD) - expected_earth_field(GPS)
