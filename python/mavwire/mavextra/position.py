"""Positions, distances and origins on a spherical Earth. Degrees and metres."""

from __future__ import annotations

from math import asin, atan2, cos, degrees, hypot, radians, sin
from typing import Any

from mavwire._sphere import great_circle
from mavwire.mavextra import state
from mavwire.mavextra.units import wrap_valid_longitude

__all__ = [
    "_distance_two", "distance_from", "distance_gps2", "distance_home", "distance_home_df",
    "distance_lat_lon", "distance_two", "ekf1_pos", "get_lat_lon_alt", "get_origin",
    "gps_newpos", "gps_offset", "radius_of_earth",
]  # fmt: skip

radius_of_earth = 6378100.0
"""Metres, for extrapolated positions; distances take the mean radius."""

Position = tuple[float, float, float]


def get_origin() -> Any:
    """The message with the origin: the first ORGN, or the first GPS with a 3D fix; or None."""
    if state.SCALARS["ORGN"] is None:
        messages = state.current_link().messages
        origin, gps = messages.get("ORGN", None), messages.get("GPS", None)
        if origin is not None:
            state.SCALARS["ORGN"] = origin
        elif gps is not None and gps.Status >= 3:
            state.SCALARS["ORGN"] = gps
    return state.SCALARS["ORGN"]


def _degrees(lat: float, lon: float, scaled: bool) -> tuple[float, float]:
    """Latitude and longitude in degrees from degrees or, if ``scaled``, from degrees * 1e7.

    Values beyond any angle are taken as scaled too: GLOBAL_POSITION_INT and others are, without
    the field that tells GPS_RAW_INT.
    """
    if scaled or abs(lat) > 90 or abs(lon) > 180:
        return lat * 1.0e-7, lon * 1.0e-7
    return lat, lon


def _lat_lon(MSG: Any) -> tuple[float, float] | None:
    """Latitude and longitude of any kind of message; None where it has none."""
    for lat, lon in (("Lat", "Lng"), ("Lat", "Lon"), ("lat", "lon"), ("lat", "lng")):
        if hasattr(MSG, lat) and hasattr(MSG, lon):
            position = getattr(MSG, lat), getattr(MSG, lon)
            return position if lat == "Lat" else _degrees(*position, scaled=hasattr(MSG, "cog"))
    return None


def get_lat_lon_alt(MSG: Any) -> Position | None:
    """(latitude, longitude) in radians and altitude in metres of a message; None if it has none.

    Takes dataflash messages (Lat, Lng or Lon, Alt), MAVLink ones (lat, lon or lng, alt in mm) and
    EKF positions relative to the origin (PN, PE, PD).
    """
    position = _lat_lon(MSG)
    if position is not None:
        altitude = MSG.Alt if hasattr(MSG, "Lat") else MSG.alt * 0.001
        return radians(position[0]), radians(position[1]), altitude
    extrapolated = ekf1_pos(MSG) if hasattr(MSG, "PN") else None
    if extrapolated is None:
        return None
    lat, lon, altitude = extrapolated
    return radians(lat), radians(lon), altitude


def _distance_two(MSG1: Any, MSG2: Any, horizontal: bool = True) -> float:
    """Metres between the positions of two messages; TypeError where one has none."""
    first, second = get_lat_lon_alt(MSG1), get_lat_lon_alt(MSG2)
    if first is None or second is None:
        raise TypeError("a message without a position")
    ground = great_circle(first[0], first[1], second[0], second[1])
    return ground if horizontal else hypot(ground, second[2] - first[2])


def distance_two(MSG1: Any, MSG2: Any, horizontal: bool = True) -> float | None:
    """Metres over ground between two messages; None, and the reason printed, where it fails."""
    try:
        return _distance_two(MSG1, MSG2)
    except Exception as error:
        print(error)
        return None


def distance_home(GPS_RAW: Any) -> float | None:
    """Metres from the first position with a fix; 0 without a fix."""
    for status in ("fix_type", "Status"):
        if hasattr(GPS_RAW, status) and getattr(GPS_RAW, status) < 2:
            return 0
    if state.SCALARS["first_fix"] is None:
        state.SCALARS["first_fix"] = GPS_RAW
        return 0
    return distance_two(GPS_RAW, state.SCALARS["first_fix"])


def distance_home_df(GPS: Any, ORGN: Any) -> float | None:
    """Metres from the origin; 0 without a fix."""
    return 0 if GPS.Status < 2 else distance_two(GPS, ORGN)


def distance_gps2(GPS: Any, GPS2: Any) -> float | None:
    """Metres between two receivers; None unless the messages are of the same time."""
    return distance_two(GPS, GPS2) if GPS.TimeMS == GPS2.TimeMS else None


def distance_lat_lon(lat1: float, lon1: float, lat2: float, lon2: float) -> float:
    """Metres between two points in degrees."""
    return great_circle(radians(lat1), radians(lon1), radians(lat2), radians(lon2))


def distance_from(GPS_RAW1: Any, lat: float, lon: float) -> float:
    """Metres between a message and a point in degrees; TypeError if it has no position."""
    position = _lat_lon(GPS_RAW1)
    if position is None:
        raise TypeError("a message without a position")
    return distance_lat_lon(*position, lat, lon)


def gps_newpos(lat: float, lon: float, bearing: float, distance: float) -> tuple[float, float]:
    """The point at this distance in this direction (degrees)."""
    start, turn, angle = radians(lat), radians(bearing), distance / radius_of_earth
    end = asin(sin(start) * cos(angle) + cos(start) * sin(angle) * cos(turn))
    east = sin(turn) * sin(angle) * cos(start)
    moved = radians(lon) + atan2(east, cos(angle) - sin(start) * sin(end))
    return degrees(end), wrap_valid_longitude(degrees(moved))


def gps_offset(lat: float, lon: float, east: float, north: float) -> tuple[float, float]:
    """The point at this offset."""
    return gps_newpos(lat, lon, degrees(atan2(east, north)), hypot(east, north))


def ekf1_pos(EKF1: Any) -> Position | None:
    """The position of an EKF message: its offset (PN, PE, PD) from the message ORGN[0]."""
    origin = state.SCALARS["ekf_origin"]
    if origin is None:
        messages = state.current_link().messages
        if "ORGN[0]" not in messages:
            return None
        origin = state.SCALARS["ekf_origin"] = messages["ORGN[0]"]
    lat, lon = gps_offset(origin.Lat, origin.Lng, EKF1.PE, EKF1.PN)
    return lat, lon, origin.Alt - EKF1.PD
